"""Which edges should a part of a larger surface have? Parts with each, beside the same parts of the whole.

    python benchmarks/edges.py [SCAN ...]

A whole surface is pressed and ages; then each of its quarters alone, at the same mean pressure, with edges
that reflect, that are free, and made periodic as it is. What is compared is the area of a quarter over its
area within the whole, the growth over three decades over that within the whole, and how many times its fair
share of the contact lies within a sixteenth of the side from the edges. Medians over quarters and surfaces.
"""

from __future__ import annotations

import dataclasses
import itertools
import sys
from collections.abc import Iterator

import numpy as np

import asperity as asp

SOLID = asp.solids.half_space(modulus=1e9, branches=[(0.4, 1.0), (0.3, 100.0)])
TIMES = [0.1, 100.0]
SHARES = 0.005, 0.05
"""Mean pressures, over E* times the rms slope: about 1 % and 10 % of contact."""


def wholes(files: list[str]) -> Iterator[tuple[str, asp.surfaces.Surface]]:
    """Surfaces of 256 x 256 sites; scans as far as they are square."""
    kinds = {"self-affine": None, "rolled off at a quarter": 64.0, "at a sixteenth": 16.0}
    for name, roll_off in kinds.items():
        for seed in range(3):
            made = asp.surfaces.spectral((256, 256), hurst=0.8, roll_off=roll_off, cutoff=4.0, seed=seed)
            yield name, asp.surfaces.Surface(1e-7 * made, "m", 1e-6, "m")
    for file in files:
        scan = asp.surfaces.read(file, periodic="reflect", tilt="quadratic", unit="m")
        n = min(scan.shape) // 2 * 2
        yield file.rpartition("/")[2], scan.crop([0, n, 0, n])


def aged(surface: asp.surfaces.Surface, pressure: float) -> list[np.ndarray]:
    """Contacts at the times."""
    start = asp.press(surface, SOLID, pressure=pressure)
    fields = asp.age(start, TIMES, fields_at=TIMES).dataset["in_contact"].values
    return list(fields)


def at_edges(touching: np.ndarray) -> float:
    """Share of the contact near the edges, over the share of the area that is near them."""
    n = touching.shape[0]
    inner = slice(n // 16, n - n // 16)
    near = np.ones_like(touching)
    near[inner, inner] = False
    return float(touching[near].sum() / touching.sum() / near.mean())


def main() -> None:
    """Print the table."""
    rows: dict[tuple[str, float, str], list[tuple[float, float, float]]] = {}
    for name, whole in wholes(sys.argv[1:]):
        for share in SHARES:
            pressure = share * 1e9 * whole.describe().rms_slope
            truth = aged(whole, pressure)
            half = whole.shape[0] // 2
            for top, left in itertools.product((0, half), repeat=2):
                cut = slice(top, top + half), slice(left, left + half)
                first, last = (int(one[cut].sum()) for one in truth)
                if first < 20:
                    continue
                part = whole.crop([top, top + half, left, left + half])
                for edges in ("reflecting", "free", "periodic"):
                    begun, ended = aged(dataclasses.replace(part, edges=edges), pressure)
                    growth = (ended.sum() / begun.sum()) / (last / first)
                    found = begun.sum() / first, growth, at_edges(begun)
                    rows.setdefault((name, share, edges), []).append(found)
    names = ("p/(E* slope)", "edges", "area", "spread", "growth", "at edges")
    print(f"{'surface':26}" + "".join(f"{name:>13}" for name in names))
    for (name, share, edges), found in rows.items():
        area, growth, near = np.median(found, axis=0)
        spread = np.exp(np.std(np.log([one[0] for one in found])))
        numbers = "".join(f"{x:13.3f}" for x in (area, spread, growth, near))
        print(f"{name:26}{share:13g}{edges:>13}{numbers}")


if __name__ == "__main__":
    main()
