"""A solid above a rough surface under a prescribed load or at a prescribed separation."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from asperity.contact.controls import EXPECTED, Control
from asperity.contact.interface import Interface
from asperity.contact.mechanics import ImplicitStep, Mechanics, mechanics_of
from asperity.contact.problem import ContactProblem, Solution
from asperity.contact.rigid_body import Prescribed, RigidBody
from asperity.errors import InputError
from asperity.lattice import Field, Lattice
from asperity.solids import Solid


@dataclass(frozen=True)
class Tuning:
    """Numbers of systems."""

    most_of_all: float = 0.999
    """Largest load, over that under which all sites yield."""


TUNING = Tuning()


@dataclass(frozen=True, eq=False)
class System:
    """A solid, a rough surface and what is prescribed.

    Heights, u, u_b and the position of the rigid body are measured from `datum`, the highest point of the
    rough surface. Fields are over the lattice of the mechanics: where there is no body heights are -inf. A
    ``external`` force of each site acts beside that of contact; the load is the sum of both.
    """

    mechanics: Mechanics
    heights: Field
    datum: float
    control: Control
    external: Field | None = None

    @classmethod
    def of(cls, heights: Field, lattice: Lattice, solid: Solid, control: Control) -> System:
        """Set up from checked heights; `InputError` if the solid cannot be used, or not with this control."""
        datum = float(heights.max())
        mechanics = mechanics_of(solid, lattice.embedding)
        if mechanics.body.stiffness == 0 and not control.load_controlled:
            raise InputError(
                "separation",
                expected="springs or an apparatus, which hold the solid at a separation",
                got="a solid without either",
                advice="load=..., or half_space(..., apparatus=math.inf)",
            )
        return cls(mechanics, mechanics.lattice.extended(heights - datum, -math.inf), datum, control)

    def at(self, time: float) -> System:
        """Return the system with what is prescribed at a time, constant from there."""
        return replace(self, control=self.control.at(time)) if self.control.course else self

    def above(self, heights: Field) -> System:
        """Return the system above other heights."""
        datum = float(heights.max())
        above = self.mechanics.lattice.extended(heights - datum, -math.inf)
        return replace(self, heights=above, datum=datum)

    @property
    def sites(self) -> int:
        """Number of sites N."""
        return self.mechanics.lattice.sites

    @property
    def load(self) -> float | None:
        """The normal load, where it is prescribed."""
        return self.control.value if self.control.load_controlled else None

    @property
    def body(self) -> RigidBody:
        """The rigid body, with its springs."""
        return self.mechanics.body

    @property
    def interface(self) -> Interface:
        """Bounds of the forces of a state."""
        return self.mechanics.interface.beside(self.external)

    @property
    def yields(self) -> bool:
        """Whether the rough surface yields under forces that are large enough."""
        return self.mechanics.interface.yields

    @property
    def sticks(self) -> bool:
        """Whether sites attract each other, so that a load may pull."""
        return self.mechanics.interface.adhesion is not None

    def pulled(self, u: Field) -> System:
        """Return the system whose external forces include the adhesion under a surface u."""
        if not self.sticks:
            return self
        pull = self.mechanics.interface.pull(u - self.heights)
        return replace(self, external=pull if self.external is None else self.external + pull)

    def lowered(self, u: Field) -> System:
        """Return the system whose rough surface has yielded to a surface u below it."""
        heights = self.mechanics.interface.lowered(self.heights, u)
        return self if heights is self.heights else replace(self, heights=heights)

    def held(self, position: float = 0.0) -> Prescribed:
        """What is prescribed; ``position`` is that of the rigid body before, where the load moves it."""
        if self.load is None:
            return Prescribed(None, self.control.value - self.datum, self.external)
        if self.load < 0 and not self.sticks:
            advice = "adhesion=asperity.solids.Dugdale(...), for a load that pulls"
            raise InputError("load", expected=EXPECTED, got=f"{self.load:g}", advice=advice)
        sites = np.count_nonzero(np.isfinite(self.heights)) if self.yields else 1
        most = TUNING.most_of_all * self.mechanics.interface.high * sites
        if self.load > most:
            hardness = f"the hardness {self.mechanics.solid.hardness:g} times the nominal area"
            expected = f"at most {most:.8g}, {TUNING.most_of_all:g} of {hardness}"
            advice = "less load, or a greater hardness"
            raise InputError("load", expected=expected, got=f"{self.load:.8g}", advice=advice)
        return Prescribed(self.load, position, self.external)

    @property
    def drift(self) -> float:
        """Velocity of the rigid body, and of the anchors with it, at time 0; 0 under a load."""
        return self.control.rate if self.load is None else 0.0

    def moved(self, since: float, time: float) -> float:
        """How far a moving rigid body takes the anchors from a time to another; 0 under a load."""
        return self.control.change(since, time) if self.load is None else 0.0

    @property
    def free_mean(self) -> bool:
        """Whether the mean of u0 creeps: viscous or local creep at a held separation."""
        return self.load is None and (self.body.mobility > 0 or self.mechanics.law is not None)

    def problem(self, step: ImplicitStep, anchors: Field) -> ContactProblem:
        """The contact problem of an implicit step from anchors v_b."""
        return step.problem(self.heights, anchors, self.held())

    def stretch(
        self, step: ImplicitStep, solution: Solution, anchors: Field, position: float
    ) -> tuple[Field, float]:
        """Stretches w_b = u - u_b after a step, and where the rigid body then is."""
        if solution.stretch is not None:
            return solution.stretch[np.newaxis], position
        return step.stretch(solution.u, anchors, self.held(position))

    def balanced_stretch(self, u: Field, stretch: Field) -> Field:
        """Stretches with which the surface u is in exact equilibrium, near some with which it almost is."""
        mean, total = self.body.stretch(self.load), None
        if mean is not None:
            total = self.sites * mean
        elif not self.free_mean:  # then the mean of u0 stays, and of u - u0 with it
            total = float(stretch.sum())
        return self.mechanics.balanced_stretch(u, stretch, self.heights, total, self.interface)
