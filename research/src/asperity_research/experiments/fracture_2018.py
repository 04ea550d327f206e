"""Rock fractures (2018): how far three of them close under a normal stress, and what stays closed after it.

The two faces of a specimen are one rough body, as far below a flat half-space as the faces are apart, which
ends where the specimen ends. The half-space has the compliance of both faces; one is turned until the contact
under the largest load has no moment. Closure is how much nearer the faces are, averaged over the specimen,
than under the least load: the compression of the rock is not in it, and was taken off what was measured.

* ``first``: the specimens are loaded for the first time since they were scanned.
* ``again``: a hypothesis, they were loaded to the same stress before. Then nothing yields.

One hardness is fitted to all of the first specimen's table, and holds for the others.
"""

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

import asperity as asp
from asperity.errors import InputError
from asperity.fits import Estimate
from asperity.solids import contact_modulus
from asperity_research import style
from asperity_research.arrays import Field
from asperity_research.experiments import apertures
from asperity_research.experiments.apertures import Aperture
from asperity_research.experiments.record import load
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Finding, Measurement, estimate, exact
from asperity_research.studies.study import Outcome, Study, Words

WORDS, MEASURED = Words.beside(__file__), load("fracture-2018")

SPECIMENS = ("vd1", "vd2", "vd3")
HYPOTHESES = {"first": "loaded for the first time", "again": "loaded before"}
HARDNESSES = np.geomspace(20e6, 1e9, 9)
"""Hardnesses that are tried, Pa; between them closures are interpolated."""

_END = 1e-3 * MEASURED["bar_end"]
_AREA = np.pi / 4 * (1e-3 * MEASURED["diameter"]) ** 2
_PIXEL = 1e-3  # m, of the fits; the finest pixels take 50 times as long
_EARLY = 2.0e6  # Pa, up to which the share of the closure shows the form of the curve
_SHOWN = ("closure", "form", "left")
_QUANTILES = (10, 50, 90)  # Percent of the apertures below 0.595 mm, as far as the histograms were read
_READ_TO = 0.595e-3


def _modulus(young: float, poisson: float) -> float:
    return float(contact_modulus([1e9 * young] * 2, [poisson] * 2))


_YOUNG = (MEASURED["young_low"] + MEASURED["young_high"]) / 2
MODULUS = _modulus(_YOUNG, MEASURED["poisson"])
VARIANTS = {
    "middle": (MODULUS, True, 1.0),
    "softest": (_modulus(MEASURED["young_low"], MEASURED["poisson_low"]), True, 1.0),
    "stiffest": (_modulus(MEASURED["young_high"], MEASURED["poisson_high"]), True, 1.0),
    "not turned": (MODULUS, False, 1.0),
    "finer": (MODULUS, True, 0.5),
}
"""Contact moduli, Pa, whether the faces turn freely, and pixels over those of the fits: the ends of a band."""


def table(specimen: str) -> tuple[Field, Field]:
    """The stress, Pa, of a specimen up and down, shape (n,), and the closure without the rock's share, m."""
    stress, moved = (MEASURED.series[specimen][column].values for column in ("stress", "displacement"))
    return 1e6 * stress, 1e-3 * (moved - MEASURED["rock"] * (stress - stress[0]))


def cycle(body: Aperture, modulus: float, hardness: float | None, stress: Field) -> Field:
    """Mean distance of the faces, m, under each of some stresses, one after the other, shape (n,)."""
    solid = asp.solids.half_space(modulus=modulus, hardness=hardness)
    contact = asp.press(body.surface, solid, load=stress[0] * _AREA)
    gaps = [contact.gap[body.body].mean()]
    for later in stress[1:]:
        contact = asp.press(contact, load=later * _AREA)
        gaps.append(contact.gap[body.body].mean())
    return np.array(gaps)


def closures(stress: Field, gaps: Field) -> dict[str, Field]:
    """Closures by hypothesis, m, of a cycle: the second time the way up is that of the first time down."""
    top = int(np.argmax(stress))
    down = np.interp(stress, stress[top:][::-1], gaps[top:][::-1])
    return {"first": gaps[0] - gaps, "again": down[0] - down}


def fit_hardness(tried: Field, predicted: Field, measured: Field) -> tuple[float, float]:
    """Return the hardness of the least rms misfit, and that misfit.

    ``predicted`` are closures at hardnesses that were tried, shape (hardnesses, n); between these they are
    interpolated in the logarithm.
    """
    fine = np.geomspace(tried[0], tried[-1], 401)
    along = [np.interp(np.log(fine), np.log(tried), column) for column in predicted.T]
    misfits = np.sqrt(np.mean((np.transpose(along) - measured) ** 2, axis=1))
    best = int(np.argmin(misfits))
    return float(fine[best]), float(misfits[best])


def found(surfaces: Sequence[Path]) -> dict[str, Aperture]:
    """Apertures of the specimens: of files in their order, or of the pictures in the folder of data."""
    paths = [*surfaces]
    if not paths:
        folder = Path(os.environ.get("ASPERITY_DATA", "."), "fracture")
        paths = [folder / f"{specimen}_aperture.png" for specimen in SPECIMENS]
        if not all(path.is_file() for path in paths):
            advice = "--surface FILE FILE FILE, from the repository danielvogler/hm_coupled_fracture_response"
            raise InputError(
                "apertures",
                expected="those of three specimens, which are not ours to give",
                got="none",
                advice=advice,
            )
    if len(paths) != len(SPECIMENS):
        raise InputError("--surface", expected=f"a file each of {', '.join(SPECIMENS)}", got=str(len(paths)))
    return {name: _read(name, path) for name, path in zip(SPECIMENS, paths, strict=True)}


def _read(name: str, path: Path) -> Aperture:
    if path.suffix != ".png":
        return apertures.of_file(path, _END)
    width, height = (1e-3 * MEASURED[f"{name}_{side}"] for side in ("width", "height"))
    return apertures.of_picture(path, width, height, _END)


def analyse(_: Evidence, bodies: Mapping[str, Aperture] | None = None) -> Outcome:
    """Fit the hardness, predict the other specimens, and compare."""
    bodies = bodies or found(())
    stresses = {name: table(name)[0] for name in SPECIMENS}
    slopes = {
        name: body.coarser(_PIXEL).leveling(MODULUS, stresses[name].max() * _AREA)
        for name, body in bodies.items()
    }
    fits, rows, numbers = [], [], []
    for variant, (modulus, turns, pixel) in VARIANTS.items():
        coarse = {name: body.coarser(pixel * _PIXEL) for name, body in bodies.items()}
        held = {name: body.tilted(turns * slopes[name]) for name, body in coarse.items()}
        fitted, stress = held[SPECIMENS[0]], stresses[SPECIMENS[0]]
        tried = [closures(stress, cycle(fitted, modulus, one, stress)) for one in HARDNESSES]
        for hypothesis in HYPOTHESES:
            predicted = np.array([one[hypothesis] for one in tried])
            hardness, misfit = fit_hardness(HARDNESSES, predicted, table(SPECIMENS[0])[1])
            about: dict[str, Any] = {"hypothesis": hypothesis, "variant": variant}
            fits.append(about | {"hardness": hardness, "misfit": misfit})
            for name, body in held.items():
                stress, measured = table(name)
                one = closures(stress, cycle(body, modulus, hardness, stress))[hypothesis]
                columns = {"row": np.arange(one.size), "stress": stress, "closure": one}
                rows.append(pd.DataFrame(about | {"specimen": name} | columns | {"measured": measured}))
                ratios = _shown(stress, one) / _shown(stress, measured)
                numbers.append(about | {"specimen": name} | dict(zip(_SHOWN, ratios.tolist(), strict=True)))
    hardness = next(one["hardness"] for one in fits if one["hypothesis"] == "again")
    pixels = []
    for name, fine in bodies.items():
        stress = stresses[name][[0, int(np.argmax(stresses[name])), 0]]
        for body in map(fine.coarser, (fine.pixel[0], _PIXEL / 2, _PIXEL)):
            both = closures(stress, cycle(body.tilted(slopes[name]), MODULUS, hardness, stress))
            pixels.append(
                {"specimen": name, "pixel": body.pixel[0]} | {key: one[1] for key, one in both.items()}
            )
    tables = {"fits": fits, "numbers": numbers, "pixels": pixels}
    frames = {name: pd.DataFrame(one) for name, one in tables.items()}
    return Outcome(
        tuple(_findings(bodies, frames)), frames | {"closures": pd.concat(rows, ignore_index=True)}
    )


def _shown(stress: Field, closure: Field) -> Field:
    """Largest closure of a curve, and the parts of it that come early and that stay, shape (3,)."""
    up, most = slice(int(np.argmax(stress)) + 1), closure.max()
    return np.array([most, np.interp(_EARLY, stress[up], closure[up]) / most, closure[-1] / most])


def _band(values: Sequence[float]) -> Estimate:
    """The first value, between the ends of all."""
    low, high = min(values), max(values)
    return estimate(values[0], (high - low) / 2, low, high, 1)


def _findings(bodies: Mapping[str, Aperture], tables: Mapping[str, pd.DataFrame]) -> Iterator[Finding]:
    yield WORDS.judge("read", [one for name, body in bodies.items() for one in _read_off(name, body)])
    pixels = tables["pixels"].set_index(["specimen", "pixel"])
    for hypothesis, which in HYPOTHESES.items():
        over = pixels[hypothesis] / pixels.groupby("specimen")[hypothesis].transform("first")
        coarse = over[over != 1].reset_index()
        at = zip(coarse["specimen"], coarse["pixel"], coarse[hypothesis], strict=True)
        ratios = {f"{name}, {1e3 * pixel:.2g} mm": exact(value) for name, pixel, value in at}
        yield WORDS.judge("pixel", ratios, key=f"pixel {hypothesis}", which=which)
    other = {name: 1e-3 * MEASURED[f"{name}_other_closure"] / table(name)[1].max() for name in SPECIMENS}
    yield WORDS.judge("other", {name: exact(float(one)) for name, one in other.items()})
    for hypothesis, which in HYPOTHESES.items():
        fits = tables["fits"][tables["fits"]["hypothesis"] == hypothesis]["hardness"]
        yield WORDS.judge("hardness", _band([*1e-6 * fits]), key=f"hardness {hypothesis}", which=which)
        rows = tables["numbers"][tables["numbers"]["hypothesis"] == hypothesis]
        for name in _SHOWN:
            numbers = {str(specimen): _band([*values]) for specimen, values in rows.groupby("specimen")[name]}
            yield WORDS.judge(name, numbers, key=f"{name} {hypothesis}", which=which)


def _read_off(name: str, body: Aperture) -> Iterator[Measurement]:
    """Quantiles of the apertures, mm, beside those of the published histogram, to twice its error."""
    near = body.distance[np.nan_to_num(body.distance, nan=_END) < _READ_TO]
    for percent in _QUANTILES:
        known = MEASURED.inputs[f"{name}_aperture_{percent}"]
        ends = (known.value + side * 2 * float(known.uncertainty) for side in (-1, 1))
        yield Measurement(f"{name}, {percent} %, mm", exact(1e3 * float(np.percentile(near, percent))), *ends)


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw stress against closure, a panel a specimen: bands of what is computed, and what was measured."""
    figure, axes = style.panels(7.2, 3.6, len(SPECIMENS))
    for ax, (name, rows) in zip(axes, tables["closures"].groupby("specimen"), strict=True):
        ax.set_title(f"{name}, fitted" if name == SPECIMENS[0] else name, fontsize=9)
        top = int(rows["stress"].iloc[: rows["row"].max() + 1].argmax())
        ways = {"up": ("^", slice(top + 1)), "down": ("v", slice(top + 1, None))}
        for hypothesis, color in {"first": style.BLUE, "again": style.VERMILION}.items():
            one = rows[rows["hypothesis"] == hypothesis]
            middle, by = (
                one[one["variant"] == "middle"],
                1e3 * one.pivot(index="row", columns="variant", values="closure"),
            )
            stress, words = 1e-6 * middle["stress"].to_numpy(), f"computed, {HYPOTHESES[hypothesis]}"
            ax.plot(by["middle"], stress, color=color, linewidth=1.2, label=words)
            for part in (slice(top + 1), slice(top, None)):
                low, high = by.min(axis=1)[part], by.max(axis=1)[part]
                ax.fill_betweenx(stress[part], low, high, color=color, alpha=0.2, linewidth=0)
        for way, (mark, part) in ways.items():
            at = 1e3 * middle["measured"].to_numpy()[part]
            ax.plot(at, stress[part], mark, color=style.INK, markersize=3.5, label=f"measured, {way}")
    WORDS.dress(*axes)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, fontsize=8)
    return figure


FRACTURE_2018 = Study(**WORDS.study, quick=(), full=(), analyse=analyse, draw=draw)


def of_surfaces(surfaces: Sequence[Path]) -> Study:
    """The comparison with apertures from files; `InputError` where there are none."""
    return replace(FRACTURE_2018, analyse=partial(analyse, bodies=found(surfaces)))
