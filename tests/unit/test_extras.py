"""What the base install does alone, and what is said where an extra is missing."""

import importlib
import importlib.metadata as metadata
import re
import subprocess
import sys
import textwrap
import tomllib
from pathlib import Path
from unittest.mock import Mock

import pytest
from packaging.utils import canonicalize_name

from asperity.app.cli.app import answer

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]

BLOCK = """
import sys
from importlib.machinery import PathFinder
find = PathFinder.find_spec
blocked = {blocked!r}
PathFinder.find_spec = lambda name, *rest: None if name.partition(".")[0] in blocked else find(name, *rest)
"""
MAIN = "from asperity.app.cli import main\nsys.argv[0] = 'asperity'\nsys.exit(main())"


@pytest.fixture
def without_extras(monkeypatch):
    """Code which makes every package of this environment missing that the base install does not bring."""
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    base = importlib.import_module("startup").closure(PROJECT["dependencies"]) | {"asperity"}
    owners = metadata.packages_distributions()
    blocked = {module for module, names in owners.items() if not set(map(canonicalize_name, names)) & base}
    assert blocked >= {"distributed", "dask", "tornado", "pytest"}
    assert not blocked & {"numpy", "scipy", "numba", "xarray", "zarr", "pandas", "asperity"}
    return BLOCK.format(blocked=blocked)


def python(code, *arguments, folder):
    command = [sys.executable, "-W", "ignore", "-c", textwrap.dedent(code), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder, timeout=240)


@pytest.mark.slow
def test_every_module_is_imported_without_the_extras(without_extras, tmp_path):
    # The server of the page is the one room that imports its extra at once, so that nothing else has to.
    code = without_extras + textwrap.dedent("""
        import importlib, pkgutil, asperity
        for module in pkgutil.walk_packages(asperity.__path__, "asperity."):
            if module.name.endswith("__main__"):
                continue
            try:
                importlib.import_module(module.name)
            except ModuleNotFoundError as error:
                lacking = error.name.partition(".")[0]
                assert module.name.startswith("asperity.app.explore."), (module.name, lacking)
                assert lacking in ("starlette", "uvicorn", "websockets"), (module.name, lacking)
        print(len([name for name in sys.modules if name.startswith("asperity.")]))
    """)
    done = python(code, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 100


@pytest.mark.slow
def test_a_run_needs_no_extra(without_extras, tmp_path):
    done = python(
        without_extras + MAIN, "run", "--shape", "24", "24", "--out", "run", "--quiet", folder=tmp_path
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "run" / "aging.png").exists()


@pytest.mark.slow
def test_a_campaign_says_which_extra_it_needs_and_writes_nothing(without_extras, tmp_path):
    (tmp_path / "campaign.toml").write_text("[surface]\nshape = [16, 16]\n[sweep]\nseeds = 2\n")
    done = python(without_extras + MAIN, "sweep", "campaign.toml", "--out", "study", folder=tmp_path)
    assert done.returncode != 0
    assert done.stderr.count("\n") == 1, done.stderr
    assert done.stderr.endswith("try pip install '.[campaign]' in a clone of Asperity\n")
    assert not (tmp_path / "study").exists()
    planned = python(
        without_extras + MAIN, "sweep", "campaign.toml", "--out", "study", "--dry-run", folder=tmp_path
    )
    assert planned.returncode == 0, planned.stderr


def test_the_hints_name_extras_that_there_are():
    hints = {
        extra
        for file in (ROOT / "src").rglob("*.py")
        for extra in re.findall(r'checks\.extra\("(\w+)"', file.read_text(encoding="utf-8"))
    }
    assert {"campaign", "instruments"} <= hints <= set(PROJECT["optional-dependencies"])


def test_what_is_slow_or_optional_is_imported_late():
    late = {"dask", "distributed", "pint", "SurfaceTopography", "matplotlib", "jinja2", "scipy.signal"}
    loads = "import sys, asperity.app.cli.app, asperity as asp, asperity.base.units as u, asperity.relaxation"
    code = f"{loads}; asp.press; u.quantity('3', 'Pa'); print({late!r} & set(sys.modules))"
    done = python(code, folder=None)
    assert done.stdout == "set()\n", done.stderr


@pytest.mark.parametrize(
    ("words", "others"), [("status /nowhere", 0), ("--version", 0), ("--help", 1), ("no", 1)]
)
def test_other_distributions_are_asked_for_commands_where_they_may_have_one(words, others, monkeypatch):
    looked = Mock(return_value=())
    monkeypatch.setattr("importlib.metadata.entry_points", looked)
    answer(words.split())
    assert looked.call_count == others
