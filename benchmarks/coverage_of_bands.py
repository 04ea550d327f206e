"""Measure how often what is called 95 % holds the truth, in synthetic cases.

    python benchmarks/coverage_of_bands.py [--cases 500] [--side 64] [held] [dropped] [law] [sliding] [ball]

held, dropped
    Bands of `asperity.predict` on levelled parts of Gaussian surfaces, against a half-space whose relaxation
    table has 1 % of noise: under 6 MPa that stay, and that fall to a quarter after 1000 s. The truth is the
    mean of all parts on the solid itself: what other parts would give on average. With the bands the 95 %
    intervals of the branches that were fitted to the tables.
law
    Bands of `asperity.law` on parts of such surfaces, against the mean of all parts.
sliding
    Bands of `asperity.steady_sliding` on such parts, against the mean of all parts.
ball
    95 % intervals of ``infer --model ball``, from depths of parameters drawn from the prior.
"""

from __future__ import annotations

import itertools
import sys
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np
import running
from running import line

import asperity as asp
from asperity.base.checks import Floats
from asperity.inference.models import of_name
from asperity.inference.problem import Problem
from asperity.inference.sampling import sample

P = asp.protocols
SERIES = asp.relaxation.PronySeries(2110e6, ((0.102, 8.93), (0.106, 118.0)))
TIMES = np.geomspace(0.1, 1e4, 30)
PIXEL, LARGE = 0.2, 1024
SPECTRUM = {"hurst": 0.8, "roll_off": 3.2, "cutoff": 1.6, "rms_height": 0.05, "spacing": PIXEL}
PRESSURE = 6e6
LEGS = [P.Ramp(2.4, pressure=PRESSURE), P.Hold(1000.0), P.Step(pressure=PRESSURE / 4), P.Hold(4000.0)]
AT = {"held": (1.0, 100.0, 1e4), "dropped": (1002.4, 1100.0, 5002.4)}
NAMES = ("contact_area_corrected", "resistance")
RHO = 1e-6
CARRIED = asp.Carried(resistivity=RHO)
PRESSURES = (1e6, 2e6, 4e6, 8e6, 16e6)
OF_TILES = ("contact_fraction", "mean_gap", "stiffness")
RUBBER = {"young": "30 MPa", "poisson": 0.5, "branches": [(0.5, "1 us"), (0.4, "1 ms")]}
SPEEDS, SLIDING = (1e-5, 1e-3, 1e-1), ("hysteresis_friction_coefficient", "contact_area")
PRIORS = {"scale": (0.5, 2.0), "time_1": (1.0, 1e4)}


def parts(side: int, count: int) -> Iterator[asp.surfaces.Surface]:
    """Cut as many levelled parts as are asked for out of large surfaces of one spectrum."""
    along = LARGE // side
    for number in range(count):
        which, place = divmod(number, along**2)
        if not place:
            whole = asp.surfaces.spectral((LARGE, LARGE), **SPECTRUM, seed=which)
        rows, columns = (slice(side * n, side * (n + 1)) for n in divmod(place, along))
        yield asp.surfaces.Surface(
            whole[rows, columns], unit="um", pixel_size=(PIXEL, PIXEL), length_unit="um", edges="reflecting"
        ).level()


def table(seed: int) -> asp.relaxation.Relaxation:
    """Measure the solid with 1 % of noise."""
    noise = 0.01 * np.random.default_rng(seed).standard_normal(TIMES.size)
    return asp.relaxation.Relaxation(TIMES, SERIES.modulus_at(TIMES) * (1 + noise), noise=0.2)


def exact(history: str, part: asp.surfaces.Surface) -> Mapping[str, Floats]:
    """Find what has a band at the times of a history, on the solid itself."""
    solid, at = asp.solids.half_space(modulus=SERIES.modulus, branches=SERIES.branches), AT[history]
    if history == "held":  # the contact of an elastic solid
        pressures = PRESSURE * SERIES.modulus * SERIES.compliance_at(at)
        contacts = asp.press(part, asp.solids.half_space(modulus=SERIES.modulus), pressure=pressures)
        areas, names = [one.contact_area_corrected for one in contacts], NAMES
        return dict(
            zip(names, (np.array(areas), np.array([one.resistance(RHO) for one in contacts])), strict=True)
        )
    data = asp.age(asp.press(part, solid, load=0.0), at, protocol=LEGS, carried=CARRIED).dataset
    return {name: data[name].values[places(data["time"].values, at)] for name in NAMES}


def places(time: Floats, at: Floats) -> Floats:
    """Last entries at some times, which are after a jump."""
    return np.searchsorted(time, np.asarray(at) * (1 + 1e-9)) - 1


def predicted(history: str, side: int, cases: int, tables: int) -> dict[str, float]:
    """Print how often the bands of predictions hold the mean of all parts, and how wide they are."""
    how = {"pressure": PRESSURE, "last": 1e4} if history == "held" else {"protocol": LEGS}
    found, truths, ratios, branches, patches = defaultdict(list), defaultdict(list), [], [], []
    materials = [asp.relaxation.material(table(seed), modulus="contact") for seed in range(tables)]
    for number, part in enumerate(parts(side, cases)):
        material = materials[number % tables]
        one = asp.predict(material, part, first=1.0, per_decade=1, carried=CARRIED, **how)
        at = places(one.time, AT[history])
        for name, truth in exact(history, part).items():
            truths[name].append(truth)
            found[name].append([values[at] for values in (one.series(name), *one.band(name))])
        if one.growth is not None:
            ratios.append(
                [
                    (one.growth.ratio - 1, *np.subtract(one.growth.ratio_band, 1)),
                    (one.growth.per_decade, *one.growth.band),
                ]
            )
        fit = material.fit
        if number < tables and fit is not None and len(fit.series.branches) == len(SERIES.branches):
            branches.append(fit.intervals)
        patches.append([resolved.patches for resolved in one.resolved])
        if number % 50 == 49 or number + 1 == cases:
            print(f"{number + 1} cases, patches {np.mean(patches, axis=0).round(1)}", file=sys.stderr)
            held = show(history, found, truths, np.array(ratios), np.array(branches))
    return held


def tabulated(side: int, cases: int) -> dict[str, float]:
    """Print how often the bands of laws hold the mean of all parts, and how wide they are."""
    solid, names = asp.solids.half_space(modulus="3 GPa"), ("approach", *OF_TILES)
    laws = [
        asp.law(solid, part, pressures=PRESSURES).isel(direction=0, time=0) for part in parts(side, cases)
    ]
    held = {}
    for (place, pressure), name in itertools.product(enumerate(PRESSURES), names):
        columns = (name, f"{name}_low", f"{name}_high")
        rows = np.array([[float(law[column][place]) for column in columns] for law in laws])
        label = f"law: {name} at {pressure:g} Pa"
        held[label] = judge(label, rows, rows[:, 0].mean())
    return held


def slid(side: int, cases: int) -> dict[str, float]:
    """Print how often the bands of steady sliding hold the mean of all parts, and how wide they are."""
    solid, held = asp.solids.half_space(**RUBBER), {}
    for pressure in (5e4, 3e5):
        curves = [
            asp.steady_sliding(solid, part, pressure=pressure, speeds=SPEEDS) for part in parts(side, cases)
        ]
        for name, place in itertools.product(SLIDING, range(len(SPEEDS))):
            columns = name, f"{name}_low", f"{name}_high"
            rows = np.array([[float(curve[column][place]) for column in columns] for curve in curves])
            fraction = np.mean([curve["contact_fraction"][place] for curve in curves])
            label = f"sliding: {name} at {SPEEDS[place]:g} m/s, contact {100 * fraction:.2g} %"
            held[label] = judge(label, rows, rows[:, 0].mean())
    return held


def show(
    history: str,
    found: Mapping[str, list[list[Floats]]],
    truths: Mapping[str, list[Floats]],
    ratios: Floats,
    branches: Floats,
) -> dict[str, float]:
    """Print a line for each band, and return which part of them holds the truth."""
    held = {}
    for name, every in found.items():
        truth = np.mean(truths[name], axis=0)
        for place, time in enumerate(AT[history]):
            said = f"{history}: {name} at {time:g} s"
            held[said] = judge(said, np.array(every)[..., place], truth[place])
    area = np.array(truths[NAMES[0]])
    if ratios.size:
        last, first = area.mean(axis=0)[[-1, 0]]
        judge(f"{history}: A(last)/A(first) - 1", ratios[:, 0], last / first - 1)
        judge(f"{history}: growth per decade", ratios[:, 1], np.mean(ratios[:, 1, 0]))
    for place, number in np.ndindex(branches.shape[1:3] if branches.size else (0, 0)):
        ends, word = branches[:, place, number], ("share", "time")[number]
        judge(f"{word} of branch {place + 1}", ends, SERIES.branches[place][number])
    return held


def judge(name: str, found: Floats, truth: float) -> float:
    """Print how many bands, the last two columns, hold the truth; and their width over 3.92 deviations."""
    low, high = found[:, -2:].T
    known = np.isfinite(low)
    held = ((low <= truth) & (truth <= high))[known].mean()
    width = (high - low)[known].mean() / (3.92 * np.std(found[known, 0], ddof=1))
    cells = [f"{width:.2f}"] if found.shape[1] > 2 else []
    print(line(name, f"{known.sum()} bands", f"{100 * held:.1f} %", *cells), flush=True)
    return float(held)


def ball(cases: int) -> Floats:
    """Print how often 95 % intervals hold the parameters of a ball, of one branch, that were drawn."""
    time = np.geomspace(1, 1e4, 15)
    flat = np.ones_like(time)
    made = of_name("ball", time, flat, priors=PRIORS, quantity="depth")
    problem = Problem(time, flat, 0.01 * flat, made)
    random = np.random.default_rng(5)
    ranks = []
    for seed, truth in enumerate(problem.of_prior(random, cases)):
        depth = made.curve(time, problem.values(truth[np.newaxis]))[0]
        case = replace(problem, value=depth + 0.01 * random.standard_normal(time.size))
        z = sample(case, seed=seed, walkers=400, draws=400, effective=100, agreement=1.05, steps=10).flat
        ranks.append(((z < truth).sum(0)[problem.used] + 0.5) / (len(z) + 1))
        if seed % 50 == 49 or seed + 1 == cases:
            held = ((np.array(ranks) > 0.025) & (np.array(ranks) < 0.975)).mean(axis=0)
            print(line("ball", seed + 1, *(f"{100 * one:.1f} %" for one in held)), flush=True)
    return held


def main() -> None:
    """Print lines of a table."""
    parser = running.parser(__doc__)
    kinds = {"held": None, "dropped": None, "law": tabulated, "sliding": slid}
    parser.add_argument("asked", nargs="*", default=[], choices=[[], *kinds, "ball"])
    parser.add_argument("--side", type=int, default=64)
    parser.add_argument("--tables", type=int, default=500, help="tables among the cases; each takes a second")
    parser.add_argument("--cases", type=int, default=500)
    asked = parser.parse_args()
    for name in asked.asked or (*kinds, "ball"):
        if name == "ball":
            ball(asked.cases)
        elif of_parts := kinds[name]:
            of_parts(asked.side, asked.cases)
        else:
            predicted(name, asked.side, asked.cases, min(asked.tables, asked.cases))


if __name__ == "__main__":
    main()
