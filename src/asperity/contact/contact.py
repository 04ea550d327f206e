"""A contact: two rough bodies at one moment, in mechanical equilibrium, with the proof of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from asperity.base import checks, views
from asperity.base.rows import Row
from asperity.contact.anchors import AnchorFields, Anchors
from asperity.contact.bodies import Bodies
from asperity.contact.controls import Control, Hold, Load, Separation
from asperity.contact.interface import interface_of
from asperity.contact.partial_slip import PartialSlip
from asperity.contact.rim import RIM, rim_sides
from asperity.contact.system import System
from asperity.errors import InputError
from asperity.lattice import Field, Mask
from asperity.surfaces.prepare import of_body

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

    PullOff = Any

WHERE_FROM = "asperity.press(...), the `final` of a history, or asperity.results.load_contact(path, solid)"
"""Where a user gets a contact."""

Each = float | str | Sequence[float | str]
"""A number of both bodies, or a pair: one of each."""

Direction = Literal["x", "y"] | float
"""Along the rows, from row to row, or degrees from x towards y."""


@dataclass(frozen=True, eq=False, init=False)
class Contact(Bodies, views.InNotebooks):
    """Two bodies in contact at one moment; made by `press`, `age` and `relax` alone, which judge it.

    Lengths are in the unit of the heights, forces in stiffness times length; where ``si``, in m and N.

    Attributes
    ----------
    heights
        The rigid rough surface, length; an array over the sites, like all fields below. It is lower where it
        has yielded, and -inf where there is no body.
    lattice
        The sites: shape, spacing, edges.
    solid
        The elastic solid above it.
    surface
        Where the heights came from, as far as known.
    si
        Whether lengths are in metres, forces in newtons and times in seconds.
    permanent_indentation
        By how much the rough surface is lower than it was before it yielded, length.
    control
        What is prescribed: `Load` or `Separation`.
    force
        Force of a site: >= 0 in contact, zero off contact. Where bodies stick, it includes their attraction.
    in_contact
        Whether a site is in contact.
    energy
        Elastic energy, force times length (Jagla, Eq. e), and that of adhesion, an integral over the sites.
    residual
        Largest force off contact (or tension in contact, or excess over the hardness) that the fields leave,
        relative to the mean contact force, or to the attraction of a site where bodies stick and that is
        more; evaluated from u and the anchors as they are kept, measured from
        the highest point of the heights, rounding included. Once a continuum has crept, anchors are kept as
        Fourier modes. Where the separation is held and the load has died out, relative to the smallest force
        that double precision can resolve to as many digits.
    residual_scale
        The force to which `residual` is relative.
    iterations
        Iterations spent: multigrid cycles, those of conjugate gradients, or rounds on few contacts.
    """

    permanent_indentation: Field
    control: Control
    force: Field
    in_contact: Mask
    energy: float
    residual: float
    residual_scale: float
    iterations: int
    # Relative to the highest point of the heights, and beyond free edges too.
    _surface: Field
    _anchors: Anchors
    _position: float

    def __init__(self, *_: object, **__: object) -> None:
        raise TypeError(
            "a Contact carries the proof of its equilibrium, so only press, age and relax make one; "
            "to change the load, try asperity.press(contact, load=...)"
        )

    @classmethod
    def _judged(cls, **values: object) -> Contact:
        """Make a contact of fields that were judged."""
        contact = cls.__new__(cls)
        contact.__setstate__({field.name: values[field.name] for field in fields(cls)})
        return contact

    def __setstate__(self, state: dict[str, object]) -> None:
        vars(self).update(state)
        for field in vars(self).values():
            if isinstance(field, np.ndarray):
                field.flags.writeable = False  # the residual vouches for exactly these numbers

    def __getstate__(self) -> dict[str, object]:
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def __repr__(self) -> str:
        shape = " x ".join(map(str, self.heights.shape))
        force, length = (" N/m" if len(self.heights.shape) == 1 else " N", " m") if self.si else ("", "")
        return (
            f"<Contact: {self.area} of {shape} sites touch, load {self.load:g}{force}, "
            f"separation {self.separation:g}{length}, residual {self.residual:.1e}>"
        )

    @cached_property
    def u(self) -> Field:
        """Height of the elastic surface, length; equal to `heights` in contact, above it elsewhere."""
        u: Field = np.maximum(self.lattice.embedding.cut(self._surface) + self.datum, self.heights)
        np.copyto(u, self.heights, where=self.in_contact)
        u.flags.writeable = False
        return u

    @cached_property
    def anchors(self) -> Field:
        """The creeping shapes u_b of the branches, length; shape ``(branches, *heights.shape)``."""
        anchors: Field = self.lattice.embedding.cut(self.relative[1]) + self.datum
        anchors.flags.writeable = False
        return anchors

    @property
    def u0(self) -> Field:
        """The creeping shape, length: of the only branch, or `anchors` of several."""
        return self.anchors[0] if len(self.anchors) == 1 else self.anchors

    @property
    def separation(self) -> float:
        """Position of the rigid body, length.

        On the lattice of springs it is the mean of u0; on a half-space without an apparatus, the mean of u,
        or with free edges the position far away.
        """
        return self.datum + self._position

    @cached_property
    def datum(self) -> float:
        """The highest point of the heights, length."""
        return float(self.heights.max())

    @cached_property
    def relative(self) -> tuple[Field, Field, Mask, float]:
        """Surface, anchors, contacts, and the position of the body as they are kept: for solvers.

        They are relative to `datum`; fields go beyond free edges.
        """
        embedding = self.lattice.embedding
        in_contact = embedding.extended(self.in_contact, beyond=False)
        return self._surface, self._anchors.on(embedding), in_contact, self._position

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
        return self.area / self.sites

    @property
    def contact_area(self) -> float:
        """Real contact area: that of the sites in contact, length^2. It overestimates smooth contacts."""
        return self.area * self.lattice.cell

    @cached_property
    def contact_area_corrected(self) -> float:
        """Real contact area less what counting sites adds at the rim, length^2; see `rim.RIM`.

        It is meant for half-spaces; on a layer that is thin beside its contacts, `contact_area` is nearer. On
        a line nothing is subtracted.
        """
        sides = rim_sides(self.in_contact, self.lattice, np.isfinite(self.heights))
        return (self.area - (self.lattice.dimension - 1) * RIM * sides) * self.lattice.cell

    @cached_property
    def gap(self) -> Field:
        """Gap u - heights >= 0, length; infinite where there is no body."""
        gap: Field = self.lattice.embedding.cut(self._surface) - (self.heights - self.datum)
        return gap

    @property
    def mean_gap(self) -> float:
        """Mean of the gap over the sites of the body, length."""
        return float(of_body(self.gap).mean())

    @property
    def rms_gap(self) -> float:
        """Root mean square of the gap over the sites of the body, length."""
        return math.sqrt(float(np.mean(of_body(self.gap) ** 2)))

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
        """Instantaneous normal contact stiffness dF / d(approach), force / length.

        The contacts stay what they are, and nothing creeps; so it solves one linear problem. The approach is
        that of `separation`: with free edges one contact of radius a has 2 E* a; with others, where the
        approach is that of the mean of the surface, it is stiffer, see `asperity.theory.hertz`.
        """
        return self._normal_stiffness()

    @views.later
    def rows(self, /) -> list[Row]:
        """Rows of a summary: name, value with its unit."""
        raise NotImplementedError

    @views.later
    def _normal_stiffness(self, /) -> float:
        raise NotImplementedError

    @views.later
    def tangential_compliance(self, /, poisson: float) -> Field:
        """Displacements along y and x by a unit of shear force along y and x, before anything slips.

        Of half-spaces alone, all contacts together, without an apparatus; see `asperity.carried.shear`.

        Parameters
        ----------
        poisson
            Poisson's ratio nu, from -1 to 0.5.

        Returns
        -------
        numpy.ndarray
            Shape ``(2, 2)``, symmetric, length / force; infinite without contact.

        Raises
        ------
        InputError
            The solid is no half-space, or the ratio is out of its range.

        References
        ----------
        K. L. Johnson, *Contact Mechanics* (Cambridge 1985), sections 3.6 and 7.2.
        """
        raise NotImplementedError

    @views.later
    def tangential_stiffness(self, /, poisson: float, direction: Direction | None = None) -> float:
        """Stiffness against a small shear force, before anything slips, force / length.

        Parameters
        ----------
        poisson
            Poisson's ratio nu, from -1 to 0.5.
        direction
            Of the force: ``"x"`` (along the rows), ``"y"`` or degrees from x towards y. By default the result
            is the inverse of the mean compliance over all directions.

        Raises
        ------
        InputError
            As `tangential_compliance`, or there is no such direction.
        """
        raise NotImplementedError

    @views.later
    def resistance(self, /, resistivity: Each) -> float:
        """Electrical resistance of the constrictions between two half-spaces.

        The current passes where the bodies touch, whatever crept before. Films of oxide are not in it.

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
        raise NotImplementedError

    @views.later
    def thermal_resistance(self, /, conductivity: Each) -> float:
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
        raise NotImplementedError

    @views.later
    def partial_slip(
        self,
        /,
        shear: float | str,
        friction: float,
        poisson: float | None = None,
        direction: Direction = "x",
    ) -> PartialSlip:
        """Where the contact sticks and slips under a shear force that does not make it slide.

        At once, under a constant normal load: see `asperity.contact.partial_slip` for the equations.

        Parameters
        ----------
        shear
            Shear force, force; with units N, or a text: ``"2 mN"``. Less than friction times load.
        friction
            Coefficient of friction of a site, > 0.
        poisson
            Poisson's ratio, for the displacement, the stiffness and the energy lost. By default sites stick
            as at 0.
        direction
            Of the shear force: ``"x"`` (along the rows), ``"y"`` or degrees from x towards y.

        Returns
        -------
        PartialSlip
            ``stick`` and ``slip`` (masks), ``traction``, ``displacement``, ``stiffness``, ``energy_lost``.

        Raises
        ------
        InputError
            The bodies slide, the solid is no half-space, or a number is out of its range; or edges reflect,
            and the direction is neither x nor y.
        """
        raise NotImplementedError

    @views.later
    def pull_off(self, /, work: float | str) -> PullOff:
        """Pull the bodies apart instantly, by an adhesion whose range is below the pixel.

        From the contacts that have aged without adhesion; creep is frozen, so that rates are out of it. Sites
        open for good where that releases the work of adhesion; see `asperity.carried.pull_off`.

        Parameters
        ----------
        work
            Work of adhesion of fast separation, energy per area, > 0; with units J/m^2, or a text:
            ``"50 mJ/m^2"``.

        Returns
        -------
        PullOff
            ``force``, the largest tension; ``path``, a Dataset; ``ratio``, load over that force.

        Raises
        ------
        InputError
            The solid is defined on sites, or no or all sites are in contact, or the work is out of its range.
        """
        raise NotImplementedError

    @views.later
    def plot(self, /, ax: Axes | None = None, *, since: Contact | None = None, colorbar: bool = True) -> Axes:
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
        raise NotImplementedError

    @property
    def dataset(self) -> xr.Dataset:
        """All maps and numbers as an xarray Dataset, each with its name, unit and coordinates.

        Maps are over the sites, ``anchors`` over the branches too: ``contact.dataset["pressure"].plot()``.
        """
        return self._dataset()

    @views.later
    def _dataset(self, /) -> xr.Dataset:
        raise NotImplementedError

    @views.later
    def save(self, /, path: str | Path, *, overwrite: bool = False) -> None:
        """Write `dataset` to a zarr folder, as `asperity.results.save` does.

        `asperity.results.load` reads the Dataset, `asperity.results.load_contact` the contact, to be aged on.
        """
        raise NotImplementedError

    def system(self, control: Control | None = None) -> System:
        """Set up the system that this contact is a state of, under its own control or another."""
        return System.of(self.heights, self.lattice, self.solid, control or self.control)

    @property
    def has_not_crept(self) -> bool:
        """Whether the anchors are flat, to their last digits."""
        anchors = self.relative[1]
        return all(float(np.ptp(v)) <= 4 * float(np.spacing(np.abs(v).max())) for v in anchors)

    def moved(self, sites: Sequence[int]) -> Contact:
        """Return the contact as a whole, crept shape and all, moved by sites along each axis of its lattice.

        Nothing in the equations tells sites apart, so the residual is that of the same numbers.
        """
        axes = tuple(range(-self.lattice.dimension, 0))
        names = ("heights", "permanent_indentation", "_surface", "force", "in_contact")
        moved: dict[str, Any] = {name: np.roll(getattr(self, name), sites, axis=axes) for name in names}
        moved["_anchors"] = AnchorFields(np.roll(self.relative[1], sites, axis=axes))
        return Contact._judged(**(self.__getstate__() | moved))

    def resting_on(self, heights: Field, indentation: Field) -> Contact:
        """Return a contact of the same bodies from which a march resumes; only its heights are of use."""
        return Contact._judged(
            **(self.__getstate__() | {"heights": heights, "permanent_indentation": indentation})
        )


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
    sticks = contact.solid.adhesion is not None
    if hold == "area" and sticks:
        expected = "'load' or 'separation': with adhesion the load does not fix the area"
        raise InputError("hold", expected=expected, got="'area'")
    if contact.load <= 0 and not (sticks and contact.area):
        raise InputError(
            "hold",
            expected="a load above 0 to hold",
            got="a contact without load",
            advice="a ramp first: age(contact, times, protocol=[Ramp(1.0, load=400.0)])",
        )
    return kept or Load(contact.load)
