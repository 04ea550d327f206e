"""Views of results: one line, pictures, and HTML in notebooks; and methods that rooms above define.

A contact cannot import carried quantities, Datasets and figures, which come after it. It states such a method
with its types and its text, and a room above defines it.
"""

from __future__ import annotations

import functools
import importlib
import inspect
from collections.abc import Callable, Sized
from dataclasses import fields
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from asperity.base.calls import showing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_P = ParamSpec("_P")
_R = TypeVar("_R")
_DEFINED: dict[Callable[..., Any], Callable[..., Any]] = {}

rooms: list[str] = []
"""Rooms that define methods of those before them, in their order; the package names them."""


def later(stub: Callable[_P, _R]) -> Callable[_P, _R]:
    """Let a room above define a method; what it does is imported at the first call."""

    @functools.wraps(stub)
    def call(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        for room in rooms:
            if stub not in _DEFINED:
                importlib.import_module(room)
        found: _R = _DEFINED[stub](*args, **kwargs)
        return found

    return call


def defines(method: Callable[_P, _R]) -> Callable[[Callable[_P, _R]], Callable[_P, _R]]:
    """Define a method of a room before this one, by a function of the same types."""

    def define(function: Callable[_P, _R]) -> Callable[_P, _R]:
        _DEFINED[inspect.unwrap(method)] = function
        return function

    return define


class Brief:
    """Base of dataclasses with arrays and ``repr=False``: a repr of one line."""

    def __repr__(self) -> str:
        names = (field.name for field in fields(self) if field.repr)  # type: ignore[arg-type]
        text = ", ".join(f"{name} {_brief(getattr(self, name))}" for name in names)
        return f"<{type(self).__name__}: {text}>"


def _brief(value: object) -> str:
    shape = getattr(value, "shape", None)
    if shape:
        return f"[{' x '.join(map(str, shape))}]"
    if isinstance(value, float):
        return f"{value:.6g}"
    if value is None or isinstance(value, int | str):
        return repr(value)
    return f"{type(value).__name__} of {len(value)}" if isinstance(value, Sized) else type(value).__name__


class Pictured:
    """Base of results that `asperity.figures` can plot."""

    @later
    def plot(self, /, kind: str | None = None, ax: Axes | None = None) -> Axes:
        """Draw one kind of picture, by default the first, into these axes or new ones.

        Kinds, result and errors are those of `asperity.figures.plot_kind`.
        """
        raise NotImplementedError


class InNotebooks:
    """Base of results with a card in notebooks: picture, numbers with units, certificate."""

    def _repr_html_(self) -> str | None:
        html: str | None = None  # a notebook shows the repr
        with showing("the card"):
            html = self._html()
        return html

    @later
    def _html(self, /) -> str:
        raise NotImplementedError
