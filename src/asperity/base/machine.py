"""Cores and memory of the machine, and deferred interrupts."""

from __future__ import annotations

import math
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

from asperity.base.words import data_size
from asperity.errors import TooLargeError

_NO_LIMIT = 2**60  # limits above it are how the system writes that there is none


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def usual_threads() -> int:
    """Number of threads: ``OMP_NUM_THREADS``, as in other numerical libraries, or all cores."""
    wanted = os.environ.get("OMP_NUM_THREADS", "")
    return max(1, int(wanted)) if wanted.isdigit() else cores()


@contextmanager
def unhurried() -> Iterator[None]:
    """Let Ctrl-C and termination wait. Processes that begin here never hear Ctrl-C: it is for the client."""
    came: list[int] = []
    try:
        with ExitStack() as stack:
            if threading.current_thread() is threading.main_thread():
                for name in (signal.SIGINT, signal.SIGTERM):
                    before = signal.signal(name, lambda number, _: came.append(number))
                    stack.callback(signal.signal, name, before)
            if hasattr(signal, "pthread_sigmask"):  # threads and processes inherit what is blocked
                from multiprocessing import resource_tracker

                resource_tracker.ensure_running()  # begun with the first process, it would unblock Ctrl-C
                blocked = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
                stack.callback(signal.pthread_sigmask, signal.SIG_SETMASK, blocked)
            yield
    finally:
        for number in came[:1]:
            signal.raise_signal(number)


def end_with(asking: Callable[[], object]) -> None:
    """End this process when a call returns that waits as long as the process lives that wants the results.

    Whoever is killed cannot end the others, and who writes to a pipe that nobody reads waits forever.
    """

    def end() -> None:
        try:
            asking()
        finally:
            os._exit(1)

    threading.Thread(target=end, daemon=True).start()


def end_with_parent() -> None:
    """End this process, which `multiprocessing` began, with the one that began it."""
    from multiprocessing import parent_process

    if (parent := parent_process()) is not None:
        end_with(parent.join)


def available() -> int:
    """Bytes that this process can still get: the smallest of all limits."""
    return max(0, min([_machine(), *_control_groups(), *_address_space()]))


def require(needed: float, shape: Sequence[int], *, power_of_two: bool = False) -> None:
    """Refuse a lattice of this shape for which there is not enough memory, at so many bytes a site.

    `TooLargeError` says the largest lattice with equal sides that would fit, or of a power of two.
    """
    free = available()
    total = needed * math.prod(shape)
    if total <= free:
        return
    side = math.floor(free / needed) if len(shape) == 1 else math.isqrt(math.floor(free / needed))
    if power_of_two and side > 0:
        side = 1 << (side.bit_length() - 1)
    sites, fits = (" x ".join(map(str, sides)) for sides in (shape, [side] * len(shape)))
    raise TooLargeError(
        f"{sites} sites: expected a lattice that fits into the memory, got one that needs "
        f"{data_size(total)} where {data_size(free)} are available; try at most {fits} sites"
    )


def _machine() -> int:
    """Free memory of the machine, with caches that it would give up."""
    for line in _lines(Path("/proc/meminfo")):
        if line.startswith("MemAvailable:"):
            return int(line.split()[1]) * 1024
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):  # Windows knows neither name
        return _NO_LIMIT


def _control_groups(
    root: Path = Path("/sys/fs/cgroup"), membership: Path = Path("/proc/self/cgroup")
) -> Iterator[int]:
    """Bytes that each control group of the process leaves, in version 2 and in version 1."""
    for line in _lines(membership):
        _, controllers, path = line.split(":", 2)
        if controllers == "":
            top, limit, used, cache = root, "memory.max", "memory.current", "inactive_file"
        elif "memory" in controllers.split(","):
            top, limit = root / "memory", "memory.limit_in_bytes"
            used, cache = "memory.usage_in_bytes", "total_inactive_file"
        else:
            continue
        group = top / path.lstrip("/")
        for folder in [group, *group.parents]:
            # In a container the path may be that of the outside: only what is there is read.
            most = _number(folder / limit)
            if most is not None and most < _NO_LIMIT:
                statistics = dict(row.split(maxsplit=1) for row in _lines(folder / "memory.stat"))
                yield most - (_number(folder / used) or 0) + int(statistics.get(cache, 0))
            if folder == top:
                break


def _address_space() -> Iterator[int]:
    if sys.platform == "win32":
        return
    import resource

    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit != resource.RLIM_INFINITY:
        pages = next(iter(_lines(Path("/proc/self/statm"))), "0").split()[0]
        yield limit - int(pages) * os.sysconf("SC_PAGE_SIZE")


def _number(path: Path) -> int | None:
    text = next(iter(_lines(path)), "")
    return int(text) if text.isdecimal() else None


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text().splitlines()
    except OSError:
        return []
