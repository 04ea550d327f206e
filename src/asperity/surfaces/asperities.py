"""Single asperities: balls, a paraboloid, a flat punch; of exact shape, in metres.

Each is a `Surface` in SI with free edges. Its highest point is at height 0 and in the middle of the lattice,
unless places and heights are given. Site (i, j) is at (i dy, j dx), as in the coordinates y and x of a
Dataset; it has the height of the body at this very point.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import numpy as np
from annotated_types import Gt, Len
from numpy.typing import NDArray

from asperity.base import checks, units
from asperity.base.parameters import Quantity
from asperity.errors import LARGEST, InputError
from asperity.lattice import Edges, Field, Lattice
from asperity.surfaces.heights import sides_of_pixels
from asperity.surfaces.making import Length, Lengths, Shape
from asperity.surfaces.surface import Surface

SHAPES = ("sphere", "paraboloid", "punch", "array")
"""Kinds of surfaces that are shapes, without statistics."""

_RADIUS = Quantity(
    "radius of the ball, radius of curvature of the paraboloid (one, or one an axis), or radius of the "
    "punch's face.",
    "m",
)
_Radius = Annotated[Length, Gt(0), _RADIUS]
_PixelSize = Annotated[
    Lengths,
    *(Gt(0), Len(1, 2)),
    Quantity("distance between sites: one, or between rows and columns.", "m", swept=False),
]
_Position = Annotated[Length, Quantity("position", "m")]

_ROUNDING = 1e-12  # relative distance beyond an edge at which a site still is on it


def sphere(shape: Shape, *, radius: _Radius, pixel_size: _PixelSize, edges: Edges = "free") -> Surface:
    r"""Make a ball: :math:`h = \sqrt{R^2 - r^2} - R`, at the distance r from the middle.

    Beyond the ball the surface is flat, at the height of its center, -R.

    Parameters
    ----------
    shape
        Sites along each axis, ``(n, m)``.
    radius
        Radius R of the ball, a pixel or more; in m, or a text with a unit, such as ``"1 mm"``.
    pixel_size
        Distance between sites, one number or one an axis (dy, dx); in m, or with a unit.
    edges
        See `Surface`. With periodic edges r is the distance to the nearest periodic image of the middle.

    Returns
    -------
    Surface
        Heights and pixel size in m; its provenance has the kind and all parameters.

    Raises
    ------
    InputError
        A number is out of range, or its unit is not a length.
    """
    lattice = _lattice(shape, pixel_size)
    size = _lengths("radius", radius, least=max(lattice.spacing))
    heights = _balls(lattice, _middle(lattice)[np.newaxis], size, np.zeros(1), edges)
    return _made("sphere", lattice, heights, edges, radius=size[0])


def paraboloid(
    shape: Shape,
    *,
    radius: Annotated[Lengths, Gt(0), Len(1, 2), _RADIUS],
    pixel_size: _PixelSize,
    edges: Edges = "free",
) -> Surface:
    r"""Make a paraboloid: :math:`h = -y^2/(2 R_y) - x^2/(2 R_x)`, for which Hertz's theory is exact.

    Parameters
    ----------
    radius
        Radius of curvature at the summit: one number, or one along y and one along x.

    Other arguments, result and errors are those of `sphere`.
    """
    lattice = _lattice(shape, pixel_size)
    radii = _lengths("radius", radius, 2, "an axis", least=max(lattice.spacing))
    y, x = _offsets(lattice, _middle(lattice), edges)
    heights = -(y**2 / (2 * radii[0]) + x**2 / (2 * radii[1]))
    return _made("paraboloid", lattice, heights, edges, radius=radii)


def punch(shape: Shape, *, radius: _Radius, pixel_size: _PixelSize, edges: Edges = "free") -> Surface:
    r"""Make a flat circular punch: height 0 up to its edge, and one radius lower beyond it.

    A site belongs to the face if its center does. So the edge is a staircase, and
    :math:`\sqrt{\text{area}/\pi}`, with the area of these sites, measures the face better than the radius.

    Parameters
    ----------
    radius
        Radius of the face.

    Other arguments, result and errors are those of `sphere`.
    """
    lattice = _lattice(shape, pixel_size)
    size = _lengths("radius", radius, least=max(lattice.spacing))[0]
    y, x = _offsets(lattice, _middle(lattice), edges)
    face = y**2 + x**2 <= (size * (1 + _ROUNDING)) ** 2
    return _made("punch", lattice, np.where(face, 0.0, -size), edges, radius=size)


def array(
    shape: Shape,
    *,
    places: Annotated[
        Sequence[tuple[_Position, _Position]] | Sequence[Sequence[Length]] | NDArray[np.float64],
        Len(1),
        Quantity("places of the balls: pairs y x, counted from the first site, in m.", "m"),
    ],
    radii: Annotated[Lengths, Gt(0), Len(1), Quantity("radii of the balls: one, or one a ball.", "m")],
    pixel_size: _PixelSize,
    heights: Annotated[
        Lengths, Len(1), Quantity("heights of the summits of the balls: one, or one a ball.", "m")
    ] = 0.0,
    edges: Edges = "free",
) -> Surface:
    """Put balls at given places; where two overlap, the higher one counts.

    Beyond all balls the surface is flat, at the height of the lowest center.

    Parameters
    ----------
    places
        Pairs (y, x) of the summits on the lattice, shape ``(balls, 2)``, with the first site at (0, 0); in m,
        or with a unit.
    radii, heights
        Radii of the balls, and heights of their summits: one number, or one a ball.

    Other arguments, result and errors are those of `sphere`.
    """
    lattice = _lattice(shape, pixel_size)
    where = _places(places, lattice)
    size = _lengths("radii", radii, len(where), "a ball", least=max(lattice.spacing))
    tops = _lengths("heights", heights, len(where), "a ball")
    balls = _balls(lattice, where / lattice.spacing, size, tops, edges)
    return _made("array", lattice, balls, edges, y=where[:, 0], x=where[:, 1], radii=size, heights=tops)


def _made(kind: str, lattice: Lattice, field: Field, edges: Edges, **facts: Field) -> Surface:
    numbers = {name: values.tolist() for name, values in facts.items()}
    origin = {"kind": kind, "shape": list(lattice.shape), **numbers, "pixel_size": list(lattice.spacing)}
    return Surface(field, "m", lattice.spacing, "m", {**origin, "length_unit": "m"}, edges)


def _balls(lattice: Lattice, places: Field, radii: Field, tops: Field, edges: Edges) -> Field:
    """Heights of balls, shape (n, m), at places in sites, (balls, 2), of these radii and tops, (balls,)."""
    floor = float((tops - radii).min())
    heights = np.full(lattice.shape, floor)
    for place, R, top in zip(places, radii, tops, strict=True):
        y, x = _offsets(lattice, place, edges)
        within = np.ix_(np.abs(y[:, 0]) <= R, np.abs(x[0]) <= R)
        squares = y[within[0][:, 0]] ** 2 + x[:, within[1][0]] ** 2
        # sqrt(R^2 - r^2) - R without the difference of two large numbers.
        fall = squares / (R + np.sqrt(np.maximum(R**2 - squares, 0.0)))
        heights[within] = np.maximum(heights[within], np.where(squares <= R**2, top - fall, floor))
    return heights


def _offsets(lattice: Lattice, place: Field, edges: Edges) -> tuple[Field, Field]:
    """Distances of the sites along each axis, shapes (n, 1) and (1, m), from a place in sites."""
    offsets = []
    for n, step, center in zip(lattice.shape, lattice.spacing, place, strict=True):
        sites = np.arange(n) - center
        offsets.append(step * (sites - n * np.rint(sites / n) if edges == "periodic" else sites))
    return offsets[0][:, np.newaxis], offsets[1][np.newaxis]


def _middle(lattice: Lattice) -> Field:
    return (np.array(lattice.shape) - 1) / 2


def _lattice(shape: int | tuple[int, ...], pixel_size: Lengths) -> Lattice:
    lengths = checks.lattice_shape(shape, advice="(256, 256)")
    if len(lengths) != 2:
        raise InputError("shape", expected="two lengths", got=checks.shown(shape), advice="(256, 256)")
    return Lattice(lengths, sides_of_pixels(pixel_size, 2, "m")[0])


def _places(value: object, lattice: Lattice) -> Field:
    if isinstance(value, list | tuple):
        value = [units.numbers("places", pair, "m") for pair in value]
    expected, advice = "a pair of lengths (y, x) for each ball", 'places=[("40 um", "60 um")]'
    places = checks.floats("places", value, expected=expected, advice=advice)
    if places.ndim != 2 or places.shape[1] != 2 or not len(places):
        raise InputError("places", expected=expected, got=f"shape {places.shape}", advice=advice)
    sites = places / lattice.spacing
    outside = ~((sites >= -0.5) & (sites <= np.array(lattice.shape) - 0.5)).all(axis=1)
    if outside.any():
        y, x = 2 * _middle(lattice) * lattice.spacing
        got = "({:g}, {:g})".format(*places[outside][0])
        raise InputError("places", expected=f"y from 0 to {y:g} m and x from 0 to {x:g} m", got=got)
    return places


def _lengths(name: str, value: object, count: int = 1, each: str = "", least: float = -LARGEST) -> Field:
    """One length for all, or one each, finite and not below the least; shape (count,)."""
    expected = f"one length, or {count}, one {each}" if count > 1 else "one length"
    advice = "a number in m, or a text such as '1 mm'"
    lengths = checks.floats(name, units.numbers(name, value, "m"), expected=expected, advice=advice)
    if lengths.shape not in ((), (1,), (count,)):
        raise InputError(name, expected=expected, got=f"shape {lengths.shape}", advice=advice)
    if not ((lengths >= least) & (lengths <= LARGEST)).all():
        expected = "finite lengths" if least < 0 else f"finite lengths of a pixel, {least:g} m, or more"
        got = float(lengths.min() if (lengths < least).any() else lengths.max())
        raise InputError(name, expected=expected, got=got, advice=advice)
    return np.broadcast_to(lengths, (count,))
