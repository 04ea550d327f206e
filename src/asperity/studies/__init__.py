"""Studies: open questions, each with the campaigns that answer it, a verdict and a figure."""

from __future__ import annotations

from asperity.errors import InputError
from asperity.studies.logarithm import LOGARITHM
from asperity.studies.patch_sizes import PATCH_SIZES
from asperity.studies.release import RELEASE
from asperity.studies.slide_hold_slide import SLIDE_HOLD_SLIDE
from asperity.studies.study import Concluded, Outcome, Study, conclude, run
from asperity.studies.unloading import UNLOADING
from asperity.words import closest

_ALL = (UNLOADING, LOGARITHM, RELEASE, SLIDE_HOLD_SLIDE, PATCH_SIZES)
STUDIES = {study.name: study for study in _ALL}
"""All studies by name, in the order of the list."""

__all__ = ["STUDIES", "Concluded", "Outcome", "Study", "conclude", "named", "run"]


def named(name: str) -> Study:
    """Return a study by its name.

    Raises
    ------
    InputError
        There is none of that name.
    """
    if name not in STUDIES:
        meant = closest(name, STUDIES) or "asperity study, which lists them"
        raise InputError("study", expected=" or ".join(STUDIES), got=name, advice=meant)
    return STUDIES[name]


def __dir__() -> list[str]:
    """List the public names."""
    return __all__
