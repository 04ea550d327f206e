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

# Each room may import the rooms before it, and itself.
ROOMS = [
    {"_version", "threads", "words", "views"},
    {"errors"},
    {"checks"},
    {"tables", "memory", "units"},
    {"columns"},
    {"lattice"},
    {"relaxation", "patches"},
    {"surfaces", "solids", "protocols"},
    {"contact"},
    {"aging"},
    {"progress", "results"},
    {"simulate"},
    {"theory", "fits"},
    {"friction"},
    {"analysis"},
    {"figures"},
    {"config"},
    {"runs"},
    {"challenge"},
    {"campaign"},
    {"explore"},
    {"studies"},
    {"paper"},
    {"cli"},
    {"__main__"},
]
DOOR = SOURCE / "views.py"  # the only one that imports downstream, when a picture or a Dataset is asked for
LEVEL = {room: level for level, rooms in enumerate(ROOMS) for room in rooms}


def rooms_imported(file):
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file}: write the full name"
            modules = [node.module or ""]
        elif isinstance(node, ast.Import):
            modules = [alias.name for alias in node.names]
        else:
            continue
        for module in modules:
            parts = module.split(".")
            if parts[0] == "asperity":
                yield parts[1] if len(parts) > 1 else "asperity"


def test_imports_point_upstream():
    checked = 0
    for file in SOURCE.rglob("*.py"):
        room = file.relative_to(SOURCE).parts[0].removesuffix(".py")
        if room == "__init__":
            continue
        for other in rooms_imported(file):
            if file == DOOR:
                assert other in ("figures", "results")
                continue
            assert other != "asperity", f"{file} imports the package root"
            assert other == room or LEVEL[other] < LEVEL[room], f"{file}: {room} imports {other}"
            checked += 1
    assert checked > 50


def test_no_other_module_imports_by_a_text():
    imports = {file for file in SOURCE.rglob("*.py") if "import_module(" in file.read_text()}
    # The last imports libraries of arrays.
    assert imports == {DOOR, SOURCE / "__init__.py", SOURCE / "contact" / "arrays.py"}


def test_theory_imports_nothing_of_the_simulation():
    for file in (SOURCE / "theory").rglob("*.py"):
        assert set(rooms_imported(file)) <= {"theory", "checks", "errors"}


def test_public_names():
    assert sorted(asperity.__all__) == dir(asperity)
    assert set(asperity.__all__) == {
        "ActiveSet",
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
        "challenge",
        "errors",
        "figures",
        "fits",
        "friction",
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


@pytest.mark.parametrize("room", sorted(set(LEVEL) - {"_version", "__main__"}))
def test_every_room_is_reached(room):
    assert asperity.__getattr__(room) is sys.modules[f"asperity.{room}"]


@pytest.mark.parametrize(
    "room",
    [
        "analysis",
        "campaign",
        "challenge",
        "figures",
        "fits",
        "friction",
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
