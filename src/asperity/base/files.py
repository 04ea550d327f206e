"""Files that people name: how they are read, and what stands beside them."""

from __future__ import annotations

import hashlib
import stat
from contextlib import suppress
from pathlib import Path

_LONGEST = 200
"""Bytes of a name that others begin with: file systems take 255."""


def beside(path: Path, ending: str) -> Path:
    """A name in the same folder: that of the file, shortened where it is long, and an ending."""
    name = path.name.encode()
    if len(name) > _LONGEST:
        mark = hashlib.sha256(name).hexdigest()[:8]
        name = name[: _LONGEST - 9] + f"~{mark}".encode()
    return path.with_name(name.decode(errors="ignore") + ending)


Standing = frozenset[tuple[str, int, int, int]]
"""What stands under a name: files, each with its inode, size and time of change, and folders."""


def standing(path: Path) -> Standing:
    """What stands under a name; nothing for an empty folder, which may always be replaced."""
    path, found = path.resolve(), set()
    for entry in path.rglob("*") if path.is_dir() else [path]:
        with suppress(OSError):  # it has gone
            facts = entry.lstat()
            is_folder = stat.S_ISDIR(facts.st_mode)
            marks = (0, 0, 0) if is_folder else (facts.st_ino, facts.st_size, facts.st_mtime_ns)
            found.add((entry.relative_to(path).as_posix(), *marks))
    return frozenset(found)
