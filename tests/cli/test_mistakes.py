"""Mistakes: a line for each, beginning with the program's name; an exit status; never a traceback."""

from __future__ import annotations

import itertools
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from asperity import __version__
from asperity.surfaces import gaussian
from tests.cli.conftest import Asperity

_FROM_TOP = "(see asperity --help)"


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Work in an empty folder, and find it empty afterwards unless the test fills it."""
    monkeypatch.chdir(tmp_path)


def complaint(asperity: Asperity, *words: str | Path, status: int = 2) -> str:
    """The one line that a mistake gets, and nothing else."""
    got, out, error = asperity(*words)
    # What was being done when it happened may come first.
    *doing, line = error.splitlines()
    assert got == status
    assert out == ""
    assert not any("asperity:" in earlier for earlier in doing)
    assert line.startswith("asperity: ")
    assert "Traceback" not in error
    return line.removeprefix("asperity: ")


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("rnu",), "unknown command rnu; did you mean run?"),
        (("plot",), "unknown command plot; there are run, predict, surface, fit, "),
        (("--vesion",), "unknown command --vesion"),
        (("run", "--lod", "3"), "unknown option --lod; did you mean --load?"),
        (("run", "--r-viscous", "3"), "unknown option --r-viscous; did you mean --R-viscous?"),
        (("run", "--E", "3"), "unknown option --E; the elastic constants are --k0 and --k1"),
        (("run", "--half-space"), "unknown option --half-space; try --solid half_space --modulus 3.8GPa"),
        (("run", "--colour", "3"), "unknown option --colour (see"),
        (("sweep", "a", "--out", "b", "--workers", "1,5"), "--workers: expected a whole number, got 1,5"),
        (("fit", "a.csv", "--window", "0,5", "3"), 'unable to convert "0,5" into float; try 0.5'),
        (("run", "--load"), "requires an argument"),
        (("run", "--load", "--out", "a"), "--load requires an argument"),
        (("run", "a.toml", "b.toml"), "too many arguments: b.toml"),
        (("run", "--load", "1", "--load", "2"), "--load specified multiple times"),
        (("surface",), "requires an argument"),
    ],
)
def test_usage(asperity: Asperity, words: tuple[str, ...], line: str) -> None:
    text = complaint(asperity, *words)
    assert line in text
    assert text.endswith(_FROM_TOP)


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("run", "none.toml"), "none.toml: No such file or directory"),
        (("run", "--load", "nan"), "--load: expected a finite number, got nan"),
        (("run", "--load", "abc"), "--load: expected a number, got 'abc'"),
        (("run", "--load", "0,5"), "--load: expected a number, got '0,5'; try 0.5"),
        (("run", "--times", "0,5"), "--times: expected a number, got '0,5'; try 0.5, or 0 5 for two values"),
        (("run", "--seed", "1.5"), "--seed: expected a whole number, got 1.5"),
        (("run", "--per-decade", "2.7"), "--per-decade: expected a whole number, got 2.7"),
        (("run", "--surface", "gausian"), "got 'gausian'; did you mean 'gaussian'?"),
        (("run", "--surface", "file"), "--file: expected the file of the surface, got none; try --file PATH"),
        (("run", "--unit", "µn", "--file", "a.npy"), "--unit: expected one of 'm', 'mm', 'um', 'nm', 'pm'"),
        (("run", "--k1", "-1"), "--k1: expected a number above 0.0, got -1"),
        (("run", "--size", "64"), "not a key of a surface of kind 'gaussian', but of 'self_affine'"),
        (
            ("run", "--shape", "8,8", "--separation", "99"),
            "separation: expected one at which the solids touch",
        ),
        (("run", "--file", "none.npy"), "none.npy: expected a surface file, got no such file"),
        (("surface", "none.npy"), "none.npy: expected a surface file, got no such file"),
        (("surface", "none.npy", "--out", "a.docx"), "--out: expected a name that ends in .png, .pdf, .svg"),
        (("surface", "none.npy", "--out", "no/folder.png"), "--out: expected a file in a folder that exists"),
        (("surface", "none.npy", "--max-undefined", "2"), "--max-undefined: expected a number below 1.0"),
    ],
)
def test_bad_input(asperity: Asperity, tmp_path: Path, words: tuple[str, ...], line: str) -> None:
    assert line in complaint(asperity, *words)
    assert list(tmp_path.iterdir()) == []


def test_several_mistakes_have_a_line_each(asperity: Asperity, tmp_path: Path) -> None:
    Path("run.toml").write_text("[surface]\nshap = 3\n[solid]\nk0 = -1\n[contcat]\n")
    status, out, error = asperity("run", "run.toml", "--rms", "-1")
    lines = error.splitlines()
    assert (status, out, len(lines)) == (2, "", 4)
    assert all(line.startswith("asperity: ") for line in lines)
    assert any("did you mean 'shape'?" in line for line in lines)
    assert any(line.startswith("asperity: --rms: ") for line in lines)


@pytest.mark.parametrize("command", [("surface",), ("run", "--file")])
def test_surface_files_that_cannot_be_read(
    asperity: Asperity, tmp_path: Path, command: tuple[str, ...]
) -> None:
    np.save("good.npy", np.ones((8, 8)))
    content = Path("good.npy").read_bytes()
    Path("empty.npy").write_bytes(b"")
    Path("cut.npy").write_bytes(content[:-9])
    Path("header.npy").write_bytes(content[:20])
    Path("words.txt").write_text("1 2\nthree 4\n")
    before = sorted(tmp_path.iterdir())
    for name in ("empty.npy", "cut.npy", "header.npy", "words.txt", "."):
        assert name in complaint(asperity, *command, name)
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize(
    ("words", "fits"),
    [
        (("--shape", "10000000,100000000"), r"\d+ x \d+ sites"),
        (("--surface", "self_affine", "--size", "1048576"), r"(\d+) x \1 sites"),
        (("--shape", "2000000000"), r"\d+ sites"),
    ],
)
def test_more_than_memory_holds(
    asperity: Asperity, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...], fits: str
) -> None:
    monkeypatch.setattr("asperity.base.machine.available", lambda: 20_000_000_000)
    line = complaint(asperity, "run", *words, status=1)
    assert re.fullmatch(rf".* sites: expected .* [GT]B where 20 GB are available; try at most {fits}", line)
    assert list(tmp_path.iterdir()) == []


def test_what_a_terminal_would_obey_is_written_as_it_is_spelled(asperity: Asperity) -> None:
    Path("run.toml").write_text(
        '["\\u001b[31mred"]\n[solid]\n"\\u001b]0;title\\u0007" = 1\n', encoding="utf-8"
    )
    _, _, error = asperity("run", "run.toml")
    assert "[\\x1b[31mred]: no such section" in error
    assert "\\x1b]0;title\\x07: no such key" in error
    np.save("\x1b[2Jrough.npy", gaussian((8, 8)))
    words = ("--maps-at", "", "--figures", "", "--times", "1")
    status, out, error = asperity("run", "--file", "\x1b[2Jrough.npy", *words)
    assert status == 0
    assert "\\x1b[2Jrough.npy" in out
    assert "\x1b" not in out + error


def test_the_folder_of_a_reproduction_has_studies(asperity: Asperity) -> None:
    Path("my paper/studies/load").mkdir(parents=True)
    line = complaint(asperity, "status", "my paper")
    assert "try asperity status 'my paper'/studies/NAME for one of its studies" in line


def test_a_load_below_the_resolution_of_the_numbers_is_a_failure(asperity: Asperity, tmp_path: Path) -> None:
    assert "too small" in complaint(asperity, "run", "--shape", "8,8", "--load", "1e-30", status=1)
    assert list(tmp_path.iterdir()) == []


def test_help_and_version(asperity: Asperity) -> None:
    status, alone, _ = asperity()
    assert status == 0
    assert asperity("--help") == (0, alone, "")
    assert "run" in alone
    assert "surface" in alone
    status, text, _ = asperity("run", "--help")
    assert status == 0
    for word in ("Surface", "Solid", "Contact", "Aging", "--R-viscous", "--per-decade", "--file", "--rtol"):
        assert word in text
    assert asperity("--version") == asperity("-V") == (0, f"{__version__}\n", "")


@pytest.mark.parametrize("command", ["run", "surface", "fit", "sweep", "status", "gather"])
def test_help_fills_its_lines(asperity: Asperity, command: str) -> None:
    _, text, _ = asperity(command, "--help")
    lines = [line.strip("│ ") for line in text.splitlines()]
    for line, after in itertools.pairwise(lines):
        if line and after and line[-1].isalpha() and after[0].islower() and "--" not in after[:3]:
            assert len(line) + 1 + len(after.split()[0]) > 45, f"{line!r} ends early"


def test_defaults_in_the_help_are_those_of_a_run(asperity: Asperity) -> None:
    text = " ".join(asperity("run", "--help")[1].replace("│", " ").split())
    for words in (
        "200 200]",
        "--rms FLOAT Rms height. For gaussian, exponential. [default: 1]",
        "ten times the longest relaxation time, else 1e+06.",
    ):
        assert words in text


def python(*words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *words]
    return subprocess.run(command, check=False, capture_output=True, text=True, timeout=120)


def test_help_does_not_wait_for_the_engine() -> None:
    code = (
        "import sys\nfrom asperity.app.cli import main\nmain(['run', '--help'])\n"
        "sys.exit(any(m in sys.modules for m in ('scipy', 'xarray', 'matplotlib')))"
    )
    assert python("-c", code).returncode == 0
    bare = code.replace("'run', ", "").replace("'scipy'", "'numpy', 'pydantic'")
    assert python("-c", bare).returncode == 0


def test_as_a_module() -> None:
    done = python("-m", "asperity", "--version")
    assert (done.returncode, done.stdout) == (0, f"{__version__}\n")
    done = python("-m", "asperity", "rnu")
    assert done.returncode == 2
    assert done.stderr.startswith("asperity: unknown command rnu")


def test_folders_that_are_no_campaign_say_what_they_are(
    asperity: Asperity, finished: Path, tmp_path: Path
) -> None:
    (tmp_path / "paper" / "studies").mkdir(parents=True)
    for command in ("status", "gather"):
        status, _, error = asperity(command, tmp_path / "paper")
        assert status == 2
        assert "that of a reproduction; try asperity" in error
        status, _, error = asperity(command, finished)
        assert status == 2
        assert "that of a run; try its summary.txt" in error
