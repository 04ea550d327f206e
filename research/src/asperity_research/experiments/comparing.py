"""Simulations beside measured contacts: each comparison is a study, with one more table of its verdicts."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from asperity import surfaces
from asperity.errors import InputError
from asperity_research import doors, studies
from asperity_research.experiments import fracture_2018, gels_2022, p655, pmma_2018, printed_2017, ptfe_2009
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Outcome
from asperity_research.studies.report import About, write_table
from asperity_research.studies.study import Concluded, Study, write_page

_ALL = (
    fracture_2018.FRACTURE_2018,
    gels_2022.GELS_2022,
    p655.P655,
    pmma_2018.PMMA_2018,
    printed_2017.PRINTED_2017,
    ptfe_2009.PTFE_2009,
)
COMPARISONS = {one.name: one for one in _ALL}
"""Studies by the names of the experiments that they stand beside."""

_ON_SCANS = {"pmma-2018": pmma_2018.campaigns, "printed-2017": printed_2017.campaigns}
"""Their campaigns on scans of an rms slope, where that can be."""


def comparison_of(name: str, scans: Sequence[Path] = (), record: Path | None = None) -> Study:
    """Return the study beside an experiment, on scans if there are any in place of surfaces that are made.

    Its folder has ``verdicts.csv``, too: a row a number, with its interval, the range that is claimed, and
    verdict. `InputError` if there is none, it has surfaces of its own, or a scan cannot be read or has no
    unit; or its record is not there.
    """
    return replace(_study_of(name, scans, record), report=_with_verdicts)


def _with_verdicts(study: Study, folder: Path, evidence: Evidence, outcome: Outcome, about: About) -> Path:
    page = write_page(study, folder, evidence, outcome, about)
    write_table(folder, "verdicts", outcome.verdicts())
    return page


def _study_of(name: str, scans: Sequence[Path], record: Path | None) -> Study:
    study = doors.named("experiment", name, COMPARISONS)
    if name == p655.P655.name and not scans:
        return p655.of_record(record)
    if record is not None:
        raise InputError("--record", expected="none, for simulations", got=str(record))
    if name == fracture_2018.FRACTURE_2018.name:
        return fracture_2018.of_files(scans)
    if not scans:
        return study
    if name not in _ON_SCANS:
        got, advice = f"{len(scans)}: this experiment is not about a scan", "leaving it out"
        raise InputError("--surface", expected="none", got=got, advice=advice)
    slopes = []
    for scan in scans:
        surface = surfaces.read(scan, periodic="reflect")
        if not surface.has_lengths:
            raise InputError("--surface", expected="heights and pixels with a unit of length", got=str(scan))
        slopes.append(surfaces.statistics(*surface.in_meters()).rms_slope)
    paths = [str(scan.resolve()) for scan in scans]
    table = {"kind": "file", "path": paths[0], "periodic": "reflect"}
    campaigns = _ON_SCANS[name](table, {"surface.path": paths}, float(np.mean(slopes)))
    return replace(study, quick=campaigns, full=campaigns)


def run(
    name: str,
    directory: str | Path,
    *,
    scans: Sequence[str | Path] = (),
    record: str | Path | None = None,
    quick: bool = False,
    seed: int = 0,
    workers: int | None = None,
) -> Concluded:
    """Simulate an experiment, compare, and write report, figure and verdicts into a folder.

    Parameters
    ----------
    name
        Of the experiment, see `names`.
    directory
        The folder; made, or gone on with.
    scans
        Files of scans of your own, with units, in place of surfaces that are made: each is one sample; or of
        the apertures of each specimen, in order.
    record
        File of a record of friction that is compared, where it is no part of the package.
    quick
        The smaller effort.
    seed
        First seed of the surfaces that are made.
    workers
        Worker processes on this machine; by default its cores.

    Raises
    ------
    AsperityError
        There is no such experiment; a scan cannot be used; or as `asperity_research.studies.run`.
    """
    path = None if record is None else Path(record)
    study = comparison_of(name, [Path(scan) for scan in scans], path)
    return studies.run(study, directory, quick=quick, seed=seed, workers=workers, command=__name__)
