"""What `asperity.predict` is asked: how the contact of a scan with a material ages."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from inspect import signature
from pathlib import Path
from typing import Annotated, Any, ClassVar, cast

from annotated_types import Gt

from asperity.ask.carried import Carried
from asperity.ask.question import Question
from asperity.ask.run import Aging, Friction, Output
from asperity.base import checks
from asperity.base.parameters import Quantity, parameters_of
from asperity.errors import InputError
from asperity.progress import Checkpoint, Progress
from asperity.protocols import Hold, Leg, MeasuredHistory, Ramp
from asperity.protocols.histories import start_of
from asperity.protocols.legs import legs_of
from asperity.relaxation import Material, Measured, PronySeries, material
from asperity.solids import Solid
from asperity.surfaces import Surface

_INSTRUMENT = ("pixel", "blur", "threshold")
_ELSEWHERE = {
    **{name: f"carried=asperity.Carried({name}=...)" for name in parameters_of(Carried)},
    **{name: f"instrument={{'{name}': ...}}" for name in _INSTRUMENT},
    **{name: f"asperity.relaxation.material(..., {name}=...)" for name in signature(material).parameters},
    "branches_per_decade": "asperity.relaxation.material(..., per_decade=...)",
    "creep": "asperity.solids.half_space(..., creep=...)",
    "separation": "asperity.press(..., separation=...), and asperity.age",
    "legs": "protocol=[...]",
}


@dataclass(frozen=True, eq=False)
class Predict(Question):
    """Predict how the contact of a rough rigid surface with a half-space ages, with 95 % bands.

    Numbers are in SI units, or texts with a unit: ``"1 MPa"``.

    Parameters
    ----------
    material
        From `asperity.relaxation.material`; or one of its arguments, such as a file with a relaxation table,
        or a half-space.
    surface
        The scan: a file for `asperity.surfaces.read`, with reflecting edges, or a `Surface` with units. A
        mirrored surface is replaced by its scan with reflecting edges.
    load, pressure
        Normal load, N, or load over nominal area, Pa: one of them. Constant, unless a protocol changes it.
    ramp
        Duration of a linear loading, s; by default the load is applied instantly. Times count from the start
        of the loading.
    protocol
        A history of the load, without ramp and last: a list of legs of `asperity.protocols`, such as
        ``[Ramp("2.4 s", pressure="1 MPa"), Hold("1000 s"), Step(pressure="250 kPa"), Hold("4000 s")]``. One
        that begins with a ramp, or is `asperity.protocols.measured`, needs no load; a ramp and a hold alone
        are the same as `ramp` and `last`. Slides, and legs that hold or move the body, have no band.
    first, last
        First and last time, s; by default those of the table, after the ramp. Without a table both are
        needed. With a protocol, ``first`` counts from each change of the load.
    per_decade
        Times recorded in each decade; five or more in all.
    times
        In place of these three all times, s: five or more after 0, rising.
    shear_strength
        Shear strength of the contacts, Pa; adds friction (Tabor).
    carried
        Carried quantities to record: stiffness, resistances, sticking share; see `asperity.age`.
    instrument
        Arguments ``pixel``, ``blur`` and ``threshold`` (default 0.5) of `asperity.observe`; adds observations
        of the contact.
    resolution_study
        Whether to repeat the prediction without waves below 4, 8, 16 and 32 pixels: see `Prediction.bands`.
    rtol
        Tolerance of time steps; see `asperity.age`.
    progress
        True for a bar, in notebooks and on terminals; or a `Progress`.
    checkpoint
        File in which aging keeps its place; see `asperity.age`.

    Raises
    ------
    AsperityError
        An argument is wrong, arguments contradict each other, or a solver did not converge.

    Notes
    -----
    A generalized Maxwell half-space is separable: while the load does not fall, the contact is exact at each
    time, see `asperity.age`. Otherwise time steps follow it. The dataset has 95 % bands, such as
    ``contact_area_low`` and ``contact_area_high``: see `Prediction.band`.

    References
    ----------
    H. Farain, D. Bonn, Nat. Commun. 14, 3606 (2023): frictional aging from bulk relaxation.
    """

    sections = ("contact", "aging", "friction")
    elsewhere = _ELSEWHERE
    unused: ClassVar[Mapping[str, Collection[str]]] = {
        "friction": [key for key in Friction.keys if key != "shear_strength"],
        "output": ("maps_at",),
    }
    refused: ClassVar[Mapping[tuple[str, str], str]] = {
        ("contact", "separation"): "a load, which a band covers",
        ("aging", "hold"): "a load, which a band covers",
    }

    material: Material | Solid | Measured | PronySeries | str | Path
    surface: str | Path | Surface
    _: KW_ONLY
    load: float | str | None = None
    pressure: float | str | None = None
    ramp: Annotated[
        float | str | None,
        Gt(0),
        Quantity(
            "time over which the load rises linearly, such as 2.4s; all times count from its start. "
            "By default instantly.",
            "s",
        ),
    ] = None
    protocol: Sequence[Leg] | Leg | None = None
    first: float | str | None = None
    last: float | str | None = None
    per_decade: int = 4
    times: Sequence[float | str] | checks.Floats | None = None
    shear_strength: float | str | None = None
    carried: Carried | None = None
    instrument: Mapping[str, float | str] | None = None
    resolution_study: Annotated[
        bool,
        Quantity(
            "predict also without the shortest waves of the scan, to see what a finer scan would change.",
            swept=False,
        ),
    ] = False
    rtol: float = Aging.keys["rtol"].default  # type: ignore[assignment]
    progress: Progress | bool | None = None
    checkpoint: str | Path | Checkpoint | None = None

    def __post_init__(self) -> None:
        legs = () if self.protocol is None else tuple(legs_of(self.protocol))
        legs = self.protocol if isinstance(self.protocol, MeasuredHistory) else legs
        if self.load is None and self.pressure is None:
            for name in ("load", "pressure"):
                object.__setattr__(self, name, start_of(legs).get(name) or None)
        object.__setattr__(self, "protocol", legs)
        self._check_legs()
        self._load_by_legs()
        super().__post_init__()
        if (strength := getattr(self.carried, "strength", None)) is not None:
            expected = "none, as a band needs no history of contacts"
            advice = "shear_strength=..., or asperity.age"
            raise InputError("strength", expected=expected, got=strength, advice=advice)
        seen = checks.instance("instrument", self.instrument or {}, dict, "{'pixel': '0.2 um'}")
        if others := seen.keys() - {*_INSTRUMENT}:
            got = repr(min(others, key=str))
            raise InputError("instrument", expected="pixel, blur and threshold", got=got)
        seen = {name: Output.keys[name].read(name, value) for name, value in seen.items()}
        object.__setattr__(self, "instrument", seen and {"blur": 0.0, "threshold": 0.5, **seen})
        if self.times is not None:
            checks.times("times", self.times)
        self._check_load()

    @property
    def legs(self) -> Sequence[Leg]:
        """The legs of the history of the load, one by one; none for a constant load."""
        return cast(Sequence[Leg], self.protocol)

    @property
    def held(self) -> dict[str, Any]:
        """The load or the pressure, as an argument of `asperity.press`."""
        given = {name: getattr(self, name) for name in ("load", "pressure")}
        return {name: value for name, value in given.items() if value is not None} or {"load": 0.0}

    def _load_by_legs(self) -> None:
        """Take a ramp to a load and a hold there for what they are: a loading, whose contact grows."""
        if loading := loading_of(self.legs, self.load, self.pressure):
            up, held = loading
            asked = {"load": up.load, "pressure": up.pressure, "ramp": up.duration, "protocol": ()}
            for name, value in (asked | {"last": up.duration + held.duration}).items():
                object.__setattr__(self, name, value)

    def _check_load(self) -> None:
        """Refuse no load and two, but before a ramp, and one that does not press."""
        given: dict[str, Any] = {"load": self.load, "pressure": self.pressure}
        if not begins_to_rise(self.legs) or (self.load, self.pressure) != (None, None):
            name = checks.one_of('pressure="1 MPa"', **given)
            unit = "N" if name == "load" else "Pa"
            checks.number(name, given[name], above=0, expected=f"more than 0 {unit}")

    def _check_legs(self) -> None:
        """Refuse legs without a band, and arguments that contradict legs."""
        for leg in self.legs:
            if leg.speed or leg.moves_the_body or leg.hold not in (None, "load"):
                words = leg.words(lambda _, value: f"{value:g}")
                advice = "asperity run, or asperity.age, which follow it without a band"
                raise InputError("protocol", expected="legs that change the load", got=words, advice=advice)
        for name in ("ramp", "last") if self.legs else ():
            if (value := getattr(self, name)) is not None:
                expected = "none beside a protocol, which has its own times and loads"
                raise InputError(name, expected=expected, got=checks.shown(value))


def begins_to_rise(legs: Sequence[Leg]) -> bool:
    """Whether a history begins with a ramp, before which a contact bears nothing."""
    return bool(legs and legs[0].target and legs[0].duration)


def loading_of(legs: Sequence[Leg], *loads: object) -> tuple[Ramp, Hold] | None:
    """The ramp and the hold of a history that is a loading and no more, unless it begins under a load."""
    match legs:
        case (Ramp(separation=None, approach=None) as up, Hold(hold=None | "load") as held):
            is_one = {*loads} <= {None, 0} and up.mobility == held.mobility == 1
            return (up, held) if is_one else None
    return None
