r"""Images of a contact by an instrument with a point spread function, pixels and a threshold.

A site is a rectangle of uniform brightness b. The point spread function G is a Gaussian of unit weight, and a
pixel averages,

    image = 1/P  integral over the pixel dx  integral dy G(x - y) b(y),

which is exact here, axis by axis: the integral of G over an interval of x and one of y is a second
difference of z Phi(z/s) + s phi(z/s), with the standard deviation s of G and the normal distribution Phi and
density phi. Periodic edges repeat the map, reflecting edges mirror it, and beyond free edges it is dark.

Microscopy of contacts: J. H. Dieterich, B. D. Kilgore, Pure Appl. Geophys. 143, 283 (1994), DOI
10.1007/BF00874332. Simulations compared with images in this way: B. Weber et al., Nat. Commun. 9, 888 (2018),
DOI 10.1038/s41467-018-02981-y.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import get_args

import numpy as np
import scipy.special
import xarray as xr
from numpy.typing import ArrayLike

from asperity.analysis.field_values import ONE_TIME, lattice_of
from asperity.base import checks, units
from asperity.contact import Contact
from asperity.errors import InputError
from asperity.lattice import Edges, Field, Mask
from asperity.patches import Patches, patches

_FWHM = 2 * math.sqrt(2 * math.log(2))
"""Full width at half maximum of a Gaussian, in standard deviations."""

_TAIL = 8.5
"""Standard deviations beyond which a Gaussian vanishes in double precision."""

_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Observation:
    """The image of a contact by an instrument.

    Attributes
    ----------
    image
        Mean brightness of each pixel, of a contact from 0 to 1; shape ``(k,)`` or ``(k, l)``.
    seen
        Pixels at or above the threshold, which count as contact. None without a threshold.
    spacing
        Distance between pixels along each axis, length.
    blur, threshold
        As given; lengths in the unit of the spacing.
    edges
        Edges of the image: "periodic", "reflecting" or "free".
    """

    image: Field
    seen: Mask | None
    spacing: tuple[float, ...]
    blur: float
    threshold: float | None
    edges: Edges

    def __repr__(self) -> str:
        shape = " x ".join(map(str, self.image.shape))
        return f"<Observation: {shape} pixels, area {self.area:.4g}, fraction {self.fraction:.4g}>"

    @property
    def area(self) -> float:
        """Area of contact in the image, length^2: of the pixels seen; without a threshold, of the light."""
        return self.fraction * self.image.size * math.prod(self.spacing)

    @property
    def fraction(self) -> float:
        """The area over that of the image."""
        return float(self.image.mean() if self.seen is None else self.seen.mean())

    @property
    def patches(self) -> Patches:
        """Patches of the pixels seen; `InputError` without a threshold."""
        if self.seen is None:
            raise InputError("patches", expected="an observation with a threshold", got="one without")
        return patches(self.seen, edges=self.edges)


def observe(
    image: Contact | xr.Dataset | ArrayLike,
    *,
    pixel: float | str | None = None,
    blur: float | str = 0.0,
    threshold: float | None = None,
    spacing: ArrayLike | None = None,
    edges: Edges | None = None,
) -> Observation:
    """Look at a contact through an instrument: blur it, sample it on pixels, and apply a threshold.

    Parameters
    ----------
    image
        A contact; the dataset of a history with fields of one time (``dataset.isel(field_time=-1)``); or
        the brightness of each site, shape ``(n,)`` or ``(n, m)``: a mask, a pressure, a function of the gap.
    pixel
        Side of the square pixels, length; by default pixels are the sites. They begin at the first edge; less
        than a pixel at the last is not seen.
    blur
        Full width at half maximum of the Gaussian point spread function, length, at most the shortest side.
    threshold
        Least brightness of a pixel that counts as contact, such as 0.5 of full contact. By default all light
        counts.
    spacing, edges
        Of an array: distance between sites along each axis, or one for all, 1 by default; "periodic", the
        default, "reflecting" or "free".

    Returns
    -------
    Observation
        Lengths are those of the contact: metres if it has units; then ``pixel="0.6 um"`` is read too.

    Raises
    ------
    InputError
        A number is out of its range, a text with a unit is given where lengths have none, or there are
        fields of several times.
    """
    brightness, sides, beyond, si = _scene(image, spacing, edges)
    shortest = min(side * n for side, n in zip(sides, brightness.shape, strict=True))
    width = checks.number("blur", _length("blur", blur, si), least=0, most=shortest)
    pixels = sides
    if pixel is not None:
        most = shortest * (1 + _ROUNDING)
        pixels = (checks.number("pixel", _length("pixel", pixel, si), above=0, most=most),) * len(sides)
    limit = None if threshold is None else checks.number("threshold", threshold)
    seen = brightness
    for axis, (site, length) in enumerate(zip(sides, pixels, strict=True)):
        weights = _weights(brightness.shape[axis], site, length, width / _FWHM, beyond)
        seen = np.moveaxis(np.tensordot(weights, seen, axes=(1, axis)), 0, axis)
    return Observation(
        image=seen,
        # Rounding must not decide on a pixel half in contact.
        seen=None if limit is None else seen >= limit - _ROUNDING * abs(limit),
        spacing=pixels,
        blur=width,
        threshold=limit,
        edges=beyond,
    )


def _weights(n: int, site: float, pixel: float, deviation: float, edges: Edges) -> Field:
    """Weight of each site in the mean of each pixel, shape (pixels, sites)."""
    count = max(1, math.floor(n * site / pixel * (1 + _ROUNDING)))
    reach = math.ceil(_TAIL * deviation / site) if deviation else 0
    sites = site * np.arange(-reach, n + reach + 1)
    distance = pixel * np.arange(count + 1)[:, None] - sites
    if deviation:
        z = distance / deviation
        smooth = deviation * (z * scipy.special.ndtr(z) + np.exp(-(z**2) / 2) / math.sqrt(2 * math.pi))
    else:
        smooth = np.maximum(distance, 0.0)
    seen = np.maximum(-np.diff(np.diff(smooth, axis=0), axis=1) / pixel, 0.0)
    place = np.arange(-reach, n + reach) % (n if edges == "periodic" else 2 * n)
    place = np.where(place < n, place, 2 * n - 1 - place)
    weights = np.zeros((n, count))
    if edges == "free":
        place, seen = np.arange(n), seen[:, reach : reach + n]
    np.add.at(weights, place, seen.T)
    return np.asarray(weights.T)


def _scene(
    image: Contact | xr.Dataset | ArrayLike, spacing: ArrayLike | None, edges: Edges | None
) -> tuple[Field, tuple[float, ...], Edges, bool]:
    """Brightness, distance between sites, edges, and whether lengths are in metres."""
    if isinstance(image, (Contact, xr.Dataset)) and not (spacing is None and edges is None):
        name = "edges" if spacing is None else "spacing"
        raise InputError(name, expected="none: the image has its own", got=checks.kind_of(image))
    if isinstance(image, Contact):
        lattice = image.lattice
        return image.in_contact.astype(np.float64), lattice.spacing, lattice.edges, image.si
    if isinstance(image, xr.Dataset):
        touching = image.get("in_contact")
        if touching is None or "field_time" in touching.dims:
            got = "none" if touching is None else f"fields of {image.sizes['field_time']} times"
            raise InputError("image", expected="a dataset with fields of one time", got=got, advice=ONE_TIME)
        lattice = lattice_of(image)
        return touching.values.astype(np.float64), lattice.spacing, lattice.edges, bool(image.attrs.get("si"))
    is_mask = np.asarray(image).dtype == np.bool_
    brightness = checks.heights("image", np.asarray(image, dtype=np.float64) if is_mask else image)
    spacings = np.ones(1) if spacing is None else checks.positive("spacing", spacing).reshape(-1)
    if spacings.size not in (1, brightness.ndim):
        raise InputError("spacing", expected=f"one length, or {brightness.ndim}", got=spacings.size)
    if edges is not None:
        checks.choice("edges", edges, get_args(Edges))
    return brightness, tuple(np.broadcast_to(spacings, brightness.ndim).tolist()), edges or "periodic", False


def _length(name: str, value: float | str, si: bool) -> float:
    if not isinstance(value, str):
        return value
    if not si:
        raise InputError(name, expected="a number: lengths have no unit here", got=checks.shown(value))
    return units.quantity(value, "m", name)
