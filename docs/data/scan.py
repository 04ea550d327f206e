"""Make `scan.txt`, a made-up rough surface, in the form in which Gwyddion writes text: `python docs/data/scan.py`."""

from pathlib import Path

import numpy as np

import asperity as asp

SIDE, PIXEL = 96, 0.2  # pixels; um

heights = asp.surfaces.spectral(
    (SIDE, SIDE), hurst=0.8, roll_off=6.0, cutoff=1.6, rms_height=0.05, pixel_size=PIXEL, seed=0
)
header = "\n".join(
    [
        "Channel: made up by docs/data/scan.py",
        f"Width: {SIDE * PIXEL:g} µm",
        f"Height: {SIDE * PIXEL:g} µm",
        "Value units: nm",
    ]
)
np.savetxt(
    Path(__file__).with_name("scan.txt"), 1e3 * heights, fmt="%.1f", header=header, encoding="utf-8"
)
