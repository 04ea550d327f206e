"""Legs of a protocol in words, as the command line takes them: ``hold 10``, ``ramp 5 load=400``."""

from __future__ import annotations

import re
from collections.abc import Iterable

from asperity.base.words import number
from asperity.errors import ConfigError

_EXAMPLES = (
    "'hold 10', 'ramp 5 load=400', 'step load=160', 'slide distance=20 velocity=0.1', or 'repeat 3' for the "
    "legs so far, 3 times in all, or 'repeat 3 last 2'"
)
_BEFORE_A_UNIT = re.compile(r"(?<=[\d.])\s+(?=[^\W\d][^\s=]*(\s|$))")
"""Between a number and its unit."""


def legs_from_words(lines: Iterable[str]) -> list[dict[str, object]]:
    """Read legs, one a line: a kind, how long (of ``repeat``: how often), and key=value.

    A line ``repeat 3 last 2`` repeats two legs before it, or all without ``last``.

    `ConfigError` if a line is none; keys and values are checked later.
    """
    legs: list[dict[str, object]] = []
    for line in lines:
        spaced = re.sub(r"\s*=\s*|(?<=\blast)\s+(?=\d)", "=", line)
        kind, *rest = _BEFORE_A_UNIT.sub("", spaced).split() or [""]
        kind = kind.lower()
        leg: dict[str, object] = {"kind": kind}
        is_bare = kind in ("slide", "step") and bool(rest) and "=" not in rest[0]
        if rest and "=" not in rest[0]:
            leg["count" if kind == "repeat" else "duration"] = number(rest.pop(0))
        if not kind or is_bare or "=" in kind or any(word.count("=") != 1 for word in rest):
            raise ConfigError([f"--leg: expected a leg, such as {_EXAMPLES}, got {line!r}"])
        leg |= {key: number(value) for key, value in (word.split("=") for word in rest)}
        if kind == "repeat":
            last = leg.pop("last", None)
            if last is not None and last not in range(1, len(legs) + 1):
                expected = f"a whole number from 1 to {len(legs)}, the legs before it"
                raise ConfigError([f"--leg repeat: last: expected {expected}, got {last}"])
            first = 0 if last is None else len(legs) - int(str(last))
            leg["legs"], legs = legs[first:], legs[:first]
        legs.append(leg)
    return legs
