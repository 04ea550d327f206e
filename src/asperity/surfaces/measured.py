"""Measured surfaces: from a file to heights that are ready for the solver, and the record of the way."""

from __future__ import annotations

import dataclasses
import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Literal, get_args

import numpy as np
from numpy.typing import DTypeLike, NDArray

from asperity.checks import number as checked_number
from asperity.errors import InputError, SurfaceFileError
from asperity.lattice import Edges, Field
from asperity.surfaces import prepare
from asperity.surfaces.heights import check_heights
from asperity.surfaces.instruments import read_instrument
from asperity.surfaces.matrix_files import read_npy, read_npz, read_text
from asperity.surfaces.raw import RawSurface
from asperity.surfaces.statistics import Statistics, statistics

Undefined = Literal["fill", "refuse"]
Tilt = Literal["plane", "mean", "none"]
Periodic = Literal["mirror", "taper", "wrap"]
Unit = Literal["m", "mm", "um", "nm", "pm", "rms"]
Provenance = dict[str, str | int | float | bool | list[int] | list[float] | list[str]]

TAPER_BORDER = 0.1
# Beyond it, moments of the heights would overflow; only damage or a wrong byte order leads there.
_LARGEST = 1e60
_TEXT_SUFFIXES = (".txt", ".csv", ".dat")
_OUTLYING = 6.0
"""Robust standard deviations above the median beyond which a height is counted as an outlier; no Gaussian
surface of less than a thousand million pixels has any."""


@dataclass(frozen=True, eq=False)
class Surface:
    """A surface with its unit and its history; if its pixels are square, it can be given for heights.

    Parameters
    ----------
    heights
        Shape ``(n,)`` or ``(n, m)``, float64, finite; kept as a read-only copy.
    unit
        Unit of the heights: "nm", ..., "rms" (of its own rms height), or "1" if none is known.
    pixel_size
        Distance between sites along each axis in `length_unit`, or None if unknown.
    length_unit
        Unit of the pixel size, or None if unknown.
    provenance
        Where it comes from, and everything that was done to it.
    """

    heights: Field
    unit: str = "1"
    pixel_size: tuple[float, ...] | None = None
    length_unit: str | None = None
    provenance: Provenance = dataclasses.field(default_factory=dict)

    def __post_init__(self) -> None:
        heights = check_heights(self.heights)
        heights.flags.writeable = False
        object.__setattr__(self, "heights", heights)

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        """Heights for those who take the pixels as square; `heights` are the same without this check."""
        if self.pixel_size is not None and not prepare.is_square(self.pixel_size):
            unit = f" {self.length_unit}" if self.length_unit else ""
            between_rows, between_columns = (f"{size:.4g}{unit}" for size in self.pixel_size)
            raise InputError(
                "heights",
                expected="square pixels",
                got=f"{between_rows} between rows and {between_columns} between columns",
                advice=f"resample = true (--resample): means over {max(self.pixel_size):.4g}{unit}",
            )
        return np.array(self.heights, dtype=dtype, copy=copy)

    edges: ClassVar[Edges] = "periodic"

    @property
    def has_lengths(self) -> bool:
        """Whether the heights have a unit of length."""
        return prepare.is_length(self.unit)

    def in_meters(self) -> tuple[Field, tuple[float, ...]]:
        """Heights and spacing in m."""
        assert self.pixel_size
        assert self.length_unit
        lateral = prepare.length_factor(self.length_unit, "m")
        heights = self.heights * prepare.length_factor(self.unit, "m")
        return heights, tuple(size * lateral for size in self.pixel_size)

    @property
    def shape(self) -> tuple[int, ...]:
        """Sites along each axis."""
        return self.heights.shape

    @property
    def remarks(self) -> tuple[str, ...]:
        """What whoever presses it should know: what its reader remarked, and heights that may be none."""
        facts = self.provenance
        told, count = facts.get("reader_remarks", []), facts.get("outlying_pixels", 0)
        remarks = tuple(map(str, told)) if isinstance(told, list) else ()
        if count:
            remarks += (
                f"pixels more than {_OUTLYING:g} robust standard deviations above the median height: "
                f"{count}, up to {facts['outlying_height']:.3g}; spikes would carry the load",
            )
        return remarks

    def describe(self) -> Statistics:
        """Measure the surface.

        The slope is a pure number where heights and pixel size both have units of length, else in
        ``unit / length_unit`` or ``unit / pixel``.
        """
        size, lateral = self.pixel_size, self.length_unit
        if (
            size is not None
            and lateral is not None
            and prepare.is_length(self.unit)
            and prepare.is_length(lateral)
        ):
            factor = prepare.length_factor(lateral, self.unit)
            size, slope_unit = tuple(s * factor for s in size), "1"
        else:
            slope_unit = (
                f"{self.unit}/pixel" if size is None else f"{self.unit}/{lateral or 'unit of length'}"
            )
        undefined = self.provenance.get("undefined_pixels", 0)
        return dataclasses.replace(
            statistics(self.heights, size),
            unit=self.unit,
            slope_unit=slope_unit,
            undefined_pixels=undefined if isinstance(undefined, int) else 0,
        )


def read(
    path: str | Path,
    *,
    undefined: Undefined = "fill",
    max_undefined: float = 0.1,
    tilt: Tilt = "plane",
    periodic: Periodic = "mirror",
    unit: Unit | None = None,
    channel: str | int | None = None,
    resample: bool = False,
) -> Surface:
    """Read a measured surface and make it ready for the solver.

    ``.npy`` and ``.npz`` files and text (``.txt``, ``.csv``, ``.dat``: a matrix of numbers) are read
    directly, everything else by the optional library SurfaceTopography; rows run downward, as the surface
    is seen in a picture. Undefined pixels are filled, then the tilt is removed, then pixels are made square,
    units converted, and the surface made periodic.

    Parameters
    ----------
    path
        The file.
    undefined
        "fill" gives each undefined pixel (NaN or masked) the mean of its neighbors on the pixel grid,
        the discrete harmonic function: no filled pixel is above the rim of its hole, so filling creates
        no summit. "refuse" raises if there is any.
    max_undefined
        Largest fraction of undefined pixels that is filled, from 0 to below 1.
    tilt
        "plane" removes the least-squares plane of the defined pixels, "mean" only their mean, "none"
        nothing.
    unit
        None keeps the file's unit of height; "m", "mm", "um", "nm" and "pm" convert; "rms" divides by the
        rms height of the pixels after the tilt was removed. The pixel size keeps the file's unit.
    periodic
        "mirror" reflects the surface along each axis, which doubles each: continuous, and no measured value
        is altered. "taper" brings a border of 10 % of each axis, on either side, to the mean by a cosine;
        under a heavy load or after long creep the flat border touches too, and counts as contact.
        "wrap" takes it as it is: the seam keeps its step.
    channel
        Name or number of the channel, for instrument files with several, or of the array in a ``.npz``
        file; None for the file's default.
    resample
        Make pixels that are not square, to 1 %, square: along the axis of the shorter spacing, means over the
        larger one take the place of the heights, and what is left of the last pixel is dropped. Without,
        a surface of such pixels can be described, but not pressed.

    Returns
    -------
    Surface
        Its provenance records the file, its checksum and every rule with its numbers.

    Raises
    ------
    SurfaceFileError
        If the file is missing, empty, truncated or of another kind, has no such channel, or has more
        undefined pixels than allowed.
    MissingExtraError
        If the format needs SurfaceTopography and it is not installed.
    InputError
        If an option is none of the above, or the unit cannot be converted; or if there are not two
        of the larger pixels along the other axis.
    """
    for option, value, choices in (
        ("undefined", undefined, get_args(Undefined)),
        ("tilt", tilt, get_args(Tilt)),
        ("periodic", periodic, get_args(Periodic)),
        ("unit", unit, (None, *get_args(Unit))),
    ):
        if value not in choices:
            raise InputError(option, expected=f"one of {', '.join(map(repr, choices))}", got=repr(value))
    limit = checked_number("max_undefined", max_undefined, expected="a fraction from 0 to below 1")
    if not 0 <= limit < 1:
        raise InputError("max_undefined", expected="a fraction from 0 to below 1", got=repr(max_undefined))
    file = _checked_file(path)
    checksum = _sha256(file)
    raw = _read_raw(file, channel)
    missing = _checked_missing(file, raw.heights, 0.0 if undefined == "refuse" else limit)

    filled = prepare.fill(raw.heights)
    level, plane = prepare.remove_tilt(filled, ~missing, tilt)
    outlying, highest = _outliers(level[~missing])
    level, pixel_size = prepare.square(level, raw.pixel_size) if resample else (level, raw.pixel_size)
    factor, final_unit = prepare.scale_factor(level, raw.unit, unit, largest=float(np.abs(filled).max()))
    heights = prepare.make_periodic(level * factor, periodic, border=TAPER_BORDER)
    done: Provenance = {
        "undefined_rule": undefined,
        "undefined_pixels": int(missing.sum()),
        "undefined_fraction": float(missing.mean()),
        "tilt_rule": tilt,
        "tilt_coefficients": plane,
        "outlying_pixels": outlying,
        "outlying_height": highest,
        "resampled": pixel_size != raw.pixel_size,
        "pixel_size": list(pixel_size or ()),
        "unit": final_unit,
        "scale_factor": factor,
        "periodic_rule": periodic,
        "final_shape": list(heights.shape),
        "rms_before": float(raw.heights[~missing].std()),
        "rms_after": float(heights.std()),
    }
    origin: Provenance = {"file": file.name, "sha256": checksum, **_origin(raw)}
    return Surface(heights, final_unit, pixel_size, raw.length_unit, {**origin, **done})


def _outliers(heights: Field) -> tuple[int, float]:
    """Count the heights far above all others, and give the highest in robust standard deviations."""
    median = np.median(heights)
    deviation = 1.4826 * float(np.median(np.abs(heights - median)))  # that of a Gaussian
    if deviation == 0:  # most heights are equal: no measure of what is far
        return 0, 0.0
    above = (heights - median) / deviation
    return int((above > _OUTLYING).sum()), float(above.max())


def _origin(raw: RawSurface) -> Provenance:
    """Describe the file's content as it was found; lengths are in the file's units."""
    sizes = raw.pixel_size or ()
    return {
        "format": raw.format,
        "reader": raw.reader,
        "reader_remarks": list(raw.remarks),
        "channel": raw.channel,
        "channels": list(raw.channels),
        "original_shape": list(raw.heights.shape),
        "original_unit": raw.unit,
        "physical_size": [s * n for s, n in zip(sizes, raw.heights.shape, strict=False)],
        "length_unit": raw.length_unit or "",
        "declared_periodic": raw.says_periodic,
    }


def _read_raw(file: Path, channel: str | int | None) -> RawSurface:
    suffix = file.suffix.lower()
    # The MetroPro format of interferometers shares the extension .dat with text.
    is_text = suffix in _TEXT_SUFFIXES and not (suffix == ".dat" and _is_binary(file))
    if suffix == ".npz":
        return read_npz(file, channel)
    if suffix != ".npy" and not is_text:
        return read_instrument(file, channel)
    if channel is not None:
        expected = "no channel: this format has a single one"
        raise SurfaceFileError(str(file), expected=expected, got=f"channel {channel!r}")
    return read_text(file) if is_text else read_npy(file)


def _is_binary(file: Path) -> bool:
    with file.open("rb") as stream:
        return b"\0" in stream.read(4096)


def _checked_file(path: str | Path) -> Path:
    try:
        file = Path(path)
        exists, is_file = file.exists(), file.is_file()
        size = file.stat().st_size if is_file else 0
    except (TypeError, ValueError, OSError) as error:
        raise SurfaceFileError(
            "path", expected="the path of a surface file", got=f"{path!r} ({error})"
        ) from error
    if not exists:
        raise SurfaceFileError(str(path), expected="a surface file", got="no such file")
    if not is_file:
        got = "a directory" if file.is_dir() else "something that is not a regular file"
        raise SurfaceFileError(str(path), expected="a surface file", got=got)
    if size == 0:
        raise SurfaceFileError(str(path), expected="a surface file", got="an empty file")
    return file


def _sha256(file: Path) -> str:
    try:
        with file.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise SurfaceFileError(str(file), expected="a readable file", got=str(error.strerror)) from error


def _checked_missing(file: Path, heights: Field, limit: float) -> NDArray[np.bool_]:
    """Say which pixels are undefined; refuse infinite or absurd ones, and too many undefined."""
    infinite = np.argwhere(np.isinf(heights))
    if len(infinite):
        raise SurfaceFileError(
            str(file),
            expected="finite heights, or NaN for undefined pixels",
            got=f"{len(infinite)} infinite of {heights.size}, the first at {infinite[0].tolist()}",
        )
    largest = float(np.nanmax(np.abs(heights), initial=0.0))
    if largest > _LARGEST:
        raise SurfaceFileError(
            str(file),
            expected=f"heights of at most {_LARGEST:g}",
            got=f"one of {largest:g}",
            advice="the right byte order: that is no height",
        )
    missing = np.isnan(heights)
    count, fraction = int(missing.sum()), float(missing.mean())
    if count and fraction > limit:
        first = np.argwhere(missing)[0].tolist()
        allowed = f"at most {limit:.3g} of the pixels undefined" if limit else "no undefined pixel"
        choice = "a larger max_undefined" if limit else "undefined = 'fill'"
        advice = "" if fraction == 1 else f"{choice}, or another measurement"
        raise SurfaceFileError(
            str(file),
            expected=allowed,
            got=f"{count} of {heights.size} undefined ({fraction:.3g}), the first at {first}",
            advice=advice,
        )
    return missing
