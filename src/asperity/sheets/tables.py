"""Tables of numbers in text files with any separator, header and comments.

Columns are separated by semicolons, tabs, commas or blanks, and numbers may have decimal commas: of these
possibilities, the first that reads most cells as numbers: of a matrix in its first lines, else in the last,
as metadata may come first. (The sniffer of Python's csv module knows no decimal commas, and pandas does not
say in which line a cell is wrong.) A cell may stand in double quotes. What follows a # is a comment.
"""

from __future__ import annotations

import csv
import functools
import math
import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from asperity.base.files import content_of, expanded
from asperity.base.units import is_usual
from asperity.errors import InputError

# A comma separates cells unless something else does, or the cells are quoted.
_DIALECTS = tuple((separator, decimal) for separator in (";", "\t", ",", " ") for decimal in (".", ","))
_LOOKED_AT = 100  # lines, and first cells of each, by which the separator is found
_ONE_COLUMN = 0.01  # weight of a line of one cell: numbers in two columns or more are preferred

_OF_EXCEL = re.compile(r"\"?sep=(.)\"?\s*")  # its first line, which states the separator
_IN_BRACKETS = re.compile(r"[^\[\]()]*[\[(][^\[\]()]*[\])]")  # a name and its unit

_FACT = re.compile(r"(?i)(?:(columns?|names?|spalten|colonnes|units?|einheiten|unit[eé]s)|[\w.-]+):\s+(.*)")

# In "Rec #;Time (s)" it ends a name, in "Area #1" it counts, and #DIV/0! is a cell of a spreadsheet.
_COMMENT = re.compile(r"#(?![;,\t\d]|[A-Z/0?]+[!?]|N/A|NV)")
# A header and the first row: "Voltage (V)41.3".
_GLUED = re.compile(r"(?<=[^\W\d_][\])])(?=[+-]?\d+\.?\d*\t)")
_MISSING = ("", "nan", "na", "n/a", "null", "#n/a", "#nv")  # in letters of any size

_WHOLE = re.compile(r"[+-]?[1-9]\d{0,2}")
GROUPED = re.compile(r"[+-]?[1-9]\d{0,2}([,.' ]\d{3})+([.,]\d*)?")
"""A number that seems to have separators between thousands."""


def with_unit(name: str, unit: str) -> str:
    """Head a column: ``load_N``, ``contact_area_m2``, and a pure number by its name alone."""
    spelled = unit.replace("^", "").replace("/", "_per_")
    return name if unit == "1" else f"{name}_{spelled}"


@dataclass(frozen=True, eq=False)
class Table:
    """The numbers of a text file, whose `name` is for messages.

    `names` of columns are "" where it has no header, and `units` where no row of units follows it; `values`,
    shape (rows, columns), are NaN where a cell is missing or no number; `lines` are the number, from 1, and
    the text of each row without comments; `separator` is " " for any blanks.
    """

    name: str
    names: list[str]
    units: list[str]
    values: NDArray[np.float64]
    lines: list[tuple[int, str]]
    separator: str

    def cell(self, row: int, column: int) -> str:
        """Text of a cell; "" where the row ends before it."""
        return "".join(_cells(self.lines[row][1], self.separator)[column : column + 1])


def read_table(
    path: Path, *, matrix: bool = False, text: str | None = None, failure: type[InputError] = InputError
) -> Table:
    """Read a table of numbers: text in UTF-8, in UTF-16 with its mark, or in Latin-1.

    Of a `matrix`, each line but comments, which begin with # or %, is a row of as many numbers as the
    first has; an empty cell, NaN or NA is a missing one. Else there are two columns or more; lines
    beginning with ; are comments too; cells may hold words; the last cells of a row may be left out; rows of
    empty cells are skipped. The header is the last line before the rows that has as many cells and no number,
    and a row of units may follow it; lines above are metadata. `text` stands for the content of the file.

    Raises the `failure`, with the number of the line that is wrong, if there is no such file or no such
    table.
    """
    path = expanded(path)
    fail = functools.partial(failure, str(path))
    everything = (text_of(path, failure) if text is None else text).split("\n")
    lines, notes = _separated(everything, ("#", "%") if matrix else ("#", "%", ";"))
    stated = None if matrix else _OF_EXCEL.fullmatch(everything[0])
    lines = [(number, line) for number, line in lines if number > 1 or not stated]
    looked_at = [line for _, line in lines if line.strip()]
    looked_at = looked_at[:_LOOKED_AT] if matrix else looked_at[-_LOOKED_AT:]
    dialects = _DIALECTS if matrix else _dialects(looked_at, stated[1] if stated else "")
    shares = [_numeric_share(looked_at, *dialect) for dialect in dialects]
    best = int(np.argmax(shares))
    separator, decimal = dialects[best]
    if not matrix or decimal == ",":
        _check_decimals(lines, separator, decimal, fail)
    # A line of nothing but tabs is a row of missing cells where tabs separate; of nothing but blanks, no row.
    lines = [(number, line) for number, line in lines if line.strip() or (separator == "\t" and "\t" in line)]
    if not lines:
        wanted, got = ("a matrix", "no number at all") if matrix else ("a table", "no line besides comments")
        raise fail(expected=f"{wanted} of numbers", got=got)
    first, header, width = 0, -1, len(_cells(lines[0][1], separator))
    if not matrix:
        if shares[best] <= _ONE_COLUMN:
            got = "one" if shares[best] else f"{lines[-1][1].strip()[:40]!r}"
            raise fail(expected="two columns of numbers or more", got=got)
        first, header, width = _beginning([line for _, line in lines], looked_at, separator, decimal)
    if not matrix and separator == "," and header >= 0 and 2 * len(_cells(lines[header][1], ",")) == width:
        number, line = lines[first]
        expected = f"semicolons or tabs between numbers with decimal commas, in line {number}"
        raise fail(expected=expected, got=f"{line.strip()[:60]!r}")
    rows = [(number, line) for number, line in lines[first:] if matrix or any(_cells(line, separator))]
    values = np.full((len(rows), width), math.nan)
    used = 1  # columns up to the last that has cells: some programs end every row with separators
    for row, (number, line) in enumerate(rows):
        cells = _cells(line, separator)
        if len(cells) > width or (matrix and len(cells) < width):
            raise fail(expected=f"{width} columns in line {number}, as before", got=f"{line.strip()[:60]!r}")
        numbers = _numbers(cells, decimal)
        if matrix and None in numbers:
            got = repr(cells[numbers.index(None)][:40])
            advice = "a # before header lines, and NaN for undefined pixels"
            raise fail(expected=f"only numbers in line {number}", got=got, advice=advice)
        values[row, : len(cells)] = numbers  # numpy makes NaN of None
        used = next((count for count in range(len(cells), used, -1) if cells[count - 1]), used)
    # numpy and many instruments write the names as a comment: the last before the numbers.
    above = [note for number, note in notes if number < lines[first][0]]
    _check_one_block(notes[len(above) :], fail)
    headers = [line for _, line in reversed(lines[: header + 1])]
    headers += [_of_note(note, separator, decimal) for note in reversed(above)]
    names, in_row = _names([_named(line, separator, used, width) for line in headers], width)
    kept = max((at for at, name in enumerate(names, 1) if name), default=0)
    # Several empty columns without names are pixels that are undefined.
    kept = max(kept, width if matrix and not kept and used < width - 1 else used)
    return Table(str(path), names[:kept], in_row[:kept], values[:, :kept], rows, separator)


def _dialects(lines: list[str], stated: str) -> Sequence[tuple[str, str]]:
    """Separators and decimal marks that these lines may have: the stated one, and no blanks beside tabs.

    Where tabs stand in most lines, and no blanks between numbers, blanks stand in words.
    """
    tabbed = [line for line in lines if "\t" in line.strip(" ")]
    by_tabs = 2 * len(tabbed) > len(lines) and not any(re.search(r"\d +[-+.\d]", line) for line in tabbed)
    left_out = " " if by_tabs else ""
    return [one for one in _DIALECTS if one[0] != left_out and stated in ("", one[0])] or _DIALECTS


def _separated(
    everything: list[str], comments: tuple[str, ...]
) -> tuple[list[tuple[int, str]], list[tuple[int, str]]]:
    """Number and text of the lines without comments, and of the lines that are comments, without marks."""
    lines, notes = [], []
    begun = ";" in comments and any(line[:1] == ";" for line in everything)  # perhaps by an empty first cell
    counts = Counter(line.count(";") for line in everything if begun and not line.startswith(comments))
    cells = counts.most_common(1)[0][0] if counts else 0
    for number, line in enumerate(everything, 1):
        is_row = cells and line[:1] == ";" and line.count(";") == cells
        if not is_row and line.lstrip().startswith(comments):
            notes.append((number, line.lstrip(" \t#%;")))
        else:
            line = _COMMENT.split(line, 1)[0] if "#" in line else line
            lines += [(number, part) for part in (_GLUED.split(line, 1) if "\t" in line else [line])]
    return lines, notes


def _check_decimals(
    lines: list[tuple[int, str]], separator: str, decimal: str, fail: Callable[..., InputError]
) -> None:
    """Refuse marks of which each may be a decimal one, or one between thousands.

    Commas decide for all columns. All points of English numbers may stand before three digits, but not beside
    500 or 1 in one column, which lack them.
    """
    if decimal == "." and separator not in ";\t":
        return  # where blanks or commas separate, points are decimal
    text, settled = "\n".join(line for _, line in lines), set[int | None]()
    for found in re.finditer(rf"\{decimal}\d{{3}}(?= *(?:[;\t \n]|$))", text):
        row = text.rfind("\n", 0, found.start()) + 1
        cell = text[max(text.rfind(separator, 0, found.start()) + 1, row) : found.end()].strip()
        column = None if decimal == "," else text.count(separator, row, found.start())
        if column in settled or not GROUPED.fullmatch(cell):
            continue
        if _is_ambiguous(lines, separator, decimal, column):
            number, _ = lines[text.count("\n", 0, row)]
            expected = f"a decimal mark or one between thousands, in line {number}"
            advice = "decimal points, or no separators between thousands"
            raise fail(expected=expected, got=repr(cell), advice=advice)
        settled.add(column)


def _is_ambiguous(lines: list[tuple[int, str]], separator: str, decimal: str, column: int | None) -> bool:
    """Whether all marks of a column, or by None of the table, stand before three digits."""
    whole = False
    for _, line in lines:
        cells = _cells(line, separator)
        for cell in cells if column is None else cells[column : column + 1]:
            if decimal not in cell:
                whole |= _WHOLE.fullmatch(cell) is not None
            elif _number(cell, decimal) is not None and not GROUPED.fullmatch(cell):
                return False
    return whole or column is None


def _beginning(lines: list[str], rows: list[str], separator: str, decimal: str) -> tuple[int, int, int]:
    """Lines of first row and header (-1 for none), and cells of a row, from some of the rows."""

    def shape(line: str) -> tuple[int, float]:
        cells = _cells(line, separator)
        others = [cell for cell in cells if cell not in ("", "1", "-")]
        is_row_of_units = bool(others) and all(map(is_usual, others))
        return len(cells), 0.0 if is_row_of_units else _share(cells, decimal)

    numeric = [(cells, share) for cells, share in map(shape, rows) if share]
    width = Counter(cells for cells, _ in numeric).most_common(1)[0][0]
    usual = float(np.median([share for cells, share in numeric if cells == width]))
    shapes = []
    for line in lines:
        shapes.append(shape(line))
        if shapes[-1][0] == width and shapes[-1][1] >= usual:
            break
    named = [at for at, pair in enumerate(shapes) if pair == (width, 0.0) and lines[at].strip(separator)]
    first = next(at for at, (_, share) in enumerate(shapes) if share and at > max(named, default=-1))
    return (first, named[-1], width) if named else (first, first - 1, shapes[first][0])


def _check_one_block(notes: list[tuple[int, str]], fail: Callable[..., InputError]) -> None:
    """Refuse comments after the first row of which one names columns again."""
    for number, note in notes:
        if (fact := _FACT.fullmatch(note)) and fact[1]:
            got = f"another with a header in line {number}"
            raise fail(expected="one block of numbers", got=got, advice="a file of one of them")


def _of_note(line: str, separator: str, decimal: str) -> str:
    """The part of a comment that may name columns or units: no other fact, and nothing with a number."""
    fact = _FACT.fullmatch(line)
    line = line if fact is None else fact[2] if fact[1] else ""
    return "" if _share(_cells(line, separator), decimal) else line


def _names(headers: list[list[str]], width: int) -> tuple[list[str], list[str]]:
    """Names of the columns, and units from a row between names and numbers."""
    names, *above = [cells for cells in headers if len(cells) == width and any(cells)] or [[""] * width]
    # A name may be a letter that is a unit, too; but not all names, and no longer unit.
    sure = any(is_usual(cell) for cell in names if len(cell) > 1 or cell == "-") or "1" in names
    if above and (sure or all(map(is_usual, names))):
        return above[0], [cell.strip("[](){}<> ") for cell in names]
    return names, [""] * width


def _named(line: str, separator: str, used: int, width: int) -> list[str]:
    """Cells of a header, padded; among blanks a unit in brackets belongs to the name before it."""
    cells = _cells(line, separator)
    if separator == " " and len(cells) != width:
        cells = [cell.strip() for cell in _IN_BRACKETS.findall(line)]
    is_whole = len(cells) == width  # the last one of a row of units may be empty
    while cells and not cells[-1]:
        cells.pop()
    cells += [""] * (width - len(cells)) * (is_whole or len(cells) >= used)
    return [cell[1:-1] if re.fullmatch("'.*'", cell) else cell for cell in cells]


def text_of(path: Path, failure: type[InputError] = InputError) -> str:
    """Content of a text file, its lines ended by a newline; raises the `failure` where there is none."""
    fail = functools.partial(failure, str(path))
    if path.is_dir() or not path.exists():
        got = "a folder" if path.is_dir() else "no such file"
        raise fail(expected="a file with a table of numbers", got=got)
    content = content_of(path)
    wide = content.startswith((b"\xff\xfe", b"\xfe\xff"))
    try:
        text = content.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")  # a µ of another age, in a header
    if "\0" in text:
        raise fail(expected="text", got="binary data", advice="exporting it as CSV")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _cells(line: str, separator: str) -> list[str]:
    if separator == " ":
        line = " ".join(line.split())
    cells = line.split(separator)
    if '"' in line:
        try:
            cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True))
        except csv.Error:  # a cell beyond the module's limit, which is no number
            return [line]
    return [cell.strip() for cell in cells]


def _numbers(cells: list[str], decimal: str) -> list[float | None]:
    """Numbers in cells: NaN for a missing one, None for one that is no number."""
    if decimal == ".":
        try:
            return [float(cell) for cell in cells]
        except ValueError:
            pass
    return [_number(cell, decimal) for cell in cells]


def _number(cell: str, decimal: str) -> float | None:
    if cell.lower() in _MISSING:
        return math.nan
    if decimal == "," and "." in cell:
        return None
    try:
        return float(cell.replace(decimal, "."))
    except ValueError:
        return None


def _numeric_share(lines: list[str], separator: str, decimal: str) -> float:
    head = [_cells(line, separator)[:_LOOKED_AT] for line in lines]
    # Quoted numbers between commas: "1,438" is one and a half, or a thousand and more. Other cells tell.
    commas = [cell for cells in head for cell in cells if "," in cell]
    if separator == decimal and all(map(GROUPED.fullmatch, commas)):
        return 0.0
    shares = [_share(cells, decimal) * (1 if len(cells) > 1 else _ONE_COLUMN) for cells in head]
    return float(np.mean(shares)) if shares else 0.0


def _share(cells: list[str], decimal: str) -> float:
    present = [cell for cell in cells if cell.lower() not in _MISSING]
    return sum(_number(cell, decimal) is not None for cell in present) / max(len(present), 1)
