"""What is prescribed while two bodies are in contact: the normal load or the separation, in time."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Literal, Self

from asperity.base import checks
from asperity.errors import LARGEST, InputError


@dataclass(frozen=True)
class Course:
    """How a number changes in time: its value at a time, and the longest time step that follows it.

    ``rises`` says that it never falls.
    """

    at: Callable[[float], float]
    longest: float
    rises: bool = False


@dataclass(frozen=True)
class Control(ABC):
    """A prescribed quantity: a constant value, or a course of which that is the value at time 0."""

    value: float
    course: Course | None = None

    name: ClassVar[str]
    load_controlled: ClassVar[bool]
    """Whether the sum of the contact forces is prescribed."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "value", self._checked(self.value))

    @staticmethod
    @abstractmethod
    def _checked(value: float) -> float:
        """Make a float of a value that can be prescribed."""

    def at(self, time: float) -> Self:
        """Return what is prescribed at a time, constant from there."""
        return type(self)(self.course.at(time)) if self.course else self

    def after(self, time: float) -> Self:
        """Return the same with times that count from a time."""
        if (course := self.course) is None:
            return self
        return type(self)(
            course.at(time), Course(lambda since: course.at(time + since), course.longest, course.rises)
        )

    def change(self, since: float, time: float) -> float:
        """By how much it changes from a time to another."""
        return self.course.at(time) - self.course.at(since) if self.course else 0.0

    @property
    def rises(self) -> bool:
        """Whether it never falls."""
        return self.course is None or self.course.rises

    @property
    def longest(self) -> float:
        """Longest time step that follows it."""
        return self.course.longest if self.course else math.inf

    @property
    def rate(self) -> float:
        """Its change per unit of time at time 0."""
        lapse = self.longest / 1024
        return self.change(0.0, lapse) / lapse if self.course else 0.0


EXPECTED = f"a number, 0 or from {1 / LARGEST:g} to {LARGEST:g}"
"""What a load is expected to be where nothing sticks."""


@dataclass(frozen=True)
class Load(Control):
    """The normal load is prescribed: the sum of the contact forces, in units of force.

    Whether it may pull, below 0, depends on what sticks: see `System.held`.
    """

    name = "load"
    load_controlled = True

    @staticmethod
    def _checked(value: float) -> float:
        load = checks.number("load", value, expected=EXPECTED)
        if 0 < abs(load) < 1 / LARGEST:
            raise InputError("load", expected=EXPECTED, got=f"{load:g}")
        return load


@dataclass(frozen=True)
class Separation(Control):
    """The rigid body is held: `value` is the mean of u0 when it was brought there, in units of height."""

    name = "separation"
    load_controlled = False

    @staticmethod
    def _checked(value: float) -> float:
        return checks.number("separation", value)


Hold = Literal["load", "separation", "area"]
