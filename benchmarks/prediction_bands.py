"""Measure how often the 95 % bands of a prediction hold the mean growth of many surfaces.

    python benchmarks/prediction_bands.py [--side 128] [--surfaces 40] [SOLID ...]

Self-affine surfaces of one spectrum, 0.2 um a pixel and flat above 3.2 um, under 10 MPa on half-spaces of
3.76 GPa, from 10 ms to 1000 s. The mean and the spread are those of all surfaces, each predicted alone.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import running
from running import line

import asperity as asp

MODULUS = asp.solids.contact_modulus(3.3e9, 0.35)
BRANCHES = [(0.2, 0.1), (0.2, 10.0), (0.2, 1e3)]
LAW = asp.solids.Eyring(rate="1e-5 nm/s", stress="20 MPa")
half_space = partial(asp.solids.half_space, modulus=MODULUS)
SOLIDS = {
    "relaxing": half_space(branches=BRANCHES),
    "relaxing, hardness 0.3 GPa": half_space(branches=BRANCHES, hardness="0.3 GPa"),
    "Eyring": half_space(creep=LAW),
    "Eyring, permanent share 0.3": half_space(creep=LAW, permanent=0.3),
    "Norton, n = 8": half_space(creep=asp.solids.Norton(1e-11, 1e8, 8)),
}


def scan(side: int, seed: int) -> asp.surfaces.Surface:
    """Make one surface."""
    spectrum = {"hurst": 0.8, "roll_off": 3.2, "cutoff": 1.6, "rms_height": 0.05, "spacing": 0.2}
    heights = asp.surfaces.spectral((side, side), **spectrum, seed=seed)
    return asp.surfaces.Surface(heights, unit="um", pixel_size=(0.2, 0.2), length_unit="um")


def main() -> None:
    """Print a line for each solid."""
    parser = running.parser(__doc__)
    parser.add_argument("solids", nargs="*", default=[], metavar="SOLID", help=", ".join(SOLIDS))
    parser.add_argument("--side", type=int, default=128)
    parser.add_argument("--surfaces", type=int, default=40)
    asked = parser.parse_args()
    growths = "mean growth per decade, and A(last)/A(first) - 1"
    print(line("solid", "patches at first", growths, "bands that hold it", "width over 3.92 deviations"))
    how = {"pressure": "10 MPa", "first": 1e-2, "last": 1e3, "per_decade": 2}
    for name in asked.solids or SOLIDS:
        scans = (scan(asked.side, seed) for seed in range(asked.surfaces))
        found = [asp.predict(SOLIDS[name], one, **how) for one in scans]
        patches = np.mean([one.resolved[0].patches for one in found])
        every = [one.growth for one in found]
        for numbers in (
            [(one.per_decade, *one.band) for one in every],
            [np.subtract((one.ratio, *one.ratio_band), 1) for one in every],
        ):
            growth, low, high = np.transpose(numbers)
            mean, held = growth.mean(), int(((low <= growth.mean()) & (growth.mean() <= high)).sum())
            width = (high - low).mean() / (3.92 * np.std(growth, ddof=1))
            said = f"{100 * mean:.3g} %", f"{held} of {len(growth)}", f"{width:.2f}"
            print(line(name, f"{patches:.0f}", *said), flush=True)


if __name__ == "__main__":
    main()
