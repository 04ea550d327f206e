"""Histories from flags and files: ``asperity run --leg ...`` and ``[[protocol]]``."""

import re
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from asperity import age, press, results
from asperity.app.cli import main
from asperity.app.cli.flags import flags_for, given
from asperity.app.config import read_config
from asperity.app.config.legs import legs_from_words
from asperity.app.config.python import to_python
from asperity.app.runs import Progress, execute
from asperity.app.runs.pipeline import recorded_times
from asperity.ask.run import RunConfig
from asperity.base.words import tables_to_toml
from asperity.errors import ConfigError, InputError
from asperity.protocols import Hold, Ramp, Repeat, Slide, Step
from asperity.solids import spring_lattice
from asperity.surfaces import gaussian
from tests.cli.conftest import rows_of
from tests.refusals import refuses

LEGS = ("--leg", "hold 1", "--leg", "step load=8", "--leg", "ramp 2 load=30", "--leg", "hold 4 mobility=2")
SMALL = ("--shape", "32x32", "--load", "20", "--first", "0.1", "--per-decade", "2")

CYCLE = [
    {"kind": "step", "load": 30.0},
    {"kind": "hold", "duration": 1.0},
    {"kind": "ramp", "duration": 1, "load": 60.0},
]
TABLES = {
    "surface": {"shape": [16, 16]},
    "contact": {"load": 60.0},
    "aging": {"first": 0.1, "per_decade": 1},
    "protocol": [
        {"kind": "repeat", "count": 2, "legs": CYCLE},
        {"kind": "hold", "duration": 10.0, "hold": "area"},
    ],
}


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    """The folder of a finished history."""
    folder = tmp_path_factory.mktemp("history") / "out"
    assert main(["run", *SMALL, *LEGS, "--quiet", "--out", str(folder)]) == 0
    return folder


def test_the_history_is_that_of_the_verbs(out):
    names = "aging.csv asperity.json config.toml contacts.csv contacts.png history.csv history.png"
    names += " history.zarr patches.csv patches.png patches_data.csv summary.txt"
    assert sorted(path.name for path in out.iterdir()) == names.split()
    data = results.load(out)
    contact = press(gaussian((32, 32), seed=0), spring_lattice(k0=1.0, k1=3.0), load=20.0)
    legs = [Hold(1.0), Step(load=8.0), Ramp(2.0, load=30.0), Hold(4.0, mobility=2.0)]
    times = np.unique(data["time"])[1:]
    alone = age(contact, times, protocol=legs, fields_at=np.unique(data["field_time"])).dataset
    for name in ("time", "leg", "area", "load", "u0", "field_leg"):
        np.testing.assert_array_equal(data[name], alone[name])
    # Times are spread over decades since each switch, and evenly in ramps.
    assert {0.1, 1.0, 3.1, 7.0} <= set(np.round(times, 12))
    assert ((times > 1) & (times < 3)).sum() == 11


def test_the_table_and_the_summary_name_legs_and_the_configuration_runs_again(out, tmp_path):
    rows, data = rows_of(out / "aging.csv"), results.load(out)
    for name in ("leg", "load"):
        np.testing.assert_array_equal([float(row[name]) for row in rows], data[name])
    lines = (out / "summary.txt").read_text().splitlines()
    legs = [line.split()[2].rstrip(",") for line in lines if line.startswith("leg ")]
    assert legs == ["hold", "step", "ramp", "hold"]
    assert main(["run", str(out / "config.toml"), "--quiet", "--out", str(tmp_path / "again")]) == 0
    assert (tmp_path / "again" / "aging.csv").read_bytes() == (out / "aging.csv").read_bytes()


def test_the_summary_says_areas_in_a_unit_and_what_a_step_left(tmp_path, asperity):
    surface = "--surface spectral --shape 32x32 --rms-height 2e-7 --spacing 5e-8 --unit m --load 80uN"
    solid = ("--solid", "half_space", "--modulus", "3GPa", "--branch", "0.6 1 s")
    legs = ("--leg", "hold 3", "--leg", "step load=15uN", "--leg", "hold 5", "--figures", "")
    assert asperity("run", *surface.split(), *solid, *legs, "-q", "--out", tmp_path / "out") == (0, "", "")
    data = results.load(tmp_path / "out")
    area, leg, sites = data["contact_area"].values * 1e12, data["leg"].values, data["area"].values  # um^2
    before, after = np.flatnonzero(leg == 0)[-1], np.flatnonzero(leg == 1)[-1]
    lines = (tmp_path / "out" / "summary.txt").read_text().splitlines()
    first, step, last = (next(line for line in lines if line.startswith(f"leg {n} ")) for n in range(3))
    grown = f"contact {area[0]:.4g} to {area[before]:.4g} um^2 ({sites[0]} to {sites[before]} sites)"
    assert first.endswith(grown)
    left = f"({sites[before]} to {sites[after]} sites) at once, {area[after] / area[before]:.4g} of before"
    assert left in step
    assert f", {area[-1] / area[before]:.4g} of before the step" in last


def test_a_file_with_repetitions(tmp_path, says):
    Path("study.toml").write_text(tables_to_toml(TABLES))
    config = read_config(Path("study.toml"), {})
    cycle = Repeat([Step(load=30.0), Hold(1.0), Ramp(1.0, load=60.0)], 2)
    assert config.protocol == (cycle, Hold(10.0, "area"))
    assert config.end == 14.0
    says("run", "study.toml", "--out", tmp_path / "out", "--figures", "")
    data = results.load(tmp_path / "out")
    assert data["leg"].values.max() == 6
    assert np.ptp(data["area"].values[data["leg"].values == 6]) <= 2


def test_units_of_legs_may_stand_apart():
    for leg in legs_from_words(["ramp 5 s pressure=2 MPa mobility=3", "ramp 5s pressure = 2MPa mobility=3"]):
        assert leg["mobility"] == 3
        assert [str(leg[key]).replace(" ", "") for key in ("duration", "pressure")] == ["5s", "2MPa"]


@pytest.mark.parametrize(
    "leg", ["hold 1h", "step pressure=2MPa", "ramp 1s load=1N", "slide distance=8um velocity=5um/s"]
)
def test_a_leg_with_units_is_refused_on_a_solid_without(leg, tmp_path):
    config = RunConfig.read(
        {
            "surface": {"kind": "gaussian", "shape": [16, 16]},
            "contact": {"load": 20.0},
            "protocol": legs_from_words(["hold 1", leg, "repeat 2"]),
        }
    )
    unit = re.search(r"(1h|2MPa|1s|8um)", leg)
    with refuses("quantities", unit[0] if unit else "none"):
        execute(config, Progress())


def test_sliding_and_friction_from_flags(tmp_path, says):
    legs = ("hold 1", "slide distance=3 velocity=2", "slide distance=2 velocity=inf")
    flags = [word for leg in legs for word in ("--leg", leg)]
    says("run", *SMALL, *flags, "--shear-strength", "4", "--out", tmp_path / "out")
    data = results.load(tmp_path / "out")
    assert data["displacement"].values[-6:].tolist() == [2, 2, 3, 3, 4, 5]
    np.testing.assert_allclose(data["friction"], 4 * data["area"] / data["load"], rtol=1e-14)
    rows = rows_of(tmp_path / "out" / "aging.csv")
    assert [float(row["friction"]) for row in rows] == data["friction"].values.tolist()
    assert (tmp_path / "out" / "sliding.png").is_file()
    config = read_config(tmp_path / "out" / "config.toml", {})
    assert config.protocol[1:] == (Slide(3.0, velocity=2.0), Slide(2.0, velocity=np.inf))
    program = to_python(config, recorded_times(config).tolist())
    assert "asp.friction.add_friction(history.dataset, asp.friction.ShearStrength(strength=4.0))" in program
    found: dict[str, Any] = {}
    exec(program, found)
    np.testing.assert_array_equal(found["friction"]["friction"], data["friction"])


def test_a_strength_that_ages_from_flags(tmp_path, says):
    legs = [word for leg in ("slide distance=3 velocity=2", "hold 10") for word in ("--leg", leg)]
    aging = ("--shear-strength", "4", "--growth", "0.02", "--after", "0.1", "--renewal", "2")
    text = says("run", *SMALL, *legs, *aging, "--out", tmp_path / "out", "--figures", "")
    assert "by the area" in text
    assert "growth of friction, leg 1" in text
    data = results.load(tmp_path / "out")
    config = read_config(tmp_path / "out" / "config.toml", {})
    found: dict[str, Any] = {}
    exec(to_python(config, recorded_times(config).tolist()), found)
    for name in ("friction", "friction_by_area", "strength_mean", "contact_age_mean", "site_age"):
        np.testing.assert_array_equal(found["history"].dataset[name], data[name])
    (row,) = [one for one in rows_of(tmp_path / "out" / "aging.csv") if float(one["time"]) == 11.5]
    assert float(row["contact_age_mean"]) == data["contact_age_mean"].values[-1] > 9


def test_repeat_last_repeats_so_many_legs_in_any_case():
    lines = ["Ramp 1s pressure=1MPa", "STEP pressure=2MPa", "hold 3s"]
    for last in ("repeat 3 last 2", "Repeat 3 last=2", "repeat 3 last = 2"):
        first, repeated = legs_from_words([*lines, last])
        assert first == {"kind": "ramp", "duration": "1s", "pressure": "1MPa"}
        inner = [{"kind": "step", "pressure": "2MPa"}, {"kind": "hold", "duration": "3s"}]
        assert repeated == {"kind": "repeat", "count": 3, "legs": inner}
    assert legs_from_words([*lines, "repeat 3 last 3"]) == legs_from_words([*lines, "repeat 3"])
    for wrong in ("0", "4", "1.5", "x"):
        with pytest.raises(ConfigError, match="last"):
            legs_from_words([*lines, f"repeat 3 last={wrong}"])


@pytest.mark.parametrize(
    "leg",
    ["ramp 0s load=100", "step load=3", "slide distance=8 velocity=5", "hold 3", "ramp 2 pressure=1MPa"],
)
def test_advice_on_the_unit_of_a_leg_is_taken(leg):
    words, legs = leg, list[Any]()
    while not legs:  # each number may lack one
        try:
            legs = cast(Any, given(None, leg=[words], units=True))["protocol"]["legs"]
        except InputError as error:
            bare, better = rf"(?<![\w.]){error.got}(?![\w.])", str(error.advice).strip('"')
            words = re.sub(bare, better, words, count=1)
    assert words != leg
    (taken,) = legs
    assert {key: quantity_of(value) for key, value in taken.items()} == {
        key: quantity_of(value) for key, value in legs_from_words([leg])[0].items()
    }


def quantity_of(value):
    """The number of a text with a unit in SI."""
    match = re.match(r"([\d.]+)[a-zA-Z]", str(value))
    return float(match[1]) if match and str(value) != "1MPa" else value


def test_zero_needs_no_unit():
    assert given(None, leg=["ramp 0 load=1N", "step pressure=0"], units=True)["protocol"]["legs"] == [
        {"kind": "ramp", "duration": 0, "load": "1N"},
        {"kind": "step", "pressure": 0},
    ]


def test_pairs_are_one_word_or_two():
    flags: Any = flags_for("solid")
    for written in (["0.7 1s", "0.2,10s"], ["0.7", "1s", "0.2", "10s"], ["0.7", "1s", "0.2 10s"]):
        assert given(flags(solid_branches=written), units=True)["solid"]["branches"] == [
            [0.7, "1s"],
            [0.2, "10s"],
        ]


_RUN = "[surface]\nshape = [16, 16]\n[aging]\ntimes = [1.5]\n[output]\nfigures = []\nmaps_at = []\n"
_FILE = 'file = "force.csv"\nunits = "Zeit=min"\ncompression = "negative"\n'


@pytest.fixture
def force(tmp_path):
    """A file of forces that press below 0, in seconds and newtons, and a configuration in its folder."""
    table = "Zeit;Kraft (mN)\n0;-20e3\n0,01;-30e3\n0,02;-40e3\n0,04;-40e3\n0,04;-30e3\n"
    (tmp_path / "force.csv").write_text(table)
    (tmp_path / "run.toml").write_text(f"{_RUN}[protocol]\n{_FILE}")
    return tmp_path


def test_a_measured_history_is_a_file_of_the_protocol_and_what_is_recorded_repeats_it(force, tmp_path):
    config = read_config(force / "run.toml", {})
    lines = [Ramp(1.2, load=40.0), Hold(1.2), Step(load=30.0)]
    for read, written in zip(config.protocol, lines, strict=True):
        assert type(read) is type(written)
        assert vars(read) == pytest.approx(vars(written), rel=1e-12)
    assert config.contact.load == 20.0
    assert main(["run", str(force / "run.toml"), "--quiet", "--out", str(tmp_path / "out")]) == 0
    (force / "force.csv").unlink()
    assert main(["run", str(tmp_path / "out/config.toml"), "--quiet", "--out", str(tmp_path / "again")]) == 0
    first, second = (results.load(tmp_path / name) for name in ("out", "again"))
    for name in ("time", "load", "area"):
        np.testing.assert_array_equal(first[name], second[name])


@pytest.mark.parametrize(
    ("change", "place"),
    [
        (('compression = "negative"', ""), r'\[protocol\] compression: .*try compression = "negative"'),
        (('units = "Zeit=min"', ""), r"protocol: column 'Zeit' of .*unit of time.*try units = "),
        (("units", "unit"), r"\[protocol\] unit: no such key; try units"),
        (("[protocol]", "[contact]\nload = 3.0\n[protocol]"), r"\[contact\] load: .*measured history.*3"),
        (("force.csv", "none.csv"), "protocol.*none.csv"),
    ],
)
def test_a_mistake_of_a_measured_history_names_its_key(force, change, place):
    (force / "run.toml").write_text(f"{_RUN}[protocol]\n{_FILE}".replace(*change))
    with pytest.raises(ConfigError, match=place):
        read_config(force / "run.toml", {})


def test_a_measured_history_by_flags_is_that_of_the_file(force, tmp_path, capsys):
    flags = ("--history-units", "Zeit=min", "--history-compression", "negative", "--quiet", "--out")
    small = ("--shape", "16x16", "--times", "1.5", "--figures", "", "--history", str(force / "force.csv"))
    assert main(["run", *small, *flags, str(tmp_path / "flags")]) == 0
    assert main(["run", str(force / "run.toml"), "--quiet", "--out", str(tmp_path / "file")]) == 0
    first, second = (results.load(tmp_path / name) for name in ("flags", "file"))
    np.testing.assert_array_equal(first["load"], second["load"])
    assert main(["run", *small, "--quiet"]) == 2
    assert main(["run", *small, "--leg", "hold 1"]) == 2
    told = capsys.readouterr().err
    assert "try --history-units Zeit=min" in told
    assert "--history: expected none beside --leg" in told


def test_a_prediction_follows_a_measured_pressure(tmp_path):
    heights = 0.05 * gaussian((16, 16), rms=1.0, seed=0)
    np.savetxt(tmp_path / "scan.txt", heights)
    (tmp_path / "h.csv").write_text("time_s,pressure_MPa\n0,0\n10,1\n20,1\n60,0.5\n")
    scan = (
        f"--surface {tmp_path}/scan.txt --file-unit um --pixel-size 1um --young 1GPa --poisson 0.4 --branch"
    )
    words = [*scan.split(), "0.5 10s", "--first", "1s", "--figures", "", "--quiet"]
    legs = ["--leg", "ramp 10s pressure=1MPa", "--leg", "hold 10s", "--leg", "ramp 40s pressure=0.5MPa"]
    for name, how in {"file": ["--history", str(tmp_path / "h.csv")], "legs": legs}.items():
        assert main(["predict", *words, *how, "--out", str(tmp_path / name)]) == 0
    first, second = (results.load(tmp_path / name / "history.zarr") for name in ("file", "legs"))
    np.testing.assert_allclose(first["contact_area"], second["contact_area"], rtol=1e-9)
    assert "3 legs, above 0 presses" in (tmp_path / "file" / "summary.txt").read_text()
