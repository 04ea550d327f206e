"""Sweep a campaign, and print its progress."""

from __future__ import annotations

import functools
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
from asperity.app.campaign.plan import Run, name_of
from asperity.app.cli.options import Work
from asperity.base.files import kind_of
from asperity.base.machine import available
from asperity.base.rows import aligned
from asperity.base.words import counted, data_size, duration
from asperity.errors import AsperityError, InputError
from asperity.progress import LINE_EVERY

_SHOWN_FAILURES = 10


def dry_run(plan: Plan, out: Path, _: Work) -> None:
    """Print how many runs are to do, and what they need."""
    demand = campaign.estimate(plan, out)
    to_do = f"{len(plan.distinct)}, of which {demand.runs} are to do"
    rows = [("runs", to_do), ("dimensions", _dimensions(plan))]
    if demand.runs:
        memory = f"about {data_size(demand.memory)} for the largest run, times the workers; "
        memory += f"this machine has {data_size(available())} available"
        rows += [("memory", memory), ("disk", f"about {data_size(demand.bytes)}")]
    sys.stdout.write(f"{aligned(rows)}\n")


def sweep(plan: Plan, out: Path, work: Work) -> None:
    """Do the missing runs, and print the tally; `AsperityError` in the end if runs failed."""
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
        done = f"{campaign.tally(plan, out).done} runs are done"
        raise KeyboardInterrupt(f"interrupted; {done}, and the same command does the rest") from None
    except InputError as error:
        # A scheduler that does not answer is no mistake in the arguments.
        if error.name != "scheduler" or isinstance(error.__cause__, ValueError):
            raise
        raise AsperityError(str(error)) from error
    if not work.quiet:
        unasked = ("scheduler", f"{work.scheduler} was not used: no run was to do")
        rows = tally_table(plan, end, *[unasked] * (idle and work.scheduler is not None))
        sys.stdout.write(f"{rows}\n")
    if end.failed:
        why = f"{shlex.join(('asperity', 'status', str(out)))} says why; try again with --retry-failed"
        raise AsperityError(f"{end.failed} of {end.total} runs failed: {why}")


def _check_out(out: Path) -> None:
    if out.exists() and not out.is_dir():
        raise InputError("--out", expected="a folder", got=f"{out}, which is a file")
    occupied = any(path.name[0] != "." for path in out.iterdir()) if out.exists() else False
    if occupied and kind_of(out) != "campaign":  # in this order: another campaign may be filling the folder
        expected = "a new folder, or that of a campaign"
        got = f"{out}, which contains something else"
        raise InputError("--out", expected=expected, got=got, advice="another name")


def tally_table(plan: Plan, end: Tally, *more: tuple[str, str]) -> str:
    """A table of the tally, and a line for each reason why runs failed."""
    states = ("done", "running", "failed", "left")
    rows = [("runs", str(end.total)), *((name, str(getattr(end, name))) for name in states)]
    alike: dict[str, list[Run]] = {}
    for identity, run in plan.distinct.items():
        if identity in end.reasons:
            alike.setdefault(end.reasons[identity], []).append(run)
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
        counts = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
        times = (TimeElapsedColumn(), TextColumn("left"), TimeRemainingColumn())
        with Bar(*counts, *times, console=Console(stderr=True), transient=True) as bar:
            task = bar.add_task("runs", total=None)
            count = functools.partial(bar.update, task)
            yield lambda now: count(total=now.total, completed=now.done + now.failed, description=_words(now))
    else:
        yield _Lines().say


class _Lines:
    """A line at the start, one when workers are there, one every few seconds, one at the end.

    The time left is that of the runs after the first one to end: before that workers start and loops compile.
    """

    def __init__(self) -> None:
        self.last = self.begin = clock.monotonic()
        self.calls = self.over_at_start = self.over_at_begin = 0

    def say(self, now: Tally) -> None:
        over, moment = now.done + now.failed, clock.monotonic()
        self.calls += 1
        if self.calls == 1:
            self.over_at_start = over
        if over <= self.over_at_start + 1:
            self.begin, self.over_at_begin = moment, over
        if self.calls <= 2 or over == now.total or moment - self.last >= LINE_EVERY:
            self.last = moment
            fresh = over - self.over_at_begin
            remaining = (now.total - over) * (moment - self.begin) / fresh if fresh else None
            estimate = f", about {duration(remaining)} left" if remaining else ""
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
