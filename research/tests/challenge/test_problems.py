"""Reference problems: their heights, their answers, and scores of answers."""

import dataclasses
import importlib
import math
import os
import sys
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.refusals import refuses

import asperity as asp
import asperity_research.challenge as challenge
from asperity.app.config import read_config
from asperity_research.challenge.heights import independent, outputs, waves

BENCHMARKS = Path(__file__).parents[3] / "benchmarks"
SCAN = Path(os.environ.get("ASPERITY_DATA", "")) / "mi-1.mi"
MADE = [one.name for one in challenge.problems() if one.heights["rule"] != "scan"]


def splitmix(seed, count):
    """The published algorithm, with the integers of Python."""
    words, state = [], seed
    for _ in range(count):
        state = (state + 0x9E3779B97F4A7C15) % 2**64
        z = state
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9 % 2**64
        z = (z ^ (z >> 27)) * 0x94D049BB133111EB % 2**64
        words.append(z ^ (z >> 31))
    return words


def number(words):
    """The normal number of three outputs."""
    return (sum(word >> shift & 0xFFFF for word in words for shift in (0, 16, 32, 48)) - 393210) / 65536


def test_random_numbers_are_those_of_splitmix64():
    # Origin: the first output of the published C code for seed 0.
    assert splitmix(0, 1) == [0xE220A8397B1DCDAF]
    for seed in (0, 101, 2**63 + 7):
        assert outputs(seed, 1, 50).tolist() == splitmix(seed, 50)
    assert outputs(5, 11, 4).tolist() == splitmix(5, 14)[10:]


def test_independent_heights_are_sums_of_parts_row_by_row():
    heights = independent(6, seed=9)
    words = splitmix(9, 3 * 36)
    assert heights.ravel().tolist() == [number(words[3 * k : 3 * k + 3]) for k in range(36)]
    large = independent(256, seed=101)
    assert abs(large.mean()) < 4 / 256
    assert abs(large.std() - 1) < 4 / 256 / math.sqrt(2)


def bspline(t):
    """The uniform cubic B-spline around 0."""
    t = abs(t)
    return 2 / 3 - t * t + t**3 / 2 if t < 1 else max(2 - t, 0) ** 3 / 6


def test_waves_are_sums_of_splines():
    heights = waves(4, octaves=2, ratio=0.6, halvings=1, seed=3)
    words = splitmix(3, 3 * (4**2 + 8**2))
    expected, used = np.zeros((16, 16)), 0
    for octave, n in enumerate((4, 8)):
        step = 16 // n
        for k in range(n * n):
            # A basis function that is wider than half the period meets itself.
            row, column = (
                [sum(bspline((i - step * j + 16 * w) / step) for w in (-1, 0, 1)) for i in range(16)]
                for j in divmod(k, n)
            )
            expected += 0.6**octave * number(words[used : used + 3]) * np.outer(row, column)
            used += 3
    np.testing.assert_allclose(heights, expected, atol=1e-13)


def test_a_finer_lattice_holds_the_sites_of_a_coarser_one():
    made = challenge.problem("self-affine")
    coarse, fine = (made.surface(halvings=n) for n in (0, 1))
    np.testing.assert_allclose(fine.heights[::2, ::2], coarse.heights, atol=1e-14)
    assert fine.in_meters()[1][0] == coarse.in_meters()[1][0] / 2


def test_any_type_of_number_gives_the_same_answer():
    rule = {"rule": "waves", "grid": 2, "octaves": 2, "ratio": 0.5, "halvings": 1, "seed": 1}
    made = challenge.problem("relaxing-half-space")
    small = dataclasses.replace(made, heights=rule | {"unit": "um", "side": 8.0})
    usual = challenge.solve(small, rtol=2.0**-5, halvings=1)
    for real, whole in ((np.float32, np.int64), (Decimal, np.uint8), (Fraction, np.int32)):
        numbers: dict[str, Any] = {"rtol": real(2.0**-5), "halvings": whole(1)}
        found = challenge.solve(small, **numbers)
        assert all(np.array_equal(found[name], usual[name]) for name in usual)
    wrongs = (("rtol", "0.01"), ("rtol", True), ("halvings", 1.0), ("halvings", True), ("halvings", -1))
    for name, value in wrongs:
        wrong: dict[str, Any] = {name: value}
        with refuses(name, value):
            challenge.solve(small, **wrong)


def test_only_a_continuum_has_something_between_its_sites():
    with refuses("halvings", "1"):
        challenge.problem("dense").surface(halvings=1)


def test_answers_are_whole_and_known_as_well_as_the_page_says():
    page = (Path(__file__).parents[3] / "docs" / "challenge.md").read_text(encoding="utf-8")
    assert len(challenge.problems()) == 8
    for one in challenge.problems():
        answer, times = one.answer, one.run["aging"]["times"]
        assert answer.abscissa.size == len(times)
        if one.abscissa.name == "time":
            assert answer.abscissa.tolist() == times
        assert answer.origin[0] == f"problem: {one.name}"
        for column in one.asked:
            bars, values = answer.bars[column.name], answer.values[column.name]
            parts = sum(answer.parts[column.name, part] for part in ("time", "solver", "lattice"))
            assert np.isfinite(values).all()
            assert (bars > 0).all()
            assert (bars >= parts * 0.99).all()
            known = np.median(bars[values != 0] / np.abs(values[values != 0]))
            assert known <= column.tolerance, f"{one.name} does not know {column.name} to its own tolerance"
            stated = f"| {100 * known:.1g} % | {100 * column.tolerance:g} % |"
            assert f"| `{one.name}` | `{column.heading}` {stated}" in page


@pytest.mark.slow
@pytest.mark.parametrize("name", MADE)
def test_answers_lie_within_their_bars(name):
    made = challenge.problem(name)
    found = challenge.solve(name, rtol=1e-3 if made.continuous else 1e-4, halvings=2 * made.continuous)
    score = challenge.score(found, name)
    assert score.agrees
    for one in score.quantities:
        assert one.verdict == "within the error bars", one.in_bars


@pytest.mark.slow
@pytest.mark.parametrize("name", MADE)
def test_the_usual_tolerance_and_lattice_agree(name):
    assert challenge.score(challenge.solve(name), name).agrees


@pytest.mark.skipif(not SCAN.is_file(), reason="needs ASPERITY_DATA")
def test_the_scan_at_time_0():
    made = challenge.problem("measured-scan")
    at_once = dataclasses.replace(made, run={**made.run, "aging": {"times": [0.0]}})
    score = challenge.score(challenge.solve(at_once, scan=SCAN), made.name)
    assert (score.places, score.asked) == (1, 8)
    assert not score.agrees
    assert [one.verdict for one in score.quantities] == ["within the error bars"] * 2


@pytest.fixture
def certify(monkeypatch):
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    yield importlib.import_module("certify")
    sys.modules.pop("certify")


def test_the_second_solver_shares_nothing_and_finds_the_same(certify):
    surface = asp.surfaces.Surface(
        waves(4, octaves=3, ratio=0.57, halvings=2, seed=5), "um", (1.5, 1.5), "um"
    )
    heights, spacing = surface.in_meters()
    pressure, gap = certify.polonsky_keer(heights, spacing, 2e9, 0.05)
    contact = asp.press(surface, asp.solids.half_space(modulus=2e9), load=0.05)
    assert np.array_equal(pressure > 0, contact.in_contact)
    np.testing.assert_allclose(pressure, contact.pressure, atol=1e-6 * contact.pressure.max())
    assert abs(gap.mean() / contact.mean_gap - 1) < 1e-8


def test_its_creep_is_that_of_the_series(certify):
    branches = [(0.3, 0.1), (0.3, 1.0), (0.2, 10.0)]
    times = np.array([0.0, 0.05, 1.0, 30.0])
    series = asp.relaxation.PronySeries(1.0, tuple(branches))
    np.testing.assert_allclose(certify.creep(branches, times), series.compliance_at(times), rtol=1e-10)


def certified(name):
    """The answer as somebody's result."""
    made = challenge.problem(name)
    columns = {column.heading: made.answer.values[column.name].copy() for column in made.asked}
    return made, {made.abscissa.heading: made.answer.abscissa} | columns


def test_the_certified_answer_has_no_deviation():
    for name in challenge.NAMES:
        score = challenge.score(certified(name)[1], name)
        assert score.agrees
        for one in score.quantities:
            assert one.verdict == "within the error bars"
            assert not one.in_bars.any()
            assert not one.relative.any()
        assert challenge.score_figure(score).axes


def test_verdicts_and_what_they_follow_from():
    made, columns = certified("dilute")
    bar, area = made.answer.bars["area"], made.answer.values["area"]
    for given, verdict in (
        (area + 0.99 * bar, "within the error bars"),
        (area + bar + 0.009 * area, "within the tolerance"),
        (area + bar + 0.011 * area, "off"),
        (np.where(np.arange(area.size) == 3, 0.97 * area, area), "off"),
    ):
        score = challenge.score(columns | {"area": given}, "dilute")
        first, second = score.quantities
        assert (first.verdict, second.verdict) == (verdict, "within the error bars")
        assert score.agrees == (verdict != "off")
    assert first.relative[3] == pytest.approx(-0.03)
    assert first.in_bars[3] == pytest.approx(-0.03 * area[3] / bar[3])


def test_a_part_of_an_answer_is_scored_and_does_not_agree():
    made, columns = certified("dilute")
    few = {key: values[2:5] for key, values in columns.items() if key != "approach"}
    score = challenge.score(few, "dilute")
    assert (score.places, score.asked, score.missing) == (3, 10, ("approach",))
    (one,) = score.quantities
    assert one.abscissa.tolist() == made.answer.abscissa[2:5].tolist()
    assert one.verdict == "within the error bars"
    assert not score.agrees


def test_the_last_of_several_rows_counts_and_others_are_left_alone(tmp_path):
    made, columns = certified("dense")
    rows = [[5.5, 1, 1], [1.0, 2, 2], *np.transpose(list(columns.values())).tolist()]
    file = tmp_path / "mine.csv"
    file.write_text(
        "# my code, version 3\n# Problem: dense\ntime;area;approach;more\n"
        + "".join(f"{t:.9g};{a:.0f};{x:.10g};7\n" for t, a, x in rows)
    )
    score = challenge.score(file)
    assert score.problem is made
    assert score.agrees
    file.write_text("time,area\n0,8498\n")
    with pytest.raises(asp.errors.InputError, match="problem: NAME"):
        challenge.score(file)


@pytest.mark.parametrize(
    "change",
    [
        {"name": "densse"},
        {"area": None, "approach": None},
        {"time": None},
        {"time": np.linspace(1e6, 2e6, 10)},
        {"area": np.arange(3.0)},
        {"area": [1.0] * 9 + [math.nan]},
    ],
    ids=["unknown", "no quantity", "no time", "other times", "lengths", "no number"],
)
def test_columns_that_are_no_answer_are_refused(change):
    _, columns = certified("dense")
    columns |= change
    name = columns.pop("name", "dense")
    given = {key: values for key, values in columns.items() if values is not None}
    with refuses("result" if name == "dense" else "problem"):
        challenge.score(given, name)


def test_inputs_say_all_that_is_needed(tmp_path):
    assert len(challenge.write(tmp_path)) == 1
    for one in challenge.problems():
        folder = tmp_path / one.name
        words = (folder / "problem.txt").read_text()
        assert one.title in words
        named, headings, *places = (folder / "answer.csv").read_text().splitlines()
        assert named == f"# problem: {one.name}"
        assert headings.split(",") == [one.abscissa.heading, *(column.heading for column in one.asked)]
        assert len(places) == one.answer.abscissa.size
        if one.heights["rule"] == "scan":
            assert not (folder / "heights.npy").exists()
            assert "SHA-256" in words
            continue
        heights = np.load(folder / "heights.npy")
        assert np.array_equal(heights, one.surface().heights)
        if one.name == "dense":
            assert np.array_equal(np.loadtxt(folder / "heights.csv", delimiter=","), heights)
        config = read_config(folder / "run.toml", {})
        given = config.surface.build()
        if one.continuous:
            (found, spacing), (made, step) = given.in_meters(), one.surface().in_meters()
            np.testing.assert_allclose(found, made, rtol=1e-12)
            assert spacing == pytest.approx(step)
        assert given.shape == heights.shape
        assert (config.solid, config.protocol, config.aging) == (one.config.solid, one.legs, one.config.aging)


def test_another_scan_is_refused(tmp_path):
    made = challenge.problem("measured-scan")
    with refuses("scan", "none"):
        made.surface()
    (tmp_path / "mi-1.mi").write_bytes(b"something else")
    with pytest.raises(asp.errors.InputError, match="something else"):
        made.surface(scan=tmp_path / "mi-1.mi")
    with pytest.raises(asp.errors.InputError, match=r"mi-1\.mi"):
        challenge.write(tmp_path / "out", scan=tmp_path / "mi-1.mi")
    assert not (tmp_path / "out").exists()
