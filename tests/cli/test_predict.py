"""``asperity predict``: from a table, a scan and a load to growth, against other ways to it."""

import html
import json
import re
from collections import Counter
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

import asperity as asp
from asperity.app.cli import asking, main
from asperity.app.cli.flags import naming
from asperity.app.config import config_from
from asperity.app.runs import Progress
from asperity.app.runs.prediction import foretell
from asperity.errors import InputError
from asperity.figures.page import prediction_page, quantity
from asperity.figures.prediction import growth_figure
from asperity.protocols import Hold, Ramp
from tests.cli.conftest import rows_of
from tests.refusals import refuses

pytestmark = pytest.mark.xdist_group("predict")  # in one process, which predicts once
TAU = 30e6
LENGTHS: dict[str, Any] = {"file_unit": "nm", "pixel_size": 50.0, "length_unit": "nm"}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A folder with a scan without units, as text in nm, and a relaxation table of four decades."""
    folder = tmp_path_factory.mktemp("files")
    heights = asp.surfaces.spectral((40, 48), spacing=50.0, hurst=0.8, rms_height=20.0, seed=3)
    np.savetxt(folder / "scan.txt", heights)
    time = np.geomspace(0.01, 100.0, 17)
    modulus = 1000 + 600 * np.exp(-time / 0.3) + 900 * np.exp(-time / 20)
    lines = (f"{t:.6g},{E:.8g}" for t, E in zip(time, modulus, strict=True))
    (folder / "relaxation.csv").write_text("\n".join(["time_s,E_MPa", *lines]) + "\n")
    return folder


def words(files, *more):
    """The command, with the units of the scan."""
    table, scan = files / "relaxation.csv", files / "scan.txt"
    units = ("--file-unit", "nm", "--pixel-size", "50", "--length-unit", "nm")
    return ["predict", str(table), "--surface", str(scan), *units, *map(str, more)]


@pytest.fixture(scope="module")
def finished(files):
    """The folder of a finished prediction, not to be changed."""
    out = files / "out"
    extra = ("--shear-strength", "30MPa", "--pixel", "0.2um", "--blur", "150nm", "--threshold", "0.3")
    assert main([*words(files, "--pressure", "40MPa", "--quiet", "--out", out), *extra]) == 0
    return out


@pytest.fixture(scope="module")
def scan(files):
    """The scan, with its units."""
    return asp.surfaces.read(files / "scan.txt", periodic="reflect", **LENGTHS)


@pytest.fixture(scope="module")
def prediction(files, scan):
    """The same prediction in Python."""
    return asp.predict(files / "relaxation.csv", scan, pressure="40 MPa", shear_strength=TAU)


def test_edges_are_free_where_asked_and_the_page_says_so(files, prediction, undrawn, tmp_path):
    out = tmp_path / "out"
    assert main(words(files, "--pressure", "40MPa", "--quiet", "--edges", "free", "--out", out)) == 0
    free = asp.surfaces.read(files / "scan.txt", periodic="free", **LENGTHS)
    same = asp.predict(files / "relaxation.csv", free, pressure="40 MPa").dataset
    np.testing.assert_array_equal(undrawn[0].dataset["in_contact"], same["in_contact"])
    assert (same["contact_area"].values != prediction.dataset["contact_area"].values).all()
    for ours, summary, page in (
        (undrawn[0], "edges are free: the body ends with the scan", "ends at the edges of the scan"),
        (prediction, "edges reflect, as for a part", "its own mirror image"),
    ):
        assert summary in str(ours.remarks)
        assert page in prediction_page(ours, {})


def test_the_command_and_the_function_agree(finished, prediction):
    assert sorted(path.name for path in finished.iterdir()) == [
        *(
            "asperity.json",
            "config.toml",
            "contacts.csv",
            "contacts.png",
            "growth.csv",
            "growth.png",
            "history.csv",
        ),
        *("history.zarr", "observed.csv", "observed.png", "prediction.html", "pressure.csv", "pressure.png"),
        *("relaxation.csv", "relaxation.png", "solid.toml", "summary.txt"),
    ]
    stored, rows = asp.results.load(finished), rows_of(finished / "history.csv")
    table = {name: [float(row[name]) for row in rows] for name in rows[0]}
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
    summary = (finished / "summary.txt").read_text(encoding="utf-8")
    for number in (
        "relaxation.csv: time from 'time_s' in s, Young's modulus from 'E_MPa' in MPa, ",
        f"A(100 s)/A(10 ms)  {prediction.growth.ratio:.2f} (95 %: {prediction.growth.ratio_band[0]:.2f} to ",
        f"{last.area * 1e12:.4g} um^2, patches: {last.patches.count}",
        *("share 0.24 relaxes in 300 ms", "share 0.36 relaxes in 20 s", "share 0.4 does"),  # 600, 900, 1000
    ):
        assert number in summary


def test_a_load_is_a_pressure_over_the_scan(files, scan, prediction):
    table, load = files / "relaxation.csv", 40e6 * 40 * 48 * 50e-9**2
    ours = asp.predict(table, scan, load=f"{1e3 * load} mN", first=1.0, last="1e5 ms")
    assert ours.time[[0, -1]].tolist() == pytest.approx([1.0, 100.0])
    np.testing.assert_array_equal(ours.series("area")[-1], prediction.series("area")[-1])
    assert ours.friction is None
    assert prediction.modulus == pytest.approx(prediction.fit.series.modulus / (1 - 0.35**2))


def test_mirror_images_are_taken_as_reflecting_edges(files, prediction):
    mirrored = asp.surfaces.read(files / "scan.txt", periodic="mirror", **LENGTHS)
    doubled = asp.predict(files / "relaxation.csv", mirrored, pressure="40 MPa")
    np.testing.assert_array_equal(doubled.series("area"), prediction.series("area"))
    assert doubled.growth == prediction.growth
    # The doubled scan itself, periodic, touches on four times the sites.
    contact = asp.press(mirrored, asp.solids.half_space(modulus=prediction.modulus), pressure=40e6)
    assert contact.area == pytest.approx(4 * int(prediction.dataset["area"][0]), abs=4)


def test_another_temperature_shifts_every_time_of_a_table_of_chosen_columns(
    files, prediction, undrawn, asperity
):
    lines = (files / "relaxation.csv").read_text().splitlines()
    Path("table.csv").write_text("\n".join(["a [s],b [MPa]", *lines[1:]]))
    chosen = ("--pressure", "40MPa", "--quiet", "--kind", "relaxation", "--columns", "0", "1")
    # A value that begins with a minus is none of the flags.
    warm = ("--temperature", "-5degC", "--reference", "258.15 K", "--activation-energy", "100kJ/mol")
    assert asperity("predict", "table.csv", *words(files, *chosen, *warm)[2:]) == (0, "", "")
    factor = np.exp(1e5 / 8.31446261815324 * (1 / 268.15 - 1 / 258.15))
    np.testing.assert_allclose(undrawn[0].time, factor * prediction.time, rtol=1e-6)
    np.testing.assert_allclose(undrawn[0].series("area"), prediction.series("area"), atol=1)


def test_quantities_are_spelled_as_printed():
    for value, unit, said in (
        (2.2e-11, "m^2", "22 µm²"),
        (1.61e-15, "m^2", "1610 nm²"),
        (9.7656e-10, "m", "977 pm"),
        (1.78e4, "s", "17800 s"),
        (1e6, "s", "10⁶ s"),
        (2.5e7, "s", "2.5 × 10⁷ s"),
    ):
        assert quantity(value, unit) == said.replace(" ", "\u00a0")


def test_the_page_says_what_was_predicted(finished, prediction):
    page = (finished / "prediction.html").read_text(encoding="utf-8")
    opened, closed = (Counter(re.findall(rf"<{slash}([a-z]\w*)", page)) for slash in ("", "/"))
    assert opened - closed == Counter({"meta": opened["meta"], "img": 5})
    assert page.count('src="data:image/png;base64,iVBOR') == 5
    text = " ".join(html.unescape(re.sub("<[^>]*>", "", page)).split())
    low, high = prediction.growth.ratio_band
    assert f"A(100 s)/A(10 ms) = {prediction.growth.ratio:.5g} (95 % band {low:.4g} to {high:.4g})" in text
    assert "nan" not in text.lower().split()
    for remark in prediction.remarks:
        assert remark[1:] in text


PMMA_BRANCHES = ((184.62 / 1805.39, 8.93), (191.06 / 1805.39, 117.96))
LOADED: dict[str, Any] = {"pressure": "2 MPa", "first": 10.0, "last": 1000.0}


@pytest.fixture(scope="module")
def ramped(scan):
    """Predictions for a load put on at once, and within 2.4 s."""
    solid = asp.solids.half_space(modulus=1805.39e6, branches=PMMA_BRANCHES)
    return {ramp: asp.predict(solid, scan, **LOADED, ramp=ramp or None) for ramp in (0.0, 2.4)}


def test_a_ramp_is_the_integral_of_the_compliance(ramped, scan):
    # J * dF(1000 s) / J * dF(10 s) by hand; loaded as by Dillavou and Rubinstein, PRL 120, 224101 (2018).
    elastic = asp.solids.half_space(modulus=1805.39e6)
    for ratio, ours in zip((1.1674, 1.1746), ramped.values(), strict=True):
        effective = ours.effective_load
        assert effective[-1] / effective[0] == pytest.approx(ratio, abs=5e-5)
        assert ours.time[[0, -1]].tolist() == pytest.approx([10.0, 1000.0])
        assert ours.dataset.attrs["exact_contact"] == "at all times"
        maps = ours.dataset["in_contact"]
        for place in (0, 4, -1):
            contact = asp.press(scan, elastic, load=float(effective[place]))
            assert ours.series("area")[place] == contact.area
            assert ours.series("load")[place] == pytest.approx(ours.load, rel=1e-9)
            if (there := maps["field_time"] == ours.time[place]).any():
                np.testing.assert_array_equal(maps[there].squeeze(), contact.in_contact)


def test_the_figure_sets_the_compliance_beside_the_area(ramped):
    for ramp, ours in ramped.items():
        upper, *_, lower = growth_figure(ours).axes[:2]
        lines = {str(line.get_label()): np.asarray(line.get_ydata(), dtype=float) for line in upper.lines}
        name = "effective load" if ramp else "creep compliance"
        dotted, area = lines[f"as the {name} grows"], lines["corrected for pixel rims"]
        np.testing.assert_allclose(dotted, area[0] * ours.effective_load / ours.effective_load[0])
        assert ("since the loading began" in lower.get_xlabel()) == bool(ramp)


def test_times_within_the_loading_are_remarked(scan):
    solid = asp.solids.half_space(modulus=1805.39e6, branches=PMMA_BRANCHES)
    times: dict[str, Any] = {"pressure": "2 MPa", "last": "100 s", "ramp": "2.4 s", "per_decade": 3}
    early, late = (asp.predict(solid, scan, first=first, **times) for first in ("1 s", "2.4 s"))
    begins = "2 recorded times are before the end of the loading"
    assert any(remark.startswith(begins) for remark in early.remarks)
    assert early.series("load")[0] == pytest.approx(early.load / 2.4, rel=1e-5)
    assert not any("loading" in remark for remark in late.remarks)


def test_the_fitted_solid_is_a_file_for_run_and_predict(finished, files, undrawn, prediction, tmp_path):
    more = words(files, "--pressure", "40MPa", "--first", "10ms", "--last", "100s", "-q")[2:]
    assert main(["predict", str(finished / "solid.toml"), *more]) == 0
    again = undrawn[0]
    assert again.modulus == pytest.approx(prediction.modulus, rel=1e-12)
    np.testing.assert_allclose(again.branches, prediction.branches, rtol=1e-12)
    np.testing.assert_array_equal(again.series("area"), prediction.series("area"))
    run = ("--shape", "16", "16", "-q", "--out", str(tmp_path / "run"))
    assert main(["run", str(finished / "solid.toml"), *run]) == 0
    assert main(["predict", str(finished / "solid.toml"), *more, "--last", "100 years"]) == 2
    # The same from flags alone, as a paper states it.
    branches = [word for share, time in prediction.branches for word in ("--branch", f"{share!r} {time!r}s")]
    young = ("--young", f"{prediction.modulus * (1 - 0.35**2)!r}Pa")
    assert main(["predict", *more, *young, *branches]) == 0
    np.testing.assert_array_equal(undrawn[1].series("area"), prediction.series("area"))


def test_a_protocol_may_put_the_load_on(files, ramped):
    # As asperity run takes it; a load of 0 is not for contacts without a ramp.
    hold = {"kind": "hold", "duration": 997.6}
    tables = {
        "surface": {"path": str(files / "scan.txt"), "periodic": "reflect", **LENGTHS},
        "solid": {"kind": "half_space", "modulus": 1.80539e9, "branches": [*map(list, PMMA_BRANCHES)]},
        "contact": {"pressure": "2 MPa"},
        "aging": {"first": 10.0},
        "protocol": [{"kind": "ramp", "duration": "2.4 s", "pressure": "2 MPa"}, hold],
        "prediction": {},
    }
    config = config_from(tables, {}, None)
    held = foretell(config, Progress()).prediction
    assert held.growth is None  # from 2 MPa to 2 MPa: a history as any other
    unloaded = type(config.contact)(load=0.0)
    ours = foretell(config.but(contact=unloaded), Progress()).prediction
    np.testing.assert_array_equal(ours.series("area"), ramped[2.4].series("area"))
    legs = [Ramp(2.4, pressure=2e6), Hold(997.6)]
    scan, material = config.surface.scan.build(), config.solid.material
    in_python = asp.predict(material, scan, protocol=legs, first=10.0)
    assert in_python.dataset.identical(ours.dataset)


@pytest.mark.parametrize("pressure", ["1 Pa", "9 GPa"])
def test_a_contact_of_one_pixel_or_of_all_does_not_grow(files, scan, pressure):
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
        top = axes.bbox.y1 + 1  # beyond it nothing is drawn
        assert not any(box.contains(*point) for line in points for point in line if point[1] < top)
    assert len(asp.figures.prediction_pictures(ours)) == 4


def test_an_interrupted_prediction_goes_on(files, monkeypatch, asperity, scan, undrawn, tmp_path):
    class Impatient(Progress):
        def reached(self, frame):
            if frame.time > 1.0:
                raise KeyboardInterrupt

    monkeypatch.setattr(asking, "_CHECKPOINT_EVERY", 0.0)
    call = words(files, "--pressure", "40MPa", "--ramp", "50ms", "--quiet", "--out", tmp_path / "out")
    with monkeypatch.context() as hurried:
        hurried.setattr("asperity.progress.Progress", Impatient)
        status, _, said = asperity(*call)
    assert status == 130
    assert "the same command resumes from" in said
    assert [path.suffix for path in tmp_path.iterdir()] == [".checkpoint"]
    assert asperity(*call) == (0, "", "")
    assert list(tmp_path.iterdir()) == []
    undisturbed = asp.predict(files / "relaxation.csv", scan, pressure="40 MPa", ramp=0.05)
    for name in ("contact_area_corrected", "iterations", "in_contact"):
        np.testing.assert_array_equal(undrawn[0].dataset[name], undisturbed.dataset[name])


def test_the_same_number_in_another_unit_is_the_same_prediction(files, asperity, monkeypatch):
    asked = Mock(side_effect=KeyboardInterrupt)
    monkeypatch.setattr("asperity.app.cli.computing._place_beside", asked)
    for pressure in ("1MPa", "1000 kPa", "2MPa"):
        asperity(*words(files, "--pressure", pressure))
    first, same, other = (call.args[1] for call in asked.mock_calls)
    assert first == same != other


def test_advice_names_flags_but_not_within_python():
    facts: dict[str, Any] = {"cure": {"unit": "m"}, "advice": "Surface(h, unit='m', x=(1, 2))"}
    with pytest.raises(InputError) as raised, naming(unit="--unit"):
        raise InputError("unit", expected="one", got="none", **facts)
    assert str(raised.value).endswith("try --unit m, or Surface(h, unit='m', x=(1, 2))")


def test_more_branches_follow_a_table_of_few_times(files, undrawn, asperity):
    omega = np.geomspace(0.01, 100.0, 13)
    shares, times = np.array([600.0, 900.0]), np.array([0.3, 0.9])  # less than half a decade apart
    x2 = (omega[:, None] * times) ** 2
    storage, loss = 1000 + x2 / (1 + x2) @ shares, np.sqrt(x2) / (1 + x2) @ shares
    columns, header = np.stack([omega, storage, loss], axis=-1), "omega_rad_s,storage_MPa,loss_MPa"
    np.savetxt("dma.csv", columns, delimiter=",", header=header, comments="", fmt="%.8g")
    call = words(files, "--pressure", "40MPa", "--quiet")[2:]
    for more in (("--branches-per-decade", "1"), ("--branches-per-decade", "4"), ()):
        assert asperity("predict", "dma.csv", *call, *more)[0] == 0
    few, many, free = (found.fit.series.error for found in undrawn)
    assert (few > 0.1, many < 0.02, free < 1e-6) == (True, True, True)
    assert undrawn[0].fit.finer == 2
    assert any("2 branches per decade" in remark for remark in undrawn[0].remarks)


def test_what_python_refuses(files, scan):
    how: dict[str, Any]
    table, line = files / "relaxation.csv", asp.surfaces.Surface(scan.heights[0])
    for name, got, data, rough, how in (
        ("load and pressure", "none", table, scan, {}),
        ("instrument", "float", table, scan, {"pressure": 1e6, "instrument": 0.2}),
        ("surface", "a profile", table, line, {"pressure": 1e6}),
        ("surface", "heights without a unit", table, asp.surfaces.Surface(scan.heights), {"pressure": 1e6}),
        ("surface", "ndarray", table, scan.heights, {"pressure": 1e6}),
        ("material", "float", 3.5, scan, {"pressure": 1e6}),
    ):
        with refuses(name, got):
            asp.predict(data, rough, **how)  # type: ignore[arg-type]


def test_beyond_a_table_the_contact_stays_where_its_last_modulus_does(files, undrawn, asperity):
    plateau = ("--pressure", "40MPa", "--last", "500s", "--extrapolate", "plateau", "--quiet")
    assert asperity(*words(files, *plateau))[0] == 0
    ours = undrawn[0]
    assert ours.assumed["extrapolate"] == "plateau"
    assert sum("assumed to stay" in remark for remark in ours.remarks) == 1
    fitted = asp.relaxation.fit(asp.relaxation.read(files / "relaxation.csv"), extrapolate="plateau")
    # A separable half-space: area in proportion to the compliance, which is 1/E on the plateau.
    area = ours.dataset["contact_area"]
    ends = [float(area.sel(time=time, method="nearest")) for time in (100.0, 500.0)]
    crept = fitted.series.compliance_at([100.0, 500.0])
    assert ends[1] / ends[0] == pytest.approx(crept[1] / crept[0], rel=0.02)
