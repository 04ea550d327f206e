"""A surface file as it is and as a run prepares it, in rows and as a figure."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from asperity.app.runs.words import described
from asperity.ask.surface import MeasuredSurface, SurfaceSection
from asperity.base.readable import is_length, readable
from asperity.base.rows import Row, aligned, words_of
from asperity.base.rows import remarks as rows_of_remarks
from asperity.base.words import to_digits
from asperity.figures import Drawing, surface_figure
from asperity.surfaces import PowerSpectrum, Statistics, Surface, power_spectrum
from asperity.surfaces.prepare import is_square
from asperity.surfaces.provenance import understood

# The data of the instrument, neither levelled nor mirrored, with undefined pixels filled.
_AS_FOUND: dict[str, Any] = {
    **{"tilt": "none", "lines": "none", "periodic": "wrap", "resample": False, "despike": False},
    **dict.fromkeys(("unit", "crop", "longest", "shortest")),
}


def drawn_and_described(settings: SurfaceSection) -> tuple[Callable[[], Drawing], str]:
    """Make or read a surface: what draws it, and its description; `AsperityError` if it cannot be used."""
    if not isinstance(settings, MeasuredSurface):
        surface = settings.build()
        facts = words_of([Row("surface", described(settings)), Row("edges", surface.edges)])
        draw = partial(surface_figure, surface, title=settings.kind.replace("_", " "))
        return draw, f"{aligned(facts)}\n\n{aligned(_comparison(made=surface.describe()))}"
    unprepared, prepared = settings.but(**_AS_FOUND).build(), settings.build()
    # The border of a tapered scan was not measured.
    scan = settings.but(periodic="wrap").build() if settings.rule == "taper" else prepared
    spectrum = power_spectrum(scan) if np.isfinite(scan.heights).all() else None
    done, shape = _preparation(prepared), prepared.provenance["original_shape"]
    note = ", ".join([f"{' × '.join(map(str, shape))} pixels", *(short for *_, short in done if short)])
    title = Path(settings.path).name
    draw = partial(surface_figure, prepared, title=title, note=note, spectrum=spectrum)
    blocks: tuple[list[Any], ...] = (
        words_of(_origin(unprepared, prepared)),
        _comparison(**{"in the file": unprepared.describe(), "prepared": prepared.describe()}),
        words_of(_spectrum(spectrum)),
        [(name, text) for name, text, _ in done],
    )
    return draw, "\n\n".join(map(aligned, blocks))


def _origin(raw: Surface, prepared: Surface) -> list[Row]:
    facts = raw.provenance
    shape, size, undefined = facts["original_shape"], facts["physical_size"], facts["undefined_pixels"]
    pixels = f"{' x '.join(map(str, shape))}{' (rows x columns)' * (len(shape) == 2)}"
    rows = [
        Row("file", facts["file"]),
        Row("format", f"{facts['format']}, read by {facts['reader']}"),
        Row("pixels", f"{pixels}, undefined: {undefined or 'none'}"),
        Row("size", _lengths(facts["length_unit"], *size, digits=6) if size else "not in the file"),
        Row("unit of heights", "not in the file" if raw.unit == "1" else raw.unit),
    ]
    remarks = list(prepared.remarks)
    if prepared.pixel_size and not is_square(prepared.pixel_size):
        remarks.append(f"pixels of {_sides(prepared)} are not square: springs refuse them; try --resample")
    return rows + understood(facts) + rows_of_remarks(*remarks)


def _comparison(**columns: Statistics) -> list[tuple[str, ...]]:
    """Statistics of heights: of the file's and those that a run would get, or of those that were made."""
    entries: list[tuple[str, Callable[[Statistics], str]]] = [
        ("sites", lambda s: " x ".join(map(str, s.shape))),
        ("minimum", lambda s: _lengths(s.unit, s.minimum, digits=5)),
        ("maximum", lambda s: _lengths(s.unit, s.maximum, digits=5)),
        ("rms height", lambda s: _lengths(s.unit, s.rms_height, digits=5)),
        ("rms slope, by differences", lambda s: f"{s.rms_slope:.4g}{_of(s.slope_unit)}"),
        ("rms curvature", lambda s: f"{s.rms_curvature:.4g}{_of(s.curvature_unit)}"),
        ("skewness", lambda s: to_digits(s.skewness, 3)),
        ("kurtosis (Gaussian: 3)", lambda s: to_digits(s.kurtosis, 3)),
        ("step at the seam / usual step", lambda s: to_digits(s.seam_ratio, 3)),
    ]
    return [("", *columns), *((name, *map(text, columns.values())) for name, text in entries)]


def _spectrum(spectrum: PowerSpectrum | None) -> list[Row]:
    if spectrum is None:
        return [Row("power spectrum", "none: the body does not cover its lattice; try --crop")]
    how = "of the scan itself" + f", with a {spectrum.window} window" * (spectrum.window != "none")
    hurst = (
        "none: no half decade of wavelengths in which the spectrum is a power law with H from 0 to 1; "
        "use the rms slope, which sets the contact area at light loads, or the spectrum itself"
    )
    if (fit := spectrum.fit) is not None:
        low, high = fit.interval
        first, last = (_lengths(spectrum.length_unit, one) for one in (fit.shortest, fit.longest))
        hurst = f"{fit.hurst:.3f} (95 %: {low:.3f} to {high:.3f}), wavelengths from {first} to {last}"
    rows = [Row("power spectrum", how), Row("Hurst exponent", hurst)]
    return rows + rows_of_remarks(*spectrum.remarks)


def _preparation(prepared: Surface) -> list[tuple[str, str, str]]:
    """Preparation by a run: a name, a text, and a short text for a figure, which may be empty."""
    facts, rows = prepared.provenance, []
    if cut := facts.get("crop"):
        sides = "top bottom left right" if len(cut) == 4 else "left right"
        rows.append(("part", f"pixels {' '.join(map(str, cut))} ({sides})", "part of them"))
    tilt, undefined, spikes = facts["tilt_rule"], facts["undefined_pixels"], facts.get("despiked_pixels")
    short = {"none": "tilt kept", "quadratic": "polynomial of second order removed"}
    rows.append(("tilt", f"{tilt}{_removed(prepared)}", short.get(tilt, f"{tilt} removed")))
    if spikes is not None:
        filled = f"{spikes} pixels of spikes filled" * bool(spikes)
        rows.append(("spikes filled", f"{spikes} pixels", filled))
    if facts["lines_rule"] != "none":
        rows.append(("lines", f"{facts['lines_rule']} of each row removed", "lines levelled"))
    treated = "without body" if facts["undefined_rule"] == "no-body" else "filled"
    treated = f"{undefined} undefined pixels {treated}" * bool(undefined)
    rows.append(("undefined pixels", f"{facts['undefined_rule']} ({undefined})", treated))
    if facts["resampled"]:
        averaged = f"averaged to {_sides(prepared)}"
        rows.append(("pixels", averaged, averaged.replace(" x ", " × ")))
    if waves := [f"{name} {facts[name]:g}" for name in ("longest", "shortest") if name in facts]:
        band = f"{', '.join(waves)} {prepared.length_unit or 'pixel'}"
        rows.append(("wavelengths kept", band, "waves left out"))
    scaled = f"{prepared.unit}: heights x {facts['scale_factor']:g}"
    rows.append(("unit", "as in the file" if facts["scale_factor"] == 1 else scaled, ""))
    shorts = {"mirror": f"mirrored to {' × '.join(map(str, prepared.shape))} in a run"}
    around = (shorts | {"taper": "border tapered"}).get(facts["periodic_rule"], "")
    return [*rows, ("edges", ", ".join(filter(None, (prepared.edges, around))), around)]


def _removed(prepared: Surface) -> str:
    facts = prepared.provenance
    if (rule := facts["tilt_rule"]) == "none":
        return ""
    height, *terms = (_lengths(facts["original_unit"], value) for value in facts["tilt_coefficients"])
    if rule == "mean":
        return f": removed {height}"
    flat = len(facts["original_shape"]) == 2
    removed = f": removed {height} at the first pixel, {terms[0]} per pixel"
    if flat:
        removed += f" downward and {terms[1]} per pixel to the right"
    if rule == "quadratic":
        removed += f", and {', '.join(terms[1 + flat :])} per pixel^2"
        removed += " (downward, mixed, to the right)" * flat
    return removed


def _sides(surface: Surface) -> str:
    return _lengths(surface.length_unit, *surface.pixel_size or ())


def _lengths(unit: str | None, *values: float, digits: int = 4) -> str:
    """Lengths in the unit that makes the largest readable; of another unit as they are."""
    name, factor = readable(unit, max(map(abs, values))) if is_length(unit) else (unit or "(no unit)", 1.0)
    return f"{' x '.join(f'{value * factor:.{digits}g}' for value in values)}{_of(name)}"


def _of(unit: str) -> str:
    return "" if unit == "1" else f" {unit}"
