"""The pull-off force of balls and flat punches beside closed forms, and what it costs on a rough surface.

    python benchmarks/pull_off.py [--rough N ...]

Prints two tables. The first has the force over 1.5 pi w R of balls and over Kendall's of punches that bore
twenty times that force, by radius, pixels, with centers at three places within a pixel; docs/adhesion.md
quotes it. The second has seconds of the processor for a press and a pull of self-affine surfaces of N x N
sites, of which 5 % are in contact.
"""

from __future__ import annotations

import argparse
import math
import time
import warnings

import numpy as np

import asperity as asp

CENTERS = ((0.0, 0.0), (0.23, 0.41), (0.4, 0.1))
SOLID = asp.solids.half_space(modulus=1.0)


def pressed(heights: np.ndarray, load: float, edges: str = "free") -> asp.Contact:
    """Press heights in pixels."""
    return asp.press(asp.surfaces.Surface(heights, pixel_size=(1.0, 1.0), edges=edges), SOLID, load=load)


def squares(radius: int, center: tuple[float, float]) -> np.ndarray:
    """Squared distance from a center."""
    y, x = (np.arange(2 * radius + 8) - radius - 3.5 + shift for shift in center)
    return y[:, np.newaxis] ** 2 + x**2


def punch(radius: int, center: tuple[float, float]) -> float:
    """Force over that of Kendall; its radius is that of the pixels' area."""
    inside = squares(radius, center) <= radius**2
    expected = math.sqrt(8 * math.pi * 1e-3 * (inside.sum() / math.pi) ** 1.5)
    return pressed(np.where(inside, 0.0, -1e3), 20 * expected).pull_off(1e-3).force / expected


def ball(radius: int, center: tuple[float, float]) -> float:
    """Force over that of Johnson, Kendall and Roberts; the radius is that of the contact at pull-off."""
    first, curvature = math.ceil(1.2 * radius), 10 * radius
    work = 8 * radius**3 / (9 * math.pi * curvature**2)
    contact = pressed(-squares(first, center) / (2 * curvature), 4 / 3 * first**3 / curvature)
    return contact.pull_off(work).force / (1.5 * math.pi * work * curvature)


def main() -> None:
    """Print both tables."""
    flags = argparse.ArgumentParser(description=__doc__)
    flags.add_argument("--rough", type=int, nargs="*", default=[256, 512])
    warnings.simplefilter("ignore", asp.errors.Remark)
    for name, kind in (("punch", punch), ("ball", ball)):
        for radius in (3, 6, 11, 16, 32):
            print(name, radius, *(f"{kind(radius, center):.3f}" for center in CENTERS), flush=True)
    for sites in flags.parse_args().rough:
        heights = asp.surfaces.spectral(
            (sites, sites), hurst=0.8, roll_off=sites / 8, cutoff=8.0, seed=2, rms_height=1.0
        )
        begin = time.process_time()
        contact = pressed(heights, 0.0215 * sites**2 / 4, "reflecting")
        press, begin = time.process_time() - begin, time.process_time()
        pulled = contact.pull_off(0.03)
        took = time.process_time() - begin
        print(
            f"{sites}^2, {contact.contact_fraction:.1%}: press {press:.1f} s, pull-off {took:.1f} s, "
            f"{len(pulled.area)} steps, load over force {pulled.ratio:.2g}",
            flush=True,
        )


if __name__ == "__main__":
    main()
