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
import importlib.util
from typing import TYPE_CHECKING

from asperity.base import views as _views
from asperity.base.version import __version__

if TYPE_CHECKING:
    from asperity import (
        analysis,
        contact_law,
        errors,
        figures,
        fits,
        friction,
        inference,
        prediction,
        protocols,
        relaxation,
        results,
        sliding,
        solids,
        surfaces,
        theory,
    )
    from asperity.aging import Frame
    from asperity.analysis import observe
    from asperity.app import campaign
    from asperity.carried import Carried
    from asperity.contact import ActiveSet, Contact, Load, Multigrid, Separation
    from asperity.contact_law import law
    from asperity.inference import infer
    from asperity.prediction import predict
    from asperity.results import Checkpoint, History
    from asperity.simulate import age, press, pull, relax, slide
    from asperity.sliding import steady_sliding

__all__ = [
    "ActiveSet",
    "Carried",
    "Checkpoint",
    "Contact",
    "Frame",
    "History",
    "Load",
    "Multigrid",
    "Separation",
    "__version__",
    "age",
    "analysis",
    "campaign",
    "contact_law",
    "errors",
    "figures",
    "fits",
    "friction",
    "infer",
    "inference",
    "law",
    "observe",
    "predict",
    "prediction",
    "press",
    "protocols",
    "pull",
    "relax",
    "relaxation",
    "results",
    "slide",
    "sliding",
    "solids",
    "steady_sliding",
    "surfaces",
    "theory",
]

_HOME = {
    "asperity.aging": ("Frame",),
    "asperity.analysis": ("observe",),
    "asperity.carried": ("Carried",),
    "asperity.contact": ("ActiveSet", "Contact", "Load", "Multigrid", "Separation"),
    "asperity.contact_law": ("law",),
    "asperity.inference": ("infer",),
    "asperity.prediction": ("predict",),
    "asperity.results": ("Checkpoint", "History"),
    "asperity.simulate": ("age", "press", "pull", "relax", "slide"),
    "asperity.sliding": ("steady_sliding",),
}
_views.rooms += ["asperity.ask.files", "asperity.carried", "asperity.results", "asperity.analysis.rows"]
_views.rooms += ["asperity.figures"]

_RESEARCH = ("challenge", "experiments", "studies")
"""Rooms that the distribution asperity-research adds, by entry points."""

if not TYPE_CHECKING:  # for a type checker, a name that is not above does not exist

    def __getattr__(name):
        """Import a public name, or any room, when it is first used: the command line starts at once."""
        for home, names in _HOME.items():
            if name in names:
                return getattr(importlib.import_module(home), name)
        for place in () if name.startswith("_") else ("asperity", "asperity.app"):
            if importlib.util.find_spec(f"{place}.{name}") is not None:
                return importlib.import_module(f"{place}.{name}")
        missing = f"module 'asperity' has no attribute {name!r}"
        if name in _RESEARCH:
            from importlib.metadata import entry_points

            for entry in entry_points(group="asperity.rooms", name=name):
                return entry.load()
            from asperity.base.checks import installed_from

            missing += "; it comes with asperity-research; try pip install "
            missing += installed_from("asperity-research")
        raise AttributeError(missing)


def __dir__() -> list[str]:
    """List the public names."""
    return sorted(__all__)
