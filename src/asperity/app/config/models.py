"""What a run needs to know: the sections of its configuration, and what each key may be.

Every key has a default, except the path of a measured surface, and the contact's load, which follows
from the surface and the solid. The flags of the command line are made of these models.
"""

from __future__ import annotations

import dataclasses
import hashlib
import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self, Union, get_args

from pydantic import AfterValidator, BeforeValidator, Field, PrivateAttr, create_model, model_validator

from asperity.app.config.sections import (
    Conductivity,
    Duration,
    FirstForce,
    Force,
    OneOrTwo,
    Place,
    Position,
    Positive,
    Pressure,
    Real,
    Resistivity,
    Section,
    Several,
    Share,
    Size,
    Time,
    Velocity,
    any_of,
    by_kind,
    field_of,
    usual,
)
from asperity.app.config.solids import SOLIDS, AnySolid, SpringLattice
from asperity.base.files import content_of, expanded
from asperity.base.parameters import parameters_of
from asperity.errors import InputError
from asperity.protocols import KINDS as LEGS_OF_PROTOCOLS
from asperity.protocols import Leg, leg_of

if TYPE_CHECKING:  # these need scipy, for which the help does not wait
    from asperity.lattice import Field as Heights
    from asperity.surfaces import Surface
    from asperity.theory.heights import HeightLaw

Figure = Literal["png", "pdf", "svg"]

_LONGEST = 2**31
"""Sites along an axis: far beyond any memory, far below what numpy cannot count."""


def _alone(values: Sequence[Any]) -> Any:
    """The one value, or all."""
    return values[0] if len(values) == 1 else values


def _name_or_number(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, int | str):
        raise ValueError("expected the name or the number of a channel")
    return value


def _power_of_two(value: int) -> int:
    if value < 2 or value & (value - 1):
        below = 1 << (max(value, 2).bit_length() - 1)
        raise ValueError(f"expected a power of two, 2 or more, got {value}; try {below} or {2 * below}")
    return value


def _micro(value: object) -> object:
    """Take the micro sign and the Greek letter for the u of um."""
    return "um" if value in ("\u00b5m", "\u03bcm") else value


Length = Literal["m", "mm", "um", "nm", "pm"]
AnyLength = Annotated[Length, BeforeValidator(_micro)]
Seed = Annotated[int, Field(ge=0, lt=2**63)]
Shape = OneOrTwo[Annotated[int, Field(ge=1, le=_LONGEST)]]

_SHAPE = "Sites along each axis: 200 200, or 4096 for a line."
_SEED = "Seed of the random heights."


class SurfaceSection(Section):
    """A surface, of one kind or another."""

    only_powers_of_two: ClassVar[bool] = False

    kind: str
    edges: Literal["periodic", "reflecting", "free"] | None = usual(
        None,
        "What lies beyond the edges: the surface again, its mirror image, or nothing, for the "
        "body ends there. By default what the kind of surface, or how a scan is made periodic, says.",
    )

    @property
    def lattice(self) -> tuple[int, ...] | None:
        """Sites along each axis; None where only making the surface tells."""
        shape = getattr(self, "shape", None)
        return None if shape is None else tuple(shape)

    @property
    def law(self) -> HeightLaw | None:
        """The law of the heights, where the sites are independent."""
        return None

    @property
    def file(self) -> Path | None:
        """The file on which it depends, if any."""
        path = getattr(self, "path", None)
        return None if path is None else expanded(path)

    def anywhere(self) -> Self:
        """The same, with an absolute path of its file."""
        return self if self.file is None else self.model_copy(update={"path": str(self.file.resolve())})

    @property
    def arguments(self) -> tuple[Any, dict[str, Any]]:
        """What the function of `asperity.surfaces` that makes it takes: the lattice, and what has a name."""
        facts = self.model_dump(exclude_none=True, exclude={"kind", "edges"})
        return tuple(facts.pop("shape")) if "shape" in facts else facts.pop("size"), facts

    def build(self) -> Surface:
        """Make or read the surface, and let it know where it comes from."""
        made = self.made()
        return made if self.edges is None else dataclasses.replace(made, edges=self.edges)

    def made(self) -> Surface:
        """The same, with the edges that surfaces of this kind have."""
        from asperity.surfaces import Surface

        found = self.heights_or_surface()
        if isinstance(found, Surface):
            return found
        return Surface(found, provenance=self.model_dump(exclude={"edges"}))

    def heights_or_surface(self) -> Any:
        """What the function of `asperity.surfaces` gives that is called like the kind."""
        import asperity.surfaces as surfaces

        lattice, facts = self.arguments
        return getattr(surfaces, self.kind)(lattice, **facts)


class Independent(SurfaceSection):
    """Heights that are independent at all sites: Gaussian or exponential ones."""

    kind: Literal["gaussian", "exponential"] = "gaussian"
    shape: Shape = usual([200, 200], _SHAPE)
    rms: Positive = usual(1.0, "Rms height.")
    seed: Seed = usual(0, _SEED)

    @property
    def law(self) -> HeightLaw:
        """The law of the heights."""
        from asperity.theory import ExponentialHeights, GaussianHeights

        return (GaussianHeights if self.kind == "gaussian" else ExponentialHeights)(rms=self.rms)


class SelfAffine(SurfaceSection):
    """Self-affine heights."""

    only_powers_of_two: ClassVar[bool] = True

    kind: Literal["self_affine"] = "self_affine"
    size: Annotated[int, Field(le=_LONGEST), AfterValidator(_power_of_two)] = usual(
        256, "Sites along each axis, a power of two."
    )
    hurst: Annotated[float, Field(gt=0, le=1)] = usual(0.5, "Hurst exponent.")
    delta: Positive = usual(0.01, "Roughness at the scale of the lattice.")
    seed: Seed = usual(0, _SEED)

    @property
    def lattice(self) -> tuple[int, ...]:
        """Sites along each axis."""
        return (self.size, self.size)


class Waves(SurfaceSection):
    """Random waves on a lattice with units."""

    shape: Shape = usual([200, 200], _SHAPE)
    spacing: OneOrTwo[Positive] = usual([1.0], "Distance between sites: one number, or one an axis.")
    unit: AnyLength | None = usual(None, "Unit of the spacing and of all heights and wavelengths.")
    seed: Seed = usual(0, _SEED)

    @property
    def pixel_size(self) -> tuple[float, ...]:
        """Distance between sites along each axis."""
        return (*self.spacing, *self.spacing)[: len(self.shape)]

    def made(self) -> Surface:
        """See `SurfaceSection`."""
        from asperity.surfaces import Surface

        origin = self.model_dump(exclude_none=True, exclude={"edges"})
        origin |= {"pixel_size": list(self.pixel_size), "length_unit": self.unit or ""}
        heights = self.heights_or_surface()
        if self.file is not None:
            origin["sha256"] = hashlib.sha256(content_of(self.file)).hexdigest()
        return Surface(heights, self.unit or "1", self.pixel_size, self.unit, origin)


class Spectral(Waves):
    """Self-affine heights of a given power spectrum; see `asperity.surfaces.spectral`."""

    kind: Literal["spectral"] = "spectral"
    hurst: Annotated[float, Field(ge=0, le=1)] = usual(0.8, "Hurst exponent.")
    roll_off: Positive | None = usual(
        None, "Wavelength above which the spectrum is flat. By default the longest side."
    )
    cutoff: Positive | None = usual(None, "Shortest wavelength. By default eight times the larger spacing.")
    rms_height: Positive | None = usual(None, "Rms height. By default 1, unless slope or curvature is given.")
    rms_slope: Positive | None = usual(None, "Rms slope, in place of the height.")
    rms_curvature: Positive | None = usual(None, "Rms mean curvature, in place of the height.")

    @property
    def arguments(self) -> tuple[Any, dict[str, Any]]:
        """What `asperity.surfaces.spectral` takes."""
        lattice, facts = super().arguments
        facts.pop("unit", None)
        return lattice, facts | {"spacing": _alone(self.spacing)}


class Spectrum(Waves):
    """Heights of a power spectrum in a table; see `asperity.surfaces.from_spectrum`."""

    kind: Literal["spectrum"] = "spectrum"
    path: str = Field(
        description="Table of the wave number q and the power spectrum C; columns with units need `unit`."
    )

    @property
    def arguments(self) -> tuple[Any, dict[str, Any]]:
        """What `asperity.surfaces.from_spectrum` takes beside the spectrum."""
        return tuple(self.shape), {"pixel_size": self.pixel_size, "seed": self.seed}

    def heights_or_surface(self) -> Heights:
        """See `SurfaceSection`."""
        from asperity.surfaces import from_spectrum, read_spectrum

        lattice, facts = self.arguments
        table = read_spectrum(self.path, unit=self.unit, dimension=len(lattice))
        heights: Heights = from_spectrum(lattice, table, **facts)
        return heights


class Asperities(SurfaceSection):
    """Single asperities, in SI, with free edges; see `asperity.surfaces.sphere`."""

    shape: Shape = usual([200, 200], _SHAPE)
    pixel_size: OneOrTwo[Size] = Field(
        description="Distance between sites: one number, or between rows and between columns."
    )

    @property
    def arguments(self) -> tuple[Any, dict[str, Any]]:
        """What the function that makes it takes."""
        lattice, facts = super().arguments
        edges = {"edges": self.edges} if self.edges else {}
        return lattice, facts | {"pixel_size": _alone(self.pixel_size)} | edges


class Asperity(Asperities):
    """One ball, paraboloid or flat punch in the middle."""

    kind: Literal["sphere", "paraboloid", "punch"] = "sphere"
    radius: OneOrTwo[Size] = Field(
        description="Radius; of curvature of a paraboloid (one, or one an axis), of the face of a punch."
    )


class Array(Asperities):
    """Balls at given places; see `asperity.surfaces.array`."""

    kind: Literal["array"] = "array"
    places: Annotated[list[Place], Field(min_length=1)] = Field(
        description="Where balls are: pairs y x, counted from the first site, in m."
    )
    radii: Several[Size] = Field(description="Radii of the balls: one, or one a ball.")
    heights: Several[Position] = usual([0.0], "Heights of their summits: one, or one a ball.")


class MeasuredSurface(SurfaceSection):
    """Heights from a file; see `asperity.surfaces.read`."""

    kind: Literal["file"] = "file"
    path: str = Field(
        description="Measured surface; the other settings of this group prepare it. For spectrum its table."
    )
    undefined: Literal["fill", "refuse"] = usual(
        "fill", "Undefined pixels: fill (from their rims) or refuse."
    )
    max_undefined: Annotated[float, Field(ge=0, lt=1)] = usual(
        0.1, "Largest fraction of undefined pixels to fill."
    )
    undefined_value: Real | None = usual(
        None, "Height that stands for an undefined pixel in the file, such as -9999."
    )
    tilt: Literal["plane", "quadratic", "mean", "none"] = usual(
        "plane", "What to remove; quadratic also removes the bow of a scanner."
    )
    despike: bool = usual(
        False, "Fill pixels more than 6 robust standard deviations above the median height."
    )
    lines: Literal["none", "median"] = usual(
        "none", "median: subtract its median from each row, against offsets of the scan's lines."
    )
    periodic: Literal["mirror", "reflect", "taper", "wrap"] = usual(
        "reflect",
        "reflect: reflecting edges. wrap: the scan is periodic. taper: its border is brought to the mean. "
        "mirror: four mirrored copies, for what must be periodic.",
    )
    unit: Annotated[Literal[Length, "rms"] | None, BeforeValidator(_micro)] = usual(
        None,
        "Unit of the heights; rms divides by the rms height. By default the file's. "
        "For spectral and spectrum the unit of all lengths; by default none.",
    )
    channel: Annotated[int | str | None, BeforeValidator(_name_or_number)] = usual(
        None, "Name or number of the channel or array. By default the file's."
    )
    resample: bool = usual(False, "Average pixels that are not square to the larger spacing.")
    crop: Annotated[list[Real], Field(min_length=2, max_length=4)] | None = usual(
        None, "Part to cut out: top bottom left right, or left right of a profile, in pixels."
    )
    crop_unit: Annotated[Literal["pixel", Length] | None, BeforeValidator(_micro)] = usual(
        None, "Unit of length in which the part is given, in place of pixels."
    )
    longest: Positive | None = usual(
        None, "Longest wavelength to keep, in the file's unit of length, or in pixels without one."
    )
    shortest: Positive | None = usual(None, "Shortest wavelength to keep, likewise.")
    file_unit: AnyLength | None = usual(None, "Unit of the heights in a file that does not say.")
    pixel_size: OneOrTwo[Positive] | None = usual(
        None,
        "Distance between pixels in a file that does not say: one number, or between rows "
        "and between columns. Of a ball, a paraboloid, a punch and an array it is that between sites, in m.",
    )
    length_unit: AnyLength | None = usual(None, "Unit of that distance.")

    @property
    def rule(self) -> Literal["mirror", "reflect", "taper", "wrap", "free"]:
        """What `asperity.surfaces.read` is to do about the edges."""
        if self.edges == "periodic":
            return "wrap" if self.periodic == "reflect" else self.periodic
        return "free" if self.edges == "free" else "reflect" if self.edges else self.periodic

    @property
    def arguments(self) -> tuple[Any, dict[str, Any]]:
        """What `asperity.surfaces.read` takes: the file, and how to prepare it."""
        facts = self.model_dump(exclude={"kind", "edges", "path"})
        return self.path, facts | {"periodic": self.rule, "pixel_size": _alone(self.pixel_size or [None])}

    def heights_or_surface(self) -> Surface:
        """See `SurfaceSection`."""
        from asperity.surfaces import read

        path, facts = self.arguments
        return read(path, **facts)


Made = Independent | SelfAffine | Spectral | Spectrum | Asperity | Array
AnySurface = Annotated[Made | MeasuredSurface, Field(discriminator="kind")]
SURFACES = by_kind(*get_args(Made), MeasuredSurface)


KINDS: Mapping[str, Mapping[str, type[Section]]] = {"surface": SURFACES, "solid": SOLIDS}
"""Sections of several kinds, and the models of each kind; the first is the usual one."""


class Contact(Section):
    """What presses: a load, a pressure or a separation; by default such that about 1 % touches."""

    load: FirstForce | None = usual(
        None,
        "Normal load, the sum of all contact forces; 0 before a ramp. "
        "By default 0.005 (k0 + k1) x rms height x sites; on a continuum a pressure is taken.",
    )
    pressure: Pressure | None = usual(
        None, "Load over nominal area, instead of the load. By default, on a continuum, 0.005 E* x rms slope."
    )
    separation: Position | None = usual(None, "Mean height of the undeformed solid; instead of the load.")

    @model_validator(mode="after")
    def _one_of_three(self) -> Self:
        if len(given := self.model_dump(exclude_none=True)) > 1:
            got = "both" if len(given) == 2 else "all"
            names = list(given)
            raise ValueError(f"expected {', '.join(names[:-1])} or {names[-1]}, got {got}")
        return self


class Aging(Section):
    """The times to record ([0.0]: only the start and the limit), what is held, and the tolerance."""

    first: Duration | None = usual(
        None,
        "First time to record. By default that of the table of relaxation, else a tenth of the "
        "shortest relaxation time, else 0.001.",
    )
    last: Duration | None = usual(
        None,
        "Last time to record. By default that of the table of relaxation, else ten times the "
        "longest relaxation time, else 1e+06.",
    )
    per_decade: Annotated[int, Field(ge=1, le=1000)] = usual(4, "Times to record in each decade.")
    times: Annotated[list[Time], Field(min_length=1)] | None = usual(
        None, "The times to record, one by one; instead of the three above."
    )
    hold: Literal["load", "separation"] | None = usual(
        None, "What is held while it ages. By default what pressed it."
    )
    rtol: Annotated[float, Field(ge=1e-6, le=0.1)] = usual(2e-3, "Relative tolerance of the time steps.")

    @model_validator(mode="after")
    def _check_times(self) -> Self:
        if self.times is None:
            return self
        if rivals := self.model_fields_set & {"first", "last", "per_decade"}:
            raise ValueError(f"expected times or {', '.join(sorted(rivals))}, got both")
        for earlier, later in pairwise(self.times):
            if later <= earlier:
                raise ValueError(
                    f"times: expected strictly increasing times, got {later:g} after {earlier:g}"
                )
        return self


class LegSection(Section):
    """A leg of `asperity.protocols`, of one kind or another; its keys are the parameters of that class."""

    kind: str
    _leg: Leg = PrivateAttr()

    @property
    def leg(self) -> Leg:
        """The leg itself."""
        return self._leg

    @model_validator(mode="after")
    def _possible(self) -> Self:
        try:
            self._leg = leg_of(self.model_dump(exclude_none=True))
        except InputError as error:
            names = error.name.replace(" and ", ", ").split(", ")
            said = f"expected {any_of(names)}" if names[1:] else f"{error.name}: expected {error.expected}"
            raise ValueError(f"{said}, got {error.got}") from None
        return self


class RepeatLeg(LegSection):
    """Legs repeated; see `asperity.protocols.Repeat`."""

    kind: Literal["repeat"] = "repeat"
    legs: list[AnyLeg] = Field(min_length=1, description="The legs that are repeated.")
    count: Annotated[int, Field(ge=1, le=100_000)] = Field(description="How often in all.")


def _section_of(kind: str, leg: type[Leg]) -> type[LegSection]:
    keys: dict[str, Any] = {"kind": (Literal[kind], kind)}
    keys |= {name: field_of(parameter) for name, parameter in parameters_of(leg).items()}
    made = create_model(f"{leg.__name__}Leg", __base__=LegSection, **keys)
    globals()[made.__name__] = made  # where pickle looks for it, to send a run to another process
    return made


LEGS: dict[str, type[LegSection]] = {
    kind: RepeatLeg if kind == "repeat" else _section_of(kind, leg) for kind, leg in LEGS_OF_PROTOCOLS.items()
}
if TYPE_CHECKING:
    AnyLeg = LegSection
else:
    AnyLeg = Annotated[Union[tuple(LEGS.values())], Field(discriminator="kind")]  # noqa: UP007


class Friction(Section):
    """What makes friction of the contact area; without a shear strength, nothing does."""

    shear_strength: Pressure | None = usual(
        None, "Shear strength of the contacts, an input; on the lattice of springs, force a site."
    )
    rate_coefficient: Share | None = usual(
        None, "Relative growth of the shear strength for each factor e of velocity. By default none."
    )
    reference_velocity: Velocity | None = usual(None, "Velocity at which the shear strength is what it is.")

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if self.shear_strength is None and self.model_fields_set:
            raise ValueError(f"{min(self.model_fields_set)}: expected shear_strength beside it, got none")
        if self.rate_coefficient and self.reference_velocity is None:
            raise ValueError("rate_coefficient: expected reference_velocity beside it, got none")
        return self


class Carried(Section):
    """What a half-space's contact carries besides its load, recorded at each time."""

    stiffness: bool = usual(
        False, "Record the normal stiffness; with one Poisson's ratio of the solid the tangential too."
    )
    resistivity: OneOrTwo[Resistivity] | None = usual(
        None, "Electrical resistivity, of both bodies or of each: record the resistance."
    )
    conductivity: OneOrTwo[Conductivity] | None = usual(
        None, "Thermal conductivity, likewise: record the thermal resistance."
    )
    shear: Force | None = usual(None, "Shear force: record which share of the contact sticks under it.")
    friction_coefficient: Positive | None = usual(
        None, "Coefficient of friction of the sites, for the shear force."
    )

    @model_validator(mode="after")
    def _both(self) -> Self:
        names = ("shear", "friction_coefficient")
        if (self.shear is None) != (self.friction_coefficient is None):
            other, name = names if self.shear is None else names[::-1]
            raise ValueError(f"{name}: expected {other} beside it, got none")
        return self

    def asked(self, poisson: list[float] | None) -> dict[str, Any] | None:
        """What `asperity.Carried` takes, beside Poisson's ratios; None where nothing is to be recorded."""
        facts = self.model_dump(exclude_defaults=True)
        if not facts:
            return None
        for name in {"resistivity", "conductivity"} & facts.keys():
            facts[name] = _alone(tuple(facts[name]))
        if "friction_coefficient" in facts:
            facts["friction"] = facts.pop("friction_coefficient")
        if facts.pop("stiffness", False) and poisson and len(set(poisson)) == 1:
            facts["poisson"] = poisson[0]
        return facts


class Output(Section):
    """What is written."""

    maps_at: list[Time] | None = usual(
        None, "Times at which to keep and draw the contact. By default 0 and five others."
    )
    figures: list[Figure] = usual(["png"], 'Formats of the figures; "" for none.')
    pixel: Size | None = usual(
        None, "Pixel of an instrument that looks at the maps; in sites where there are no units."
    )
    blur: Size | None = usual(None, "Full width at half maximum of its point spread function, likewise.")
    threshold: Share | None = usual(
        None, "Part of full contact from which such a pixel counts. By default all light counts."
    )

    @property
    def instrument(self) -> dict[str, Any]:
        """What looks at the maps, for `asperity.observe`; empty for none."""
        return self.model_dump(include={"pixel", "blur", "threshold"}, exclude_none=True)

    @model_validator(mode="after")
    def _check_maps(self) -> Self:
        if self.threshold is not None and self.pixel is None and self.blur is None:
            raise ValueError("threshold: expected `pixel` or `blur` beside it, got neither")
        if self.maps_at == [] and self.instrument:
            raise ValueError(f"{next(iter(self.instrument))}: expected maps to look at, got maps_at = []")
        return self


SECTIONS: Mapping[str, type[Section]] = {
    "contact": Contact,
    "aging": Aging,
    "friction": Friction,
    "carried": Carried,
    "output": Output,
}
"""Sections of one kind."""


class RunConfig(Section):
    """The configuration of a run."""

    surface: AnySurface = Independent()
    solid: AnySolid = SpringLattice()
    contact: Contact = Contact()
    aging: Aging = Aging()
    protocol: list[AnyLeg] = Field(default=[])
    friction: Friction = Friction()
    carried: Carried = Carried()
    output: Output = Output()

    @model_validator(mode="after")
    def _check_times(self) -> Self:
        if self.protocol and "last" in self.aging.model_fields_set:
            raise ValueError("[aging] last: expected none beside a protocol, which says when it ends")
        if self.aging.times is None and not self.protocol and not self.span[0] < self.span[1]:
            raise ValueError("[aging] expected first < last, got {:g} and {:g}".format(*self.span))
        if self.protocol and self.aging.hold is not None:
            raise ValueError("[aging] hold: expected none beside a protocol, whose legs say what they hold")
        if self.contact.load == 0 and not (self.protocol and self.written_out[0].target):
            expected = "a protocol that begins with a ramp beside 0"
            raise ValueError(f"[contact] load: expected {expected}, got none; try --leg 'ramp 1 load=...'")
        if (known := self.solid.known) is not None:
            first = next((time for time in self.aging.times or [self.span[0]] if time > 0), known[0])
            if first < known[0] * (1 - 1e-9) or self.end > known[1] * (1 + 1e-9):
                got = "{:g} to {:g}".format(*known)
                expected = f"a table of the times to record, {first:g} to {self.end:g}"
                begun = first >= known[0] * (1 - 1e-9)
                advice = '; try extrapolate = "plateau" (--extrapolate plateau), or branches' if begun else ""
                raise ValueError(f"[solid] relaxation: expected {expected}, got one of {got}{advice}")
        for where, times in (("[aging] times", self.aging.times), ("[output] maps_at", self.output.maps_at)):
            late = max(times or [], default=-math.inf)
            if late > self.end * (1 + 1e-9):
                raise ValueError(f"{where}: expected times up to the last, {self.end:g}, got {late:g}")
        return self

    @property
    def legs(self) -> tuple[Leg, ...]:
        """The legs of the protocol; none where nothing changes."""
        return tuple(leg.leg for leg in self.protocol)

    @property
    def written_out(self) -> list[Leg]:
        """The legs one by one, without repetitions."""
        return [one for leg in self.legs for one in leg.written_out()]

    @property
    def span(self) -> tuple[float, float]:
        """First and last time to record, where they are not listed one by one; of a leg the first."""
        first, last = self.solid.span
        first, last = self.aging.first or first, self.aging.last or last
        return first, last

    @property
    def carries(self) -> dict[str, Any] | None:
        """What `asperity.Carried` takes; None where nothing is to be recorded."""
        return self.carried.asked(getattr(self.solid, "poisson", None))

    @property
    def end(self) -> float:
        """The last time."""
        if not self.protocol:
            return self.span[1] if self.aging.times is None else self.aging.times[-1]
        return math.fsum(leg.duration for leg in self.written_out)
