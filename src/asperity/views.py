"""How results show themselves: as pictures, and as HTML in notebooks.

A contact knows nothing of figures, which are made of what comes after it. Only when a picture is asked for
does this module import `asperity.figures`. It is the one place where an import points downstream, and
``tests/unit/test_house.py`` lets no other do so.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from asperity.figures.film import Film, animate_history
    from asperity.figures.plots import plot_contact, plot_history, plot_spectrum, plot_surface

__all__ = ["Film", "animate_history", "plot_contact", "plot_history", "plot_spectrum", "plot_surface"]

if not TYPE_CHECKING:

    def __getattr__(name):
        """Import what draws, when it is first used."""
        if name not in __all__:
            raise AttributeError(f"module 'asperity.views' has no attribute {name!r}")
        return getattr(importlib.import_module("asperity.figures"), name)
