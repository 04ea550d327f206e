"""Surfaces of a run: sections made from the functions of `asperity.surfaces`."""

from __future__ import annotations

import hashlib
from inspect import signature
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np

from asperity.ask.section import Section, SectionError, arguments_of
from asperity.base import checks
from asperity.base.files import content_of, expanded
from asperity.base.parameters import Quantity
from asperity.base.words import has_unit
from asperity.errors import InputError
from asperity.surfaces import KINDS, Surface, read
from asperity.surfaces.heights import sides_of_pixels
from asperity.surfaces.making import in_numbers


class SurfaceSection(Section):
    """A surface, of one kind or another."""

    section = "surface"
    ways = (({"rms_height"}, {"rms_slope"}, {"rms_curvature"}),)

    edges: Annotated[
        Literal["periodic", "reflecting", "free"] | None,
        Quantity(
            "Edges: periodic, reflecting (mirror image) or free (the body ends there). By default "
            "they depend on the kind of surface, and on how a scan is made periodic"
        ),
    ] = None

    def __init__(self, **table: Any) -> None:
        try:
            table = self._in_numbers(table)
        except InputError as error:
            own = {key: key for key in self.keys}
            raise SectionError([error.about(error.name, "surface", error.name, keys=own)]) from None
        super().__init__(**table)

    @classmethod
    def _in_numbers(cls, table: dict[str, Any]) -> dict[str, Any]:
        """Lengths with a unit, as numbers in the unit of the surface."""
        return in_numbers(cls.make, table)

    @property
    def lattice(self) -> tuple[int, ...] | None:
        """Sites along each axis; None if they are unknown before the surface is made."""
        if (size := getattr(self, "size", None)) is not None:
            return (size, size)
        shape = getattr(self, "shape", None)
        return None if shape is None else tuple(shape)

    @property
    def only_powers_of_two(self) -> bool:
        """Whether its axes have to be powers of two."""
        return hasattr(self, "size")

    @property
    def file(self) -> Path | None:
        """The file on which it depends, if any."""
        path = getattr(self, "path", None)
        return None if path is None else expanded(path)

    @property
    def scan(self) -> Self:
        """The same without mirrored copies of itself."""
        return self

    @property
    def arguments(self) -> tuple[Any, dict[str, Any]]:
        """Arguments of `make`: the lattice or the file, and keywords."""
        first, *facts = arguments_of(self.make, self).items()
        return first[1], dict(facts) | (self._edges if self._knows_edges else {})

    @property
    def around(self) -> dict[str, Any]:
        """Arguments of `asperity.surfaces.Surface` beside those of `make`; empty if these are complete."""
        facts = {} if self._knows_edges else self._edges
        if (spacing := getattr(self, "spacing", None)) is not None:
            facts["pixel_size"] = (*spacing, *spacing)[: len(self.lattice or ())]
            unit = getattr(self, "unit", None)
            facts |= {} if unit is None else {"unit": unit, "length_unit": unit}
        return facts

    @property
    def _knows_edges(self) -> bool:
        return "edges" in signature(self.make).parameters

    @property
    def _edges(self) -> dict[str, Any]:
        return {} if self.edges is None else {"edges": self.edges}

    def build(self) -> Surface:
        """Make or read the surface, with its provenance."""
        first, facts = self.arguments
        surface, around = self.make(first, **facts), self.around
        if isinstance(surface, Surface) and not around:
            return surface
        origin = self.table
        origin.pop("edges", None)
        if "pixel_size" in around:
            origin |= {"pixel_size": list(around["pixel_size"]), "length_unit": around.get("unit", "")}
        if self.file is not None:
            origin["sha256"] = hashlib.sha256(content_of(self.file)).hexdigest()
        return Surface(np.asarray(surface), **around, provenance=origin)


class MeasuredSurface(SurfaceSection.of_kind("file", KINDS["file"])):  # type: ignore[misc]
    """Heights from a file; see `asperity.surfaces.read`."""

    @classmethod
    def _in_numbers(cls, table: dict[str, Any]) -> dict[str, Any]:
        """Pixel sizes with a unit are in that unit, or in the one that is given."""
        size = table.get("pixel_size")
        sizes = [size] if isinstance(size, str) else size
        if isinstance(sizes, list | tuple) and any(map(has_unit, sizes)):
            numbers, unit = sides_of_pixels(sizes, len(sizes), table.get("length_unit"))
            return table | {"pixel_size": list(numbers), "length_unit": unit}
        return table

    def check(self) -> None:
        """See `Section`; a rule that the edges overrule is refused, and the one that is used is kept."""
        super().check()
        rule = self.rule
        if {"edges", "periodic"} <= self.stated and self.edges and self.periodic != rule:
            expected = f"{rule!r} beside edges {self.edges!r}"
            raise self.wrong("periodic", expected=expected, got=repr(self.periodic), cure={"periodic": rule})
        self._set({"periodic": rule}, self.stated)

    @property
    def rule(self) -> Literal["mirror", "reflect", "taper", "wrap", "free"]:
        """How `asperity.surfaces.read` treats the edges."""
        if self.edges == "periodic":
            return "wrap" if self.periodic in ("reflect", "free") else self.periodic
        return "free" if self.edges == "free" else "reflect" if self.edges else self.periodic

    @property
    def scan(self) -> Self:
        """The same, with reflecting edges in place of mirrored copies."""
        return self.but(periodic="reflect", edges=None) if self.rule == "mirror" else self

    @property
    def arguments(self) -> tuple[Any, dict[str, Any]]:
        """Arguments of `asperity.surfaces.read`: the file, and its preparation."""
        path, facts = super().arguments
        return path, facts | {"periodic": self.rule}

    @property
    def around(self) -> dict[str, Any]:
        """See `SurfaceSection`: `rule` includes the edges."""
        return {}


def scan_of(surface: str | Path | Surface) -> Surface:
    """A scan, once without mirrored copies, or that of a file; `InputError` unless it has two axes."""
    advice = "asperity.surfaces.Surface(heights, unit='um', pixel_size='1 um')"
    found = read(surface) if isinstance(surface, str | Path) else surface
    scan = checks.instance("surface", found, Surface, advice).scan
    if scan.heights.ndim != 2:
        raise InputError("surface", expected="a scan of two axes", got="a profile", advice="a scan")
    return scan


SURFACES: dict[str, type[SurfaceSection]] = {
    kind: MeasuredSurface if kind == "file" else SurfaceSection.of_kind(kind, make)
    for kind, make in KINDS.items()
}
