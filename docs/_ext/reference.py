"""The reference, made of the code: a page for each public name, the commands, the Dataset."""

import inspect
from pathlib import Path
from types import ModuleType

import asperity
from asperity.cli.app import app
from asperity.results import quantities

DOCS = Path(__file__).parents[1]

VERBS = ("press", "age", "relax", "predict", "observe")


def rooms():
    """The public rooms by name."""
    return {
        name: thing for name in asperity.__all__ if isinstance(thing := getattr(asperity, name), ModuleType)
    }


def public():
    """Every public name outside and inside the rooms, as one writes it, and what it is."""
    found = {f"asperity.{name}": getattr(asperity, name) for name in asperity.__all__}
    found = {name: thing for name, thing in found.items() if not isinstance(thing, ModuleType)}
    for room, module in rooms().items():
        found |= {f"asperity.{room}.{name}": getattr(module, name) for name in module.__all__}
    return found


def first_line(thing):
    """The first sentence of a docstring, on one line."""
    text = inspect.getdoc(thing) or ""
    return " ".join(text.split("\n\n")[0].split())


def heading(text, mark="="):
    """A heading of reStructuredText."""
    return f"{text}\n{mark * len(text)}\n"


def directive(thing):
    """What autodoc calls such a thing."""
    if inspect.isclass(thing):
        return "autoexception" if issubclass(thing, Exception) else "autoclass"
    return "autofunction" if callable(thing) else "autodata"


def pages():
    """Name and text of every generated page."""
    names = public()
    first = {}  # the shortest name under which a thing is public has its description
    for name, thing in names.items():
        if inspect.isclass(thing) or inspect.isfunction(thing):
            first.setdefault(thing, name)
    made = {}
    for name, thing in names.items():
        made[f"{name}.rst"] = page(name, thing, first.get(thing, name) if callable(thing) else name)
    for room, module in rooms().items():
        inside = [f"asperity.{room}.{name}" for name in module.__all__]
        made[f"{room}.rst"] = "\n".join(
            (heading(f"asperity.{room}"), f".. automodule:: asperity.{room}\n   :no-members:\n", toctree(inside, names))
        )
    top = [name for name in names if name.count(".") == 1 and name != "asperity.__version__"]
    top.sort(key=lambda name: (list(names).index(name) if name.split(".")[1] not in VERBS else -1))
    made["asperity.rst"] = "\n".join(
        (heading("asperity"), ".. automodule:: asperity\n   :no-members:\n", toctree([*top, "asperity.__version__"], names))
    )
    made["commands.rst"] = commands()
    made["dataset.rst"] = dataset()
    return made


def page(name, thing, home):
    """The page of one name."""
    if home != name:
        return f"{heading(name)}\nThe same as :py:obj:`{home}`.\n"
    return f"{heading(name)}\n.. {directive(thing)}:: {name}\n"


def toctree(inside, names):
    """A table of names, each with its first line, and the list that the navigation shows."""
    rows = [f"   * - :doc:`{name.rsplit('.', 1)[-1]} <{name}>`\n     - {first_line(names[name])}" for name in inside]
    table = ".. list-table::\n   :widths: 25 75\n\n" + "\n".join(rows)
    hidden = ".. toctree::\n   :hidden:\n\n" + "\n".join(f"   {name.rsplit('.', 1)[-1]} <{name}>" for name in inside)
    return f"{table}\n\n{hidden}\n"


def commands():
    """The command line."""
    text = app.generate_docs(output_format="rst")
    return text


def dataset():
    """The variables of a Dataset of a history."""
    tables = (
        ("Series, over time", quantities.SERIES),
        ("Of continua, besides or in another unit", quantities.OF_CONTINUA),
        ("Fields, over field_time and the sites", quantities.FIELDS),
        ("Fields of continua", quantities.FIELDS_OF_CONTINUA),
        ("Coordinates", quantities.COORDINATES),
    )
    parts = [heading("The Dataset of a history")]
    for title, rows in tables:
        parts.append(heading(title, "-"))
        parts.append(".. list-table::\n   :header-rows: 1\n   :widths: 25 50 25\n")
        parts.append("   * - name\n     - what it is\n     - dimension")
        parts += [f"   * - ``{name}``\n     - {what}\n     - {unit}" for name, (what, unit) in rows.items()]
        parts.append("")
    return "\n".join(parts)
