"""What the tests of the command line share: small runs, and the command as a process."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from asperity.app.cli import main

SMALL = ("--shape", "32x32", "--last", "10", "--per-decade", "2")
"""Flags of a run that takes less than a second."""

Asperity = Callable[..., tuple[int, str, str]]


@pytest.fixture
def asperity(capsys: pytest.CaptureFixture[str]) -> Asperity:
    """Run the command in this process; give exit status, output and error lines."""

    def call(*words: str | Path) -> tuple[int, str, str]:
        status = main([str(word) for word in words])
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return call


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of one small finished run, not to be changed."""
    out = tmp_path_factory.mktemp("finished") / "out"
    assert main(["run", *SMALL, "--seed", "7", "--quiet", "--out", str(out)]) == 0
    return out


def process(*words: str | Path, before: str = "") -> subprocess.Popen[str]:
    """Start the command as a process of its own, after some Python code."""
    code = f"import sys\n{before}\nfrom asperity.app.cli import main\nsys.exit(main(sys.argv[1:]))"
    return subprocess.Popen(
        [sys.executable, "-c", code, *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
