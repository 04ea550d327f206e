"""Threads that do their shares of a loop together.

A loop of multigrid takes some hundred microseconds, and to wake a thread takes tens. So a thread looks for
the next loop for a while, without the interpreter's lock, before it sleeps.
"""

from __future__ import annotations

import threading
import time
import weakref
from collections.abc import Callable, Sequence
from queue import SimpleQueue
from typing import Any

import numpy as np

from asperity.contact.multigrid.loops import APART, ASKED, DONE, FAILED, MET, Gate, announce, call, watch

_LOOKS_BEFORE_SLEEP = 100_000
"""How often a thread looks for the next loop before it sleeps: about 100 microseconds."""


class Team:
    """The thread that calls, and others, which begin with the first loop that they share.

    Parameters
    ----------
    size
        Most threads, the one that calls included.
    """

    def __init__(self, size: int) -> None:
        self._counts, self._job, self._others = np.zeros(APART * (size + 1), np.int64), _Job(), 0
        weakref.finalize(self, _dismiss, self._counts, self._job, size)

    def gate(self, threads: int) -> Gate:
        """Where so many threads meet within a loop."""
        return Gate(self._counts, threads)

    def do(self, loop: Callable[..., None], shares: Sequence[tuple[Any, ...]]) -> None:
        """Call the loop with each of the shares, one a thread; what fails in a thread is raised here."""
        counts, job = self._counts, self._job
        while self._others < len(shares) - 1:
            place = self._others + 1
            threading.Thread(target=_help, args=(counts, job, place), daemon=True).start()
            self._others = place
        self._wait()  # an interrupt may have ended the last call early
        counts[MET] = counts[FAILED] = 0
        job.loop, job.shares, job.failure = loop, shares, None
        try:
            call(counts, len(shares))
            job.wake(len(shares))
            loop(*shares[0])
        except BaseException:
            announce(counts, FAILED)
            raise
        finally:
            self._wait()
            job.shares = ()
        if job.failure is not None:
            raise job.failure

    def _wait(self) -> None:
        """Wait until the others have done all that they were asked."""
        while not watch(self._counts, DONE, int(self._counts[ASKED]), _LOOKS_BEFORE_SLEEP):
            time.sleep(0)


class _Job:
    """What threads have to do, and where those that sleep are woken; nothing here takes a lock twice."""

    def __init__(self) -> None:
        self.loop: Callable[..., None] | None = None
        self.shares: Sequence[tuple[Any, ...]] = ()
        self.failure: BaseException | None = None
        self.asleep: dict[int, SimpleQueue[None]] = {}

    def wake(self, threads: int) -> None:
        """Wake those of the first so many threads that sleep."""
        for place in range(1, threads):
            bell = self.asleep.get(place)
            if bell is not None:
                bell.put(None)


def _help(counts: Any, job: _Job, place: int) -> None:
    """Do the share in this place of every loop, until none is left to do."""
    called, bell = 0, SimpleQueue[None]()
    while True:
        called += 1
        if not watch(counts, APART * (place + 1), called, _LOOKS_BEFORE_SLEEP):
            job.asleep[place] = bell
            while not watch(counts, APART * (place + 1), called, 1):  # once more, now that it would be woken
                bell.get()
            del job.asleep[place]
        if job.loop is None:
            return
        try:
            job.loop(*job.shares[place])
        except BaseException as failure:
            job.failure = failure
            announce(counts, FAILED)
        announce(counts, DONE)


def _dismiss(counts: Any, job: _Job, size: int) -> None:
    """End the threads."""
    job.loop = None
    call(counts, size)
    job.wake(size)
