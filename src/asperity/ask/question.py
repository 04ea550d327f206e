"""Questions as data: what a verb is asked, checked when it is made."""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, ClassVar, ParamSpec, TypeVar

import numpy as np

from asperity.ask.section import KINDS, Keys, Section, keys_of_maker
from asperity.base.checks import Floats
from asperity.base.parameters import Checked

_P = ParamSpec("_P")
_Question = TypeVar("_Question")
_Answer = TypeVar("_Answer")


def answers(
    question: Callable[_P, _Question],
) -> Callable[[Callable[[_Question], _Answer]], Callable[_P, _Answer]]:
    """Let a function answer questions of a class: it is called with the arguments that make one.

    Its signature and its text are those of the class.
    """

    def asked(answer: Callable[[_Question], _Answer]) -> Callable[_P, _Answer]:
        @functools.wraps(answer)
        def ask(*args: _P.args, **kwargs: _P.kwargs) -> _Answer:
            return answer(question(*args, **kwargs))

        ask.__doc__, signature = question.__doc__, inspect.signature(question)
        returned = inspect.signature(answer).return_annotation
        vars(ask).update(question=question, __signature__=signature.replace(return_annotation=returned))
        return ask

    return asked


def in_decades(given: Sequence[Any] | Floats | float | str, per_decade: int) -> Floats:
    """Numbers as given; of the two ends of a range so many in each decade."""
    numbers = np.array(given, dtype=np.float64)
    if numbers.size != 2 or not 0 < numbers[0] < numbers[1]:
        return numbers
    decades = math.log10(numbers[1] / numbers[0])
    return np.geomspace(numbers[0], numbers[1], math.ceil(decades * per_decade) + 1)


class Question(Checked):
    """A frozen dataclass; fields annotated with a quantity are its own keys, others may be those of sections.

    This class itself stands for a run, which has no keys of its own.

    Attributes
    ----------
    sections
        Sections that have keys of the same names as fields, and read them.
    placed
        Sections in which a file has its own keys, by key.
    elsewhere
        What to write in place of arguments that users expect and that it has not, by argument.
    unused
        Keys of the file of a run that it does not use, by section.
    refused
        What it expects in place of keys of that file that contradict it, by section and key.
    pressed
        Whether it needs a load.
    """

    sections: ClassVar[tuple[str, ...]] = ()
    placed: ClassVar[Mapping[str, str]] = {}
    elsewhere: ClassVar[Mapping[str, str]] = {}
    unused: ClassVar[Mapping[str, Collection[str]]] = {"solid": ("draws",)}
    refused: ClassVar[Mapping[tuple[str, str], str]] = {}
    pressed: ClassVar[bool] = False

    @classmethod
    def section(cls, name: str) -> type[OwnKeys]:
        """The section of a file that has its own keys."""
        keys = {key: one for key, one in keys_of_maker(cls).items() if key not in cls.placed}
        facts = {"section": name, "keys": keys, "question": cls, "__module__": cls.__module__}
        return type(cls.__name__, (OwnKeys,), facts)

    @classmethod
    def uses(cls, section: str, key: str) -> bool:
        """Whether it uses a key of a section of the file of a run."""
        return key not in cls.unused.get(section, ()) and (section, key) not in cls.refused

    @classmethod
    @functools.cache
    def checked(cls) -> Keys:
        """Its own keys, and those of sections that it takes."""
        fields = inspect.signature(cls).parameters
        shared = {
            name: one
            for section in cls.sections
            for name, one in KINDS[section][""].keys.items()
            if name in fields
        }
        return shared | keys_of_maker(cls)


class OwnKeys(Section):
    """The section of a file that makes it that of a question, with keys that no other section has."""

    question: ClassVar[type[Question]]
