"""Asperity: how the real contact between rough solids grows old.

The whole vocabulary::

    rough   = asp.surfaces.gaussian((200, 200), rms=1.0, seed=0)
    solid   = asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0)
    contact = asp.press(rough, solid, load=800.0)
    history = asp.age(contact, times=np.geomspace(1e-3, 1e6, 37))
    limit   = asp.relax(contact)

with `asp.theory` and `asp.fits` to judge the results by, `asp.results` to keep them, and `asp.campaign` to
do thousands of them.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

from asperity._version import __version__

if TYPE_CHECKING:
    from asperity import campaign, errors, fits, results, solids, surfaces, theory
    from asperity.aging import relax
    from asperity.contact import Contact, press
    from asperity.results import History, age

__all__ = [
    "Contact",
    "History",
    "__version__",
    "age",
    "campaign",
    "errors",
    "fits",
    "press",
    "relax",
    "results",
    "solids",
    "surfaces",
    "theory",
]

_HOME = {
    "Contact": "asperity.contact",
    "History": "asperity.results",
    "age": "asperity.results",
    "press": "asperity.contact",
    "relax": "asperity.aging",
}


def __getattr__(name: str) -> object:
    """Import a public name when it is first used, so that the command line starts at once."""
    if name in _HOME:
        return getattr(importlib.import_module(_HOME[name]), name)
    if name in __all__:
        return importlib.import_module(f"asperity.{name}")
    raise AttributeError(f"module 'asperity' has no attribute {name!r}")


def __dir__() -> list[str]:
    """List the public names."""
    return sorted(__all__)
