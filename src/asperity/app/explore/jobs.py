"""Runs in processes of their own: started, watched, stopped, and kept when they are done.

A process imports and compiles everything once and then takes one run after the other. It is asked to stop
and ends its run at the next recorded moment; if that takes long, as in the press of a large lattice, it is
killed.
"""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import json
import multiprocessing
import os
import re
import signal
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from time import perf_counter
from typing import Any

from asperity.aging import Frame
from asperity.app.config import RunConfig, to_tables
from asperity.app.config.keys import sections
from asperity.app.config.python import to_python
from asperity.app.explore.scene import Header, Recording, ending, mapped, of_frame, started
from asperity.app.runs import Progress, execute
from asperity.app.runs.loops import compile_loops
from asperity.base.words import reason_of
from asperity.errors import AsperityError, ConfigError, InputError, SurfaceFileError, brief

_PATIENCE = 0.5
"""Seconds after which a process that was asked to stop is killed."""

_UNWATCHED = 10.0
"""Seconds for which a run goes on that nobody watches: a page that is loaded again finds it."""

_MOST_AT_ONCE = 2
_KEPT_BYTES, _KEPT_RUNS = 256e6, 32
"""Finished runs that are kept: their bytes, and their number."""

_END = 5.0
"""Seconds for which a process is waited for that has let go of its connection, or was killed."""

_STARTING = "starting"

_LEG = re.compile(r"^(protocol(?:\[\d+\](?: legs)?)*)(?: (\w+))?: ")

Mistake = dict[str, str]
Shown = dict[str, str]
"""What stands for the absolute path of a file where others read it."""


def mistake(text: str, where: str = "") -> list[Mistake]:
    """One line of what is wrong, and the key it is about."""
    return [{"where": where, "text": text}]


def mistakes_of(error: BaseException, shown: Shown | None = None) -> list[Mistake]:
    """Say in one line each what is wrong, and which key it is about: ``contact.load``, or nothing."""
    for path, name in (shown or {}).items():
        if isinstance(error, SurfaceFileError) or (isinstance(error, AsperityError) and path in str(error)):
            where = "solid.relaxation" if "relaxation" in str(error) else "surface.path"
            return mistake(brief(str(error).replace(path, name)), where)
    match error:
        case ConfigError():
            return [{"where": _place(problem), "text": problem} for problem in error.shown]
        case InputError():
            name = error.name.removeprefix("--").replace("-", "_")
            homes = ("contact", "surface", "solid", "aging", "friction", "output")
            known = (one for one in homes if any(name in keys for keys in sections()[one].values()))
            home = next(known, "")
            return mistake(brief(str(error)), home and f"{home}.{name}")
        case AsperityError():
            return mistake(brief(str(error)))
        case MemoryError():
            return mistake(f"not enough memory: {str(error) or 'try a smaller surface'}")
        case OSError() if error.strerror:
            return mistake(f"{error.filename or ''}: {error.strerror}".removeprefix(": "))
    return mistake(f"unexpected: {type(error).__name__}: {reason_of(error)}")


def failed(mistakes: list[Mistake]) -> Header:
    """Header of the message that ends a run without a result."""
    return {"kind": "failed", "mistakes": mistakes}


def _place(problem: str) -> str:
    """The key that a line of `ConfigError` is about, as it names it itself."""
    if leg := _LEG.match(problem):
        return ".".join(filter(None, (leg[1].replace(" ", "."), leg[2])))
    if problem.startswith("[") and (found := re.match(r"^\[(\w+)\](?: (\w+):)?", problem)):
        return ".".join(filter(None, found.groups()))
    return ""


# In the process that computes


class _StoppedError(Exception):
    """The run is not wanted any more."""


class _Teller(Progress):
    """Tells through a connection how far a run has come."""

    def __init__(self, connection: Connection, asked: RunConfig, shown: Shown, title: str) -> None:
        self._connection, self._asked, self._shown, self._title = connection, asked, shown, title
        self._recording = Recording("")
        self._config = asked
        self._times: Sequence[float] = ()
        self._mapped: set[float] = set()

    def stage(self, name: str, times: Sequence[float] = ()) -> None:
        self._times = times
        self.tell("stage", name)

    def completed(self, config: RunConfig) -> None:
        self._config = config

    def reached(self, frame: Frame) -> None:
        if self._recording.scene is None:
            config, output, surface = self._config, self._asked.output, self._config.surface
            if (path := str(surface.file)) in self._shown:  # by the name that the user knows
                surface = surface.model_copy(update={"path": self._shown[path]})
            written = config.model_copy(update={"output": output, "surface": surface})
            facts = {"last_time": config.end, "python": to_python(written, list(self._times))}
            self._recording.begin(started(frame, config), written, self._title, **facts)
            scene: Header = self._recording.scene or {}
            moments = [*scene["switches"], *(output.maps_at or ())]
            self._mapped = mapped(self._times, moments, frame.contact.heights.size)
            self.tell("scene", (scene, self._recording.heights))
        row, found = of_frame(frame)
        self._recording.add_row(row)
        wanted = any(abs(frame.time - time) <= 1e-9 * time for time in self._mapped)
        self.tell("row", (self._recording.rows[-1], found if wanted else None))

    def tell(self, what: str, content: object) -> None:
        """Send a message, unless the run is not wanted any more."""
        if self._connection.poll():
            self._connection.recv()
            raise _StoppedError
        self._connection.send((what, content))


def work(connection: Connection) -> None:
    """Compute one run after the other until the connection ends: the body of a process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the server, which ends this process
    with contextlib.suppress(AttributeError, OSError):
        os.nice(5)  # the server answers first
    with contextlib.suppress(EOFError, BrokenPipeError, ConnectionResetError):
        compile_loops(lambda text: connection.send(("stage", text)), lambda _: None)
        connection.send(("ready", None))
        while True:
            if (asked := connection.recv()) is not None:  # None: to stop what has ended meanwhile
                connection.send(("end", _end_of(connection, *asked)))


def _end_of(connection: Connection, config: RunConfig, shown: Shown, title: str) -> Header:
    """Compute a run, and say how it ended."""
    begun, teller = perf_counter(), _Teller(connection, config, shown, title)
    # The page takes its maps from the moments as they come, unless an instrument looks at those of the run.
    if config.output.maps_at is None and not config.output.instrument:
        output = config.output.model_copy(update={"maps_at": []})
        config = config.model_copy(update={"output": output})
    try:
        outcome = execute(config, teller)
    except _StoppedError:
        return failed([])
    except Exception as error:  # said to the user, in the page
        return failed(mistakes_of(error, shown))
    seconds = perf_counter() - begun
    return ending(outcome.dataset, outcome.summary, remarks=outcome.remarks, seconds=seconds)


# In the process that serves


@dataclass(eq=False)
class Job:
    """A run that was asked for: what is known of it, what its process is told, and who is to hear of it."""

    recording: Recording
    config: RunConfig
    shown: Shown
    title: str
    watchers: set[Callable[[], None]] = field(default_factory=set)
    lost: bool = False
    """Whether a process ended before it began this."""


@dataclass(eq=False)
class _Worker:
    """A process that computes: whether it has all its loops, and what it does before its first run."""

    process: Any
    connection: Connection
    job: Job | None = None
    stops: bool = False
    ready: bool = False
    stage: str = _STARTING


class Jobs:
    """All runs of a server; to be used from one event loop."""

    def __init__(self) -> None:
        self._context = multiprocessing.get_context("spawn")
        self._loop = asyncio.get_running_loop()
        self._workers: list[_Worker] = []
        self._jobs: dict[str, Job] = {}  # not done in the order of asking, done in that of their ends
        self._closed = False
        self._start_worker()

    def ask(self, config: RunConfig, shown: Shown, title: str) -> Job:
        """Take up a run, or join the one of this configuration that is under way or done."""
        name = _name_of(config)
        if name not in self._jobs:
            self._jobs[name] = Job(Recording(name, stage=_STARTING), config, shown, title)
            self._next()
        return self._jobs[name]

    def leave(self, job: Job, watcher: Callable[[], None], *, at_once: bool) -> None:
        """Watch a run no more; what nobody watches ends, at once or after a while."""
        job.watchers.discard(watcher)
        if at_once:
            self._stop_if_unwatched(job)
        elif not self._closed:
            self._loop.call_later(_UNWATCHED, self._stop_if_unwatched, job)

    def close(self) -> None:
        """End all processes."""
        self._closed = True
        for worker in self._workers:
            worker.process.kill()
        for worker in self._workers:
            worker.process.join(_END)

    def _stop_if_unwatched(self, job: Job) -> None:
        recording = job.recording
        if job.watchers or recording.end is not None or self._jobs.get(recording.job) is not job:
            return
        del self._jobs[recording.job]
        for worker in self._workers:
            if worker.job is job and not worker.stops:
                worker.stops = True
                with contextlib.suppress(OSError):
                    worker.connection.send(None)
                self._loop.call_later(_PATIENCE, self._lose_patience, worker, job)

    def _lose_patience(self, worker: _Worker, job: Job) -> None:
        if worker.stops and worker.job is job:
            worker.process.kill()

    def _waiting(self) -> list[Job]:
        """Runs that no process has taken up."""
        taken = [worker.job for worker in self._workers]
        return [job for job in self._jobs.values() if job.recording.end is None and job not in taken]

    def _next(self) -> None:
        """Give runs that wait to processes that do not work; a process that is stopping is waited for."""
        for job in [] if self._closed else self._waiting():
            alive = (worker for worker in self._workers if worker.process.is_alive())
            free = next((worker for worker in alive if worker.job is None), None)
            if free is None:
                if any(worker.stops for worker in self._workers) or len(self._workers) >= _MOST_AT_ONCE:
                    self._tell(job, "waiting for another run")
                    continue
                free = self._start_worker()
            free.job = job
            self._tell(job, free.stage)
            with contextlib.suppress(OSError):  # it has just ended: see `_lost`
                free.connection.send((job.config, job.shown, job.title))

    def _start_worker(self) -> _Worker:
        ours, theirs = self._context.Pipe()
        process = self._context.Process(target=work, args=(theirs,), daemon=True)
        process.start()
        theirs.close()
        worker = _Worker(process, ours)
        self._workers.append(worker)
        threading.Thread(target=self._listen, args=(worker,), daemon=True).start()
        return worker

    def _listen(self, worker: _Worker) -> None:
        """Hand on what a process says: a thread for each."""
        with contextlib.suppress(RuntimeError):  # the loop has ended
            try:
                while True:
                    message = worker.connection.recv()
                    self._loop.call_soon_threadsafe(self._heard, worker, *message)
            except (EOFError, OSError):
                self._loop.call_soon_threadsafe(self._lost, worker)

    def _heard(self, worker: _Worker, what: str, content: Any) -> None:
        job = worker.job
        if what == "end":
            worker.job, worker.stops = None, False
            if job is not None:
                self._ended(job, content)
            self._next()
            return
        if what == "ready" or (what == "stage" and not worker.ready):  # compiling, asked for a run or not
            worker.stage, worker.ready = content or _STARTING, what == "ready"
            what, content = "stage", worker.stage
        if job is None:
            return
        recording = job.recording
        if what == "stage":
            recording.stage = content
        elif what == "scene":
            recording.scene, recording.heights = content
        elif what == "row":
            row, found = content
            recording.rows.append(row)
            recording.maps += [] if found is None else [found]
        self._wake(job)

    def _lost(self, worker: _Worker) -> None:
        """A process has ended: it was killed, by us or by the system."""
        self._workers.remove(worker)
        worker.connection.close()
        worker.process.join(_END)
        if self._closed:
            return
        if worker.process.exitcode is None:
            worker.process.kill()
            worker.process.join(_END)
        code = worker.process.exitcode or 0
        job = worker.job
        if job is not None and job.recording.stage == worker.stage and not (job.lost or worker.stops):
            job.lost = True  # whatever ended the process, it was not this run, which waits again
        elif job is not None:
            cause = f"signal {-code}" if code < 0 else f"status {code}"
            said = f"the computing process was stopped by the system ({cause}); press again"
            self._ended(job, failed(mistake(said)))
        if job is not None or self._waiting():
            self._start_worker()
        self._next()

    def _ended(self, job: Job, end: Header) -> None:
        """Keep what is done, and forget what ended longest ago; what failed may be tried again."""
        job.recording.end = end
        name = job.recording.job
        if self._jobs.get(name) is job:
            del self._jobs[name]
            if end["kind"] == "done":
                self._jobs[name] = job
        kept = [one.recording for one in self._jobs.values() if one.recording.end is not None]
        while len(kept) > _KEPT_RUNS or (len(kept) > 1 and sum(one.size for one in kept) > _KEPT_BYTES):
            del self._jobs[kept.pop(0).job]
        self._wake(job)

    def _tell(self, job: Job, stage: str) -> None:
        job.recording.stage = stage
        self._wake(job)

    def _wake(self, job: Job) -> None:
        for watcher in list(job.watchers):
            watcher()


def _name_of(config: RunConfig) -> str:
    """One name for one configuration: of its keys, and of the state of its files."""
    tables, states = to_tables(config), []
    for name in filter(None, (tables["surface"].get("path"), tables["solid"].get("relaxation"))):
        with contextlib.suppress(OSError):
            facts = Path(name).stat()
            states.append((facts.st_mtime_ns, facts.st_size))
    return hashlib.sha256(json.dumps([tables, states], sort_keys=True).encode()).hexdigest()[:24]
