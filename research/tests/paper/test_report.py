"""The report: what it writes, that it stands alone, and that what it says was computed."""

import datetime
import math
import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from scipy.integrate import quad
from scipy.special import ndtr

from asperity.errors import InputError, OutputError
from asperity.fits.resampling import Estimate
from asperity.theory import GaussianHeights, compliance
from asperity_research.paper import report
from asperity_research.paper.corrections import corrections
from asperity_research.paper.figures.paper_figure import COLUMN, PAGE, PaperFigure
from asperity_research.paper.places import EQUATIONS, section_of
from asperity_research.paper.report import write_report
from asperity_research.paper.studies import QUICK, studies
from asperity_research.studies import typeset
from asperity_research.studies.ledger import Finding, Measurement, Verdict, exact
from asperity_research.studies.report import About, Simulated

DOCUMENTED = Path(__file__).parents[3] / "docs" / "paper.md"
CSS = Path(report.__file__).parent / "templates" / "report.css"
TABLE = pd.DataFrame({"time": [0.1, 1 / 3], "area": [3, 4]})


def estimate(value, half, runs=4):
    return Estimate(value, half / 3, value - half, value + half, runs)


def drawn(number, title="Area <i>A</i> against load", caption="1 < 2 & <i>F</i><sub>N</sub>"):
    figure = Figure(figsize=(COLUMN, 2))
    axes = figure.subplots()
    axes.plot([1, 2], [3, 4])
    axes.set_xlabel("load")
    return PaperFigure(number, title, caption, figure, {"area": TABLE, "relaxed state": TABLE})


def finding(key, place="Section 3", value=1.0, corrected=(), **words):
    measured = (Measurement("slope <i>s</i>", estimate(value, 0.05), 0.9, 1.1),)
    return Finding(key, place, f"The claim {key}.", measured, corrected, **words)


FINDINGS = (
    finding("late", "Section 5, Eq. (ndet2)"),
    finding("wrong", "Section 4, Fig. 5", 2.0, note="Not <script>alert(1)</script> & more."),
    finding("open", "Fig. 3", 1.08),
    finding(
        "mended",
        "Section 5",
        3.9,
        (Measurement("corrected", exact(1.003), 0.99, 1.01),),
        correction="with <i>k</i><sub>eff</sub>",
    ),
    Finding("unknown", "Section 2", "Nothing known.", (Measurement("n", exact(math.nan), 0, 1),)),
)


ABOUT = About(
    effort="quick",
    version="9.8.7",
    date=datetime.date(2030, 1, 2),
    command="asperity reproduce --out here --quick",
    wall_seconds=75.0,
    run_seconds=3661.0,
    studies=tuple(Simulated(study, 7, study.name) for study in studies(QUICK)),
)


class Page:
    """A page, whose tags must be closed in turn."""

    def __init__(self, path):
        closed = re.sub(r"<(meta|img|br)\b([^>]*)>", r"<\1\2/>", path.read_text(encoding="utf-8"))
        self.folder, self.root = path.parent, ElementTree.fromstring(closed)
        self.tags = {one.tag for one in self.root.iter()}
        self.words = "".join(self.root[1].itertext())
        self.text = " ".join(self.words.split())

    def values(self, attribute):
        return [one.get(attribute) for one in self.root.iter() if attribute in one.attrib]


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    wide = drawn(8)
    wide.figure.set_figwidth(PAGE)
    return Page(write_report(tmp_path_factory.mktemp("reproduction"), [drawn(2), wide], FINDINGS, ABOUT))


def test_figures_and_tables_lie_beside_the_page(page):
    for number in (2, 8):
        drawings = [page.folder / "figures" / f"figure-{number}.{suffix}" for suffix in ("svg", "pdf", "png")]
        assert [path.read_bytes()[:4] for path in drawings] == [b"<?xm", b"%PDF", b"\x89PNG"]
        for name in ("area", "relaxed-state"):
            table = pd.read_csv(page.folder / "data" / f"figure-{number}-{name}.csv")
            pd.testing.assert_frame_equal(table, TABLE, check_exact=True)
    names = {path.name for path in page.folder.iterdir()}
    assert names == {"figures", "data", "ledger.csv", "ledger.md", "report.html"}
    assert "<text" not in (page.folder / "figures" / "figure-2.svg").read_text()  # its letters need no font


def test_page_stands_alone_and_its_links_lead_somewhere(page):
    assert not {"script", "link", "iframe", "object"} & page.tags
    assert all(source.startswith("data:image/svg+xml;base64,") for source in page.values("src"))
    assert not re.search(r"url\(|@import", CSS.read_text())
    names = page.values("id")
    assert len(set(names)) == len(names)
    assert set(page.values("aria-labelledby")) <= set(names)
    for target in page.values("href"):
        assert ":" not in target, f"{target} leaves the folder"
        if target.startswith("#"):
            assert target[1:] in names
        elif not target.endswith("campaign.toml"):
            assert (page.folder / target).is_file()
    assert [name for name in page.values("class") if name.startswith("picture")] == [
        "picture",
        "picture wide",
    ]
    assert [words.split(":")[0] for words in page.values("alt")] == ["Figure 2", "Figure 8"]


def test_page_says_what_was_found(page):
    for words in (
        "5 claims were put to the test: 1 agrees, 1 agrees once corrected, 1 differs and 2 cannot",
        "To decide it: about 25 seeds in place of 4.",
        "Corrected: with keff.",
        "1.080 [1.030, 1.130]",
        "not determined",
        "Not <script>alert(1)</script> & more.",
        "1 < 2 & FN",
        f"{7 * len(studies(QUICK))} simulations",
        "61 minutes of computing in all; the session that wrote this page took 75 seconds",
        "Asperity 9.8.7, 2030-01-02, quick reproduction.",
        "Section 5, Eq. (17)",
    ):
        assert words in page.text
    assert "shape = 200\N{NO-BREAK SPACE}×\N{NO-BREAK SPACE}200" in page.words
    assert not [label for label in EQUATIONS if f"Eq. ({label})" in page.text]
    claims = [name for name in page.values("id") if name.startswith("claim-")]
    assert claims == ["claim-unknown", "claim-open", "claim-wrong", "claim-late", "claim-mended"]
    shown = [name for name in page.values("id") if name.startswith("correction-")]
    assert shown == [f"correction-{entry.key}" for entry in corrections()]


def test_page_says_what_an_undecided_correction_needs_and_praises_whole_sections(tmp_path):
    corrected = (Measurement("corrected", estimate(1.08, 0.05), 0.9, 1.1),)
    differs = finding("mended", "Section 5", 3.9, corrected, correction="by half")
    page = Page(write_report(tmp_path, [], [finding("a", "Section 2"), differs], ABOUT))
    assert differs.verdict is Verdict.UNDECIDED
    assert "about 25 seeds in place of 4" in differs.needs
    assert "It differs as it stands; its correction is undecided. To decide it" in page.text
    assert f"The correction is undecided. To decide it: {differs.needs}." in page.text
    assert "Every claim of Section 2 agrees." in page.text


def test_ledger_as_a_table_and_as_a_file(page):
    first, *rows = (page.folder / "ledger.md").read_text(encoding="utf-8").splitlines()
    made_of = f"{7 * len(studies(QUICK))} simulations, 5 claims."
    assert first == f"The quick reproduction, Asperity 9.8.7, 2030-01-02: {made_of}"
    assert rows[:4] == ["Agrees: 1;", "Agrees once corrected: 1;", "Differs: 1;", "Undecided: 2."]
    assert rows[7:] == [
        "| Nothing known. | Section 2 | undecided | not determined |",
        "| The claim open. | Fig. 3 | undecided | 1.080 [1.030, 1.130] |",
        "| The claim wrong. | Section 4, Fig. 5 | differs | 2.000 [1.950, 2.050] |",
        "| The claim late. | Section 5, Eq. (ndet2) | agrees | 1.000 [0.950, 1.050] |",
        "| The claim mended. | Section 5 | agrees once corrected | 3.900 [3.850, 3.950] — corrected: 1.003 |",
    ]
    table = pd.read_csv(page.folder / "ledger.csv")
    assert len(table) == sum(len(f.measured) + len(f.corrected) for f in FINDINGS)
    mended = table[table["key"] == "mended"].set_index("judged")
    assert dict(mended["value"]) == {"as it stands": 3.9, "corrected": 1.003}
    assert set(mended["verdict"]) == {"agrees once corrected"}
    assert set(mended["correction"]) == {"with k_eff"}
    assert table["value"].isna().sum() == 1


def test_page_is_written_last_and_the_same_each_time(tmp_path):
    first, again = (write_report(tmp_path / name, [drawn(1)], FINDINGS, ABOUT) for name in "ab")
    assert first.read_bytes() == again.read_bytes()
    with pytest.raises(InputError, match="tags i, sub and sup that are closed"):
        write_report(tmp_path / "c", [], [finding("a", note="<i>open")], ABOUT)
    (tmp_path / "d" / "ledger.csv").mkdir(parents=True)
    with pytest.raises(OutputError, match=r"could not write .*ledger\.csv"):
        write_report(tmp_path / "d", [drawn(1)], FINDINGS, ABOUT)
    assert not list(tmp_path.glob("[cd]/report.html"))
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="could not write"):
        write_report(tmp_path / "file", [], [], ABOUT)


@pytest.mark.parametrize(
    ("place", "section"),
    [("Section 3; Fig. 8", 3), ("Sections 4 to 5", 4), ("Fig. 3", 3), ("Fig. 7 caption", 4), ("Fig. 9", 6)],
)
def test_section_of_a_place(place, section):
    assert section_of(place) == f"Section {section}"


@pytest.mark.parametrize(
    ("say", "given", "said"),
    [
        (typeset.number, 0.0, "0"),
        (typeset.number, 1 / 3, "0.3333"),
        (typeset.number, 2.0, "2"),
        (typeset.number, 0.99996, "1"),
        (typeset.number, -0.40396, "−0.404"),
        (typeset.number, 12345.6, "12346"),
        (typeset.number, 99999.7, "100000"),
        (typeset.number, 123456.0, "1.235 × 10<sup>5</sup>"),
        (typeset.number, 1e-9, "10<sup>−9</sup>"),
        (typeset.number, 2.3e-12, "2.3 × 10<sup>−12</sup>"),
        (typeset.number, -math.inf, "−∞"),
        (typeset.interval, estimate(0.803, 0.012), "0.803 [0.791, 0.815]"),
        (typeset.interval, estimate(1234.5, 150.0), "1234 [1084, 1384]"),
        (typeset.interval, estimate(123456.0, 3400.0), "(1.235 [1.201, 1.269]) × 10<sup>5</sup>"),
        (typeset.interval, estimate(3.2e-7, 2e-8), "(3.20 [3.00, 3.40]) × 10<sup>−7</sup>"),
        (typeset.interval, estimate(0.0, 0.5), "0.00 [−0.50, 0.50]"),
        (typeset.interval, exact(1 / 3), "0.3333"),
        (typeset.interval, exact(0.0), "0"),
        (typeset.interval, estimate(1.0, 1e-12), "1"),
        (typeset.interval, estimate(1e-12, 1e-13), "(1.00 [0.90, 1.10]) × 10<sup>−12</sup>"),
        (typeset.interval, estimate(0.31, math.nan), "0.31"),
        (typeset.interval, estimate(math.nan, math.nan), "not determined"),
        (lambda ends: typeset.bounds(*ends), (0.9, 1.1), "0.9 to 1.1"),
        (lambda ends: typeset.bounds(*ends), (-math.inf, 1e-3), "at most 0.001"),
        (lambda ends: typeset.bounds(*ends), (2, math.inf), "at least 2"),
        (lambda ends: typeset.bounds(*ends), (1, 1), "1"),
        (lambda ends: typeset.bounds(*ends), (-math.inf, math.inf), "any number"),
        (typeset.rich, "<i>a</i> < b <b>&amp;", "<i>a</i> &lt; b &lt;b&gt;&amp;amp;"),
        (
            typeset.plain,
            "<i>F</i><sub>N</sub><sup>0.8</sup> 10<sup>6</sup> x<sup>2</sup>",
            "F_N^(0.8) 10^6 x^2",
        ),
        (report.rich_numbered, "from 1 to 1e+06, then", "from 1 to 10<sup>6</sup>, then"),
        (report.rich_numbered, "<i>x</i> < 2.5e-05", "<i>x</i> &lt; 2.5 × 10<sup>−5</sup>"),
        (report.rich_numbered, "1e+09 and 3e+10", "10<sup>9</sup> and 3 × 10<sup>10</sup>"),
        (report.rich_numbered, "file1e+06, 1e6 and 1e+06x", "file1e+06, 1e6 and 1e+06x"),
        (report.rich_numbered, "Eqs. (uq), (u); Fig. 8", "Eqs. (6), (8); Fig. 8"),
        (report.rich_numbered, "Eq. (vt) to Eq. (ndet) (a)", "Eq. (11) to Eq. (16) (a)"),
        (report.rich_numbered, "Eqs. (a) and (log)", "Eqs. (4) and (5)"),
        (report.rich_numbered, "Eq. (7), Eq. (new)", "Eq. (7), Eq. (new)"),
    ],
)
def test_numbers_and_texts_as_they_are_set(say, given, said):
    assert say(given) == said


def test_colors_have_contrast():
    style, paper = CSS.read_text(), luminance("#f4f5f7")
    for name in ("ink", "soft", "link", "agrees", "corrected", "differs", "undecided"):
        color = re.search(rf"--{name}: (#\w{{6}})", style)
        assert color is not None
        assert (paper + 0.05) / (luminance(color[1]) + 0.05) > 4.5, name  # WCAG 2.1, level AA


def luminance(color):
    channels = [int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def test_each_correction_has_its_proof_in_the_documentation():
    headings = re.findall(r"^### (.+)$", DOCUMENTED.read_text(), flags=re.MULTILINE)
    assert [entry.title for entry in corrections()] == headings
    assert all(re.fullmatch(r"[a-z0-9-]+", entry.key) for entry in corrections())


@pytest.fixture(scope="module")
def numbers():
    return {entry.key: [value for _, value in entry.numbers] for entry in corrections()}


def waves(n):
    q = 2 * np.pi * np.arange(n) / n
    return np.add.outer(2 - 2 * np.cos(q), 2 - 2 * np.cos(q))


def test_stiffness_of_a_contact_by_brute_force(numbers):
    brute = [1 / np.mean(1 / (x1 + waves(512))) / x1 for x1 in (1.0, 3.0, 10.0)]
    assert numbers["contact-stiffness"] == pytest.approx(brute, rel=1e-12)


def test_energy_of_a_lone_contact_by_brute_force(numbers):
    lam = waves(64).ravel()[1:]
    before, after = (np.sum(1 / (3 + lam)), np.sum(1 / lam))
    assert numbers["falling-energy"] == pytest.approx([(1 / 3 + after) / (1 / 3 + before)], rel=1e-12)


def test_intercept_on_the_square_zone(numbers):
    catalan = 0.915965594177219015
    closed = (4 * math.log(2 * math.pi) + np.euler_gamma - 8 * catalan / math.pi) / (8 * math.pi)
    assert numbers["laplacian"][1] == pytest.approx(closed, abs=1e-7)


def test_gaussian_integral_by_quadrature(numbers):
    law = GaussianHeights()
    before, after = (float(law.separation_for(1e-3 * compliance(3.0, x2))) for x2 in (0.0, 1e4))
    grown = quad(lambda d: ndtr(-d), after, before)[0]
    assert grown == pytest.approx(1e-3 * float(compliance(3.0, 1e4) - compliance(3.0, 0.0)), rel=1e-9)
    assert numbers["gaussian-integral"] == pytest.approx([ndtr(-after)], rel=1e-9)
    assert numbers["lost-sign"] == pytest.approx([after - before])


def test_rates_by_differences(numbers):
    step = 1e-3
    for which, x1 in enumerate((1.0, 10.0)):
        later, earlier = (float(compliance(x1, 1e6 * math.exp(sign * step))) for sign in (1, -1))
        relative = math.log(later / earlier) / (2 * step)
        assert numbers["aging-rate"][2 * which + 1] == pytest.approx(relative, rel=1e-5)
        assert relative == pytest.approx(1 / (math.log(1e6) + 10 * math.log(2) + np.euler_gamma), rel=1e-3)
    assert numbers["viscous-slope"][:3] == sorted(numbers["viscous-slope"][:3])
    assert numbers["viscous-slope"][2] == pytest.approx(2, rel=1e-3)
