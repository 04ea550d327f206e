"""Text for the terminal, in characters that it can write, without control sequences."""

from __future__ import annotations

import codecs
import io
import os
import shutil
import sys

from asperity.base.words import PLAIN
from asperity.errors import brief, printable

_NARROWEST = 40
"""Columns that help needs at least."""


def complain(status: int, *problems: str) -> int:
    """Write a line for each problem, and return the exit status."""
    for problem in problems:
        print("asperity:", brief(printable(" ".join(problem.split())), 900), file=sys.stderr)
    return status


def make_streams_safe() -> None:
    """Drop text for closed streams, and replace characters that a stream cannot encode."""
    codecs.register_error("asperity", _plainly)
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None or stream.closed:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115, PTH123
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="asperity")


def widen() -> None:
    """Widen terminals that are too narrow for the help."""
    wanted = os.environ.get("COLUMNS", "")
    if min(shutil.get_terminal_size().columns, int(wanted) if wanted.isdigit() else _NARROWEST) < _NARROWEST:
        os.environ["COLUMNS"] = str(_NARROWEST)


def silence_output() -> None:
    """Drop the interpreter's last flush, when the reader of a pipe has ended."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _plainly(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(PLAIN.get(c, "?") for c in error.object[error.start : error.end]), error.end
