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
from asperity_research.experiments.apertures import Aperture, of_file, of_picture
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
_COMPARED = ("closure", "form", "left")
_QUANTILES, _BELOW = (
    (10, 50, 90),
    0.595e-3,
)  # Percent of the apertures below, m, as far as histograms were read


def _modulus(young: float, poisson: float) -> float:
    return float(contact_modulus([1e9 * young] * 2, [poisson] * 2))


MODULUS = _modulus((MEASURED["young_low"] + MEASURED["young_high"]) / 2, MEASURED["poisson"])
VARIANTS = {
    "middle": (MODULUS, True, 1.0),
    "softest": (_modulus(MEASURED["young_low"], MEASURED["poisson_low"]), True, 1.0),
    "stiffest": (_modulus(MEASURED["young_high"], MEASURED["poisson_high"]), True, 1.0),
    "not turned": (MODULUS, False, 1.0),
    "finer": (MODULUS, True, 0.5),
}
"""Contact moduli, Pa, whether a face turns freely, and pixels over those of the fits: a band lies between."""


def table(specimen: str) -> tuple[Field, Field]:
    """The stress, Pa, of a specimen up and down, shape (n,), and the closure without the rock's share, m."""
    stress, moved = (MEASURED.series[specimen][column].values for column in ("stress", "displacement"))
    return 1e6 * stress, 1e-3 * (moved - MEASURED["rock"] * (stress - stress[0]))


def cycle(aperture: Aperture, modulus: float, hardness: float | None, stress: Field) -> Field:
    """Mean distance of the faces, m, under each of some stresses, one after the other, shape (n,)."""
    contact = asp.press(aperture.surface, asp.solids.half_space(modulus=modulus, hardness=hardness), load=0)
    gaps = []
    for force in stress * _AREA:
        contact = asp.press(contact, load=force)
        gaps.append(contact.gap[aperture.body].mean())
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
    curves = [np.interp(np.log(fine), np.log(tried), column) for column in predicted.T]
    misfits = np.sqrt(np.mean((np.transpose(curves) - measured) ** 2, axis=1))
    best = int(np.argmin(misfits))
    return float(fine[best]), float(misfits[best])


def read(files: Sequence[Path]) -> dict[str, Aperture]:
    """Apertures of the specimens: of files in their order, or of the pictures in the folder of data."""
    folder = Path(os.environ.get("ASPERITY_DATA", "."), "fracture")
    paths = [*files] or [folder / f"{specimen}_aperture.png" for specimen in SPECIMENS]
    if not files and not all(path.is_file() for path in paths):
        expected = "those of three specimens, which are not ours to give"
        advice = "--surface FILE FILE FILE, from the repository danielvogler/hm_coupled_fracture_response"
        raise InputError("apertures", expected=expected, got="none", advice=advice)
    if len(paths) != len(SPECIMENS):
        raise InputError("--surface", expected=f"a file each of {', '.join(SPECIMENS)}", got=str(len(paths)))
    apertures = {}
    for name, path in zip(SPECIMENS, paths, strict=True):
        width, height = (1e-3 * MEASURED[f"{name}_{side}"] for side in ("width", "height"))
        picture = path.suffix == ".png"
        apertures[name] = of_picture(path, width, height, _END) if picture else of_file(path, _END)
    return apertures


def analyse(_: Evidence, apertures: Mapping[str, Aperture] | None = None) -> Outcome:
    """Fit the hardness, predict the other specimens, and compare."""
    apertures = apertures or read(())
    tables = {name: table(name) for name in SPECIMENS}
    slopes = {
        name: aperture.coarser(_PIXEL).leveling(MODULUS, tables[name][0].max() * _AREA)
        for name, aperture in apertures.items()
    }
    fits, numbers, curves, pixels = [], [], [], []
    for variant, (modulus, turns, pixel) in VARIANTS.items():
        coarse = {name: aperture.coarser(pixel * _PIXEL) for name, aperture in apertures.items()}
        held = {name: aperture.tilted(turns * slopes[name]) for name, aperture in coarse.items()}
        first, (stress, measured) = held[SPECIMENS[0]], tables[SPECIMENS[0]]
        tried = [closures(stress, cycle(first, modulus, hardness, stress)) for hardness in HARDNESSES]
        for hypothesis in HYPOTHESES:
            predicted = np.array([curve[hypothesis] for curve in tried])
            hardness, misfit = fit_hardness(HARDNESSES, predicted, tables[SPECIMENS[0]][1])
            about: dict[str, Any] = {"hypothesis": hypothesis, "variant": variant}
            fits.append(about | {"hardness": hardness, "misfit": misfit})
            for name, aperture in held.items():
                stress, measured = tables[name]
                closure = closures(stress, cycle(aperture, modulus, hardness, stress))[hypothesis]
                ratios = (_compared(stress, closure) / _compared(stress, measured)).tolist()
                of = about | {"specimen": name}
                numbers.append(of | dict(zip(_COMPARED, ratios, strict=True)))
                columns = {"row": np.arange(stress.size), "stress": stress, "closure": closure}
                curves.append(pd.DataFrame(of | columns | {"measured": measured}))
    hardness = next(fit["hardness"] for fit in fits if fit["hypothesis"] == "again")
    for name, aperture in apertures.items():
        stress = tables[name][0][[0, int(np.argmax(tables[name][0])), 0]]
        for some in map(aperture.coarser, (aperture.pixel[0], _PIXEL / 2, _PIXEL)):
            gaps = cycle(some.tilted(slopes[name]), MODULUS, hardness, stress)
            ends = {hypothesis: curve[1] for hypothesis, curve in closures(stress, gaps).items()}
            pixels.append({"specimen": name, "pixel": some.pixel[0]} | ends)
    rows = {"fits": fits, "numbers": numbers, "pixels": pixels}
    frames = {name: pd.DataFrame(records) for name, records in rows.items()}
    frames["closures"] = pd.concat(curves, ignore_index=True)
    return Outcome(tuple(_findings(apertures, frames)), frames)


def _compared(stress: Field, closure: Field) -> Field:
    """Largest closure of a curve, and the parts of it that come early and that stay, shape (3,)."""
    up, most = slice(int(np.argmax(stress)) + 1), closure.max()
    return np.array([most, np.interp(_EARLY, stress[up], closure[up]) / most, closure[-1] / most])


def _band(values: Sequence[float]) -> Estimate:
    """The first value, between the ends of all."""
    low, high = min(values), max(values)
    return estimate(values[0], (high - low) / 2, low, high, 1)


def _findings(apertures: Mapping[str, Aperture], frames: Mapping[str, pd.DataFrame]) -> Iterator[Finding]:
    quantiles = [number for name, aperture in apertures.items() for number in _quantiles(name, aperture)]
    yield WORDS.judge("read", quantiles)
    for hypothesis, which in HYPOTHESES.items():
        finest, ratios = np.nan, {}
        for name, pixel, closure in frames["pixels"][["specimen", "pixel", hypothesis]].itertuples(
            index=False
        ):
            if pixel == apertures[name].pixel[0]:
                finest = closure
            else:
                ratios[f"{name}, {1e3 * pixel:.2g} mm"] = exact(closure / finest)
        yield WORDS.judge("pixel", ratios, key=f"pixel {hypothesis}", which=which)
    other = {name: 1e-3 * MEASURED[f"{name}_other_closure"] / table(name)[1].max() for name in SPECIMENS}
    yield WORDS.judge("other", {name: exact(float(ratio)) for name, ratio in other.items()})
    for hypothesis, which in HYPOTHESES.items():
        fits, rows = (frames[name].set_index("hypothesis").loc[hypothesis] for name in ("fits", "numbers"))
        hardness = _band([*1e-6 * fits["hardness"]])
        yield WORDS.judge("hardness", hardness, key=f"hardness {hypothesis}", which=which)
        for name in _COMPARED:
            bands = {specimen: _band([*rows[rows["specimen"] == specimen][name]]) for specimen in SPECIMENS}
            yield WORDS.judge(name, bands, key=f"{name} {hypothesis}", which=which)


def _quantiles(name: str, aperture: Aperture) -> Iterator[Measurement]:
    """Quantiles of the apertures, mm, beside those of the published histogram, to twice its error."""
    near = aperture.distance[np.nan_to_num(aperture.distance, nan=_END) < _BELOW]
    for percent in _QUANTILES:
        published, value = MEASURED.inputs[f"{name}_aperture_{percent}"], np.percentile(near, percent)
        ends = (published.value + side * float(published.uncertainty) for side in (-2, 2))
        yield Measurement(f"{name}, {percent} %, mm", exact(1e3 * float(value)), *ends)


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw stress against closure, a panel a specimen: bands of what is computed, and what was measured."""
    figure, axes = style.panels(5.4, 8.6, rows=len(SPECIMENS))
    for ax, name in zip(axes, SPECIMENS, strict=True):
        ax.set_title(f"{name}, fitted" if name == SPECIMENS[0] else name, fontsize=9)
        stress, measured = 1e-6 * table(name)[0], 1e3 * table(name)[1]
        top = int(np.argmax(stress))
        for hypothesis, color in {"first": style.BLUE, "again": style.VERMILION}.items():
            rows = tables["closures"].query("specimen == @name and hypothesis == @hypothesis")
            closure = 1e3 * rows.pivot(index="row", columns="variant", values="closure")
            words = f"computed, {HYPOTHESES[hypothesis]}"
            ax.plot(closure["middle"], stress, color=color, linewidth=1.2, label=words)
            for way in (slice(top + 1), slice(top, None)):
                ends = closure.min(axis=1)[way], closure.max(axis=1)[way]
                ax.fill_betweenx(stress[way], *ends, color=color, alpha=0.2, linewidth=0)
        for mark, words, way in (("^", "loading", slice(top + 1)), ("v", "unloading", slice(top + 1, None))):
            look = {"color": style.INK, "markersize": 3.5, "label": f"measured, {words}"}
            ax.plot(measured[way], stress[way], mark, **look)
    WORDS.dress(*axes)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, fontsize=8)
    return figure


FRACTURE_2018 = Study(
    **WORDS.study, quick=(), full=(), analyse=analyse, draw=draw, takes="two to four minutes"
)


def of_files(files: Sequence[Path]) -> Study:
    """The comparison with apertures from files; `InputError` where there are none."""
    return replace(FRACTURE_2018, analyse=partial(analyse, apertures=read(files)))
