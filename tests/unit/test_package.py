"""What packagers, archives and indexes are told of the package agrees with the package."""

import importlib
import json
import os
import re
import tomllib
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name

from asperity import __version__

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
