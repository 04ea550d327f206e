"""``asperity friction``: what it says of records and runs, what it writes, and its mistakes."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import asperity as asp
from asperity.base.words import tables_to_toml
from asperity.friction.loading import Drive
from asperity.friction.slider import Shape, follow
from tests.cli.conftest import rows_of

F = asp.friction
LAW = F.RateAndState(a=0.010, b=0.015, D_c=10e-6, mu_0=0.6, V_0=1e-6)
HOLDS = F.slide_hold_slide([10.0, 100.0, 1000.0], velocity=1e-6, distance=50e-6)
STEPS = F.velocity_steps([1e-5, 1e-6], distance=50e-6)


def write(name, record):
    """Write the table of an experiment."""
    columns = np.column_stack([record.time, record.displacement * 1e6, record.friction])
    np.savetxt(name, columns, delimiter=",", header="time_s,displacement_um,friction", comments="")


def test_parameters_of_a_table_in_words_files_and_a_picture(says):
    write("lab.csv", F.synthetic_record([*HOLDS, *STEPS], LAW, noise=5e-4, seed=1))
    text = says("friction", "lab.csv", "--out", "found")
    assert "the data prefer the aging law: the slip law is less than 1e-6 times as likely" in text
    assert text.index("aging law  mu =") < text.index("slip law   mu =")
    assert "not determined by this record" in text
    assert (
        "lab.csv: time from 'time_s' in s, displacement from 'displacement_um' in um, friction from" in text
    )
    names = [
        "asperity.json",
        *(f"friction{end}" for end in (".csv", ".png", ".toml", "_data.csv")),
        "summary.txt",
    ]
    assert sorted(path.name for path in Path("found").iterdir()) == names
    found = tomllib.loads(Path("found/friction.toml").read_text())
    for name in ("a", "b", "D_c", "mu_0"):
        low, high = found["intervals_95"][name]
        assert low < found["parameters"][name] < high
        assert found["parameters"][name] == pytest.approx(getattr(LAW, name), rel=0.05)
    assert found["units"] | {"D_c": "m", "V_0": "m/s"} == found["units"]
    assert found["origin"]["record"] == "lab.csv"
    assert [row["law"] for row in rows_of(Path("found/friction.csv"))] == ["aging", "slip"]
    assert Path("found/friction.png").read_bytes().startswith(b"\x89PNG")


def test_several_surfaces_and_a_law_that_was_asked_for(says):
    for seed in range(3):
        write(f"{seed}.csv", F.synthetic_record(HOLDS, LAW, per_leg=20, noise=5e-4, seed=seed))
    words = ("--a", "0.01", "--law", "slip", "--reference-velocity", "2 um/s")
    text = says("friction", "0.csv", "1.csv", "2.csv", *words)
    assert "3 surfaces: 0.csv, ..." in text
    assert "the surfaces prefer the aging law" in text
    found = tomllib.loads(Path("friction/friction.toml").read_text())
    assert found["parameters"]["law"] == "slip"
    assert found["laws"]["verdict"] == "aging"
    assert found["parameters"]["V_0"] == pytest.approx(2e-6)
    assert found["origin"]["intervals_from"] == "jackknife over surfaces"


def test_a_run_that_slid(says, refused):
    rough = asp.surfaces.gaussian((256,), rms=1.0, seed=0)
    contact = asp.press(rough, asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0), load=16.0)
    protocol = F.slide_hold_slide([10.0, 100.0], velocity=1.0, distance=8.0)
    history = asp.age(contact, times=[1.0], protocol=protocol)
    asp.results.save(history.dataset, "run/history.zarr")
    refused("friction", "run")
    text = says("friction", "run", "--shear-strength", "1.0")
    assert "2 holds" in text
    assert "a        0, of a constant shear strength" in text
    found = tomllib.loads(Path("friction/friction.toml").read_text())
    assert found["units"]["D_c"] == "length of the record"


def test_a_slip_below_that_between_two_values_is_noted(says):
    law = F.RateAndState(a=0.0, b=0.02, D_c=0.5, mu_0=0.6, V_0=1.0)
    velocity = np.repeat([1.0, 10.0, 1.0, 10.0], 60)
    for slip, noted in ((2.0, True), (0.05, False)):
        time = np.cumsum(slip / velocity)
        friction = law.friction(time, velocity) + 1e-5 * np.sin(np.arange(time.size) ** 2)
        table = np.column_stack([time, velocity, friction])
        np.savetxt("record.csv", table, delimiter=",", header="time,velocity,friction", comments="")
        text = says("friction", "record.csv", "--a", "0.0", "--overwrite")
        assert ("shorter than the slip between two values" in text) is noted


def machine(name, *, places, header=""):
    """Write a hold of 10 s and a step of a slider on a spring, in min and um and with noise."""
    shape = Shape(a=0.008, b=0.010, D_c=10e-6, k=0.01e6)
    drive = Drive(np.array([10.0, 20.0, 45.0]), 1e-6 * np.array([10, 0, 10, 30]), np.full(3, 0.1))
    time = np.arange(0.0, 55.0, 0.1)
    place = drive.place(time)
    elastic = follow("aging", shape, drive, time).elastic(shape)
    rng = np.random.default_rng(0)
    columns = {"load_point_um": place, "displacement_um": place - elastic / shape.k}
    noisy = [1e6 * columns[column] + 0.02 * rng.standard_normal(time.size) for column in places]
    friction = 0.6 + elastic + 4e-4 * rng.standard_normal(time.size)
    rows = np.column_stack([time / 60, *noisy, friction])
    np.savetxt(
        name,
        rows,
        fmt="%.7g",
        delimiter=",",
        comments="",
        header=f"{header}{','.join(('time_min', *places, 'friction [-]'))}",
    )


@pytest.mark.slow
def test_the_record_of_a_machine_from_load_point_to_a_table_of_laws_and_events(says):
    machine("lab.csv", places=["load_point_um"], header="Operator,M. Huber,2026\n")
    text = says("friction", "lab.csv", "--stiffness", "0.01 / um")
    assert "1 hold" in text
    assert "the data prefer the aging law" in text
    first, second, *others = rows_of(Path("friction/friction.csv"))
    assert [row["stiffness_from"] for row in (first, second)] == ["given", "fitted"]
    assert len(others) == 2
    for name, value in (("a", 0.008), ("b", 0.010), ("D_c", 1e-5), ("stiffness", 1e4)):
        end = {"D_c": "_m", "stiffness": "_per_m"}.get(name, "")
        low, high = (float(second[f"{name}_{side}{end}"]) for side in ("low", "high"))
        assert abs(value - (low + high) / 2) < high - low
        assert high - low < 0.1 * value
    events = rows_of(Path("friction/events.csv"))
    assert [(row["number"], row["kind"]) for row in events] == [("1", "hold"), ("2", "step")]
    assert [float(row["end"]) - float(row["time"]) for row in events] == pytest.approx([10, 0], abs=0.1)
    assert [float(row["a"]) for row in events] == pytest.approx([0.008] * 2, rel=0.1)
    assert [float(row["displacement_m"]) for row in events] == pytest.approx([1e-4, 3.5e-4], abs=2e-6)
    for row in events:
        for name in ("a", "b", "a_minus_b", "D_c"):
            end = "_m" * (name == "D_c")
            assert (
                float(row[f"{name}_low{end}"]) < float(row[f"{name}{end}"]) < float(row[f"{name}_high{end}"])
            )
    drawn = Path("friction/events_data.csv").read_text()
    assert "displacement of the load point [um]" in drawn


@pytest.mark.slow
def test_a_window_in_the_units_of_the_record_and_what_it_lacks(says, refused):
    machine("lab.csv", places=["displacement_um"])
    says("friction", "lab.csv", "--from", "0.1", "--to", "54 s", "--law", "slip")
    (step, *_) = rows_of(Path("friction/friction.csv"))
    assert step["law"] == "slip"
    refused("friction", "lab.csv", "--to", "0.15", "--out", "none")
    refused("friction", "lab.csv", "--from", "1 h", "--out", "none")
    refused("friction", "lab.csv", "--stiffness", "0.01", "--out", "none")


def test_an_infinite_stiffness_fits_slip_that_is_the_load_point(says):
    machine("lab.csv", places=["load_point_um"])
    assert "given      inf" in says("friction", "lab.csv", "--stiffness", "inf")
    given, free, *_ = rows_of(Path("friction/friction.csv"))
    assert [row["stiffness_from"] for row in (given, free)] == ["given", "fitted"]
    assert float(free["stiffness_per_m"]) == pytest.approx(0.01e6, rel=0.1)


def test_what_a_record_leaves_open_is_not_called_the_same_for_all_laws(says):
    machine("lab.csv", places=["load_point_um"])
    for stop, is_open in (("45.3 s", True), ("46 s", False)):
        text = says("friction", "lab.csv", "--from", "30 s", "--to", stop, "--overwrite")
        same = [line for line in text.splitlines() if "for each law" in line]
        assert [all(name in line for name in ("a (", "b (")) for line in same] == [True] * (not is_open)


SLIDE = {"kind": "slide", "distance": 8, "velocity": 1.0}
CAMPAIGN = {
    "surface": {"shape": [64]},
    "contact": {"load": 8.0},
    "aging": {"per_decade": 2},
    "protocol": [SLIDE, {"kind": "hold", "duration": 30.0}, SLIDE],
    "sweep": {"seeds": 3, "solid": {"k1": [3.0]}},
}


@pytest.mark.slow
def test_the_surfaces_of_a_campaign(asperity, says, refused, monkeypatch):
    Path("one.toml").write_text(tables_to_toml(CAMPAIGN))
    assert asperity("sweep", "one.toml", "--out", "one", "--workers", "1", "--quiet")[0] == 0
    text = says("friction", "one", "--shear-strength", "0.5")
    assert "3 surfaces: one, ..." in text
    found = tomllib.loads(Path("friction/friction.toml").read_text())
    runs = asp.campaign.open("one")
    friction = (0.5 * runs["area"] / runs["load"]).mean("seed").values[0]
    record = F.Record.of_displacement(
        runs["time"], runs["displacement"][0, 0], friction, a=0.0, strength_at_rest=True
    )
    fit = F.rate_and_state(record, law=found["parameters"]["law"])
    assert fit.b == pytest.approx(found["parameters"]["b"], rel=1e-6)
    several = xr.concat([runs, runs.assign_coords(k1=[1.0])], "k1")
    monkeypatch.setattr(asp.campaign, "open", lambda _: several)
    refused("friction", "one", "--shear-strength", "0.5", "--out", "none")
