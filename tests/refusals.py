"""Refusals: a test names the class, the argument and the value that came; sentences may change.

Refusals that users meet most (units, tables, scans, files of a run) stand in `refused.txt`, below the names
of the tests that compare them: class, path and value in JSON; "..." stands for any words. To renew them, run
``ASPERITY_MESSAGES=write pytest -n 0 FILES`` and read what changed.
"""

import functools
import json
import os
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from cyclopts.exceptions import CycloptsError

from asperity.app.config.keys import sections
from asperity.app.config.mistakes import flag_of
from asperity.errors import AsperityError, ConfigError, InputError

REFUSED = Path(__file__).with_name("refused.txt")
_WRITES = os.environ.get("ASPERITY_MESSAGES") == "write"


def refusal(error: BaseException, own: Iterable[str] = ()) -> list[str]:
    """An error as data: its class, and for each mistake the path of the thing and the value that came.

    A path has section and key, whichever door they came through, but for the arguments that are a command's
    `own`.
    """
    rows = [("", "")]
    if isinstance(error, ConfigError) and error.mistakes:
        rows = [(".".join(map(str, one.path)) or one.name, one.got) for one in error.mistakes]
    elif isinstance(error, ConfigError):  # lines of "[FILE: ]PATH: expected ..., got VALUE[; try ...]"
        rows = []
        for line in error.problems:
            place, _, rest = re.sub(r"^\S+\.toml: (?=.*: )", "", line).partition(": ")
            got = re.split("; try |; did you mean ", rest.partition(", got ")[2])[0]
            rows.append(
                (place.split(" expected ")[0], re.sub(r"--\w[\w-]*", lambda key: _plain(key[0]), got))
            )
    elif isinstance(error, InputError):
        rows = [(error.name, error.got)]
    elif isinstance(error, CycloptsError):
        token, argument = getattr(error, "token", None), getattr(error, "argument", None)
        flag = argument.name if argument else token.keyword if token else ""
        unused = getattr(error, "unused_tokens", None) or [] if not flag else []
        rows = [(flag or "", token.value if token else " ".join(unused))]
    found = [type(error).__name__]
    for name, got in rows:
        place = name if _plain(name) in own else _keys().get(name, name)
        place = re.sub(r"^--leg\b:?", "protocol", place)
        if re.match(r"\[\w+\]|protocol", place):
            place = ".".join(re.findall(r"\w+", place))
        found += [_plain(place), got.replace(str(Path.cwd()), "HERE")]
    return found


def _plain(name: str) -> str:
    """A flag as the name of an argument; other names, with paths of files shortened, as they are."""
    is_flag = name.startswith("--")
    return name[2:].replace("-", "_") if is_flag else name.replace(str(Path.cwd()), "HERE")


@functools.cache
def _keys() -> dict[str, str]:
    """Section and key by flag."""
    return {
        flag_of(section, key): f"{section}.{key}"
        for section, kinds in reversed(sections().items())
        for keys in kinds.values()
        for key in (*keys, *(["kind"] if len(kinds) > 1 else []))
    }


class Sentences:
    """Lines that some tests compare, in a file: below the name of each test, one a line."""

    def __init__(self, path: Path) -> None:
        self.path, self.renewed = path, dict[str, list[str]]()

    @functools.cached_property
    def known(self) -> dict[str, list[str]]:
        """Lines of each test."""
        found: dict[str, list[str]] = {}
        test = ""
        for line in self.path.read_text(encoding="utf-8").splitlines():
            if line.startswith(" "):
                found[test].append(line.strip())
            else:
                test = line
                found[test] = []
        return found

    def check(self, sentence: str) -> None:
        """Expect a sentence in the words that are known, if the test compares any."""
        test = re.split(r"[\[@ ]", os.environ["PYTEST_CURRENT_TEST"].removeprefix("tests/"))[0]
        if test in self.known:
            as_known = [line for line in self.known[test] if matches(line, sentence)]
            if _WRITES:
                self._renew(test, *(as_known or [sentence]))
            else:
                assert as_known, f"{sentence} is not in {self.path.name}"

    def _renew(self, test: str, *lines: str) -> None:
        renewed = self.renewed.setdefault(test, [])
        renewed += [line for line in lines if line not in renewed]
        entries = sorted((self.known | self.renewed).items())
        text = "".join(f"{each}\n" + "".join(f"    {line}\n" for line in lines) for each, lines in entries)
        self.path.write_text(text, encoding="utf-8")


def matches(pattern: str, sentence: str) -> bool:
    """Whether a sentence is as expected, where three dots stand for any words."""
    return bool(re.fullmatch(".*".join(map(re.escape, pattern.split("..."))), sentence))


KNOWN = Sentences(REFUSED)


@contextmanager
def refuses(
    name: str = "", got: object = "", *, advice: str = "", kind: type[AsperityError] = InputError
) -> Iterator[pytest.ExceptionInfo[AsperityError]]:
    """Expect an error of this class, about this argument, that shows what it got and advises so."""
    with pytest.raises(kind) as raised:
        yield raised
    error = raised.value
    sentence = str(error)
    assert getattr(error, "name", "") == name
    assert str(got) in getattr(error, "got", sentence)
    assert advice in sentence
    assert "\n" not in sentence
    KNOWN.check(json.dumps(refusal(error), ensure_ascii=False))


def each_refuses(*calls: tuple[Any, ...], got: str = "") -> None:
    """Expect an error of each call: a name, perhaps a value, what is called, and with which arguments.

    Values of calls that have none of their own are in `got`, between bars.
    """
    values = got.split(" | ") if got else [""] * len(calls)
    for (name, *row), value in zip(calls, values, strict=True):
        shown = value if callable(row[0]) else row.pop(0)
        with refuses(name, shown):
            row[0](*row[1:])
