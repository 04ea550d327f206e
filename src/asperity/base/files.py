"""Files that people name: how they are read, and what stands beside them."""

from __future__ import annotations

import hashlib
import json
import os
import select
import stat
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Literal, get_args

from asperity.base.machine import available
from asperity.base.version import __version__
from asperity.base.words import data_size
from asperity.errors import InputError, TooLargeError

_LONGEST = 200
"""Bytes of a name that others begin with: file systems take 255."""

_TIMES, _PATIENCE = 20, 5.0
"""Memory that a table takes, over that of its text; seconds in which somebody must write into a pipe."""

_pipes: dict[tuple[int, int], bytes] = {}
"""What pipes of a shell held, which can be read only once, by device and inode."""

_commands: list[object] = []
"""Commands that are running: one may ask again for what any pipe held."""


def expanded(path: str | Path) -> Path:
    """A path of a user, whose ~ is the home."""
    return Path(os.path.expanduser(path))  # noqa: PTH111  (which leaves the home of nobody as it is)


def without_links(path: Path) -> Path:
    """A path without links; `InputError` for links that lead nowhere but to each other."""
    place = Path(os.path.realpath(path))
    if any(part.is_symlink() for part in (place, *place.parents)):
        raise InputError(str(path), expected="a path", got="links in a circle")
    return place


def content_of(path: Path) -> bytes:
    """Read a file, or a pipe to its end, such as standard input or that of a shell.

    `InputError` for a device, and for a pipe into which nobody writes; `TooLargeError` for more than the
    memory has room for.
    """
    most = available() // _TIMES
    # A pipe without a writer would never open otherwise.
    flags = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    with open(os.open(path, os.O_RDONLY | flags), "rb") as file:  # noqa: PTH123  (which would open it anew)
        facts = os.fstat(file.fileno())
        if stat.S_ISFIFO(facts.st_mode):
            mark = facts.st_dev, facts.st_ino
            content = _pipes[mark] if mark in _pipes else _piped(file.fileno(), most)
            if not content:
                expected = "a pipe into which something is written"
                raise InputError(str(path), expected=expected, got="none for 5 s")
            if _commands or path.parts[1:2] in (("dev",), ("proc",)):
                _pipes[mark] = content
        elif stat.S_ISREG(facts.st_mode):
            content = file.read(most + 1)
        else:
            raise InputError(str(path), expected="a file or a pipe", got="a device")
    if len(content) > most:
        raise TooLargeError(f"{path}: expected a text of at most {data_size(most)}, got a longer one")
    return content


@contextmanager
def command_running() -> Iterator[None]:
    """Let each pipe be read once while a command runs, and what it held be asked for again."""
    _commands.append(None)
    try:
        yield
    finally:
        _commands.pop()
        _pipes.clear()


def _piped(handle: int, most: int) -> bytes:
    """What is written into a pipe, and no more than is asked for."""
    content, begin = bytearray(), time.monotonic()
    while len(content) <= most:
        try:
            if piece := os.read(handle, 1 << 26):
                content += piece
            elif content or time.monotonic() - begin > _PATIENCE:
                break
            else:
                time.sleep(0.02)
        except BlockingIOError:  # its writer has nothing yet
            select.select([handle], [], [])
    return bytes(content)


def beside(path: Path, ending: str) -> Path:
    """A name in the same folder: that of the file, shortened where it is long, and an ending."""
    name = os.fsencode(path.name)
    if len(name) > _LONGEST:
        mark = hashlib.sha256(name).hexdigest()[:8]
        name = name[: _LONGEST - 9].decode(errors="ignore").encode() + f"~{mark}".encode()
    return path.with_name(os.fsdecode(name) + ending)


Format = Literal["png", "pdf", "svg"]
FORMATS: tuple[Format, ...] = get_args(Format)
"""In which figures are written."""

OF_FIGURES = "# What a figure of Asperity draws."
"""First line of the table beside a figure."""

MARKER = "asperity.json"
"""Name of the file that says what a folder of results is: its kind, the version, and names of its files."""


def mark(file: Path, kind: str, names: Iterable[str], **facts: object) -> None:
    """Write the marker of a folder that holds these names."""
    marker = {"kind": kind, "version": __version__, "files": sorted(names), **facts}
    file.write_text(f"{json.dumps(marker, indent=1)}\n", encoding="utf-8")


def marker_of(folder: Path) -> dict[str, Any]:
    """What the marker of a folder says; empty without one."""
    try:
        marker = json.loads((folder / MARKER).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    return marker if isinstance(marker, dict) and isinstance(marker.get("kind"), str) else {}


def kind_of(folder: Path) -> str:
    """``"run"``, ``"prediction"``, ``"campaign"``, ...: what the folder of a command holds, or nothing."""
    return str(marker_of(folder).get("kind", ""))


def named(kind: str) -> str:
    """A kind with its article."""
    return f"{'an' if kind[0] in 'aeiou' else 'a'} {kind}"


Standing = frozenset[tuple[str, int, int, int]]
"""What stands under a name: files, each with its inode, size and time of change, and folders."""


def standing(path: Path) -> Standing:
    """What stands under a name; nothing for an empty folder, which may always be replaced."""
    path, visited = without_links(path), set()
    for entry in path.rglob("*") if path.is_dir() else [path]:
        with suppress(OSError):  # it has gone
            facts = entry.lstat()
            is_folder = stat.S_ISDIR(facts.st_mode)
            marks = (0, 0, 0) if is_folder else (facts.st_ino, facts.st_size, facts.st_mtime_ns)
            visited.add((entry.relative_to(path).as_posix(), *marks))
    return frozenset(visited)


def table_beside(path: Path, source: Path | None = None) -> Path:
    """Where the table of a figure goes: not over any other table, nor over the source of the numbers."""
    table = path.with_name(f"{path.stem}.csv")
    if table.exists():
        with table.open(encoding="utf-8", errors="replace") as file:
            ours = file.readline().rstrip() == OF_FIGURES
        if not ours or (source is not None and source.exists() and table.samefile(source)):
            return path.with_name(f"{path.stem}_data.csv")
    return table
