"""What steady sliding costs, and how far a slide that is marched in time is from it.

    python benchmarks/sliding.py [--sizes 256 1024] [--march]

A self-affine surface with waves from four sites on slides over a half-space with four branches, under a mean
pressure that makes some per cent contact. One thread; seconds are of the processor. Products are those of
forces with the compliance.
"""

from __future__ import annotations

import argparse
import time
import warnings

import numpy as np

import asperity as asp
from asperity.protocols import Slide

BRANCHES = [(0.3, 1e-6), (0.3, 1e-4), (0.2, 1e-2), (0.15, 1.0)]


def curves(sizes: list[int]) -> None:
    """Print a row for 17 speeds, each started from the one before, and for one speed from nothing."""
    columns = ["sites", "speeds", "s", "s a speed", "products a speed", "contact %", "residual"]
    print(f"| {' | '.join(columns)} |\n{'|---' * len(columns)}|")
    solid = asp.solids.half_space(modulus="100 MPa", branches=BRANCHES)
    for n in sizes:
        track = track_of(n)
        for speeds in (np.geomspace(1e-6, 1e2, 17), [1e-3]):
            begun = time.process_time()
            found = asp.steady_sliding(solid, track, pressure="0.2 MPa", speeds=speeds)
            seconds, count = time.process_time() - begun, found.sizes["speed"]
            area = 100 * found["contact_fraction"].values
            cells = [f"{n}^2", count, f"{seconds:.1f}", f"{seconds / count:.2f}"]
            cells += [f"{float(found['products'].mean()):.0f}", f"{area.max():.2g} to {area.min():.2g}"]
            print(f"| {' | '.join(map(str, cells))} | {float(found['residual'].max()):.1e} |", flush=True)


def marched() -> None:
    """Print the friction of a wave that slides for three periods beside that of the steady state."""
    print("| shifts a site | friction of the third period, Pa | off the steady one | s |\n|---|---|---|---|")
    solid = asp.solids.half_space(young=1e6, poisson=0.3, branches=[(0.5, 1.0)])
    length, sites = 32e-6, 32
    heights = 0.5e-6 * np.cos(2 * np.pi * np.arange(sites) / sites)
    wave = asp.surfaces.Surface(heights, "m", (length / sites,), "m")
    begun = time.process_time()
    steady = asp.steady_sliding(solid, wave, speeds=1e-5, pressure=1e4)
    right = 1e4 * steady["hysteresis_friction_coefficient"].item()
    print(f"| steady | {right:.3f} | | {time.process_time() - begun:.2f} |")
    for substeps in (1, 2, 4):
        begun, leg = time.process_time(), Slide(3 * length, 1e-5, substeps=substeps)
        data = asp.age(asp.press(wave, solid, pressure=1e4), [0.0], protocol=leg).dataset
        when, friction = data["time"].values, 1e4 * data["hysteresis_friction_coefficient"].values
        last = data["displacement"].values > 2 * length
        mean = np.trapezoid(friction[last], when[last]) / np.ptp(when[last])
        off = f"{100 * (mean / right - 1):+.2f} %"
        print(f"| {substeps} | {mean:.3f} | {off} | {time.process_time() - begun:.2f} |", flush=True)


def shifts(sizes: list[int], count: int = 8) -> None:
    """Print what a shift of a rough surface costs at 1 mm/s."""
    print("| sites | s a shift | time steps a shift |\n|---|---|---|")
    solid = asp.solids.half_space(modulus="100 MPa", branches=BRANCHES)
    for n in sizes:
        contact = asp.press(track_of(n), solid, pressure="0.2 MPa")
        begun = time.process_time()
        data = asp.age(contact, [0.0], protocol=Slide(count * 1e-6, 1e-3)).dataset
        seconds, steps = time.process_time() - begun, int(data["steps"].sum())
        print(f"| {n}^2 | {seconds / count:.3f} | {steps / count:.0f} |", flush=True)


def track_of(n: int) -> asp.surfaces.Surface:
    """A self-affine track."""
    rough = asp.surfaces.spectral((n, n), hurst=0.8, roll_off=n / 4, cutoff=4.0, rms_slope=0.2, seed=1)
    return asp.surfaces.Surface(rough, unit="um", pixel_size="1 um")


def main() -> None:
    """Measure and print tables."""
    plain = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=plain)
    parser.add_argument("--sizes", type=int, nargs="+", default=[256, 1024])
    parser.add_argument("--march", action="store_true", help="march slides, too")
    asked = parser.parse_args()
    warnings.simplefilter("ignore", asp.errors.Remark)
    curves(asked.sizes)
    if asked.march:
        marched()
        shifts([32, 128])


if __name__ == "__main__":
    main()
