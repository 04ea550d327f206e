"""What the numbers were measured on: facts, transforms and memory bandwidth."""

from __future__ import annotations

import itertools
import os
import platform
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np

PACKAGES = ("asperity", "numpy", "scipy", "numba", "pyfftw", "xarray")


def facts() -> dict[str, object]:
    """CPU, cores, memory, load average, versions and commit."""
    return {
        "cpu": _cpu(),
        "cores": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(),
        "memory_gb": round(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9, 1),
        "load_average": [round(value, 2) for value in os.getloadavg()],
        "system": f"{platform.system()} {platform.release()}",
        "python": platform.python_version(),
        "versions": {name: _version(name) for name in PACKAGES},
        "commit": _commit(),
        "time": time.strftime("%Y-%m-%d %H:%M:%S %Z"),
    }


def available_memory() -> int:
    """Bytes that a process could get; what caches hold counts as available where Linux says so."""
    try:
        lines = Path("/proc/meminfo").read_text().splitlines()
    except OSError:
        lines = []
    for line in lines:
        if line.startswith("MemAvailable:"):
            return int(line.split()[1]) * 1024
    return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


def thread_environment(threads: int) -> dict[str, str]:
    """An environment in which every library uses this many threads."""
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
    return {**os.environ, **dict.fromkeys(names, str(threads))}


def bandwidth(threads: int, *, megabytes: int = 256, repeats: int = 5) -> dict[str, float]:
    """Best gigabytes per second of a copy and of ``a = b + s c``, on slices shared among threads.

    A copy counts 16 bytes an element. numpy does the triad in two passes over blocks that fit the cache, so
    that 24 bytes an element come from and go to memory. The read that precedes each write on most processors
    is not counted.
    """
    size = megabytes * 2**20 // 8
    a, b, c = (np.full(size, value) for value in (0.0, 1.0, 2.0))
    edges = np.linspace(0, size, threads + 1).astype(int)
    parts = [slice(*pair) for pair in itertools.pairwise(edges)]

    def copy(part: slice) -> None:
        np.copyto(a[part], b[part])

    def triad(part: slice) -> None:
        for begin in range(part.start, part.stop, 16384):
            block = slice(begin, min(begin + 16384, part.stop))
            np.multiply(c[block], 3.0, out=a[block])
            np.add(a[block], b[block], out=a[block])

    best = {}
    with ThreadPoolExecutor(threads) as pool:
        for name, work, count in (("copy", copy, 16), ("triad", triad, 24)):
            seconds = []
            for _ in range(repeats):
                begin = time.perf_counter()
                list(pool.map(work, parts))
                seconds.append(time.perf_counter() - begin)
            best[name] = count * size / min(seconds) / 1e9
    return best


def _cpu() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "unknown")


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "absent"


def _commit() -> str:
    try:
        command = ["git", "-C", str(Path(__file__).parent), "describe", "--always", "--dirty"]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
