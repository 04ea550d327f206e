"""Measure what a second thread gains, beside what the machine has to give.

    python benchmarks/threads.py                     512, 1024 and 2048, as many threads as there are cores
    python benchmarks/threads.py --sizes 512 --threads 4

In turn, and again: one process with one thread; as many such processes as there are threads, side by side,
which tells what the machine can give; one process with all threads. Each presses a lattice of springs
(k1/k0 = 3, white heights, F / N = 0.02), ages it through nine decades at 37 times, and presses a self-affine
half-space. The table has the seconds; what the machine gives, the number of copies over what each is slowed
down by the others; and what the threads gain, the seconds of one over those of all.

What threads share is counted in one more run of one thread: the seconds within loops and transforms that
are large enough to be shared. The rest is serial, and limits what any number of threads can gain.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

VERBS = ("press", "age", "press a half-space")


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--sizes", type=int, nargs="+", default=[512, 1024, 2048])
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--work", type=int, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.work:
        work(options.work)
        return
    n = options.threads
    print(f"size  verb                one thread  {n} copies  {n} threads  machine gives  gained  shared")
    for size in options.sizes:
        found: dict[str, list[dict[str, float]]] = {"one": [], "copies": [], "threads": []}
        for _ in range(options.rounds):
            found["one"] += side_by_side(size, copies=1, threads=1)
            found["copies"] += side_by_side(size, copies=n, threads=1)
            found["threads"] += side_by_side(size, copies=1, threads=n)
        for verb in VERBS:
            one, copies, threads = (statistics.median(run[verb] for run in runs) for runs in found.values())
            shared = statistics.median(run[f"shared {verb}"] for run in found["one"])
            seconds = f"{one:10.3f}  {copies:8.3f}  {threads:9.3f}"
            gains = f"{n * one / copies:13.2f}  {one / threads:6.2f}  {shared:6.2f}"
            print(f"{size:4}  {verb:18}  {seconds}  {gains}", flush=True)


def side_by_side(size: int, *, copies: int, threads: int) -> list[dict[str, float]]:
    """What each of some processes measures, which begin at the same time."""
    command = [sys.executable, __file__, "--work", str(size)]
    pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    known = os.environ | {"OMP_NUM_THREADS": str(threads)}
    processes = [subprocess.Popen(command, env=known, **pipes) for _ in range(copies)]
    try:
        for verb in VERBS:
            for process in processes:
                process.stdout.readline()  # ready
            for process in processes:
                print(verb, file=process.stdin, flush=True)
        return [json.loads(process.stdout.readline()) for process in processes]
    finally:
        for process in processes:
            process.kill()
            process.wait()


def work(size: int) -> None:
    """Say that a verb is ready, wait for the word, measure; then, what of each is shared."""
    import numpy as np
    import synthetic

    import asperity as asp

    white, rough = synthetic.white(size), synthetic.self_affine(size)
    springs, half_space = asp.solids.spring_lattice(k0=1.0, k1=3.0), asp.solids.half_space(modulus=1.0)
    slope = float(np.sqrt(np.mean(np.gradient(rough)[0] ** 2 + np.gradient(rough)[1] ** 2)))
    contact = asp.press(white, springs, load=0.02 * size**2)
    times = np.geomspace(1e-3, 1e6, 37)
    verbs: dict[str, Callable[[], object]] = {
        "press": lambda: asp.press(white, springs, load=0.02 * size**2),
        "age": lambda: asp.age(contact, times),
        "press a half-space": lambda: asp.press(rough, half_space, pressure=0.025 * slope),
    }
    asp.age(contact, times[:2])
    found: dict[str, float] = {}
    for verb, call in verbs.items():
        call()
        print("ready", flush=True)
        sys.stdin.readline()
        repeats = 1 if verb == "age" else 5
        found[verb] = min(timed(call) for _ in range(repeats))
        with Watched() as watched:
            seconds = timed(call)
        found[f"shared {verb}"] = watched.seconds / seconds
    print(json.dumps(found), flush=True)


def timed(call: Callable[[], object]) -> float:
    """Seconds that a call takes."""
    begun = time.perf_counter()
    call()
    return time.perf_counter() - begun


class Watched:
    """Adds up the seconds within loops and transforms that threads would share."""

    def __enter__(self) -> Watched:
        from asperity import lattice
        from asperity.contact.multigrid import processor

        def loops(_: object, __: object, sites: Any, *___: Any) -> bool:
            return bool(sites.rows * sites.columns >= processor._WORTH_SHARING)

        def transforms(own: Any, *_: Any) -> bool:
            return bool(own.sites >= lattice._WORTH_SHARING)

        self.seconds = 0.0
        self.known = [
            (processor.Processor, "_over", loops),
            (lattice.Lattice, "forward", transforms),
            (lattice.Lattice, "backward", transforms),
        ]
        self.usual = [getattr(kind, name) for kind, name, _ in self.known]
        for (kind, name, shared), usual in zip(self.known, self.usual, strict=True):
            setattr(kind, name, self._adding(usual, shared))
        return self

    def _adding(self, usual: Callable[..., Any], shared: Callable[..., bool]) -> Callable[..., Any]:
        def call(*arguments: Any, **options: Any) -> Any:
            begun = time.perf_counter()
            result = usual(*arguments, **options)
            self.seconds += (time.perf_counter() - begun) * shared(*arguments)
            return result

        return call

    def __exit__(self, *_: object) -> None:
        for (kind, name, _), usual in zip(self.known, self.usual, strict=True):
            setattr(kind, name, usual)


if __name__ == "__main__":
    main()
