"""Studies: open questions, each with the campaigns that answer it, a verdict and a figure."""

from pathlib import Path

from asperity_research import doors
from asperity_research.studies.activated_creep import ACTIVATED_CREEP
from asperity_research.studies.campaigns import run_campaigns
from asperity_research.studies.growth_rate import GROWTH_RATE
from asperity_research.studies.logarithm import LOGARITHM
from asperity_research.studies.patch_sizes import PATCH_SIZES
from asperity_research.studies.pmma import PMMA
from asperity_research.studies.release import RELEASE
from asperity_research.studies.slide_hold_slide import SLIDE_HOLD_SLIDE
from asperity_research.studies.study import Concluded, Inquiry, Outcome, Study, conclude
from asperity_research.studies.unloading import UNLOADING

_ALL = (UNLOADING, LOGARITHM, GROWTH_RATE, RELEASE, SLIDE_HOLD_SLIDE, PATCH_SIZES, ACTIVATED_CREEP, PMMA)
STUDIES = {study.name: study for study in _ALL}  # All studies by name, in the order of the list
__all__ = ["STUDIES", "Concluded", "Outcome", "Study", "conclude", "named", "run"]


def named(name: str) -> Study:
    """Return a study by its name; `InputError` if there is none."""
    return doors.named("study", name, STUDIES, "asperity study, which lists them")


def run(
    study: Inquiry | str,
    directory: str | Path,
    *,
    quick: bool = False,
    seed: int = 0,
    workers: int | None = None,
    command: str = "asperity_research.studies.run",
) -> Concluded:
    """Run what is missing of a study, and write its report.

    Parameters
    ----------
    study
        A study or its name, such as ``"unloading"``; or `asperity_research.paper.reproduce.PAPER`.
    directory
        Its folder; made, or gone on with.
    quick
        The smaller effort.
    seed
        First seed of every ensemble.
    workers
        Worker processes on this machine; by default its cores.
    command
        The command, for the report.

    Raises
    ------
    AsperityError
        There is no such study; or as `asperity_research.studies.campaigns.prepared_in`, `run_campaigns` and
        `conclude`.
    """
    chosen = study if isinstance(study, Inquiry) else named(study)
    with chosen.prepared_in(directory, quick=quick, seed=seed) as prepared:
        run_campaigns(prepared, workers=workers)
        return conclude(chosen, directory, prepared, quick=quick, command=command, seed=seed)


__dir__ = __all__.copy  # dir() lists the public names alone
