"""Calls of public names: mistaken arguments are answered as mistaken keys of a configuration are."""

from __future__ import annotations

import functools
import inspect
import sys
from collections.abc import Callable
from types import FunctionType
from typing import Any, ParamSpec, TypeVar

from asperity.base.words import MEANT, closest, shortened
from asperity.errors import CallError

_P = ParamSpec("_P")
_T = TypeVar("_T")


def answered(namespace: dict[str, Any]) -> Callable[[], list[str]]:
    """Let the public functions and classes of a module answer mistaken arguments by a `CallError`.

    Returns the ``__dir__`` of the module: it lists the public names alone.
    """
    names: list[str] = namespace["__all__"]
    for name in names:
        thing: Any = namespace[name]
        if isinstance(thing, FunctionType):
            home = vars(sys.modules[thing.__module__])
            if home.get(thing.__name__) == thing:
                home[thing.__name__] = _answering(thing)
            namespace[name] = home[thing.__name__]
        elif isinstance(thing, type) and not issubclass(thing, BaseException):
            for key, member in list(vars(thing).items()):
                wrap = type(member) if isinstance(member, classmethod | staticmethod) else lambda inner: inner
                inner = getattr(member, "__func__", member)
                if (key == "__init__" or key[0] != "_") and isinstance(inner, FunctionType):
                    setattr(thing, key, wrap(_answering(inner)))
    return names.copy


def _answering(function: Callable[_P, _T]) -> Callable[_P, _T]:
    if hasattr(function, "answers"):
        return function

    @functools.wraps(function)
    def call(*args: _P.args, **kwargs: _P.kwargs) -> _T:
        try:
            return function(*args, **kwargs)
        except TypeError:
            _check(function, args, kwargs)
            raise

    call.answers = True  # type: ignore[attr-defined]
    return call


def _check(function: Callable[..., Any], args: tuple[Any, ...], given: dict[str, Any]) -> None:
    """Refuse arguments that a function does not have, and too few of them."""
    signature = inspect.signature(function)
    known = [name for name in signature.parameters if name not in ("self", "cls")]
    *_, owner, name = f".{function.__qualname__}".split(".")
    name, listed = owner if name == "__init__" else name, shortened(", ".join(known), 120)
    try:
        signature.bind(*args, **given)
    except TypeError as error:
        if word := next((word for word in given if word not in known), None):
            meant = MEANT.get(word) if MEANT.get(word) in known else closest(word, known)
            advice = f"{meant}=..." if meant else ""
            raise CallError(name, expected=f"one of {listed}", got=repr(word), advice=advice) from None
        raise CallError(name, expected=f"the arguments {listed}", got=error) from None
