"""How results show themselves: in one line, as Datasets, as pictures, and as HTML in notebooks.

A contact knows nothing of figures and Datasets, which come after it. Only when one is asked for does this
module import `asperity.figures` or `asperity.results`. It is the one place where an import points downstream,
and ``tests/unit/test_house.py`` lets no other do so.
"""

from __future__ import annotations

import importlib
from collections.abc import Sized
from dataclasses import fields
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from asperity.figures.cards import html_of
    from asperity.figures.film import Film, animate_history
    from asperity.figures.plots import plot_contact, plot_history, plot_spectrum, plot_surface
    from asperity.results.contacts import contact_dataset
    from asperity.results.store import save

__all__ = [
    "Brief",
    "Film",
    "InNotebooks",
    "animate_history",
    "contact_dataset",
    "html_of",
    "plot_contact",
    "plot_history",
    "plot_spectrum",
    "plot_surface",
    "save",
]
_OF_RESULTS = {"contact_dataset": "asperity.results.contacts", "save": "asperity.results.store"}


def _figures() -> ModuleType:
    return importlib.import_module("asperity.figures")


if not TYPE_CHECKING:

    def __getattr__(name):
        """Import what draws or saves, when it is first used."""
        if name not in __all__:
            raise AttributeError(f"module 'asperity.views' has no attribute {name!r}")
        return getattr(importlib.import_module(_OF_RESULTS.get(name, "asperity.figures")), name)


class Brief:
    """A base of dataclasses with arrays, made with ``repr=False``: says in one line what it holds."""

    def __repr__(self) -> str:
        names = (field.name for field in fields(self))  # type: ignore[arg-type]
        said = ", ".join(f"{name} {_brief(getattr(self, name))}" for name in names)
        return f"<{type(self).__name__}: {said}>"


def _brief(value: object) -> str:
    """A value in a few characters: an array by its shape."""
    shape = getattr(value, "shape", None)
    if shape:
        return f"[{' x '.join(map(str, shape))}]"
    if isinstance(value, float):
        return f"{value:.6g}"
    if value is None or isinstance(value, int | str):
        return repr(value)
    return f"{type(value).__name__} of {len(value)}" if isinstance(value, Sized) else type(value).__name__


class InNotebooks:
    """What a notebook shows as a small picture and numbers with units, with its certificate if it has one."""

    def _repr_html_(self) -> str:
        html: str = _figures().html_of(self)
        return html
