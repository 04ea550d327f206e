"""Threads that do their shares of a loop together.

A loop of multigrid takes some hundred microseconds, and to wake a thread takes tens. So a thread looks for
the next loop for a while, without the interpreter's lock, before it sleeps.
"""

from __future__ import annotations

import threading
import time
import weakref
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from asperity.contact.multigrid.loops import Gate, announce, watch

_LOOKS = 100_000
"""How often a thread looks for the next loop before it sleeps: about 100 microseconds."""

_MET, _FAILED, _CALLED, _DONE = 0, 1, 16, 32
"""Places of counts: arrivals and failures, as `Gate` has them; loops called; shares done. 128 bytes apart."""


class Team:
    """The thread that calls, and others, which begin with the first loop that is shared.

    Parameters
    ----------
    size
        Number of threads, the one that calls included.
    """

    def __init__(self, size: int) -> None:
        self._others, self._calls = size - 1, 0
        self._counts, self._job = np.zeros(48, np.int64), _Job()

    def gate(self, threads: int) -> Gate:
        """Where so many threads meet within a loop."""
        return Gate(self._counts, threads)

    def do(self, loop: Callable[..., None], shares: Sequence[tuple[Any, ...]]) -> None:
        """Call the loop with each of the shares, one a thread; what fails in a thread is raised here."""
        if len(shares) == 1:
            loop(*shares[0])
            return
        counts, job = self._counts, self._job
        if self._calls == 0:
            self._begin()
        self._wait()  # an interrupt may have ended the last call early
        counts[_MET] = counts[_FAILED] = 0
        job.loop, job.shares, job.failure = loop, shares, None
        self._calls += 1
        announce(counts, _CALLED)
        for event in tuple(job.asleep):
            event.set()
        try:
            loop(*shares[0])
        except BaseException:
            announce(counts, _FAILED)
            raise
        finally:
            self._wait()
            job.shares = ()
        if job.failure is not None:
            raise job.failure

    def _begin(self) -> None:
        """Start the other threads, which end with this object."""
        for place in range(1, self._others + 1):
            threading.Thread(target=_help, args=(self._counts, self._job, place), daemon=True).start()
        weakref.finalize(self, _dismiss, self._counts, self._job)

    def _wait(self) -> None:
        """Wait until the others have nothing to do."""
        while not watch(self._counts, _DONE, self._calls * self._others, _LOOKS):
            time.sleep(0)


class _Job:
    """What threads have to do, and what those that sleep wait for."""

    def __init__(self) -> None:
        self.loop: Callable[..., None] | None = None
        self.shares: Sequence[tuple[Any, ...]] = ()
        self.failure: BaseException | None = None
        self.asleep: set[threading.Event] = set()


def _help(counts: Any, job: _Job, place: int) -> None:
    """Do the share in this place of every loop, until none is left to do."""
    called, event = 0, threading.Event()
    while True:
        called += 1
        if not watch(counts, _CALLED, called, _LOOKS):
            job.asleep.add(event)
            while not watch(counts, _CALLED, called, 1):  # looked at once more, now that it would be woken
                event.wait()
                event.clear()
            job.asleep.discard(event)
        if job.loop is None:
            return
        try:
            if place < len(job.shares):
                job.loop(*job.shares[place])
        except BaseException as failure:
            job.failure = failure
            announce(counts, _FAILED)
        announce(counts, _DONE)


def _dismiss(counts: Any, job: _Job) -> None:
    """End the threads."""
    job.loop = None
    announce(counts, _CALLED)
    for event in tuple(job.asleep):
        event.set()
