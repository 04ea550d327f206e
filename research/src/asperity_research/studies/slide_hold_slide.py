r"""Study: slide, hold, slide: static friction against hold time, steady friction against velocity, and D_c.

By Tabor's relation with a constant shear strength, friction is in proportion to the real area of contact.
The rough surface slides by whole sites under a body that keeps its crept shape: at the velocity 1 for a
run-in, and again after each of four rests, and then at other velocities. Rate-and-state friction with the
aging law (J. H. Dieterich, J. Geophys. Res. 84, 2161 (1979), DOI 10.1029/JB084iB05p02161) says without a
direct effect

    at rest      mu(t) = mu_0 + b ln(1 + V t/D_c)
    steady       mu(V) = mu_0 - b ln(V)
    after a rest a small excess falls by a factor e within a slip of D_c.

`asperity.friction.rate_and_state` fits b and D_c to the rests and to the steps of the velocity, by the aging
law and by the slip law. Other slides, with one rest, give the slip that forgets it on surfaces of several
wavelengths.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, Self

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

import asperity.friction as friction
import asperity_research.studies.sliding as sliding
from asperity.fits import Estimate, jackknife
from asperity_research import style
from asperity_research.arrays import Field
from asperity_research.studies.campaigns import Campaign, hold, slide, waves
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.numbers import all_columns, columns, mean, mean_of
from asperity_research.studies.sliding import HALF_SPACE, LATTICE, STEADY, Lines, Slips
from asperity_research.studies.study import Outcome, Study, Words

WORDS = Words.beside(__file__)

HOLDS = (10.0, 100.0, 1e3, 1e4)
VELOCITIES = (10.0, 0.1, 0.01)  # Those after the rests; all slides before are at 1
_SIDE, _RUN_IN, _AGAIN, _STEP, _SLIP = 128, 24, 16, 20, 28

SOLIDS = {"lattice": LATTICE, "half_space": HALF_SPACE}  # By the names of their campaigns
LOADS = {"lattice": (0.01, 0.05), "half_space": (0.02,)}  # Loads a site
_RTOL = {"lattice": 0.02, "half_space": 0.05}
_REST = {"lattice": 10.0, "half_space": 1e3}  # Hold times where wavelengths are varied
_LONGER = {"lattice": (_SIDE, (16.0, 32.0, 64.0)), "half_space": (64, (12.0, 20.0, 32.0))}
"""Sites along a side and longest wavelengths, with shortest ones of a quarter."""

LONGEST = (8.0, 16.0, 32.0, 64.0)  # Longest wavelengths with one shortest, 4 sites, on the lattice

_HISTORY = [
    slide(_RUN_IN),
    *(leg for time in HOLDS for leg in (hold(time), slide(_AGAIN))),
    *(slide(_STEP, velocity) for velocity in VELOCITIES),
]


def _campaigns(surfaces: int, *, quick: bool) -> tuple[Campaign, ...]:
    """Return the campaigns, with so many surfaces each; the quick ones have one load."""

    def campaign(solid: str, name: str, purpose: str, rough: dict[str, Any], **tables: Any) -> Campaign:
        return SOLIDS[solid].campaign(
            name,
            purpose,
            rough | SOLIDS[solid].rough,
            friction={"shear_strength": 1.0},
            aging={"first": 1.0, "per_decade": 1, "rtol": _RTOL[solid]},
            **tables,
        )

    def varied(solid: str, name: str, what: str, side: int, **waves_of: tuple[float, ...]) -> Campaign:
        """Return a rest and a slide on surfaces of several wavelengths."""
        first = {"cutoff": 4.0} | {key: values[0] for key, values in waves_of.items()}
        together: dict[str, Any] = {"combine": "zip"} if len(waves_of) > 1 else {}
        return campaign(
            solid,
            name,
            f"A rest and a slide on surfaces of several {what}",
            waves(side, **first),
            protocol=[slide(_RUN_IN), hold(_REST[solid]), slide(_SLIP)],
            sweep={key: list(values) for key, values in waves_of.items()} | {"seeds": surfaces} | together,
        )

    campaigns = []
    for name, (side, longest) in _LONGER.items():
        loads = [load * _SIDE**2 for load in LOADS[name][: 1 if quick else None]]
        sweep = {"load": loads, "seeds": surfaces}
        purpose = "Rests and steps of the velocity"
        campaigns.append(
            campaign(name, name, purpose, waves(_SIDE, 48.0, 12.0), protocol=_HISTORY, sweep=sweep)
        )
        shortest = tuple(wave / 4 for wave in longest)
        campaigns.append(varied(name, f"waves_{name}", "scales", side, roll_off=longest, cutoff=shortest))
    campaigns.append(varied("lattice", "longest", "longest wavelengths", _SIDE, roll_off=LONGEST))
    return (*campaigns, *sliding.line_campaigns(2 * surfaces))


def slip_of_memory(excess: Field) -> float:
    """Slip over which an excess, at slips of 0, 1, 2 and so on, loses a factor e if it falls exponentially.

    Its sum tells: 1 + e^(-1/D) + ... is 1/(1 - e^(-1/D)).
    """
    total = float(np.sum(excess) / excess[0])
    return 1 / math.log(total / (total - 1)) if total > 1 else 0.0


@dataclass(frozen=True, eq=False)
class Records:
    """Friction of all surfaces of one solid under one load, over its steady friction at the velocity 1.

    The load is that of a site. ``steady`` is friction at the end of the slide at each of the velocities 1,
    then `VELOCITIES`, over that at 1, shape (surfaces, 4).
    """

    solid: str
    load: float
    records: list[friction.Record]
    steady: Field

    @classmethod
    def of(cls, data: xr.Dataset, solid: str, load: float) -> Self:
        """Read them from the campaign of the solid."""
        records, steady = [], []
        last = 1 + 2 * len(HOLDS)
        for seed in data["seed"].values:
            record = data.sel(load=load, seed=seed)
            slides = [*range(0, last, 2), *range(last, last + len(VELOCITIES))]
            ends = [sliding.steady_area(record, leg) for leg in slides]
            slow = np.mean(ends[: -len(VELOCITIES)])
            steady.append(np.array([slow, *ends[-len(VELOCITIES) :]]) / slow)
            time, place, force = (record[name].values for name in ("time", "displacement", "friction"))
            over = force / float(force[0] / record["area"].values[0] * slow)
            of = friction.Record.of_displacement
            records.append(of(time, place, over, strength_at_rest=True, a=0.0, si=False))
        return cls(solid, load / _SIDE**2, records, np.array(steady))

    @property
    def words(self) -> str:
        """Which ones, for a reader."""
        return f"{SOLIDS[self.solid].what}, load {self.load:g}"

    @property
    def rest(self) -> Field:
        """1 and the growth of friction in each of `HOLDS`, shape (surfaces, holds)."""
        peaks = [friction.hold_peaks(record) for record in self.records]
        return np.array([1 + one.peak - one.before for one in peaks])

    def _of_mean(self, number: Callable[[friction.Record], float]) -> Estimate:
        """Estimate a number of the mean record over surfaces."""
        first, samples = self.records[0], np.array([record.friction for record in self.records])
        return jackknife(lambda sample: number(replace(first, friction=sample.mean(axis=0))), samples)

    def ratio_of_b(self) -> Estimate:
        """B of the steps of the velocity over that of the rests, by fits of the aging law."""

        def b(record: friction.Record, events: Literal["steps", "holds"]) -> float:
            return friction.rate_and_state(record, events=events).b

        return self._of_mean(lambda record: b(record, "steps") / b(record, "holds"))

    def explained(self) -> Estimate:
        """Part of the variance of friction that the aging law, fitted to the whole record, explains."""

        def share(record: friction.Record) -> float:
            residual = friction.rate_and_state(record).residual
            return 1 - float(np.var(residual) / np.var(record.friction))

        return self._of_mean(share)

    def laws(self) -> list[dict[str, object]]:
        """Parameters of both laws by rests, by steps and by both, a row each."""
        rows: list[dict[str, object]] = []
        for events in _EVENTS:
            comparison = friction.compare_state_laws(self.records, events=events)
            for law, estimates in comparison.estimates.items():
                fit = comparison.fits[law]
                head = {"solid": self.solid, "load": self.load, "events": events, "law": law}
                misfit = float(np.sqrt(np.mean(fit.residual**2)))
                how = {"determined": fit.determined, "misfit": misfit, "runs": comparison.runs}
                rows.append(head | all_columns(b=estimates["b"], D_c=estimates["D_c"]) | how)
        return rows

    def points(self) -> pd.DataFrame:
        """Friction after each rest and at each velocity, a row each."""
        parts = []
        for quantity, at, sample in (("rest", HOLDS, self.rest), ("steady", (1.0, *VELOCITIES), self.steady)):
            head = {"solid": self.solid, "load": self.load, "what": quantity, "at": at}
            parts.append(pd.DataFrame(head | columns("value", mean(sample), shared=True)))
        return pd.concat(parts).assign(runs=len(self.records))


_EVENTS: tuple[Literal["holds", "steps", "all"], ...] = ("holds", "steps", "all")
FAMILIES = {
    "waves_lattice": "all waves longer, lattice of springs",
    "longest": "only the longest waves longer, lattice of springs",
    "waves_half_space": "all waves longer, half-space",
}
"""Campaigns in which wavelengths are varied."""


def analyse(evidence: Evidence) -> Outcome:
    """Find the growth at rest, the fall with velocity, the laws, and the slip of memory."""
    every = [
        Records.of(evidence[name], name, load) for name in SOLIDS for load in evidence[name]["load"].values
    ]
    slips = {name: _slips(name, evidence[name]) for name in FAMILIES}
    on_lines = [Lines.of(evidence, name) for name in sliding.LINES]
    tables = {
        "points": pd.concat([one.points() for one in every], ignore_index=True),
        "laws": pd.DataFrame([row for one in every for row in one.laws()]),
        "slips": pd.concat([one.table() for one in slips.values()], ignore_index=True),
        "lines": pd.concat([one.contacts() for one in on_lines], ignore_index=True),
    }

    def each(number: Callable[[Records], Estimate]) -> dict[str, Estimate]:
        return {one.words: number(one) for one in every}

    numbers = {
        "logarithm": each(
            lambda one: mean_of(lambda rest: (rest[-1] - rest[-2]) / (rest[1] - rest[0]), one.rest)
        ),
        "explained": each(Records.explained),
        "same_b": each(Records.ratio_of_b),
        "law": each(lambda one: friction.compare_state_laws(one.records).log_ratio),
        "length": {words: slips[name].of_length() for name, words in FAMILIES.items()},
        "resolved": {sliding.LINES[one.name][0]: one.of_length() for one in on_lines},
        "contact": {sliding.LINES[one.name][0]: one.of_patch() for one in on_lines},
    }
    return Outcome(tuple(WORDS.judge(claim, some) for claim, some in numbers.items()), tables)


def _slips(name: str, data: xr.Dataset) -> Slips:
    along = "point" if "point" in data.dims else "roll_off"
    lengths, excesses = [], []
    for at in range(data.sizes[along]):
        runs = data.isel({along: at})
        cutoff = float(runs["cutoff"]) if "cutoff" in runs.coords else float(data.attrs["cutoff"])
        lengths.append(sliding.correlation_length(float(runs["roll_off"]), cutoff))
        areas = [sliding.after_rest(runs.sel(seed=seed)) for seed in runs["seed"].values]
        excesses.append(np.array([one[:-STEADY] / one[-STEADY:].mean() - 1 for one in areas]))
    return Slips(name, np.array(lengths), tuple(excesses), slip_of_memory)


_COLORS = {"waves_lattice": style.INK, "longest": style.INK, "waves_half_space": style.BLUE}
_MARKS = {"lattice": "o", "half_space": "s", "waves_lattice": "o", "longest": "^", "waves_half_space": "s"}


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw static and steady friction, and the slip that forgets a rest."""
    figure, (rest, steady, memory, resolved) = style.panels(6.4, 6.0, 2, 2)
    values, slips = tables["points"], tables["slips"]
    for axis, quantity in ((rest, "rest"), (steady, "steady")):
        shown = values[values["what"] == quantity].sort_values("at", kind="stable")
        for (solid, load), part in shown.groupby(["solid", "load"], sort=False):
            heavy = part["load"].iloc[0] > LOADS[str(solid)][0]
            color = style.INK if solid == "lattice" else style.BLUE
            look: dict[str, Any] = {"label": f"{str(solid).replace('_', '-')}, load {load:g}"}
            look["markerfacecolor"] = None if heavy else "white"
            style.points(axis, part, "at", "value", f"{_MARKS[str(solid)]}-", color, **look)
    looks = {name: (f"{_MARKS[name]}-", _COLORS[name], words) for name, words in FAMILIES.items()}
    style.families(memory, slips, "family", "length", "slip", looks)
    memory.set(xlim=(0, None), ylim=(0, memory.get_ylim()[1] * 1.3))
    style.families(resolved, tables["lines"], "family", "length", "slip", sliding.LINE_LOOKS)
    WORDS.dress(rest, steady, memory, resolved)
    return figure


SLIDE_HOLD_SLIDE = Study(
    **WORDS.study,
    quick=_campaigns(2, quick=True),
    full=_campaigns(4, quick=False),
    analyse=analyse,
    draw=draw,
)
