"""Reproduce the paper: run the studies, draw the figures, judge the claims, write the report."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from filelock import FileLock, Timeout

import asperity.campaign as campaign
from asperity._version import __version__
from asperity.campaign import Plan, Tally
from asperity.errors import AsperityError, InputError, OutputError
from asperity.paper.claims import ledger
from asperity.paper.evidence import Evidence
from asperity.paper.figures import draw
from asperity.paper.ledger import Finding
from asperity.paper.report import About, Simulated, write_report
from asperity.paper.studies import Effort, Study, studies
from asperity.results.store import whole_file

STUDIES = "studies"
"""Folder of the campaigns, in that of the reproduction."""


@dataclass(frozen=True)
class Prepared:
    """A study that is ready to run.

    Attributes
    ----------
    study
        What it is.
    plan
        Its runs.
    folder
        Where they go.
    """

    study: Study
    plan: Plan
    folder: Path


@dataclass(frozen=True)
class Reproduction:
    """What came out.

    Attributes
    ----------
    report
        The page to read.
    findings
        The lines of its ledger.
    """

    report: Path
    findings: tuple[Finding, ...]


@contextmanager
def prepared_in(directory: str | Path, effort: Effort, *, seed: int = 0) -> Iterator[tuple[Prepared, ...]]:
    """Write the campaign files of all studies, and keep other reproductions out of the folder.

    Parameters
    ----------
    directory
        The folder; made, or gone on with.
    effort
        How much to compute.
    seed
        First seed of every ensemble.

    Raises
    ------
    InputError
        The folder holds something else, or a reproduction with another seed, or one is at work there; or
        the seed is negative.
    OutputError
        The disk refused.
    """
    folder = Path(directory)
    wanted = studies(effort, seed=seed)
    check_folder(folder)
    with _alone(folder / STUDIES):
        _claim(folder / STUDIES / "seed", seed)
        yield tuple(_prepared(study, folder / STUDIES / study.name) for study in wanted)


def _prepared(study: Study, home: Path) -> Prepared:
    try:
        return Prepared(study, study.write(home), home)
    except OSError as error:
        raise OutputError(f"cannot write {home}: {error.strerror or error}") from error


def check_folder(folder: Path) -> None:
    """Refuse a folder that holds something else than a reproduction; `InputError`."""
    if folder.exists() and not folder.is_dir():
        raise InputError("--out", expected="a folder", got=f"{folder}, which is a file")
    if folder.exists() and any(folder.iterdir()) and not (folder / STUDIES / "seed").is_file():
        raise InputError(
            "--out",
            expected="a new folder, or that of a reproduction",
            got=f"{folder}, which holds something else and is kept",
            advice="another name",
        )


def _claim(mark: Path, seed: int) -> None:
    """Mark the folder as this reproduction's, or find that it is another's, of other surfaces."""
    if mark.exists() and (owner := mark.read_text(encoding="utf-8").strip()) != str(seed):
        raise InputError(
            "--out",
            expected="a new folder, or that of a reproduction with this seed",
            got=f"{mark.parent.parent}, which is that of --seed {owner}",
            advice="another name",
        )
    with whole_file(mark) as part:
        part.write_text(f"{seed}\n", encoding="utf-8")


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = FileLock(folder / "lock")
        lock.acquire(blocking=False)
    except Timeout as error:
        raise InputError(
            "--out",
            expected="a folder that nothing is at work on",
            got=f"{folder.parent}, which another reproduction is writing",
            advice="waiting, or another name",
        ) from error
    except OSError as error:
        raise OutputError(f"cannot write {folder}: {error.strerror or error}") from error
    try:
        yield
    finally:
        lock.release()


def run_studies(
    prepared: Sequence[Prepared],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    retry_failed: bool = False,
    watch: Callable[[Prepared], AbstractContextManager[Callable[[Tally], None]]],
) -> None:
    """Do what is missing of every study.

    Parameters
    ----------
    prepared
        From `prepared_in`.
    workers, scheduler, retry_failed
        As `asperity.campaign.sweep`.
    watch
        Entered for each study that has runs to do, until they are done; gives what is told the tally
        after every run.

    Raises
    ------
    AsperityError
        The disk or the scheduler refused; or some runs failed, after all others were done.
    """
    failed = []
    for one in prepared:
        before = campaign.tally(one.plan, one.folder)
        # A finished study is swept too, which takes no time: its folder may hold another plan.
        with watch(one) if before.done < before.total else nullcontext() as progress:
            now = campaign.sweep(
                one.plan,
                one.folder,
                workers=workers,
                scheduler=scheduler,
                retry_failed=retry_failed,
                progress=progress,
            )
        if now.done < now.total:
            failed.append(one)
    if failed:
        names = ", ".join(f"asperity status {one.folder}" for one in failed)
        raise AsperityError(f"some runs failed ({names} say why); --retry-failed tries them again")


def conclude(
    directory: str | Path, prepared: Sequence[Prepared], *, effort: Effort, command: str, seconds: float
) -> Reproduction:
    """Draw the figures, judge the claims and write the report, from studies that are finished.

    Parameters
    ----------
    directory
        The folder of the reproduction.
    prepared
        From `prepared_in`.
    effort
        How much was computed.
    command
        The command that did it, for the report.
    seconds
        How long it took.

    Raises
    ------
    AsperityError
        A study is not finished; or the disk refused. An earlier report stays.
    """
    folder = Path(directory)
    evidence = Evidence(folder / STUDIES)
    finished = {one.study.name: evidence[one.study.name].attrs["finished"] for one in prepared}
    for one in prepared:
        if finished[one.study.name] < len({run.identity for run in one.plan.runs}):
            raise AsperityError(f"{one.folder} is not finished: asperity status says what is left")
    findings = ledger(evidence)
    about = About(
        effort=effort.name,
        version=__version__,
        date=datetime.now(UTC).date(),
        command=command,
        wall_seconds=seconds,
        run_seconds=sum(float(evidence[one.study.name]["seconds"].sum()) for one in prepared),
        studies=tuple(
            Simulated(one.study, finished[one.study.name], f"{STUDIES}/{one.study.name}") for one in prepared
        ),
    )
    return Reproduction(write_report(folder, draw(evidence), findings, about), findings)
