"""A surface with its units: heights, the distance between them, and where they come from."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, get_args

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from asperity.base import checks, readable, views
from asperity.base.words import unit_of
from asperity.errors import InputError, Name, Words
from asperity.lattice import Edges, Field, Mask
from asperity.surfaces import doubts, levelling, prepare
from asperity.surfaces.heights import check_heights, sides_of_pixels
from asperity.surfaces.moments import Statistics, statistics

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Provenance = dict[str, Any]
"""Words, numbers, and lists of them, by name."""

_SPIKY = 0.1  # largest share of the pixels that are filled as spikes
_ALIKE = 1e-6  # largest relative difference of pixel sizes that are the same


@dataclass(frozen=True, eq=False)
class Surface(views.InNotebooks):
    """Heights with units and provenance; a function that takes heights takes a surface.

    Parameters
    ----------
    heights
        Shape ``(n,)`` or ``(n, m)``, float64; finite, or -inf where there is no body: such sites never touch,
        and areas and statistics leave them out. Kept as a read-only copy.
    unit
        Unit of the heights: "nm", ..., "rms" (of its own rms height), or "1" if none is known.
    pixel_size
        Distance between sites, one number or one an axis, in `length_unit`, or text with a unit, ``"1 um"``
        or ``("1 um", "0.5 um")``; None if unknown.
    length_unit
        Unit of the pixel size, by default that of its text, or None if unknown.
    provenance
        Origin, and all steps since then.
    edges
        "periodic", "reflecting" (a mirror image lies beyond each edge), or "free" (the body ends there, for
        half-spaces).
    filled
        Mask of the pixels that were not measured, of the shape of the heights; None if there are none.
        `level` fills them anew. Results remark if they bear load.
    """

    heights: Field
    unit: str = "1"
    pixel_size: tuple[float, ...] | None = None
    length_unit: str | None = None
    provenance: Provenance = dataclasses.field(default_factory=dict)
    edges: Edges = "periodic"
    filled: Mask | None = None

    def __post_init__(self) -> None:
        heights, stated = check_heights(self.heights), prepare.spelled(unit_of(self.heights))
        if readable.is_length(stated):
            object.__setattr__(self, "unit", stated if self.unit in ("1", None) else self.unit)
            heights = heights * (readable.conversion(stated, prepare.spelled(self.unit)) or 1.0)
        heights.flags.writeable = False
        object.__setattr__(self, "heights", heights)
        for name, others in (("unit", ("1", "rms")), ("length_unit", (None,))):
            unit = (given := getattr(self, name)) and prepare.spelled(given)
            checks.choice(name, unit, (*readable.LENGTHS, *others))
            object.__setattr__(self, name, unit)
        if self.pixel_size is not None:
            size, unit = sides_of_pixels(self.pixel_size, heights.ndim, self.length_unit)
            object.__setattr__(self, "pixel_size", size)
            object.__setattr__(self, "length_unit", unit)
        checks.choice("edges", self.edges, get_args(Edges))
        if self.filled is not None:
            filled = np.array(self.filled, dtype=bool)
            if filled.shape != heights.shape:
                expected = f"an array of the shape of the heights, {heights.shape}"
                raise InputError("filled", expected=expected, got=filled.shape)
            filled.flags.writeable = False
            object.__setattr__(self, "filled", filled if filled.any() else None)

    def __repr__(self) -> str:
        sites, rms = " x ".join(map(str, self.shape)), float(prepare.of_body(self.heights).std())
        unit, factor = readable.display_unit(self.unit, rms) or (self.unit, 1.0)
        height, size = f"rms height {rms * factor:.4g} {'' if unit == '1' else unit}".rstrip(), ""
        if self.pixel_size is not None:
            whole = self.length_unit or "", 1.0
            unit, factor = readable.display_unit(self.length_unit, max(self.pixel_size)) or whole
            size = f" of {_sides(tuple(side * factor for side in self.pixel_size))} {unit}".rstrip()
        return f"<Surface: {sites} sites{size}, {height}, {self.edges}>"

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        """Return the heights, in `unit`."""
        return np.array(self.heights, dtype=dtype, copy=copy)

    @property
    def shape(self) -> tuple[int, ...]:
        """Sites along each axis."""
        return self.heights.shape

    @property
    def has_lengths(self) -> bool:
        """Whether heights or pixels have a unit of length."""
        return self.unit not in ("1", "rms") or self.length_unit is not None

    def in_meters(self) -> tuple[Field, tuple[float, ...]]:
        """Heights, and spacing along each axis, in meters.

        Raises
        ------
        InputError
            The heights have no unit of length, or the pixels no size or unit of length.
        """
        if not readable.is_length(self.unit):
            got = {"1": "heights without a unit", "rms": "heights in units of their rms"}[self.unit]
            advice: Words = ("unit='nm' of a Surface, or ", Name("file_unit"), " of a file without a unit")
            advice = "another unit than 'rms'" if self.unit == "rms" else advice
            raise InputError("surface", expected="heights with a unit of length", got=got, advice=advice)
        if (spacing := self.pixel_size) is None:
            got = f"heights in {self.unit!r}, and pixels of unknown size"
            advice = (Name("pixel_size"), " and ", Name("length_unit"))
            raise InputError("surface", expected="the distance between pixels", got=got, advice=advice)
        if (across := readable.conversion(self.length_unit, "m")) is None:
            got, cure = f"pixels of {_sides(spacing)} in no unit", {"length_unit": "um"}
            raise InputError("surface", expected="pixels with a unit of length", got=got, cure=cure)
        return self.heights * readable.length_factor(self.unit, "m"), tuple(across * size for size in spacing)

    @property
    def scan(self) -> Surface:
        """The scan without its mirror images; without such images the surface itself."""
        part = measured_part(self.shape, self.provenance)
        if math.prod(s.stop for s in part) == self.heights.size:
            return self
        provenance = self.provenance | {"periodic_rule": "reflect"}
        provenance["final_shape"] = [side.stop for side in part]
        return dataclasses.replace(self._part(part), edges="reflecting", provenance=provenance)

    def _part(self, part: tuple[slice, ...]) -> Surface:
        filled = None if self.filled is None else self.filled[part]
        return dataclasses.replace(self, heights=self.heights[part], filled=filled)

    @property
    def remarks(self) -> tuple[str, ...]:
        """Remarks of the reader of its file, and on implausible heights."""
        facts, scan = self.provenance, self.scan
        if "kind" in facts:  # made, not measured
            return ()
        across = readable.conversion(self.length_unit, "m")
        sentences = doubts.remarks(facts, scan.describe(), self.pixel_size, across)
        return (*facts.get("reader_remarks", ()), *sentences)

    @views.later
    def plot(self, /, ax: Axes | None = None) -> Axes:
        """Draw the heights into axes or a new figure; see `asperity.figures.plot_surface`."""
        raise NotImplementedError

    @cached_property
    def in_si(self) -> Statistics:
        """Statistics in meters, for every contact of this surface; `InputError` as for `in_meters`."""
        return statistics(*self.in_meters())

    def describe(self) -> Statistics:
        """Measure the surface.

        The slope is a pure number where heights and pixel size both have units of length, else in
        ``unit / length_unit`` or ``unit / pixel``; the curvature likewise in ``1 / unit``,
        ``unit / length_unit^2`` or ``unit / pixel^2``.
        """
        size, lateral = self.pixel_size, self.length_unit
        factor = readable.conversion(lateral, self.unit)
        if size is not None and factor is not None:
            size, slope_unit, curvature_unit = tuple(s * factor for s in size), "1", f"1/{self.unit}"
        else:
            across = "pixel" if size is None else lateral or "unit of length"
            squared = f"({across})^2" if " " in across else f"{across}^2"
            slope_unit, curvature_unit = f"{self.unit}/{across}", f"{self.unit}/{squared}"
        return dataclasses.replace(
            statistics(self.heights, size),
            unit=self.unit,
            slope_unit=slope_unit,
            curvature_unit=curvature_unit,
            undefined_pixels=self.provenance.get("undefined_pixels", 0),
        )

    def crop(self, bounds: Sequence[float], unit: str = "pixel") -> Surface:
        """Cut out a part.

        Parameters
        ----------
        bounds
            Begin and end of the part along each axis, from the first pixel: ``[left, right]`` of a profile,
            ``[top, bottom, left, right]`` of a surface.
        unit
            "pixel", or a unit of length. Lengths are rounded to whole pixels.

        Returns
        -------
        Surface
            With reflecting edges in place of periodic ones, unless the part is the whole surface.

        Raises
        ------
        InputError
            The bounds are not within the surface, or the pixels have no unit of length.
        """
        part = prepare.part_of(self.shape, bounds, prepare.spelled(unit), self.pixel_size, self.length_unit)
        facts = {name: value for name, value in self.provenance.items() if name != "periodic_rule"}
        facts["crop"] = [edge for axis in part for edge in (axis.start, axis.stop)]
        cropped = self._part(part)
        kept = cropped.heights.size == self.heights.size or self.edges == "free"
        return dataclasses.replace(cropped, edges=self.edges if kept else "reflecting", provenance=facts)

    def level(
        self, tilt: levelling.Tilt = "plane", *, despike: bool = False, lines: levelling.Lines = "none"
    ) -> Surface:
        """Remove tilt, bow, spikes and offsets of lines; `filled` pixels are filled anew.

        Parameters
        ----------
        tilt, despike, lines
            As for `asperity.surfaces.read`.

        Returns
        -------
        Surface
            The scan, without mirror images.

        Raises
        ------
        InputError
            An argument is none of these, or more than a tenth of the pixels are spikes.
        """
        checks.choice("tilt", tilt, get_args(levelling.Tilt))
        checks.choice("lines", lines, get_args(levelling.Lines))
        scan, most = self.scan, _SPIKY if despike else None
        body = np.isfinite(scan.heights)
        missing = ~body if scan.filled is None else scan.filled | ~body
        level, filled, facts = levelling.levelled(scan.heights, missing, tilt, most, lines)
        level, filled = np.where(body, level, -np.inf), filled & body
        provenance = {**scan.provenance, **facts, **levelling.bow(level)}
        return dataclasses.replace(scan, heights=level, provenance=provenance, filled=filled)

    def band(self, *, longest: float | None = None, shortest: float | None = None) -> Surface:
        """Remove the waves that are longer or shorter than these; the mean stays.

        Parameters
        ----------
        longest, shortest
            Wavelengths in `length_unit`, in pixels where the pixel size is unknown; None for no limit.

        Returns
        -------
        Surface
            The other waves of the lattice with its edges, unaltered; for free edges those of reflecting ones.

        Raises
        ------
        InputError
            A wavelength is not positive, or the shortest is not below the longest.
        """
        limits = prepare.checked_band(longest, shortest)
        heights = prepare.band(self.heights, self.pixel_size, limits, reflecting=self.edges != "periodic")
        return dataclasses.replace(self, heights=heights, provenance=self.provenance | limits)


def combined(first: Surface, second: Surface) -> Surface:
    """Two rough bodies as one: the sum of their heights, each counted from its body towards the other.

    The gap between two rough surfaces depends on the sum of their heights alone; their elastic constants
    combine in `asperity.solids.half_space`. Both have the same coordinates: flip the scan of the second body,
    which lies face down, along one axis first.

    Parameters
    ----------
    first, second
        Surfaces of the same shape, pixel size and edges, with heights in units that convert to each other.

    Returns
    -------
    Surface
        In the units of the first, with its provenance, and ``other``: the file or the kind of the second.

    Raises
    ------
    InputError
        They cannot be added.
    """
    for name, surface in (("first", first), ("second", second)):
        checks.instance(name, surface, Surface, "asperity.surfaces.Surface(heights)")
    for same, wanted, got in (
        ("shape", first.shape, second.shape),
        ("edges", first.edges, second.edges),
        ("shape without mirror images", first.scan.shape, second.scan.shape),
    ):
        if wanted != got:
            raise InputError("second", expected=f"the {same} of the first, {wanted}", got=got)
    mine, other_unit, unit = first.pixel_size, second.length_unit, first.length_unit
    across = 1.0 if other_unit == unit else readable.conversion(other_unit, unit) or math.nan
    pixels = second.pixel_size and [across * side for side in second.pixel_size]
    if (mine is None) != (pixels is None) or not np.allclose(mine or 0.0, pixels or 0.0, rtol=_ALIKE, atol=0):
        expected = f"the pixel size of the first, {_pixel_words(first)}"
        raise InputError("second", expected=expected, got=_pixel_words(second))
    if first.unit == second.unit == "rms":
        of_each = "heights in units of the rms of each"
        raise InputError("second", expected="heights of one unit", got=of_each, advice="a unit of length")
    factor = 1.0 if first.unit == second.unit else readable.conversion(second.unit, first.unit)
    if factor is None:
        expected = f"heights that can be added to those of the first, in {first.unit!r}"
        raise InputError("second", expected=expected, got=f"heights in {second.unit!r}")
    masks = [part.filled for part in (first, second) if part.filled is not None]
    other = str(second.provenance.get("file") or second.provenance.get("kind") or "heights")
    return dataclasses.replace(
        first,
        heights=first.heights + factor * second.heights,
        provenance={**first.provenance, "other": other},
        filled=np.any(masks, axis=0) if masks else None,
    )


def check_square(heights: ArrayLike) -> None:
    """Refuse a `Surface` with pixels that are not square to 1 %, for a solid that is defined on sites.

    Raises
    ------
    InputError
        The pixels are not square.
    """
    if isinstance(heights, Surface) and (size := heights.pixel_size) and not prepare.is_square(size):
        unit = f" {heights.length_unit}" if heights.length_unit else ""
        got = f"{size[0]:.4g}{unit} between rows and {size[1]:.4g}{unit} between columns"
        cure = {"resample": True} if "file" in heights.provenance else {}
        raise InputError("heights", expected="square pixels", got=got, cure=cure)


def measured_part(shape: tuple[int, ...], provenance: Mapping[str, object]) -> tuple[slice, ...]:
    """Slices of the scan within a surface that has its mirror images; else of the whole surface."""
    mirrored = provenance.get("periodic_rule") == "mirror"
    return tuple(slice(0, n // 2 if mirrored else n) for n in shape)


def _pixel_words(surface: Surface) -> str:
    if surface.pixel_size is None:
        return "unknown"
    return f"{_sides(surface.pixel_size)} {surface.length_unit or '(no unit)'}"


def _sides(size: tuple[float, ...]) -> str:
    return " x ".join(f"{side:.4g}" for side in size)
