"""Every page does what it says: its blocks are executed, its names, files, links and versions exist.

A page is executed from top to bottom in one new folder: TOML blocks are checked as printed and written to
the file that their first comment names; commands are parsed as printed and executed, with the flags of
`SMALLER` behind them; Python blocks share one namespace, and so does Python within sentences. What cannot
be executed here stands in `UNTRIED`, with the reason. A block of another kind is a mistake.
"""

import importlib.util
import os
import re
import runpy
import shlex
import shutil
import tomllib
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity
from asperity.app.campaign import read_plan
from asperity.app.cli import main
from asperity.app.cli.app import with_others
from asperity.app.config import config_from, read_tables
from tests.named import in_pages

ROOT = Path(__file__).parents[2]
PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "benchmarks/README.md")),
    *sorted((ROOT / "docs").glob("*.md")),
    *sorted((ROOT / "docs" / "studies").glob("*.md")),
]
FILES = (".csv", ".html", ".md", ".npy", ".png", ".toml", ".txt", ".zarr")
PRINTED = r"(?:sites in contact|from 1 s to a day): ([\d. ]+)"

SMALLER = {
    r"asperity run .*--times": "--quiet",
    r"asperity run .*(--(leg|history)|(history|sliding|measured).toml)": "--shape 48 48 --per-decade 1 -q",
    r"asperity run .*self_affine": "--size 32 --last 10 --per-decade 2 --quiet",
    r"asperity run problems/": "--quiet",
    r"asperity run .*--file": "--last 10 --per-decade 2 --quiet",
    r"asperity run .*--shape": "--last 10 --per-decade 2 --quiet",
    r"asperity run": "--shape 32 32 --last 10 --per-decade 2 --quiet",
    r"asperity predict": "--per-decade 1 --quiet",
    r"asperity law": "--per-decade 1 --quiet",
    r"asperity sliding(?! config)": "--per-decade 1 --quiet",
    r"asperity infer": "--quiet",
    r"asperity sweep(?!.*--dry-run)": "--workers 1 --quiet",
}
"""Flags behind a command, by the beginning of its line; the first that matches."""

FEWER = {"seeds = 32": "seeds = 2", "shape = [64, 64]": "shape = [16, 16]"}
"""What is replaced in a campaign before it is executed."""

UNTRIED = {
    r"asperity explore(?!.*--export)": "serves until it is stopped; tests/explore starts it",
    r"asperity reproduce": "takes minutes; tests/paper does it on tiny lattices",
    r"asperity study \w": "takes minutes; tests/studies does it on tiny lattices",
    r"asperity experiment .*--out": "takes minutes; tests/experiments does it on tiny lattices",
    r"asperity sweep .*--scheduler": "needs a cluster; tests/campaign has one of its own",
    r"make\b": "installs, or runs the tests and benchmarks themselves",
    r"(benchmarks/(peers/install|gpu\.sh)|\.venv/bin/python benchmarks/)": "tests/unit/test_benchmarks.py",
    r"# cluster.py": "starts jobs on a cluster",
}
"""Why a line, or a Python block by its first line, is only checked."""

RESEARCH = (
    r"asperity (experiment|reproduce|study|challenge)\b|asperity_research\."
    r"|\b(asp|asperity)\.(challenge|experiments|studies)\b"
)
"""What only a page has that shows the distribution asperity-research."""

LINK = r"\]\(((?!http)[^)#]+)[^)]*\)"
MADE = ("auto_gallery/", "reference/")
"""Folders that `make docs` fills; it refuses links to what is not in them."""


def first_match(rules, line):
    """What the first rule that fits a line says."""
    return next((said for pattern, said in rules.items() if re.match(pattern, line)), "")


def name_of(page):
    return str(page.relative_to(ROOT))


def blocks(page):
    """Languages and texts of the blocks of a page, less directives, whose names are in braces."""
    found = re.findall(r"^```(.*)\n((?:.*\n)*?)```$", page.read_text("utf-8"), flags=re.MULTILINE)
    return [(language, text) for language, text in found if not language.startswith("{")]


def write_configuration(text):
    """Check a TOML block as printed; write it, with fewer runs, to the file that it names."""
    file = re.match(r"# (\w+\.toml)\b", text)
    assert file, "a TOML block begins with the name of its file: # study.toml"
    path = Path(file[1])
    path.write_text(text, encoding="utf-8")
    if "sweep" not in tomllib.loads(text):
        config_from(read_tables(path), {}, path)
        return
    assert read_plan(path).runs
    for much, little in FEWER.items():
        text = text.replace(much, little)
    path.write_text(text, encoding="utf-8")


def commands(text):
    """Lines of a block for the shell; a backslash at the end of one continues it."""
    return [line.strip() for line in text.replace("\\\n", "").splitlines() if line.strip()]


def parse(words):
    with_others().parse_args(words, exit_on_error=False, print_error=False)


def execute(line, capsys):
    """Execute a line for the shell, or check what can be checked of it."""
    words = shlex.split(line, comments=True)
    untried = first_match(UNTRIED, line)
    if words[0] == "asperity":
        parse(words[1:])
        if not untried:
            status = main([*words[1:], *shlex.split(first_match(SMALLER, line))])
            assert status == 0, f"{line}\n{capsys.readouterr().err}"
    elif words[0] == "make":
        assert make_has(words[1]), line
    elif words[0] == "source":
        assert f"VENV := {words[1].removesuffix('/bin/activate')}\n" in (ROOT / "Makefile").read_text(), line
    elif words[:2] == ["pip", "install"]:
        assert words[2:] == ["."], line
    else:
        assert untried, f"{line}: no rule for this command"
        script = next(word for word in words if word.startswith("benchmarks/"))
        assert (ROOT / script).is_file(), line
        assert words[0] != script or os.access(ROOT / script, os.X_OK), line


def make_has(target):
    return re.search(rf"^{re.escape(target)}:", (ROOT / "Makefile").read_text(), flags=re.MULTILINE)


def surface_file(path):
    """Write what SurfaceTopography takes for a file of an instrument: it goes by the content."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from SurfaceTopography import Topography

        heights = np.random.default_rng(0).normal(size=(16, 16))
        Topography(heights, (1.0, 1.0), unit="um", periodic=False).to_netcdf(str(path))


LONG = {
    f"docs/{name}.md"
    for name in (
        *("adhesion", "campaigns", "challenge", "edges", "explore", "figures", "friction", "hardness"),
        *("histories", "indentation", "inference", "law", "predict", "rate_and_state", "sliding"),
        *("solids", "start", "surfaces"),
    )
}
"""Pages whose commands take more than a second."""


@pytest.mark.usefixtures("coarse_pictures")
@pytest.mark.parametrize(
    "page",
    [pytest.param(page, marks=[pytest.mark.slow] * (name_of(page) in LONG)) for page in PAGES],
    ids=name_of,
)
def test_what_a_page_shows_works(page, tmp_path, monkeypatch, capsys):
    for adds, what in (("asperity_research", RESEARCH), ("SurfaceTopography", r"scan\.opd")):
        if not importlib.util.find_spec(adds) and re.search(what, page.read_text("utf-8")):
            pytest.skip(f"the page shows what {adds} adds")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    if "scan.opd" in page.read_text(encoding="utf-8"):
        surface_file("scan.opd")
    data = Path(shutil.copytree(ROOT / "docs" / "data", "docs/data"))
    shutil.copy(data / "pmma_like_relaxation.csv", "relaxation.csv")
    shutil.copy(data / "force.csv", "force.csv")
    found = blocks(page)
    for language, text in found:
        assert language in ("sh", "toml", "python"), f"```{language}: no rule for this language"
        if language == "toml":
            write_configuration(text)
    for language, text in found:
        if language == "sh":
            for line in commands(text):
                execute(line, capsys)
        elif language == "python":
            code = compile(text, name_of(page), "exec")
            if not first_match(UNTRIED, text):
                capsys.readouterr()
                exec(code, names)
                for promised in re.findall(PRINTED, text):
                    assert capsys.readouterr().out.split() == promised.split()
    for phrase in in_pages(page):
        check_phrase(phrase, names)


def check_phrase(phrase, names):
    """Check code within a sentence: Python, a command or a target of make; `tests.named` looks up names."""
    dotted = re.match(r"([A-Za-z_]\w*)[\w.]*\w(?=$|[(\[])", phrase)
    root = dotted[1] if dotted and not phrase.endswith(FILES) else ""
    if phrase.startswith("asperity ") and not phrase.startswith("asperity -"):
        assert phrase.split()[1] in list(with_others()), phrase
    elif phrase.startswith("make "):
        assert make_has(phrase.split()[1]), phrase
    elif dotted and root in names and "..." not in phrase:
        eval(phrase, names)


def test_the_example_scan_is_the_one_that_its_script_makes():
    scan = ROOT / "docs" / "data" / "scan.txt"  # in nm, with a digit behind the point
    made = runpy.run_path(str(scan.with_suffix(".py")))
    np.testing.assert_allclose(np.loadtxt(scan), made["heights"](), atol=0.051)
    read = asperity.surfaces.read(scan, tilt="none")
    assert (read.unit, read.length_unit) == ("nm", "um")
    assert read.pixel_size == pytest.approx([made["PIXEL"]] * 2)
    assert scan.stat().st_size < 100_000


def test_every_exception_is_needed():
    printed = [block for page in PAGES for block in blocks(page)]
    lines = [line for language, text in printed if language == "sh" for line in commands(text)]
    lines += [text for language, text in printed if language == "python"]
    for pattern in (*UNTRIED, *SMALLER):
        assert any(re.match(pattern, line) for line in lines), pattern
    for much in FEWER:
        assert any(much in text for language, text in printed if language == "toml"), much


def test_links_lead_somewhere_and_the_source_distribution_holds_what_they_lead_to():
    tables = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    packed = set(tables["tool"]["hatch"]["build"]["targets"]["sdist"]["include"])
    assert packed >= {"Makefile", ".ci", "src", "tests", "benchmarks", "README.md"}
    assert all((ROOT / name).exists() for name in packed)
    for page in PAGES:
        for target in re.findall(LINK, page.read_text(encoding="utf-8")):
            place = (page.parent / target).resolve()
            assert target.startswith(MADE) or place.exists(), (page, target)
            assert place.relative_to(ROOT).parts[0] in packed, (page, target)


def test_pages_and_the_changelog_state_this_version():
    for page in PAGES:
        # A number may come from this minor version or the one before; what is offered is this very one.
        for stated in re.findall(r"(?:Asperity|[Vv]ersion) (\d+\.\d+(?:\.\d+)?)", page.read_text("utf-8")):
            (major, minor), present = (map(int, one.split(".")[:2]) for one in (stated, asperity.__version__))
            assert (major, minor + 1) >= (*present,) >= (major, minor), page
            assert page.name != "README.md" or stated == asperity.__version__
    assert f"Version {asperity.__version__}:" in (ROOT / "README.md").read_text(encoding="utf-8")
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    headings = re.findall(r"^## (.*)$", changes, flags=re.MULTILINE)
    parts = [re.findall(r"^(\d+)\.(\d+)\.(\d+), (\d{4}-\d\d-\d\d)$", heading) for heading in headings]
    order = [(*map(int, numbers), date) for ((*numbers, date),) in parts]
    assert order == sorted(order, reverse=True)
    assert headings[0].startswith(f"{asperity.__version__}, ")
