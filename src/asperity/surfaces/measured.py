"""Measured surfaces: from a file to heights for the solver, with a record of each step."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import scipy
from annotated_types import Ge, Gt, Len, Lt
from numpy.typing import NDArray

from asperity.base import checks
from asperity.base.parameters import Quantity, Spelled, parameters_of
from asperity.errors import Name, SurfaceFileError, Value, printable
from asperity.lattice import Edges, Field
from asperity.surfaces import doubts, files, levelling, prepare
from asperity.surfaces.files import Length
from asperity.surfaces.levelling import Lines, Tilt
from asperity.surfaces.making import Positive
from asperity.surfaces.points import LARGEST_READ
from asperity.surfaces.surface import Provenance, Surface

Periodic = Literal["mirror", "reflect", "taper", "wrap", "free"]


def read(
    path: Annotated[
        str | Path, Quantity("surface file; the other settings prepare it. For spectrum its table.")
    ],
    *,
    undefined: Annotated[
        Literal["fill", "no-body", "refuse"],
        Quantity("treatment of undefined pixels: fill (from neighbors), no-body or refuse."),
    ] = "fill",
    max_undefined: Annotated[
        float, Ge(0), Lt(1), Quantity("largest fraction of undefined pixels to fill")
    ] = 0.1,
    undefined_value: Annotated[
        float | None,
        Quantity("height that marks an undefined pixel, such as -9999.", dimension="height unit"),
    ] = None,
    tilt: Annotated[
        Tilt, Quantity("tilt to remove from the heights; quadratic removes a bow, too.")
    ] = "plane",
    despike: Annotated[
        bool,
        Quantity("fill spikes: pixels more than 6 robust standard deviations above the median", swept=False),
    ] = False,
    lines: Annotated[Lines, Quantity("offsets of scan lines. median: subtract that of each row.")] = "none",
    periodic: Annotated[
        Periodic,
        Quantity(
            "edges of the scan. reflect: reflecting edges. wrap: the scan is periodic. taper: its border "
            "is brought to the mean. mirror: four mirrored copies, for a periodic solid. free: the body "
            "ends."
        ),
    ] = "reflect",
    unit: Annotated[
        Literal[Length, "rms"] | None,
        Spelled(prepare.spelled),
        Quantity(
            "unit of the heights; rms divides by the rms height. By default the file's. For spectral and "
            "spectrum the unit of all lengths; by default none."
        ),
    ] = None,
    channel: Annotated[str | int | None, Quantity("channel of the surface file, by name or number.")] = None,
    resample: Annotated[
        bool, Quantity("average oblong pixels to squares of the larger spacing", swept=False)
    ] = False,
    crop: Annotated[
        Sequence[float] | None,
        Len(2, 4),
        Quantity(
            "part of the surface file: top bottom left right, or left right of a profile, in pixels.",
            dimension="pixels, or the unit of the part",
        ),
    ] = None,
    crop_unit: Annotated[
        Literal["pixel", Length] | None,
        Spelled(prepare.spelled),
        Quantity("unit of that part, in place of pixels.", swept=False),
    ] = None,
    longest: Annotated[
        Positive, Quantity("longest wavelength kept, in the file's unit.", dimension="length unit")
    ] = None,
    shortest: Annotated[
        Positive, Quantity("shortest wavelength kept, likewise.", dimension="length unit")
    ] = None,
    file_unit: Annotated[
        Length | None,
        Spelled(prepare.spelled),
        Quantity("unit of the heights, for a file that does not state it", swept=False),
    ] = None,
    pixel_size: Annotated[
        float | str | Sequence[float | str] | None,
        *(Gt(0), Len(1, 2)),
        Quantity(
            "distance between pixels, for a file that does not state it, such as 0.5um: one, or between "
            "rows and between columns. For a ball, a paraboloid, a punch or an array: between sites, in m.",
            dimension="length unit",
            swept=False,
        ),
    ] = None,
    length_unit: Annotated[
        Length | None,
        Spelled(prepare.spelled),
        Quantity("unit of that distance, if it is a plain number", swept=False),
    ] = None,
) -> Surface:
    """Read a measured surface and make it ready for the solver.

    Arrays (``.npy``, ``.npz``, ``.mat``, ``.h5``) and text (``.txt``, ``.csv``, ``.dat``, ``.asc``,
    ``.xyz``: a matrix of numbers, a profile, or points x, y, z) are read directly, everything else by the
    optional library SurfaceTopography. Row 0 is the top line of the picture that the instrument's program
    shows, the first line of a text, or the largest y of points. Points must lie on a regular grid; its pixels
    without a point are undefined. The order of the steps: `crop`, `tilt`, `lines`, filling of undefined
    pixels and spikes, `resample`, `longest` and `shortest`, `unit`, `periodic`.

    Parameters
    ----------
    path
        The file.
    undefined
        "fill" gives each undefined pixel (NaN or masked) the mean of its neighbors on the pixel grid, once
        the tilt is removed: the discrete harmonic function. No filled pixel is above the border of its hole,
        so filling creates no summit. `Surface.filled` marks them. "no-body": there is a hole, or the body
        ends. Heights are -inf, these pixels never touch, and areas and statistics leave them out.
        "refuse" raises if any pixel is undefined.
    max_undefined
        Largest fraction of undefined pixels that is filled, from 0 to below 1.
    undefined_value
        Height that marks undefined pixels in the file: -9999, 0, 1e38.
    tilt
        "plane" removes the least-squares plane of the defined pixels, "quadratic" their least-squares
        polynomial of second order, such as the bow of a scanner; "mean" their mean, "none" nothing.
    despike
        Fill pixels that are more than 6 robust standard deviations (1.4826 times the median distance from the
        median) above the median height, as no Gaussian height is (L. Davies and U. Gather, J. Am. Stat.
        Assoc. 88, 782 (1993), DOI 10.1080/01621459.1993.10476339). Then remove the tilt of the other pixels,
        and so on until there are no spikes.
    lines
        "median" subtracts its median from each row, against offsets of scan lines; real waves along the
        columns are lost, too. "none" leaves the rows as they are.
    unit
        None keeps the file's unit of height; "m", "mm", "um", "nm" and "pm" convert; "rms" divides by the
        rms height after the tilt is removed. The pixel size keeps the file's unit.
    periodic
        For a scan, take "reflect": the heights stay, with reflecting edges (`Surface.edges`). "mirror" makes
        four mirrored copies (of a profile two), for a solid that must be periodic: it doubles each axis, and
        all sums are those of the copies. "taper" brings a border of 10 % of each side to the mean by a
        cosine; under a heavy load or after long creep this flat border touches, too. "wrap" takes the scan as
        periodic: its seam keeps a step. "free" ends the body at the edges, for half-spaces.
    channel
        Name or number of the channel or the array. By default that of an instrument's file, or the only one.
    resample
        Make oblong pixels (by 1 % or more) square: means over the larger spacing replace the heights along
        the axis of the shorter one, without the remainder at its end.
    crop, crop_unit
        Part to cut out: ``[left, right]`` or ``[top, bottom, left, right]``, in pixels or in a unit of
        length; see `Surface.crop`.
    longest, shortest
        Limits of the wavelengths that are kept, in the unit of the pixel size, or in pixels if that is
        unknown. The waves are those of reflecting edges, or, with "wrap", of a periodic surface.
    file_unit
        Unit of the heights, in place of that in the file.
    pixel_size, length_unit
        Distance between pixels (one number or text such as ``"1 um"``, or one an axis) and its unit, in place
        of those in the file.

    Returns
    -------
    Surface
        Its provenance has the file, its checksum, and the numbers of each step.

    Raises
    ------
    SurfaceFileError
        The file is missing, empty, truncated or of another kind, has no such channel, more undefined pixels
        than allowed, scattered points, or two heights at one point.
    MissingExtraError
        The format needs SurfaceTopography, which is not installed.
    InputError
        An option is out of range, the unit cannot be converted, `resample` would leave less than two pixels
        along an axis, or a larger fraction of the pixels than `max_undefined` are spikes.
    """
    given = locals()
    words = {name: one.read(name, given[name]) for name, one in parameters_of(read).items() if one.words}
    unit, crop_unit = words["unit"], words["crop_unit"]
    limit = checks.number("max_undefined", max_undefined, least=0, below=1)
    limits = prepare.checked_band(longest, shortest)
    void = None if undefined_value is None else checks.number("undefined_value", undefined_value)
    file, checksum = files.checked_file(path)
    raw = files.read_raw(file, channel, void)
    raw = files.with_lengths(raw, words["file_unit"], pixel_size, words["length_unit"])
    heights, size = raw.heights, raw.pixel_size
    cut: Provenance = {}
    if crop is not None:
        part = prepare.part_of(heights.shape, crop, crop_unit or "pixel", size, raw.length_unit)
        heights, cut["crop"] = heights[part], [edge for axis in part for edge in (axis.start, axis.stop)]
    most = {"refuse": 0.0, "no-body": math.nextafter(1, 0)}.get(undefined, limit)
    missing = _checked_missing(file, heights, most, cut.get("crop", []))

    level, filled, facts = levelling.levelled(heights, missing, tilt, limit if despike else None, lines)
    nothing = missing & (undefined == "no-body")
    if resample:
        nothing, filled = (prepare.square(mask.astype(float), size)[0] > 0 for mask in (nothing, filled))
        level, size = prepare.square(level, size)
    level, filled = np.where(nothing, -np.inf, level), filled & ~nothing
    level = prepare.band(level, size, limits, reflecting=periodic != "wrap")
    largest = float(np.nanmax(np.abs(heights)))
    factor, final_unit = prepare.scale_factor(level, raw.unit, unit, largest=largest)
    final = prepare.make_periodic(level * factor, periodic)
    if periodic == "mirror":
        filled = prepare.make_periodic(filled.astype(float), periodic) > 0
    provenance: Provenance = {"file": printable(file.name), "sha256": checksum, **files.record_of(raw)}
    provenance |= {
        "undefined_rule": undefined,
        "undefined_pixels": int(missing.sum()),
        "undefined_fraction": float(missing.mean()),
        **facts,
        **doubts.repeated(heights[~missing]),
        **levelling.bow(level),
        "resampled": size != raw.pixel_size,
        "pixel_size": list(size or ()),
        "unit": final_unit,
        "scale_factor": factor,
        "periodic_rule": periodic,
        "final_shape": list(final.shape),
        "rms_before": float(heights[~missing].std()),
        "rms_after": float(prepare.of_body(final).std()),
    }
    provenance |= cut | limits
    beyond: dict[Periodic, Edges] = {"reflect": "reflecting", "free": "free"}
    edges = beyond.get(periodic, "periodic")
    return Surface(final, final_unit, size, raw.length_unit, provenance, edges, filled)


def _checked_missing(file: Path, heights: Field, limit: float, crop: Sequence[int]) -> NDArray[np.bool_]:
    """Return the mask of undefined pixels; refuse infinite or huge heights, and too many undefined."""
    fail = functools.partial(SurfaceFileError, str(file))
    infinite = np.argwhere(np.isinf(heights))
    if len(infinite):
        got = f"{len(infinite)} infinite of {heights.size}, the first at {infinite[0].tolist()}"
        raise fail(expected="finite heights, or NaN for undefined pixels", got=got)
    largest = float(np.nanmax(np.abs(heights), initial=0.0))
    if largest > LARGEST_READ:
        expected, advice = f"heights of at most {LARGEST_READ:g}", "the right byte order: that is no height"
        raise fail(expected=expected, got=f"one of {largest:g}", advice=advice)
    missing = np.isnan(heights)
    count, fraction = int(missing.sum()), float(missing.mean())
    if count and fraction > limit:
        expected = f"at most {limit:.3g} of the pixels undefined" if limit else "no undefined pixel"
        first = np.argwhere(missing)[0].tolist()
        got = f"{count} of {heights.size} undefined ({fraction:.3g}), the first at {first}"
        if fraction == 1:
            raise fail(expected=expected, got=got)
        cure: dict[str, Value] = _inside(missing, limit, crop) or ({} if limit else {"undefined": "fill"})
        larger = ("a larger ", Name("max_undefined"), ", or ") if limit else ()
        raise fail(expected=expected, got=got, cure=cure, advice=(*larger, "another measurement"))
    return missing


def _inside(missing: NDArray[np.bool_], limit: float, crop: Sequence[int]) -> dict[str, Value]:
    """The crop that leaves an undefined frame out, if the pixels within it suffice."""
    (box,) = scipy.ndimage.find_objects((~missing).astype(int))
    if missing[box].mean() > limit:
        return {}
    starts = crop[::2] or [0] * missing.ndim
    return {"crop": [n + end for n, part in zip(starts, box, strict=True) for end in (part.start, part.stop)]}
