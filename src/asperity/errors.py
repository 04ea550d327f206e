"""Every exception that Asperity raises on purpose.

AsperityError
├── InputError (ValueError)         something given is wrong; the message says what was expected
│   ├── CallError (TypeError)       a call has an argument that does not exist, or lacks one
│   ├── SurfaceFileError            a surface file is missing, empty, truncated or of another kind
│   ├── ConfigError                 a run configuration is wrong; lists every mistake
│   └── CheckpointError             a file is no checkpoint, or that of another run
├── MissingExtraError (ImportError) an optional library is needed; the message says how to install it
├── TooLargeError (MemoryError)     more than the memory there is would be needed; nothing was begun
├── ConvergenceError (RuntimeError) a solver stopped before its tolerance; nothing is returned
├── OutputError (OSError)           results could not be written; nothing half-written is left
└── PulledOff (RuntimeError)        two bodies do not hold together under a load: an answer, and no failure

Remark (UserWarning)                nothing is wrong, but the user should know
"""

from __future__ import annotations

import copy
import copyreg
from collections.abc import Callable, Iterable, Mapping


def printable(text: str) -> str:
    """Write what a terminal would obey, or not show, as escapes; lines, tabs and thin spaces stay."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c in "\n\t\u202f" else ascii(c)[1:-1] for c in text)


def brief(text: str, longest: int = 400) -> str:
    """Leave out the line breaks, and the middle of what is too long for a line; escape what is not shown."""
    line = " ".join(text.split()) if "\n" in text else text
    return printable(line if len(line) <= longest else f"{line[: longest // 2]} ... {line[-longest // 3 :]}")


class AsperityError(Exception):
    """Base of every exception that Asperity raises on purpose."""

    def __reduce__(self) -> tuple[object, ...]:
        # By default a copy would be made by calling the class with the message alone.
        return copyreg.__newobj__, (type(self), *self.args), vars(self)  # type: ignore[attr-defined]


class Remark(UserWarning):
    """Nothing is wrong, but the user should know: something takes long, or lies in an unusual place."""


class Name(str):
    """An argument or a key within a message: each door writes it in its way."""

    __slots__ = ()


Words = str | tuple[str, ...]
"""Part of a message; a tuple is joined, and a `Name` in it becomes a flag or a key."""


def named(names: Iterable[str], between: str = ", ") -> tuple[str, ...]:
    """Arguments or keys within a message; "none" where there are none."""
    parts = [part for name in names for part in (between, Name(name))]
    return tuple(parts[1:]) or ("none",)


Spell = Callable[[str], str]
Value = str | float | bool | list[int]
Assign = Callable[[str, Value], str]


class InputError(AsperityError, ValueError):
    """Something that was given is wrong; it keeps as attributes what it is made of, `got` as text.

    Parameters
    ----------
    name
        What is wrong, as the user wrote it: ``"load"``, ``"heights"``.
    expected, got
        What was expected, and what came instead.
    advice
        What to write or do instead, in words; may be empty.
    cure
        Arguments to give, with their values: each door writes them in its way.
    said
        The mistake in words, in place of what was expected and what came.
    path
        Section and key of a configuration, and places in its lists.
    """

    def __init__(
        self,
        name: str,
        *,
        expected: Words = "",
        got: object = "",
        advice: Words = "",
        cure: Mapping[str, Value] | None = None,
        said: Words = "",
        path: tuple[str | int, ...] = (),
    ) -> None:
        self.name, self.expected, self.got, self.advice = name, expected, brief(str(got)), advice
        self.cure, self.said, self.path = dict(cure or {}), said, path
        super().__init__(self.told(brief(name)))

    def told(self, place: str, spell: Spell = str, assign: Assign = "{}={!r}".format) -> str:
        """The message behind a place, with names and assignments as a door writes them."""
        said = _joined(self.said, spell) or f"expected {_joined(self.expected, spell)}, got {self.got}"
        cures = ", ".join(filter(None, (assign(name, value) for name, value in self.cure.items())))
        advice = ", or ".join(filter(None, (cures, _joined(self.advice, spell))))
        return f"{place}: {said}{'; try ' * bool(advice)}{advice}".removeprefix(": ")

    def retold(self, name: str, text: str) -> InputError:
        """Return the same error as a door says it, unless one said it before."""
        if self.args != (self.told(brief(self.name)),):
            return self
        retold = copy.copy(self)
        retold.name, retold.args = name, (text,)
        return retold

    def about(self, name: str, *path: str | int, keys: Mapping[str, str] | None = None) -> InputError:
        """Return the same error about something else, its cure by the keys that set arguments, if given."""
        facts = {key: getattr(self, key) for key in ("expected", "got", "advice", "said")}
        cure = self.cure if keys is None else {keys[one]: self.cure[one] for one in self.cure if one in keys}
        return InputError(name, **facts, cure=cure, path=path or self.path)


def _joined(words: Words, spell: Spell) -> str:
    parts = (words,) if isinstance(words, str) else words
    return "".join(spell(part) if isinstance(part, Name) else part for part in parts)


class CallError(InputError, TypeError):
    """A call of a public function has an argument that does not exist, or lacks one."""


class SurfaceFileError(InputError):
    """A surface file is missing, empty, truncated or of another kind."""


SHOWN_PROBLEMS = 10
"""Mistakes of a configuration that a terminal or a page shows."""


class ConfigError(InputError):
    """A run configuration is wrong.

    Parameters
    ----------
    problems
        One line for each mistake, kept; `shown` are the first ten, and how many more there are.
    mistakes
        The same as data, with the section and the key of each in `path`; empty where there are lines alone.
    """

    def __init__(self, problems: list[str], mistakes: tuple[InputError, ...] = ()) -> None:
        self.problems, self.mistakes = [brief(problem) for problem in problems], mistakes
        more = len(problems) - SHOWN_PROBLEMS
        self.shown = [*self.problems[:SHOWN_PROBLEMS], *[f"... and {more:,} more"] * (more > 0)]
        super().__init__("configuration", expected="no mistakes")
        self.got = "; ".join(self.shown)
        self.args = (self.got,)


class CheckpointError(InputError):
    """A file is no checkpoint, or that of another run."""


class MissingExtraError(AsperityError, ImportError):
    """An optional library is needed and not installed."""


class TooLargeError(MemoryError, AsperityError):  # in this order, else no copy of it can be made
    """What was asked for needs more memory than there is."""


class ConvergenceError(AsperityError, RuntimeError):
    """A solver stopped before it reached its tolerance."""


class OutputError(AsperityError, OSError):
    """Results could not be written."""


class PulledOff(AsperityError, RuntimeError):  # noqa: N818  (an answer, and no failure)
    """The contact does not bear a load that pulls: the bodies part.

    Parameters
    ----------
    load
        The last load that it bore; None where it bore none.
    """

    def __init__(self, load: float | None = None) -> None:
        self.load = load
        last = "they do not bear that load" if load is None else f"the last load borne was {load:.6g}"
        super().__init__(f"the bodies are pulled off each other: {last}")


LARGEST = 1e100
"""Numbers beyond it, or below its inverse, would overflow or vanish when energies are computed."""

_OWN = [one for one in vars().values() if isinstance(one, type) and issubclass(one, AsperityError)]
__all__ = sorted(one.__name__ for one in _OWN)
__dir__ = __all__.copy  # dir() lists the public names alone
