"""Tables on the terminal."""

from __future__ import annotations

from collections.abc import Sequence

from asperity.errors import printable

Row = tuple[str, str]


def aligned(rows: Sequence[Sequence[str]]) -> str:
    """Align rows as a table of plain text; a row of one cell is a heading."""
    columns = max(len(row) for row in rows)
    widths = [max((len(row[i]) for row in rows if i < len(row) > 1), default=0) for i in range(columns)]
    lines = []
    for row in rows:
        cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=False)]
        lines.append("  ".join(cells).rstrip())
    return printable("\n".join(lines))


def table_row(name: str, table: Sequence[Sequence[str]]) -> list[Row]:
    """Rows of a table within another, of which the first has the name."""
    return [(name * (number == 0), line) for number, line in enumerate(aligned(table).splitlines())]
