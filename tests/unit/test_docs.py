"""Pages: those made of the code hold all of it, their numbers are those of scripts, and they are short."""

import importlib
import re
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import asperity as asp
from asperity.aging import constant_area, controller, march
from asperity.app.cli.app import with_others
from asperity.app.config.keys import sections
from asperity.contact import Multigrid, active_set
from tests.named import ROOT, SOURCE, Source, in_docstrings, in_pages
from tests.surfaces import uncorrelated
from tests.unit.test_house import ROOMS, ROOMS_OF_RESEARCH

pytestmark = pytest.mark.xdist_group("docs")  # in one process, which makes the pages once
DOCS = ROOT / "docs"
PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "benchmarks/README.md")),
    *(*sorted(DOCS.glob("*.md")), *sorted(DOCS.glob("studies/*.md"))),
]


@pytest.fixture(scope="module")
def made():
    """Modules by name: those that make pages, and the benchmarks whose tables stand on pages."""
    names = ("reference", "house", "growth", "resolution")
    folders = [str(DOCS / "_ext"), str(ROOT / "benchmarks")]
    sys.path[:0] = folders
    try:
        yield {name: importlib.import_module(name) for name in names}
    finally:
        del sys.path[: len(folders)]
        for name in names:
            sys.modules.pop(name, None)


@pytest.fixture(scope="module")
def pages(made):
    return made["reference"].pages()


def test_every_public_name_has_a_page(made, pages):
    names = made["reference"].public()
    rooms = made["reference"].rooms()
    outside = {name.split(".")[1] for name in names if name.count(".") == 1}
    assert set(asp.__all__) == (set(rooms) - {"challenge", "experiments"}) | outside
    for room, module in rooms.items():
        assert {f"asperity.{room}.{name}" for name in module.__all__} <= set(names)
    for name in names:
        text = pages[f"{made['reference'].stem(name)}.rst"]
        home = re.search(r"The same as :py:obj:`(.*)`", text)
        assert names[home[1]] is names[name] if home else f":: {name}\n" in text


def test_every_page_is_in_the_navigation(made, pages):
    listed = set(
        re.findall(r"<((?:asperity\.|command-)[\w.-]+)>$", "\n".join(pages.values()), flags=re.MULTILINE)
    )
    for page in ("reference.md", "developers.md"):
        listed |= set(re.findall(r"^reference/(.+)$", (DOCS / page).read_text(), flags=re.MULTILINE))
    assert len({name.lower() for name in pages}) == len(pages)  # also where capitals do not count
    assert {name.removesuffix(".rst") for name in pages} <= listed


def test_every_command_and_flag_is_described(pages):
    commands = [name for name in with_others() if not name.startswith("-")]
    text = "".join(pages[f"command-{command}.rst"] for command in commands)
    for command in commands:
        assert f":doc:`{command} <command-{command}>`" in pages["commands.rst"]
        assert pages[f"command-{command}.rst"].startswith(f"asperity {command}\n===")
    assert "pytest" not in text
    for flag in ("--overwrite", "--k1", "--branch", "--pressure", "--dry-run", "--wlf"):
        assert f"``{flag}" in text


def test_every_key_is_described(pages):
    text = pages["keys.rst"]
    for section, kinds in sections().items():
        assert f"[{section}]" in text
        for kind, keys in kinds.items():
            part = text.split(f'``kind = "{kind}"``')[1] if kind else text.split(f"\n[{section}]\n")[1]
            part = part.split("``kind = ")[0]
            for name, key in keys.items():
                assert f"- ``{name}``" in part
                assert key.description in part.replace("\\", "")


def test_every_variable_of_a_dataset_is_described(pages):
    heights = asp.surfaces.gaussian((8, 8), rms=1.0, seed=0)
    scan = asp.surfaces.Surface(heights, unit="m", pixel_size=(1.0, 1.0), length_unit="m")
    creeping = asp.solids.half_space(modulus=1.0, branches=[(0.5, 1.0)])
    for surface, solid in ((heights, asp.solids.spring_lattice(k0=1, k1=3)), (scan, creeping)):
        contact = asp.press(surface, solid, load=1.0)
        data = asp.age(contact, [1.0], protocol=asp.protocols.Hold(1.0), fields_at=[1.0]).dataset
        assert not [name for name in data.variables if f"- ``{name}``" not in pages["dataset.rst"]]


def test_the_house_is_drawn_as_it_is(made, monkeypatch):
    house = made["house"]
    imports = house.rooms()
    monkeypatch.setattr(house, "rooms", lambda: imports)  # not read anew
    known = {room.removeprefix("app.") for rooms in ROOMS for room in rooms if not room.startswith("_")}
    assert set(imports) == known == {room for room, *_ in house.listed()}
    drawn = ElementTree.fromstring(house.drawing())
    assert {text.text for text in drawn.iter("{http://www.w3.org/2000/svg}text")} == known

    def reached(room, lines):
        return set().union(*({other} | reached(other, lines) for other in lines[room]))

    lines = house.needed(imports)
    assert sum(map(len, lines.values())) < sum(map(len, imports.values()))
    for room in imports:
        assert reached(room, lines) == reached(room, imports)


def rows_of(page):
    """Cells of the tables of a page, by the first cell."""
    cells = [
        line.strip("| \n").split(" | ")
        for line in page.read_text(encoding="utf-8").splitlines()
        if line[:1] == "|"
    ]
    return {first.strip(): [cell.strip() for cell in rest] for first, *rest in cells}


@pytest.mark.slow
@pytest.mark.parametrize("number", range(5))
def test_growth_is_what_the_page_says(made, number):
    case = list(made["growth"].CASES)[number]
    stated, decade, _ = rows_of(DOCS / "experiments.md")[case]
    mean, error = made["growth"].measured(case)
    assert [float(number) for number in stated.split(" ± ")] == pytest.approx([mean, error], abs=2e-4)
    assert float(decade.rstrip("%")) == pytest.approx(100 * (10**mean - 1), abs=0.1)


def test_all_growths_are_on_the_page(made):
    assert set(made["growth"].CASES) <= set(rows_of(DOCS / "experiments.md"))
    assert len(made["growth"].CASES) == 5
    said = re.findall(r"relaxes by ([\d.]+) an e-fold", (DOCS / "experiments.md").read_text())
    assert [float(rate) for rate in said] == pytest.approx([made["growth"].relaxation()], abs=1e-4)


def test_theory_is_what_the_page_says():
    text = (DOCS / "experiments.md").read_text()
    for rate, x2 in ((0.083, 100.0), (0.047, 1e6), (0.035, 1e9), (0.02, 3e18)):
        assert f"{rate:g} at " in text
        assert 1 / (np.log(x2) + 10 * np.log(2) + np.euler_gamma) == pytest.approx(rate, abs=6e-4)
        if x2 < 1e10:
            found = x2 * asp.theory.compliance_rate(3.0, x2) / asp.theory.compliance(3.0, x2)
            assert found == pytest.approx(rate, abs=1e-3)


def test_a_smaller_load_lets_the_area_fall_and_then_rise():
    heights = asp.surfaces.gaussian((200, 200), rms=1.0, seed=0)
    contact = asp.press(heights, asp.solids.spring_lattice(k0=1.0, k1=3.0), load=800.0)
    legs = [asp.protocols.Hold(1e3), asp.protocols.Step(load=200.0), asp.protocols.Hold(1.1e6)]
    data = asp.age(contact, 1e3 + np.geomspace(1e-2, 1e6, 17), protocol=legs).dataset
    area = data["area"].values[data["leg"].values == 2]
    assert area.min() / area[0] == pytest.approx(0.99, abs=0.005)
    assert area[-1] / area.min() == pytest.approx(1.22, abs=0.01)
    assert area.argmin() > 0


@pytest.mark.slow
def test_what_a_lattice_resolves_is_what_the_page_says(made):
    page = (DOCS / "units.md").read_text()
    for line in made["resolution"].tables(quick=True):
        assert line.replace("\\\\", "\\") in page, line


def test_tests_that_the_table_of_validation_names_are_there():
    named = re.findall(r"`(?:tests/)?([\w/]+\.py)(?:::(\w+))?`", (DOCS / "validation.md").read_text())
    assert len(named) > 30
    for file, test in named:
        places = [ROOT / "tests" / "physics" / file, ROOT / "tests" / file, ROOT / file]
        text = next(place for place in places if place.is_file()).read_text()
        assert f"def {test}(" in text or not test, (file, test)


def test_the_glossary_is_in_alphabetical_order():
    words = (DOCS / "notation.md").read_text("utf-8").split("{glossary}")[1]
    terms = re.findall(r"^(\S.*)\n    ", words, flags=re.MULTILINE)
    assert len(terms) > 10
    assert terms == sorted(terms, key=str.casefold)


@pytest.fixture(scope="module")
def source():
    return Source()


def test_what_pages_name_is_there(source):
    for page in PAGES:
        assert not {code: unknown for code in in_pages(page) if (unknown := [*source.unknown(code, page)])}, (
            page
        )


def test_what_docstrings_name_is_there(source):
    for file in sorted(SOURCE.rglob("*.py")):
        assert not {
            code: unknown for code in in_docstrings(file) if (unknown := [*source.unknown(code, file)])
        }, file


@pytest.mark.parametrize(
    "code",
    [
        *("STEP_TOLERANCE", "lattice.wave_numbers", "asp.pres", "asperity.checks.number", "fits.compares"),
        *("aging/marches.py", "cuts.py", "--poison 0.3", "summaries.txt", "Surface.edge", "age(x, tmies=1)"),
    ],
)
def test_a_false_name_is_found(source, code):
    assert [*source.unknown(code, DOCS / "start.md")]


def test_names_that_are_not_marked_as_code_are_looked_up_too(tmp_path, source):
    page = tmp_path / "page.md"
    page.write_text(
        "Set STEP_TOLERANCE, or --poison, as aging/marches.py does; --out and RATE_9 of [x](a/b.md)."
    )
    assert [code for code in in_pages(page) if [*source.unknown(code, DOCS / "start.md")]] == [
        *("STEP_TOLERANCE", "--poison", "aging/marches.py", "RATE_9")
    ]


def test_rooms_of_contributing_are_those_of_the_house():
    text = (ROOT / "CONTRIBUTING.md").read_text("utf-8").split("in one direction:")[1].split("Each folder")[0]
    library, app, research = re.split(r"app:|research:", text)
    for said, rooms in ((library, ROOMS), (app, ROOMS), (research, ROOMS_OF_RESEARCH)):
        prefix = "app." if said == app else ""
        stated = [{f"{prefix}{room.strip()}" for room in level.split(",")} for level in said.split("->")]
        mine = [{room for room in level if room.startswith("app.") == bool(prefix)} for level in rooms]
        assert stated == [level for level in mine if level and level != {"__main__"}]


@pytest.mark.parametrize(
    ("page", "sentence"),
    [
        ("accuracy", f"steps of error ({controller.TUNING.step_error:g} rtol)^1.5"),
        ("accuracy", f"may add {march.TUNING.unnoticed:g} of the allowed error"),
        ("accuracy", f"and {march.TUNING.published:g} in the last stage"),
        ("accuracy", f"At the default, {march.DEFAULT_RTOL * 1000:g}e-3"),
        ("histories", f"{100 * constant_area.TUNING.allowed:g} %, the step is repeated once"),
        ("histories", f"shorter than {constant_area.TUNING.lapse:g} in ln t"),
        ("histories", f"fewer than {constant_area.TUNING.fewest_sites} sites in contact"),
        ("design", f"did not solve in {Multigrid().max_cycles} cycles"),
        ("design", f"After {active_set.TUNING.careful_after} revisions"),
        ("design", f"residual has fallen to {active_set.TUNING.reduction:g}"),
    ],
)
def test_numbers_of_the_engine_are_what_a_page_says(page, sentence):
    assert sentence in " ".join((DOCS / f"{page}.md").read_text("utf-8").split())


@pytest.mark.parametrize("page", ["performance", "reproduction", "studies", "campaigns"])
def test_a_speed_on_a_page_names_its_version(page):
    text = (DOCS / f"{page}.md").read_text("utf-8")
    sections = re.split(r"^## ", text, flags=re.MULTILINE)
    timed = [one for one in sections if re.search(r"\d (ms|seconds|minutes|ns)\b|\bseconds\b.*\|\n\|-", one)]
    assert timed
    for section in timed:
        assert re.search(r"([Vv]ersions?|Asperity) 0\.\d+\.\d+", section), section.splitlines()[0]


def test_the_page_of_one_step_names_the_functions_in_the_order_of_their_calls():
    named = re.findall(r"^ *(\S+\.py) +(\w+) ", (DOCS / "design.md").read_text(), re.MULTILINE)
    called = []

    def note(frame, event, _):
        place = Path(frame.f_code.co_filename)
        if event == "call" and place.is_relative_to(SOURCE):
            one = place.relative_to(SOURCE).as_posix(), frame.f_code.co_name
            if one in named and one not in called:
                called.append(one)

    solid = asp.solids.half_space(modulus=1.0, branches=[(0.5, 1.0)])
    contact = asp.press(uncorrelated(8), solid, load=1.0)
    sys.setprofile(note)
    try:
        asp.age(contact, [5.0], protocol=asp.protocols.Ramp(10.0, load=2.0), exact=False)
    finally:
        sys.setprofile(None)
    assert called == named
    assert len(named) == 13


TEXTS = {
    page.relative_to(ROOT).as_posix(): page.read_text("utf-8")
    for page in PAGES
    if page.parent.name != "benchmarks"
}
LONGEST_PAGE, LONGEST_SENTENCE, ALL_PAGES = 2000, 35, 34_000

MEASURED = r"benchmarks/\w+\.(?:py|sh)|data/studies|AMD EPYC|NVIDIA|busy machine"
"""Scripts and machines, of which a page speaks that has measured numbers."""

DATED = r"(?:[Vv]ersions?|Asperity) 0\.\d+\.\d+|\(0\.\d+\.\d+|20\d\d-\d\d-\d\d"

UNDATED = {
    *("CONTRIBUTING.md", "docs/design.md"),  # they name scripts, and no numbers
    "docs/units.md",  # whose tables are computed anew, above
}


def words(text):
    """How many words a text has; the bars of a table are none."""
    return len(re.findall(r"\S*\w\S*", text))


def sentences(page):
    """Sentences of a page: code, tables, headings and formulas aside; a bullet is a paragraph of its own."""
    text = re.sub(r"^(```|:::).*\n(?:.*\n)*?\1 *$", "", page, flags=re.MULTILINE)
    lines = [line for line in text.splitlines() if not line.startswith(("|", "    ", "#", "!["))]
    text = "\n".join(f"\n{line}" if re.match(r" *- |\d+\. |: ", line) else line for line in lines)
    for paragraph in re.split(r"\n\s*\n", text):
        yield from re.split(r"(?<=[.!?:;])[\"')*]*\s+(?=[^a-z\s])", " ".join(paragraph.split()))


def long_sentences(page):
    return [one for one in sentences(page) if words(one) > LONGEST_SENTENCE]


@pytest.mark.parametrize("name", TEXTS)
def test_pages_and_their_sentences_are_short(name):
    assert words(TEXTS[name]) <= LONGEST_PAGE
    assert not long_sentences(TEXTS[name])


def test_the_documentation_is_short():
    pages = (page for name, page in TEXTS.items() if re.fullmatch(r"docs/\w+\.md", name))
    assert sum(len(page.split()) for page in pages) <= ALL_PAGES  # as wc -w counts


def test_a_long_sentence_is_found():
    table, beginning, end = f"| {'table ' * 40}|", "word " * 20, "word " * 36 + "end."
    assert [words(one) for one in long_sentences(f"# A\n\n{table}\n\n{beginning}`code`, {end}\n\n- B.")] == [
        58
    ]
    assert not long_sentences("word " * 30 + "end. " + "Word " * 30 + "\n- " + "word " * 30)


@pytest.mark.parametrize(
    "name", sorted(name for name in TEXTS if name not in UNDATED and re.search(MEASURED, TEXTS[name]))
)
def test_a_measured_number_says_when_it_was_measured(name):
    assert re.search(DATED, TEXTS[name])
