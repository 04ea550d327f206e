"""What `asperity.law` is asked: the law of a scan on a solid, over pressures, at ages."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np
from annotated_types import Ge, Le

from asperity.ask.carried import Carried
from asperity.ask.question import Question, in_decades
from asperity.ask.run import Aging, Contact, Friction
from asperity.base import checks
from asperity.base.parameters import Quantity
from asperity.errors import InputError
from asperity.lattice import Field
from asperity.progress import Checkpoint, Progress
from asperity.solids import Solid
from asperity.surfaces import Surface


@dataclass(frozen=True, eq=False)
class Law(Question):
    """Tabulate approach, stiffness, conductance and gap of a rough contact over pressure, at each age.

    Each pressure is applied instantly and held. The approach is that of the rough layer alone. `law_for`
    writes the table for other programs.

    Parameters
    ----------
    solid
        A half-space or a layer. For a relaxation table: ``asperity.relaxation.material(table).solid``.
    surface
        The scan: a file for `asperity.surfaces.read`, or a `Surface` with units.
    pressures
        Load over nominal area, Pa or with units, rising. Two are the ends of a range, ``["0.1 MPa",
        "100 MPa"]``, with `per_decade` pressures in each decade; three or more are taken as they are.
    times
        Ages, s or with units, strictly increasing, >= 0. By default 0, for a solid that does not creep.
    carried
        For half-spaces: ``poisson`` adds the tangential stiffness, ``resistivity`` and ``conductivity`` add
        conductances.
    rtol
        Tolerance of time steps; see `asperity.age`.
    progress
        True for a bar, or a `Progress`.
    checkpoint
        File that keeps finished pressures, so that a killed run goes on. Remove it when the results are safe.

    Returns
    -------
    xarray.Dataset
        Over ``direction``, ``time`` (s) and ``pressure`` (Pa): approach, stiffness and others, with bands.
        If the solid creeps or yields, ``direction`` has "unloading", too: instantly, at each age, from the
        largest pressure.

    Raises
    ------
    InputError
        A number is out of range, all of the surface touches, or the solid is defined on sites.
    ConvergenceError
        A contact problem was not solved.
    """

    sections, placed = ("aging",), {"times": "aging"}
    unused: ClassVar[Mapping[str, Collection[str]]] = {
        "solid": ("draws",),
        "contact": Contact.keys,
        "aging": ("first", "last", "per_decade", "hold"),
        "friction": Friction.keys,
        "output": ("maps_at", "pixel", "blur", "threshold"),
    }
    refused: ClassVar[Mapping[tuple[str, str], str]] = {
        ("protocol", ""): "none for a law, whose pressures are held",
        ("output", "measured"): "none for a law, whose pressures are held",
    }

    solid: Solid
    surface: str | Path | Surface
    _: KW_ONLY
    pressures: Annotated[
        Sequence[float | str] | checks.Floats,
        Quantity(
            "load over nominal area: the two ends of a range, such as 0.1MPa 100MPa, or three values "
            "or more.",
            "Pa",
            swept=False,
        ),
    ]
    times: Annotated[
        Sequence[float | str] | checks.Floats | float | str | None,
        Quantity('ages, such as 0s 1h "1 year". By default 0s, if nothing creeps.', "s", swept=False),
    ] = None
    per_decade: Annotated[
        int, *(Ge(1), Le(1000)), Quantity("pressures in each decade of a range", swept=False)
    ] = 10
    carried: Carried | None = None
    rtol: float = Aging.keys["rtol"].default  # type: ignore[assignment]
    progress: Progress | Callable[[Any], None] | bool | None = None
    checkpoint: str | Path | Checkpoint | None = None

    def __post_init__(self) -> None:
        body = checks.instance("solid", self.solid, Solid, "asperity.solids.half_space(modulus='3 GPa')")
        if not body.in_lengths:
            expected, got = "a solid whose approach is a length", f"a {body.kind}, defined on sites"
            raise InputError("solid", expected=expected, got=got, advice="half_space(modulus='3 GPa')")
        if body.adhesion is not None:
            expected, advice = "a solid without adhesion", "asperity.pull"
            raise InputError("solid", expected=expected, got="one with adhesion", advice=advice)
        for name in ("shear", "work_of_adhesion", "strength"):
            if (put := getattr(self.carried, name, None)) is not None:
                raise InputError(name, expected="none: a law has neither shear nor pull", got=put)
        given = self.pressures
        super().__post_init__()
        if self.times is None and body.branches:
            expected, advice = "the ages of a solid that creeps", "0 s, and when the law is needed"
            raise InputError("times", expected=expected, got="none", advice=advice)
        if self.steps.size < 2 or not (np.diff(self.steps, prepend=0) > 0).all():
            expected, got = "two pressures or more above 0 that rise", checks.shown(given)
            raise InputError("pressures", expected=expected, got=got, advice="the lowest first")

    @property
    def steps(self) -> Field:
        """The pressures, Pa, of a range those within it, too."""
        return in_decades(self.pressures, self.per_decade)

    @property
    def ages(self) -> Field:
        """The ages, s."""
        return checks.times("times", 0.0 if self.times is None else self.times)
