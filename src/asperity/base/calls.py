"""Calls of public names: mistaken arguments get messages like mistaken keys of a configuration."""

from __future__ import annotations

import functools
import inspect
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from types import FrameType, FunctionType, ModuleType, SimpleNamespace, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from asperity.base.words import MEANT, closest, has_unit, reason_of, shortened
from asperity.errors import AsperityError, CallError, InputError, Remark


def answered(namespace: dict[str, Any]) -> Callable[[], list[str]]:
    """Let the public functions and classes of a module answer mistaken arguments by a `CallError`.

    Public are the names of ``__all__``; without it all but private ones, modules and tables. Returns the
    ``__dir__`` of the module: it lists the public names alone.
    """
    stated = (name for name, thing in namespace.items() if not isinstance(thing, ModuleType | dict))
    names: list[str] = namespace.setdefault("__all__", sorted(name for name in stated if name[0] != "_"))
    for name in names:
        thing = namespace[name]
        if isinstance(thing, FunctionType):  # pickles find it where it was defined
            home = vars(sys.modules[thing.__module__])
            namespace[name] = home[thing.__name__] = _answering(home[thing.__name__])
        elif isinstance(thing, type) and not issubclass(thing, BaseException):
            for key, member in list(vars(thing).items()):
                if (key == "__init__" or key[0] != "_") and (answering := _answering(member)) is not member:
                    setattr(thing, key, answering)
    return names.copy


def outside(group: str, name: str | None = None) -> Iterator[tuple[str, Any]]:
    """What other distributions offer by entry points, perhaps of one name; what fails is a remark."""
    from importlib.metadata import entry_points  # takes as long as all else that most commands import

    for entry in entry_points(group=group) if name is None else entry_points(group=group, name=name):
        try:
            yield entry.name, entry.load()
        except Exception as error:
            home = entry.dist.name if entry.dist else entry.value
            remark(f"{home} offers {entry.name}, which cannot be used: {reason_of(error)}")


def remark(text: str) -> None:
    """Issue a `Remark` at the line that called this package, unless it is empty."""
    if not text:
        return
    frame: FrameType | None = sys._getframe()
    level = outermost = 1
    while frame:  # of the compiler there may be some between ours
        outermost = level if str(frame.f_globals.get("__name__")).startswith("asperity.") else outermost
        frame, level = frame.f_back, level + 1
    warnings.warn(text, Remark, stacklevel=outermost + 1)


@contextmanager
def showing(what: str) -> Iterator[None]:
    """Let a picture, page, card or summary that fails be a remark, for the results are worth keeping.

    What the disk refuses is an error.
    """
    try:
        yield
    except OSError:
        raise
    except Exception as error:  # whatever it is, nothing that was computed is wrong
        remark(f"{what} could not be drawn: {reason_of(error)}")


@contextmanager
def remarks_made() -> Iterator[list[str]]:
    """Gather the remarks that are made meanwhile, in place of warnings."""
    texts: list[str] = []
    with warnings.catch_warnings(record=True) as made:
        warnings.simplefilter("always", Remark)
        yield texts
    texts += [str(one.message) for one in made if issubclass(one.category, Remark)]
    for other in made:
        if not issubclass(other.category, Remark):
            warnings.warn_explicit(other.message, other.category, other.filename, other.lineno)


def _answering(member: Any) -> Any:
    """Wrap a function or method so that it answers; return anything else."""
    if isinstance(member, classmethod | staticmethod):
        return type(member)(_answering(member.__func__))
    if not isinstance(member, FunctionType) or hasattr(member, "answers"):
        return member

    @functools.wraps(member)
    def call(*args: Any, **kwargs: Any) -> Any:
        if kwargs.get("rng") is not None and "seed" in kwargs:
            raise InputError("seed and rng", expected="one of them", got="both")
        import numpy as np

        try:
            with np.errstate(under="ignore"):  # what vanishes is 0, also where a user has it raise
                return member(*args, **kwargs)
        except Exception as error:
            if not isinstance(error, AsperityError):
                _check(member, args, kwargs, error)
            raise

    call.answers = True  # type: ignore[attr-defined]
    return call


def _check(
    function: Callable[..., Any], args: tuple[Any, ...], keywords: dict[str, Any], met: Exception
) -> None:
    """Blame what a call met on an argument that does not exist, is missing, or is of another type."""
    from asperity.base import checks  # takes long, as NumPy does
    from asperity.base.parameters import kinds_of

    signature = inspect.signature(function)
    names = [name for name in signature.parameters if name not in ("self", "cls")]
    *_, owner, name = f".{function.__qualname__}".split(".")
    name, listed = owner if name == "__init__" else name, shortened(", ".join(names), 120)
    try:
        given = signature.bind(*args, **keywords).arguments
    except TypeError as error:
        word = next((word for word in keywords if word not in names), "")
        meant = closest(MEANT[word] if MEANT.get(word) in names else word, names)
        elsewhere = getattr(getattr(function, "question", None), "elsewhere", {})
        advice = elsewhere.get(word, f"{meant}=..." if meant else "")
        got = repr(word) if word else str(error).removeprefix("got ")
        raise CallError(name, expected=f"the arguments {listed}", got=got, advice=advice) from None
    home = sys.modules[getattr(function, "question", function).__module__]
    for word in filter(given.__contains__, names):
        annotation = signature.parameters[word].annotation
        annotated = SimpleNamespace(__annotations__={word: annotation})
        with suppress(NameError):  # of a name that only the type checker imports
            hint = get_type_hints(annotated, vars(home))[word]
            if not _fits(given[word], hint):
                words = [repr(kind) for kind in kinds_of(hint) if isinstance(kind, str)]
                stated = hint if "Annotated[" in str(annotation) else annotation
                expected = f"one of {', '.join(words)}" if words else str(stated)
                raise InputError(word, expected=expected, got=checks.shown(given[word])) from met


def _fits(value: Any, hint: Any) -> bool:
    """Whether a value is of a type, as far as it tells; arrays are checked where they are used."""
    import numpy as np

    kind, parts = get_origin(hint) or hint, get_args(hint)
    if kind in (Union, UnionType):
        return any(_fits(value, part) for part in parts)
    if kind is Literal:
        return isinstance(value, str | int) and value in parts
    if kind in (int, float, complex):
        is_number = not isinstance(value, type) and (hasattr(value, "__float__") or has_unit(value))
        return is_number and not (isinstance(value, int) and abs(value) >= 2**63)
    if kind in (Sequence, list, tuple):
        several = hasattr(value, "__iter__") and not isinstance(value, str | Mapping)
        return several and all(any(_fits(item, part) for part in parts) for item in value)
    is_plain = isinstance(kind, type) and kind.__module__ != "typing"  # IO tells nothing of its values
    return kind in (Any, np.ndarray) or not is_plain or isinstance(value, kind)
