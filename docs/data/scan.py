"""Make `scan.txt`, a made-up rough surface, as Gwyddion writes text: `python docs/data/scan.py`."""

from pathlib import Path

import numpy as np

import asperity as asp

SIDE, PIXEL = 96, 0.2
"""Pixels along each side, and their size in um."""


def heights():
    """Heights in nm, about as many patches of contact as a band needs."""
    lengths = {"roll_off": 6.0, "cutoff": 1.6, "rms_height": 0.05, "pixel_size": PIXEL}
    return 1e3 * asp.surfaces.spectral((SIDE, SIDE), hurst=0.8, seed=0, **lengths)


if __name__ == "__main__":
    width = f"{SIDE * PIXEL:g} µm"
    header = f"Channel: made up by docs/data/scan.py\nWidth: {width}\nHeight: {width}\nValue units: nm"
    np.savetxt(Path(__file__).with_name("scan.txt"), heights(), "%.1f", header=header, encoding="utf-8")
