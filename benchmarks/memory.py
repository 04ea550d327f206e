"""Measure the peak memory of press and age, in bytes a site.

    python benchmarks/memory.py [--press 4096 ...] [--half-space 256 ...] [--age 2048 ...] [--threads 1]

Each measurement is a process of its own. It imports Asperity and solves the same thing on 64 x 64 sites, so
that everything is loaded and compiled; the most memory it has held by then (ru_maxrss) is the baseline. Then
it makes the heights and does the real thing. The difference of the most memory held, over the sites, counts
everything that a user's process needs: the heights, the working memory and the result. White heights, k0 = 1,
k1 = 3, F / N = 0.02; age is nine decades, 37 times; half-space is a press of the self-affine heights of
`cases.py`, which touch at 4 to 6 % of the sites, and tells the iterations too. A size predicted not to fit
the free memory is skipped.
"""

from __future__ import annotations

import argparse
import json
import resource
import sys
import time
from typing import Any

import machine
import running
import synthetic
from cases import HALF_SPACE_RMS, MEAN_PRESSURE

VERBS = {
    "press": (4096, 8192, 16384),
    "half_space": tuple(HALF_SPACE_RMS),
    "age": (2048, 4096, 8192),
}


def most_held() -> int:
    """Bytes of the largest resident set so far; macOS counts in bytes, Linux in units of 1024."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)


def child(verb: str, n: int) -> dict[str, Any]:
    """Measure in this process."""
    import numpy as np

    import asperity as asp

    def work(size: int) -> tuple[float, int]:
        solid, mean_force = asp.solids.spring_lattice(k0=1.0, k1=3.0), 0.02
        if verb == "half_space":
            solid, mean_force = asp.solids.half_space(modulus=1.0), MEAN_PRESSURE
            heights = synthetic.self_affine(size)
            heights *= HALF_SPACE_RMS[n]
        else:
            heights = synthetic.white(size)
        begin = time.perf_counter()
        contact = asp.press(heights, solid, load=mean_force * size**2)
        if verb == "age":
            asp.age(contact, np.geomspace(1e-3, 1e6, 37))
        return time.perf_counter() - begin, contact.iterations

    work(64)
    baseline = most_held()
    seconds, iterations = work(n)
    peak = most_held()
    return {
        "baseline": baseline,
        "peak": peak,
        "bytes_per_site": (peak - baseline) / n**2,
        "seconds": seconds,
        "iterations": iterations,
    }


def main() -> None:
    parser = running.parser(__doc__, threads=True, out=True)
    for verb, sizes in VERBS.items():
        parser.add_argument(f"--{verb.replace('_', '-')}", type=int, nargs="*", default=sizes, metavar="N")
    parser.add_argument("--limit", type=float, default=3600.0, help="seconds that one measurement may take")
    parser.add_argument("--child", nargs=2, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.child:
        print(json.dumps(child(options.child[0], int(options.child[1]))))
        return
    found: dict[str, Any] = {"machine": machine.facts(), "threads": options.threads, "points": []}
    for verb in VERBS:
        guess = 0.0
        for n in getattr(options, verb):
            point = _point(verb, n, guess, options)
            guess = point.get("bytes_per_site", guess)
            found["points"].append(point)
            print(_words(point), flush=True)
            running.store(options.out, "memory", found)


def _point(verb: str, n: int, guess: float, options: argparse.Namespace) -> dict[str, Any]:
    """Measure in a process of its own, unless the bytes a site of the size before say it will not fit."""
    start = {"verb": verb, "n": n}
    free = machine.available_memory()
    if guess * n * n > free:
        return {**start, "failure": f"would need {guess * n * n / 1e9:.1f} GB; {free / 1e9:.1f} GB are free"}
    return start | running.alone(__file__, ["--child", verb, n], options.threads, options.limit)


def _words(point: dict[str, Any]) -> str:
    start = f"{point['verb']:10} {point['n']:5}^2: "
    if "failure" in point:
        return start + point["failure"]
    return start + (
        f"peak {point['peak'] / 1e9:.2f} GB, of which {point['baseline'] / 1e9:.2f} GB before the heights "
        f"were made: {point['bytes_per_site']:.0f} bytes a site; {point['seconds']:.1f} s; "
        f"{point['iterations']} iterations of the press"
    )


if __name__ == "__main__":
    main()
