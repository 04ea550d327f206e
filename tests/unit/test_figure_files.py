"""Figures as files: formats, sizes, letters, the table beside each; single panels; measured points."""

import ast
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text
from PIL import Image

import asperity as asp
from asperity import figures
from asperity.base.calls import remarks_made
from asperity.figures.style import COLUMN, PAGE
from asperity.fits import measured_growth, read_measurements
from asperity.fits.measurements import measured_area
from asperity.protocols import Hold, Ramp, Step
from asperity.sheets.columns import Columns, Role
from asperity.sheets.tables import read_table
from tests.refusals import refuses

pytestmark = pytest.mark.usefixtures("no_display")

HEIGHTS = asp.surfaces.spectral((32, 32), hurst=0.8, roll_off=8.0, cutoff=1.6, rms_height=0.05, spacing=0.2)
SCAN = asp.surfaces.Surface(HEIGHTS, unit="um", pixel_size=(0.2, 0.2), length_unit="um")
SOLID = asp.solids.half_space(modulus=2e9, branches=[(0.3, 10.0)])
AREA = "time [min];area [mm^2];std error [mm^2]\n0,05;2e-6;1e-7\n1;3e-6;2e-7\n10;4e-6;2e-7\n"


@pytest.fixture(scope="module")
def prediction() -> asp.prediction.Prediction:
    how: dict[str, Any] = {"first": "1 s", "last": "1000 s", "per_decade": 2, "shear_strength": "50 MPa"}
    return asp.predict(SOLID, SCAN, pressure="3 MPa", carried=asp.Carried(resistivity=1e-6), **how)


@pytest.fixture(scope="module")
def stepped() -> asp.History:
    """A ramp from 0, a hold, a drop to a quarter, a hold."""
    legs = [Ramp(2.0, pressure=3e6), Hold(100.0), Step(pressure=0.75e6), Hold(400.0)]
    times = [0.5, 1.0, 2.0, 3.0, 12.0, 102.0, 103.0, 112.0, 502.0]
    contact, carried = asp.press(SCAN, SOLID, load=0.0), asp.Carried(poisson=0.4, resistivity=1e-6)
    return asp.age(contact, times, protocol=legs, carried=carried, rtol=1e-2)


def test_a_figure_is_written_in_each_format_with_its_table(prediction, tmp_path):
    figure = figures.prediction_pictures(prediction)["growth"].figure
    files = figures.write(figure, tmp_path / "growth", ["png", "pdf", "svg"])
    assert [path.name for path in files] == ["growth.png", "growth.pdf", "growth.svg", "growth.csv"]
    with Image.open(files[0]) as image:
        assert image.size[0] == pytest.approx(85 / 25.4 * 300, abs=1)
    pdf, svg = files[1].read_bytes(), files[2].read_text("utf-8")
    assert b"/FontFile2" in pdf
    assert b"/Type3" not in pdf
    assert "real contact area [µm²]" in svg
    title = figure.get_suptitle()
    assert title
    assert title not in svg
    assert title in files[3].read_text("utf-8")
    # The title is drawn again, and a table of one's own is not replaced.
    assert figure._suptitle.get_visible()  # type: ignore[attr-defined]
    (tmp_path / "own.csv").write_text("t;A\n1;2\n")
    assert [path.name for path in figures.write(figure, tmp_path / "own.png")] == ["own.png", "own_data.csv"]
    assert figures.write(figure, tmp_path / "growth.svg")[-1].name == "growth.csv"
    assert figures.write(figure, tmp_path / "none", []) == []
    for wrong in ("eps", ["png", "jpeg"]):
        with refuses("formats", "eps" if wrong == "eps" else "jpeg"):
            figures.write(figure, tmp_path / "growth", wrong)  # type: ignore[arg-type]


def test_the_table_of_a_figure_holds_what_is_drawn(tmp_path):
    x, y, error = np.geomspace(1, 100, 5), np.arange(1.0, 6), np.linspace(0.1, 0.5, 5)
    figure = figures.Drawing(figsize=(4, 4))
    upper, lower = figure.subplots(2, 1, sharex=True)
    upper.plot(x, 0 * y)
    upper.clear()
    upper.fill_between([], [], label="in the legend alone")
    upper.plot(x, y, label=r"law $\mu$")
    upper.plot([0, 1], [0.5, 0.5], transform=upper.transAxes)
    upper.errorbar(x[1:], pd.Series(y[1:]), pd.Series(error[1:]), label="data")
    ends = np.ma.masked_less(y, 2) - 1, np.where(y < 5, y + 1, np.nan)
    upper.fill_between(x, *ends, where=y != 3, step="mid", label="band")
    upper.axhline(3.0)
    upper.set_ylabel("area [µm²]")
    lower.stairs(y[:-1], x, label="counts")
    lower.set(ylabel="part", xlabel="time $t$  [s]")
    figures.write(figure, tmp_path / "a.png")
    table = read_table(tmp_path / "a.csv")
    expected = {
        "time t [s]": x,
        "law mu: area [um^2]": y,
        "time t (2) [s]": x[1:],
        "data: area [um^2]": y[1:],
        "data: area low [um^2]": (y - error)[1:],
        "data: area high [um^2]": (y + error)[1:],
        "time t (3) [s]": x[[1, 3]],
        "band: area low [um^2]": y[[1, 3]] - 1,
        "band: area high [um^2]": y[[1, 3]] + 1,
        "time t (4) [s]": x,
        "counts: part up to the next": y[:-1],
    }
    assert table.names == list(expected)
    for name, values in zip(table.names, table.values.T, strict=True):
        np.testing.assert_allclose(values[: expected[name].size], expected[name])
        assert np.isnan(values[expected[name].size :]).all()
    found = Columns(table, [Role("area", "m^2", "law")])
    np.testing.assert_allclose(found.values("area", 1), 1e-12 * y)


def test_the_table_has_what_a_plot_draws_and_what_a_user_adds_to_it(prediction, tmp_path):
    figure = figures.Drawing(figsize=(4, 4))
    above, below = figure.subplots(2, 1)
    prediction.plot("area", ax=above).errorbar(
        [1.0, 10.0], [4.0, 5.0], [[0.1, 0.2], [0.3, 0.4]], label="mine"
    )
    below.plot("t", "A", data={"t": [1, 2], "A": [3, 4]})
    below.errorbar("t", "A", "A", data={"t": [1, 2], "A": [3, 4]})
    below.fill_between("t", "A", where="B", data={"t": [1, 2], "A": [3, 4], "B": [True, False]})
    below.plot([[1, 2], [3, 4], [5, 6]])
    figures.write(figure, tmp_path / "area.svg")
    table = read_table(tmp_path / "area.csv")
    columns = dict(zip(table.names, table.values.T, strict=True))
    quantity = "real contact area{} [um^2]".format
    area = 1e12 * prediction.series("contact_area_corrected")
    np.testing.assert_allclose(columns["corrected for pixel rims: " + quantity("")], area, rtol=1e-11)
    assert {name for name in columns if "mine" in name} == {
        "mine: " + quantity(end) for end in ("", " low", " high")
    }
    assert columns["mine: " + quantity(" low")][:2].tolist() == [3.9, 4.8]
    assert columns["mine: " + quantity(" high")][:2].tolist() == [4.3, 5.4]
    assert all("area" in name or "time" in name for name in columns)  # the lower panel has no columns


def test_a_figure_that_keeps_no_numbers_has_no_table(prediction, tmp_path):
    theirs = Figure()
    prediction.plot("area", ax=theirs.subplots())
    with refuses("figure", "Figure"):
        figures.write(theirs, tmp_path / "area.png")
    assert not list(tmp_path.iterdir())
    round_axes = figures.Drawing(figsize=(3, 3)).add_subplot(projection="polar")
    assert round_axes.name == "polar"


def test_no_table_is_read_back_from_a_picture():
    drawn = {"collections", "containers", "get_array", "get_data", "get_lines", "get_offsets", "get_path"}
    drawn |= {"get_paths", "get_segments", "get_verts", "get_xdata", "get_xydata", "get_ydata", "patches"}
    for file in Path(figures.__file__).parent.glob("*.py"):
        tree = ast.parse(file.read_text("utf-8"))
        read = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
        assert not read & drawn, file


@pytest.mark.slow
def test_figures_have_the_widths_and_letters_of_a_journal_and_cut_no_text(prediction, stepped):
    drawn = {name: one.figure for name, one in figures.prediction_pictures(prediction).items()}
    drawn |= {"history": figures.history_figure(stepped.dataset)}
    drawn["carried of legs"] = figures.carried_figure(stepped.dataset)
    drawn["fit"] = figures.fit_figure(growth(), quantity="area", unit_time="s", window=False)
    drawn["plot"] = prediction.plot("area").get_figure()
    drawn["map"], drawn["legs"] = stepped.final.plot().get_figure(), stepped.plot().get_figure()
    for name, figure in drawn.items():
        assert figure.get_figwidth() in (COLUMN, PAGE), name
        figure.draw_without_rendering()
        texts = [text for text in figure.findobj(Text) if text.get_text()]
        assert {text.get_fontsize() for text in texts} <= {7.0, 8.0}, name
        ticks = {
            label for axes in figure.axes for label in (*axes.get_xticklabels(), *axes.get_yticklabels())
        }
        for text in set(texts) - ticks:
            box = text.get_window_extent()
            inside = figure.bbox.x0 <= box.x0 + 1 and box.x1 - 1 <= figure.bbox.x1
            assert inside or not text.get_visible(), (name, text.get_text())


def test_a_column_of_the_time_axis_has_its_first_and_last_decade(stepped):
    labels = [label.get_text() for label in stepped.plot().get_xticklabels()]
    assert {"$10^{0}$", "$10^{2}$"} <= set(labels)


def growth() -> Any:
    time = np.geomspace(1, 1e4, 9)
    return measured_growth(time, 1 + 0.1 * np.log(time))


def test_one_panel_of_a_result_is_drawn_into_axes(prediction):
    time = np.geomspace(0.1, 100, 20)
    table = asp.relaxation.fit(asp.relaxation.Relaxation(time, 1e9 + 1e9 * np.exp(-time / 5)))
    results: dict[Any, tuple[str, ...]] = {
        prediction: ("area", "growth", "friction", "pressure", "contacts", "resistance"),
        table: ("moduli", "deviations", "branches"),
        growth(): ("growth", "residuals"),
    }
    for result, kinds in results.items():
        for kind in kinds:
            ax = Figure(figsize=(5, 4)).subplots()
            assert result.plot(kind, ax=ax) is ax
            assert ax.has_data(), kind
            assert ax.get_xlabel(), kind
        with refuses("kind", "'aera'") as found:
            result.plot("aera")
        assert all(kind in str(found.value) for kind in kinds)
    area = prediction.plot()  # the first, in a new figure
    assert area.get_figure() is plt.gcf()
    drawn = next(line for line in area.lines if line.get_label() == "corrected for pixel rims")
    np.testing.assert_allclose(drawn.get_ydata(), 1e12 * prediction.series("contact_area_corrected"))


def written(folder: Path, text: str) -> Path:
    path = folder / "area.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_measured_values_are_read_in_units_with_their_errors(tmp_path):
    found: Any = measured_area(written(tmp_path, AREA), 1.0, si=True)
    np.testing.assert_allclose(found.time, [3, 60, 600])
    np.testing.assert_allclose(found.value, [2e-12, 3e-12, 4e-12])
    np.testing.assert_allclose(found.stderr, [1e-13, 2e-13, 2e-13])
    bare = measured_area(written(tmp_path, "t;A\n1;2\n2;3\n"), 1.0, si=False)
    assert (bare.stderr, bare.value.tolist()) == (None, [2, 3])
    for header, wrong in {"t [s];F [N]": "N", "t [s];A": "none", "t;A [um^2]": "none"}.items():
        path = written(tmp_path, f"{header}\n1;2\n2;3\n")
        with refuses(str(path), wrong):
            measured_area(path, 1.0, si=True)
    with refuses("measured", "none"):
        measured_area(read_measurements(path), 1.0, si=True)


@pytest.mark.parametrize(
    "table",
    [
        "t [min];A/A_nom [%]\n1;2\n2;3\n",
        "t_min,contact_fraction\n1,0.02\n2,0.03\n",
        "t (s),percent\n60,2\n120,3\n",
    ],
)
def test_a_fraction_of_the_nominal_area_is_an_area(table, tmp_path):
    found = measured_area(written(tmp_path, table), 5e-6, si=True)
    np.testing.assert_allclose(found.value, [1e-7, 1.5e-7])
    assert found.value_unit == "m^2"
    with refuses(str(path := written(tmp_path, "t_s,contact_fraction\n60,2\n120,3\n")), "3"):
        measured_area(path, 5e-6, si=True)


def test_measured_areas_are_drawn_beside_computed_ones_and_their_ratio_below(prediction, stepped, tmp_path):
    path = written(tmp_path, AREA)
    held = asp.age(asp.press(SCAN, SOLID, pressure=3e6), [1.0, 10.0, 100.0, 1000.0], rtol=1e-2).dataset
    summary = asp.analysis.aging_summary(held)
    areas, first, steps = (
        held["contact_area_corrected"].values,
        float(held["contact_area"][0]),
        stepped.dataset,
    )
    corrected = 1e12 * prediction.series("contact_area_corrected")
    with remarks_made() as made:
        cases: list[Any] = [
            (
                figures.prediction_pictures(prediction, measured=path)["growth"].figure,
                0,
                prediction.time,
                corrected,
                1e12,
            ),
            (
                figures.aging_curve(held, summary, path),
                0,
                held["time"].values,
                areas / first,
                1 / first,
            ),
            (
                figures.history_figure(steps, path),
                1,
                steps["time"].values,
                1e12 * steps["contact_area_corrected"].values,
                1e12,
            ),
        ]
    beyond = []
    for figure, number, time, computed, scale in cases:
        upper, lower = figure.axes[number : number + 2]
        (bars,), (ratios,) = upper.containers, lower.containers
        value = scale * np.array([2e-12, 3e-12, 4e-12])
        np.testing.assert_allclose(bars.lines[0].get_ydata(), value)
        assert upper.get_ylim()[0] < value.min() - scale * 1e-13
        assert upper.get_ylim()[1] > value.max() + scale * 2e-13
        beside = np.interp(np.log([3, 60, 600]), np.log(time[time > 0]), computed[time > 0], right=np.nan)
        np.testing.assert_allclose(ratios.lines[0].get_ydata(), value / beside)
        beyond += [count] if (count := int(np.isnan(beside).sum())) else []
        places = [3, 60, 600] if number == 0 else ratios.lines[0].get_xdata()
        np.testing.assert_allclose(ratios.lines[0].get_xdata(), places)
    assert beyond
    assert [text.partition(" measured times are outside ")[0] for text in made] == [
        f"{count} of 3" for count in beyond
    ]


def test_what_a_contact_carries_has_the_axes_of_its_history(stepped):
    figure: Any = figures.carried_figure(stepped.dataset)
    history = figures.history_figure(stepped.dataset)
    assert figure.axes[-1].get_xlim() == history.axes[-1].get_xlim()
    ticks = [[text.get_text() for text in one.axes[-1].get_xticklabels()] for one in (figure, history)]
    assert ticks[0] == ticks[1]
    assert [axes.get_ylabel() for axes in figure.axes] == ["stiffness [kN/m]", "resistance [mΩ]"]
    # The reference is the end of the loading, at 2 s, and not the first touch.
    data = stepped.dataset
    at = int(np.flatnonzero(data["time"].values == 2.0)[0])
    dotted = [line.get_ydata()[0] for line in figure.axes[1].lines if line.get_linestyle() == ":"]
    assert dotted[0] == pytest.approx(1e3 * float(data["resistance"][at]))
    assert "at 2\u00a0s" in figure.axes[1].get_legend_handles_labels()[1]
