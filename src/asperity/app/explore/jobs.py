"""Runs in separate processes: started, watched, stopped, and kept when they are done.

Each run is a task that follows its process. To stop a run its process is killed; one whose run has ended
takes the next.
"""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import json
import pickle
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from asperity.app.config import RunConfig, to_tables
from asperity.app.explore.mistakes import Shown, failed, mistake
from asperity.app.explore.scene import Recording
from asperity.base.files import standing

_UNWATCHED = 10.0
"""Seconds until an unwatched run is stopped: a page that is loaded again finds it before."""

_MOST_AT_ONCE, _KEPT_RUNS = 2, 8
"""Most runs that compute in parallel, and most finished ones that are kept."""

_WORK = "from asperity.app.explore.work import work; work()"


@dataclass(eq=False)
class Job:
    """A requested run: its recording, its task, and its watchers."""

    recording: Recording
    task: asyncio.Task[None] | None = None
    watchers: set[Callable[[], None]] = field(default_factory=set)
    taken: bool = False
    """Whether a process has taken it."""

    def take(self, sort: str, content: Any) -> None:
        """Take a message of the process that computes it."""
        recording = self.recording
        if sort == "stage":
            recording.stage = content
        elif sort == "scene":
            recording.scene, recording.heights = content
        elif sort == "row":
            row, new_map = content
            recording.rows.append(row)
            recording.maps += [] if new_map is None else [new_map]
        elif sort == "taken":
            self.taken = True
        else:
            recording.end = content
        for watcher in list(self.watchers):
            watcher()


class Jobs:
    """All runs of a server; to be used from one event loop."""

    def __init__(self) -> None:
        self._jobs: dict[str, Job] = {}  # those that are done in the order of their ends
        self._room = asyncio.Semaphore(_MOST_AT_ONCE)
        self._idle: list[Process] = []
        self._closed = False

    def ask(self, config: RunConfig, shown: Shown, title: str) -> Job:
        """Start a run, or return the one of the same configuration that is running or done."""
        name = _name_of(config)
        if name not in self._jobs:
            job = self._jobs[name] = Job(Recording(name))
            job.task = asyncio.create_task(self._follow(job, pickle.dumps((config, shown, title))))
        return self._jobs[name]

    def leave(self, job: Job, watcher: Callable[[], None], *, at_once: bool) -> None:
        """Stop watching a run; unwatched runs are stopped, immediately or after a delay."""
        job.watchers.discard(watcher)
        asyncio.get_running_loop().call_later(0 if at_once else _UNWATCHED, self._stop_if_unwatched, job)

    async def close(self) -> None:
        """End all processes."""
        self._closed = True
        tasks = [job.task for job in self._jobs.values() if job.task is not None]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        for process in self._idle:
            await _killed(process)

    async def warm(self) -> None:
        """Start a process that imports the engine before the next run comes."""
        if not (self._idle or self._closed):
            self._idle.append(await _started())

    def _stop_if_unwatched(self, job: Job) -> None:
        # Where several pages left a run, it may be stopped, and another of its name have begun.
        current = self._jobs.get(job.recording.job) is job
        if current and not job.watchers and job.recording.end is None and job.task is not None:
            del self._jobs[job.recording.job]
            job.task.cancel()

    async def _follow(self, job: Job, asked: bytes) -> None:
        """Compute a run, and keep it if it succeeds; failed runs may be tried again."""
        job.take("stage", "waiting for another run" if self._room.locked() else "starting")
        async with self._room:
            # One that waited may have ended, which is seen only when it does not take a run; the last is new.
            for others in reversed(range(len(self._idle) + 1)):
                process = self._idle.pop() if others and self._idle else await _started()
                try:
                    await self._hear(job, process, asked, others)
                finally:
                    if job.recording.end is None or process.returncode is not None:
                        await _killed(process)
                    else:
                        self._idle.append(process)
                    await self.warm()
                if job.recording.end is not None:
                    break
        del self._jobs[job.recording.job]
        if job.recording.end is not None and job.recording.end["kind"] != "failed":
            self._jobs[job.recording.job] = job
        done = [name for name, one in self._jobs.items() if one.recording.end is not None]
        for name in done[:-_KEPT_RUNS]:
            del self._jobs[name]

    async def _hear(self, job: Job, process: Process, asked: bytes, others: int) -> None:
        """Send a run to a process, and take its messages until the run or the process ends.

        No end is recorded where the process ends before it takes the run, and others are left to take it.
        """
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            process.stdin.write(asked)
            while job.recording.end is None:
                length = int.from_bytes(await process.stdout.readexactly(8), "little")
                job.take(*pickle.loads(await process.stdout.readexactly(length)))
        except (EOFError, OSError):
            code = await process.wait()
            if others and not job.taken:
                return
            cause = f"signal {-code}" if code < 0 else f"status {code}"
            text = f"the computing process was stopped by the system ({cause}); press again"
            job.take("end", failed(mistake(text)))


async def _started() -> Process:
    # Ctrl-C is for the server, which ends its processes: they are in a session of their own.
    return await asyncio.create_subprocess_exec(
        sys.executable, "-c", _WORK, stdin=PIPE, stdout=PIPE, start_new_session=True
    )


async def _killed(process: Process) -> None:
    with contextlib.suppress(ProcessLookupError):
        process.kill()
    await process.communicate()  # reads what it left, without which it would not be seen to end


def _name_of(config: RunConfig) -> str:
    states = [sorted(standing(Path(name))) for name in config.files.values()]
    return hashlib.sha256(json.dumps([to_tables(config), states], sort_keys=True).encode()).hexdigest()[:24]
