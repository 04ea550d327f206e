"""What is held while two bodies are in contact: the normal load or the separation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import asperity.checks as checks
from asperity.errors import LARGEST, InputError


@dataclass(frozen=True)
class Load:
    """The normal load is held: the sum of the contact forces, in units of force."""

    value: float

    def __post_init__(self) -> None:
        expected = f"a finite number > 0 (from {1 / LARGEST:g} to {LARGEST:g})"
        load = checks.number("load", self.value, least=1 / LARGEST, expected=expected)
        object.__setattr__(self, "value", load)


@dataclass(frozen=True)
class Separation:
    """The rigid body is held: `value` is the mean of u0 when it was pressed, in units of height."""

    value: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", checks.number("separation", self.value))


Control = Load | Separation
Hold = Literal["load", "separation"]


def control_from(load: float | None, separation: float | None) -> Control:
    """One control from two arguments of which exactly one is given."""
    if load is not None and separation is None:
        return Load(load)
    if separation is not None and load is None:
        return Separation(separation)
    raise InputError(
        "load and separation",
        expected="exactly one of the two",
        got="neither" if load is None else "both",
        advice="load=800.0",
    )
