"""A rough profile that slides, and the numbers of its states."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from asperity.analysis.bands import in_tiles
from asperity.contact.bodies import Bodies
from asperity.contact.rim import RIM, rim_sides
from asperity.contact.waves import unit_vector, waves_along
from asperity.errors import InputError
from asperity.lattice import Field, Lattice
from asperity.protocols.legs import sites_along
from asperity.sliding.problem import Sliding, State
from asperity.surfaces.prepare import band, make_periodic

Row = dict[str, Any]

_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Profile:
    """A rough profile that slides, with its mirror images where its edges reflect."""

    bodies: Bodies
    lattice: Lattice
    heights: Field
    direction: tuple[float, ...]
    load: float

    @classmethod
    def of(cls, bodies: Bodies, direction: str | tuple[int, ...], load: float) -> Self:
        """Set up; `InputError` where edges are free, or the surface has no such direction."""
        lattice, heights = bodies.lattice, bodies.heights
        if lattice.edges == "free":
            expected = "periodic or reflecting edges: beyond free ones the profile does not go on"
            raise InputError("edges", expected=expected, got="'free'", cure={"edges": "reflecting"})
        if lattice.reflecting:
            heights = make_periodic(heights, "mirror")
            lattice = Lattice(heights.shape, lattice.spacing)
        way = unit_vector(lattice, sites_along(direction, lattice.dimension))
        return cls(bodies, lattice, heights - heights.max(), way, load)

    @property
    def waves(self) -> tuple[float, float]:
        """Wave numbers along the motion, largest and smallest."""
        waves = np.abs(waves_along(self.lattice, self.direction)[0])
        return float(waves.max()), float(waves[waves > 0].min())

    @cached_property
    def without_last_octave(self) -> Self | None:
        """The profile without waves shorter than four sites; None if it has none."""
        spacing = self.lattice.spacing
        heights = band(self.heights, spacing, {"shortest": 4 * max(spacing)}, reflecting=False)
        body = np.isfinite(heights)
        if np.ptp((heights - self.heights)[body]) <= _ROUNDING * np.ptp(heights[body]):
            return None
        return replace(self, heights=heights - heights.max())

    @property
    def copies(self) -> float:
        """Sites over those of the scan."""
        return self.lattice.sites / math.prod(self.bodies.lattice.shape)

    def at(self, speed: float) -> Sliding:
        """The contact problem at a speed."""
        how = self.direction, speed, self.copies * self.load
        return Sliding.of(self.lattice, self.heights, self.bodies.solid, *how)

    def tiles(self, state: State) -> dict[str, Field]:
        """What tiles of the scan have: sites of the body, those in contact, load and friction."""
        arising = state.problem.slope * state.problem.compliance.imag
        friction = state.force * self.lattice.apply(arising, state.force)
        maps = {"sites": np.isfinite(self.heights), "area": state.in_contact}
        maps |= {"load": state.force, "friction": friction}
        return {name: in_tiles(self.of_scan(field)[np.newaxis])[0] for name, field in maps.items()}

    def of_scan(self, field: Field) -> Field:
        """Sum over the mirror images."""
        for axis in range(self.lattice.dimension) if self.copies > 1 else ():
            field = field.astype(float) + np.flip(field, axis)
        return field[tuple(map(slice, self.bodies.lattice.shape))]

    def pressure(self, state: State) -> Field:
        """Contact pressure of each site of the scan; its force on a solid that is defined on sites."""
        return state.force[tuple(map(slice, self.bodies.lattice.shape))] / self.area_of_site

    @property
    def branches(self) -> int:
        """Branches whose spectra are kept one by one."""
        return 0 if self.bodies.solid.shares is not None else len(self.bodies.solid.branches)

    @property
    def area_of_site(self) -> float:
        """Area of a site; 1 on a solid that is defined on sites."""
        return self.lattice.cell if self.bodies.solid.in_lengths else 1.0

    def row(self, state: State) -> Row:
        """Numbers of a state."""
        body, sites = np.isfinite(self.heights), np.count_nonzero(state.in_contact)
        rim = RIM * rim_sides(state.in_contact, self.lattice, body)
        area = self.area_of_site / self.copies
        load = self.copies * self.load
        corrected = {"contact_area_corrected": (sites - rim) * area} if self.bodies.solid.in_lengths else {}
        return {
            "hysteresis_friction_coefficient": state.friction / load,
            "contact_area": sites * area,
            **corrected,
            "contact_fraction": sites / np.count_nonzero(body),
            "mean_gap": float((state.u - self.heights)[body].mean()),
            "largest_pressure": float(state.force.max()) / self.area_of_site,
            "slope_friction_coefficient": state.friction_of_slopes / load,
            "residual": state.residual,
            "products": state.products,
        }
