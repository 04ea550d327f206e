"""The rooms of the source and who imports whom, drawn as a graph and listed."""

import ast
from itertools import pairwise
from pathlib import Path

import asperity

SOURCE = Path(asperity.__file__).parent
WIDTH, HEIGHT, STEP, CHARACTER, GAP = 620, 26, 50, 8.2, 14


def rooms():
    """Each folder or module of the library and of the programs, with the rooms that it imports."""
    imports = {}
    for path in sorted(SOURCE.rglob("*.py")):
        room = _room(path.relative_to(SOURCE).with_suffix("").parts)
        if room not in ("", "app", "__init__") and not room.startswith("_"):
            imports.setdefault(room, set()).update(_imported(path) - {room})
    return {room: {other for other in others if other in imports} for room, others in imports.items()}


def _imported(path):
    """The rooms that a module imports; what only types need is not counted."""
    names = set()
    nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
    typing = [
        node for node in nodes if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    ]
    unused = {part for node in typing for part in ast.walk(node)}
    for node in nodes:
        if node in unused:
            continue
        if isinstance(node, ast.ImportFrom) and node.module:
            names.add(node.module)
        elif isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
    return {_room(name.split(".")[1:]) for name in names if name.startswith("asperity.")}


def _room(parts):
    """The name of a room: a module or a folder of the library, or of the programs."""
    return next(iter(parts[1:] if parts[0] == "app" else parts), "")


def needed(imports):
    """Imports that do not follow from others: a room that is reached through another one has no line."""

    def reached(room):
        return set().union(*({other} | reached(other) for other in imports[room]))

    behind = {room: {other: reached(other) for other in others} for room, others in imports.items()}
    return {
        room: {other for other in others if not any(other in behind[room][via] for via in others - {other})}
        for room, others in imports.items()
    }


def levels(imports):
    """Rooms by the length of the longest way down to a room that imports none."""
    lengths = {}

    def level(room):
        if room not in lengths:
            lengths[room] = 1 + max(map(level, imports[room]), default=-1)
        return lengths[room]

    rows = [[] for _ in range(max(map(level, imports)) + 1)]
    for room in imports:
        rows[lengths[room]].append(room)
    return rows


def routed(lines, rows):
    """Rows of rooms, and of places (room, other, row) through which a line passes a row; and its pieces."""
    level = {room: number for number, row in enumerate(rows) for room in row}
    rows = [list(row) for row in rows]
    pieces = []
    for room, others in lines.items():
        for other in sorted(others):
            stops = [(room, other, number) for number in range(level[room] - 1, level[other], -1)]
            for stop in stops:
                rows[stop[2]].append(stop)
            pieces += pairwise([room, *stops, other])
    return rows, pieces


def placed(rows, pieces):
    """Middle of each room and stop: rows are ordered by where their neighbors in the next row stand."""
    middle = {}
    for sweep in range(12):
        for row in rows if sweep % 2 else reversed(rows):
            places = {
                node: [
                    middle[end]
                    for piece in pieces
                    if node in piece
                    for end in piece
                    if end != node and end in middle
                ]
                for node in row
            }
            row.sort(key=lambda node: sum(places[node]) / len(places[node]) if places[node] else 0)
            widths = [_width(node) for node in row]
            x = WIDTH / 2 - (sum(widths) + GAP * (len(row) - 1)) / 2
            for node, width in zip(row, widths, strict=True):
                middle[node] = x + width / 2
                x += width + GAP
    return middle


def _width(node):
    return CHARACTER * len(node) + 18 if isinstance(node, str) else 4


def drawing():
    """The graph as SVG, with the rooms that others are built on at the bottom."""
    imports = rooms()
    rows, pieces = routed(needed(imports), levels(imports))
    middle = placed(rows, pieces)
    top = {node: 8 + (len(rows) - 1 - number) * STEP for number, row in enumerate(rows) for node in row}
    height = len(rows) * STEP
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" font-family="sans-serif" '
        'font-size="13">',
        "<title>Rooms of the source and what each imports</title>",
        f'<rect width="{WIDTH}" height="{height}" fill="#ffffff"/>',
    ]
    for upper, lower in pieces:
        x, y, u, v = middle[upper], top[upper] + HEIGHT, middle[lower], top[lower]
        bend = (y + v) / 2
        parts.append(
            f'<path d="M{x:.0f} {y - HEIGHT / 2} V{y} C{x:.0f} {bend} {u:.0f} {bend} {u:.0f} {v} '
            f'V{v + HEIGHT / 2}" '
            'fill="none" stroke="#5b7c99" stroke-width="1.3"/>'
        )
    for room in imports:
        width = _width(room)
        parts.append(
            f'<rect x="{middle[room] - width / 2:.0f}" y="{top[room]}" width="{width:.0f}" '
            f'height="{HEIGHT}" rx="4" fill="#eef3f7" stroke="#2c4a63"/>'
            f'<text x="{middle[room]:.0f}" y="{top[room] + 17.5}" text-anchor="middle" fill="#10202e">'
            f"{room}</text>"
        )
    return "\n".join([*parts, "</svg>\n"])


def listed():
    """Each room with its first sentence, modules and lines, from the ground up."""
    rows = []
    for room in [room for row in levels(rooms()) for room in sorted(row)]:
        folder = SOURCE / "app" / room if (SOURCE / "app" / room).is_dir() else SOURCE / room
        files = sorted(folder.rglob("*.py")) if folder.is_dir() else [SOURCE / f"{room}.py"]
        first = folder / "__init__.py" if folder.is_dir() else files[0]
        summary = (ast.get_docstring(ast.parse(first.read_text(encoding="utf-8"))) or "").split("\n\n")[0]
        count = sum(len(file.read_text(encoding="utf-8").splitlines()) for file in files)
        rows.append((room, " ".join(summary.split()), len(files), count))
    return rows
