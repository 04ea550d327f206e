"""The reference, made of the code: a page for each public name, the commands, the keys, the Dataset."""

import inspect
import re
import sys
from pathlib import Path
from types import ModuleType

import house

import asperity
from asperity.app.cli.app import with_others
from asperity.app.config.keys import sections
from asperity.results import quantities

DOCS = Path(__file__).parents[1]


def rooms():
    """The public rooms by name."""
    return {
        name: thing
        for name in (
            *asperity.__all__,
            "challenge",
            "experiments",
        )  # asperity-research adds the last, where installed
        if isinstance(thing := getattr(asperity, name, None), ModuleType)
    }


def public():
    """Every public name outside and inside the rooms, as one writes it, and what it is."""
    names = {f"asperity.{name}": getattr(asperity, name) for name in asperity.__all__}
    names = {name: thing for name, thing in names.items() if not isinstance(thing, ModuleType)}
    for room, module in rooms().items():
        names |= {f"asperity.{room}.{name}": getattr(module, name) for name in module.__all__}
    return names


def pages():
    """Text of every generated page, by its file."""
    names = public()
    first = {}  # the shortest name under which a thing is public has its description
    for name, thing in names.items():
        if inspect.isclass(thing) or inspect.isfunction(thing):
            first.setdefault(thing, name)
    files = {f"{stem(name)}.rst": page(name, thing, first) for name, thing in names.items()}
    outside = [name for name in names if name.count(".") == 1]
    verbs = [f"asperity.{name}" for name in ("press", "age", "relax", "predict", "observe")]
    files["asperity.rst"] = room_page("asperity", list(dict.fromkeys(verbs + outside)), names)
    for room, module in rooms().items():
        files[f"{room}.rst"] = room_page(
            f"asperity.{room}", [f"asperity.{room}.{name}" for name in module.__all__], names
        )
    return (
        files
        | commands()
        | {
            "keys.rst": keys(),
            "dataset.rst": dataset(),
            "house.rst": house_page(),
        }
    )


def stem(name):
    """File of a name: files of ``Fit`` and ``fit`` must differ where capitals do not count."""
    return f"{name}-class" if name.rsplit(".", 1)[-1][0].isupper() else name


def heading(text, mark="="):
    """Make a heading of reStructuredText."""
    return f"{text}\n{mark * len(text)}\n"


def table(titles, rows, widths=None):
    """Make a table; a cell that is nothing stays empty."""
    lines = [".. list-table::", f"   :widths: {' '.join(map(str, widths))}" if widths else "   :widths: auto"]
    if titles:
        lines.append("   :header-rows: 1")
    lines.append("")
    for row in ([titles] if titles else []) + list(rows):
        lines += [f"   {'  ' if number else '* '}- {cell}".rstrip() for number, cell in enumerate(row)]
    return "\n".join(lines) + "\n"


def page(name, thing, first):
    """One name."""
    home = first.get(thing, name) if callable(thing) else name
    if home != name:
        return f"{heading(name)}\nThe same as :py:obj:`{home}`.\n"
    directive = "autodata"
    if inspect.isclass(thing):
        directive = "autoexception" if issubclass(thing, Exception) else "autoclass"
    elif callable(thing):
        directive = "autofunction"
    return f"{heading(name)}\n.. {directive}:: {name}\n"


def room_page(name, inside, names):
    """A room: what it says of itself, and its names."""
    rows = []
    for one in inside:
        text = (inspect.getdoc(names[one]) or "").split("\n\n")[0]
        summary = "" if isinstance(names[one], str | float) else " ".join(text.split())
        rows.append((f":doc:`{one.rsplit('.', 1)[-1]} <{stem(one)}>`", summary))
    hidden = [f"   {one.rsplit('.', 1)[-1]} <{stem(one)}>" for one in inside]
    return "\n".join(
        (
            heading(name),
            f".. automodule:: {name}\n   :no-members:\n",
            table((), rows, (25, 75)),
            ".. toctree::\n   :hidden:\n",
            *hidden,
            "",
        )
    )


def commands():
    """The command line, as its help has it: a page with all commands, and one for each."""
    words, sys.argv = sys.argv, ["asperity"]  # usage lines are made of these
    try:
        text = with_others().generate_docs(output_format="rst")
    finally:
        sys.argv = words
    text = re.sub(r"(?<=[ (\[])(--\w[\w-]*)", r"``\1``", text[text.index("**Commands:**") :])
    start, *parts = re.split(r"^\.\. _cyclopts-[\w-]+:\n\n(?=(?:.+)\n-+\n)", text, flags=re.MULTILINE)
    files = {}
    for part in parts:
        name, _, body = part.split("\n", 2)
        if "^^^" not in body:  # groups of flags become sections, which the page lists
            body = re.sub(r"^\*\*(.+):\*\*$", lambda match: heading(match[1], "-"), body, flags=re.MULTILINE)
        if not name.startswith("-"):
            files[f"command-{name}.rst"] = f"{heading(f'asperity {name}')}\n{body}"
    start = re.sub(r"^``(\w+)``$", r":doc:`\1 <command-\1>`", start, flags=re.MULTILINE)
    names = sorted(path.removesuffix(".rst") for path in files)
    listed = [f"   {name.replace('command-', 'asperity ')} <{name}>" for name in names]
    contents = "\n".join((".. toctree::\n   :hidden:\n", *listed))
    return files | {"commands.rst": f"{heading('The command line')}\n{start}\n{contents}\n"}


def keys():
    """The keys of a configuration file, by section and kind."""
    parts = [
        heading("Keys of a configuration"),
        "What a file for ``asperity run`` may hold. Most keys have a flag of the same name "
        "(:doc:`commands`), and most can be swept by a campaign (:doc:`../campaigns`). Where a unit is "
        'named, the number may be text with a unit, such as ``"3.8 GPa"``, if the surface has a unit of '
        "length.\n",
    ]
    for section, kinds in sections().items():
        name = "[[protocol]]" if section == "protocol" else f"[{section}]"
        parts.append(heading(name, "-"))
        for number, (kind, known) in enumerate(kinds.items()):
            if kind:
                usual = ", the usual kind" if not number and section != "protocol" else ""
                parts.append(f'``kind = "{kind}"``{usual}\n')
            rows = [
                (f"``{key.name}``", f"{meaning(key)} — {'; '.join(filter(None, facts(key)))}")
                for key in known.values()
            ]
            if rows:
                parts.append(table(("key", "meaning — what it is; range; default"), rows, (20, 80)))
    return "\n".join(parts)


def meaning(key):
    """What the help of a flag says."""
    return key.description.replace("*", r"\*")


def facts(key):
    """What a value may be, its range, and what it is where it is not given."""
    default = by_default(key)
    return what(key), bounds(key), default and (default if key.required else f"default {default}")


def what(key):
    """What a value may be, with its unit."""
    words = ", ".join(f'``"{choice}"``' for choice in key.choices) if key.choices else key.what
    return f"{words}, {key.unit}" if key.unit else words


def bounds(key):
    """The range of a number."""
    ends = []
    if key.least is not None and key.least > -1e15:
        ends.append(f"{'>' if key.above else '≥'} {key.least:g}")
    if key.most is not None and key.most < 1e15:
        ends.append(f"{'<' if key.below else '≤'} {key.most:g}")
    return ", ".join(ends)


def by_default(key):
    """What it is where it is not given."""
    if key.required:
        return "must be given"
    if key.default is None:
        return ""
    return f"``{str(key.default).lower() if isinstance(key.default, bool) else key.default!r}``".replace(
        "'", '"'
    )


def dataset():
    """The variables of the Dataset of a history."""
    parts = [
        heading("The Dataset of a history"),
        "``history.dataset``, and what ``asperity.results.load`` opens: an xarray Dataset. Each variable "
        'carries its long name and its unit (``data["area"].attrs``); which unit a dimension has depends on '
        "the surface and the solid "
        "(:doc:`../solids`). Write the name in brackets: ``data.load`` is a method of xarray.\n",
    ]
    for title, home in (
        ("Series, over time", "series"),
        ("Fields, over field_time and the sites", "field"),
        ("Fields that the dataset of a contact has besides", "contact"),
        ("Patches of contact, over field_time", "map"),
        ("Coordinates", "coordinate"),
    ):
        rows = [
            (f"``{row.name}``", row.long_name, row.symbol, row.dimension, row.of.replace("all", ""))
            for row in quantities.QUANTITIES
            if row.home == home
        ]
        titles = ("name", "what it is", "paper", "dimension", "only of")
        parts += [heading(title, "-"), table(titles, rows, (22, 42, 12, 14, 10))]
    return "\n".join(parts)


def house_page():
    """The rooms of the source."""
    rows = [
        (f"``{room}``", summary, str(files), f"{lines:,}")
        for room, summary, files, lines in reversed(house.listed())
    ]
    return "\n".join(
        (
            heading("The house"),
            "A line leads down from a room to each room that it imports. Where one room is reached through "
            "another, the line is left out. The drawing and the table are made of the source whenever these "
            "pages are built; ``tests/unit/test_house.py`` keeps imports pointing down.\n",
            ".. image:: house.svg\n"
            "   :alt: Rooms of the source, from the command line down to words and errors\n"
            "   :align: center\n   :width: 100%\n",
            table(("room", "what it is", "files", "lines"), rows, (14, 66, 8, 12)),
        )
    )
