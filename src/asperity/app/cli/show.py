"""The command ``asperity surface``: what a surface file holds, in words and as a figure."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from asperity.analysis.scan import readable
from asperity.app.cli.output import write_figure
from asperity.app.cli.report import aligned
from asperity.app.config.models import MeasuredSurface
from asperity.figures import surface_figure
from asperity.surfaces import PowerSpectrum, Statistics, Surface, power_spectrum
from asperity.surfaces.prepare import is_length, is_square


def show(settings: MeasuredSurface, target: Path) -> None:
    """Read, describe and draw a surface.

    `AsperityError` if the file cannot be used, or the figure not written.
    """
    file = Path(settings.path)
    # What the instrument wrote, but for holes that cannot be counted with: nothing levelled or mirrored.
    as_found = {"tilt": "none", "periodic": "wrap", "unit": None, "resample": False, "despike": False}
    as_found |= dict.fromkeys(("crop", "longest", "shortest"))
    found = settings.model_copy(update=as_found).build()
    prepared = settings.build()
    # A border that was brought to the mean is no part of what was measured.
    tapered = settings.periodic == "taper"
    scan = settings.model_copy(update={"periodic": "wrap"}).build() if tapered else prepared
    spectrum, note = power_spectrum(scan), _note(prepared, settings)
    figure = surface_figure(prepared, title=file.name, note=note, spectrum=spectrum)
    write_figure(figure, target)
    sys.stdout.write(f"{aligned(_origin(found, prepared))}\n\n")
    sys.stdout.write(f"{aligned(_comparison(found.describe(), prepared.describe()))}\n\n")
    sys.stdout.write(f"{aligned(_spectrum(spectrum))}\n\n")
    sys.stdout.write(f"{aligned(_preparation(prepared))}\n\nfigure written: {target}\n")


def _origin(found: Surface, prepared: Surface) -> list[tuple[str, str]]:
    """Say what the file holds."""
    facts = found.provenance
    shape, size = _listed(facts["original_shape"]), _listed(facts["physical_size"])
    undefined = int(str(facts["undefined_pixels"]))
    pixels = " x ".join(map(str, shape))
    channels = ", ".join(map(str, _listed(facts["channels"])))
    length_unit = str(facts["length_unit"] or "(no unit)")
    rows = [
        ("file", str(facts["file"])),
        ("format", f"{facts['format']}, read by {facts['reader']}"),
        (
            "pixels",
            f"{pixels}{' (rows x columns)' if len(shape) == 2 else ''}, undefined: {undefined or 'none'}",
        ),
        ("size", _lengths(length_unit, *size, digits=6) if size else "not in the file"),
        ("unit of heights", "not in the file" if found.unit == "1" else found.unit),
    ]
    if channels:
        rows.append(("channels", f"{channels}; shown: {facts['channel']}"))
    remarks = list(prepared.remarks)
    if prepared.pixel_size and not is_square(prepared.pixel_size):
        remarks.append(f"pixels of {_sides(prepared)} are not square: springs refuse them; try --resample")
    return rows + [("remark", remark) for remark in remarks]


def _comparison(before: Statistics, after: Statistics) -> list[tuple[str, ...]]:
    """Statistics of the file's heights and of those that a run would get."""
    entries: list[tuple[str, Callable[[Statistics], str]]] = [
        ("sites", lambda s: " x ".join(map(str, s.shape))),
        ("minimum", lambda s: _lengths(s.unit, s.minimum, digits=5)),
        ("maximum", lambda s: _lengths(s.unit, s.maximum, digits=5)),
        ("rms height", lambda s: _lengths(s.unit, s.rms_height, digits=5)),
        ("rms slope", lambda s: f"{s.rms_slope:.4g}{_of(s.slope_unit)}"),
        ("rms curvature", lambda s: f"{s.rms_curvature:.4g}{_of(s.curvature_unit)}"),
        ("skewness", lambda s: f"{s.skewness:.3g}"),
        ("kurtosis (Gaussian: 3)", lambda s: f"{s.kurtosis:.3g}"),
        ("step at the seam / usual step", lambda s: f"{s.seam_ratio:.3g}"),
    ]
    return [("", "in the file", "prepared"), *((name, text(before), text(after)) for name, text in entries)]


def _spectrum(spectrum: PowerSpectrum) -> list[tuple[str, str]]:
    """Say whether the scan is self-affine, and in which range."""
    how = (
        "of the scan itself"
        if spectrum.window == "none"
        else f"of the scan itself, with a {spectrum.window} window"
    )
    fit = spectrum.fit
    hurst = (
        "none: no half decade of wavelengths in which the spectrum is a power law with H from 0 to 1; "
        "use the rms slope, which sets the contact area at light loads, or the spectrum itself"
    )
    if fit is not None:
        low, high = fit.interval
        hurst = (
            f"{fit.hurst:.3f} (95 %: {low:.3f} to {high:.3f}), "
            f"wavelengths from {_lengths(spectrum.length_unit, fit.shortest)} "
            f"to {_lengths(spectrum.length_unit, fit.longest)}"
        )
    return [("power spectrum", how), ("Hurst exponent", hurst)]


def _preparation(prepared: Surface) -> list[tuple[str, str]]:
    """Say what a run would do."""
    facts = prepared.provenance
    unit = str(facts["original_unit"])
    flat = len(_listed(facts["original_shape"])) == 2
    height, *found = (_lengths(unit, value) for value in _listed(facts["tilt_coefficients"]))
    removed = f": removed {height} at the first pixel"
    if facts["tilt_rule"] == "mean":
        removed = f": removed {height}"
    elif flat:
        removed += f", {found[0]} per pixel downward and {found[1]} per pixel to the right"
    else:
        removed += f", {found[0]} per pixel"
    if facts["tilt_rule"] == "quadratic":
        removed += f", and {', '.join(found[2 if flat else 1 :])} per pixel^2"
        removed += " (downward, mixed, to the right)" if flat else ""
    removed = "" if facts["tilt_rule"] == "none" else removed
    cut = " ".join(map(str, _listed(facts.get("crop"))))
    waves = [f"{name} {facts[name]:g}" for name in ("longest", "shortest") if name in facts]
    return [
        *([("part", f"pixels {cut} ({'top bottom left right' if flat else 'left right'})")] if cut else []),
        ("undefined pixels", f"{facts['undefined_rule']} ({facts['undefined_pixels']})"),
        ("tilt", f"{facts['tilt_rule']}{removed}"),
        *(
            [("spikes filled", f"{spikes} pixels")]
            if (spikes := facts.get("despiked_pixels")) is not None
            else []
        ),
        *([("pixels", f"averaged to {_sides(prepared)}")] if facts["resampled"] else []),
        *([("wavelengths kept", f"{', '.join(waves)} {prepared.length_unit or 'pixel'}")] if waves else []),
        (
            "unit",
            "as in the file"
            if facts["scale_factor"] == 1
            else f"{prepared.unit}: heights x {facts['scale_factor']:g}",
        ),
        ("made periodic by", str(facts["periodic_rule"])),
    ]


def _note(prepared: Surface, settings: MeasuredSurface) -> str:
    facts = prepared.provenance
    shape = " × ".join(map(str, _listed(facts["original_shape"])))
    parts = [f"{shape} pixels"]
    if "crop" in facts:
        parts.append("part of them")
    if facts["undefined_pixels"]:
        parts.append(f"{facts['undefined_pixels']} undefined pixels filled")
    if facts["resampled"]:
        parts.append(f"averaged to {_sides(prepared).replace(' x ', ' × ')}")
    if facts.get("despiked_pixels"):
        parts.append(f"{facts['despiked_pixels']} pixels of spikes filled")
    said = {
        "plane": "plane removed",
        "quadratic": "polynomial of second order removed",
        "mean": "mean removed",
    }
    parts.append(said.get(settings.tilt, "tilt kept"))
    if "longest" in facts or "shortest" in facts:
        parts.append("waves left out")
    if settings.periodic == "mirror":
        final = " × ".join(map(str, prepared.shape))
        parts.append(f"mirrored to {final} in a run")
    elif settings.periodic == "taper":
        parts.append("border tapered")
    return ", ".join(parts)


def _sides(surface: Surface) -> str:
    return _lengths(surface.length_unit or "(no unit)", *surface.pixel_size or ())


def _lengths(unit: str, *values: float, digits: int = 4) -> str:
    """Lengths in the unit that makes the largest readable; of another unit as they are."""
    name, factor = readable(unit, max(map(abs, values))) if is_length(unit) else (unit, 1.0)
    return f"{' x '.join(f'{value * factor:.{digits}g}' for value in values)}{_of(name)}"


def _listed(value: object) -> list[Any]:
    return list(value) if isinstance(value, list) else []


def _of(unit: str) -> str:
    return "" if unit == "1" else f" {unit}"
