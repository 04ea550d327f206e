"""The house: imports point upstream, public names are what they are said to be."""

import ast
import importlib
import pkgutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import asperity

SOURCE = Path(asperity.__file__).parent
RESEARCH = Path(__file__).parents[2] / "research" / "src" / "asperity_research"

# Each room may import the rooms before it, and itself. The library comes first, then the programs.
ROOMS = [
    {"errors"},
    {"base"},
    {"lattice"},
    {"relaxation", "patches", "creep"},
    {"surfaces", "solids", "protocols"},
    {"contact"},
    {"aging"},
    {"progress", "results"},
    {"simulate"},
    {"theory", "fits"},
    {"friction"},
    {"inference"},
    {"analysis"},
    {"figures"},
    {"app.config"},
    {"app.runs"},
    {"app.predict", "app.campaign"},
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


@pytest.mark.parametrize(
    ("source", "package", "rooms"),
    [(SOURCE, "asperity", ROOMS), (RESEARCH, "asperity_research", ROOMS_OF_RESEARCH)],
)
def test_imports_point_upstream(source, package, rooms):
    level, checked = levels(rooms), 0
    for file in source.rglob("*.py"):
        module = ".".join([package, *file.relative_to(source).with_suffix("").parts])
        room = room_of(module.removesuffix(".__init__"), package)
        for other in imported(file):
            if not other.startswith(f"{package}.") or room in (package, "app"):  # their doors show all
                continue
            there = room_of(other, package)
            assert there in level, f"{file} imports {other}"
            assert there == room or level[there] < level[room], f"{file}: {room} imports {there}"
            checked += 1
    assert checked > 50


def circles(files):
    """Files that import each other in a loop."""
    arrows = {name: {other for other in others if other in files} - {name} for name, others in files.items()}
    while ends := [name for name, others in arrows.items() if not others]:
        arrows = {name: others - set(ends) for name, others in arrows.items() if name not in ends}
    return sorted(arrows)


@pytest.mark.parametrize(("source", "package"), [(SOURCE, "asperity"), (RESEARCH, "asperity_research")])
def test_no_files_import_each_other_in_a_circle(source, package):
    files = {}
    for file in source.rglob("*.py"):
        name = ".".join([package, *file.relative_to(source).with_suffix("").parts])
        found = set(imported(file))
        found |= {other.rpartition(".")[0] for other in found}
        files[name.removesuffix(".__init__")] = found
    # A package's face hands names on.
    faces = {name for name in files if any(other.startswith(f"{name}.") for other in files)}
    assert circles({name: found for name, found in files.items() if name not in faces}) == []


def test_the_library_knows_neither_programs_nor_research():
    for file in SOURCE.rglob("*.py"):
        named = set(imported(file))
        assert not any(module.startswith("asperity_research") for module in named), file
        if file.relative_to(SOURCE).parts[0] not in ("app", "__main__.py", "__init__.py"):
            assert not any(module.startswith("asperity.app") for module in named), file


def test_no_other_module_imports_by_a_text():
    imports = {file for file in SOURCE.rglob("*.py") if "import_module(" in file.read_text()}
    # The last imports libraries of arrays.
    assert imports == {SOURCE / "base" / "views.py", SOURCE / "__init__.py", SOURCE / "contact" / "arrays.py"}


def test_theory_imports_nothing_of_the_simulation():
    for file in (SOURCE / "theory").rglob("*.py"):
        named = {module for module in imported(file) if module.startswith("asperity.")}
        others = {module for module in named if room_of(module, "asperity") not in ("theory", "errors")}
        assert all(module.startswith("asperity.base.checks") for module in others)


def test_public_names():
    assert sorted(asperity.__all__) == dir(asperity)
    assert set(asperity.__all__) == {
        "ActiveSet",
        "Carried",
        "Checkpoint",
        "Contact",
        "Frame",
        "History",
        "Load",
        "Multigrid",
        "Separation",
        "__version__",
        "age",
        "analysis",
        "campaign",
        "errors",
        "figures",
        "fits",
        "friction",
        "infer",
        "inference",
        "observe",
        "predict",
        "press",
        "protocols",
        "relax",
        "relaxation",
        "results",
        "slide",
        "solids",
        "surfaces",
        "theory",
    }


def test_public_rooms_show_public_names():
    for name in asperity.__all__:
        member = getattr(asperity, name)
        if isinstance(member, ModuleType):
            assert sorted(member.__all__) == dir(member)


# The name of the room of predictions is that of the function at its door.
@pytest.mark.parametrize("room", sorted(set(levels(ROOMS)) - {"__main__", "app.predict"}))
def test_every_room_is_reached(room):
    assert asperity.__getattr__(room.removeprefix("app.")) is sys.modules[f"asperity.{room}"]


@pytest.mark.parametrize(
    "room",
    [
        "analysis",
        "app.campaign",
        "figures",
        "fits",
        "friction",
        "inference",
        "relaxation",
        "results",
        "solids",
        "surfaces",
        "theory",
    ],
)
def test_no_module_hides_behind_a_function_of_its_name(room):
    inside = importlib.import_module(f"asperity.{room}")
    for module in pkgutil.iter_modules(inside.__path__):
        found = importlib.import_module(f"asperity.{room}.{module.name}")
        assert getattr(inside, module.name) is found


def test_a_room_is_reached_whatever_was_imported_before():
    code = "import asperity; asperity.analysis.patches"
    assert subprocess.run([sys.executable, "-c", code], check=False, timeout=120).returncode == 0


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
    (seen,) = (
        node for node in root if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    )
    imports = [node for node in seen.body if isinstance(node, ast.ImportFrom)]
    known = {alias.name for node in imports for alias in node.names}
    assert known | {"__version__"} == set(asperity.__all__)
    functions = {node.name for node in root if isinstance(node, ast.FunctionDef)}
    assert functions == {
        "__dir__"
    }  # __getattr__, which would allow any name, stands under "not TYPE_CHECKING"


def test_other_names_do_not_exist():
    for name in ("nope", "__main__", "_nope", "press_"):
        with pytest.raises(AttributeError, match=f"module 'asperity' has no attribute '{name}'"):
            getattr(asperity, name)


def test_a_bare_import_is_light():
    code = "import sys, asperity; sys.exit(any(m in sys.modules for m in ('numpy', 'xarray', 'matplotlib')))"
    assert subprocess.run([sys.executable, "-c", code], check=False, timeout=120).returncode == 0
