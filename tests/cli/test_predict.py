"""``asperity predict``: from a table, a scan and a load to growth, against other ways to it."""

from __future__ import annotations

import csv
import html.parser
import json
import os
import shlex
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

import asperity as asp
from asperity.analysis.prediction import Prediction
from asperity.app.cli import main
from asperity.app.cli import predict as command
from asperity.app.cli.flags import of_flags
from asperity.app.config.reading import read_config
from asperity.app.predict import predict_config
from asperity.app.predict.pipeline import Modulus
from asperity.app.runs import Progress
from asperity.errors import InputError
from asperity.figures.page import quantity
from asperity.figures.prediction import growth_figure
from tests.cli.conftest import Asperity, Refused
from tests.refusals import refuses

TAU = 30e6
LENGTHS: dict[str, Any] = {"file_unit": "nm", "pixel_size": 50.0, "length_unit": "nm"}
DATA = Path(os.environ.get("ASPERITY_DATA", ""))
PMMA = Path(__file__).parents[2] / "docs" / "data" / "pmma_like_relaxation.csv"


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a scan without units, as text in nm, and a relaxation table of four decades."""
    folder = tmp_path_factory.mktemp("files")
    heights = asp.surfaces.spectral((40, 48), spacing=50.0, hurst=0.8, rms_height=20.0, seed=3)
    np.savetxt(folder / "scan.txt", heights)
    time = np.geomspace(0.01, 100.0, 17)
    modulus = 1000 + 600 * np.exp(-time / 0.3) + 900 * np.exp(-time / 20)
    lines = (f"{t:.6g},{E:.8g}" for t, E in zip(time, modulus, strict=True))
    (folder / "relaxation.csv").write_text("\n".join(["time_s,E_MPa", *lines]) + "\n")
    return folder


def words(files: Path, *more: str | Path) -> list[str]:
    """The command, with the units of the scan."""
    table, scan = files / "relaxation.csv", files / "scan.txt"
    units = ("--file-unit", "nm", "--pixel-size", "50", "--length-unit", "nm")
    return ["predict", str(table), "--surface", str(scan), *units, *map(str, more)]


@pytest.fixture(scope="module")
def finished(files: Path) -> Path:
    """The folder of a finished prediction, not to be changed."""
    out = files / "out"
    extra = ("--shear-strength", "30MPa", "--pixel", "0.2um", "--blur", "150nm", "--threshold", "0.3")
    assert main([*words(files, "--pressure", "40MPa", "--quiet", "--out", out), *extra]) == 0
    return out


@pytest.fixture(scope="module")
def scan(files: Path) -> asp.surfaces.Surface:
    """The scan, with its units."""
    return asp.surfaces.read(files / "scan.txt", periodic="reflect", **LENGTHS)


@pytest.fixture(scope="module")
def prediction(files: Path, scan: asp.surfaces.Surface) -> Prediction:
    """The same prediction in Python."""
    return asp.predict(files / "relaxation.csv", scan, pressure="40 MPa", shear_strength=TAU)


def table_of(folder: Path) -> dict[str, list[float]]:
    with (folder / "history.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


def test_edges_are_free_where_asked_and_the_page_says_so(
    files: Path, finished: Path, prediction: Prediction, tmp_path: Path
) -> None:
    flags = ("--pressure", "40MPa", "--quiet", "--edges", "free", "--out", tmp_path / "out")
    assert main(words(files, *flags)) == 0
    stored, said = asp.results.load(tmp_path / "out"), (tmp_path / "out" / "summary.txt").read_text("utf-8")
    free = asp.surfaces.read(files / "scan.txt", periodic="free", **LENGTHS)
    same = asp.predict(files / "relaxation.csv", free, pressure="40 MPa")
    np.testing.assert_array_equal(stored["in_contact"], same.dataset["in_contact"])
    assert (stored["contact_area"].values != prediction.dataset["contact_area"].values).all()
    assert "edges are free: the body ends with the scan" in said
    assert "edges reflect, as for a part" in (finished / "summary.txt").read_text("utf-8")
    for folder, ends in ((tmp_path / "out", True), (finished, False)):
        page = (folder / "prediction.html").read_text("utf-8")
        assert ("ends at the edges of the scan" in page, "its own mirror image" in page) == (ends, not ends)


def test_the_command_and_the_function_agree(finished: Path, prediction: Prediction) -> None:
    assert sorted(path.name for path in finished.iterdir()) == [
        *("contacts.png", "growth.png", "history.csv", "history.zarr", "observed.png"),
        *("prediction.html", "pressure.png", "relaxation.png", "solid.toml", "summary.txt"),
    ]
    stored, table = asp.results.load(finished), table_of(finished)
    for name in ("time", "contact_area", "contact_area_corrected", "in_contact", "pressure"):
        np.testing.assert_array_equal(stored[name], prediction.dataset[name])
    np.testing.assert_array_equal(table["time [s]"], prediction.time)
    np.testing.assert_array_equal(table["contact_area [m^2]"], prediction.series("contact_area"))
    load = np.array(table["load [N]"])
    np.testing.assert_allclose(load, 40e6 * 40 * 48 * 50e-9**2, rtol=1e-6)
    force = TAU * np.array(table["contact_area_corrected [m^2]"])
    np.testing.assert_allclose(table["friction_force [N]"], force, rtol=1e-14)
    np.testing.assert_allclose(table["friction [1]"], force / load, rtol=1e-14)
    assert "u0" not in stored
    assert json.loads(stored.attrs["prediction"])["table"] == "relaxation.csv"
    last = asp.observe(stored.isel(field_time=-1), pixel=0.2e-6, blur=150e-9, threshold=0.3)
    assert last.image.shape == (10, 12)
    area = prediction.series("contact_area_corrected")
    summary = (finished / "summary.txt").read_text(encoding="utf-8")
    for number in (
        f"A(100 s)/A(10 ms) = {area[-1] / area[0]:.5g}",
        f"{last.area * 1e12:.4g} um^2, patches: {last.patches.count}",
        *("share 0.24 relaxes in 300 ms", "share 0.36 relaxes in 20 s", "share 0.4 does"),  # 600, 900, 1000
    ):
        assert number in summary


def test_the_contact_is_that_of_an_elastic_solid_as_soft_as_the_table_says(
    scan: asp.surfaces.Surface, prediction: Prediction
) -> None:
    # E. H. Lee, J. R. M. Radok (1960): under a constant load, an elastic contact of modulus 1/J(t).
    assert prediction.fit is not None
    series = prediction.fit.series
    for place in (0, 7, -1):
        compliance = float(series.compliance_at(prediction.time[place])) * (1 - 0.35**2)
        elastic = asp.press(scan, asp.solids.half_space(modulus=1 / compliance), pressure=40e6)
        assert prediction.series("area")[place] == pytest.approx(elastic.area, abs=1)
        assert prediction.series("mean_gap")[place] == pytest.approx(elastic.mean_gap, rel=1e-4)


def test_a_load_is_a_pressure_over_the_scan(
    files: Path, scan: asp.surfaces.Surface, prediction: Prediction
) -> None:
    load = 40e6 * 40 * 48 * 50e-9**2
    ours = asp.predict(files / "relaxation.csv", scan, load=f"{1e3 * load} mN", first=1.0, last="1e5 ms")
    assert ours.time[[0, -1]].tolist() == pytest.approx([1.0, 100.0])
    np.testing.assert_array_equal(ours.series("area")[-1], prediction.series("area")[-1])
    assert ours.friction is None


def test_mirror_images_are_taken_as_reflecting_edges(files: Path, prediction: Prediction) -> None:
    mirrored = asp.surfaces.read(files / "scan.txt", periodic="mirror", **LENGTHS)
    doubled = asp.predict(files / "relaxation.csv", mirrored, pressure="40 MPa")
    assert mirrored.shape == (80, 96)
    np.testing.assert_array_equal(doubled.series("area"), prediction.series("area"))
    assert doubled.growth == prediction.growth
    # The doubled scan itself, periodic, touches on four times the sites.
    contact = asp.press(mirrored, asp.solids.half_space(modulus=prediction.modulus), pressure=40e6)
    assert contact.area == pytest.approx(4 * int(prediction.dataset["area"][0]), abs=4)


def test_what_the_table_measures(files: Path, scan: asp.surfaces.Surface, prediction: Prediction) -> None:
    assert prediction.fit is not None
    at_once = prediction.fit.series.modulus
    assert prediction.modulus == pytest.approx(at_once / (1 - 0.35**2))
    cases: dict[Modulus, float] = {"shear": 2 * at_once / (1 - 0.4), "contact": at_once}
    how: dict[str, Any] = {"pressure": 80e6, "poisson": 0.4, "last": 0.1, "per_decade": 1}
    for modulus, stiffness in cases.items():
        ours = asp.predict(files / "relaxation.csv", scan, modulus=modulus, **how)
        assert ours.modulus == pytest.approx(stiffness)


def test_another_temperature_shifts_every_time(
    files: Path, prediction: Prediction, undrawn: list[Prediction], tmp_path: Path
) -> None:
    # A value that begins with a minus is none of the flags.
    for here, there, kelvin in (
        ("40degC", "293.15 K", (313.15, 293.15)),
        ("-5degC", "-15degC", (268.15, 258.15)),
    ):
        warm = ("--temperature", here, "--reference", there, "--activation-energy", "100kJ/mol")
        assert main([*words(files, "--pressure", "40MPa", *warm, "-q", "--out", tmp_path / "out")]) == 0
        factor = np.exp(1e5 / 8.31446261815324 * (1 / kelvin[0] - 1 / kelvin[1]))
        np.testing.assert_allclose(undrawn[-1].time, factor * prediction.time, rtol=1e-6)
        np.testing.assert_allclose(undrawn[-1].series("area"), prediction.series("area"), atol=1)


def test_quantities_are_spelled_as_printed() -> None:
    for value, unit, said in (
        (5e6, "Pa", "5 MPa"),
        (2.2e-11, "m^2", "22 µm²"),
        (1.61e-15, "m^2", "1610 nm²"),
        (9.7656e-10, "m", "977 pm"),
        (1.78e4, "s", "17800 s"),
        (1e6, "s", "10⁶ s"),
        (2.5e7, "s", "2.5 × 10⁷ s"),
    ):
        assert quantity(value, unit) == said


class Page(html.parser.HTMLParser):
    """Reads a page: its words, its pictures, and whether tags are closed in turn."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.words, self.pictures = "", 0
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in ("meta", "img"):
            self.open.append(tag)
        self.pictures += tag == "img" and (dict(attrs)["src"] or "").startswith("data:image/png;base64,iVBOR")

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words += data


def test_the_page_says_what_was_predicted(finished: Path, prediction: Prediction) -> None:
    page = Page((finished / "prediction.html").read_text(encoding="utf-8"))
    assert page.open == []
    assert page.pictures == 5
    text = " ".join(page.words.split())
    low, high = prediction.growth.ratio_band
    assert f"A(100 s)/A(10 ms) = {prediction.growth.ratio:.5g} (95 % band {low:.4g} to {high:.4g})" in text
    assert "nan" not in text.lower().split()
    for remark in prediction.remarks:
        assert remark[1:] in text


PMMA_BRANCHES = ((184.62 / 1805.39, 8.93), (191.06 / 1805.39, 117.96))
LOADED: dict[str, Any] = {"pressure": "2 MPa", "first": 10.0, "last": 1000.0}


@pytest.fixture(scope="module")
def ramped(scan: asp.surfaces.Surface) -> dict[float, Prediction]:
    """Predictions for a load put on at once, and within 2.4 s."""
    solid = asp.solids.half_space(modulus=1805.39e6, branches=PMMA_BRANCHES)
    return {ramp: asp.predict(solid, scan, **LOADED, ramp=ramp or None) for ramp in (0.0, 2.4)}


@pytest.mark.parametrize(("ramp", "ratio"), [(0.0, 1.1674), (2.4, 1.1746)])
def test_a_ramp_is_the_integral_of_the_compliance(
    ramped: dict[float, Prediction], scan: asp.surfaces.Surface, ramp: float, ratio: float
) -> None:
    # J * dF(1000 s) / J * dF(10 s) by hand; loaded as by Dillavou and Rubinstein, PRL 120, 224101 (2018).
    ours = ramped[ramp]
    effective = ours.effective_load
    assert effective is not None
    assert effective[-1] / effective[0] == pytest.approx(ratio, abs=5e-5)
    assert ours.time[[0, -1]].tolist() == pytest.approx([10.0, 1000.0])
    assert ours.dataset.attrs["exact_contact"] == "at all times"
    elastic = asp.solids.half_space(modulus=1805.39e6)
    for place in (0, 4, -1):
        contact = asp.press(scan, elastic, load=float(effective[place]))
        assert ours.series("area")[place] == contact.area
        assert ours.series("load")[place] == pytest.approx(ours.load, rel=1e-9)
        moment = ours.dataset["in_contact"].sel(field_time=ours.time[place], method="nearest")
        if float(moment["field_time"]) == ours.time[place]:
            np.testing.assert_array_equal(moment, contact.in_contact)


def test_the_figure_sets_the_compliance_beside_the_area(ramped: dict[float, Prediction]) -> None:
    for ramp, ours in ramped.items():
        upper, *_, lower = growth_figure(ours).axes[:2]
        lines = {str(line.get_label()): np.asarray(line.get_ydata(), dtype=float) for line in upper.lines}
        name = "effective load L(t)/L(first)" if ramp else "creep compliance J(t)/J(first)"
        dotted, area = lines[f"first area × {name}"], lines["less the rim"]
        assert dotted[-1] / dotted[0] == pytest.approx(1.1746 if ramp else 1.1674, abs=5e-5)
        assert dotted[0] == area[0]
        assert ("since the loading began" in lower.get_xlabel()) == bool(ramp)


def test_times_within_the_loading_are_remarked(scan: asp.surfaces.Surface) -> None:
    solid = asp.solids.half_space(modulus=1805.39e6, branches=PMMA_BRANCHES)
    times: dict[str, Any] = {"pressure": "2 MPa", "last": "100 s", "ramp": "2.4 s", "per_decade": 2}
    early = asp.predict(solid, scan, first="1 s", **times)
    begins = "2 recorded times are before the end of the loading"
    assert any(remark.startswith(begins) for remark in early.remarks)
    assert early.series("load")[0] == pytest.approx(early.load / 2.4, rel=1e-5)
    late = asp.predict(solid, scan, first="2.4 s", **times)
    assert not any("loading" in remark for remark in late.remarks)


def test_the_fitted_solid_is_a_file_for_run_and_predict(
    finished: Path, files: Path, undrawn: list[Prediction], prediction: Prediction, tmp_path: Path
) -> None:
    scan = words(files)[2:]
    more = ("--pressure", "40MPa", "--first", "10ms", "--last", "100s", "-q", "--out", tmp_path / "out")
    assert main(["predict", *map(str, (finished / "solid.toml", *scan, *more))]) == 0
    again = undrawn[0]
    assert again.modulus == pytest.approx(prediction.modulus, rel=1e-12)
    np.testing.assert_allclose(again.branches, prediction.branches, rtol=1e-12)
    np.testing.assert_array_equal(again.series("area"), prediction.series("area"))
    run = ("run", finished / "solid.toml", "--shape", "16", "16", "-q", "--out", tmp_path / "run")
    assert main([*map(str, run)]) == 0
    # The same from flags alone, as a paper states it.
    branches = [word for share, time in prediction.branches for word in ("--branch", f"{share!r} {time!r}s")]
    young = ("--young", f"{prediction.modulus * (1 - 0.35**2)!r}Pa")
    assert main(["predict", *map(str, (*scan, *more, *young, *branches))]) == 0
    np.testing.assert_array_equal(undrawn[1].series("area"), prediction.series("area"))


def test_a_protocol_may_put_the_load_on(files: Path, scan: asp.surfaces.Surface) -> None:
    # As asperity run takes it; a load of 0 is not for contacts without a ramp.
    text = f"""
        [surface]
        path = "{files / "scan.txt"}"
        periodic = "reflect"
        file_unit = "nm"
        pixel_size = 50.0
        length_unit = "nm"
        [solid]
        kind = "half_space"
        modulus = 1.80539e9
        branches = {[list(one) for one in PMMA_BRANCHES]}
        [contact]
        pressure = "2 MPa"
        [aging]
        first = 10.0
        [[protocol]]
        kind = "ramp"
        duration = "2.4 s"
        pressure = "2 MPa"
        [[protocol]]
        kind = "hold"
        duration = 997.6
    """
    (files / "ramp.toml").write_text(text)
    config = read_config(files / "ramp.toml", {})
    with refuses("[[protocol]]"):
        predict_config(config, Progress())
    unloaded = config.contact.model_construct(load=0.0, pressure=None, separation=None)
    ours = predict_config(config.model_copy(update={"contact": unloaded}), Progress())
    solid = asp.solids.half_space(modulus=1805.39e6, branches=PMMA_BRANCHES)
    theirs = asp.predict(solid, scan, **LOADED, ramp=2.4)
    np.testing.assert_array_equal(ours.series("area"), theirs.series("area"))


@pytest.mark.parametrize("pressure", ["1 Pa", "9 GPa"])
def test_a_contact_of_one_pixel_or_of_all_does_not_grow(
    files: Path, scan: asp.surfaces.Surface, pressure: str
) -> None:
    ours = asp.predict(files / "relaxation.csv", scan, pressure=pressure, per_decade=1)
    np.testing.assert_array_equal(ours.series("area"), 1 if pressure == "1 Pa" else scan.heights.size)
    growth = ours.growth
    np.testing.assert_array_equal([growth.per_decade, *growth.band, *growth.of_table, *growth.of_scan], 0)
    figure = growth_figure(ours)
    FigureCanvasAgg(figure).draw()
    for axes in figure.axes[:2]:  # no point under the legend
        legend = axes.get_legend()
        assert legend is not None
        box = legend.get_window_extent()
        points = [line.get_transform().transform(np.column_stack(line.get_data())) for line in axes.lines]
        assert not any(box.contains(*point) for line in points for point in line)
    assert len(asp.figures.prediction_pictures(ours)) == 4


def test_an_interrupted_prediction_goes_on(
    files: Path,
    monkeypatch: pytest.MonkeyPatch,
    asperity: Asperity,
    scan: asp.surfaces.Surface,
    undrawn: list[Prediction],
    tmp_path: Path,
) -> None:
    class Impatient(Progress):
        def reached(self, frame: asp.Frame) -> None:
            if frame.time > 1.0:
                raise KeyboardInterrupt

    monkeypatch.setattr(command, "_CHECKPOINT_EVERY", 0.0)
    monkeypatch.setattr("asperity.progress.Progress", Impatient)
    call = words(files, "--pressure", "40MPa", "--ramp", "50ms", "--quiet", "--out", tmp_path / "out")
    status, _, said = asperity(*call)
    assert status == 130
    assert "the same command goes on from" in said
    assert [path.suffix for path in tmp_path.iterdir()] == [".checkpoint"]
    monkeypatch.setattr("asperity.progress.Progress", Progress)
    assert asperity(*call) == (0, "", "")
    assert list(tmp_path.iterdir()) == []
    undisturbed = asp.predict(files / "relaxation.csv", scan, pressure="40 MPa", ramp=0.05)
    for name in ("contact_area_corrected", "iterations", "in_contact"):
        np.testing.assert_array_equal(undrawn[0].dataset[name], undisturbed.dataset[name])


MISTAKES = """
    --pressure 1
    --pressure '1 MPb'
    --pressure 10N
    --pressure=-1MPa
    --load 'ten newtons'
    --last 1s
    --pressure 1MPa --load 1N
    --pressure 1MPa --shear-strength 50
    --pressure 1MPa --first 1us
    --pressure 1MPa --last 2days
    --pressure 1MPa --last 500s
    --pressure 1MPa --first 10s --last 1s
    --pressure 1MPa --last 2days --first abc
    --pressure 1MPa --last 1e6
    --pressure 1MPa --first --quiet
    --pressure 1MPa --poisson 0.6
    --pressure 1MPa --poisson 0.6 --modulus contact
    --pressure 1MPa --poisson 0.3 0.2
    --pressure 1MPa --poisson abc --modulus shear
    --pressure 1MPa --per-decade 0
    --pressure 1MPa --per-decade abc
    --pressure 1MPa --branches-per-decade 99
    --pressure 1MPa --branches-per-decade x
    --pressure 1MPa --threshold 0.4
    --pressure 1MPa --pixel 1um --threshold abc
    --pressure 1MPa --temperature 40degC
    --pressure 1MPa --temperature 40degC --reference 20degC
    --pressure 1MPa --ramp 2.4
    --pressure 1MPa --ramp=-1s
    --pressure 1MPa --ramp 1day
    --pressure 1MPa --branch '0.3 10s'
    --pressure 1MPa --branch '0.3 10'
    --pressure 1MPa --branches 0
    --pressure 1MPa --branches 2 --branches-per-decade 2
    --pressure 1MPa --pixel 1
    --pressure 1MPa --creep eyring
    --pressure 1MPa --creep none --hardness 0MPa
"""
ALONE = """
    --young 3GPa 70GPa --poisson 0.3
    --young 3
    --young 3GPa --creep eyring
    --young 3GPa --creep-stress 20MPa
    --young 3GPa --permanent 0.01 --creep norton
    --young 3GPa --noise 0.1
    --young 3GPa --surface none.txt
    --young 3GPa --hardness 9MPa --first 1s --last 100s
    --young 3GPa --hardness 9MPa --first 1s --last 100s --ramp 1s
    run.toml --wlf 17 51
"""


def test_mistakes_are_one_clear_line(files: Path, refused: Refused, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("relaxation.csv", "scan.txt"):
        shutil.copy(files / name, name)
    shutil.copy("scan.txt", "run.toml")
    surface = ("--surface", "scan.txt", "--file-unit", "nm", "--pixel-size", "50", "--length-unit", "nm")
    monkeypatch.setattr("asperity.simulate.follow", lambda *_, **__: pytest.fail("aged"))
    for line in MISTAKES.split("\n")[1:-1]:
        refused("predict", "relaxation.csv", *surface, *shlex.split(line), "--quiet")
    for line in ALONE.split("\n")[1:-1]:
        refused("predict", *surface, "--pressure", "10MPa", *shlex.split(line), "--quiet")
    refused("predict", "--pressure", "1MPa")
    refused("predict", "relaxation.csv", "--pressure", "1MPa")
    # Files that cannot be used.
    refused("predict", "relaxation.csv", "--surface", "scan.txt", "--pressure", "1MPa")
    refused("predict", "relaxation.csv", "--surface", "scan.txt", "--file-unit", "nm", "--pressure", "1MPa")
    Path("noheights.txt").write_text("no heights")
    refused("predict", "relaxation.csv", "--surface", "noheights.txt", "--pressure", "1MPa")
    lines = Path("relaxation.csv").read_text().splitlines()
    numbers = [line.replace(",", "e0,") for line in lines[1:]]
    for broken, more in (
        (["t,E", *lines[1:]], ()),
        ([lines[0], lines[2], lines[1], *lines[3:]], ()),
        ([*lines[:10], "1.2,9000", *lines[10:]], ()),
        ([*lines[:10], "1.2,2500", *lines[10:]], ()),
        (lines[:4], ()),
        (lines[1:], ()),
        (["a,b", *numbers], ()),
        # Without units a modulus in MPa would be taken for one in Pa.
        (["a,b", *numbers], ("--kind", "relaxation", "--columns", "a", "b")),
    ):
        Path("table.csv").write_text("\n".join(broken))
        refused("predict", "table.csv", *surface, "--pressure", "1MPa", *more, "--quiet")


def test_a_table_whose_columns_are_chosen(
    files: Path, undrawn: list[Prediction], prediction: Prediction, asperity: Asperity
) -> None:
    lines = (files / "relaxation.csv").read_text().splitlines()
    Path("table.csv").write_text("\n".join(["a [s],b [MPa]", *lines[1:]]))
    call = words(files, "--pressure", "40MPa", "--quiet", "--kind", "relaxation", "--columns", "0", "1")
    assert asperity("predict", "table.csv", *call[2:]) == (0, "", "")
    assert undrawn[0].modulus == pytest.approx(prediction.modulus)


def test_the_same_number_in_another_unit_is_the_same_prediction(
    files: Path, tmp_path: Path, asperity: Asperity, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []

    def begin(_: Path, one: str) -> None:
        asked.append(one)
        raise KeyboardInterrupt

    monkeypatch.setattr("asperity.app.cli.computing.place_beside", begin)
    for pressure in ("1MPa", "1000 kPa", "2MPa"):
        asperity(*words(files, "--pressure", pressure, "--out", tmp_path / "out"))
    assert asked[0] == asked[1] != asked[2]


def test_advice_names_flags_but_not_within_python() -> None:
    wrong = InputError(
        "unit", expected="one", got="none", advice="unit='m', or Surface(h, unit='m', x=(1, 2))"
    )
    assert of_flags(wrong, {"unit": "--unit"}).advice == "--unit 'm', or Surface(h, unit='m', x=(1, 2))"


def test_more_branches_follow_a_table_of_few_times(
    files: Path, undrawn: list[Prediction], tmp_path: Path, asperity: Asperity
) -> None:
    omega = np.geomspace(0.01, 100.0, 13)
    shares, times = np.array([600.0, 900.0]), np.array([0.3, 0.9])  # less than half a decade apart
    x2 = (omega[:, None] * times) ** 2
    storage, loss = 1000 + x2 / (1 + x2) @ shares, np.sqrt(x2) / (1 + x2) @ shares
    lines = [f"{w:.8g},{s:.8g},{one:.8g}" for w, s, one in zip(omega, storage, loss, strict=True)]
    (tmp_path / "dma.csv").write_text("\n".join(["omega_rad_s,storage_MPa,loss_MPa", *lines]))
    call = words(files, "--pressure", "40MPa", "--quiet", "--out", tmp_path / "out")
    call[1] = str(tmp_path / "dma.csv")
    for more in (("--branches-per-decade", "1"), ("--branches-per-decade", "4"), ()):
        assert asperity(*call, *more)[0] == 0
    few, many, free = (found.fit.series.error for found in undrawn if found.fit is not None)
    assert few > 0.1
    assert many < 0.02
    assert free < 1e-6
    assert any("more branches per decade" in remark for remark in undrawn[0].remarks)


def test_what_python_refuses(files: Path, scan: asp.surfaces.Surface) -> None:
    table = files / "relaxation.csv"
    with refuses("load and pressure"):
        asp.predict(table, scan)
    for ratio in (0.7, [0.3, 0.2], "abc"):
        with refuses("poisson"):
            asp.predict(table, scan, pressure=1e6, modulus="contact", poisson=ratio)  # type: ignore[arg-type]
    with refuses("modulus"):
        asp.predict(table, scan, pressure=1e6, modulus="bulk")  # type: ignore[arg-type]
    with refuses("surface"):
        asp.predict(table, asp.surfaces.Surface(scan.heights[0]), pressure=1e6)
    with refuses("surface"):
        asp.predict(table, asp.surfaces.Surface(scan.heights), pressure=1e6)
    with refuses("data"):
        asp.predict(3.5, scan, pressure=1e6)  # type: ignore[arg-type]
    with refuses("surface"):
        asp.predict(table, scan.heights, pressure=1e6)  # type: ignore[arg-type]


@pytest.mark.skipif(not (DATA / "mi-1.mi").is_file(), reason="needs ASPERITY_DATA")
def test_a_part_of_a_real_scan(undrawn: list[Prediction], tmp_path: Path, asperity: Asperity) -> None:
    part = ("--crop", "0", "64", "0", "64", "--pressure", "5MPa", "--per-decade", "1")
    call = ("predict", PMMA, "--surface", DATA / "mi-1.mi", *part, "--quiet", "--out", tmp_path / "out")
    assert asperity(*call) == (0, "", "")
    assert undrawn[0].time.size == 10
    area = undrawn[0].series("contact_area_corrected")
    assert (np.diff(area) > 0).all()
    assert 0.05 < area[0] / (64 * 78.125e-9) ** 2 < 0.6
    assert 1.2 < area[-1] / area[0] < 3


def test_beyond_a_table_the_contact_stays_where_its_last_modulus_does(
    files: Path, tmp_path: Path, asperity: Asperity
) -> None:
    refused = asperity(*words(files, "--pressure", "40MPa", "--last", "500s", "--out", tmp_path / "out"))
    assert refused[0] == 2
    assert "try --extrapolate" in refused[2]
    plateau = ("--pressure", "40MPa", "--last", "500s", "--extrapolate", "plateau", "--quiet")
    assert asperity(*words(files, *plateau, "--out", tmp_path / "out"))[0] == 0
    dataset = asp.results.load(tmp_path / "out" / "history.zarr")
    assert json.loads(dataset.attrs["prediction"])["extrapolate"] == "plateau"
    fitted = asp.relaxation.fit(asp.relaxation.read(files / "relaxation.csv"), extrapolate="plateau")
    # A separable half-space: area in proportion to the compliance, which is 1/E on the plateau.
    area = dataset["contact_area"]
    ends = [float(area.sel(time=time, method="nearest")) for time in (100.0, 500.0)]
    crept = fitted.series.compliance_at([100.0, 500.0])
    assert ends[1] / ends[0] == pytest.approx(crept[1] / crept[0], rel=0.02)
    assert (tmp_path / "out" / "solid.toml").read_text().count("assumed to stay") == 1
