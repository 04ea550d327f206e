r"""Study: the growth of a contact of PMMA, from its activation volume, its modulus and a hardness.

Each site of a half-space flows by Eyring's law v0 sinh(s/s0), s0 = kT/Omega, under its own pressure s. B is
at most s0/s, see `asperity.theory.flowing_area`. The pressure of a contact that flows is 3 sqrt(3) times its
shear stress (D. Tabor and R. von Mises), so Omega is the shear activation volume over 3 sqrt(3). Its energy
of activation Q is such that the surface sinks by 1 nm/s under a hardness H at room temperature:
Q = kT ln(prefactor/(2 nm/s)) + H Omega.
"""

import math
from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from scipy.constants import Boltzmann

from asperity.fits import Estimate, jackknife
from asperity_research import style
from asperity_research.arrays import Field
from asperity_research.studies.campaigns import Campaign, scanned
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.numbers import all_columns, columns, power, slope, within
from asperity_research.studies.study import Outcome, Study, Words

WORDS = Words.beside(__file__)

SHEAR_VOLUME = 8.2e-27 * 0.078**0.6
"""m^3: J. Ho, L. Govaert, M. Utz, Macromolecules 36, 7398 (2003), for 0.078 entanglements a nm^3."""

VOLUME = SHEAR_VOLUME / (3 * math.sqrt(3))  # Activation volume of the pressure, m^3
MODULUS = 3.8e9  # Contact modulus, Pa: Young's modulus 3.3 GPa, Poisson's ratio 0.35, both round
PREFACTOR = 1e4  # m/s: 1e13 attempts a second, 1 nm each
ROOM = 298.15  # K
PRESSURE = 1e7  # Load over nominal area, Pa
_INDENTED = 1e-9  # Velocity under the hardness, m/s
_HARDNESSES, _SLOPES = (3e8, 4e8, 5e8, 6e8), (0.25, 0.5, 1.0)
_TEMPERATURES = (250.0, 275.0, 300.0, 325.0, 350.0)
_MEASURED = (10.0, 1e4)  # Times between which growth is measured, s
_SIDE, _SPACING = 128, 0.1  # Sites along a side, and their distance, um
HARDNESS = 0.3  # Mean contact pressure at which B is stated, GPa: an assumed round number
WANTED = (0.01, 0.02)  # B of static friction of PMMA: T. Baumberger, C. Caroli, Adv. Phys. 55, 279 (2006)


def energy(hardness: float) -> float:
    """Energy of activation with which the surface sinks by 1 nm/s under a hardness, J."""
    thermal = Boltzmann * ROOM
    return float(f"{thermal * math.log(PREFACTOR / (2 * _INDENTED)) + hardness * VOLUME:.4g}")


ACTIVATED = {
    "creep": "eyring",
    "creep_energy": energy(4e8),
    "creep_volume": float(f"{VOLUME:.4g}"),
    "creep_prefactor": PREFACTOR,
    "temperature": ROOM,
}
"""Flow under a hardness of 0.4 GPa, as keys of a solid."""

_FAMILIES: Mapping[str, tuple[str, tuple[float, ...]]] = {
    "hardness": ("creep_energy", tuple(energy(one) for one in _HARDNESSES)),
    "temperature": ("temperature", _TEMPERATURES),
    "roughness": ("rms_slope", _SLOPES),
}
"""What each campaign sweeps."""


def _campaigns(surfaces: int) -> tuple[Campaign, ...]:
    waves = {"roll_off": _SIDE * _SPACING / 2, "cutoff": 8 * _SPACING, "rms_slope": 0.5}
    tables = {
        "surface": scanned(_SIDE, _SPACING, "um", 0.8, **waves),
        "solid": {"kind": "half_space", "modulus": MODULUS, **ACTIVATED},
        "contact": {"pressure": PRESSURE},
        "aging": {"first": 1.0, "last": 1e5, "per_decade": 4, "rtol": 5e-3},
        "output": {"maps_at": []},
    }
    return tuple(
        Campaign(
            name,
            f"Half-spaces with the numbers of PMMA, by {name}",
            tables | {"sweep": {parameter: list(values), "seeds": surfaces}},
        )
        for name, (parameter, values) in _FAMILIES.items()
    )


def rate(time: Field, area: Field) -> float:
    """B: slope of ln of the mean area, shape (runs, times), against ln t."""
    return slope(time, np.log(area.mean(axis=0)), *_MEASURED)


def pressure(time: Field, area: Field) -> float:
    """Mean contact pressure, geometric mean over the times in which B is measured, GPa."""
    logarithms = np.log(area.mean(axis=0)[within(time, *_MEASURED)])
    return 1e-9 * PRESSURE * _SIDE**2 / math.exp(float(logarithms.mean()))


def share(time: Field, area: Field, stress: float) -> float:
    """B over s0/s, for s0 in GPa."""
    return rate(time, area) * pressure(time, area) / stress


def rate_at(time: Field, wanted: float, *areas: Field) -> tuple[float, float]:
    """B at a mean contact pressure, GPa, and the pressure of B = 0.02, by ln B linear in ln s."""
    s, b = (np.log([one(time, area) for area in areas]) for one in (pressure, rate))
    power, shift = np.polyfit(s, b, 1)
    return math.exp(power * math.log(wanted) + shift), math.exp((math.log(WANTED[1]) - shift) / power)


def analyse(evidence: Evidence) -> Outcome:
    """Find B, the mean contact pressure, and what B is of s0/s."""
    rows: list[Mapping[str, object]] = []
    courses, shares, grown = [], dict[tuple[str, float], Estimate](), {}
    for family, (parameter, _) in _FAMILIES.items():
        time, values = np.array(evidence.values(family, "time")), evidence.values(family, parameter)
        grown[family] = tuple(evidence.samples(family, "area", **{parameter: value}) for value in values)
        for value, area in zip(values, grown[family], strict=True):
            head = {"family": family, "at": value}
            stress = 1e-9 * Boltzmann * (value if parameter == "temperature" else ROOM) / VOLUME
            statistics: dict[str, Callable[..., float]] = {
                "B": rate,
                "pressure": pressure,
                "share": partial(share, stress=stress),
            }
            estimates = {key: jackknife(partial(one, time), area) for key, one in statistics.items()}
            shares[family, value] = estimates["share"]
            rows.append(head | {"s0": stress, "runs": len(area)} | all_columns(**estimates))
            courses.append(pd.DataFrame(head | {"time": time, "area": area.mean(axis=0) / _SIDE**2}))
    both = jackknife(partial(rate_at, time, HARDNESS), grown["hardness"])
    rows.append(
        {"family": "B = 0.02", "at": WANTED[1], **columns("pressure", both.part(1)), "runs": both.runs}
    )
    rates = jackknife(
        lambda *areas: power(np.array(_TEMPERATURES), np.array([rate(time, area) for area in areas])),
        grown["temperature"],
    )
    rough = jackknife(lambda one, other: rate(time, one) / rate(time, other), grown["roughness"][::-1][:2])
    flow = {
        f"{1e-9 * hardness:g}": shares["hardness", at]
        for hardness, at in zip(_HARDNESSES, _FAMILIES["hardness"][1], strict=True)
    }
    findings = (
        WORDS.judge("friction", both.part(0), ends=WANTED),
        WORDS.judge("flow", flow),
        WORDS.judge("temperature", rates),
        WORDS.judge("roughness", rough),
    )
    return Outcome(findings, {"numbers": pd.DataFrame(rows), "curves": pd.concat(courses, ignore_index=True)})


_LOOKS = {
    "hardness": ("o", style.INK, "hardness varied"),
    "temperature": ("s", style.VERMILION, "temperature varied"),
    "roughness": ("D", style.BLUE, "roughness varied"),
}


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw areas against time, and B against s0/s."""
    figure, (upper, lower) = style.panels(5.4, 6.6, rows=2)
    curves, numbers = tables["curves"], tables["numbers"]
    selected = curves[(curves["family"] == "hardness") & (curves["time"] > 0)]
    marks = zip(_HARDNESSES, selected.groupby("at"), ("^", "o", "s", "D"), strict=True)
    for hardness, (_, course), mark in marks:
        words = f"{1e-9 * hardness:g} GPa"
        upper.plot(course["time"], 100 * course["area"], f"{mark}-", markersize=3, linewidth=0.8, label=words)
    numbers = numbers.assign(x=numbers["s0"] / numbers["pressure"])
    style.families(lower, numbers, "family", "x", "B", _LOOKS, linewidth=None)
    ends = np.array([0.0, 1.1 * numbers["x"].max()])
    lower.plot(ends, ends, ":", color="0.5", label=r"$B = s_0/s$")
    lower.axhspan(*WANTED, color="0.9", zorder=0, label="friction of PMMA")
    WORDS.dress(upper, lower)
    upper.yaxis.set_major_formatter("{x:g}")
    upper.yaxis.set_minor_formatter("{x:g}")
    return figure


PMMA = Study(**WORDS.study, quick=_campaigns(2), full=_campaigns(8), analyse=analyse, draw=draw)
