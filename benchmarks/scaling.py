"""Measure what a site costs against size, load, stiffness ratio, contact fraction and threads.

    python benchmarks/scaling.py                          sizes 64 to 8192, everything else at 512
    python benchmarks/scaling.py --largest 1024 --base 256

`press` and `relax` cost what one contact problem costs; `age` (nine decades, 37 times) is divided by the
contact problems on the way, two for each step. White heights of rms 1, k0 = 1; where nothing else is said
k1 = 1 and F / N = 0.02. Every point is the median of --repeats or more, after one that is not counted. A
point that is predicted to take longer than --limit is left out.

The limit drawn is memory traffic: one sweep over the grid reads u and the heights and writes u, 24 bytes a
site, at the bandwidth measured on the same threads in the same run, the better of copy and triad. No solver
does with less than one sweep; an iterative one takes some tens.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import machine
import matplotlib
import numpy as np
import running
import solvers
import synthetic
from peers.problem import Law, Problem
from prepare import write

SWEEP_BYTES = 24
MOST_REPEATS, ENOUGH_SECONDS = 30, 0.3
VERBS = {"press": "lattice", "relax": "relaxed", "age": "lattice"}
TIMES = [0.0, *np.geomspace(1e-3, 1e6, 37).tolist()]
LOADS = (1e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0, 3.0, 10.0)
RATIOS = (1e-3, 1e-2, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0)


def main() -> None:
    parser = running.parser(__doc__, threads=True, out=True)
    parser.add_argument("--largest", type=int, default=8192)
    parser.add_argument("--base", type=int, default=512, help="size at which everything else is varied")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--limit", type=float, default=120.0, help="seconds that one point may take")
    parser.add_argument("--verbs", nargs="+", default=list(VERBS), choices=VERBS)
    options = parser.parse_args()
    found: dict[str, Any] = {"machine": machine.facts(), "points": []}
    cores = int(str(found["machine"]["cores"]))
    others = {2**k for k in range(cores.bit_length()) if 2**k <= cores} | {cores}
    counts = [options.threads, *sorted(others - {options.threads})]
    found["bandwidth"] = {str(count): machine.bandwidth(count) for count in counts}
    costs: dict[str, float] = {}
    for count in counts:
        for point in _points(options, count, costs):
            found["points"].append(point)
            print(_words(point), flush=True)
            running.store(options.out, "scaling", found)
    draw(found, options.threads, options.base, options.out / "scaling.png")


def _points(options: argparse.Namespace, threads: int, costs: dict[str, float]) -> Iterator[dict[str, Any]]:
    """Every point that is measured on so many threads; ``costs`` are seconds a site, to predict by."""
    worker = solvers.start(solvers.ASPERITY, [], threads)
    try:
        with tempfile.TemporaryDirectory() as folder:
            for verb in options.verbs:
                # Not recorded: the first solve ever compiles.
                _measure(worker, verb, _conditions(options, options.threads)[0], options, Path(folder))
                for conditions in _conditions(options, threads):
                    if costs.get(verb, 0.0) * conditions["n"] ** 2 > options.limit:
                        continue
                    try:
                        point = _measure(worker, verb, conditions, options, Path(folder))
                    except solvers.SolverError as error:
                        print(f"{verb} {conditions}: {error}", flush=True)
                        continue
                    if point["sweep"] == "size":
                        costs[verb] = point["whole_seconds"] / conditions["n"] ** 2
                    yield {**point, "threads": threads}
    finally:
        worker.close()


def _conditions(options: argparse.Namespace, threads: int) -> list[dict[str, Any]]:
    standard = {"n": options.base, "k1": 1.0, "mean_force": 0.02}
    if threads != options.threads:
        return [{"sweep": "threads", **standard, "n": n} for n in (options.base, 4 * options.base)]
    sizes = [2**k for k in range(6, 15) if 2**k <= options.largest]
    return [
        *({"sweep": "size", **standard, "n": n} for n in sizes),
        *({"sweep": "load", **standard, "mean_force": force} for force in LOADS),
        *({"sweep": "ratio", **standard, "k1": k1} for k1 in RATIOS),
        *({"sweep": "threads", **standard, "n": n} for n in (options.base, 4 * options.base)),
    ]


def _measure(
    worker: solvers.Worker, verb: str, conditions: dict[str, Any], options: argparse.Namespace, folder: Path
) -> dict[str, Any]:
    """Time one verb under given conditions."""
    n = conditions["n"]
    path = folder / f"{verb}-{conditions['sweep']}-{n}-{conditions['k1']}-{conditions['mean_force']}.npz"
    law = Law(VERBS[verb], k1=conditions["k1"])
    write(Problem(synthetic.white(n), law, conditions["mean_force"] * n * n), path)
    out = folder / "answer.npz"
    request: dict[str, Any] = {"problem": str(path), "do": "solve", "tolerance": 0.0, "out": str(out)}
    if verb == "age":
        request |= {"do": "age", "times": TIMES, "out": ""}
    seconds = []
    for attempt in range(MOST_REPEATS):
        reply = worker.ask(request, 20 * options.limit)
        # The first compiles and reads; it counts where there will hardly be another.
        if attempt or reply["seconds"] > options.limit / 4:
            seconds.append(reply["seconds"])
        enough = len(seconds) >= options.repeats and sum(seconds) > ENOUGH_SECONDS
        if enough or sum(seconds) > options.limit / 2:
            break
    path.unlink()
    whole = statistics.median(seconds)
    if verb == "age":
        problems, fraction = 2 * (reply["steps"] + reply["rejected"]), reply["contact_fraction"]
    else:
        with np.load(out) as fields:
            problems, fraction = 1, float(fields["in_contact"].mean())
    return {
        **conditions,
        "verb": verb,
        "whole_seconds": whole,
        "problems": problems,
        "nanoseconds_per_site": 1e9 * whole / max(problems, 1) / n**2,
        "iterations": reply["iterations"] / max(problems, 1),
        "contact_fraction": fraction,
    }


def _words(point: dict[str, Any]) -> str:
    return (
        f"{point['verb']:5} {point['sweep']:7} n {point['n']:5} k1 {point['k1']:<6g} "
        f"F/N {point['mean_force']:<6g} threads {point['threads']}: "
        f"{point['nanoseconds_per_site']:8.1f} ns a site and contact problem, "
        f"{point['iterations']:.0f} iterations, contact {100 * point['contact_fraction']:.2f} %, "
        f"whole {point['whole_seconds']:.3g} s"
    )


def _sweep(found: dict[str, Any], threads: int) -> float:
    """Nanoseconds a site in which one sweep moves its bytes."""
    return SWEEP_BYTES / max(found["bandwidth"][str(threads)].values())


def draw(found: dict[str, Any], threads: int, base: int, path: Path) -> None:
    """Draw cost per site against everything, with the time that sweeps over memory take."""
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, panels = plt.subplots(3, 2, figsize=(6.4, 8.4), sharey=True, layout="constrained")
    here = [point for point in found["points"] if point["threads"] == threads]
    limit = _sweep(found, threads)
    views = (
        ("size", "n", "sites along each side", here),
        ("load", "mean_force", f"load per site, k0 rms (n = {base})", here),
        ("ratio", "k1", f"k1 / k0 (n = {base})", here),
        ("load", "contact_fraction", f"contact fraction (n = {base})", here),
        ("threads", "threads", f"threads (n = {base}; dotted: {4 * base})", found["points"]),
    )
    for axes, (sweep, key, label, points) in zip(panels.flat, views, strict=False):
        for k, verb in enumerate(VERBS):
            chosen = [point for point in points if point["sweep"] == sweep and point["verb"] == verb]
            for n, style in ((base, "o-"), (4 * base, "o:")):
                line = [point for point in chosen if sweep != "threads" or point["n"] == n]
                line.sort(key=lambda point: point[key])
                if line and (n == base or sweep == "threads"):
                    costs = [point["nanoseconds_per_site"] for point in line]
                    axes.plot([point[key] for point in line], costs, style, color=f"C{k}", label=verb, ms=4)
        if sweep == "threads":
            counts = sorted(map(int, found["bandwidth"]))
            sweeps = [_sweep(found, count) for count in counts]
            axes.plot(counts, sweeps, "k-", lw=1)
            axes.plot(counts, [30 * value for value in sweeps], "k--", lw=1)
        else:
            axes.axhline(limit, color="k", lw=1, label="1 sweep of memory")
            axes.axhline(30 * limit, color="k", lw=1, ls="--", label="30 sweeps of memory")
        axes.set(xscale="log", yscale="log", xlabel=label)
        if sweep in ("size", "threads"):
            ticks = sorted({point[key] for point in points if point["sweep"] == sweep})
            axes.set_xticks(ticks, labels=map(str, ticks), minor=False)
            axes.set_xticks([], minor=True)
    for row in panels:
        row[0].set_ylabel("ns per site and contact problem")
    panels[2, 1].axis("off")
    panels[2, 1].legend(*panels[0, 0].get_legend_handles_labels(), loc="center", frameon=False)
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    main()
