"""Flags that a command has many of, or shares with others: each with its default and its help."""

from __future__ import annotations

import inspect
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, TypeVar, dataclass_transform

from cyclopts import Parameter

from asperity.app.cli.flags import Out, Quiet, Switch, Whole
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


@flags_of_fields
class PredictFlags:
    """What a relaxation table holds, and for which temperature.

    Parameters
    ----------
    kind
        What the table holds, if the names of its columns do not say.
    columns
        Names or numbers, from 0, of its columns: time and modulus, time and compliance, or frequency,
        storage and loss modulus. [default: those that are named so]
    noise
        Largest relative change in the wrong direction that is taken for noise of the table. [default: 0.05]
    modulus
        What the table measures: Young's modulus, the shear modulus, or the contact modulus E*.
        [default: young]
    branches
        How many relaxation times the fit of the table has, which are free. [default: the fewest whose misfit
        looks like noise, five at most; else --branches-per-decade 1]
    reference
        Temperature of the table, such as 20degC.
    activation_energy
        How relaxation times depend on temperature, by Arrhenius, such as 100kJ/mol.
    wlf
        The same by Williams, Landel and Ferry, for the decimal logarithm: C1 C2, C2 in K.
    """

    kind: Literal["relaxation", "creep", "dynamic"] | None = None
    columns: Annotated[list[str] | None, Parameter(negative=(), consume_multiple=True)] = None
    noise: float | None = None
    modulus: Literal["young", "shear", "contact"] | None = None
    branches: Whole | None = None
    reference: Annotated[str | None, Parameter(metavar="QUANTITY", allow_leading_hyphen=True)] = None
    activation_energy: Annotated[str | None, Parameter(metavar="QUANTITY")] = None
    wlf: Annotated[tuple[float, float] | None, Parameter(negative=())] = None


@flags_of_fields
class FitFlags:
    """What is fitted to a table, and where it goes.

    Parameters
    ----------
    law
        Law to fit.
    out
        Figure to write (.png, .pdf or .svg).
    json
        File to write all numbers to (.json).
    overwrite
        Replace these files if they exist.
    window
        Hold times T1 T2 between which a straight line gives the growth per decade; the laws are fitted
        to all values. [default: all]
    column_time
        Column of the hold times: its name in the header, or a number counted from 0. [default: 0, or 1
        where column 0 is an index 0, 1, 2, ... without a name, as pandas writes it]
    column_value
        Column of the values. [default: the next]
    column_stderr
        Column of their standard errors. [default: none are known]
    quantity
        What the values are, for the figure. [default: the name in the header]
    unit_time
        Unit of the hold times, such as s, for the figure. [default: none]
    """

    law: Literal["saturation", "logarithm", "both"] = "both"
    out: Out = Path("fit.png")
    json: Path | None = None
    overwrite: Switch = False
    window: Annotated[tuple[float, float] | None, Parameter(negative=())] = None
    column_time: str | None = None
    column_value: str | None = None
    column_stderr: str | None = None
    quantity: str | None = None
    unit_time: str | None = None


@flags_of_fields
class FrictionFlags:
    """What of records of friction is fitted.

    Parameters
    ----------
    law
        The law whose parameters come first: one, or that of the verdict.
    a
        The direct effect, such as 0.01. [default: 0 for runs with a constant shear strength, else fitted]
    reference_velocity
        V_0, such as "1 um/s", of which mu_0 is the steady friction. [default: the first of the record]
    events
        What to fit: all, the holds, or the velocity steps.
    shear_strength
        Shear strength of the contacts, such as 50MPa, for runs that did not state it.
    columns
        Names or numbers, from 0, of the columns to read. [default: those whose names are understood]
    strength_at_rest
        Friction at rest in a table is the strength, as in a simulation, and not the force held.
    """

    law: Literal["best", "aging", "slip"] = "best"
    a: float | None = None
    reference_velocity: str | None = None
    events: Literal["all", "holds", "steps"] = "all"
    shear_strength: str | None = None
    columns: Annotated[list[str] | None, Parameter(negative=(), consume_multiple=True)] = None
    strength_at_rest: Switch = False


@flags_of_fields
class Work:
    """How the runs of campaigns are done.

    Parameters
    ----------
    workers
        Worker processes on this machine. [default: its cores]
    scheduler
        Address of a Dask scheduler to use instead, such as tcp://10.0.0.1:8786.
    dry_run
        Only say how many runs, and how much memory and disk.
    retry_failed
        Try again what failed earlier.
    quiet
        Print neither progress nor summary.
    """

    workers: Whole | None = None
    scheduler: str | None = None
    dry_run: Switch = False
    retry_failed: Switch = False
    quiet: Quiet = False

    def check(self) -> None:
        """Refuse with `InputError` to work with nobody."""
        if self.workers is not None and self.workers < 1:
            raise InputError("--workers", expected="1 or more", got=self.workers)
