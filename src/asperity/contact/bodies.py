"""What a contact is of: a rough surface and a solid, whose units meet here."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from asperity.base import checks, units
from asperity.contact.controls import Control, Load, Separation
from asperity.errors import InputError
from asperity.lattice import Field, Lattice
from asperity.solids import Solid
from asperity.surfaces import Surface, check_square
from asperity.surfaces.heights import check_heights


@dataclass(frozen=True, eq=False)
class Bodies:
    """What a contact is of, and what its numbers mean; see `asperity.Contact`."""

    heights: Field
    lattice: Lattice
    solid: Solid
    surface: Mapping[str, object]
    si: bool
    permanent_indentation: Field | float = 0.0

    def with_heights(self, heights: Field, indentation: Field | float) -> Bodies:
        """The same bodies, of which the rough one has other heights, and yielded by an indentation."""
        return Bodies(heights, self.lattice, self.solid, self.surface, self.si, indentation)

    @cached_property
    def sites(self) -> int:
        """Number of sites of the rough body: those whose height is not -inf."""
        return int(np.count_nonzero(np.isfinite(self.heights)))

    @property
    def nominal_area(self) -> float:
        """Area of the rough body, length^2; of a line, its length, as of all areas below."""
        return self.sites * self.lattice.cell


def bodies_of(heights: ArrayLike, solid: Solid) -> Bodies:
    """Put a solid above heights, in units that both have.

    A solid that is a continuum takes a surface with units in metres, its own numbers being in pascals and
    seconds. Anything else has the units of the user, and spacing 1 unless a surface without units gives
    another. A solid that is defined on sites takes heights as they are.
    """
    provenance = getattr(heights, "provenance", None)
    origin = dict(provenance) if isinstance(provenance, dict) else {}
    spacing: tuple[float, ...] = ()
    si = False
    if isinstance(heights, Surface) and heights.pixel_size:
        origin["pixel_size"] = list(heights.pixel_size)
    if isinstance(heights, Surface) and solid.in_lengths:
        si, spacing = heights.has_lengths, heights.pixel_size or ()
        rough = check_heights(heights.heights)
        if si:
            rough, spacing = heights.in_meters()
    else:
        check_square(heights)
        rough = check_heights(heights)
    edges = heights.edges if isinstance(heights, Surface) else "periodic"
    if edges == "free":
        _check_free(solid, rough.ndim)
    return Bodies(rough, Lattice(rough.shape, spacing, edges), solid, origin, si)


def _check_free(solid: Solid, dimension: int) -> None:
    """Refuse what cannot have free edges; some solids refuse themselves, by their spectra."""
    got = {
        "a line contact": dimension == 1,
        "a solid that is defined on sites": not solid.in_lengths,
        "permanent stiffness beside a law of creep": solid.creep is not None and solid.permanent_share > 0,
    }
    if wrong := [case for case, is_so in got.items() if is_so]:
        expected = "a half-space under a 2-D surface, for free edges"
        raise InputError("edges", expected=expected, got=wrong[0], advice="edges='reflecting'")


def control_by(bodies: Bodies, name: str, value: Any) -> Control:
    """Load, or by name pressure or separation, in the units of the bodies; `InputError` where it is none."""
    unit, of_line = {"load": ("N", "N/m"), "pressure": ("Pa", ""), "separation": ("m", "")}[name]
    how: Any = {"si": bodies.si, "of_line": of_line, "dimensions": bodies.lattice.dimension}
    number: Any = units.converted(name, value, unit, **how)
    if name == "separation":
        return Separation(number)
    if name == "pressure":
        least = -math.inf if bodies.solid.adhesion is not None else 0.0
        number = checks.number("pressure", number, above=least, advice="pressure=1e6")
        number *= bodies.nominal_area
    return Load(number)
