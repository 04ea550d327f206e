"""Anybody's answer to a reference problem, held against the certified one."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from asperity.base.rows import Row
from asperity.base.words import counted
from asperity.errors import InputError
from asperity.results import read_table
from asperity_research.arrays import Field
from asperity_research.challenge.posing import Column, Problem, problem

Verdict = Literal["within the error bars", "within the tolerance", "off"]
_SAME = 1e-6  # Relative difference up to which a number in the first column is that of the problem
_EXAMPLE = '{"time": times, "area": areas}'
_NAMED = re.compile(r"^\s*[#%;]\s*problem\s*[:=]\s*(\S+)", re.IGNORECASE | re.MULTILINE)


@dataclass(frozen=True, eq=False)
class QuantityScore:
    """One quantity of an answer, at the places where it is given.

    Attributes
    ----------
    column
        What it is.
    heading
        The column of the result that was taken.
    abscissa, given, certified, bar
        Shape (n,): where, the answer, the certified one and its error bar.
    """

    column: Column
    heading: str
    abscissa: Field
    given: Field
    certified: Field
    bar: Field

    @property
    def in_bars(self) -> Field:
        """Deviation over the error bar, shape (n,)."""
        return (self.given - self.certified) / self.bar

    @property
    def relative(self) -> Field:
        """Deviation over the certified value, shape (n,); 0 where both are 0."""
        apart = self.given - self.certified
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(apart == 0, 0.0, apart / np.abs(self.certified))

    @property
    def verdict(self) -> Verdict:
        """Of all places together; the tolerance is that of the problem, beyond the error bars."""
        apart = np.abs(self.given - self.certified)
        if (apart <= self.bar).all():
            return "within the error bars"
        allowed = self.bar + self.column.tolerance * np.abs(self.certified)
        return "within the tolerance" if (apart <= allowed).all() else "off"

    @property
    def worst(self) -> str:
        """Where it deviates most in error bars, and by how much; and the tolerance."""
        at = np.argmax(np.abs(self.in_bars))
        apart = f"{self.in_bars[at]:+.3g} bars, {100 * self.relative[at]:+.2g} %"
        return f"worst at {self.abscissa[at]:.6g}: {apart}; tolerance {100 * self.column.tolerance:g} %"


@dataclass(frozen=True, eq=False)
class Score:
    """A result held against the certified answer.

    Attributes
    ----------
    problem
        Which problem.
    quantities
        Those that the result has.
    missing
        Headings of those that it has not.
    places, asked
        How many places of the answer the result has, and how many there are.
    """

    problem: Problem
    quantities: tuple[QuantityScore, ...]
    missing: tuple[str, ...]
    places: int
    asked: int

    @property
    def agrees(self) -> bool:
        """Whether all that is asked is there, and within the tolerance."""
        complete = not self.missing and self.places == self.asked
        return complete and all(one.verdict != "off" for one in self.quantities)

    def rows(self) -> list[Row]:
        """The verdict on each quantity, with the place that is worst in error bars; and on all."""
        judged = [Row(one.column.heading, one.verdict, note=f"; {one.worst}") for one in self.quantities]
        judged += [Row(name, "not given") for name in self.missing]
        good = sum(one.verdict != "off" for one in self.quantities)
        total = f"{good} of {counted(len(self.problem.asked), 'quantity', 'quantities')} agree"
        total += f" at {self.places} of {self.asked} places"
        verdict = "agrees" if self.agrees else "does not agree"
        return [*judged, Row(self.problem.name, verdict, note=f"; {total}")]

    def table(self) -> pd.DataFrame:
        """What was given and certified, with error bar and deviation: a row for each quantity and place."""
        place, names = self.problem.abscissa.heading, ("given", "certified", "bar", "in_bars", "relative")
        tables = (
            {"quantity": one.heading, place: one.abscissa, **{name: getattr(one, name) for name in names}}
            for one in self.quantities
        )
        return pd.concat(map(pd.DataFrame, tables), ignore_index=True)


def score(result: str | Path | Mapping[str, ArrayLike], name: str | None = None) -> Score:
    """Compare a result with the certified answer of a reference problem.

    Parameters
    ----------
    result
        A table in a text file, such as the ``aging.csv`` of a run, or columns by their headings. Columns
        and rows that are not asked are left alone; of several rows of one time or load the last counts.
    name
        The problem; by default what the file says in a line ``# problem: NAME``.

    Raises
    ------
    InputError
        The problem is not named, a column is missing or no number, or no row is one of the problem's.
    """
    asked = None if name is None else problem(name)
    if isinstance(result, Mapping):
        where, columns = "result", {key: _column(key, value) for key, value in result.items()}
        if not columns:
            raise InputError("result", expected="columns", got="none", advice=_EXAMPLE)
        lengths = {len(values) for values in columns.values()}
        if len(lengths) != 1:
            raise InputError("result", expected="columns of one length", got=sorted(lengths))
    else:
        try:
            path = Path(result)
        except TypeError as error:
            expected, got = "a file, or columns by their headings", type(result).__name__
            raise InputError("result", expected=expected, got=got, advice=_EXAMPLE) from error
        where = str(path)
        table = read_table(path)
        columns = dict(zip(table.names, table.values.T, strict=True))
        match = _NAMED.search(path.read_text(encoding="utf-8", errors="replace"))
        if asked is None and match:
            asked = problem(match[1])
    if asked is None:
        expected = "the name of the problem, in a line '# problem: NAME' of the file"
        raise InputError(where, expected=expected, got="none", advice="--problem NAME")
    return _compared(asked, columns, where)


def _column(name: str, values: ArrayLike) -> Field:
    """Numbers of a column, of which some may be missing further on; `InputError` for anything else."""
    try:
        array = np.asarray(values)
        array = array.astype(np.float64) if array.dtype.kind in "iufO" else np.empty(())
    except (TypeError, ValueError):
        array = np.empty(())
    if array.ndim != 1:
        raise InputError(name, expected="real numbers in a row", got=type(values).__name__)
    return array


def _compared(asked: Problem, columns: Mapping[str, Field], where: str) -> Score:
    place, answer = asked.abscissa.heading, asked.answer
    headings = {
        column.name: next((name for name in column.headings if name in columns), "") for column in asked.asked
    }
    if place not in columns or not any(headings.values()):
        wanted = ", ".join(column.heading for column in asked.asked)
        expected = f"one of the columns {wanted}" if place in columns else f"the columns {place}, {wanted}"
        got = ", ".join(filter(None, columns)) or "no names"
        raise InputError(where, expected=expected, got=got, advice=f"the form {asked.name}/answer.csv")
    rows = _rows(columns[place], answer.abscissa)
    present = np.flatnonzero(rows >= 0)
    if not present.size:
        places = ", ".join(f"{x:g}" for x in answer.abscissa)
        got = f"{len(columns[place])} rows with others"
        raise InputError(where, expected=f"rows with {place} of {places}", got=got)
    quantities = []
    for column in asked.asked:
        if heading := headings[column.name]:
            values = columns[heading][rows[present]]
            if not np.isfinite(values).all():
                at = answer.abscissa[present[np.argmin(np.isfinite(values))]]
                expected = f"a number for {heading} at {place} = {at:g}"
                raise InputError(where, expected=expected, got="none, or no finite one")
            answered = (answer.values[column.name][present], answer.bars[column.name][present])
            quantities.append(QuantityScore(column, heading, answer.abscissa[present], values, *answered))
    missing = tuple(column.heading for column in asked.asked if not headings[column.name])
    return Score(asked, tuple(quantities), missing, present.size, answer.abscissa.size)


def _rows(given: Field, wanted: Field) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """The last row of the result at each place of the answer; -1 where there is none."""
    same = np.abs(given[None, :] - wanted[:, None]) <= _SAME * np.abs(wanted[:, None])
    last = given.size - 1 - np.argmax(same[:, ::-1], axis=1)
    return np.where(same.any(axis=1), last, -1)
