"""Mistakes: a line for each, beginning with the program's name; an exit status; never a traceback."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from asperity import __version__
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
        (("rnu",), 'Unknown command "rnu". Did you mean "run"?'),
        (("--vesion",), 'Unknown command "--vesion"'),
        (("run", "--lod", "3"), "Unknown option: --lod. Did you mean --load?"),
        (("run", "--r-viscous", "3"), "Unknown option: --r-viscous. Did you mean --R-viscous?"),
        (("run", "--load"), "requires an argument"),
        (("run", "--load", "abc"), 'Invalid value for --load: unable to convert "abc" into float'),
        (("run", "--surface", "gausian"), 'Did you mean "gaussian"?'),
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
        (("run", "--k1", "-1"), "--k1: expected a number above 0.0, got -1.0"),
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


def test_more_than_memory_holds(asperity: Asperity) -> None:
    line = complaint(asperity, "run", "--shape", "10000000,100000000", status=1)
    assert line.startswith("not enough memory")


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
    assert asperity("--version") == (0, f"{__version__}\n", "")


def test_help_does_not_wait_for_the_engine() -> None:
    code = (
        "import sys\nfrom asperity.cli import main\nmain(['run', '--help'])\n"
        "sys.exit(any(m in sys.modules for m in ('numpy', 'xarray', 'matplotlib', 'pydantic')))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False, capture_output=True).returncode == 0


def test_as_a_module() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "asperity", "--version"], check=False, capture_output=True, text=True
    )
    assert (done.returncode, done.stdout) == (0, f"{__version__}\n")
    done = subprocess.run(
        [sys.executable, "-m", "asperity", "rnu"], check=False, capture_output=True, text=True
    )
    assert done.returncode == 2
    assert done.stderr.startswith('asperity: Unknown command "rnu"')
