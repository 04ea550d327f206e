"""``asperity fit``: what it says of a table, what it writes, and its mistakes."""

import json
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.collections import LineCollection

from asperity.figures import fit_figure
from asperity.fits import compare, growth_rate, logarithm, measured_growth
from tests.cli.conftest import remarks

HOLD = np.repeat(np.geomspace(1, 1e5, 11), 3)


@pytest.fixture
def friction():
    """Static friction against hold time, also in mu.csv: unsorted, decimal commas, Windows line ends."""
    rng = np.random.default_rng(1)
    mu = 0.6 + 0.01 * np.log10(1 + HOLD / 2) + 0.002 * rng.normal(size=HOLD.size)
    rows = np.round(np.column_stack([HOLD, mu]), 6)[rng.permutation(HOLD.size)]
    text = "\r\n".join(f"{t:.6f};{m:.6f};0.002".replace(".", ",") for t, m in rows)
    Path("mu.csv").write_bytes(f"hold time;mu;error\r\n{text}\r\n".encode("utf-8-sig"))
    return rows


def line(text, name):
    """What stands beside the first such name."""
    lines = (line.strip() for line in text.splitlines())
    return next(line.removeprefix(name) for line in lines if line.startswith(name))


def legend_of(figure):
    """The words of the legend, below each other."""
    (legend,) = figure.legends
    return "\n".join(["", *(text.get_text() for text in legend.get_texts())])


def test_friction_in_words_figure_and_numbers(says, friction):
    words = ("--quantity", "static friction", "--unit-time", "s", "--window", "10", "1e5", "--json", "n.json")
    text = says("fit", "mu.csv", *words)
    read = "mu.csv: time from 'hold time' without a unit, value from 'mu', 33 rows; left out 'error'"
    assert line(text, "read").strip() == read
    assert line(text, "quantity").strip() == "static friction"
    assert line(text, "data").strip() == "33 values; times 1 to 100000 s"
    assert line(text, "saturation").strip() == "A0 [a - (a - 1)/(1 + t/t0)^q]"
    assert line(text, "logarithm").strip() == "A0 [1 + C ln(1 + t/t0)]"
    time, mu = friction.T
    rate = growth_rate(time, mu, first=10, initial=0.6)
    per_decade = re.search(r"95 %: (\S+) to (\S+)\)", line(text, "per decade "))
    low, high = (float(word) for word in per_decade.groups())
    ends = [np.log(10) * end for end in rate.interval("slope")]
    assert (low, high) == pytest.approx(ends, abs=np.log(10) * rate.slope_stderr / 10)
    assert low < 0.01 < high
    assert "the data prefer the logarithm: no sign" in text or "these data do not tell" in text
    assert "figure written: fit.png; its data: fit.csv\nnumbers written: n.json\n" in text
    assert Path("fit.png").read_bytes().startswith(b"\x89PNG")
    found, fit = json.loads(Path("n.json").read_text()), logarithm(time, mu)
    written, straight = found["fits"]["logarithm"], found["straight_line"]
    assert written["C"]["value"] == pytest.approx(fit.C, rel=1e-9)
    assert written["C"]["interval"] == pytest.approx(fit.interval("C"), rel=1e-9)
    assert found["fits"]["saturation"]["q"]["stderr"] > 0
    # The names of the screen, and slopes both ways.
    assert written["A0"]["value"] == pytest.approx(fit.initial_area, rel=1e-9)
    assert written["slope_per_efold"]["value"] == pytest.approx(fit.slope, rel=1e-9)
    assert written["slope_per_decade"]["stderr"] == pytest.approx(np.log(10) * fit.slope_stderr, rel=1e-9)
    assert "slope A0 C per decade" in text
    assert straight["points"] == rate.points
    assert straight["B_per_decade"]["interval"][0] < straight["B_per_decade"]["value"]
    assert found["comparison"]["verdict"] == compare(time, mu).verdict


def test_columns_and_standard_errors(says, friction):
    words = "--column-value mu --column-stderr 2 --law logarithm --out a.pdf"
    text = says("fit", "mu.csv", *words.split())
    assert [name in text for name in ("reduced chi²", "saturation", "AICc")] == [True, False, False]
    assert Path("a.pdf").read_bytes().startswith(b"%PDF")


def test_the_table_of_a_run(says, finished):
    text = says("fit", finished / "aging.csv")
    assert line(text, "data").strip() == "10 values, 1 of them at time 0; times 0.001 to 10"
    assert line(text, "A0 ").endswith(", as given, taken as exact")
    assert "measured at time 0" in text


def test_what_is_to_be_known_of_a_fit_is_noted(says, friction):
    scatter = np.random.default_rng(9).normal(size=20)
    hold, long = np.geomspace(1, 1e4, 20), np.geomspace(1e-2, 1e4, 40)
    three = np.repeat([1.0, 10.0, 100.0], 5)
    np.savetxt("still.txt", np.column_stack([hold, 0.6 + 0.01 * scatter]))
    np.savetxt("three.txt", np.column_stack([three, 0.6 + 0.01 * np.log10(three) + 1e-3 * scatter[:15]]))
    np.savetxt("curve.txt", np.column_stack([long, 4 - 3 * np.exp(-((long / 10) ** 0.3))]))
    pd.DataFrame(friction, columns=["hold", "mu"]).to_csv("pandas.csv")
    for name in ("still.txt", "three.txt", "curve.txt", "pandas.csv"):
        window = ("--window", "200", "300") if name == "three.txt" else ()
        assert remarks(says("fit", name, *window, "--overwrite"), "note")


def test_a_late_piece_does_not_tell_its_beginning(says):
    hold = np.geomspace(1e4, 1e5, 30)
    mu = 0.6 + 0.01 * np.log10(hold) + 1e-3 * np.random.default_rng(3).normal(size=30)
    np.savetxt("late.txt", np.column_stack([hold, mu]))
    text = says("fit", "late.txt")
    assert line(text, "A0").strip() == "not determined by these times"
    assert "in units of A0" not in text
    # The straight line, which is determined, comes before the laws, which are not.
    assert text.index("straight line ") < text.index("saturation ") < text.index("logarithm ")
    assert line(text[text.index("logarithm ") :], "t0").strip() == "not determined by these times"
    figure = fit_figure(measured_growth(hold, mu), quantity="mu", unit_time="s", window=False)
    words = legend_of(figure)
    assert "\nstraight line, 0.0" in words
    assert "$t_0$ not determined by these times" in words


def test_any_name_is_drawn_as_it_stands(says, friction):
    for name in (r"$\foo$", "摩擦力", "a\tb", "coefficient of friction " * 9):
        Path(f"{name[:50]}.csv").write_bytes(Path("mu.csv").read_bytes().replace(b"mu", name.encode()))
        # Warnings are errors here: a glyph that the font lacks would be one.
        words = ("--unit-time", name, "--law", "logarithm", "--out", "a.png", "--overwrite")
        text = says("fit", f"{name[:50]}.csv", *words)
        assert name.strip() in text


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="needs a folder that nobody can write to")
def test_nothing_is_written_where_one_file_cannot_be(asperity, friction):
    status, text, error = asperity("fit", "mu.csv", "--json", "/proc/n.json")
    assert (status != 0, text) == (True, "")
    assert error.startswith("asperity: --json: cannot write /proc/n.json: ")
    assert not Path("fit.png").exists()


def test_the_figure_draws_the_numbers():
    rng = np.random.default_rng(5)
    time = np.concatenate([np.zeros(3), HOLD])
    value = 0.6 + 0.01 * np.log1p(time) + 1e-3 * rng.normal(size=time.size)
    growth = measured_growth(time, value, first=10)
    figure = fit_figure(growth, quantity="static friction", unit_time="s", window=True)
    upper, lower = figure.axes
    assert upper.get_ylabel() == "static friction"
    assert lower.get_xlabel() == "hold time $t$ [s]"
    curves = {str(artist.get_label()).split()[0]: artist for artist in upper.lines}
    fit = growth.fits["logarithm"]
    drawn = curves["logarithm"]
    np.testing.assert_allclose(np.asarray(drawn.get_ydata()), fit.predict(np.asarray(drawn.get_xdata())))
    words = legend_of(figure)
    for piece in ("at time 0:", "mean of 3", "saturation", "straight line", "per decade", "$t_0$"):
        assert piece in words
    strips = {artist.get_marker(): artist for artist in lower.lines}
    assert growth.rate is not None
    for marker, law, kept in (("x", growth.rate, time >= 10), ("s", fit, time > 0)):
        missed = 100 * (value[kept] / law.predict(time[kept]) - 1)
        np.testing.assert_allclose(np.asarray(strips[marker].get_ydata()), missed)


def test_error_bars_are_in_both_panels():
    value, stderr = 0.6 + 0.01 * np.log(HOLD), np.full(HOLD.size, 0.006)
    growth = measured_growth(HOLD, value, stderr=stderr, laws=("logarithm",))
    figure = fit_figure(growth, quantity="mu", unit_time="s", window=False)
    for axes, half in zip(figure.axes, (stderr, 0.6 / value), strict=True):
        bars = next(artist for artist in axes.collections if isinstance(artist, LineCollection))
        heights = [float(np.ptp(segment[:, 1])) for segment in bars.get_segments()]
        np.testing.assert_allclose(heights, 2 * half)
