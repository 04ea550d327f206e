"""Press half-spaces with an array library, on a graphics card for example, beside the processor.

    benchmarks/gpu.sh                                              on a machine with an NVIDIA card
    python benchmarks/gpu.py --libraries torch --sizes 512 1024    on any machine with PyTorch

Self-affine heights are pressed onto an elastic half-space until some 5 % of the sites touch. Each library and
size is a process of its own, with all cores; what a process does first is a small press, which is not timed.
`numpy` is the processor. The table has, for each: a transform there and back in single and in double
precision (median of seven), the solver with its coarser lattices, the whole press, which publishes fields in
numpy, and what the library holds of the card's memory; and the residual, the largest force off contact or
tension over the mean contact force, which complex transforms in double precision on the processor evaluate
anew. Up to `--largest` sites along a side the processor presses too, and contact sets are compared site by
site.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import tempfile
import time
from pathlib import Path
from typing import Any

import machine
import numpy as np
import running
import scipy.fft
from array_api_compat import array_namespace

import asperity as asp
from asperity.contact.arrays import library

LOAD = 0.022
"""Pressure over modulus and rms slope: some 5 % of the sites touch."""


def main() -> None:
    parser = running.parser(__doc__, out=True)
    parser.add_argument("--libraries", nargs="+", default=["numpy", "cupy", "torch"])
    parser.add_argument("--sizes", nargs="+", type=int, default=[4096, 8192, 16384])
    parser.add_argument(
        "--largest", type=int, default=8192, help="largest side that the processor presses too"
    )
    parser.add_argument("--limit", type=float, default=240.0, help="seconds that one process may take")
    parser.add_argument("--one", nargs=3, metavar=("LIBRARY", "SIZE", "FOLDER"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        name, size, folder = options.one
        print(json.dumps(measured(name, int(size), Path(folder))))
        return
    found: dict[str, Any] = {"machine": machine.facts(), "rows": []}
    titles = (
        "sites",
        "library",
        "transform, single",
        "double",
        "solver, s",
        "press, s",
        "iterations",
        "card, GB",
    )
    print(*running.head(*titles, "contact, %", "residual", "sites that differ"), sep="\n", flush=True)
    threads = int(str(found["machine"]["cores"]))
    with tempfile.TemporaryDirectory() as folder:
        for size in options.sizes:
            for name in options.libraries:
                if name == "numpy" and size > options.largest:
                    continue
                row = running.alone(__file__, ("--one", name, size, folder), threads, options.limit)
                found["rows"].append({"library": name, "size": size, **row})
                running.store(options.out, "gpu", found)
                print(words(name, size, row), flush=True)
    print(json.dumps(found["machine"]))


def heights_of(size: int) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Self-affine heights, Hurst exponent 0.8, rms slope 1, eight waves a side, on all cores."""
    cores, q = os.cpu_count(), np.hypot(np.fft.fftfreq(size)[:, None], np.fft.rfftfreq(size))
    modes = scipy.fft.rfft2(np.random.default_rng(0).standard_normal((size, size)), workers=cores)
    modes *= np.maximum(q, 8 / size) ** -1.8
    modes[0, 0] = 0.0
    heights: np.ndarray[Any, np.dtype[np.float64]] = scipy.fft.irfft2(modes, s=(size, size), workers=cores)
    slope = np.sqrt(np.mean(np.diff(heights, axis=0) ** 2) + np.mean(np.diff(heights, axis=1) ** 2))
    return heights / slope


class Timed(asp.ActiveSet):
    """The solver, and the seconds that it took; coarser lattices are part of them."""

    seconds = 0.0

    def solve(self, problem: Any, guess: Any, accuracy: Any) -> Any:
        begin = time.perf_counter()
        solution = super().solve(problem, guess, accuracy)
        Timed.seconds = time.perf_counter() - begin  # the finest lattice ends last
        return solution


def measured(name: str, size: int, folder: Path) -> dict[str, Any]:
    """Numbers of one library and size."""
    if name == "torch":
        import torch

        torch.set_default_device("cuda" if torch.cuda.is_available() else "cpu")
    solid, solver = asp.solids.half_space(modulus=1.0), Timed(arrays=name)
    small = heights_of(512)
    asp.press(small, solid, pressure=LOAD, solver=solver)
    heights = heights_of(size)
    transforms = {kind: transform(name, heights.astype(kind)) for kind in ("float32", "float64")}
    begin = time.perf_counter()
    contact = asp.press(heights, solid, pressure=LOAD, solver=solver)
    seconds = time.perf_counter() - begin
    found = {
        **transforms,
        "solver_s": Timed.seconds,
        "press_s": seconds,
        "iterations": contact.iterations,
        "contact_fraction": contact.area / heights.size,
        "residual": residual(heights, contact.u, contact.in_contact),
        "memory_gb": memory(name),
    }
    path = folder / f"{size}.npy"
    if name == "numpy":
        np.save(path, contact.in_contact)
    elif path.exists():
        found["differ"] = int(np.count_nonzero(np.load(path) != contact.in_contact))
    return found


def transform(arrays: str, field: Any) -> float:
    """Median seconds of a real transform there and back, waited for."""
    xp, lattice = library(arrays), asp.lattice.Lattice(field.shape)
    there = xp.asarray(field)

    def once() -> float:
        begin = time.perf_counter()
        back = lattice.backward(lattice.forward(there), overwrite=True)
        float(array_namespace(back).sum(back[:1, :1]))  # a number on the processor: all before it is done
        return time.perf_counter() - begin

    once()
    return statistics.median(once() for _ in range(7))


def residual(heights: Any, u: Any, in_contact: Any) -> float:
    """Largest force off contact or tension, over the mean contact force, by complex transforms in double."""
    cores, (n, m) = os.cpu_count(), heights.shape
    modes = scipy.fft.fft2(np.where(in_contact, heights, np.maximum(u, heights)), workers=cores)
    modes *= np.pi * np.hypot(np.fft.fftfreq(n)[:, None], np.fft.fftfreq(m))
    force = scipy.fft.ifft2(modes, workers=cores, overwrite_x=True).real + LOAD
    worst = max(float(np.abs(force[~in_contact]).max()), -float(force[in_contact].min()))
    return worst / float(force[in_contact].mean())


def memory(arrays: str) -> float:
    """Gigabytes of the card that the library holds."""
    if arrays == "cupy":
        import cupy

        return float(cupy.get_default_memory_pool().total_bytes()) / 1e9
    if arrays == "torch":
        import torch

        return float(torch.cuda.max_memory_reserved()) / 1e9 if torch.cuda.is_available() else 0.0
    return 0.0


def words(name: str, size: int, row: dict[str, Any]) -> str:
    """One line of the table."""
    if "failure" in row:
        return running.line(f"{size}²", name, row["failure"])
    return running.line(
        f"{size}²",
        name,
        *(f"{1e3 * row[kind]:.3g} ms" for kind in ("float32", "float64")),
        f"{row['solver_s']:.3g}",
        f"{row['press_s']:.3g}",
        row["iterations"],
        f"{row['memory_gb']:.3g}",
        f"{100 * row['contact_fraction']:.2f}",
        f"{row['residual']:.1e}",
        row.get("differ", ""),
    )


if __name__ == "__main__":
    main()
