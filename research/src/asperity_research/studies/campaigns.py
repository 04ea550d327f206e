"""The campaigns of a study: ordinary files of ``asperity sweep`` in one folder, and the running of them."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Self

import numpy as np
import tomli_w
from filelock import FileLock, Timeout

import asperity as asp
from asperity.errors import AsperityError, InputError, OutputError
from asperity.results import whole_file
from asperity_research.arrays import Field
from asperity_research.studies.evidence import Evidence

Tables = Mapping[str, Any]
Told = Callable[[asp.campaign.Tally], None]  # What is told how many runs are done


@dataclass(frozen=True)
class Campaign:
    """One campaign: the name of its folder, what it is for, and its file, section by section.

    ``heights`` are surfaces that it reads, by the names of their files (.npy).
    """

    name: str
    purpose: str
    tables: Tables
    heights: Mapping[str, Field] = field(default_factory=dict)

    def write(self, folder: Path) -> asp.campaign.Plan:
        """Write the campaign file, and its surfaces if it has any, and read the plan back.

        `OutputError` if the disk refused.
        """
        try:
            folder.mkdir(parents=True, exist_ok=True)
            for name, heights in self.heights.items():
                with whole_file(folder / name) as part, part.open("wb") as stream:
                    np.save(stream, heights)
            path = folder / "campaign.toml"
            with whole_file(path) as part:
                part.write_text(f"# {self.purpose}\n\n{tomli_w.dumps(self.tables)}", encoding="utf-8")
        except OSError as error:
            raise OutputError(f"cannot write {folder}: {error.strerror or error}") from error
        return asp.campaign.read_plan(path)

    def seeded(self, first: int) -> Self:
        """Return the same campaign with as many surfaces, whose seeds go on from a first one.

        `InputError` for a negative seed, and where the seeds are a list already, not a number of surfaces.
        """
        if first < 0:
            raise InputError("seed", expected="0 or more", got=first)
        sweep = self.tables["sweep"]
        if "seeds" not in sweep:  # a surface from a file
            return self
        if not isinstance(count := sweep["seeds"], int):
            raise InputError(f"seeds of {self.name}", expected="a number of surfaces", got=count)
        seeds = list(range(first, first + count))
        return replace(self, tables={**self.tables, "sweep": {**sweep, "seeds": seeds}})


@dataclass(frozen=True)
class Solid:
    """A solid of a study, in words and as a section of the campaign file, and what is done to it.

    ``load`` is that of a site at first, or the separation where that is prescribed; ``waits`` are waiting
    times before a step; ``steps`` loads after it over that before, or by how much the bodies move apart.
    """

    what: str
    table: Tables
    load: float
    waits: Sequence[float] = ()
    steps: Sequence[float] = ()

    @property
    def rough(self) -> dict[str, float]:
        """What of the heights is 1: their slope where there is a modulus, else their height."""
        return {"rms_slope" if "modulus" in self.table else "rms_height": 1.0}

    def campaign(self, name: str, purpose: str, surface: Tables, **tables: Any) -> Campaign:
        """Return one on this solid, under its load unless the tables have another contact; without maps.

        A point in the name of its folder becomes an underscore; the words of the solid follow the purpose.
        """
        contact = {"load": self.load * math.prod(surface["shape"])}
        shared = {"surface": surface, "solid": self.table, "contact": contact, "output": {"maps_at": []}}
        return Campaign(name.replace(".", "_"), f"{purpose}: {self.what}", shared | tables)


def waves(side: int, roll_off: float, cutoff: float = 4.0, **more: float) -> dict[str, Any]:
    """Return the table of a square surface of waves, with the Hurst exponent 0.8 unless there is another."""
    shape = {"kind": "spectral", "shape": [side, side]}
    return {**shape, "hurst": 0.8, "roll_off": roll_off, "cutoff": cutoff, **more}


def scanned(side: int, spacing: float, unit: str, hurst: float, **more: float) -> dict[str, Any]:
    """Return the table of a square surface of waves with lengths, as a scan has."""
    shape = {"kind": "spectral", "shape": [side, side], "spacing": [spacing], "unit": unit}
    return {**shape, "hurst": hurst, **more}


def hold(duration: float, **more: Any) -> dict[str, Any]:
    """Return the table of a hold."""
    return {"kind": "hold", "duration": duration, **more}


def slide(distance: float, velocity: float = 1.0) -> dict[str, Any]:
    """Return the table of a slide."""
    return {"kind": "slide", "distance": float(distance), "velocity": velocity}


def zipped(seeds: int, **values: Sequence[float]) -> dict[str, Any]:
    """Return the table of a sweep in which the values of several keys go together."""
    return {**{key: list(some) for key, some in values.items()}, "seeds": seeds, "combine": "zip"}


def after_waits(
    step: Mapping[str, float], waits: Sequence[float], duration: float, surfaces: int
) -> dict[str, Any]:
    """Return the tables of a hold for each waiting time, a step as in a leg, and a hold; times over waits.

    Creep t_w times as fast for a time of 1 is creep for t_w: waiting times are factors on creep.
    """
    legs = [hold(1.0), {"kind": "step", **step}, hold(duration)]
    factors = {f"protocol.{leg}.mobility": waits for leg in (0, 2)}
    return {"protocol": legs, "sweep": zipped(surfaces, **factors)}


@dataclass(frozen=True)
class Prepared:
    """A campaign that is ready to run, with its runs and the folder that they go to."""

    campaign: Campaign
    plan: asp.campaign.Plan
    folder: Path


@dataclass(frozen=True)
class Home:
    """Whose folder it is, such as ``"a reproduction"``, and the folder of the campaigns inside of it."""

    owner: str
    inside: str

    def check(self, folder: Path) -> None:
        """Refuse a folder that holds something else; `InputError`."""
        if folder.exists() and not folder.is_dir():
            raise InputError("--out", expected="a folder", got=f"{folder}, which is a file")
        if folder.exists() and any(folder.iterdir()) and not (folder / self.inside / "seed").is_file():
            expected, got = f"a new folder, or that of {self.owner}", "which holds something else and is kept"
            raise _taken(expected, f"{folder}, {got}")

    @contextmanager
    def alone(self, folder: Path, seed: int) -> Iterator[None]:
        """Keep others out of the folder, and mark it as one of this seed: another's has other surfaces."""
        inside = folder / self.inside
        try:
            inside.mkdir(parents=True, exist_ok=True)
            lock = FileLock(inside / "lock")
            lock.acquire(blocking=False)
        except Timeout as error:
            kind = self.owner.removeprefix("a ").removeprefix("the ")
            expected, got = "a folder that nothing is at work on", f"which another {kind} is writing"
            raise _taken(expected, f"{folder}, {got}", "waiting, or another name") from error
        except OSError as error:
            raise OutputError(f"cannot write {inside}: {error.strerror or error}") from error
        try:
            mark = inside / "seed"
            if mark.exists() and (other := mark.read_text(encoding="utf-8").strip()) != str(seed):
                expected = f"a new folder, or that of {self.owner} with this seed"
                raise _taken(expected, f"{folder}, which is that of --seed {other}")
            with whole_file(mark) as part:
                part.write_text(f"{seed}\n", encoding="utf-8")
            yield
        finally:
            lock.release()


def _taken(expected: str, got: str, advice: str = "another name") -> InputError:
    return InputError("--out", expected=expected, got=got, advice=advice)


@contextmanager
def prepared_in(
    directory: str | Path, campaigns: Sequence[Campaign], home: Home, *, seed: int = 0
) -> Iterator[tuple[Prepared, ...]]:
    """Write the campaign files, of ensembles from a first seed on, and keep others out of the folder.

    `InputError` if the folder holds something else, or is of another seed, or something is at work there, or
    the seed is negative; `OutputError` if the disk refused.
    """
    folder = Path(directory)
    wanted = [one.seeded(seed) for one in campaigns]
    home.check(folder)
    with home.alone(folder, seed):
        places = [(one, folder / home.inside / one.name) for one in wanted]
        yield tuple(Prepared(one, one.write(place), place) for one, place in places)


def run_campaigns(
    prepared: Sequence[Prepared],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    retry_failed: bool = False,
    watch: Callable[[Prepared], AbstractContextManager[Told | None]] | None = None,
) -> None:
    """Do what is missing of every campaign; workers, scheduler and retrying are those of a sweep.

    ``watch`` is entered for each campaign that has runs to do, until they are done, and gives what is told
    the tally after every run. `AsperityError` if the disk or the scheduler refused, or if some runs failed,
    after all others were done.
    """
    failed = []
    how: dict[str, Any] = {"workers": workers, "scheduler": scheduler, "retry_failed": retry_failed}
    for one in prepared:
        before = asp.campaign.tally(one.plan, one.folder)
        # A finished campaign is swept too, which takes no time: its folder may hold another plan.
        with nullcontext() if watch is None or before.done == before.total else watch(one) as progress:
            now = asp.campaign.sweep(one.plan, one.folder, progress=progress, **how)
        if now.done < now.total:
            failed.append(one)
    if failed:
        names = ", ".join(f"asperity status {one.folder}" for one in failed)
        raise AsperityError(f"some runs failed ({names} say why); --retry-failed tries them again")


def finished(evidence: Evidence, prepared: Sequence[Prepared]) -> dict[str, int]:
    """Return the number of finished runs of every campaign, by name.

    `AsperityError` if a campaign is not finished.
    """
    counts = {one.campaign.name: int(evidence[one.campaign.name].attrs["finished"]) for one in prepared}
    for one in prepared:
        if counts[one.campaign.name] < len({run.identity for run in one.plan.runs}):
            raise AsperityError(f"{one.folder} is not finished: asperity status says what is left")
    return counts
