"""How fast the model ages: the growth of the area for each e-fold of hold time, beside its cause.

Prints the table of docs/experiments.md: the slope of ln A over ln t between t = 1 and 1e4 (in seconds, or in
1 / (k0 R)), mean over seeds and standard error.
"""

from functools import partial
from pathlib import Path

import numpy as np
from running import head, line

import asperity as asp

WINDOW = (1.0, 1e4)
SEEDS = 4
TIMES = np.geomspace(*WINDOW, 17)
TABLE = Path(__file__).parents[1] / "docs" / "data" / "pmma_like_relaxation.csv"


def slope(times, values):
    """The slope of ln(values) over ln(times), by least squares."""
    return float(np.polyfit(np.log(times), np.log(values), 1)[0])


def aged(surface, solid, **load):
    """The growth of the area of one contact."""
    history = asp.age(asp.press(surface, solid, **load), TIMES)
    return slope(TIMES, history.dataset["area"].values[1:])


def springs(ratio, load, seed, kind="gaussian"):
    """On the lattice of springs; the load is per site and k0."""
    if kind == "gaussian":
        heights = asp.surfaces.gaussian((200, 200), rms=1.0, seed=seed)
    else:
        heights = asp.surfaces.self_affine(256, hurst=0.5, delta=0.01, seed=seed)
    solid = asp.solids.spring_lattice(k0=1.0, k1=ratio, R=1.0)
    return aged(heights, solid, load=load * heights.size)


def polymer(seed):
    """Of a half-space that relaxes like the made-up table; and the relaxation of that table itself."""
    series = asp.relaxation.fit(asp.relaxation.read(TABLE)).series
    shape = (128, 128)
    heights = asp.surfaces.spectral(shape, hurst=0.8, cutoff=4.0, rms_slope=0.1, spacing=0.5, seed=seed)
    surface = asp.surfaces.Surface(heights, unit="um", pixel_size=(0.5, 0.5), length_unit="um")
    modulus = asp.solids.contact_modulus(series.modulus, 0.35)
    solid = asp.solids.half_space(modulus=modulus, branches=series.branches)
    return aged(surface, solid, pressure=0.002 * modulus)


def relaxation():
    """How fast the table itself relaxes."""
    return -slope(TIMES, asp.relaxation.fit(asp.relaxation.read(TABLE)).series.modulus_at(TIMES))


SPRINGS = ((1.0, 0.02), (3.0, 0.002), (3.0, 0.02))
CASES = {
    **{f"springs, k1/k0 = {ratio:g}, F/(N k0) = {p:g}": partial(springs, ratio, p) for ratio, p in SPRINGS},
    "springs, k1/k0 = 3, self-affine, F/(N k0) = 1e-4": lambda seed: springs(3.0, 1e-4, seed, "self_affine"),
    "half-space that relaxes like the table": polymer,
}


def measured(case, seeds=SEEDS):
    """Mean over the seeds, and its standard error."""
    slopes = np.array([CASES[case](seed) for seed in range(seeds)])
    return slopes.mean(), slopes.std(ddof=1) / np.sqrt(seeds)


def main():
    """Print the table."""
    print(*head("model", "d ln A / d ln t", "for each decade"), sep="\n")
    for case in CASES:
        mean, error = measured(case)
        print(line(case, f"{mean:.4f} ± {error:.4f}", f"{10**mean - 1:.1%}"))
    print(f"the table itself: -d ln E / d ln t = {relaxation():.4f}")


if __name__ == "__main__":
    main()
