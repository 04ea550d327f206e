"""What a run needs to know: the sections of its configuration, and what each key may be.

Every key has a default, except the path of a measured surface, and the contact's load, which follows
from the surface and the solid.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from asperity.errors import LARGEST

Figure = Literal["png", "pdf", "svg"]


def _listed(value: object) -> object:
    return [value] if isinstance(value, int) and not isinstance(value, bool) else value


def _name_or_number(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, int | str):
        raise ValueError("expected the name or the number of a channel")
    return value


def _power_of_two(value: int) -> int:
    if value < 2 or value & (value - 1):
        below = 1 << (max(value, 2).bit_length() - 1)
        raise ValueError(f"expected a power of two, 2 or more, got {value}; try {below} or {2 * below}")
    return value


Positive = Annotated[float, Field(gt=0, le=LARGEST)]
NotNegative = Annotated[float, Field(ge=0, le=LARGEST)]
Seed = Annotated[int, Field(ge=0)]
Shape = Annotated[
    list[Annotated[int, Field(ge=1)]], Field(min_length=1, max_length=2), BeforeValidator(_listed)
]


class Section(BaseModel):
    """A table of the configuration: no unknown keys, no silent conversions, no infinities."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


class Gaussian(Section):
    """Independent Gaussian heights."""

    kind: Literal["gaussian"] = "gaussian"
    shape: Shape = [200, 200]
    rms: Positive = 1.0
    seed: Seed = 0


class Exponential(Section):
    """Independent exponential heights."""

    kind: Literal["exponential"] = "exponential"
    shape: Shape = [200, 200]
    rms: Positive = 1.0
    seed: Seed = 0


class SelfAffine(Section):
    """Self-affine heights."""

    kind: Literal["self_affine"] = "self_affine"
    size: Annotated[int, AfterValidator(_power_of_two)] = 256
    hurst: Annotated[float, Field(gt=0, le=1)] = 0.5
    delta: Positive = 0.01
    seed: Seed = 0


class MeasuredSurface(Section):
    """Heights from a file; see `asperity.surfaces.read`."""

    kind: Literal["file"] = "file"
    path: str
    undefined: Literal["fill", "refuse"] = "fill"
    max_undefined: Annotated[float, Field(ge=0, lt=1)] = 0.1
    tilt: Literal["plane", "mean", "none"] = "plane"
    periodic: Literal["mirror", "taper", "wrap"] = "mirror"
    unit: Literal["m", "mm", "um", "nm", "pm", "rms"] | None = None
    channel: Annotated[int | str | None, BeforeValidator(_name_or_number)] = None
    resample: bool = False


SURFACES: dict[str, type[Gaussian | Exponential | SelfAffine | MeasuredSurface]] = {
    "gaussian": Gaussian,
    "exponential": Exponential,
    "self_affine": SelfAffine,
    "file": MeasuredSurface,
}
AnySurface = Annotated[Gaussian | Exponential | SelfAffine | MeasuredSurface, Field(discriminator="kind")]


class Solid(Section):
    """The spring lattice."""

    k0: NotNegative = 1.0
    k1: Positive = 3.0
    R: NotNegative = 1.0
    R_viscous: NotNegative = 0.0


class Contact(Section):
    """What presses: a load or a separation; by default a load that gives about 1 % contact."""

    load: Positive | None = None
    separation: float | None = None

    @model_validator(mode="after")
    def _one_of_two(self) -> Self:
        if self.load is not None and self.separation is not None:
            raise ValueError("expected load or separation, got both")
        return self


class Aging(Section):
    """The times to record ([0.0]: only the start and the limit), what is held, and the tolerance."""

    first: Positive = 1e-3
    last: Positive = 1e6
    per_decade: Annotated[int, Field(ge=1)] = 4
    times: Annotated[list[NotNegative], Field(min_length=1)] | None = None
    hold: Literal["load", "separation"] | None = None
    rtol: Annotated[float, Field(ge=1e-6, le=0.1)] = 2e-3

    @model_validator(mode="after")
    def _check_times(self) -> Self:
        if self.times is None:
            if not self.first < self.last:
                raise ValueError(f"expected first < last, got {self.first:g} and {self.last:g}")
            return self
        if rivals := self.model_fields_set & {"first", "last", "per_decade"}:
            raise ValueError(f"expected times or {', '.join(sorted(rivals))}, got both")
        if any(later <= earlier for earlier, later in pairwise(self.times)):
            raise ValueError("times: expected strictly increasing times")
        return self

    @property
    def end(self) -> float:
        """The last time."""
        return self.last if self.times is None else self.times[-1]


class Output(Section):
    """What is written."""

    maps_at: list[NotNegative] | None = None
    figures: Annotated[list[Figure], Field(min_length=1)] = ["png"]


class RunConfig(Section):
    """The configuration of a run."""

    surface: AnySurface = Gaussian()
    solid: Solid = Solid()
    contact: Contact = Contact()
    aging: Aging = Aging()
    output: Output = Output()

    @model_validator(mode="after")
    def _check_maps(self) -> Self:
        late = max(self.output.maps_at or [], default=-math.inf)
        if late > self.aging.end:
            raise ValueError(
                f"[output] maps_at: expected times up to the last, {self.aging.end:g}, got {late:g}"
            )
        return self
