"""Carried quantities that a history records: which, and for which materials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar, Literal

from annotated_types import Gt, Len

from asperity.ask.strength import ShearStrength
from asperity.base import checks
from asperity.base.parameters import Needs, Quantity, check_needs

Each = float | str | Sequence[float | str]
"""A number or a text with a unit, of the half-space and perhaps of the rough body."""


@dataclass(frozen=True)
class Carried:
    """Carried quantities to record; for `asperity.age`. But for the strength, they are those of a half-space.

    Parameters
    ----------
    strength
        Record ``friction``, ``friction_force``, ``friction_by_area`` (without growth with age) and
        ``strength_mean``, and of a strength that ages also ``contact_age_mean`` and maps ``site_age``. Ages
        are 0 where the history begins.
    stiffness
        Whether to record the normal stiffness beside a strength; it is always recorded beside the others, and
        alone.
    resistivity
        Record ``resistance``; see `Contact.resistance`.
    conductivity
        Record ``thermal_resistance``; see `Contact.thermal_resistance`.
    poisson
        Record ``tangential_stiffness``; see `Contact.tangential_stiffness`. Without a direction, also that
        of the softest and the stiffest direction, ``tangential_stiffness_soft`` and ``_stiff``.
    shear, friction_coefficient
        Record ``stick_fraction``, the share of the contact that sticks under this shear force, applied at
        that time, with this coefficient of friction. It is 0 where the bodies slide: at loads up to
        shear / friction_coefficient. See `Contact.partial_slip`.
    direction
        Of the shear force, ``"x"`` (along the rows) or ``"y"``, and of the tangential stiffness. By default
        the force is along x.
    work_of_adhesion
        Record ``pull_off``, the force that pulls the contact apart at that time, with this work of adhesion;
        0 without contact, NaN in full contact. See `Contact.pull_off`.

    Raises
    ------
    InputError
        Only one of shear and its coefficient is given, or the strength is none.
    """

    needs: ClassVar[Needs] = (("shear", ("friction_coefficient",)), ("friction_coefficient", ("shear",)))

    strength: ShearStrength | None = None
    stiffness: Annotated[
        bool,
        Quantity("record the normal stiffness, and the tangential one if the solid has one Poisson's ratio."),
    ] = False
    resistivity: Annotated[
        Each | None,
        *(Gt(0), Len(1, 2)),
        Quantity("electrical resistivity, one value or one for each body: record the resistance.", "ohm m"),
    ] = None
    conductivity: Annotated[
        Each | None,
        *(Gt(0), Len(1, 2)),
        Quantity("thermal conductivity, likewise: record the thermal resistance.", "W/m/K"),
    ] = None
    poisson: float | None = None
    shear: Annotated[
        float | str | None,
        Gt(0),
        Quantity("shear force: record the fraction of the contact that sticks.", "N"),
    ] = None
    friction_coefficient: Annotated[
        float | None, Gt(0), Quantity("local coefficient of friction under the shear force")
    ] = None
    direction: Annotated[
        Literal["x", "y"] | None,
        Quantity(
            "direction of the shear force and of the tangential stiffness: x along the rows, y from row to "
            "row. By default x for the force, and without one the stiffness in the softest and the stiffest "
            "direction and a mean.",
            key="shear_direction",
        ),
    ] = None
    work_of_adhesion: Annotated[
        float | str | None,
        Gt(0),
        Quantity("work of adhesion: record the pull-off force, without further creep.", "J/m^2"),
    ] = None

    def __post_init__(self) -> None:
        if self.strength is not None:
            checks.instance(
                "strength", self.strength, ShearStrength, "asperity.friction.ShearStrength('50 MPa')"
            )
        check_needs(self, self.needs)

    @property
    def responds(self) -> bool:
        """Whether anything is asked of the response of a half-space."""
        return self.strength is None or any(vars(replace(self, strength=None)).values())

    @property
    def along(self) -> Literal["x", "y"] | None:
        """The direction of the shear force, or that stated; else None."""
        return self.direction or ("x" if self.shear is not None else None)
