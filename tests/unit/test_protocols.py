"""Protocols: what they take, what they refuse, and what a history says of them."""

import json
import math

import numpy as np
import pytest

import asperity as asp
from asperity.protocols import Hold, Ramp, Repeat, Schedule, Slide, Step, described, in_words, leg_of, legs_of
from tests.refusals import refuses
from tests.surfaces import uncorrelated

SOLID = asp.solids.spring_lattice(k0=1.0, k1=3.0)
CONTACT = asp.press(uncorrelated(16), SOLID, load=10.0)
HALF_SPACE = asp.press(uncorrelated(16), asp.solids.half_space(modulus=2.0), load=10.0)
LIFTED = asp.press(uncorrelated(16), SOLID, separation=50.0)
LINE = asp.press(uncorrelated(16)[0], SOLID, load=3.0)
MIRRORED = asp.press(asp.surfaces.Surface(uncorrelated(16), edges="reflecting"), SOLID, load=10.0)
NAN = float("nan")


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda: Hold(-1.0), "duration"),
        (lambda: Hold(NAN), "duration"),
        (lambda: Hold("long"), "duration"),  # type: ignore[arg-type]
        (lambda: Hold(1.0, mobility=0.0), "mobility"),
        (lambda: Hold(1.0, hold="height"), "hold"),  # type: ignore[arg-type]
        (lambda: Ramp(1.0), "load, pressure, separation and approach"),
        (lambda: Ramp(1.0, load=1.0, separation=1.0), "load, pressure, separation and approach"),
        (lambda: Ramp(1.0, load=0.0), "load"),
        (lambda: Ramp(1.0, separation=NAN), "separation"),
        (lambda: Step(), "load, pressure, separation and approach"),
        (lambda: Repeat([Hold(1.0)], 0), "count"),
        (lambda: Repeat([], 2), "protocol"),
        (lambda: Repeat([Hold(1.0), "hold"], 2), "protocol"),  # type: ignore[list-item]
        (lambda: Repeat([Repeat([Repeat([Hold(1.0)], 1000)], 1000)], 1000), "protocol"),
        (lambda: asp.age(CONTACT, [1.0], protocol=[Repeat([Hold(1.0)], 1000)] * 101), "protocol"),
        (lambda: Slide(0.0, velocity=1.0), "distance"),
        (lambda: Slide(3.0, velocity=-1.0), "velocity"),
        (lambda: Slide(3.0, velocity=1.0, direction="z"), "direction"),
        (lambda: Slide(3.0, velocity=1.0, direction=(0, 0)), "direction"),
        (lambda: Slide(3.0, velocity=1.0, direction=(0.5, 1)), "direction"),  # type: ignore[arg-type]
        (lambda: Slide(3.0, velocity=1.0, substeps=0), "substeps"),
        (lambda: asp.age(CONTACT, [1.0, 3.0], protocol=[Hold(2.0)]), "times"),
        (lambda: asp.age(CONTACT, [1.0], protocol=[]), "protocol"),
        (lambda: asp.age(CONTACT, [1.0], protocol="hold"), "protocol"),  # type: ignore[arg-type]
        (lambda: asp.age(CONTACT, [1.0], protocol=3), "protocol"),  # type: ignore[arg-type]
        (lambda: asp.age(CONTACT, [1.0], protocol=[Hold(1.0)], hold="load"), "hold"),
        (lambda: asp.age(HALF_SPACE, [1.0], protocol=[Hold(1.0), Step(separation=0.0)]), "separation"),
        (lambda: asp.age(HALF_SPACE, [1.0], protocol=[Hold(1.0, hold="separation")]), "separation"),
        (lambda: asp.age(LIFTED, [1.0], protocol=[Hold(1.0, hold="area")]), "hold"),
        (lambda: asp.age(LIFTED, [1.0], protocol=[Ramp(1.0, load=3.0)]), "hold"),
        (lambda: asp.age(CONTACT, [1.0], protocol=[Slide(0.3, velocity=0.1)]), "distance"),
        (lambda: asp.age(CONTACT, [1.0], protocol=[Slide(3.0, velocity=0.1, direction=(1,))]), "direction"),
        (lambda: asp.age(CONTACT, [1.0], protocol=[Slide("3 um", velocity=0.1)]), "units"),  # type: ignore[arg-type]
        (lambda: asp.age(LINE, [1.0], protocol=[Slide(3.0, velocity=0.1, direction="y")]), "direction"),
        (lambda: asp.age(MIRRORED, [1.0], protocol=[Slide(3.0, velocity=0.1)]), "slide"),
        (lambda: asp.age(CONTACT, [1.0], hold="area"), "hold"),  # few sites: no area to keep
        (lambda: asp.slide(CONTACT, [1.0, 2.0, 3.0]), "shift"),
        (lambda: asp.slide(CONTACT), "shift and distance"),
        (lambda: asp.slide(CONTACT, distance="3 um"), "units"),
        (lambda: asp.slide(MIRRORED, 1), "slide"),
        (lambda: asp.slide(CONTACT.heights, 1), "contact"),  # type: ignore[arg-type]
        (lambda: asp.press(CONTACT, asp.solids.spring_lattice(k0=1.0, k1=4.0), load=3.0), "heights"),
    ],
)
def test_what_cannot_be(make, name):
    with refuses(name) as caught:
        make()
    assert "\n" not in str(caught.value)


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


def test_the_solid_of_a_contact_may_be_named():
    assert asp.press(CONTACT, SOLID, load=10.0).area == CONTACT.area


def test_nobody_else_makes_a_contact():
    with pytest.raises(TypeError, match="only press, age and relax make one"):
        asp.Contact(u=np.zeros((2, 2)))


def test_repetitions_are_written_out():
    cycle = Repeat([Ramp(1.0, load=2.0), Repeat([Hold(1.0)], 2)], 3)
    assert list(legs_of([cycle, Hold(4.0)])) == [Ramp(1.0, load=2.0), Hold(1.0), Hold(1.0)] * 3 + [Hold(4.0)]
    assert list(legs_of(Hold(1.0))) == [Hold(1.0)]


def test_a_switch_is_the_time_that_is_meant():
    legs = [Hold(0.1)] * 3
    assert sum(leg.duration for leg in legs) != 0.3
    assert Schedule.of(legs, np.array([0.3])).switches[-1] == 0.3
    history = asp.age(CONTACT, [0.1, 0.3], protocol=legs)
    assert history.dataset["time"].values.tolist() == [0.0, 0.1, 0.2, 0.3]
    assert history.dataset["leg"].values.tolist() == [0, 0, 1, 2]


def test_a_history_describes_itself(tmp_path):
    protocol = [Repeat([Hold(0.5, mobility=2.0), Step(load=5.0)], 2)]
    history = asp.age(CONTACT, [0.5], protocol=protocol, fields_at=[0.5])
    data = history.dataset
    assert data["time"].values.tolist() == [0.0, 0.5, 0.5, 1.0, 1.0]
    assert data["leg"].values.tolist() == [0, 0, 1, 2, 3]
    assert data["field_time"].values.tolist() == [0.5, 0.5]
    assert data["field_leg"].values.tolist() == [0, 1]
    assert json.loads(data.attrs["protocol"]) == [described(protocol[0])]
    assert described(protocol[0])["legs"] == [
        {"kind": "hold", "duration": 0.5, "mobility": 2.0},
        {"kind": "step", "load": 5.0},
    ]
    history.save(tmp_path / "history.zarr")
    assert asp.results.load(tmp_path / "history.zarr").identical(data)


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
