"""What packagers and indexes are told agrees with the package; what the base install does without extras."""

import importlib
import importlib.metadata as metadata
import json
import os
import re
import subprocess
import sys
import textwrap
import tomllib
from pathlib import Path
from typing import Any
from unittest.mock import Mock, call
from urllib.parse import quote

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name

from asperity import __version__
from asperity.app.cli.app import answer
from asperity.base import checks

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS = PROJECT["optional-dependencies"]


def read(name):
    return (ROOT / name).read_text(encoding="utf-8")


def bounds(texts):
    """Names and bounds of requirements, without the extras of this package itself."""
    found = map(Requirement, texts)
    return {canonicalize_name(r.name): r.specifier for r in found if r.name != "asperity"}


@pytest.fixture
def release(tmp_path, monkeypatch):
    """The script of a release, at work on a copy of the files that it changes."""
    monkeypatch.syspath_prepend(str(ROOT / ".ci"))
    module: Any = importlib.import_module("release")
    for name, _ in module.PLACES:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(read(name), encoding="utf-8")
    monkeypatch.setattr(module, "ROOT", tmp_path)
    return module


def test_every_place_states_this_version(release):
    citation, recipe = (yaml.safe_load(read(name)) for name in ("CITATION.cff", "recipe.yaml"))
    assert {citation["version"], recipe["context"]["version"]} == {__version__}
    assert f"## {__version__}, {citation['date-released']}\n" in read("CHANGELOG.md")
    version, cited, date, *others, heading = release.stated()
    assert {version, cited, *others} == {__version__}
    assert len(others) == 4  # research twice, the recipe and the page of the package
    assert heading == f"{__version__}, {date}"


def test_a_version_is_set_at_every_place_and_nothing_else_changes(release, tmp_path):
    before = {name: read(name) for name, _ in release.PLACES}
    changelog = tmp_path / "CHANGELOG.md"
    changelog.write_text(before["CHANGELOG.md"].replace("\n## ", "\n## Unreleased\n\nNew.\n\n## ", 1))
    release.set_version("9.8.7", "2031-02-03")
    assert release.stated() == ["9.8.7", "9.8.7", "2031-02-03", *["9.8.7"] * 4, "9.8.7, 2031-02-03"]
    assert f"\n## {__version__}, " in changelog.read_text()
    for name in set(before) - {"CHANGELOG.md"}:
        lines = zip(before[name].splitlines(), (tmp_path / name).read_text().splitlines(), strict=True)
        changed = [line for line, new in lines if line != new]
        assert len(changed) == sum(place == name for place, _ in release.PLACES)
    with pytest.raises(SystemExit, match="expected the heading '## Unreleased'"):
        release.set_version("9.8.8", "2031-02-03")


def test_the_address_is_set_at_every_place_and_its_absence_keeps_a_commit_from_release(release, tmp_path):
    git = Mock(return_value="")
    release.git = git
    for name in release.ADDRESSED:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(read(name), encoding="utf-8")
        assert release.address() in read(name)
    release.set_address(release.NO_ADDRESS)
    assert release.ready() == ["there is no address yet; try python .ci/release.py address https://..."]
    release.set_address("https://host.org/someone/rough/")
    assert release.ready() == release.ready(f"v{__version__}") == []
    assert len(release.ready("v9.8.7")) == 1
    recipe = yaml.safe_load((tmp_path / "recipe.yaml").read_text())
    assert recipe["extra"]["recipe-maintainers"] == ["someone"]
    assert recipe["context"]["address"] == "https://host.org/someone/rough"
    assert not [name for name in release.ADDRESSED if "example.org" in (tmp_path / name).read_text()]


def test_actions_are_pinned_to_commits():
    for workflow in (ROOT / ".github" / "workflows").glob("*.yml"):
        for action in re.findall(r"uses: (.*)", workflow.read_text(encoding="utf-8")):
            assert re.fullmatch(r"[\w-]+/[\w-]+@[0-9a-f]{40} # v[\d.]+", action), (workflow.name, action)


def test_the_conda_recipe_has_the_dependencies_of_the_package():
    recipe = yaml.safe_load(read("recipe.yaml"))
    needs, least = recipe["requirements"], recipe["context"]["python_min"]
    lines = (line.replace("${{ python_min }}", least) for line in needs["run"])
    run = bounds(line.replace("matplotlib-base", "matplotlib") for line in lines)
    assert run.pop("python") == SpecifierSet(PROJECT["requires-python"])
    assert run == bounds(PROJECT["dependencies"])
    extras = [text for name in ("arrays", "campaign", "explore") for text in EXTRAS[name]]
    assert bounds(needs["run_constraints"]) == bounds(extras)


def test_the_lock_file_meets_every_bound():
    locked: dict[str, list[str]] = {}
    for text in re.findall(r"^([a-z0-9].*?) *\\$", read("requirements-dev.lock"), flags=re.MULTILINE):
        requirement = Requirement(text)
        (pin,) = requirement.specifier
        locked.setdefault(canonicalize_name(requirement.name), []).append(pin.version)
    wanted = [*PROJECT["dependencies"], *(text for extra in EXTRAS.values() for text in extra)]
    for name, bound in bounds(wanted).items():
        assert locked[name], name
        assert all(bound.contains(version) for version in locked[name]), name
    assert "://" not in read("requirements-dev.lock")


def test_citation_and_archive_say_the_same():
    citation, archive = yaml.safe_load(read("CITATION.cff")), json.loads(read(".zenodo.json"))
    assert citation["title"] == archive["title"]
    assert citation["license"] == archive["license"] == PROJECT["license"]
    assert citation["keywords"] == archive["keywords"] == PROJECT["keywords"]
    assert archive["description"] == f"<p>{citation['abstract']}</p>"
    names = [author["name"] for author in PROJECT["authors"]]
    assert [author["name"] for author in citation["authors"]] == names
    assert [author["name"] for author in archive["creators"]] == names
    (paper,) = citation["references"]
    assert [link["identifier"] for link in archive["related_identifiers"]] == [paper["doi"]]
    assert f"https://doi.org/{paper['doi']}" in read("docs/paper.md")


def test_every_stated_python_is_tried():
    jobs = yaml.safe_load(read(".github/workflows/ci.yml"))["jobs"]
    matrix = set(jobs["test"]["strategy"]["matrix"]["python"])
    stated = set(re.findall(r"Python :: (3\.\d+)", "\n".join(PROJECT["classifiers"])))
    tried = set(re.findall(r'"(3\.\d+)"', re.findall(r"PYTHONS = (.*)", read(".ci/packages.py"))[0]))
    assert matrix == stated == tried
    assert all(SpecifierSet(PROJECT["requires-python"]).contains(version) for version in stated)


def test_public_checks_are_what_a_developer_runs():
    jobs = yaml.safe_load(read(".github/workflows/ci.yml"))["jobs"]
    commands = [step["run"] for job in jobs.values() for step in job["steps"] if "run" in step]
    targets = set(re.findall(r"^([a-z-]+):", read("Makefile"), flags=re.MULTILINE))
    for command in commands + read(".ci/run").splitlines():
        for target in re.findall(r"\bmake ([a-z-]+)", command):
            assert target in targets, command
    assert os.access(ROOT / ".ci" / "run", os.X_OK)


def test_a_developer_gets_every_extra():
    (own,) = (Requirement(text) for text in EXTRAS["dev"] if Requirement(text).name == "asperity")
    assert own.extras == set(EXTRAS) - {"dev"}


# -- What the base install does alone ----------------------------------------------------------------------

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
    assert done.stderr.endswith(f"try pip install '{checks.installed_from()}[campaign]'\n")
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


@pytest.mark.parametrize(
    "url", ["", "https://host.org/asperity.whl", "file://{clone}", "file://{clone}/missing"]
)
def test_advice_on_what_to_install_names_the_clone_if_there_is_one(url, tmp_path, monkeypatch):
    (tmp_path / "a clone" / "research").mkdir(parents=True)
    clone = str(tmp_path / "a clone")
    written = json.dumps({"url": url.format(clone=quote(clone))}) if url else None
    monkeypatch.setattr(metadata, "distribution", lambda _: Mock(read_text=lambda _: written))
    found = checks.installed_from(), checks.installed_from("asperity-research")
    is_clone = url.endswith("{clone}")
    assert found == ((clone, f"{clone}/research") if is_clone else ("asperity", "asperity-research"))


ENGINE = "scipy.fft numba xarray matplotlib"
LATE = {
    "import sys, asperity as asp": "numpy xarray matplotlib",
    "from asperity.app.cli import main; main(['--help']); main(['--out', '.'])": f"{ENGINE} numpy pydantic",
    "main(['run', '--help']); main(['run', '--out', '.'])": ENGINE,
    "import asperity.app.cli.app, asperity.base.units; asperity.base.units.quantity('3', 'Pa')": "pint",
    "asp.press; asp.relaxation.fit": "dask distributed pint SurfaceTopography matplotlib jinja2 scipy.signal",
    "asp.analysis.patches; asp.results": "matplotlib",
    "asp.figures": "matplotlib.pyplot",
}
"""Which modules code does not import, nor does all the code above it."""


def test_what_is_slow_or_optional_is_imported_late():
    shown = "\nprint([name for name in {!r}.split() if name in sys.modules], file=sys.stderr)\n".format
    done = python("".join(code + shown(late) for code, late in LATE.items()), folder=None)
    found = [line for line in done.stderr.splitlines() if line.startswith("[")]
    assert dict(zip(LATE, found, strict=True)) == dict.fromkeys(LATE, "[]"), done.stderr


PRESSES = (
    "asp.press; asp.age",
    "asp.press(asp.surfaces.gaussian((16, 16)), asp.solids.spring_lattice(k0=1, k1=3), load=9)",
    """asp.press(
        asp.surfaces.spectral((16, 16), roll_off=4, cutoff=2, rms_height=0.1, pixel_size=1, unit="um"),
        asp.solids.half_space(modulus="1 GPa"), pressure="1 MPa",
    )""",
)


def test_a_press_imports_its_engine_alone():
    shown = "\nprint(*{name.partition('.')[0] for name in sys.modules})\n"
    done = python("import sys, asperity as asp\n" + "".join(press + shown for press in PRESSES), folder=None)
    assert done.returncode == 0, done.stderr
    owners = metadata.packages_distributions()
    needed = {canonicalize_name(Requirement(text).name) for text in PROJECT["dependencies"]} | {"pydantic"}
    engine = {"annotated-types", "numba", "numpy", "scipy"}
    for imported in done.stdout.splitlines():
        brought = {canonicalize_name(owner) for name in imported.split() for owner in owners.get(name, ())}
        assert brought & needed == engine
    assert done.stdout.count("\n") == len(PRESSES)


LIMITS = {"press": 3.5, "run --help": 2.0, "--help": 1.0}
"""What a process may take, over what it takes to import numba."""


@pytest.mark.slow
@pytest.mark.parametrize("words", LIMITS)
def test_a_process_starts_in_a_few_times_what_numba_takes(words):
    def seconds(*arguments):
        """Processor time, which a busy machine changes least; the least of three."""
        taken = []
        for _ in range(3):
            before = os.times()
            subprocess.run([sys.executable, *arguments], check=True, capture_output=True, timeout=60)
            taken.append(sum(os.times()[2:4]) - sum(before[2:4]))
        return min(taken)

    press = "-c", "import asperity; asperity.press; asperity.age"
    arguments = press if words == "press" else ("-m", "asperity", *words.split())
    assert seconds(*arguments) < LIMITS[words] * seconds("-c", "import numba")


@pytest.mark.parametrize(
    ("words", "others"), [("status /nowhere", 0), ("--version", 0), ("--help", 1), ("no", 1)]
)
def test_other_distributions_are_asked_for_commands_where_they_may_have_one(words, others, monkeypatch):
    looked = Mock(return_value=())
    monkeypatch.setattr("importlib.metadata.entry_points", looked)
    answer(words.split())
    # What a command imports may ask for entry points of its own.
    assert looked.call_args_list.count(call(group="asperity.commands")) == others
