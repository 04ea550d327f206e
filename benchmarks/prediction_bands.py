"""Measure how often the 95 % bands of a prediction hold the mean growth of many surfaces.

    python benchmarks/prediction_bands.py [--side 128] [--surfaces 40] [SOLID ...]

Self-affine surfaces of one spectrum, 0.2 um a pixel and flat above 3.2 um, under 10 MPa on half-spaces of
3.76 GPa, from 10 ms to 1000 s. The mean and the spread are those of all surfaces, each predicted alone.
"""

from __future__ import annotations

import argparse

import numpy as np

import asperity as asp

MODULUS = asp.solids.contact_modulus(3.3e9, 0.35)
BRANCHES = [(0.2, 0.1), (0.2, 10.0), (0.2, 1e3)]
LAW = asp.solids.Eyring(rate="1e-5 nm/s", stress="20 MPa")
SOLIDS = {
    "relaxing": asp.solids.half_space(modulus=MODULUS, branches=BRANCHES),
    "relaxing, hardness 0.3 GPa": asp.solids.half_space(
        modulus=MODULUS, branches=BRANCHES, hardness="0.3 GPa"
    ),
    "Eyring": asp.solids.half_space(modulus=MODULUS, creep=LAW),
    "Eyring, permanent share 0.3": asp.solids.half_space(modulus=MODULUS, creep=LAW, permanent=0.3),
    "Norton, n = 8": asp.solids.half_space(modulus=MODULUS, creep=asp.solids.Norton(1e-11, 1e8, 8)),
}


def scan(side: int, seed: int) -> asp.surfaces.Surface:
    """Make one surface."""
    spectrum = {"hurst": 0.8, "roll_off": 3.2, "cutoff": 1.6, "rms_height": 0.05, "spacing": 0.2}
    heights = asp.surfaces.spectral((side, side), **spectrum, seed=seed)
    return asp.surfaces.Surface(heights, unit="um", pixel_size=(0.2, 0.2), length_unit="um")


def main() -> None:
    """Print a line for each solid."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("solids", nargs="*", default=[], metavar="SOLID", help=", ".join(SOLIDS))
    parser.add_argument("--side", type=int, default=128)
    parser.add_argument("--surfaces", type=int, default=40)
    asked = parser.parse_args()
    print(
        "| solid | patches at first | mean growth per decade, and A(last)/A(first) - 1 | bands that hold it "
        "| width over 3.92 deviations |"
    )
    for name in asked.solids or SOLIDS:
        found = [
            asp.predict(
                SOLIDS[name], scan(asked.side, seed), pressure="10 MPa", first=1e-2, last=1e3, per_decade=2
            )
            for seed in range(asked.surfaces)
        ]
        patches = np.mean([one.resolved[0].patches for one in found])
        for growth, bands in (
            ([one.growth.per_decade for one in found], [one.growth.band for one in found]),
            (
                [one.growth.ratio - 1 for one in found],
                [np.subtract(one.growth.ratio_band, 1) for one in found],
            ),
        ):
            (low, high), mean = np.transpose(bands), np.mean(growth)
            held = int(((low <= mean) & (mean <= high)).sum())
            width = (high - low).mean() / (3.92 * np.std(growth, ddof=1))
            said = f"{100 * mean:.3g} % | {held} of {len(growth)} | {width:.2f}"
            print(f"| {name} | {patches:.0f} | {said} |", flush=True)


if __name__ == "__main__":
    main()
