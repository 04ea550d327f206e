r"""Study: the force after a partial release of the displacement, and whether it remembers the waiting time.

Two bodies are pressed, held at that displacement for a time t_w, brought apart by a little, and held there.
The force rises for a while, and then falls. Y. Lahini, O. Gottesman, A. Amir, S. M. Rubinstein, Phys. Rev.
Lett. 118, 085501 (2017), DOI 10.1103/PhysRevLett.118.085501, find on crumpled sheets and foams that it is
greatest at a time in proportion to t_w.

With a fixed set of contacts a separable solid is linear: the force after every displacement relaxes as the
modulus E(t), so that, with t from the release on,

    F(t) = [F_0 E(t + t_w) - F_1 E(t)] / E(0),

F_0 being the force at first and F_1 the fall of the force at the release. Where E falls like ln t or like a
power of t, the greatest F comes at a fixed multiple of t_w; where E relaxes with one time there is no
maximum. A rough contact loses contacts in the release and wins some again, so that this is an estimate for
it: the tables have its maximum beside the measured one.
"""

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from asperity.base.words import power
from asperity.fits import jackknife
from asperity.relaxation import PronySeries
from asperity_research import style
from asperity_research.arrays import Field
from asperity_research.studies.campaigns import Campaign, Solid, after_waits, waves
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Measurement, proportion
from asperity_research.studies.numbers import columns, mean, slope, vertex
from asperity_research.studies.study import Outcome, Study, Words

WORDS = Words.beside(__file__)

PROPORTIONAL = (0.95, 1.05)  # Slopes d ln t_max/d ln t_w that bear out that the two are proportional
PROMINENT = 1e-4  # Part of the greatest force by which the first and the last one are to be below it
HAS_MAXIMUM = (0.95, 1.0)  # Shares of the runs with a maximum that bear out that there is one
_WAITING = (1.0, 10.0, 100.0, 1e3, 1e4)
_EXACT = np.geomspace(1e-4, 1e8, 25)
_TIMES = [float(f"{time:.4g}") for time in _EXACT]

_LOGARITHMIC = [[0.03, time] for time in _TIMES]
"""Equal shares, two in a decade: the modulus falls by 0.06 in each decade, for twelve of them."""

_POWER = [
    [float(f"{0.09 * (exact / 1e-4) ** -0.1:.4g}"), time] for exact, time in zip(_EXACT, _TIMES, strict=True)
]
"""Shares that fall as the power -0.1 of their time: so does the modulus, beside what does not relax."""


def _half_space(words: str, branches: list[list[float]], *moves: float) -> Solid:
    held = {"kind": "half_space", "modulus": 1.0, "apparatus": math.inf, "branches": branches}
    return Solid(f"half-space with {words}", held, 0.5, steps=moves)


def _lattice(words: str, *moves: float, **mobilities: float) -> Solid:
    springs = {"kind": "spring_lattice", "k0": 1.0, "k1": 3.0, **mobilities}
    return Solid(f"lattice of springs, {words}", springs, 2.5, steps=moves)


_SOLIDS = {
    "logarithm": _half_space("a modulus that falls like ln t", _LOGARITHMIC, 0.1, 0.2),
    "power": _half_space("a modulus that falls like a power of t", _POWER, 0.1),
    "one_time": _half_space("one relaxation time, 10", [[0.75, 10.0]], 0.1),
    "conserved": _lattice("conserved creep (R = 1)", 0.05, 0.1, R=1.0),
    "viscous": _lattice("viscous creep (R_viscous = 1, R = 0)", 0.1, R=0.0, R_viscous=1.0),
}
"""By name, with the separation at first, and by how much they are brought apart."""

_CASES = [(name, solid, move) for name, solid in _SOLIDS.items() for move in solid.steps]


def _campaigns(waiting: tuple[float, ...], seeds: int) -> tuple[Campaign, ...]:
    """Campaigns by solid and release; on half-spaces with an eighth of the surfaces."""
    rough, white = waves(48, 24.0, rms_height=1.0), {"kind": "gaussian", "shape": [96, 96]}
    on = {True: (rough, seeds // 8), False: (white, seeds)}
    campaigns = []
    for name, solid, move in _CASES:
        surface, count = on["modulus" in solid.table]
        campaign = solid.campaign(
            f"{name}_{move:g}",
            f"Force after a release by {move:g}, with the waiting time as a factor on mobility",
            surface,
            contact={"separation": solid.load},
            aging={"first": 0.01, "per_decade": 8},
            **after_waits({"approach": -move}, waiting, 30.0, count),
        )
        campaigns.append(campaign)
    return tuple(campaigns)


def maximum(time: Field, force: Field) -> float:
    """Time at which a force is greatest: that of the parabola in ln t through the greatest and its neighbors.

    Times above 0 and forces, shape (n,). NaN where the force does not rise to it and fall after it by more
    than a part `PROMINENT`.
    """
    at = int(np.argmax(force))
    if not force[at] - max(force[0], force[-1]) > PROMINENT * abs(force[at]):
        return math.nan
    return vertex(time, force, at)


def superposed(series: PronySeries, waiting: float, fall: float) -> float:
    """Time of the maximum of E(t + t_w) - fall E(t), that of a linear solid; NaN where there is none.

    ``fall`` is that of the force at the release, over the force at first.
    """
    time = np.geomspace(1e-2, 30.0, 241) * waiting
    return maximum(time, series.modulus_at(time + waiting) - fall * series.modulus_at(time))


def _runs(evidence: Evidence, name: str, solid: Solid, move: float) -> pd.DataFrame:
    """Return one row a run: the force at the switches and the time of its maximum."""
    branches = solid.table.get("branches", ())
    series = PronySeries(1.0, tuple((share, time) for share, time in branches))
    folder, rows = f"{name}_{move:g}", []
    seeds = evidence[folder.replace(".", "_")]["seed"].values.tolist()
    for waiting, forces in evidence.waits(folder, "load"):
        each = zip(seeds, forces.after, forces.before, forces.first, strict=True)
        for seed, force, before, first in each:
            fall = float(before - force[0]) / float(first)
            numbers = {
                "before": float(before / first),
                "released": float(force[0] / first),
                "greatest": float(force[1:].max() / first),
                "time_of_maximum": maximum(forces.time[1:] * waiting, force[1:]),
                "superposed": superposed(series, waiting, fall) if branches else math.nan,
            }
            rows.append({"solid": name, "move": move, "waiting": waiting, "seed": seed} | numbers)
    return pd.DataFrame(rows)


def analyse(evidence: Evidence) -> Outcome:
    """Find the maxima, and the slopes of their times."""
    every, ratios, slopes = [], [], []
    judged: dict[str, list[Measurement]] = {name: [] for name in _SOLIDS}
    for name, solid, move in _CASES:
        runs, head = _runs(evidence, name, solid, move), {"solid": name, "move": move}
        times, estimates = (
            runs.pivot(index="seed", columns="waiting", values=number)
            for number in ("time_of_maximum", "superposed")
        )
        waiting, logs = times.columns.to_numpy(dtype=float), np.log(times.to_numpy())
        ratio = columns("ratio", mean(logs - np.log(waiting)), shared=True)
        course = {
            "waiting": waiting,
            **{key: np.exp(values) for key, values in ratio.items()},
            "with_maximum": np.isfinite(logs).mean(axis=0),
            "superposed_ratio": np.exp(np.log(estimates.to_numpy()).mean(axis=0)) / waiting,
            "runs": len(logs),
        }
        measurement = _measured(waiting, logs, f"{solid.what}, released by {move:g}")
        measured = {"measured": "share" if (measurement.low, measurement.high) == HAS_MAXIMUM else "slope"}
        facts = {"runs": measurement.estimate.runs, "verdict": measurement.verdict.value}
        slopes.append(head | measured | columns("value", measurement.estimate, shared=True) | facts)
        every.append(runs)
        ratios.append(pd.DataFrame(head | course))
        judged[name].append(measurement)
    tables = {
        "runs": pd.concat(every, ignore_index=True),
        "ratios": pd.concat(ratios, ignore_index=True),
        "slopes": pd.DataFrame(slopes),
        "forces": _forces(evidence),
    }
    findings = (WORDS.judge("proportional", measured, key=name) for name, measured in judged.items())
    return Outcome(tuple(findings), tables)


def _measured(waiting: Field, logs: Field, solid: str) -> Measurement:
    """Slope of the mean of ln t_max, shape (runs, waiting times), where each run has one; or their share."""
    shared = np.isfinite(logs).all(axis=0)
    if shared.sum() > 2:
        fitted = jackknife(lambda some: slope(waiting[shared], some.mean(axis=0)), logs[:, shared])
        words = f"slope of ln <i>t</i><sub>max</sub> against ln <i>t</i><sub>w</sub>: {solid}"
        return Measurement(words, fitted, *PROPORTIONAL)
    fitted = proportion(int(np.isfinite(logs).sum()), logs.size)
    words = f"share of the runs in which the force has a maximum: {solid}"
    return Measurement(words, fitted, *HAS_MAXIMUM)


def _forces(evidence: Evidence) -> pd.DataFrame:
    """Return force over that at first against the time since the release, of the first surface."""
    name, _, move = _CASES[0]
    parts = []
    for waiting, forces in evidence.waits(f"{name}_{move:g}", "load"):
        course = {"time": forces.time[1:] * waiting, "force": forces.after[0, 1:] / forces.first[0]}
        parts.append(pd.DataFrame({"waiting": waiting, **course}))
    return pd.concat(parts, ignore_index=True)


_LOOKS = {
    "logarithm": ("o", style.INK),
    "power": ("s", style.BLUE),
    "conserved": ("^", style.VERMILION),
    "viscous": ("D", style.SKY),
}


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw the force after the release, and the times of its maxima."""
    figure, (upper, lower) = style.panels(5.4, 6.6, rows=2)
    forces, ratios = tables["forces"], tables["ratios"]
    for _, part in forces.groupby("waiting"):
        greatest = part.iloc[int(part["force"].to_numpy().argmax())]
        upper.plot(part["time"], part["force"], "-", color=style.INK, linewidth=0.9)
        upper.plot(greatest["time"], greatest["force"], "o", color=style.INK, markersize=4)
        upper.annotate(
            rf"$t_\mathrm{{w}}={power(float(part['waiting'].iloc[0]))}$",
            (part["time"].iloc[0], part["force"].iloc[0]),
            xytext=(0, -9),
            textcoords="offset points",
            fontsize=7,
        )
    for (name, move), part in ratios.groupby(["solid", "move"], sort=False):
        if name not in _LOOKS or part["ratio"].isna().all():
            continue
        mark, color = _LOOKS[str(name)]
        look = {"label": f"{str(name).replace('_', ', ')}, {move:g}"}
        look["markerfacecolor"] = color if move == _SOLIDS[str(name)].steps[0] else "white"
        style.points(lower, part, "waiting", "ratio", f"{mark}-", color, **look)
        if not part["superposed_ratio"].isna().any():
            lower.plot(part["waiting"], part["superposed_ratio"], ":", color=color, linewidth=1.2)
    WORDS.dress(upper, lower)
    return figure


RELEASE = Study(
    **WORDS.study,
    quick=_campaigns(_WAITING[:3], seeds=16),
    full=_campaigns(_WAITING, seeds=32),
    analyse=analyse,
    draw=draw,
)
