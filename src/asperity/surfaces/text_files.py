"""Text files: matrices of heights, profiles and points, with the headers that programs write.

Comments, blank lines and lines that begin with a word separate blocks of numbers. Each block is a channel.
Its header may state name, size, unit and undefined value.
"""

from __future__ import annotations

import contextlib
import dataclasses
import re
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from asperity.base.readable import conversion, is_length
from asperity.base.words import shortened
from asperity.errors import MissingExtraError, SurfaceFileError
from asperity.sheets.columns import Columns, Role, normal
from asperity.sheets.tables import Table, read_table, text_of
from asperity.surfaces import points
from asperity.surfaces.instruments import read_instrument
from asperity.surfaces.prepare import spelled
from asperity.surfaces.raw import FIRST_LINE, LARGEST_Y, RawSurface, choose, without

_WORD = re.compile(r"[\"'\[]?(?!(?:nan|na|n/a|null|inf|infinity)\b)[^\W\d_]|\*+$", re.IGNORECASE)
_NUMBER = r"([-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:e[-+]?\d+)?|nan)"
_KEYWORDS = ("ncols", "nrows", "cellsize", "dx", "dy", "nodata_value")  # of ESRI's grids
_FACTS = {
    name: re.compile(rf"[#%\s]*{fact}", re.IGNORECASE)
    for name, fact in {
        # Labels of Gwyddion's export in three languages.
        "channel": r"(?:channel|kanal|canal)\s*[:=]\s*(.+)",
        "width": rf"(?:width|breite|largeur)\s*[:=]\s*{_NUMBER}\s*(\S*)",
        "height": rf"(?:height|höhe|hauteur)\s*[:=]\s*{_NUMBER}\s*(\S*)",
        "unit": r"(?:value units|einheiten|unités)\s*[:=]\s*(\S*)",
        "length_unit": r"lateral units\s*:\s*(\S*)",
        **{name: rf"{name}\s+{_NUMBER}\s*$" for name in _KEYWORDS},
        "corner": rf"[xy]ll(?:corner|center)\s+{_NUMBER}\s*$",
    }.items()
}
_SDF = re.compile(r"[ab](ISO|BCR)-\d")
_MEASURES = re.compile("unit|scale|einheit|pixel|size|resolution|length", re.IGNORECASE)
_DOWNWARD = re.compile("depth|tiefe|profond")
_AXES = (
    Role("", "", r"\bstd|\berr|uncert|mask|valid"),
    Role("y", "m", r"^y\d?\b|position y\b|y.?position"),
    Role("x", "m", r"^x\b|position|lateral|distance|length|lange|weg\b|longueur"),
    Role("z", "m", r"^[zh]\d?\b|raw|height|profile?|topography|hohe|hauteur|depth|tiefe|profond"),
)


@dataclass
class _Block:
    """Lines of numbers, from the `first` to before the `end`, and the header around them."""

    first: int
    end: int
    header: list[str]

    def fact(self, name: str) -> list[str]:
        """A fact of the header: its value, and its unit if it may have one; empty if it is not there."""
        matches = (_FACTS[name].match(line) for line in self.header)
        return next(([part or "" for part in match.groups()] for match in matches if match), [])

    @property
    def strange(self) -> list[str]:
        """Lines of the header without a known fact."""
        return [line for line in self.header if not any(fact.match(line) for fact in _FACTS.values())]


def read_text(path: Path, channel: str | int | None) -> RawSurface:
    """Read heights from text: a matrix, a profile, or points x, y, z; see `read_table` for the numbers."""
    lines = text_of(path, SurfaceFileError).split("\n")
    blocks = _blocks(lines)
    if any(map(_SDF.match, blocks[0].header)) and (raw := _by_library(path, channel)):
        return raw
    blocks = _joined(path, lines, blocks)
    tables = [_table(path, lines, block) for block in blocks]
    strange = [line for block in blocks for line in block.strange if not all(map(_roles, tables))]
    words = [line for line in strange if line[0] not in "#%"]
    other = len(blocks) == 1 and (words or any(map(_MEASURES.search, strange)))
    if other and (raw := _by_library(path, channel)):
        return raw
    if words:
        number = 1 + [line.strip() for line in lines].index(words[0])
        expected = f"only numbers, or a header of a known kind, in line {number}"
        advice = "a # before header lines, and NaN for undefined pixels"
        raise SurfaceFileError(str(path), expected=expected, got=repr(shortened(words[0], 60)), advice=advice)
    rows, others = {}, []
    titles = [shortened("".join(block.fact("channel")), 40) for block in blocks]
    labels = [title or "matrix" * (len(blocks) > 1) for title in titles]
    for name, table, block in zip(_distinct(labels), tables, blocks, strict=True):
        unit = "".join(block.fact("unit"))
        if unit and not is_length(spelled(unit)):
            others.append(f"{name!r} in {unit}")
            continue
        rows[name] = table, block
    if not rows:
        raise SurfaceFileError(str(path), expected="heights in a unit of length", got=", ".join(others))
    if "" in rows:
        return _surface(path, *rows[""], channel)
    name = choose(str(path), channel, {each: table.values.shape for each, (table, _) in rows.items()})
    return dataclasses.replace(_surface(path, *rows[name], None), channel=name, channels=tuple(rows))


def _distinct(names: list[str]) -> list[str]:
    """Names of channels, those that occur more than once with a number."""
    numbers = [names[:i].count(name) for i, name in enumerate(names, 1)]
    numbered = zip(names, numbers, strict=True)
    return [f"{name}#{number}" if names.count(name) > 1 else name for name, number in numbered]


def _by_library(path: Path, channel: str | int | None) -> RawSurface | None:
    """Read by the optional library, which knows other headers; None unless it finds unit and size."""
    with contextlib.suppress(SurfaceFileError, MissingExtraError):
        raw = read_instrument(path, channel, ("sdf", "bcr", "asc", "xyz"))
        return raw if raw and raw.unit != "1" and raw.pixel_size is not None else None
    return None


def _blocks(lines: list[str]) -> list[_Block]:
    """Separate the blocks of numbers."""
    blocks: list[_Block] = []
    header: list[str] = []
    apart = True
    for number, line in enumerate(map(str.strip, lines)):
        if not line and "\t" in lines[number]:
            continue  # a row of missing cells
        if not line or line[0] in "#%" or _WORD.match(line):
            apart = True
            header += filter(None, [line])
        elif apart:
            blocks.append(_Block(number, number + 1, header))
            header, apart = [], False
        else:
            blocks[-1].end = number + 1
    if not blocks:
        return [_Block(0, 0, [])]
    blocks[-1].header += header
    return blocks


def _joined(path: Path, lines: list[str], blocks: list[_Block]) -> list[_Block]:
    """Join blocks if blank lines separate the lines of one matrix, or the points of one list."""
    whole = _Block(blocks[0].first, blocks[-1].end, [line for block in blocks for line in block.header])
    apart = len(blocks) > 1 and any(block.end - block.first > 1 for block in blocks)
    if apart and len(re.split(r"[\s,;]+", lines[whole.first].strip())) == 3:
        apart = not points.are_points(_table(path, lines, whole).values)
    return blocks if apart else [whole]


def _table(path: Path, lines: list[str], block: _Block) -> Table:
    """Read the numbers of a block; the last two lines above them may name the columns and their units."""
    rows = ["" if _WORD.match(row.strip()) else row for row in lines[block.first : block.end]]
    shown = [""] * block.first
    above = (number for number in range(block.first - 1, -1, -1) if lines[number].strip())
    for number in islice(above, 2) if block.header else ():
        shown[number] = f"# {lines[number].strip().lstrip('#% ')}"
    return read_table(path, matrix=True, text="\n".join(shown + rows), failure=SurfaceFileError)


def _roles(table: Table) -> list[tuple[str, str | None]]:
    """Roles of the columns by their names, and their units, None for one that is no length.

    Empty unless x and heights are among them; without z, y are the heights.
    """
    if not any(table.names):
        return []
    columns = Columns(table, _AXES)
    stand_in = {} if "z" in columns.roles else {"y": "z"}
    roles = [stand_in.get(role, role) for role in columns.roles]
    for at in (at for at, role in enumerate(roles) if role == "z"):
        others = columns.scaled(at) or ["a logarithm"] * (at in columns.logarithms)
        if others or _DOWNWARD.search(normal(table.names[at])):
            got = f"{table.names[at]!r}, with {others[0]}" if others else f"the depths {table.names[at]!r}"
            raise SurfaceFileError(table.name, expected="a column of heights, upward", got=got)
    units = [spelled(columns.unit_text(at)) for at in range(len(roles))]
    understood = [unit if unit == "1" or is_length(unit) else None for unit in units]
    return list(zip(roles, understood, strict=True)) if {"x", "z"} <= set(roles) else []


def _surface(path: Path, table: Table, block: _Block, channel: str | int | None) -> RawSurface:
    """Heights of a block; channels are the columns of heights beside the same coordinates."""
    unit = spelled("".join(block.fact("unit")))
    raw = RawSurface(table.values, "text", unit=unit, orientation=FIRST_LINE)
    if void := block.fact("nodata_value"):
        heights, rule = without(raw.heights, _number(void), "NODATA_value", " in the header")
        raw = dataclasses.replace(raw, heights=heights, undefined_by=(rule,))
    strange = [] if _roles(table) else list(filter(_MEASURES.search, block.strange))
    if strange:
        remark = f"not understood in the header: {', '.join(strange)}"
        raw = dataclasses.replace(raw, remarks=(shortened(remark, 120),))
    return _points(path, raw, table, block, channel) or _matrix(path, raw, block)


def _points(
    path: Path, raw: RawSurface, table: Table, block: _Block, channel: str | int | None
) -> RawSurface | None:
    """Heights of points on their grid, if names or values of columns are those of coordinates; else None."""
    used, units = points.coordinates(raw.heights, sure=path.suffix.lower() == ".xyz"), ["1", "1"]
    if roles := _roles(table):
        at = {role: [i for i, (each, _) in enumerate(roles) if each == role] for role in "xyz"}
        names = dict(zip(_distinct([table.names[i] for i in at["z"]]), at["z"], strict=True))
        name = choose(str(path), channel, {each: f"column {i + 1}" for each, i in names.items()})
        used = [*at["x"][:1], *at["y"][:1], names[name]]
        lengths = [roles[i][1] for i in used]
        units = [unit for unit in lengths if unit is not None]
        if units != lengths or len(set(units[:-1])) > 1:
            expected, got = "lengths, x and y in the same unit", ", ".join(map(repr, table.names))
            raise SurfaceFileError(str(path), expected=expected, got=got)
        raw = dataclasses.replace(raw, channel=name, channels=tuple(names)) if len(names) > 1 else raw
    elif channel is not None:
        choose(str(path), channel, {})
    if not used:
        return None
    heights, size = points.grid_of(str(path), raw.heights[:, used])
    others = ", ".join(str(i + 1) for i in range(raw.heights.shape[1]) if i not in used)
    length_unit = spelled("".join(block.fact("length_unit"))) if units[0] == "1" else units[0]
    return dataclasses.replace(
        raw,
        heights=heights,
        format="xyz",
        unit=raw.unit if units[-1] == "1" else units[-1],
        pixel_size=size,
        length_unit=None if length_unit == "1" else length_unit,
        orientation=FIRST_LINE if heights.ndim == 1 else LARGEST_Y,
        size_from="its coordinates",
        remarks=(*raw.remarks, *[f"left out column {others}"] * bool(others)),
    )


def _matrix(path: Path, raw: RawSurface, block: _Block) -> RawSurface:
    """Separate labels of lines and columns from heights, and find the size of the pixels."""
    heights, *labels = points.without_labels(raw.heights)
    remarks, steps = list(raw.remarks), []
    for each, direction in zip(labels, ("lines", "columns"), strict=True):
        if each is not None:
            step = 0.0 if points.are_numbers(each) else abs(points.even_step(each) or 0)
            steps.append(step)
            first = ", ".join(f"{label:g}" for label in each[:3])
            remarks.append(f"left out the numbers {first}, ... of the {direction}")
    size, length_unit = _size(path, heights.shape, block)
    if size is None and heights.shape[1] == 3 and heights.shape[0] > 3:
        remarks.append("three columns, taken as pixels; points x, y, z are read from files named .xyz")
    if size is None and len(steps) == 2 and all(steps):
        size, raw = (steps[0], steps[1]), dataclasses.replace(raw, size_from="its coordinates")
    return dataclasses.replace(
        raw, heights=heights.copy(), pixel_size=size, length_unit=length_unit, remarks=tuple(remarks)
    )


def _size(path: Path, shape: tuple[int, ...], block: _Block) -> tuple[tuple[float, ...] | None, str | None]:
    """Distance between rows and between columns by the header, and its unit."""
    stated = [block.fact(name) for name in ("nrows", "ncols")]
    if any(each and _number(each) != n for each, n in zip(stated, shape, strict=True)):
        expected = f"{' x '.join(each[0] if each else '?' for each in stated)} numbers, as the header says"
        raise SurfaceFileError(str(path), expected=expected, got=" x ".join(map(str, shape)))
    cell = block.fact("cellsize")
    if (down := block.fact("dy") or cell) and (across := block.fact("dx") or cell):
        return (_number(down), _number(across)), None
    height, width = (block.fact(side) for side in ("height", "width"))
    if not (height and width):
        return None, None
    unit, other = spelled(height[1]), spelled(width[1])
    factor = 1.0 if unit == other else conversion(other, unit)
    if factor is None or not (is_length(unit) or unit == "1"):
        got = f"{' '.join(width)} and {' '.join(height)}"
        raise SurfaceFileError(str(path), expected="a width and a height in units of length", got=got)
    size = _number(height) / shape[0], factor * _number(width) / shape[1]
    return size, None if unit == "1" else unit


def _number(fact: list[str]) -> float:
    return float(fact[0].replace(",", "."))
