"""A contact: two rough bodies at one moment, in mechanical equilibrium, with the proof of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from asperity.base import checks, units, views
from asperity.contact.bodies import Bodies
from asperity.contact.controls import Control, Hold, Load, Separation
from asperity.contact.interface import interface_of
from asperity.contact.partial_slip import PartialSlip
from asperity.contact.problem import Solution, mean_by_rounding
from asperity.contact.response import (
    RIM,
    check_half_space,
    normal_stiffness,
    resistance,
    rim_sides,
    shear_ratio,
)
from asperity.contact.system import System
from asperity.errors import ConvergenceError, InputError
from asperity.lattice import Field, Lattice, Mask, Modes
from asperity.solids import Solid

if TYPE_CHECKING:
    from pathlib import Path

    import xarray as xr
    from matplotlib.axes import Axes

WHERE_FROM = "asperity.press(...), the `final` of a history, or asperity.results.load_contact(path, solid)"
"""Where a user gets a contact."""

Each = float | str | Sequence[float | str]
"""A number of both bodies, or a pair: one of each."""

ACCEPTED_RESIDUAL = 1e-8
"""No fields are returned whose residual, evaluated on these very fields, is larger."""


@dataclass(frozen=True, eq=False)
class AnchorModes:
    """Fourier modes of the anchors u_b relative to a system's datum, which go to sites when asked for."""

    modes: Modes


@dataclass(frozen=True, eq=False, init=False)
class Contact(views.InNotebooks):
    """Two bodies in contact at one moment; made by `press`, `age` and `relax` alone, which judge it.

    Lengths are in the unit of the heights, forces in stiffness times length; where ``si``, in m and N.

    Attributes
    ----------
    heights
        The rigid rough surface, length; an array over the sites, like all fields below. It is lower where it
        has yielded.
    lattice
        The sites: shape, spacing, edges.
    solid
        The elastic solid above it.
    control
        What is prescribed: `Load` or `Separation`.
    permanent_indentation
        By how much the rough surface is lower than it was before it yielded, length.
    force
        Contact force, >= 0; zero off contact.
    in_contact
        Whether a site is in contact.
    separation
        Position of the rigid body, length. On the lattice of springs it is the mean of u0; on a half-space
        without an apparatus, the mean of u, or with free edges the position far away.
    energy
        Elastic energy, force times length (Jagla, Eq. e).
    residual
        Largest force off contact (or tension in contact, or excess over the hardness) that the fields above
        leave, relative to the mean contact force; evaluated from `u` and `anchors` as they are, rounding
        included. Once a continuum has crept, from the Fourier modes of `anchors`, whose fields are judged
        when they are asked for. Where the separation is held and the load has died out, relative to the
        smallest force that double precision can resolve to as many digits.
    residual_scale
        The force to which `residual` is relative.
    iterations
        Iterations spent: multigrid cycles, those of conjugate gradients, or rounds on few contacts.
    surface
        Where the heights came from, as far as known.
    si
        Whether lengths are in metres, forces in newtons and times in seconds.
    """

    heights: Field
    lattice: Lattice
    solid: Solid
    control: Control
    _u: Field
    _anchors: Field | Callable[[], Field]
    permanent_indentation: Field
    force: Field
    in_contact: Mask
    separation: float
    energy: float
    residual: float
    residual_scale: float
    iterations: int
    surface: Mapping[str, object]
    si: bool

    def __init__(self, *_: object, **__: object) -> None:
        raise TypeError(
            "a Contact carries the proof of its equilibrium, so only press, age and relax make one; "
            "to change the load, try asperity.press(contact, load=...)"
        )

    @classmethod
    def _judged(cls, **values: object) -> Contact:
        """Make a contact of fields that were judged."""
        contact = cls.__new__(cls)
        contact.__dict__.update({field.name: values[field.name] for field in fields(cls)})
        contact._close()
        return contact

    def __setstate__(self, state: dict[str, object]) -> None:
        vars(self).update(state)
        self._close()

    def __getstate__(self) -> dict[str, object]:
        return vars(self) | {"_anchors": self._whole_anchors}

    def _close(self) -> None:
        indentation = self.permanent_indentation
        for field in (self.heights, self._u, indentation, self.force, self.in_contact):
            field.flags.writeable = False  # the residual vouches for exactly these numbers

    def __repr__(self) -> str:
        shape = " x ".join(map(str, self.heights.shape))
        force, length = (" N", " m") if self.si else ("", "")
        return (
            f"<Contact: {self.area} of {shape} sites touch, load {self.load:g}{force}, "
            f"separation {self.separation:g}{length}, residual {self.residual:.1e}>"
        )

    @property
    def u(self) -> Field:
        """Height of the elastic surface, length; equal to `heights` in contact, above it elsewhere."""
        return np.asarray(self.lattice.embedding.cut(self._u))

    @property
    def whole(self) -> tuple[Field, Field, Mask]:
        """The surface, the anchors and the contacts, beyond free edges too: fields for solvers."""
        embedding = self.lattice.embedding
        return self._u, self._whole_anchors, embedding.extended(self.in_contact, beyond=False)

    @property
    def anchors(self) -> Field:
        """The creeping shapes u_b of the branches, length; shape ``(branches, *heights.shape)``.

        Once a continuum has crept, they go from Fourier modes to sites when they are first asked for.

        Raises
        ------
        ConvergenceError
            The residual of these fields exceeds 1e-8, for the load is too small for the heights.
        """
        return np.asarray(self.lattice.embedding.cut(self._whole_anchors))

    @property
    def _whole_anchors(self) -> Field:
        fields = self._anchors
        if callable(fields):
            fields = fields()
            vars(self)["_anchors"] = fields
        fields.flags.writeable = False
        return fields

    @property
    def u0(self) -> Field:
        """The creeping shape, length: of the only branch, or `anchors` of several."""
        return self.anchors[0] if len(self.anchors) == 1 else self.anchors

    @cached_property
    def area(self) -> int:
        """Real contact area: the number of sites in contact."""
        return int(np.count_nonzero(self.in_contact))

    @cached_property
    def load(self) -> float:
        """Normal load: the sum of the contact forces."""
        return float(self.force.sum())

    @cached_property
    def yielding_area(self) -> int:
        """Number of sites in contact whose pressure is the hardness."""
        return interface_of(self.solid, self.lattice).yielding(self.force)

    @property
    def contact_fraction(self) -> float:
        """Real over nominal contact area."""
        return self.area / self.heights.size

    @property
    def nominal_area(self) -> float:
        """Area of the whole surface, length^2; of a line, its length, as of all areas below."""
        return self.lattice.sites * self.lattice.cell

    @property
    def contact_area(self) -> float:
        """Real contact area: that of the sites in contact, length^2. It overestimates smooth contacts."""
        return self.area * self.lattice.cell

    @cached_property
    def contact_area_corrected(self) -> float:
        """Real contact area less what counting sites adds at the rim, length^2; see `response.RIM`.

        It is meant for half-spaces; on a layer that is thin beside its contacts, `contact_area` is nearer. On
        a line nothing is subtracted.
        """
        if self.lattice.dimension == 1:
            return self.contact_area
        return (self.area - RIM * rim_sides(self.in_contact, self.lattice)) * self.lattice.cell

    @property
    def gap(self) -> Field:
        """Gap u - heights >= 0, length."""
        return self.u - self.heights

    @property
    def mean_gap(self) -> float:
        """Mean of the gap over all sites, length."""
        return float(self.gap.mean())

    @property
    def rms_gap(self) -> float:
        """Root mean square of the gap over all sites, length."""
        return math.sqrt(float(np.mean(self.gap**2)))

    @property
    def pressure(self) -> Field:
        """Contact pressure, force / length^2: the force of a site over its area."""
        return self.force / self.lattice.cell

    @property
    def mean_pressure(self) -> float:
        """Load over nominal area, force / length^2."""
        return self.load / self.nominal_area

    @property
    def mean_contact_pressure(self) -> float:
        """Load over real contact area, force / length^2; 0 without contact."""
        return self.load / self.contact_area if self.area else 0.0

    @property
    def largest_pressure(self) -> float:
        """Largest contact pressure, force / length^2."""
        return float(self.force.max()) / self.lattice.cell

    @cached_property
    def normal_stiffness(self) -> float:
        """Normal contact stiffness dF / d(approach) at once, force / length.

        The contacts stay what they are, and nothing creeps; so it solves one linear problem. The approach is
        that of `separation`: with free edges one contact of radius a has 2 E* a; with others, where the
        approach is that of the mean of the surface, it is stiffer, see `asperity.theory.hertz`.
        """
        return normal_stiffness(self.system(), self.whole[2])

    def tangential_stiffness(self, poisson: float) -> float:
        """Stiffness against a small shear force, before anything slips, force / length.

        That is 2 (1 - nu) / (2 - nu) times `normal_stiffness`; of half-spaces alone.

        Parameters
        ----------
        poisson
            Poisson's ratio nu, from -1 to 0.5.

        Raises
        ------
        InputError
            The solid is no half-space, or the ratio is out of its range.

        References
        ----------
        K. L. Johnson, *Contact Mechanics* (Cambridge 1985), section 7.2.
        """
        check_half_space("tangential_stiffness", self.solid, self.lattice)
        return shear_ratio(checks.number("poisson", poisson, above=-1, most=0.5)) * self.normal_stiffness

    def resistance(self, resistivity: Each) -> float:
        """Electrical resistance of the constrictions between two half-spaces.

        The current passes where the bodies touch, whatever crept before: what counts are the contacts. Films
        of oxide are not in it.

        Parameters
        ----------
        resistivity
            Of both bodies alike, or a pair, > 0; with units in ohm m, or a text: ``"17 nohm m"``.

        Returns
        -------
        float
            In ohm; without contact infinite. Where edges are not free, between the means of the surfaces.

        Raises
        ------
        InputError
            The solid is no half-space, or the number is none.

        References
        ----------
        J. R. Barber, Proc. R. Soc. A 459, 53 (2003), DOI 10.1098/rspa.2002.1038.
        """
        both = _of_both("resistivity", resistivity, "ohm m", si=self.si)
        return resistance(self.solid, self.lattice, self.normal_stiffness, both)

    def thermal_resistance(self, conductivity: Each) -> float:
        """Thermal resistance of the constrictions between two half-spaces; see `resistance`.

        Parameters
        ----------
        conductivity
            Of both bodies alike, or a pair, > 0; with units in W/m/K, or a text: ``"0.2 W/m/K"``.

        Returns
        -------
        float
            In K/W. What the gas between the bodies and radiation conduct is not in it.

        Raises
        ------
        InputError
            As `resistance`.
        """
        one, other = _of_both("conductivity", conductivity, "W/m/K", si=self.si)
        return resistance(self.solid, self.lattice, self.normal_stiffness, (1 / one, 1 / other))

    def partial_slip(self, shear: float | str, friction: float, poisson: float | None = None) -> PartialSlip:
        """Where the contact sticks and slips under a shear force that does not make it slide.

        At once, under a constant normal load: see `asperity.contact.partial_slip` for the equations.

        Parameters
        ----------
        shear
            Shear force, force; with units N, or a text: ``"2 mN"``. Less than friction times load.
        friction
            Coefficient of friction of a site, > 0.
        poisson
            Poisson's ratio, for the displacement, the stiffness and the energy lost.

        Returns
        -------
        PartialSlip
            ``stick`` and ``slip`` (masks), ``traction``, ``displacement``, ``stiffness``, ``energy_lost``.

        Raises
        ------
        InputError
            The bodies slide, the solid is no half-space, or a number is out of its range.
        """
        slip: PartialSlip = views.made_by("partial_slip")(self, shear, friction, poisson)
        return slip

    def plot(self, ax: Axes | None = None, *, since: Contact | None = None, colorbar: bool = True) -> Axes:
        """Draw where it touches and with which pressure; see `asperity.figures.plot_contact`.

        Parameters
        ----------
        ax
            Where to draw; by default a new figure.
        since
            An earlier contact of the same surface: draw what is new and what is lost since.
        colorbar
            Whether to explain the colors.

        Raises
        ------
        InputError
            The earlier contact is of another surface.
        """
        axes: Axes = views.made_by("plot_contact")(self, ax, since=since, colorbar=colorbar)
        return axes

    @property
    def dataset(self) -> xr.Dataset:
        """All maps and numbers as an xarray Dataset, each with its name, unit and coordinates.

        Maps are over the sites, ``anchors`` over the branches too: ``contact.dataset["pressure"].plot()``.
        """
        dataset: xr.Dataset = views.made_by("contact_dataset")(self)
        return dataset

    def save(self, path: str | Path, *, overwrite: bool = False) -> None:
        """Write `dataset` to a zarr folder, as `asperity.results.save` does.

        `asperity.results.load` reads the Dataset, `asperity.results.load_contact` the contact, to be aged on.
        """
        views.made_by("save")(self.dataset, path, overwrite=overwrite)

    def system(self, control: Control | None = None) -> System:
        """Set up the system that this contact is a state of, under its own control or another."""
        return System.of(self.heights, self.lattice, self.solid, control or self.control)

    @property
    def has_not_crept(self) -> bool:
        """Whether the anchors are flat, to their last digits."""
        return all(float(np.ptp(v)) <= 4 * float(np.spacing(np.abs(v).max())) for v in self.anchors)

    def moved(self, sites: Sequence[int]) -> Contact:
        """Return the contact as a whole, crept shape and all, moved by sites along each axis of its lattice.

        Nothing in the equations tells sites apart, so the residual is that of the same numbers.
        """
        axes = tuple(range(-self.lattice.dimension, 0))
        names = ("heights", "_u", "permanent_indentation", "force", "in_contact")
        fields = {name: np.roll(getattr(self, name), sites, axis=axes) for name in names}
        fields["_anchors"] = np.roll(self.anchors, sites, axis=axes)
        return Contact._judged(**(vars(self) | fields))

    def resting_on(self, heights: Field, indentation: Field) -> Contact:
        """Return a contact of the same bodies from which a march resumes; only its heights are of use."""
        return Contact._judged(**(vars(self) | {"heights": heights, "permanent_indentation": indentation}))

    def become(
        self, system: System, solution: Solution, anchors: Field | AnchorModes, position: float
    ) -> Contact:
        """Publish what the same bodies have become; see `contact_from`. The load may have died out."""
        return contact_from(system, solution, anchors, position, bodies=self, load_may_vanish=True)


def _of_both(name: str, given: Each, unit: str, *, si: bool) -> tuple[float, float]:
    """A number of two bodies, from one for both or a pair."""
    pair = given if isinstance(given, list | tuple) else (given, given)
    if len(pair) != 2:
        raise InputError(name, expected="one number, or one of each body", got=checks.shown(given))
    one, other = (checks.number(name, units.converted(name, value, unit, si=si), above=0) for value in pair)
    return one, other


def control_of(contact: Contact, hold: Hold | None) -> Control:
    """Load or separation of a contact, to be held; by default what it was pressed by.

    Where the area is to be held, the load with which that begins. `InputError` where there is none to hold.
    """
    checks.instance("contact", contact, Contact, WHERE_FROM)
    if hold not in (None, "load", "separation", "area"):
        raise InputError("hold", expected="'load', 'separation' or 'area'", got=repr(hold))
    kept = contact.control if hold in (None, contact.control.name) else None
    if "separation" in (hold, None if kept is None else kept.name):
        return kept or Separation(contact.separation)
    if contact.load <= 0:
        raise InputError(
            "hold",
            expected="a contact that carries a load to hold",
            got="one without any",
            advice="a ramp first: age(contact, times, protocol=[Ramp(1.0, load=400.0)])",
        )
    return kept or Load(contact.load)


def contact_from(
    system: System,
    solution: Solution,
    anchors: Field | float | AnchorModes,
    position: float,
    *,
    bodies: Bodies | Contact,
    load_may_vanish: bool = False,
    least_force: float = 0.0,
) -> Contact:
    """Publish a solution: fields measured like the user's heights, checked once more as published.

    The anchors u_b are fields, the level at which all are flat, or Fourier modes; they and the position of
    the rigid body are relative to the system's datum. `ConvergenceError` where double precision cannot
    resolve the load, unless it may be so small, as it dies out at a held separation. Residuals are relative
    to at least ``least_force``, a mean contact force: that of a contact with which this one is compared.
    """
    datum, mechanics, lattice = system.datum, system.mechanics, system.mechanics.lattice
    lowered, indentation = _lowered(system, solution.u, bodies)
    heights = lattice.extended(lowered, -math.inf)
    surface, u = solution.u, solution.u + datum
    np.maximum(u, heights, out=u)
    np.copyto(u, heights, where=solution.in_contact)
    in_contact = u == heights
    vanishing = load_may_vanish and not system.load
    floor = _smallest_force(system, u) if vanishing or not in_contact.any() else least_force
    yielding = solution.u < system.heights

    def judged(state: _State) -> float:
        if system.load is None:
            size = float(np.abs(u).max()) * mechanics.mean_stiffness
            state.force[...] -= mean_by_rounding(state.force, in_contact, size)
        left = system.interface.violation(state.force, in_contact, yielding, floor)
        if system.load and state.carried is not None:
            # The mean of the stretches is as accurate as waves are: a stiffer one follows from the load.
            most = system.sites * max(1.0, mechanics.mean_stiffness / mechanics.greatest_stiffness)
            touching = np.count_nonzero(in_contact)
            scale = max(system.load, floor * touching)
            left = max(left, abs(state.carried - system.load) / scale * touching / most)
            left = max(left, abs(float(state.force.sum()) - system.load) / scale)
        if not left <= ACCEPTED_RESIDUAL:
            raise ConvergenceError(
                f"residual {left:.1e} after rounding, expected at most {ACCEPTED_RESIDUAL:.0e}: the load is "
                "too small for these heights in double precision; try heights without a large offset, or "
                "more load"
            )
        return left

    def on_sites() -> Field:
        assert isinstance(anchors, AnchorModes)
        fields = _rounded(lattice.backward(anchors.modes), surface, u, datum, mechanics.branches)
        judged(_State.of(system, u - datum, fields - datum, position))
        return fields

    published: Field | Callable[[], Field]
    relative: Field | AnchorModes
    if isinstance(anchors, AnchorModes):
        published, relative = on_sites, anchors
    else:
        published = _rounded(anchors, surface, u, datum, mechanics.branches)
        relative = published - datum
    state = _State.of(system, u - datum, relative, position)
    left, force = judged(state), state.force
    force = system.interface.admit(force, in_contact)
    mean_force = float(force.sum()) / max(int(np.count_nonzero(in_contact)), 1)
    return Contact._judged(
        heights=lowered,
        lattice=bodies.lattice,
        solid=bodies.solid,
        control=system.control,
        _u=u,
        _anchors=published,
        permanent_indentation=indentation,
        force=lattice.cut(force),
        in_contact=lattice.cut(in_contact),
        separation=datum + state.position,
        energy=state.energy(),
        residual=left,
        residual_scale=max(mean_force, floor),
        iterations=solution.iterations,
        surface=bodies.surface,
        si=bodies.si,
    )


@dataclass(frozen=True, eq=False)
class _State:
    """What follows from a surface and its anchors: the position of the rigid body, forces and the energy."""

    position: float
    force: Field
    energy: Callable[[], float]
    carried: float | None

    @classmethod
    def of(cls, system: System, u: Field, anchors: Field | AnchorModes, position: float) -> _State:
        """Of fields, or of anchors in Fourier modes: those at wave vector 0 are sums over the sites."""
        mechanics, mean = system.mechanics, system.mechanics.lattice.mean
        if not isinstance(anchors, AnchorModes):
            position, stretch = system.position(u, anchors, position), u - anchors
            force, energy = system.force(u, stretch, position), system.energy
            carried = system.carried(u, stretch, position)
            return cls(position, force, lambda: energy(u, stretch, position), carried)
        position = system.position(u, anchors.modes[mean].real / system.sites, position)
        surface, held = mechanics.lattice.forward(u), system.held(position)
        modes = surface - anchors.modes
        force, carried = (
            mechanics.force_of_modes(surface, modes, held),
            system.carried(u, modes[mean].real, position),
        )
        return cls(position, force, lambda: mechanics.energy_of_modes(surface, modes, held), carried)


def _lowered(system: System, u: Field, bodies: Bodies | Contact) -> tuple[Field, Field]:
    """Heights of the rough surface, lower where it has yielded under a surface, and by how much in all."""
    before = np.broadcast_to(bodies.permanent_indentation, bodies.heights.shape)
    if not system.yields:
        return bodies.heights, before
    obstacle = system.mechanics.lattice.cut(system.lowered(u).heights)
    lower = obstacle < bodies.heights - system.datum
    heights = np.where(lower, obstacle + system.datum, bodies.heights)
    return heights, before + (bodies.heights - heights)


def _smallest_force(system: System, u: Field) -> float:
    """Force whose last trusted digit is rounding: the scale where there is no load to speak of."""
    stiffest = system.mechanics.greatest_stiffness
    heights = system.mechanics.lattice.cut(system.heights)
    largest = max(float(np.abs(field).max()) for field in (u, u - system.datum, heights))
    return 4 * float(np.spacing(largest)) * stiffest / ACCEPTED_RESIDUAL


def _rounded(anchors: Field | float, surface: Field, u: Field, datum: float, branches: int) -> Field:
    """Move all anchors to the user's datum; see `_rounded_keeping_load`. Flat ones take no memory."""
    if not isinstance(anchors, np.ndarray):
        return np.broadcast_to(_rounded_keeping_load(anchors, surface, u, datum), (branches, *u.shape))
    moved = [_rounded_keeping_load(v, surface, u, datum) for v in anchors]
    return moved[0][np.newaxis] if branches == 1 else np.array(moved).reshape(branches, *u.shape)


def _rounded_keeping_load(anchors: Field | float, surface: Field, u: Field, datum: float) -> Field:
    """Move u0 to the user's datum so that rounding leaves the sum of u - u0, and so the load, alone.

    Rounding errors of a smooth field are alike from site to site and add up; where they would change
    the sum by more than 1e-11 of it, as many sites as it takes are moved by their last digit.
    """
    # A flat u0 takes no memory: all its sites are one number.
    u0 = np.asarray(np.broadcast_to(anchors + datum, u.shape))
    wanted = _sum_of_difference(surface, anchors)
    excess = _sum_of_difference(u, u0) - wanted
    last_digit = float(np.spacing(max(abs(float(u0.max())), abs(float(u0.min())))))
    if abs(excess) > 1e-11 * abs(wanted):
        sites = round(min(abs(excess) / last_digit, u0.size))  # beside 0 the last digit is next to nothing
        chosen = np.linspace(0, u0.size - 1, sites).astype(int)
        u0 = u0.copy()
        u0.flat[chosen] += np.copysign(last_digit, excess)
    return u0


def _sum_of_difference(field: Field, other: Field | float) -> float:
    """Sum over the sites of a difference, some rows at a time to spare memory."""
    rows, some = np.atleast_2d(field), np.atleast_2d(np.broadcast_to(other, field.shape))
    parts = range(0, len(rows), 128)
    return math.fsum(float(np.sum(rows[i : i + 128] - some[i : i + 128])) for i in parts)
