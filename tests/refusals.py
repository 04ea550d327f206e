"""Refusals: class and name are asserted where a test is, and the sentences stand in one file, `messages.txt`.

A better wording costs one run: ``ASPERITY_MESSAGES=write pytest -n 0 FILES`` writes the sentences of these
tests anew; then read what changed. A line of the file has the parameters of the test, the number of the
refusal in it, and the sentence.
"""

import functools
import os
import re
from collections import Counter
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
    """The sentences that tests know, in a file: below the name of each test, one a line."""

    def __init__(self, path: Path) -> None:
        self.path, self.seen, self.written = path, Counter[str](), set[str]()

    @functools.cached_property
    def known(self) -> dict[str, list[str]]:
        """Lines of each test."""
        found: dict[str, list[str]] = {}
        test = ""
        for line in self.path.read_text(encoding="utf-8").splitlines() if self.path.exists() else ():
            if line.startswith(" "):
                found[test].append(line.strip())
            else:
                test = line
                found[test] = []
        return found

    def check(self, sentence: str) -> None:
        """Expect a sentence in the words that are known."""
        case = os.environ["PYTEST_CURRENT_TEST"].removeprefix("tests/").rsplit(" (", 1)[0]
        case = re.sub(r"@\w+$", "", case)  # its group
        test, bracket, parameters = case.partition("[")
        self.seen[case] += 1
        line = f"{bracket}{parameters} {self.seen[case]}: {sentence}".strip()
        if _WRITES:
            self._write(test, line)
        assert line in self.known.get(test, [])

    def _write(self, test: str, line: str) -> None:
        if test not in self.written:
            self.known[test] = []
        self.written.add(test)
        self.known[test].append(line)
        tests = sorted(self.known)
        entries = (f"{each}\n" + "".join(f"    {one}\n" for one in self.known[each]) for each in tests)
        self.path.write_text("".join(entries), encoding="utf-8")


_MESSAGES = Sentences(MESSAGES)


def messages() -> dict[str, list[str]]:
    """Lines of each test."""
    return _MESSAGES.known


@contextmanager
def refuses(
    name: str = "", *, kind: type[AsperityError] = InputError
) -> Iterator[pytest.ExceptionInfo[AsperityError]]:
    """Expect an error of this class, about the argument of this name, in the words that are known."""
    with pytest.raises(kind) as raised:
        yield raised
    error = raised.value
    assert getattr(error, "name", "") == name
    sentence = str(error)
    assert "\n" not in sentence
    if isinstance(error, ConvergenceError):  # its numbers are rounding errors
        sentence = _NUMBER.sub("N", sentence)
    _MESSAGES.check(sentence)


def each_refuses(*calls: tuple[Any, ...]) -> None:
    """Expect an error of each call: a name, what is called, and with which arguments."""
    for name, call, *given in calls:
        with refuses(name):
            call(*given)
