"""Refusals: a test names the class, the argument and the value that the message shows.

Sentences that users meet most (units, tables, scans, files of a run, convergence) stand in `messages.txt`,
below the names of the tests that compare them; "..." stands for any words. To renew them, run
``ASPERITY_MESSAGES=write pytest -n 0 FILES`` and read what changed.
"""

import functools
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from asperity.errors import AsperityError, ConvergenceError, InputError

MESSAGES = Path(__file__).with_name("messages.txt")
_WRITES = os.environ.get("ASPERITY_MESSAGES") == "write"
_NUMBER = re.compile(r"\d\S*\d|\d")


class Sentences:
    """The sentences that some tests compare, in a file: below the name of each test, one a line."""

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


_MESSAGES = Sentences(MESSAGES)


def messages() -> dict[str, list[str]]:
    """Lines of each test."""
    return _MESSAGES.known


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
    assert advice in getattr(error, "advice", sentence)
    assert "\n" not in sentence
    if isinstance(error, ConvergenceError):  # its numbers are rounding errors
        sentence = _NUMBER.sub("N", sentence)
    _MESSAGES.check(sentence)


def each_refuses(*calls: tuple[Any, ...], got: str = "") -> None:
    """Expect an error of each call: a name, perhaps a value, what is called, and with which arguments.

    Values of calls that have none of their own are in `got`, between bars.
    """
    values = got.split(" | ") if got else [""] * len(calls)
    for (name, *row), value in zip(calls, values, strict=True):
        shown = value if callable(row[0]) else row.pop(0)
        with refuses(name, shown):
            row[0](*row[1:])
