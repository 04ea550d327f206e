"""Rows of a summary, which terminal, cards and page only format."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from asperity.base.readable import in_unit, written
from asperity.base.words import UNKNOWN, to_error, uncertain
from asperity.errors import printable


@dataclass(frozen=True)
class Row:
    """A named value with its unit, or words; its standard error, its 95 % interval, and a note.

    With error or interval all numbers are in one unit, to the decimals that the two digits of the error have.
    """

    name: str
    value: float | str
    unit: str = "1"
    interval: tuple[float, float] | None = None
    note: str = ""
    digits: int = 8
    brief: bool = False
    """Whether a card shows it, too."""
    error: float = 0.0
    at_least: bool = False
    """Whether such intervals hold the truth in 95 % of cases or more, not in just as many."""

    def words(self, spelled: Callable[[str], str] = str) -> str:
        """Value, interval and note; `spelled` formats a plain "2 um" for a medium."""
        if isinstance(self.value, str):
            return self.value + self.note
        if self.interval is None and not self.error:
            return spelled(written(self.value, self.unit, self.digits)) + self.note
        unit, factor = in_unit(self.value, self.unit)
        low, high = self.interval or (math.nan, math.nan)
        error = factor * (self.error or (high - low) / 4)
        number, *ends = to_error([factor * one for one in (self.value, low, high)], error)
        number = uncertain(factor * self.value, error) if self.error else number
        between = UNKNOWN if math.isnan(low) else " to ".join(ends)
        ends_in_words = f" ({'at least ' * self.at_least}95 %: {between})" * bool(self.interval)
        return spelled(f"{number} {unit}".rstrip()) + ends_in_words + self.note


def words_of(rows: Iterable[Row]) -> list[tuple[str, str]]:
    """Rows as pairs of a name and plain words."""
    return [(row.name, row.words()) for row in rows]


def remarks(*texts: str) -> list[Row]:
    """Rows of remarks."""
    return [Row("remark", text) for text in texts]


def aligned(table: Sequence[Sequence[str]]) -> str:
    """Align a table as plain text; a row of one cell is a heading."""
    columns = max(len(row) for row in table)
    widths = [max((len(row[i]) for row in table if i < len(row) > 1), default=0) for i in range(columns)]
    lines = []
    for row in table:
        cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=False)]
        lines.append("  ".join(cells).rstrip())
    return printable("\n".join(lines))


def table_rows(name: str, table: Sequence[Sequence[str]]) -> list[Row]:
    """Rows of a table within another, of which the first has the name."""
    return [Row(name * (number == 0), line) for number, line in enumerate(aligned(table).splitlines())]
