"""Refusals: class and name are asserted where a test is, and the sentences stand in one file, `messages.txt`.

A better wording costs one run: ``ASPERITY_MESSAGES=write pytest -n 0 FILES`` writes the sentences of these
tests anew; then read what changed. A line of the file has the parameters of the test, the number of the
refusal in it, and the sentence.
"""

import os
import re
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from asperity.errors import AsperityError, ConvergenceError, InputError

MESSAGES = Path(__file__).with_name("messages.txt")
_WRITES = os.environ.get("ASPERITY_MESSAGES") == "write"
_NUMBER = re.compile(r"\d\S*\d|\d")


def messages() -> dict[str, list[str]]:
    """Lines of each test."""
    found: dict[str, list[str]] = {}
    test = ""
    for line in MESSAGES.read_text(encoding="utf-8").splitlines():
        if line.startswith(" "):
            found[test].append(line.strip())
        else:
            test = line
            found[test] = []
    return found


_KNOWN, _SEEN, _WRITTEN = messages(), Counter[str](), set[str]()


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
    case = os.environ["PYTEST_CURRENT_TEST"].removeprefix("tests/").rsplit(" (", 1)[0]
    test, bracket, parameters = case.partition("[")
    _SEEN[case] += 1
    line = f"{bracket}{parameters} {_SEEN[case]}: {sentence}".strip()
    if _WRITES:
        _write(test, line)
    assert line in _KNOWN.get(test, [])


def _write(test: str, line: str) -> None:
    if test not in _WRITTEN:
        _KNOWN[test] = []
    _WRITTEN.add(test)
    _KNOWN[test].append(line)
    entries = (f"{each}\n" + "".join(f"    {one}\n" for one in _KNOWN[each]) for each in sorted(_KNOWN))
    MESSAGES.write_text("".join(entries), encoding="utf-8")
