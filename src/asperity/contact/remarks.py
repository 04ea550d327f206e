"""Remarks on a contact, its surface and its solid: one list for all that press bodies together.

Rough bodies stick where the attraction beside their contacts exceeds the repulsion in them (L. Pastewka,
M. O. Robbins, PNAS 111, 3298 (2014), DOI 10.1073/pnas.1320846111):

    pi x / d  w / r  >  h' E* / 2,        x = d (3 r / (4 h' d))^(2/3),        d = 4 h' / h''.

Patches of the mean diameter d have the mean pressure h' E* / 2, with the rms slope h' and the rms Laplacian
h''. Beside them the gap is (4/3) h' d (x / d)^(3/2), and bodies attract each other by w / r where it is less
than r.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from asperity.base.words import counted
from asperity.contact.bodies import Bodies
from asperity.contact.contact import Contact
from asperity.contact.rim import RIM, rim_sides
from asperity.lattice import Field, Mask
from asperity.patches import patches
from asperity.relaxation.materials import relaxing_of
from asperity.solids import Solid
from asperity.surfaces import Surface
from asperity.surfaces.asperities import SHAPES
from asperity.surfaces.doubts import BORNE
from asperity.surfaces.moments import Statistics

_FEW = 10
"""Pixels of a patch below which its shape is not resolved."""

# Contact area over Persson's above which a remark is made. Random surfaces have 0.7 to 2.5, most with patches
# of single pixels; offsets of lines of twice the rms height have 3 and more.
_BEYOND = 3.0

_PITTED = -2.0  # skewness below which pits are named; Gaussian heights have 0
_MODULI = (1e2, 2e12)  # E* of solids, Pa
_LIGHT = 1e-8  # pressure over E* that leaves a contact to be seen
_STEEP = 0.3  # rms slope above which surfaces are not nearly flat: sqrt(1 + 0.3^2) = 1.04
_WIDE = {"free": 0.9, "reflecting": 0.5, "periodic": 0.5}  # widest contact over its cell, by its edges
_SOFT = 1e8  # E* of rubbers and gels, which do not yield, Pa
_WORK, _RANGE = 0.05, 0.5e-9  # of van der Waals forces: usual work of adhesion, J/m^2, and its range, m


@dataclass(frozen=True)
class Resolved:
    """A contact at one moment, and how well pixels resolve it.

    Attributes
    ----------
    patches
        Patches of contact.
    mean
        Pixels of a patch on average.
    in_small
        Part of the area that lies in patches of fewer than ten pixels.
    rim
        Part of the counted area that the rim correction removes.
    when
        The moment in words.
    width
        Width of the largest patch over that of the cell, along the axis where that is more.
    fraction
        Counted contact area over the nominal one.
    strain
        Mean contact pressure over E*.
    pressure, effective
        Load over the nominal area; and the one under which an elastic half-space has this contact, Pa, NaN
        where it is unknown.
    on_filled
        Share of the load on filled pixels.
    """

    patches: int
    mean: float
    in_small: float
    rim: float
    when: str = ""
    width: float = 0.0
    fraction: float = 0.0
    strain: float = 0.0
    pressure: float = 0.0
    effective: float = math.nan
    on_filled: float = 0.0

    @classmethod
    def of(
        cls, bodies: Bodies, touches: Mask, pressure: Field, when: str, filled: Mask | None, *loads: ArrayLike
    ) -> Self:
        """Measure a contact of two bodies after times and loads over the nominal area."""
        lattice, solid = bodies.lattice, bodies.solid
        found, effective = patches(touches, edges=lattice.edges), math.nan
        area, largest = max(int(found.sizes.sum()), 1), np.nonzero(found.labels == 1)
        if solid.half_space and solid.separable:
            effective = float(relaxing_of(solid).effective_load(*loads)[-1])
        return cls(
            patches=found.count,
            mean=found.mean_size,
            in_small=float(found.sizes[found.sizes < _FEW].sum()) / area,
            rim=RIM * rim_sides(touches, lattice, np.isfinite(bodies.heights)) / area,
            when=when,
            width=max(np.unique(i).size / n for i, n in zip(largest, lattice.shape, strict=True)),
            fraction=float(touches.sum()) / bodies.sites,
            strain=float(pressure[touches].sum()) / area / (solid.modulus or math.inf),
            pressure=float(pressure.sum()) / bodies.sites,
            effective=effective,
            on_filled=0.0 if filled is None else float(pressure[filled].sum() / (pressure.sum() or 1.0)),
        )


def resolution_of(contact: Contact, rough: Surface, when: str, age: float = 0.0) -> Resolved:
    """Measure a contact whose load has stayed for an age."""
    loads = (0.0, age), 2 * (contact.mean_pressure,)
    return Resolved.of(contact, contact.in_contact, contact.pressure, when, rough.filled, *loads)


def remarks_on_bodies(rough: Surface, solid: Solid) -> Iterator[str]:
    """Remarks on a surface, its edges, and its slope and adhesion beside a solid."""
    yield from rough.remarks
    if "periodic_rule" in rough.provenance and rough.edges == "free":
        yield "edges are free: the body ends with the scan, and does not tilt"
    elif "periodic_rule" in rough.provenance and rough.edges == "reflecting":
        yield "edges reflect, as for a part of a larger surface; a body that ends with the scan has free ones"
    if _is_shape(rough) or not (solid.in_lengths and rough.has_lengths):
        return
    measures, modulus = rough.in_si, solid.modulus or math.inf
    if not _MODULI[0] <= (solid.modulus or 1e9) <= _MODULI[1]:
        yield f"E* is {modulus:.3g} Pa, and solids have 100 Pa to 2 TPa: numbers are in Pa, texts have units"
    if (slope := measures.rms_slope) > _STEEP:
        yield f"the rms slope is {slope:.2g}: the theory takes surfaces as nearly flat, of {_STEEP:g} at most"
    if solid.adhesion is None and modulus < _SOFT and (work := sticking_work(measures, modulus)) < _WORK:
        usual = f"usual is {1e3 * _WORK:.0f} mJ/m^2, and it is left out"
        yield f"bodies so soft stick above a work of adhesion of {1e3 * work:.2g} mJ/m^2; {usual}"


def sticking_work(measures: Statistics, modulus: float) -> float:
    """Work of adhesion above which rough bodies stick, J/m^2; see the module. Heights are in m."""
    slope, curvature = measures.rms_slope, measures.rms_curvature
    if not (slope and curvature):
        return 0.0
    rim = math.pow(3 * _RANGE * curvature / (8 * slope**2), 2 / 3)  # x / d, where h'' is twice the curvature
    return slope * modulus / 2 * _RANGE / (math.pi * rim)


def remarks_on_contacts(
    rough: Surface, solid: Solid, contacts: Sequence[Resolved], others: str = ""
) -> Iterator[str]:
    """Remarks on contacts of two bodies, each once, at the first that it is true of.

    `others` names the contacts, if their number is to be told: ``"rows"``.
    """
    limits = solid.in_lengths and rough.has_lengths and rough.heights.ndim == 2
    measures = rough.in_si if limits else None
    for texts in zip(*(_remarks(rough, solid, one, measures) for one in contacts), strict=True):
        first, *more = [text for text in texts if text] or [""]
        if others and more:
            first += f"; likewise in {len(more)} of {len(texts) - 1} other {others}"
        yield from [first] if first else []


def _remarks(rough: Surface, solid: Solid, seen: Resolved, measures: Statistics | None) -> list[str]:
    """All remarks on a contact, in one order; "" for one that is not true of it."""
    when, filled = seen.when, ""
    if seen.on_filled > BORNE:
        cure = "crop the scan, measure another place, or set undefined = 'no-body' where there is none"
        filled = f"{100 * seen.on_filled:.3g} % of the load is on filled pixels: {cure}"
    if measures is None:
        return [filled]
    shape, soft = _is_shape(rough), (solid.modulus or math.inf) < _SOFT
    cause = "real asperities would yield, and these do not; set a hardness"
    cause = "strains are large, and the theory is of small ones" if soft else cause
    share = f"{100 * seen.strain:.2g} % of E*" if seen.strain < 1 else f"{seen.strain:.3g} times E*"
    ends = "there the body ends" if rough.edges == "free" else "images beyond the edges disturb it"
    relative = seen.pressure / (solid.modulus or math.inf)
    wide, small, full = 100 * seen.width, 100 * seen.in_small, 100 * seen.fraction
    said = {
        f"{small:.0f} % of the area {when} lies in patches of fewer than {_FEW} pixels: "
        "the scan does not resolve them, and a finer one would change the area": small > 20 and not shape,
        f"{counted(seen.patches, 'patch', 'patches')} {when}: too few for the statistics of a surface": 0
        < seen.patches
        < 30
        and not shape,
        f"the contact is {wide:.0f} % as wide as the cell {when}: {ends}": shape
        and seen.width > _WIDE[rough.edges],
        f"the mean contact pressure is {share} {when}: {cause}": seen.strain > 0.05 and not solid.yields,
        f"the load over the nominal area is {seen.pressure:.3g} Pa {when}, {relative:.1g} of E*: numbers are "
        "in Pa or N, texts have units": 0 < relative < _LIGHT and solid.adhesion is None,
        f"{full:.0f} % of the surface touches {when}: "
        "on a larger surface longer waves would keep the bodies further apart": full > 50 and not shape,
    }
    theory = _beyond_theory(rough, solid, seen, measures)
    return [filled, theory, *(text if is_so else "" for text, is_so in said.items())]


def _beyond_theory(rough: Surface, solid: Solid, seen: Resolved, measures: Statistics) -> str:
    """Remark on a measured contact many times that of random heights, with the cures that were not taken."""
    if "kind" in rough.provenance or not (seen.effective > 0 and measures.rms_slope > 0):
        return ""
    from asperity.theory import persson_area  # takes as long as all else that a press imports

    expected = persson_area(seen.effective, modulus=solid.modulus or math.inf, slope=measures.rms_slope)
    if (touches := seen.fraction * (1 - seen.rim)) <= _BEYOND * expected:
        return ""
    cause, facts = "a bow, offsets of lines or spikes bear it", rough.provenance
    left = [] if facts.get("tilt_rule") == "quadratic" else ["tilt = 'quadratic'"]
    left += [] if facts.get("lines_rule") == "median" else ["lines = 'median'"]
    left += [] if "despiked_pixels" in facts else ["despike = true"]
    if measures.skewness < _PITTED:
        cause, left = f"pits (skewness {measures.skewness:.3g}) raise the slope and bear nothing", []
    cure = f"; try {', '.join(left)}" if left else ""
    return (
        f"{100 * touches:.2g} % of the surface touches {seen.when}; random heights of its rms slope "
        f"would have {100 * expected:.2g} % (Persson's theory): {cause}{cure}"
    )


def _is_shape(rough: Surface) -> bool:
    """Whether a surface is a shape alone, which has no statistics."""
    return rough.provenance.get("kind") in SHAPES and "other" not in rough.provenance
