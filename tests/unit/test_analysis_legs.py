"""The table of the legs of a history, against its entries."""

import numpy as np
import pytest

import asperity as asp
from asperity.analysis.legs import leg_table, protocol_of
from asperity.protocols import Hold, Ramp, Repeat, Step, legs_of
from tests.surfaces import uncorrelated

CONTACT = asp.press(uncorrelated(16), asp.solids.spring_lattice(k0=1.0, k1=3.0), load=10.0)
PROTOCOL = [
    Step(load=20.0),
    Repeat([Ramp(0.5, load=5.0, mobility=2.0), Step(load=20.0), Hold(1.0)], 2),
    Hold(1.0, hold="separation"),
    Ramp(1.0, separation=1.5),
    Step(separation=1.2),
]


def test_each_leg_has_the_states_at_its_ends():
    times = [0.25, 0.5, 1.0, 2.25, 3.0, 4.0, 4.5]
    data = asp.age(CONTACT, times, protocol=PROTOCOL).dataset
    assert data["time"].values.tolist() == [0, 0, 0.25, 0.5, 0.5, 1, 1.5, 2, 2, 2.25, 3, 4, 4.5, 5, 5]
    table = leg_table(data)
    assert [row.leg for row in table] == list(legs_of(PROTOCOL))
    assert [row.number for row in table] == list(range(10))
    kinds = "step ramp step hold ramp step hold hold ramp step"
    assert [row.kind for row in table] == kinds.split()
    assert [row.begin for row in table] == [0, 0, 0.5, 0.5, 1.5, 2, 2, 3, 4, 5]
    assert [row.end for row in table] == [0, 0.5, 0.5, 1.5, 2, 2, 3, 4, 5, 5]
    entries = [(0, 1), (1, 3), (3, 4), (4, 6), (6, 7), (7, 8), (8, 10), (10, 11), (11, 13), (13, 14)]
    for name in ("load", "separation", "area"):
        values = data[name].values
        expected = [[values[i] for i in pair] for pair in entries]
        np.testing.assert_array_equal([getattr(row, name) for row in table], expected)
    assert [row.load for row in table[:3]] == [
        pytest.approx(ends) for ends in [(10.0, 20.0), (20.0, 5.0), (5.0, 20.0)]
    ]


def test_the_lowest_area_is_that_of_the_entries_of_a_leg():
    data = asp.age(CONTACT, [1.0, 2.0, 3.0, 5.0], protocol=[Hold(2.0), Step(load=5.0), Hold(4.0)]).dataset
    assert data["time"].values.tolist() == [0, 1, 2, 2, 3, 5, 6]
    data["area"].values[:] = [7, 9, 11, 6, 4, 4, 8]
    rows = leg_table(data)
    assert [(row.lowest_area, row.lowest_after) for row in rows] == [(7, 0), (6, 0), (4, 1)]


def test_switches_are_those_of_the_run():
    # 0.1 + 0.1 + 0.1 is not 0.3, which is meant; it is recorded once as a time, once as that of fields.
    protocol = [Hold(0.1), Hold(0.1), Hold(0.1), Step(load=5.0), Hold(0.1)]
    for times, fields in (([0.3], []), ([0.4], [0.3])):
        data = asp.age(CONTACT, times, protocol=protocol, fields_at=fields).dataset
        row = leg_table(data)[3]
        assert (row.begin, row.end) == (0.3, 0.3)
        assert row.load == pytest.approx((10.0, 5.0))


def test_without_a_protocol_a_history_is_one_hold():
    data = asp.age(CONTACT, [1.0, 2.0]).dataset
    (row,) = leg_table(data)
    assert (row.kind, row.begin, row.end) == ("hold", 0.0, 2.0)
    assert row.area == (data["area"].values[0], data["area"].values[-1])
    assert leg_table(asp.age(CONTACT, [0.0]).dataset) == []


def test_the_protocol_is_read_back(tmp_path):
    history = asp.age(CONTACT, [1.0], protocol=PROTOCOL)
    history.save(tmp_path / "history.zarr")
    assert protocol_of(asp.results.load(tmp_path / "history.zarr")) == PROTOCOL
