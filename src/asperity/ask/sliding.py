"""What `asperity.steady_sliding` is asked: a solid under a rough profile that slides, over speeds."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from annotated_types import Ge, Gt, Le
from numpy.typing import ArrayLike

from asperity.ask.question import Question, in_decades
from asperity.ask.run import Aging
from asperity.ask.run import Carried as CarriedSection
from asperity.ask.strength import ShearStrength
from asperity.base import checks
from asperity.base.parameters import Quantity
from asperity.errors import InputError
from asperity.lattice import Field
from asperity.progress import Progress
from asperity.protocols.legs import checked_direction
from asperity.relaxation import Material, Measured, PronySeries
from asperity.solids import Solid

_Speed = Annotated[float | str, Gt(0)]


@dataclass(frozen=True, eq=False)
class SteadySliding(Question):
    """Find friction and contact area of a rough profile that slides steadily over a viscoelastic solid.

    In the frame of the profile nothing depends on time, so each speed is one contact problem, with the
    complex modulus at the frequency of each wave. No time is marched. Heat is left out.

    Parameters
    ----------
    solid
        A solid of `asperity.solids` whose creep is linear: a half-space, a layer, a film or a lattice of
        springs; or a material from `asperity.relaxation.material`, or one of its arguments, such as a file
        with a relaxation table. At rest it bears a load for ever.
    surface
        The rough profile: a file for `asperity.surfaces.read`, or heights, such as a `Surface`. Under
        reflecting edges it is slid with its mirror images, so friction is the mean of both directions.
    speeds
        Speeds > 0, m/s or with units, rising: one, or the two ends of a range with `per_decade` speeds in
        each decade, or three or more. On a solid that is defined on sites: sites per time.
    load, pressure
        Normal load, N, or load over nominal area, Pa: one of them.
    per_decade
        Speeds in each decade of a range.
    direction
        Where the profile goes: ``"x"`` along the last axis, ``"-x"``, ``"y"``, ``"-y"``; or the sites along
        each axis, such as ``(1, 1)``.
    shear_strength
        Shear strength of the contacts, Pa, or a `asperity.friction.ShearStrength`; adds its friction to that
        of the hysteresis.
    beyond_table
        Whether to slide at speeds at which some waves oscillate faster or slower than the data of the
        material, where its fitted branches continue.
    fields_at
        Speeds, among the speeds, at which the pressure of each site is kept.
    progress
        True for a bar, or a `Progress`.

    Returns
    -------
    xarray.Dataset
        Over ``speed``: ``hysteresis_friction_coefficient``, the dissipation over speed and load;
        ``contact_area``, ``contact_fraction``, ``mean_gap``, ``largest_pressure`` and ``residual``;
        ``last_octave``, the share of the friction that is lost without waves shorter than four pixels; and
        with a shear strength ``friction_coefficient``. Friction and areas have 95 % bands, ``_low`` and
        ``_high``, as those of `asperity.predict`.

    Raises
    ------
    InputError
        A number is out of range; the solid sticks, yields, creeps by a local law or flows without end; the
        edges are free; or the table lacks the frequencies.
    ConvergenceError
        A contact problem was not solved.

    References
    ----------
    B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001), DOI 10.1063/1.1388626: rubber friction.
    G. Carbone, C. Putignano, J. Mech. Phys. Solids 61, 1822 (2013), DOI 10.1016/j.jmps.2013.03.005.
    """

    sections, pressed = ("contact",), True
    unused: ClassVar[Mapping[str, Collection[str]]] = {
        "aging": Aging.keys,
        "carried": CarriedSection.keys,
        "output": ("maps_at", "measured", "pixel", "blur", "threshold"),
    }
    refused: ClassVar[Mapping[tuple[str, str], str]] = {
        ("protocol", ""): "none for steady sliding, which is at a speed for ever",
        ("contact", "separation"): "a load or a pressure, under which the profile slides",
    }

    solid: Material | Solid | Measured | PronySeries | str | Path
    surface: str | Path | ArrayLike
    _: KW_ONLY
    speeds: Annotated[
        Sequence[_Speed] | checks.Floats | float | str,
        Quantity(
            "sliding speeds: the two ends of a range, such as 1um/s 10m/s, or one speed, or three or more.",
            "m/s",
            swept=False,
        ),
    ]
    load: float | str | None = None
    pressure: float | str | None = None
    per_decade: Annotated[
        int, *(Ge(1), Le(1000)), Quantity("speeds in each decade of a range", swept=False)
    ] = 4
    direction: Annotated[
        Literal["x", "-x", "y", "-y"] | str | tuple[int, ...],
        Quantity("where the rough surface goes: x along the rows"),
    ] = "x"
    shear_strength: ShearStrength | float | str | None = None
    beyond_table: Annotated[
        bool,
        Quantity(
            "slide also at speeds whose frequencies the table lacks; the fitted branches continue.",
            swept=False,
        ),
    ] = False
    fields_at: Annotated[
        Sequence[_Speed] | None, Quantity("speeds at which the map of pressure is kept", "m/s", swept=False)
    ] = None
    progress: Progress | Callable[[Any], None] | bool | None = None

    def __post_init__(self) -> None:
        given, law = self.speeds, self.shear_strength
        object.__setattr__(self, "direction", checked_direction(self.direction))
        if law is not None and not isinstance(law, ShearStrength):
            object.__setattr__(self, "shear_strength", ShearStrength(law))  # type: ignore[arg-type]
        super().__post_init__()
        checks.one_of('pressure="1 MPa"', load=self.load, pressure=self.pressure)
        if not self.each_speed.size or not (np.diff(self.each_speed, prepend=0) > 0).all():
            expected, got = "speeds above 0 that rise", checks.shown(given)
            raise InputError("speeds", expected=expected, got=got, advice="the lowest first")
        for speed in self.fields_at or ():
            if not np.isclose(self.each_speed, float(speed), rtol=1e-6, atol=0).any():
                expected = "some of the speeds"
                raise InputError("fields_at", expected=expected, got=checks.shown(speed))

    @property
    def each_speed(self) -> Field:
        """The speeds, of a range those within it, too."""
        return in_decades(self.speeds, self.per_decade)
