"""Anchors u_b of the branches relative to the datum, as fields or Fourier modes, and what balances them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from asperity.contact.system import System
from asperity.lattice import Field, Lattice, Modes


class Balance(NamedTuple):
    """What follows from a surface and its anchors: the position of the rigid body, forces and the energy.

    ``carried`` is the load that hangs on the rigid body, None where nothing hangs on it.
    """

    position: float
    force: Field
    energy: Callable[[], float]
    carried: float | None


class Anchors(ABC):
    """The creeping shapes of the branches relative to the datum."""

    @abstractmethod
    def on(self, lattice: Lattice) -> Field:
        """Fields on the sites, with the branches as first axis."""

    @abstractmethod
    def balance(self, system: System, u: Field, position: float) -> Balance:
        """Forces and energy of a surface above them, with the rigid body near a position."""


@dataclass(frozen=True, eq=False)
class AnchorFields(Anchors):
    """Anchors as fields; flat ones may take no memory."""

    fields: Field

    @classmethod
    def flat(cls, level: float, system: System) -> AnchorFields:
        """All at one level."""
        return cls(np.broadcast_to(level, (system.mechanics.branches, *system.heights.shape)))

    def on(self, lattice: Lattice) -> Field:
        """See `Anchors`."""
        del lattice
        return self.fields

    def balance(self, system: System, u: Field, position: float) -> Balance:
        """See `Anchors`."""
        position, stretch = system.body.position(u, self.fields, position), u - self.fields
        mechanics, held = system.mechanics, system.held(position)
        force, carried = mechanics.force(u, stretch, held), system.body.carried(u, stretch, position)
        return Balance(position, force, lambda: mechanics.energy(u, stretch, held), carried)


@dataclass(frozen=True, eq=False)
class AnchorModes(Anchors):
    """Anchors in Fourier modes, in which a branch costs no transform."""

    modes: Modes

    def on(self, lattice: Lattice) -> Field:
        """See `Anchors`."""
        return lattice.backward(self.modes)

    def balance(self, system: System, u: Field, position: float) -> Balance:
        """See `Anchors`; what hangs at wave vector 0 are sums over the sites."""
        mechanics, mean = system.mechanics, system.mechanics.lattice.mean
        position = system.body.position(u, self.modes[mean].real / system.sites, position)
        surface, held = mechanics.lattice.forward(u), system.held(position)
        stretch = surface - self.modes
        force = mechanics.force_of_modes(surface, stretch, held)
        carried = system.body.carried(u, stretch[mean].real, position)
        return Balance(position, force, lambda: mechanics.energy_of_modes(surface, stretch, held), carried)
