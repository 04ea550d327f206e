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
from asperity.base.calls import outside as _outside
from asperity.base.version import __version__ as __version__

if TYPE_CHECKING:  # `as` is how a type checker knows what is public
    from asperity import analysis as analysis
    from asperity import contact_law as contact_law
    from asperity import errors as errors
    from asperity import figures as figures
    from asperity import fits as fits
    from asperity import friction as friction
    from asperity import inference as inference
    from asperity import prediction as prediction
    from asperity import protocols as protocols
    from asperity import relaxation as relaxation
    from asperity import results as results
    from asperity import sliding as sliding
    from asperity import solids as solids
    from asperity import surfaces as surfaces
    from asperity import theory as theory
    from asperity.aging import Frame as Frame
    from asperity.analysis import observe as observe
    from asperity.app import campaign as campaign
    from asperity.carried import Carried as Carried
    from asperity.contact import ActiveSet as ActiveSet
    from asperity.contact import Contact as Contact
    from asperity.contact import Load as Load
    from asperity.contact import Multigrid as Multigrid
    from asperity.contact import Separation as Separation
    from asperity.contact_law import law as law
    from asperity.inference import infer as infer
    from asperity.prediction import predict as predict
    from asperity.results import Checkpoint as Checkpoint
    from asperity.results import History as History
    from asperity.simulate import age as age
    from asperity.simulate import press as press
    from asperity.simulate import pull as pull
    from asperity.simulate import relax as relax
    from asperity.simulate import slide as slide
    from asperity.sliding import steady_sliding as steady_sliding

_ROOMS = """analysis campaign contact_law errors figures fits friction inference prediction protocols
    relaxation results sliding solids surfaces theory"""
_HOMES = {
    "asperity.aging": "Frame",
    "asperity.analysis": "observe",
    "asperity.carried": "Carried",
    "asperity.contact": "ActiveSet Contact Load Multigrid Separation",
    "asperity.contact_law": "law",
    "asperity.inference": "infer",
    "asperity.prediction": "predict",
    "asperity.results": "Checkpoint History",
    "asperity.simulate": "age press pull relax slide",
    "asperity.sliding": "steady_sliding",
}
_HOME = {name: home for home, names in _HOMES.items() for name in names.split()}
__all__ = sorted(["__version__", *_HOME, *_ROOMS.split()])
_views.rooms += ["asperity.ask.files", "asperity.carried", "asperity.results", "asperity.analysis.rows"]
_views.rooms += ["asperity.figures"]

_RESEARCH = ("challenge", "experiments", "studies")
"""Rooms that the distribution asperity-research adds, by entry points."""

if not TYPE_CHECKING:  # for a type checker, a name that is not above does not exist

    def __getattr__(name):
        """Import a public name, or any room, when it is first used: the command line starts at once."""
        if name in _HOME:
            return getattr(importlib.import_module(_HOME[name]), name)
        for place in () if name.startswith("_") else ("asperity", "asperity.app"):
            if importlib.util.find_spec(f"{place}.{name}") is not None:
                return importlib.import_module(f"{place}.{name}")
        missing = f"module 'asperity' has no attribute {name!r}"
        if name in _RESEARCH:
            for _, room in _outside("asperity.rooms", name):
                return room
            from asperity.base.checks import installed_from

            missing += (
                f"; it comes with asperity-research; try pip install {installed_from('asperity-research')}"
            )
        raise AttributeError(missing)


def __dir__() -> list[str]:
    """List the public names."""
    return __all__.copy()
