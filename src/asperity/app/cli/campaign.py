"""The commands ``asperity sweep``, ``status`` and ``gather``."""

from __future__ import annotations

import shlex
import sys
import time as clock
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.progress import Progress as Bar

import asperity.app.campaign as campaign
from asperity.app.campaign import Plan, Tally
from asperity.app.campaign.gather import with_ends
from asperity.app.campaign.plan import Run, name_of
from asperity.app.cli.options import Work
from asperity.app.cli.output import write_figure
from asperity.app.cli.report import aligned
from asperity.base.tables import with_unit
from asperity.base.words import counted, data_size, duration
from asperity.errors import AsperityError, InputError
from asperity.figures import campaign_figure
from asperity.results import save
from asperity.results.store import whole_file

_LINE_EVERY = 10.0
"""Seconds between two plain lines of progress."""

_SHOWN_FAILURES = 10


def dry_run(plan: Plan, out: Path, _: Work) -> None:
    """Say what a campaign would do."""
    left = campaign.estimate(plan, out)
    rows = [
        ("runs", f"{len({run.identity for run in plan.runs})}, of which {left.runs} are to do"),
        ("dimensions", _dimensions(plan)),
    ]
    if left.runs:
        rows += [
            ("memory", f"about {data_size(left.memory)} for the largest run, one on each worker"),
            ("disk", f"about {data_size(left.bytes)}"),
        ]
    sys.stdout.write(f"{aligned(rows)}\n")


def sweep(plan: Plan, out: Path, work: Work) -> None:
    """Do what is missing, and say how it ended.

    `AsperityError` if the disk or the scheduler refused; or some runs failed, after all others were done.
    """
    _check_out(out)
    before = campaign.tally(plan, out)
    idle = before.done + (0 if work.retry_failed else before.failed) == before.total
    try:
        with tally_shown(quiet=work.quiet) as show:
            end = campaign.sweep(
                plan,
                out,
                workers=work.workers,
                scheduler=work.scheduler,
                retry_failed=work.retry_failed,
                progress=show,
            )
    except KeyboardInterrupt:
        done = campaign.tally(plan, out).done
        raise KeyboardInterrupt(
            f"interrupted; {done} runs are done and kept, and the same command does the rest"
        ) from None
    if not work.quiet:
        unasked = ("scheduler", f"{work.scheduler} was not asked: there was nothing to do")
        told = _tally_told(plan, end, *[unasked] * (idle and work.scheduler is not None))
        sys.stdout.write(f"{told}\n")
    if end.failed:
        why = shlex.join(("asperity", "status", str(out)))
        raise AsperityError(
            f"{end.failed} of {end.total} runs failed: {why} says why; try again with --retry-failed"
        )


def status(out: Path) -> None:
    """Say how far a campaign is."""
    plan = campaign.load_plan(out)
    sys.stdout.write(f"{_tally_told(plan, campaign.tally(plan, out))}\n")


def gather(out: Path, *, to: Path | None, overwrite: bool) -> None:
    """Write a campaign's Dataset, a table of its runs, and a figure of their growth; else `AsperityError`."""
    dataset = campaign.open(out)
    target = out / "gathered.zarr" if to is None else to
    if target.suffix not in (".zarr", ".nc"):
        raise InputError("--to", expected="a name that ends in .zarr, or in .nc for netCDF", got=target)
    # Gathering again, with more runs, is what one does: the default place is always replaced.
    replace = overwrite or to is None
    csv, picture = target.with_suffix(".csv"), target.with_suffix(".png")
    for there in (csv, picture, *[target] * (target.suffix == ".nc")):
        if there.exists() and not replace:
            raise InputError("--to", expected="a new name", got=f"{there} exists", advice="--overwrite")
    if target.suffix == ".nc":
        with whole_file(target) as part:
            dataset.to_netcdf(part)
    else:
        save(dataset, target, overwrite=replace)
    runs = campaign.table(dataset)
    if dataset["time"].attrs["units"] == "s":
        ends = with_ends(dataset)
        runs = runs.rename(columns=lambda name: with_unit(name, ends[name].attrs.get("units") or "1"))
    with whole_file(csv) as part:
        runs.to_csv(part, index=False)
    sizes = ", ".join(f"{name} {size}" for name, size in dataset.sizes.items())
    opener = "asp.results.load" if target.suffix == ".zarr" else "xarray.open_dataset"
    rows = [
        ("finished", f"{dataset.attrs['finished']} of {dataset.attrs['runs']} runs"),
        ("dimensions", sizes),
        ("written", f"{target}: all series and their ensemble; {opener} opens it"),
        ("", f"{csv}: one row a run, {len(runs)} rows"),
    ]
    if float(dataset["time"].max()) > 0:
        write_figure(campaign_figure(dataset), picture)
        rows.append(("", f"{picture}: growth of the contact, with standard errors"))
    sys.stdout.write(f"{aligned(rows)}\n")


def _check_out(out: Path) -> None:
    """Refuse a folder that holds something else."""
    if out.exists() and not out.is_dir():
        raise InputError("--out", expected="a folder", got=f"{out}, which is a file")
    # Listed once: another campaign may be filling the folder at this very moment.
    found = [path.name.lstrip(".") for path in out.iterdir()] if out.exists() else []
    ours = any(name.startswith(("plan.json", "runs.zarr")) for name in found) or (
        (out / "state" / "locks").is_dir()
    )
    if found and not ours:
        raise InputError(
            "--out",
            expected="a new folder, or that of a campaign",
            got=f"{out}, which holds something else and is kept",
            advice="another name",
        )


def _tally_told(plan: Plan, end: Tally, *more: tuple[str, str]) -> str:
    """A table of the tally, and a line for all runs that failed alike."""
    rows = [
        ("runs", str(end.total)),
        ("done", str(end.done)),
        ("running", str(end.running)),
        ("failed", str(end.failed)),
        ("left", str(end.left)),
    ]
    alike: dict[str, list[Run]] = {}
    for run in {run.identity: run for run in plan.runs if run.identity in end.reasons}.values():
        alike.setdefault(end.reasons[run.identity], []).append(run)
    lines = [aligned([*rows, *more])]
    for reason, runs in list(alike.items())[:_SHOWN_FAILURES]:
        which = runs[0].identity if len(runs) == 1 else f"{len(runs)} runs, the first {runs[0].identity}"
        lines.append(f"{name_of(plan, *runs)} ({which}): {reason}")
    if len(alike) > _SHOWN_FAILURES:
        lines.append(f"... and {sum(map(len, list(alike.values())[_SHOWN_FAILURES:]))} more")
    return "\n".join(lines)


@contextmanager
def tally_shown(*, quiet: bool) -> Iterator[Callable[[Tally], None]]:
    """Progress with the time left: a bar on a terminal, lines elsewhere."""
    if quiet:
        yield lambda _: None
    elif sys.stderr.isatty():
        columns = (
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(),
        )
        with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
            task = bar.add_task("runs", total=None)
            yield lambda now: bar.update(
                task, total=now.total, completed=now.done + now.failed, description=_words(now)
            )
    else:
        yield _Lines().say


class _Lines:
    """A line at the start, one when workers are there, one every few seconds, one at the end.

    The time left is that of the runs after the first one to end: before that workers start and loops compile.
    """

    def __init__(self) -> None:
        self.last = clock.monotonic()
        self.begin, self.over_at_start, self.over_at_begin = 0.0, 0, 0
        self.calls = 0

    def say(self, now: Tally) -> None:
        over, moment = now.done + now.failed, clock.monotonic()
        self.calls += 1
        if self.calls == 1:
            self.over_at_start = over
        if over <= self.over_at_start + 1:
            self.begin, self.over_at_begin = moment, over
        if self.calls <= 2 or over == now.total or moment - self.last >= _LINE_EVERY:
            self.last = moment
            fresh = over - self.over_at_begin
            left = (now.total - over) * (moment - self.begin) / fresh if fresh else None
            estimate = f", about {duration(left)} left" if left else ""
            print(f"{_words(now)}: {over} of {now.total}{estimate}", file=sys.stderr, flush=True)


def _words(now: Tally) -> str:
    at_work = f" on {counted(now.workers, 'worker')}" if now.workers else ""
    return f"runs{at_work}, {now.failed} failed" if now.failed else f"runs{at_work}"


def _dimensions(plan: Plan) -> str:
    axes = [f"{axis.name} ({len(axis.values)})" for axis in plan.axes]
    joined = (", " if plan.zipped else " x ").join(axes)
    parts = [f"{joined} pairwise" if plan.zipped and axes else joined] if axes else []
    if plan.seeds:
        parts.append(f"seed ({len(plan.seeds)})")
    return " x ".join(parts) or "a single run"
