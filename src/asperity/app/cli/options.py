"""Flags as fields of a class: each with its default and its help."""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar, dataclass_transform

from cyclopts import Parameter, Token

from asperity.app.cli.flags import Columns, Open, Quiet, Switch, Units, Whole, listed
from asperity.base.files import FORMATS, Format
from asperity.errors import InputError

_Flags = TypeVar("_Flags")


def paragraphs(text: str) -> str:
    """Join the lines of a paragraph: help breaks them where the terminal ends."""
    lines: list[str] = []
    for line in inspect.cleandoc(text).splitlines():
        before = lines[-1] if lines else ""
        indents = [len(one) - len(one.lstrip()) for one in (before, line)]
        if (
            before
            and line
            and indents[0] == indents[1]
            and "--" not in (before.strip()[:2], line.strip()[:2])
        ):
            lines[-1] += f" {line.strip()}"
        else:
            lines.append(line)
    return "\n".join(lines)


@dataclass_transform(kw_only_default=True, frozen_default=True)
def flags_of_fields(kind: type[_Flags]) -> type[_Flags]:
    """Make flags of the fields of a class, with the help that its docstring has for each."""
    kind.__doc__ = paragraphs(kind.__doc__ or "")
    return Parameter(name="*")(dataclass(frozen=True, kw_only=True)(kind))


def _formats(_: object, tokens: Sequence[Token]) -> list[str]:
    words = listed(token.value for token in tokens)
    if wrong := [word for word in words if word not in FORMATS]:
        raise ValueError(f"expected some of {', '.join(FORMATS)}, got {wrong[0]}")
    return words


@flags_of_fields
class Results:
    """How the folder of results is written and shown.

    Parameters
    ----------
    overwrite
        Replace the results of an earlier command.
    show
        Open the page or the picture of the results at the end.
    """

    overwrite: Switch = False
    quiet: Quiet = False
    show: Open = False


@flags_of_fields
class Drawn:
    """How pictures are written.

    Parameters
    ----------
    figures
        Formats of the figures; "" for none. Each figure has a table of its data beside it. [default: as in
        the TOML file or the file name, else png]
    """

    figures: Annotated[
        list[Format] | None, Parameter(negative=(), consume_multiple=True, converter=_formats)
    ] = None

    def formats(self, usual: Sequence[Format] = ("png",)) -> Sequence[Format]:
        """What was asked for, or what is usual."""
        return usual if self.figures is None else self.figures


@flags_of_fields
class Reading:
    """How a table is read.

    Parameters
    ----------
    columns
        Columns by name, or by number from 0. Of a curve: times, values and, if any, standard errors; of a
        record: all to read. [default: the first two; of a record, those with names that we know]
    units
        Units of columns, in place of those of the table, such as t=min.
    """

    columns: Columns = None
    units: Units = None


@flags_of_fields
class CurveColumns:
    """The columns of a curve.

    Parameters
    ----------
    column_time
        Column of the hold times: its name in the header, or a number counted from 0. [default: 0, or 1 if
        column 0 is an index of pandas]
    column_value
        Column of the values. [default: the next]
    column_stderr
        Column of their standard errors. [default: none; to infer, the one whose name has std, err or sigma]
    """

    column_time: str | None = None
    column_value: str | None = None
    column_stderr: str | None = None

    def chosen(self) -> dict[str, str | None]:
        """Arguments of `asperity.fits.read_measurements`."""
        return {name.removeprefix("column_"): column for name, column in vars(self).items()}


@flags_of_fields
class Indenter:
    """An indenter or AFM whose record has times, depths and forces.

    Parameters
    ----------
    radius
        Radius of the ball or punch, such as 7um. With it (or an angle) the table is the record of an
        indenter: approach and hold make the solid, and the retraction is predicted.
    angle
        Half-angle of the cone, such as "35 deg".
    poisson
        Poisson's ratio, for Young's modulus. [default: the contact modulus E* only]
    spring
        Spring constant, such as "0.05 N/m", of heights (piezo), which contain its deflection.
    contact
        Depth of the first contact, such as 20nm, or fit. [default: depth 0; tip positions and heights: fit]
    drift
        Speed of the depth without deformation, such as "0.1 nm/s", which is subtracted.
    """

    radius: str | None = None
    angle: str | None = None
    poisson: float | None = None
    spring: str | None = None
    contact: str | None = None
    drift: str | None = None

    def tip(self) -> dict[str, Any]:
        """Arguments of `asperity.infer`; none for a curve."""
        told = {"radius": self.radius, "angle": self.angle, "poisson": self.poisson}
        return told if self.radius or self.angle else {}

    def reading(self) -> dict[str, Any]:
        """Arguments of `asperity.inference.read_indentation`."""
        return {"spring": self.spring, "contact": self.contact, "drift": self.drift or 0.0}


@flags_of_fields
class Work:
    """How the runs of campaigns are done.

    Parameters
    ----------
    workers
        Worker processes on this machine. [default: one for each core]
    scheduler
        Address of a Dask scheduler to use instead, such as tcp://10.0.0.1:8786.
    dry_run
        Only print how many runs there are to do, and how much memory and disk they need.
    retry_failed
        Repeat runs that failed earlier.
    """

    workers: Whole | None = None
    scheduler: str | None = None
    dry_run: Switch = False
    retry_failed: Switch = False
    quiet: Quiet = False

    def check(self) -> None:
        """Refuse fewer than one worker with `InputError`."""
        if self.workers is not None and self.workers < 1:
            raise InputError("--workers", expected="1 or more", got=self.workers)


RESULTS, DRAWN, READING = Results(), Drawn(), Reading()
COLUMNS, INDENTER, WORK = CurveColumns(), Indenter(), Work()
"""What commands take where no flag is typed."""
