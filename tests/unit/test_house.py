"""The house: imports point upstream, public names and sentences of refusals are what they are said to be."""

import ast
import importlib
import json
import pkgutil
import subprocess
import sys
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest

import asperity
from tests.refusals import KNOWN, REFUSED

SOURCE = Path(asperity.__file__).parent
RESEARCH = Path(__file__).parents[2] / "research" / "src" / "asperity_research"

# Each room may import the rooms before it, and itself. The library comes first, then the programs.
ROOMS = [
    {"errors"},
    {"base"},
    {"sheets", "progress"},
    {"theory"},
    {"lattice"},
    {"patches", "creep", "adhesion"},
    {"surfaces", "solids", "protocols"},
    {"relaxation"},
    {"ask"},
    {"contact"},
    {"carried"},
    {"aging"},
    {"results"},
    {"simulate"},
    {"fits"},
    {"analysis"},
    {"prediction", "contact_law", "sliding"},
    {"figures"},
    {"friction"},
    {"inference"},
    {"app.config"},
    {"app.runs"},
    {"app.campaign"},
    {"app.explore"},
    {"app.cli"},
    {"__main__"},
]
ROOMS_OF_RESEARCH = [
    {"arrays", "doors", "style"},
    {"challenge"},
    {"studies"},
    {"experiments", "paper"},
    {"commands"},
]


def levels(rooms):
    return {room: level for level, there in enumerate(rooms) for room in there}


def room_of(module, package):
    """The room of a module of a package, of which the programs are one each."""
    parts = module.removeprefix(f"{package}.").split(".")
    return ".".join(parts[: 2 if parts[0] == "app" else 1])


def imported(file):
    """Modules that a file imports anywhere: at its top, in a function, or for type checkers."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file}: write the full name"
            # What is imported from a package may be a module of it.
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)


@cache
def files_of(source, package):
    """Names of the modules of a package, and what each imports."""
    parts = {
        file: (package, *file.relative_to(source).with_suffix("").parts) for file in source.rglob("*.py")
    }
    return {".".join(name).removesuffix(".__init__"): set(imported(file)) for file, name in parts.items()}


HOUSES = {
    "library": (SOURCE, "asperity", ROOMS),
    "research": (RESEARCH, "asperity_research", ROOMS_OF_RESEARCH),
}


@pytest.mark.parametrize(("source", "package", "rooms"), HOUSES.values(), ids=HOUSES)
def test_imports_point_upstream_and_never_in_a_circle(source, package, rooms):
    files, level, checked = files_of(source, package), levels(rooms), 0
    for name, others in files.items():
        room = room_of(name, package)
        for other in others:
            assert package == "asperity_research" or not other.startswith("asperity_research"), name
            if not other.startswith(f"{package}.") or room in (package, "app"):  # their doors show all
                continue
            there = room_of(other, package)
            assert there in level, f"{name} imports {other}"
            assert there == room or level[there] < level[room], f"{name}: {room} imports {there}"
            checked += 1
    assert checked > 50
    # A package's face hands names on.
    within = {name for name in files if not any(other.startswith(f"{name}.") for other in files)}
    wider = {name: files[name] | {other.rpartition(".")[0] for other in files[name]} for name in within}
    arrows = {name: (others & within) - {name} for name, others in wider.items()}
    while ends := {name for name, others in arrows.items() if not others}:
        arrows = {name: others - ends for name, others in arrows.items() if name not in ends}
    assert not arrows


LEAVES = {
    "page": ("asperity.app.explore",),
    "friction": ("asperity.friction", "asperity.inference", "asperity.app.cli.reports.infer"),
}
"""Rooms that can be left out: the page; and records of friction with inference, which builds on them."""

_WITHOUT = """
import importlib, json, sys
for left_out, rest in json.load(sys.stdin):
    for name in [name for name in sys.modules if name.startswith("asperity")]:
        del sys.modules[name]
    sys.modules.update(dict.fromkeys(left_out))  # which are then not found
    for name in rest:
        importlib.import_module(name)
"""


def test_the_rest_works_without_a_leaf():
    names = [name for name in files_of(SOURCE, "asperity") if not name.endswith("__main__")]
    inside = {leaf: tuple(f"{room}." for room in LEAVES[leaf]) for leaf in LEAVES}
    left_out = {leaf: [name for name in names if f"{name}.".startswith(inside[leaf])] for leaf in LEAVES}
    assert all(len(left_out[leaf]) > len(LEAVES[leaf]) for leaf in LEAVES)
    told = json.dumps([(out, [name for name in names if name not in out]) for out in left_out.values()])
    words = [sys.executable, "-W", "ignore", "-c", _WITHOUT]
    done = subprocess.run(words, input=told, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr


def test_no_other_module_imports_by_a_text():
    imports = {file for file in SOURCE.rglob("*.py") if "import_module(" in file.read_text()}
    # The last imports libraries of arrays.
    assert imports == {SOURCE / "base" / "views.py", SOURCE / "__init__.py", SOURCE / "contact" / "arrays.py"}


def test_theory_imports_nothing_of_the_simulation():
    files = files_of(SOURCE, "asperity")
    named = {
        other for name, others in files.items() if name.startswith("asperity.theory") for other in others
    }
    rooms = {other: room_of(other, "asperity") for other in named if other.startswith("asperity.")}
    others = {other for other, room in rooms.items() if room not in ("theory", "errors")}
    assert all(other.startswith("asperity.base.") for other in others)


def test_public_rooms_show_public_names_and_no_module_hides_behind_a_function_of_its_name():
    assert sorted(asperity.__all__) == dir(asperity)
    rooms = [getattr(asperity, name) for name in asperity.__all__]
    for room in (room for room in rooms if isinstance(room, ModuleType)):
        assert sorted(room.__all__) == dir(room)
        for module in pkgutil.iter_modules(getattr(room, "__path__", [])):
            found = importlib.import_module(f"{room.__name__}.{module.name}")
            assert getattr(room, module.name) is found


def test_every_room_is_reached():
    # The name of the room of predictions is that of the function at its door.
    for room in set(levels(ROOMS)) - {"__main__"}:
        assert asperity.__getattr__(room.removeprefix("app.")) is sys.modules[f"asperity.{room}"]


def test_whatever_waits_for_a_process_in_a_test_has_a_limit():
    unlimited = []
    for file in Path(__file__).parents[1].rglob("*.py"):
        nodes = list(ast.walk(ast.parse(file.read_text(encoding="utf-8"))))
        awaited = {id(node.value) for node in nodes if isinstance(node, ast.Await)}
        for node in nodes:
            if not isinstance(node, ast.Call) or id(node) in awaited:
                continue
            called, limited = ast.unparse(node.func), any(word.arg == "timeout" for word in node.keywords)
            waits = called.startswith("subprocess.") and called != "subprocess.Popen"
            waits |= called.endswith((".communicate", ".wait"))
            waits |= called.endswith(".join") and not node.args  # a thread's, not a string's
            if waits and not limited:
                unlimited.append(f"{file.name}:{node.lineno}: {called}")
    assert unlimited == []


def test_type_checkers_know_the_public_names_and_no_others():
    root = ast.parse((SOURCE / "__init__.py").read_text()).body
    conditions = {ast.unparse(node.test): node.body for node in root if isinstance(node, ast.If)}
    imports = [node for node in conditions["TYPE_CHECKING"] if isinstance(node, ast.ImportFrom)]
    known = {alias.name for node in imports for alias in node.names}
    assert known | {"__version__"} == set(asperity.__all__)
    functions = {node.name for node in root if isinstance(node, ast.FunctionDef)}
    assert functions == {"__dir__"}  # __getattr__, which would allow any name, stands elsewhere


def test_other_names_do_not_exist():
    for name in ("nope", "__main__", "_nope", "press_"):
        with pytest.raises(AttributeError, match=f"module 'asperity' has no attribute '{name}'"):
            getattr(asperity, name)


def test_each_known_refusal_belongs_to_a_test():
    for test in KNOWN.known:
        file, name = test.split("::")
        source = (REFUSED.parent / file).read_text(encoding="utf-8")
        assert "refuses(" in source.partition(f"def {name}(")[2].partition("\ndef ")[0], test
