"""Random draws, each judged and each bounded in time.

The draws of a test are the same in every run. Two environment variables make a longer one, with others:
`ASPERITY_FUZZ_DRAWS` (how many draws each test makes) and `ASPERITY_FUZZ_SEED`; a failure names its seed and
its number, and `ASPERITY_FUZZ_FIRST` (number of the first draw) begins there.
"""

import json
import os
import shutil
import time
import traceback
import warnings
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asperity.errors import AsperityError, ConfigError, Remark

SEED = int(os.environ.get("ASPERITY_FUZZ_SEED", "11"))
DRAWS = int(os.environ.get("ASPERITY_FUZZ_DRAWS", "0"))
FIRST = int(os.environ.get("ASPERITY_FUZZ_FIRST", "0"))
LONGEST = 10.0
"""Seconds of processor time for one draw."""


@dataclass
class Draw:
    """One draw: its random numbers, and words about it for whoever reads of its failure."""

    rng: np.random.Generator
    about: list[str] = field(default_factory=list)

    def one(self, things: Sequence[Any]) -> Any:
        return things[int(self.rng.integers(len(things)))]

    def chance(self, probability: float) -> bool:
        return bool(self.rng.random() < probability)

    def between(self, low: int, high: int) -> int:
        """A whole number, both ends included."""
        return int(self.rng.integers(low, high + 1))

    def decades(self, low: float, high: float) -> float:
        """A number of which the decimal logarithm is anything between these."""
        return float(10.0 ** self.rng.uniform(low, high))

    def say(self, text: object) -> None:
        """Remember what was drawn."""
        self.about.append(str(text)[:2000])


def fuzz(kind: str, count: int, attempt: Callable[[Draw], None]) -> None:
    """Make draws of one kind; report all that went wrong, by seed and number."""
    failures = []
    for number in range(FIRST, FIRST + (DRAWS or count)):
        draw = Draw(np.random.default_rng([SEED, zlib.crc32(kind.encode()), number]))
        begin, where = time.process_time(), ""
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", Remark)
                attempt(draw)
        except Exception as error:
            where = "".join(traceback.format_exception(error)[-4:])
        if (took := time.process_time() - begin) > LONGEST:
            where += f"took {took:.3g} s"
        if where:
            failures.append(f"{kind}, seed {SEED}, draw {number}: {'; '.join(draw.about)}\n{where}")
    if failures:
        pytest.fail(f"{len(failures)} draws:\n" + "\n".join(failures[:40]), pytrace=False)


def tried(call: Callable[[], Any]) -> Any:
    """The result of a call; or the error that it raised on purpose, in one clear line."""
    try:
        return call()
    except AsperityError as error:
        for line in error.problems if isinstance(error, ConfigError) else [str(error)]:
            assert_clear(line)
        return error


def assert_clear(line: str) -> None:
    """A line that a person can read: short, no traceback, nothing that a terminal obeys."""
    assert 0 < len(line) < 1000, f"{len(line)} characters: {line[:200]!r}"
    assert not [bad for bad in ("Traceback", "\n", "\x1b") if bad in line], repr(line)


def damage_bytes(draw: Draw, content: bytes) -> bytes:
    """Flip bits, cut, empty, repeat, fill or replace a part of a file."""
    size = len(content)
    how = draw.one(["flip", "flip", "cut", "empty", "repeat", "zero", "noise", "insert", "begin"])
    draw.say(f"{how} of {size} bytes")
    if how == "empty" or not size:
        return b""
    begin = draw.between(0, size - 1)
    end = min(size, begin + draw.one([1, 4, 16, size]))
    nasty = draw.one([b"\x00", b"\xff\xfe", b"nan", b",", b"\n", b"-", b"1e999", b"\x1b[2J"])
    data = bytearray(content)
    # Headers stand at the beginning and directories at the end.
    near = draw.one([size, min(size, 200)])
    for _ in range(draw.one([1, 1, 2, 10])):
        at = draw.between(0, near - 1)
        data[draw.one([at, size - 1 - at])] ^= 1 << draw.between(0, 7)
    damaged: dict[str, bytes] = {
        "flip": bytes(data),
        "cut": content[:begin],
        "begin": content[begin:],
        "repeat": content[:end] + content[begin:],
        "zero": content[:begin] + bytes(end - begin) + content[end:],
        "noise": content[:begin] + draw.rng.bytes(end - begin) + content[end:],
        "insert": content[:begin] + nasty + content[begin:],
    }
    return damaged[how]


def damage_json(draw: Draw, tree: Any) -> Any:
    """Replace, remove or double something inside nested lists and tables."""
    nasty: list[Any] = [None, True, -1, 0, 10**18, 1e308, 2.5, "", "x", "\x1b[2J"]
    nasty += [[], {}, [[]], [0], {"a": 1}]
    if not isinstance(tree, (dict, list)) or not tree or draw.chance(0.12):
        return draw.one(nasty)
    keys = list(tree) if isinstance(tree, dict) else list(range(len(tree)))
    changed: Any = dict(tree) if isinstance(tree, dict) else list(tree)
    key = draw.one(keys)
    draw.say(key)
    if draw.chance(0.1):
        del changed[key]
    elif draw.chance(0.1) and isinstance(changed, list):
        changed.append(changed[key])
    elif draw.chance(0.1) and isinstance(changed, dict):
        changed[draw.one(["x", "", "\x1b[2J"])] = draw.one(nasty)
    else:
        changed[key] = damage_json(draw, changed[key])
    return changed


def damage_folder(draw: Draw, folder: Path) -> Path:
    """Damage one of the files below a folder, remove it, or put something else in its place."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    path: Path = draw.one(files)
    draw.say(path.relative_to(folder))
    how = draw.one(["bytes", "bytes", "json", "json", "json", "remove", "folder", "remove folder", "stray"])
    draw.say(how)
    if how == "json" and path.suffix == ".json":
        path.write_text(json.dumps(damage_json(draw, json.loads(path.read_bytes()))), encoding="utf-8")
    elif how in ("bytes", "json"):
        path.write_bytes(damage_bytes(draw, path.read_bytes()))
    elif how in ("remove", "folder"):
        path.unlink()
        if how == "folder":
            path.mkdir()
    elif how == "remove folder" and path.parent != folder:
        shutil.rmtree(path.parent)
        if draw.chance(0.3):
            path.parent.write_bytes(b"x")
    else:
        (path.parent / draw.one(["x", "zarr.json", "c", "\x1b[2J"])).touch()
    return path
