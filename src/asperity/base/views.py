"""Views of results: one line, Datasets, pictures, and HTML in notebooks.

A contact cannot import carried quantities, Datasets and figures, which come after it. The rooms `carried`,
`results` and `figures` register their functions here, and are imported at the first use.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Sized
from dataclasses import fields
from typing import TYPE_CHECKING, Any, TypeVar

from asperity.base.calls import showing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_Maker = TypeVar("_Maker", bound=Callable[..., Any])
_MAKERS: dict[str, Callable[..., Any]] = {}


def maker(function: _Maker) -> _Maker:
    """Register a function by its name."""
    _MAKERS[function.__name__] = function
    return function


def made_by(name: str) -> Callable[..., Any]:
    """Return the registered function of a name."""
    for room in ("asperity.carried", "asperity.results", "asperity.figures"):
        if name not in _MAKERS:
            importlib.import_module(room)
    return _MAKERS[name]


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

    def plot(self, kind: str | None = None, ax: Axes | None = None) -> Axes:
        """Draw one kind of picture, by default the first, into these axes or new ones.

        Kinds, result and errors are those of `asperity.figures.plot_kind`.
        """
        axes: Axes = made_by("plot_kind")(self, kind, ax)
        return axes


class InNotebooks:
    """Base of results with a card in notebooks: picture, numbers with units, certificate."""

    def _repr_html_(self) -> str | None:
        html: str | None = None  # a notebook shows the repr
        with showing("the card"):
            html = made_by("html_of")(self)
        return html
