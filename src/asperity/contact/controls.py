"""What is prescribed while two bodies are in contact: the normal load or the separation."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Literal, Self, cast

from asperity.base import checks
from asperity.errors import LARGEST


@dataclass(frozen=True)
class Control(ABC):
    """A prescribed quantity, constant or linear in time.

    Parameters
    ----------
    value
        Its value at the time ``since``.
    rate
        Its change per unit of time.
    since
        The time at which it has that value.
    """

    value: float
    rate: float = 0.0
    since: float = 0.0

    name: ClassVar[str]
    load_controlled: ClassVar[bool]
    """Whether the sum of the contact forces is prescribed."""

    def __post_init__(self) -> None:
        for name in ("rate", "since"):
            object.__setattr__(self, name, checks.number(name, getattr(self, name)))
        object.__setattr__(self, "value", self._checked(self.value))

    @staticmethod
    @abstractmethod
    def _checked(value: float) -> float:
        """Make a float of a value that can be prescribed."""

    def at(self, time: float) -> Self:
        """Return what is prescribed at a time, constant from there."""
        return type(self)(self.value + self.rate * (time - self.since)) if self.rate else self


@dataclass(frozen=True)
class Load(Control):
    """The normal load is prescribed: the sum of the contact forces, in units of force."""

    name = "load"
    load_controlled = True

    @staticmethod
    def _checked(value: float) -> float:
        expected = f"a number, 0 or from {1 / LARGEST:g} to {LARGEST:g}"
        found = checks.number("load", value, least=0, expected=expected)
        return found and checks.number("load", value, least=1 / LARGEST, expected=expected)


@dataclass(frozen=True)
class Separation(Control):
    """The rigid body is held: `value` is the mean of u0 when it was brought there, in units of height."""

    name = "separation"
    load_controlled = False

    @staticmethod
    def _checked(value: float) -> float:
        return checks.number("separation", value)


Hold = Literal["load", "separation", "area"]


def control_from(load: float | None, separation: float | None) -> Control:
    """One control from two arguments of which exactly one is given."""
    checks.one_of("load=800.0", load=load, separation=separation)
    return Load(load) if load is not None else Separation(cast(float, separation))
