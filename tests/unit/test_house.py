"""The house: imports point upstream, public names are what they are said to be."""

import ast
import subprocess
import sys
from pathlib import Path

import asperity

SOURCE = Path(asperity.__file__).parent

# Each room may import the rooms before it, and itself.
ROOMS = [
    {"errors", "_version"},
    {"tables"},
    {"lattice"},
    {"surfaces", "solids"},
    {"contact"},
    {"aging"},
    {"results"},
    {"theory", "fits"},
    {"analysis"},
    {"figures"},
    {"config"},
    {"runs"},
    {"campaign"},
    {"paper"},
    {"cli"},
    {"__main__"},
]
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
            assert other != "asperity", f"{file} imports the package root"
            assert other == room or LEVEL[other] < LEVEL[room], f"{file}: {room} imports {other}"
            checked += 1
    assert checked > 50


def test_theory_imports_nothing_of_the_simulation():
    for file in (SOURCE / "theory").rglob("*.py"):
        assert set(rooms_imported(file)) <= {"theory", "errors"}


def test_public_names():
    assert sorted(asperity.__all__) == dir(asperity)
    assert set(asperity.__all__) == {
        "Contact",
        "History",
        "__version__",
        "age",
        "campaign",
        "errors",
        "fits",
        "press",
        "relax",
        "results",
        "solids",
        "surfaces",
        "theory",
    }
    for name in asperity.__all__:
        assert getattr(asperity, name) is not None


def test_a_bare_import_is_light():
    code = "import sys, asperity; sys.exit(any(m in sys.modules for m in ('numpy', 'xarray', 'matplotlib')))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
