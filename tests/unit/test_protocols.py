"""Protocols: what they take, what they refuse, what a history says of them, and the table of its legs."""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
import pytest
from annotated_types import Gt

import asperity as asp
from asperity.analysis.legs import leg_table, protocol_of
from asperity.base.parameters import Quantity
from asperity.protocols import Hold, Leg, Ramp, Repeat, Slide, Step, measured
from asperity.protocols.legs import described, in_words, leg_of, legs_of
from tests.refusals import each_refuses
from tests.surfaces import uncorrelated

SOLID = asp.solids.spring_lattice(k0=1.0, k1=3.0)
CONTACT = asp.press(uncorrelated(16), SOLID, load=10.0)
HALF_SPACE = asp.press(uncorrelated(16), asp.solids.half_space(modulus=2.0), load=10.0)
LIFTED = asp.press(uncorrelated(16), SOLID, separation=50.0)
LINE = asp.press(uncorrelated(16)[0], SOLID, load=3.0)
MIRRORED = asp.press(asp.surfaces.Surface(uncorrelated(16), edges="reflecting"), SOLID, load=10.0)
NAN = float("nan")


TARGET = "load, pressure, separation and approach"


def follow(*legs: Any, of: asp.Contact = CONTACT) -> asp.History:
    return asp.age(of, [1.0], protocol=legs)


def slid(distance: float | str = 3.0, of: asp.Contact = CONTACT, **how: Any) -> asp.History:
    return follow(Slide(distance, velocity=0.1, **how), of=of)  # type: ignore[arg-type]


def test_what_cannot_be():
    each_refuses(
        ("duration", "-1.0", Hold, -1.0),
        ("mobility", "0.0", lambda: Hold(1.0, mobility=0.0)),
        ("hold", "'height'", lambda: Hold(1.0, hold="height")),  # type: ignore[arg-type]
        (TARGET, "none", Ramp, 1.0),
        (TARGET, "load and separation", lambda: Ramp(1.0, load=1.0, separation=1.0)),
        ("separation", "nan", lambda: Ramp(1.0, separation=NAN)),
        (TARGET, "none", Step),
        ("protocol", "[]", Repeat, [], 2),
        ("protocol", "'hold'", Repeat, [Hold(1.0), "hold"], 2),
        ("protocol", "1,000 times 1,000", lambda: Repeat([Repeat([Repeat([Hold(1.0)], 1000)], 1000)], 1000)),
        ("protocol", "101,000", follow, *[Repeat([Hold(1.0)], 1000)] * 101),
        ("distance", "0.0", lambda: Slide(0.0, velocity=1.0)),
        ("direction", "'z'", lambda: Slide(3.0, velocity=1.0, direction="z")),
        ("direction", "(0, 0)", lambda: Slide(3.0, velocity=1.0, direction=(0, 0))),
        ("direction", "0.5", lambda: Slide(3.0, velocity=1.0, direction=(0.5, 1))),  # type: ignore[arg-type]
        ("times", "3", lambda: asp.age(CONTACT, [1.0, 3.0], protocol=[Hold(2.0)])),
        ("protocol", "[]", lambda: asp.age(CONTACT, [1.0], protocol=[])),
        ("protocol", "'h'", lambda: asp.age(CONTACT, [1.0], protocol="hold")),  # type: ignore[arg-type]
        ("hold", "'load'", lambda: asp.age(CONTACT, [1.0], protocol=[Hold(1.0)], hold="load")),
        ("separation", lambda: follow(Hold(1.0), Step(separation=0.0), of=HALF_SPACE)),
        ("separation", lambda: follow(Hold(1.0, hold="separation"), of=HALF_SPACE)),
        ("separation", lambda: asp.age(HALF_SPACE, [1.0], hold="separation")),
        ("separation", lambda: asp.press(uncorrelated(16), HALF_SPACE.solid, separation=1.0)),
        ("hold", "a contact without load", lambda: follow(Hold(1.0, hold="area"), of=LIFTED)),
        ("hold", "a contact without load", lambda: follow(Ramp(1.0, load=3.0), of=LIFTED)),
        ("distance", "0.3", slid, 0.3),
        ("direction", "(1,)", lambda: slid(direction=(1,))),
        ("units", "'3 um'", slid, "3 um"),
        ("direction", "'y'", lambda: slid(of=LINE, direction="y")),
        ("slide", slid, 3.0, MIRRORED),
        ("hold", "3", lambda: asp.age(CONTACT, [1.0], hold="area")),  # few sites: no area to keep
        ("shift", "[1.0, 2.0, 3.0]", asp.slide, CONTACT, [1.0, 2.0, 3.0]),
        ("shift and distance", "none", asp.slide, CONTACT),
        ("units", "'3 um'", lambda: asp.slide(CONTACT, distance="3 um")),
        ("slide", asp.slide, MIRRORED, 1),
        ("contact", "ndarray", asp.slide, CONTACT.heights, 1),
        ("heights", lambda: asp.press(CONTACT, asp.solids.spring_lattice(k0=1.0, k1=4.0), load=3.0)),
    )


def test_a_distance_is_in_the_unit_of_the_spacing():
    heights = asp.surfaces.Surface(uncorrelated(16), unit="um", pixel_size=(2.0, 0.5), length_unit="um")
    contact = asp.press(heights, asp.solids.half_space(modulus=1e9, branches=[(0.5, 1.0)]), pressure=1e7)
    moved = asp.slide(contact, distance="1.5 um")
    np.testing.assert_array_equal(moved.heights, np.roll(contact.heights, 3, axis=1))
    across = asp.slide(contact, distance=6e-6, direction="-y")
    np.testing.assert_array_equal(across.heights, np.roll(contact.heights, -3, axis=0))
    history = asp.age(contact, ["1 s"], protocol=Slide("1.5 um", velocity="1 um/s"))  # type: ignore[arg-type]
    assert history.time.values == pytest.approx([0, 0, 0.5, 0.5, 1.0, 1.0, 1.5])
    assert history["displacement"].values == pytest.approx([0, 5e-7, 5e-7, 1e-6, 1e-6, 1.5e-6, 1.5e-6])
    assert (history["displacement"].attrs["units"], history["velocity"].attrs["units"]) == ("m", "m/s")


def test_every_tenth_shift_is_recorded():
    contact = asp.press(uncorrelated(16), SOLID, load=60.0)
    history = asp.age(
        contact, [0.0], protocol=[Slide(40, velocity=10.0, every=10), Slide(25, math.inf, every=10)]
    )
    assert history["displacement"].values.tolist() == [0, 1, 10, 11, 20, 21, 30, 31, 40, 41, 51, 61, 65]
    assert "displacement" not in asp.age(contact, [1.0], protocol=Hold(1.0)).dataset


def test_slides_are_written_and_read():
    legs = [Slide(3.0, velocity=math.inf), Slide(2.0, 0.5, direction=(1, 1), substeps=3), Slide(1, 1, "-y")]
    assert [leg_of(described(leg)) for leg in legs] == legs
    assert in_words(map(described, legs)) == (
        "slide distance=3 velocity=inf, slide distance=2 velocity=0.5 direction=[1, 1] substeps=3, "
        "slide distance=1 velocity=1 direction=-y"
    )


def test_nobody_else_makes_a_contact():
    with pytest.raises(TypeError, match="only press, age and relax make one"):
        asp.Contact(u=np.zeros((2, 2)))


def test_repetitions_are_written_out():
    cycle = Repeat([Ramp(1.0, load=2.0), Repeat([Hold(1.0)], 2)], 3)
    assert list(legs_of([cycle, Hold(4.0)])) == [Ramp(1.0, load=2.0), Hold(1.0), Hold(1.0)] * 3 + [Hold(4.0)]
    assert list(legs_of(Hold(1.0))) == [Hold(1.0)]


def test_a_pressure_is_a_load_over_the_nominal_area():
    heights = asp.surfaces.spectral((16, 32), hurst=0.8, spacing=2e-6, rms_slope=0.1, seed=1)
    scan = asp.surfaces.Surface(heights, "m", (2e-6, 2e-6), "m")
    solid = asp.solids.half_space(modulus=3e9, branches=[(0.3, 0.1)])
    contact = asp.press(scan, solid, pressure=1e6)
    area = 16 * 32 * 4e-12
    for legs in (
        lambda one: [Hold(1.0), Step(**{one[0]: 2 * one[1]}), Hold(1.0)],
        lambda one: [Ramp(1.0, **{one[0]: 2 * one[1]}), Hold(1.0)],
    ):
        by_pressure, by_load = (
            asp.age(contact, [2.0], protocol=legs(one)).dataset
            for one in (("pressure", 1e6), ("load", 1e6 * area))
        )
        np.testing.assert_allclose(by_pressure["load"][-1], 2e6 * area, rtol=1e-8)
        np.testing.assert_array_equal(by_pressure["area"], by_load["area"])
        assert "pressure=2e+06" in by_pressure.attrs["protocol_in_words"]


def test_a_held_area_is_recorded_as_such():
    contact = asp.press(uncorrelated(16), SOLID, load=100.0)
    data = asp.age(contact, [0.1], hold="area").dataset
    assert (data.attrs["held"], data.attrs["held_area"]) == ("area", contact.area)
    assert "leg" not in data.coords  # without a protocol nothing is new


PROTOCOL = [
    Step(load=20.0),
    Repeat([Ramp(0.5, load=5.0, mobility=2.0), Step(load=20.0), Hold(1.0)], 2),
    Hold(1.0, hold="separation"),
    Ramp(1.0, separation=1.5),
    Step(separation=1.2),
]


def test_a_history_describes_itself_and_each_leg_has_the_states_at_its_ends(tmp_path):
    times = [0.25, 0.5, 1.0, 2.25, 3.0, 4.0, 4.5]
    history = asp.age(CONTACT, times, protocol=PROTOCOL, fields_at=[0.5])
    data = history.dataset
    assert data["time"].values.tolist() == [0, 0, 0.25, 0.5, 0.5, 1, 1.5, 2, 2, 2.25, 3, 4, 4.5, 5, 5]
    assert data["leg"].values.tolist() == [0, 0, 1, 1, 2, 3, 3, 4, 5, 6, 6, 7, 8, 8, 9]
    assert (data["field_time"].values.tolist(), data["field_leg"].values.tolist()) == ([0.5, 0.5], [1, 2])
    table = leg_table(data)
    assert [row.leg for row in table] == list(legs_of(PROTOCOL))
    assert [row.number for row in table] == list(range(10))
    assert " ".join(row.kind for row in table) == "step ramp step hold ramp step hold hold ramp step"
    assert [row.begin for row in table] == [0, 0, 0.5, 0.5, 1.5, 2, 2, 3, 4, 5]
    assert [row.end for row in table] == [0, 0.5, 0.5, 1.5, 2, 2, 3, 4, 5, 5]
    entries = [(0, 1), (1, 3), (3, 4), (4, 6), (6, 7), (7, 8), (8, 10), (10, 11), (11, 13), (13, 14)]
    for name in ("load", "separation", "area"):
        expected = data[name].values[np.array(entries)]
        np.testing.assert_array_equal([getattr(row, name) for row in table], expected)
    assert [row.load for row in table[:2]] == [pytest.approx((10.0, 20.0)), pytest.approx((20.0, 5.0))]
    history.save(tmp_path / "history.zarr")
    read = asp.results.load(tmp_path / "history.zarr")
    assert read.identical(data)
    assert protocol_of(read) == PROTOCOL
    assert json.loads(read.attrs["protocol"])[0] == described(PROTOCOL[0]) == {"kind": "step", "load": 20.0}


def test_the_lowest_area_is_that_of_the_entries_of_a_leg():
    data = asp.age(CONTACT, [1.0, 2.0, 3.0, 5.0], protocol=[Hold(2.0), Step(load=5.0), Hold(4.0)]).dataset
    assert data["time"].values.tolist() == [0, 1, 2, 2, 3, 5, 6]
    data["area"].values[:] = [7, 9, 11, 6, 4, 4, 8]
    rows = leg_table(data)
    assert [(row.lowest_area, row.lowest_after) for row in rows] == [(7, 0), (6, 0), (4, 1)]


@pytest.mark.parametrize(("times", "fields"), [([0.3], []), ([0.4], [0.3])])
def test_a_switch_is_the_time_that_is_meant(times, fields):
    protocol = [*3 * [Hold(0.1)], Step(load=5.0), Hold(0.1)]
    assert sum(leg.duration for leg in protocol[:3]) != 0.3
    data = asp.age(CONTACT, times, protocol=protocol, fields_at=fields).dataset
    assert data["time"].values.tolist() == [0.0, 0.1, 0.2, 0.3, 0.3, 0.4]
    row = leg_table(data)[3]
    assert (row.begin, row.end) == (0.3, 0.3)
    assert row.load == pytest.approx((10.0, 5.0))


def test_without_a_protocol_a_history_is_one_hold():
    data = asp.age(CONTACT, [1.0, 2.0]).dataset
    (row,) = leg_table(data)
    assert (row.kind, row.begin, row.end) == ("hold", 0.0, 2.0)
    assert row.area == (data["area"].values[0], data["area"].values[-1])
    assert leg_table(asp.age(CONTACT, [0.0]).dataset) == []


def test_a_ramp_that_takes_no_time_is_a_step():
    contact = asp.press(uncorrelated(16), asp.solids.spring_lattice(k0=1.0, k1=3.0), load=10.0)
    for target in ({"load": 20.0}, {"separation": 0.9 * contact.separation}):
        ramped, stepped = (
            asp.age(contact, [1.0], protocol=[leg, Hold(1.0)])
            for leg in (Ramp(0.0, **target), Step(**target))
        )
        np.testing.assert_array_equal(ramped.final.u, stepped.final.u)
        np.testing.assert_array_equal(ramped["load"].values, stepped["load"].values)
    each_refuses(("duration", "-1.0", Ramp, -1.0, 20.0), ("duration", "0", Hold, 0))


_WRITTEN = [Hold(3.0), Step(load=16.0), Ramp(4.0, load=6.0), Step(load=8.0), Ramp(2.0, load=12.0), Hold(5.0)]
_SAMPLES = {
    "time": [0, 1, 1.5, 3, 3, 4, 5.5, 7, 7, 7, 8, 8.25, 9, 9, 11, 14],
    "load": [10, 10, 10, 10, 16, 13.5, 9.75, 6, 6, 8, 10, 10.5, 12, 12, 12, 12],
}


@pytest.mark.parametrize(
    ("head", "scales"),
    [
        ("time (s),Load (N)", (1, 1)),
        ("Zeit / min;Kraft / mN", (1 / 60, 1000)),
        ("temps_s\tcharge_kN", (1, 1e-3)),
        ("temp_C,time_s,F (N),shear force (N)", (1, 1)),
    ],
)
def test_a_measured_history_is_that_of_its_legs(tmp_path, head, scales):
    table = np.transpose([_SAMPLES["time"], _SAMPLES["load"]]) * scales
    table = np.column_stack([table[:, 0] + 20, table, table[:, 1]]) if "temp_C" in head else table
    separator = next(one for one in ";\t," if one in head)
    np.savetxt(tmp_path / "h.csv", table, "%.15g", separator, header=head, comments="")
    history = measured(tmp_path / "h.csv")
    assert [type(leg) for leg in history] == [type(leg) for leg in _WRITTEN]
    assert history.start == {"load": pytest.approx(10.0, rel=1e-12)}
    times = [1.0, 2.0, 6.5, 8.0, 14.0]
    read, written = (asp.age(CONTACT, times, protocol=legs).dataset for legs in (history, _WRITTEN))
    for name in ("time", "load", "area", "separation"):
        np.testing.assert_allclose(read[name], written[name], rtol=1e-9, atol=1e-9)
    assert "16 rows" in history.read
    assert history.read.endswith("6 legs, above 0 presses")


@pytest.mark.parametrize("quantity", ["load", "pressure", "separation", "displacement"])
def test_an_uneven_history_is_that_of_the_machine(quantity):
    rng = np.random.default_rng(1)
    corners, values = np.cumsum(rng.uniform(0.01, 100, 41)), rng.uniform(5, 9, 41)
    times = np.union1d(corners, rng.uniform(corners[0], corners[-1], 3000))
    history = measured({"time": times, quantity: np.interp(times, corners, values)})
    ends = [getattr(leg, leg.target) for leg in history]
    values -= values[0] * (quantity == "displacement")
    np.testing.assert_allclose(ends, values[1:], rtol=1e-12)
    np.testing.assert_allclose(np.cumsum([leg.duration for leg in history]), corners[1:] - corners[0])


@pytest.mark.parametrize(
    ("quantity", "values", "held", "legs"),
    [
        (
            "displacement",
            [0, 0, 0.1, 0.1],
            None,
            [Hold(1.0, hold="separation"), Ramp(1.0, approach=0.1), Hold(1.0)],
        ),
        ("load", [10, 10, 12, 12], "separation", [Hold(1.0, hold="load"), Ramp(1.0, load=12.0), Hold(1.0)]),
    ],
)
def test_constant_rows_at_first_hold_what_the_table_has(quantity, values, held, legs):
    start = CONTACT if held is None else asp.age(CONTACT, [0.5], hold=held).final
    values = [*np.multiply(values, 1.0 if held is None else start.load / 10)]
    legs = [legs[0], legs[1] if held is None else Ramp(1.0, load=1.2 * start.load), Hold(1.0)]
    history = measured({"time": [0, 1, 2, 3], quantity: values})
    found, right = (asp.age(start, [0.5, 1.0, 2.5], protocol=each).dataset for each in (history, legs))
    for name in ("load", "separation", "area"):
        np.testing.assert_allclose(found[name], right[name], rtol=1e-9)


def test_rows_within_the_noise_are_one_ramp():
    noise = np.random.default_rng(2).uniform(-0.1, 0.1, 500)
    times = np.arange(500.0)
    rising = {"time": times, "load": 10 + 0.1 * times + noise}
    assert len(measured(rising)) > 400
    at = np.cumsum([0.0] + [leg.duration for leg in measured(rising, within=0.2)])
    ends = np.interp(times, at, rising["load"][at.astype(int)])
    assert len(at) < 20
    assert abs(ends - rising["load"]).max() <= 0.2 * (1 + 1e-12)


@dataclass(frozen=True)
class Course(Leg):
    """A load by its values at some times."""

    times: Annotated[Sequence[float], Quantity("times", "s")]
    loads: Annotated[Sequence[float], Gt(0), Quantity("loads", "N")]
    target = "load"

    @property
    def duration(self):  # type: ignore[override]
        return self.times[-1]

    def value(self, time, start):
        return float(np.interp(time, self.times, self.loads))


def test_a_leg_of_ones_own_holds_arrays():
    arrays: Any = (np.array([0.0, 1.0, 2.0]), np.array([10.0, 20.0, 15.0]))
    course = Course(*arrays)
    history = asp.age(CONTACT, [0.5, 1.0], protocol=course)
    np.testing.assert_allclose(history.dataset["load"], [10, 15, 20, 15], rtol=1e-9)
    assert protocol_of(history.dataset) == [course]
    each_refuses(("loads", "1e-200", Course, [0.0, 1.0], [1.0, 1e-200]))


def test_what_presses_is_said():
    pulled = {"time": [0, 1, 2], "load": [-1, -3, -2]}
    history: Any = measured(pulled, compression="negative")
    assert [leg.load for leg in history] == [3.0, 2.0]
    assert "below 0 presses" in history.read
    approach = {"time": [0, 1, 2], "stroke": [7, 5, 6]}
    moved: Any = measured(approach, compression="negative")
    assert [leg.approach for leg in moved] == [2.0, 1.0]
    assert measured(pulled, compression="positive").start == {"load": -1.0}


def test_what_is_no_history(tmp_path):
    def of(text, **choices):
        (tmp_path / "h.csv").write_text(text)
        return measured(tmp_path / "h.csv", **choices)

    two = "time_s,load_N,gap_um\n0,1,2\n1,2,1\n"
    name = str(tmp_path / "h.csv")
    assert len(of(two, columns=["time_s", "gap_um"])) == 1
    each_refuses(
        ("compression", "none", lambda: of("time_s,load_N\n0,-1\n1,-2\n")),
        ("compression", "'negative'", lambda: of("time_s,gap_um\n0,1\n1,2\n", compression="negative")),
        (name, "load and separation", lambda: of(two)),
        (name, "'0,2'", lambda: of("time_s,load_N\n1,1\n0,2\n")),
        (name, "'1,nan'", lambda: of("time_s,load_N\n0,1\n1,nan\n")),
        (name, "1", lambda: of("time_s,load_N\n0,1\n")),
        (f"column 'load' of {name}", "none", lambda: of("time_s,load\n0,1\n1,2\n")),
        ("protocol", "10", lambda: asp.age(CONTACT, [1.0], protocol=measured({"t": [0, 1], "F": [3, 4]}))),
        ("load", "0", lambda: asp.age(CONTACT, [1.0], protocol=measured({"t": [0, 1], "F": [10, 0]}))),
        ("F", "1", lambda: measured({"t": [0, 1, 2], "F": [3, NAN, 4]})),
        ("t, F", "(3,)", lambda: measured({"t": [0, 1, 2], "F": [3, 4]})),
    )
