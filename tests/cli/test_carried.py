"""What a contact carries, as columns: in Python, files, flags, campaigns and predictions."""

import shlex
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.app.cli import main
from asperity.app.config import config_from
from asperity.base.units import quantity
from asperity.errors import ConfigError, Remark
from asperity.figures import carried_figure
from tests.cli.conftest import rows_of
from tests.refusals import refuses

P = asp.protocols
RUN = """--surface sphere --shape 32 32 --radius 1mm --pixel-size 1um --solid half_space --young 3GPa
    --poisson 0.3 --branch '0.5 1s' --load 1mN --times 0.1 1 10 --stiffness --resistivity '17 nOhm m'
    --conductivity '0.2 W/m/K' --shear 0.2mN --friction-coefficient 0.4
    --work-of-adhesion '2 J/m^2'"""
PREDICT = """--surface scan.npy --file-unit m --pixel-size 1e-6 --length-unit m --young 3GPa --branch '0.5 1s'
    --first 0.1s --last 100s --pressure 1kPa --stiffness --resistivity '17 nOhm m' --conductivity '0.2 W/m/K'
    --shear 0.1nN --friction-coefficient 0.4 --work-of-adhesion '2 J/m^2'"""
NAMES = ["normal_stiffness", "tangential_stiffness", "resistance", "thermal_resistance"]
NAMES += ["stick_fraction", "pull_off"]


@pytest.fixture(scope="module")
def contact():
    ball = asp.surfaces.sphere((32, 32), radius="1 mm", pixel_size="1 um")
    solid = asp.solids.half_space(modulus=asp.solids.contact_modulus(3e9, 0.3), branches=[(0.5, 1.0)])
    return asp.press(ball, solid, load="1 mN")


@pytest.fixture(scope="module")
def history(contact):
    how: dict[str, Any] = {"resistivity": "17 nOhm m", "shear": "0.2 mN", "friction_coefficient": 0.4}
    carried = asp.Carried(conductivity=0.2, poisson=0.3, work_of_adhesion=2.0, **how)
    return asp.age(contact, [0.1, 1.0, 10.0], carried=carried)


def test_a_history_records_what_its_contacts_carry(contact, history):
    for place, one in ((0, contact), (-1, history.final)):
        carries = (
            *(one.normal_stiffness, one.tangential_stiffness(0.3), one.resistance(17e-9)),
            *(
                one.thermal_resistance(0.2),
                one.partial_slip(2e-4, 0.4).stick_fraction,
                one.pull_off(2.0).force,
            ),
        )
        found = [float(history.dataset[name][place]) for name in NAMES]
        np.testing.assert_allclose(found, carries, rtol=1e-6)
    assert history.dataset["resistance"].attrs["units"] == "ohm"
    assert history.dataset["normal_stiffness"].attrs["units"] == "N/m"
    assert "normal_stiffness" not in asp.age(contact, [1.0]).dataset


def test_a_load_that_falls_ends_the_sticking(contact):
    legs = [P.Hold(1.0), P.Step(load=4e-4), P.Hold(1.0)]
    told = asp.Carried(shear="0.2 mN", friction_coefficient=0.4)
    with pytest.warns(Remark, match="slide at 2 of 4"):
        sticks = asp.age(contact, [1.0, 2.0], protocol=legs, carried=told).dataset["stick_fraction"].values
    assert (sticks[:2] > 0).all()
    assert (sticks[2:] == 0).all()


def test_a_checkpoint_is_of_what_is_recorded(contact):
    place = asp.results.Checkpoint("place", every=0.0)
    asp.age(contact, [1.0], checkpoint=place, carried=asp.Carried(resistivity=1e-8))
    with refuses("checkpoint", kind=asp.errors.CheckpointError):
        asp.age(contact, [1.0], checkpoint=place)


def test_the_figure_draws_what_was_recorded(history):
    panels = carried_figure(history.dataset).axes
    assert len(panels) == 5
    drawn = [line for axes in panels for line in axes.get_lines() if line.get_marker() in ("o", "s")]
    assert len(drawn) == len(NAMES)
    for line, name in zip(drawn, NAMES, strict=True):
        values, found = history.dataset[name].values, np.asarray(line.get_ydata(), dtype=float)
        assert line.axes is not None
        label, unit = line.axes.get_ylabel(), history.dataset[name].attrs["units"]
        if unit == "1":
            np.testing.assert_allclose(found, values)
        else:  # in the unit of the axis
            np.testing.assert_allclose(
                [quantity(f"{one} {label.split('[')[1][:-1].replace('Ω', 'ohm')}", unit) for one in found],
                values,
            )
    with refuses("dataset", "none"):
        carried_figure(history.dataset.drop_vars(NAMES))


def test_a_run_has_the_columns_and_says_them(history, tmp_path):
    out = tmp_path / "out"
    assert main(["run", *shlex.split(RUN), "--quiet", "--out", str(out)]) == 0
    data = asp.results.load(out)
    for name in NAMES:
        np.testing.assert_allclose(data[name], history.dataset[name], rtol=1e-6)
    rows = rows_of(out / "aging.csv")
    assert [float(row["resistance_ohm"]) for row in rows] == data["resistance"].values.tolist()
    said = (out / "summary.txt").read_text("utf-8")
    assert all(name in said for name in ("thermal resistance", "stick fraction", "pull-off force"))
    assert (out / "carried.png").stat().st_size > 10_000
    again = tmp_path / "again"
    assert main(["run", str(out / "config.toml"), "--figures", "", "--quiet", "--out", str(again)]) == 0
    np.testing.assert_array_equal(asp.results.load(again)["resistance"], data["resistance"])


def test_a_prediction_shows_them(tmp_path):
    np.save("scan.npy", 1e-9 * asp.surfaces.spectral((32, 32), hurst=0.8, seed=1))
    out = tmp_path / "out"
    assert main(["predict", *shlex.split(PREDICT), "--quiet", "--out", str(out)]) == 0
    data = asp.results.load(out)
    assert (data["normal_stiffness"] > 0).all()
    assert "Stiffness and resistance of the constrictions" in (out / "prediction.html").read_text("utf-8")
    row = rows_of(out / "history.csv")[0]
    assert float(row["pull_off [N]"]) > 0
    assert float(row["resistance [ohm]"]) > 0


def test_what_cannot_be_asked(contact):
    with refuses("shear", "none"):
        asp.Carried(shear=1.0)
    rough, springs = np.random.default_rng(0).normal(size=(8, 8)), asp.solids.spring_lattice(k0=1, k1=1)
    asked: tuple[Any, ...] = (
        ("carried", "dict", contact, {"resistivity": 1.0}),
        ("resistivity", "-1.0", contact, asp.Carried(resistivity=-1.0)),
        ("carried", "a spring lattice", asp.press(rough, springs, load=1), asp.Carried()),
    )
    for name, got, one, carried in asked:
        with refuses(name, got):
            asp.age(one, [1.0], carried=carried)
    for key, value in (
        ("shear", 1.0),
        ("friction_coefficient", 0.4),
        ("resistivity", [1.0, 2.0, 3.0]),
        ("work_of_adhesion", 0.0),
    ):
        with pytest.raises(ConfigError):
            config_from({"carried": {key: value}}, {}, None)
