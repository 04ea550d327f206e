"""The README's Python runs as printed, and gives the numbers that it prints."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

from asperity.config import config_from

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)


def test_the_ten_lines_run_as_printed(capsys):
    (code,) = (block for block in blocks("python") if "press" in block)
    names: dict[str, Any] = {}
    exec(code, names)
    printed = capsys.readouterr().out.split()
    (promised,) = re.findall(r"sites in contact: ([\d ]+)", code)
    assert printed == promised.split()
    data = names["history"].dataset
    for quantity in ("area", "load", "separation", "energy", "residual"):
        assert data[quantity].dims == ("time",)
    assert data["time"].values[0] == 0
    assert data.sizes["time"] == 38


def test_the_configuration_is_accepted():
    (text,) = blocks("toml")
    config = config_from(tomllib.loads(text), {}, None)
    assert config.surface.model_dump()["shape"] == [400, 400]


def test_every_command_of_the_readme_exists():
    lines = [line.split("#")[0].strip() for block in blocks("sh") for line in block.splitlines()]
    for line in lines:
        words = line.split()
        if words[0] == "make":
            makefile = (Path(__file__).parents[2] / "Makefile").read_text()
            assert f"\n{words[1]}:" in makefile
        else:
            assert words[0] == "asperity"
            command = [sys.executable, "-m", *words[:2], "--help"]
            known = subprocess.run(command, capture_output=True, text=True, check=True).stdout
            for flag in (word for word in words if word.startswith("--")):
                assert flag in known, line


@pytest.mark.parametrize("name", re.findall(r"\]\(((?!http)[^)]+)\)", README))
def test_links_lead_somewhere(name):
    assert (Path(__file__).parents[2] / name).exists()
