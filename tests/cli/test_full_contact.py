"""Commands and results where all touches, nothing bears load, or there is one site, one row, one time."""

import html
import re
import shlex
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest

import asperity as asp
from asperity.figures import carried_figure
from tests.cli.conftest import SMALL, rows_of
from tests.cli.test_friction import HOLDS, LAW, F, write

HEIGHTS = 1e-9 * asp.surfaces.spectral((12, 12), hurst=0.8, seed=1)
MODULUS, SIDE = 3e9, 1e-6
CARRIED = """--stiffness --resistivity '17 nOhm m' --conductivity '0.2 W/m/K' --shear 1fN
    --friction-coefficient 0.4 --work-of-adhesion '2 J/m^2'"""
SCAN = "--surface scan.npy --file-unit m --pixel-size 1e-6 --length-unit m"
SOLID = "--young 3GPa --poisson 0 --branch '0.9 1s'"
RUN = f"run {SCAN} --solid half_space {SOLID} {CARRIED}"
PREDICT = f"predict {SCAN} {SOLID} {CARRIED} --first 0.1s --last 100s"


def pressure_of_full_contact() -> float:
    """Largest tension where reflecting edges and all heights touch: E* |q| h / 2, wave by wave."""
    whole = np.block([[HEIGHTS, HEIGHTS[:, ::-1]], [HEIGHTS[::-1], HEIGHTS[::-1, ::-1]]])
    q = 2 * np.pi * np.fft.fftfreq(len(whole), SIDE)
    pressure = np.fft.ifft2(MODULUS * np.hypot(*np.meshgrid(q, q)) / 2 * np.fft.fft2(whole)).real
    return -float(pressure.min())


FULL = pressure_of_full_contact()
HALF, TWICE = f"{FULL / 2:.6g}Pa", f"{2 * FULL:.6g}Pa"


@pytest.fixture(autouse=True)
def _scan():
    np.save("scan.npy", HEIGHTS)


def said(asperity, words: str, out: str = "") -> str:
    """What a command that succeeds says, on terminal, page and summary: no picture fails, no nan, no inf."""
    status, text, error = asperity(*shlex.split(words), *(["--out", out] if out else []))
    assert status == 0, error
    for path in [*Path(out).glob("*.html"), *Path(out).glob("summary.txt")] if out else ():
        text += re.sub(r"<style.*?</style>|<[^>]*>", " ", html.unescape(path.read_text("utf-8")), flags=re.S)
    assert "could not be drawn" not in text + error
    assert not re.findall(r"(?<![\w.])[-+]?(?:nan|inf)(?!\w)", text + error)
    return str(text + error)


@pytest.mark.parametrize(
    ("load", "full"),
    [
        (f"--pressure {HALF} --times 0.1 1 10", [False, False, False, True]),
        (f"--pressure {TWICE} --times 0.1 1 10", [True] * 4),
        (
            f"--load 0 --leg 'ramp 1 pressure={TWICE}' --leg 'hold 10' --times 0.1 11",
            [False, False, True, True],
        ),
    ],
    ids=["becomes", "from the start", "empty at first"],
)
def test_a_run_carries_on_through_full_contact(asperity, load, full):
    text = said(asperity, f"{RUN} {load}", "out")
    data = asp.results.load("out")
    assert (data["contact_fraction"].values == 1).tolist() == full
    assert "full contact has no pull-off force" in text
    for name in ("normal_stiffness", "tangential_stiffness"):
        assert np.isinf(data[name].values).tolist() == full
    for name in ("resistance", "thermal_resistance"):
        assert (data[name] == 0).values.tolist() == full
    assert data["pull_off"].isnull().values.tolist() == full
    assert "pull-off force" in text
    assert "infinite" in text
    column = [row["pull_off_N"] for row in rows_of(Path("out/aging.csv"))]
    assert [cell == "nan" for cell in column] == full
    drawn = carried_figure(data).axes[0].get_lines()
    (values,) = [line.get_ydata() for line in drawn if line.get_marker() == "o"]
    there = ~np.array(full) & (data["load"].values > 0)
    assert np.isfinite(np.asarray(values, dtype=float)).tolist() == there.tolist()
    said(asperity, "explore out --export page.html")


@pytest.mark.parametrize(
    "load",
    [
        pytest.param(f"--pressure {HALF} --resolution-study", id="becomes", marks=pytest.mark.slow),
        pytest.param(f"--pressure {TWICE} --ramp 1s", id="empty at first", marks=pytest.mark.slow),
        pytest.param(f"--pressure {TWICE}", id="from the start"),
    ],
)
def test_a_prediction_carries_on_through_full_contact(asperity, monkeypatch, load):
    monkeypatch.setattr("asperity.prediction.predicting._FEWEST", 2)  # so that the study leaves waves out
    text = said(asperity, f"{PREDICT} {load}", "out")
    assert "infinite" in text
    assert "full contact has no pull-off force" in text
    assert Path("out/carried.png").exists()
    if "study" in load:
        assert [row["stiffness [N/m]"] for row in rows_of(Path("out/resolution.csv"))] == ["inf", "inf"]
        changes, *_ = re.findall(r"resolution +without waves below 4 um: (.*)", text)
        assert changes.startswith("area by +0 %, pressure by")
        assert "stiffness" not in changes
    last = rows_of(Path("out/history.csv"))[-1]
    assert (last["normal_stiffness [N/m]"], last["pull_off [N]"]) == ("inf", "nan")


@pytest.mark.parametrize(
    "words",
    [
        "run --shape 1 1 --k0 1 --k1 3 --load 1 --times 1 10",
        "run --shape 1 12 --k0 1 --k1 3 --load 1e6 --times 1 10",
        "run --shape 12 --k0 1 --k1 3 --load 1 --times 1",
        "run --shape 12 12 --k0 1 --k1 3 --load 1 --times 0",
        f"{RUN} --pressure {HALF} --times 0",
        f"{RUN} --pressure {HALF} --times 1",
        f"law {SCAN} {SOLID} --pressures 1kPa {HALF} --per-decade 1 --times 0s",
    ],
)
def test_one_site_one_row_and_one_time(asperity, words):
    said(asperity, words, "out")


@pytest.mark.parametrize("shape", [(1, 1), (1, 12)])
def test_a_surface_of_one_site_or_one_row(asperity, shape):
    np.save("few.npy", HEIGHTS[: shape[0], : shape[1]])
    said(asperity, "surface few.npy --file-unit m --pixel-size 1e-6 --length-unit m")


def test_a_separation_without_load(asperity):
    highest = float(asp.surfaces.gaussian((12, 12), seed=1).max())
    said(asperity, f"run --shape 12 12 --seed 1 --k0 1 --k1 3 --separation {highest!r} --times 1 10", "out")


def test_results_in_python(no_display):
    scan = asp.surfaces.Surface(
        HEIGHTS, pixel_size=(SIDE, SIDE), unit="m", length_unit="m", edges="reflecting"
    )
    solid = asp.solids.half_space(modulus=MODULUS, branches=[(0.9, 1.0)])
    full = asp.press(scan, solid, pressure=2 * FULL)
    carried = asp.Carried(resistivity=17e-9, poisson=0.3, work_of_adhesion=2.0)
    with pytest.warns(asp.errors.Remark, match="full contact has no pull-off force"):
        history = asp.age(full, [1.0], carried=carried)
    for name in ("area", "normal_stiffness", "resistance", "pull_off"):
        history.plot(quantity=name)
    full.plot()
    for card in (history._repr_html_(), full._repr_html_()):
        assert card is not None
        assert "<img" in card
    with pytest.raises(asp.errors.InputError):
        asp.age(full, [1.0], carried=asp.Carried(work_of_adhesion=-1.0))


COMMANDS = {
    "run": (" ".join(("run", *SMALL)), "aging.csv"),
    "predict": (f"predict {SCAN} {SOLID} --pressure {HALF} --first 0.1s --last 10s", "history.csv"),
    "law": (f"law {SCAN} {SOLID} --pressures 1kPa {HALF} --per-decade 1 --times 0s", "law.csv"),
    "friction": ("friction lab.csv --a 0.01", "friction.toml"),
    "surface": ("surface scan.npy", ""),
    "fit": ("fit area.csv --json out.json", "../out.json"),
}


@pytest.mark.parametrize("command", COMMANDS)
def test_a_picture_that_fails_is_a_remark_and_no_loss(asperity, monkeypatch, command):
    monkeypatch.setattr("matplotlib.figure.Figure.savefig", Mock(side_effect=IndexError("no axis fits")))
    write("lab.csv", F.synthetic_record(HOLDS, LAW, noise=5e-4, seed=1))
    time = np.geomspace(1, 1e4, 12)
    np.savetxt("area.csv", np.transpose([time, 1 + np.log1p(time)]), header="time_s,area", delimiter=",")
    words, kept = COMMANDS[command]
    folder = ["--out", "out"] if command not in ("surface", "fit") else []
    status, text, error = asperity(*shlex.split(words), *folder)
    assert (status, "Traceback" in error) == (0, False), error
    assert re.search(r"the figure .* could not be drawn: no axis fits", text + error)
    assert not [*Path().rglob("*.png")]
    assert not kept or (Path("out") / kept).resolve().exists()
    if folder:
        assert "could not be drawn: no axis fits" in Path("out/summary.txt").read_text("utf-8")
    if command == "predict":
        assert "could not be drawn" in Path("out/prediction.html").read_text("utf-8")


def test_a_summary_or_a_page_that_fails_is_a_remark_and_no_loss(says, monkeypatch):
    monkeypatch.setattr("asperity.prediction.rows.carried_rows", Mock(side_effect=ZeroDivisionError("by 0")))
    monkeypatch.setattr("asperity.figures.page.prediction_page", Mock(side_effect=KeyError("rows")))
    words, kept = COMMANDS["predict"]
    text = says(*shlex.split(words), "--quiet", "--out", "out") + Path("out/summary.txt").read_text("utf-8")
    assert "the summary could not be drawn: by 0" in text
    assert "the page could not be drawn: 'rows'" in text
    assert Path("out", kept).exists()
    assert asp.results.load("out").sizes["time"] > 1


def test_a_card_that_fails_leaves_its_rows_or_the_repr(monkeypatch):
    contact = asp.press(HEIGHTS, asp.solids.spring_lattice(k0=1.0, k1=3.0), load=1.0)
    monkeypatch.setattr("asperity.figures.cards.plot_contact", Mock(side_effect=ValueError("no axis fits")))
    with pytest.warns(asp.errors.Remark, match="picture of the card 'Contact' could not be drawn: no axis"):
        assert "separation" in str(contact._repr_html_())
    monkeypatch.setattr(asp.Contact, "rows", Mock(side_effect=ValueError("no rows")))
    with pytest.warns(asp.errors.Remark, match="the card could not be drawn: no rows"):
        assert contact._repr_html_() is None
