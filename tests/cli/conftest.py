"""What tests of the command line share: a small run, mistakes in one line, the command as a process."""

from __future__ import annotations

import csv
import os
import re
import subprocess
import sys
import textwrap
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest

from asperity.app.cli import main
from asperity.prediction import Prediction
from tests.refusals import Sentences

SMALL = ("--shape", "32x32", "--last", "10", "--per-decade", "2")
"""Flags of a run that takes less than a second."""

told = Sentences(Path(__file__).with_name("said.txt")).check
"""Expects what the command line said in the words of said.txt, which are written as those of refused.txt."""


def remarks(text: str, name: str = "remark") -> int:
    """How many lines begin with this name; what they say is in said.txt."""
    found = [line.removeprefix(name).strip() for line in text.splitlines() if line.startswith(name)]
    for one in found:
        told(one)
    return len(found)


Asperity = Callable[..., tuple[int, str, str]]
Says = Callable[..., str]
Mistaken = Callable[..., str]
SectionError = Callable[..., None]


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, coarse_pictures: None) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("asperity.base.checks.installed_from", lambda: "asperity")  # not where it is tested


@pytest.fixture
def asperity(capsys: pytest.CaptureFixture[str]) -> Asperity:
    """Run the command in this process; give exit status, output and error lines."""

    def call(*words: str | Path) -> tuple[int, str, str]:
        status = main([str(word) for word in words])
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return call


@pytest.fixture
def says(asperity: Asperity) -> Says:
    """Run a command that does what it is asked for; give its words. A run tells its progress beside them."""

    def call(*words: str | Path) -> str:
        status, text, error = asperity(*words)
        assert (status, error if words[:1] != ("run",) else "") == (0, ""), error
        return text

    return call


@pytest.fixture
def mistaken(asperity: Asperity) -> Mistaken:
    """Run a command that is a mistake, which gets one line and leaves nothing; give the line."""

    def call(*words: str | Path, status: int = 2) -> str:
        before = [*os.walk(".")]
        got, out, error = asperity(*words)
        # What was being done when it happened may come first.
        *doing, line = error.splitlines()
        assert (got, out) == (status, ""), error
        assert not any("asperity:" in earlier for earlier in doing)
        assert "Traceback" not in error
        assert line.startswith("asperity: ")
        # Other distributions add commands.
        line = re.sub(r" Available commands: .*(?= \(see)", "", line)
        assert [*os.walk(".")] == before
        return line.removeprefix("asperity: ").replace(str(Path.cwd()), "HERE")

    return call


@pytest.fixture
def refused(mistaken: Mistaken) -> SectionError:
    """Run a command that is a mistake, which gets a line that said.txt knows."""
    return lambda *words, status=2: told(mistaken(*words, status=status))


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> list[Prediction]:
    """What ``asperity predict`` finds from now on, of which nothing is drawn and kept: that takes longest."""
    found: list[Prediction] = []
    folder = tmp_path_factory.mktemp("undrawn")
    of_answer = "asperity.app.runs.prediction.Predicted.write"
    monkeypatch.setattr(of_answer, lambda one, *_, **__: found.append(one.prediction))
    monkeypatch.setattr("asperity.app.cli.computing.write_into", lambda *_: None)
    monkeypatch.setattr("asperity.app.cli.computing.whole_folder", lambda *_, **__: nullcontext(folder))
    return found


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of one small finished run, not to be changed."""
    out = tmp_path_factory.mktemp("finished") / "out"
    assert main(["run", *SMALL, "--seed", "7", "--quiet", "--out", str(out)]) == 0
    return out


def rows_of(table: Path) -> list[dict[str, str]]:
    """Rows of a table that a command wrote, by the names of its columns."""
    with table.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def process(*words: str | Path, before: str = "", **how: Any) -> subprocess.Popen[str]:
    """Start the command as a process of its own, after some Python code."""
    lines = ["import sys", before, "from asperity.app.cli import main", "sys.exit(main(sys.argv[1:]))"]
    code = "if __name__ == '__main__':\n" + textwrap.indent("\n".join(lines), "    ")
    return subprocess.Popen(
        [sys.executable, "-c", code, *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        **how,
    )
