"""Do the remaining runs of a campaign, on this machine's cores or on a Dask cluster."""

from __future__ import annotations

import json
import multiprocessing
import time as clock
from collections.abc import Callable, Sequence
from concurrent.futures import CancelledError
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from asperity.app.campaign.cluster import ATTEMPTS, connect, ended
from asperity.app.campaign.plan import Plan, Run, plan_to_json, with_units
from asperity.app.campaign.store import Store
from asperity.app.campaign.worker import Report, run_task
from asperity.app.runs.loops import compile_loops
from asperity.base import checks
from asperity.base.files import expanded, without_links
from asperity.base.version import __version__
from asperity.errors import InputError, OutputError
from asperity.results.store import whole_file

if TYPE_CHECKING:
    from distributed import Client

_POLL = 1.0
"""Seconds between two looks at runs that another process computes."""


@dataclass(frozen=True)
class Tally:
    """Progress of a campaign.

    Attributes
    ----------
    total, done, failed, running
        Numbers of runs; those neither done, failed nor running are left.
    reasons
        Why runs failed, by identity.
    workers
        Number of workers that the campaign began with; 0 where none are at work.
    """

    total: int
    done: int
    failed: int
    running: int
    reasons: dict[str, str]
    workers: int = 0

    @property
    def left(self) -> int:
        """Runs that have not been started."""
        return self.total - self.done - self.failed - self.running


def tally(plan: Plan, directory: str | Path) -> Tally:
    """Count the runs of a plan that are done, failed and running.

    Parameters
    ----------
    plan
        The plan.
    directory
        Folder of the campaign.
    """
    store = Store(directory)
    wanted = set(plan.distinct)
    store.remark_on_remains(wanted)
    done = store.done() & wanted
    reasons = {name: why for name, why in store.failures().items() if name in wanted - done}
    running = (store.running() & wanted) - done - set(reasons)
    return Tally(len(wanted), len(done), len(reasons), len(running), reasons)


def sweep(
    plan: Plan,
    directory: str | Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    retry_failed: bool = False,
    progress: Callable[[Tally], None] | None = None,
) -> Tally:
    """Do the runs of a plan that are not done yet.

    Parameters
    ----------
    plan
        From `read_plan`.
    directory
        Folder of the campaign; on a cluster, one that all its machines see under this name.
    workers
        Worker processes on this machine, one thread each; by default as many as there are cores.
    scheduler
        Address of a Dask scheduler to use instead, such as ``"tcp://10.0.0.1:8786"``.
    retry_failed
        Whether to try again what failed earlier.
    progress
        Called after every run.

    Returns
    -------
    Tally
        The end of it. A run that fails does not stop the others.

    Raises
    ------
    InputError
        The scheduler cannot be reached, or runs another version.
    OutputError
        The disk refused; what is finished stays, and the same call goes on.
    MissingExtraError
        Dask is not installed, which the extra ``campaign`` brings.
    """
    checks.instance("plan", plan, Plan, 'asperity.campaign.read_plan("campaign.toml")')
    if getattr(multiprocessing.current_process(), "_inheriting", False):
        # A worker that imports, as it starts, a script which calls this at its top level: it could not start
        # workers of its own, and dozens of lines would say so. `connect` says it in one.
        raise SystemExit(1)
    with checks.extra("campaign", "running a campaign"):  # before anything is written
        import distributed  # noqa: F401
    store = Store(without_links(expanded(directory)))
    try:
        store.directory.mkdir(parents=True, exist_ok=True)
        store.prepare()
    except OSError as error:
        raise OutputError(f"cannot write {directory}: {error.strerror or error}") from error
    with whole_file(store.directory / "plan.json") as part:
        part.write_text(plan_to_json(plan), encoding="utf-8")
    if retry_failed:
        for identity in store.failures():
            store.forgive(identity)
    now = tally(plan, store.directory)  # from here on as reports come, without looking at the disk

    def tell(**changed: Any) -> None:
        nonlocal now
        now = replace(now, **changed)
        if progress is not None:
            progress(now)

    def take(report: Report) -> None:
        identity, state, reason = report
        if state == "done":
            tell(done=now.done + 1)
        else:
            reasons = now.reasons | {identity: reason}
            tell(failed=len(reasons), reasons=reasons)

    tell(running=0)
    over = store.done() | set(store.failures())
    todo = [run for identity, run in plan.distinct.items() if identity not in over]
    if todo:
        compile_loops()  # once, rather than in every worker
        with connect(workers, scheduler, len(todo)) as client:
            tell(workers=len(client.nthreads()))
            while todo:
                busy = _round(client, store, todo, take)
                if busy:
                    clock.sleep(_POLL)
                todo = [run for run in busy if not store.is_done(run.identity)]
    return tally(plan, store.directory)


def _round(client: Client, store: Store, runs: Sequence[Run], take: Callable[[Report], None]) -> list[Run]:
    """Submit runs, take their reports; return the runs that other processes compute."""
    by_key = {f"run-{run.identity}-{clock.monotonic_ns()}": run for run in runs}
    futures = []
    for key, run in by_key.items():
        asked = run.identity, json.dumps(with_units(run.config)), run.content, __version__
        futures.append(client.submit(run_task, str(store.directory), *asked, key=key, pure=False))
    busy = []
    try:
        for future, returned in ended(client, futures):
            run = by_key[str(future.key)]
            if returned is None and future.status != "error":
                raise _lost(f"a run came back {future.status}")
            report: Report = returned or _crashed(store, run, future.exception())
            future.release()
            if _is_busy(report):
                busy.append(run)
            else:
                take(report)
    except (OSError, TimeoutError, CancelledError) as error:
        if isinstance(error, OutputError):
            raise
        raise _lost(str(error)) from error
    finally:
        with suppress(Exception):  # the scheduler may be gone
            client.cancel([future for future in futures if not future.done()])
    return busy


def _is_busy(report: Report) -> bool:
    """Whether another process is at the run; raises if the campaign cannot go on."""
    _, state, reason = report
    if state == "version":
        raise InputError("scheduler", expected="workers with this version", got=reason)
    if state == "disk":
        full = any(word in reason for word in ("No space left", "quota", "File too large"))
        advice = "free some space and give" if full else "mend that and give"
        raise OutputError(f"{reason}; {advice} the same command again")
    return state == "busy"


def _lost(reason: str) -> OutputError:
    return OutputError(
        f"lost the scheduler ({reason or 'for unknown reasons'}); finished runs are kept, "
        "and the same command does the rest"
    )


def _crashed(store: Store, run: Run, error: BaseException) -> Report:
    if type(error).__name__ == "KilledWorker":
        reason = f"its worker died {ATTEMPTS + 1} times; was there too little memory?"
    else:
        reason = f"unexpected {type(error).__name__}: {error}"
    reason = " ".join(reason.split())
    store.fail(run.identity, reason)
    return run.identity, "failed", reason
