"""Connect to a Dask cluster: an existing one, or a new one on this machine's cores."""

from __future__ import annotations

import asyncio
import gc
import logging
import time as clock
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager, suppress
from typing import TYPE_CHECKING, Any

from asperity.base.calls import remark
from asperity.base.machine import cores, unhurried
from asperity.base.words import shortened
from asperity.errors import AsperityError, InputError

if TYPE_CHECKING:
    from distributed import Client, Future

ATTEMPTS = 3
"""Deaths of its worker after which a run counts as failed."""

_THREADS = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS")

_ANSWER, _TELL, _PATIENCE = 30.0, 5.0, 300.0
"""Seconds to wait: for a scheduler; without any worker before a remark; without any worker in all."""

_LOOK, _COUNT = 0.02, 1.0
"""Seconds between two looks for runs that have ended, and between two counts of the workers."""


@contextmanager
def connect(workers: int | None, scheduler: str | None, runs: int) -> Iterator[Client]:
    """Connect to a cluster: a given one, or one made of this machine's cores."""
    import dask
    from distributed import Client, LocalCluster

    settings = {
        "distributed.scheduler.allowed-failures": ATTEMPTS,
        # A worker that dies is blamed on the run that it was at, and on none that waits for it.
        "distributed.scheduler.worker-saturation": 1.0,
        # One thread each. Dask would also have the allocator return memory at once (MALLOC_TRIM_THRESHOLD_),
        # after which every array of a run is fetched from the system anew: twice the time.
        "distributed.nanny.pre-spawn-environ": dict.fromkeys(_THREADS, 1),
    }
    with dask.config.set(settings), ExitStack() as stack:
        # Silence the log of lost workers and schedulers: the tally has what matters.
        # What a task of it failed by is logged as the task is collected: before logging is on again.
        stack.callback(logging.disable, logging.root.manager.disable)
        stack.callback(gc.collect)
        logging.disable(logging.CRITICAL)
        if scheduler is not None:
            yield stack.enter_context(_connected(scheduler))
            return
        # Dask cannot be stopped while it starts or ends.
        with unhurried():
            try:
                cluster = LocalCluster(
                    n_workers=min(workers or cores(), runs),
                    threads_per_worker=1,
                    processes=True,
                    dashboard_address=":0",
                    memory_limit=None,
                    silence_logs=logging.CRITICAL,
                )
            except Exception as error:  # any: they may come from a configuration of Dask
                raise AsperityError(f"the worker processes did not start{_why(error)}") from None
            within = stack.enter_context(ExitStack())
            client = within.enter_context(Client(within.enter_context(cluster)))
        try:
            yield client
        finally:
            with unhurried():
                within.close()


def _why(error: BaseException) -> str:
    """Why workers did not start: the first error, or that they ended on their own."""
    while (before := error.__cause__ or error.__context__) is not None:
        error = before
    if "failed to start worker process" in str(error):
        return "; a script has to call sweep under if __name__ == '__main__':, as they import it"
    reason = shortened(f"{type(error).__name__}: {error}".removesuffix(": "), 200)
    return f" ({reason}); Dask is configured in ~/.config/dask and by variables DASK_..."


def ended(client: Client, futures: Sequence[Future[Any]]) -> Iterator[tuple[Future[Any], Any]]:
    """Yield futures as they end, with their results; remark if there are no workers.

    `AsperityError` after minutes without any worker.
    """
    from distributed import as_completed

    ending = as_completed(futures)
    last_seen = looked = clock.monotonic()  # when workers were there last, and when they were counted
    remarked = False
    while not ending.is_empty():
        if not ending.has_ready():
            clock.sleep(_LOOK)
        else:
            future, returned = next(ending), None
            with suppress(TimeoutError):
                if future.status == "finished":
                    returned = future.result(timeout=_COUNT)
            over = future.status in ("error", "cancelled") or client.status != "running"
            if returned is not None or over:
                yield future, returned
                continue
            ending.add(future)  # what it returned is lost with its worker: another one says it again
        now = clock.monotonic()
        if now - looked < _COUNT:
            continue
        looked = now
        if client.nthreads():
            last_seen, remarked = now, False
        elif now - last_seen >= _TELL and not remarked:  # said before it ends, however slow the machine
            remarked = True
            remark("waiting for workers: 0 connected")
        elif now - last_seen >= _PATIENCE:
            raise AsperityError(
                f"scheduler: expected workers, got none for {_PATIENCE:.0f} seconds; finished runs are kept; "
                "start workers and give the same command again"
            )


def _connected(scheduler: str) -> Client:
    from distributed import Client, rpc

    async def asked() -> None:  # a client would wait forever for what takes connections and is no scheduler
        async with rpc(scheduler) as connection, asyncio.timeout(_ANSWER):
            await connection.identity()

    try:
        with ThreadPoolExecutor(1) as aside:  # a notebook has a loop of its own
            aside.submit(asyncio.run, asked()).result()
        return Client(scheduler, timeout=_ANSWER)
    except (OSError, TimeoutError, ValueError) as error:
        got = f"{scheduler}: {str(error) or f'no answer in {_ANSWER:.0f} seconds'}"
        raise InputError("scheduler", expected="the address of a Dask scheduler", got=got) from error
