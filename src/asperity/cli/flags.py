"""The flags of the commands: each overrides the key of the same name in a section of the configuration.

A flag that was not given is None. The flags are checked together with the configuration.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

from cyclopts import Group, Parameter

Switch = Annotated[bool, Parameter(negative=(), show_default=False)]
_Words = Parameter(consume_multiple=True, negative=())

_SURFACE = Group("Surface", sort_key=1)
_SOLID = Group("Solid", sort_key=2)
_CONTACT = Group("Contact", sort_key=3)
_AGING = Group("Aging", sort_key=4)
_OUTPUT = Group("Output", sort_key=5)


@dataclass(frozen=True, kw_only=True)
class Flags:
    """Flags of one section."""

    section: ClassVar[str] = ""
    renamed: ClassVar[dict[str, str]] = {}


@Parameter(name="*", group=_SURFACE)
@dataclass(frozen=True, kw_only=True)
class SurfaceFlags(Flags):
    """What the surface is."""

    section: ClassVar[str] = "surface"
    renamed: ClassVar[dict[str, str]] = {"surface": "kind", "file": "path"}

    surface: Literal["gaussian", "exponential", "self_affine", "file"] | None = None
    """Kind of surface. [default: gaussian]"""
    shape: Annotated[list[str] | None, _Words, Parameter(metavar="N")] = None
    """Sites along each axis: 200 200, or 4096 for a line (gaussian, exponential). [default: 200 200]"""
    rms: float | None = None
    """Rms height (gaussian, exponential). [default: 1.0]"""
    seed: int | None = None
    """Seed of the random heights. [default: 0]"""
    size: int | None = None
    """Sites along each axis, a power of two (self_affine). [default: 256]"""
    hurst: float | None = None
    """Hurst exponent (self_affine). [default: 0.5]"""
    delta: float | None = None
    """Roughness at the scale of the lattice (self_affine). [default: 0.01]"""
    file: Annotated[str | None, Parameter(metavar="PATH")] = None
    """Measured surface (file); the last flags of this group prepare it."""


@Parameter(name="*", group=_SURFACE)
@dataclass(frozen=True, kw_only=True)
class FileFlags(Flags):
    """How a measured surface is prepared."""

    section: ClassVar[str] = "surface"

    undefined: Literal["fill", "refuse"] | None = None
    """Undefined pixels: fill (from their rims; default) or refuse."""
    max_undefined: float | None = None
    """Largest fraction of undefined pixels to fill. [default: 0.1]"""
    tilt: Literal["plane", "mean", "none"] | None = None
    """What to remove. [default: plane]"""
    periodic: Literal["mirror", "taper", "wrap"] | None = None
    """How to make it periodic; mirror doubles each axis. [default: mirror]"""
    unit: Literal["m", "mm", "um", "nm", "pm", "rms"] | None = None
    """Unit of the heights; rms divides by the rms height. [default: the file's]"""
    channel: str | None = None
    """Name or number of the channel. [default: the file's]"""
    resample: Annotated[bool | None, Parameter(negative=())] = None
    """Average pixels that are not square to the larger spacing; without, a run refuses them."""


@Parameter(name="*", group=_SOLID)
@dataclass(frozen=True, kw_only=True)
class SolidFlags(Flags):
    """What the solid is."""

    section: ClassVar[str] = "solid"

    k0: float | None = None
    """Stiffness of the springs between neighbors. [default: 1.0]"""
    k1: float | None = None
    """Stiffness of the springs to the bulk. [default: 3.0]"""
    R: Annotated[float | None, Parameter(name="--R")] = None
    """Mobility of creep that conserves the mean. [default: 1.0]"""
    R_viscous: Annotated[float | None, Parameter(name="--R-viscous")] = None
    """Mobility of viscous creep. [default: 0.0]"""


@Parameter(name="*", group=_CONTACT)
@dataclass(frozen=True, kw_only=True)
class ContactFlags(Flags):
    """What presses."""

    section: ClassVar[str] = "contact"

    load: float | None = None
    """Normal load, the sum of all contact forces. [default: 0.005 (k0 + k1) x rms height x sites]"""
    separation: float | None = None
    """Mean height of the undeformed solid; instead of the load."""


@Parameter(name="*", group=_AGING)
@dataclass(frozen=True, kw_only=True)
class AgingFlags(Flags):
    """How the contact ages."""

    section: ClassVar[str] = "aging"

    hold: Literal["load", "separation"] | None = None
    """What is held while it ages. [default: what pressed it]"""
    first: float | None = None
    """First time to record. [default: 0.001]"""
    last: float | None = None
    """Last time to record. [default: 1e6]"""
    per_decade: int | None = None
    """Times to record in each decade. [default: 4]"""
    times: Annotated[list[str] | None, _Words, Parameter(metavar="T")] = None
    """The times to record, one by one; instead of the three above."""
    rtol: float | None = None
    """Relative tolerance of the time steps. [default: 0.002]"""


@Parameter(name="*", group=_OUTPUT)
@dataclass(frozen=True, kw_only=True)
class OutputFlags(Flags):
    """What is written."""

    section: ClassVar[str] = "output"

    maps_at: Annotated[list[str] | None, _Words, Parameter(metavar="T")] = None
    """Times at which to keep and draw the contact. [default: 0 and five others]"""
    figures: Annotated[list[Literal["png", "pdf", "svg"]] | None, _Words] = None
    """Formats of the figures. [default: png]"""


def given(*groups: Flags | None) -> dict[str, dict[str, object]]:
    """Gather the flags that were given, by section and key; lists of words become lists of numbers."""
    sections: dict[str, dict[str, object]] = {}
    for group in groups:
        if group is None:
            continue
        for field in dataclasses.fields(group):
            value = getattr(group, field.name)
            if value is not None:
                key = group.renamed.get(field.name, field.name)
                sections.setdefault(group.section, {})[key] = _parsed(key, value)
    return sections


def _parsed(key: str, value: object) -> object:
    if key == "channel" and isinstance(value, str) and value.isdecimal():
        return int(value)
    if not isinstance(value, list) or key == "figures":
        return value
    if key == "shape":  # 200x200 too
        value = [item.replace("x", " ") for item in value]
    words = [word for item in value for word in item.replace(",", " ").split()]
    return [_number(word, whole=key == "shape") for word in words]


def _number(word: str, *, whole: bool) -> object:
    """Read a number; a word that is none is left to the check of the configuration."""
    try:
        return int(word) if whole else float(word)
    except ValueError:
        return word
