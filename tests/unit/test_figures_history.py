"""The figure of a history: every entry is drawn once, where it belongs, and words say what happens."""

import numpy as np
import pytest
from matplotlib.text import Annotation
from numpy.typing import ArrayLike

import asperity as asp
from asperity.figures import history_figure
from asperity.protocols import Hold, Leg, Ramp, Repeat, Step
from tests.surfaces import uncorrelated

SOLID = asp.solids.spring_lattice(k0=1.0, k1=3.0)
CONTACT = asp.press(uncorrelated(16), SOLID, load=10.0)
DECADES = np.geomspace(0.01, 1.0, 5)
STEPPED = [
    Hold(1.0, hold="load"),
    Step(load=4.0),
    Hold(100.0),
    Ramp(4.0, load=8.0, mobility=2.0),
    Step(load=12.0),
]
STEPPED_TIMES = np.concatenate([DECADES, 1 + 100 * DECADES, [103.0]])
CASES: dict[str, tuple[list[Leg] | None, ArrayLike]] = {
    "steps after holds": (STEPPED, STEPPED_TIMES),
    "cycles": ([Repeat([Ramp(1.0, load=20.0), Ramp(1.0, load=10.0)], 3)], np.linspace(0.25, 6, 24)),
    "many legs": ([Repeat([Hold(1.0), Step(load=4.0), Hold(2.0), Step(load=10.0)], 6)], np.arange(1.0, 18)),
    "steps alone": ([Step(load=4.0), Step(load=20.0)], [0.0]),
    "steps at first": ([Step(load=4.0), Step(load=20.0), Hold(1.0)], DECADES),
    "separation": ([Hold(1.0), Step(separation=1.5), Hold(1.0), Ramp(1.0, separation=1.3)], DECADES),
    "one hold": (None, DECADES),
}


def aged(name):
    protocol, times = CASES[name]
    return asp.age(CONTACT, times, protocol=protocol).dataset


def panels(figure):
    """Label -> places and values of all markers, and those of the filled ones."""
    found = {}
    for axes in figure.axes:
        markers = {line.get_marker(): line for line in axes.lines if line.get_marker() in ("o", "D")}
        drawn = {kind: np.array(line.get_data()) for kind, line in markers.items()}
        found[axes.get_ylabel().split("\n")[0]] = (
            np.concatenate(list(drawn.values()), axis=1),
            drawn.get("D", np.empty((2, 0))),
        )
    return found


@pytest.mark.parametrize("name", CASES)
def test_every_entry_is_drawn_once(name):
    data = aged(name)
    figure = history_figure(data)
    kinds = [type(leg) for leg in asp.protocols.legs_of(CASES[name][0] or Hold(1.0))]
    numbers = data["leg"].values if "leg" in data.coords else np.zeros(data.sizes["time"], int)
    after = np.array([kinds[number] is Step for number in numbers]) & (np.arange(numbers.size) > 0)
    drawn = panels(figure)
    assert list(drawn) == ["separation", "load", "contact area [sites]"][name != "separation" :]
    for label, (all_points, filled) in drawn.items():
        values = data[label.replace("contact ", "").split(" ")[0]].values
        np.testing.assert_array_equal(np.sort(all_points[1]), np.sort(values))
        np.testing.assert_array_equal(filled[1], values[after])
    figure.draw_without_rendering()


def test_both_sides_of_a_jump_are_joined():
    data = aged("steps after holds")
    numbers, load = data["leg"].values, data["load"].values
    axes = history_figure(data).axes[0]
    (jumps,) = (line for line in axes.lines if line.get_linestyle() == "--")
    y = np.asarray(jumps.get_ydata()).reshape(-1, 3)
    first, last = (int(np.flatnonzero(numbers == leg)[0]) for leg in (1, 4))
    np.testing.assert_array_equal(y[:, :2], [load[[first - 1, first]], load[[last - 1, last]]])
    assert np.isnan(y[:, 2]).all()
    joined = next(line for line in axes.lines if line.get_linestyle() == "-")
    assert np.isnan(np.asarray(joined.get_ydata())).sum() == 2  # no curve through the jumps


def test_each_leg_has_its_own_time():
    data = aged("steps after holds")
    figure = history_figure(data)
    figure.draw_without_rendering()
    axes = figure.axes[-1]
    ticks = dict(zip(axes.get_xticks(), (text.get_text() for text in axes.get_xticklabels()), strict=True))
    begins = [place for place, text in ticks.items() if text == "0"]
    assert len(begins) == 3
    places, _ = panels(figure)["load"][0]
    assert places.min() == begins[0] == 0
    assert begins[1] in places  # the state after the first jump
    assert places.max() == pytest.approx(max(ticks))  # the end of the last column, where both sides lie
    # Decades are as long as each other within a column; a leg's end is the end of its column.
    second = {text: place for place, text in ticks.items() if begins[1] < place < begins[2] and "10^" in text}
    assert list(second) == ["$10^{0}$", "$10^{1}$", "$10^{2}$"]
    assert np.ptp(np.diff(list(second.values()))) == pytest.approx(0, abs=1e-9)
    assert second["$10^{2}$"] in places
    assert axes.get_xlabel().startswith("time since the beginning of each leg")


def test_heads_say_what_happens():
    heads = [text.get_text() for text in history_figure(aged("steps after holds")).axes[0].texts]
    said = [" ".join(head.split()) for head in heads]
    assert said == [
        "hold load for 1",
        "load 10 → 4 hold for 100",
        "ramp to load 8 in 4, mobility × 2 then load 8 → 12",
    ]
    many = history_figure(aged("many legs"))
    assert len(many.axes[0].texts) == 0
    assert "6 × (hold for 1, step to load 4, hold for 2, step to load 10)" in many.get_suptitle()
    assert "16 × 16 sites, load 10 at first, k0 = 1, k1 = 3, R = 1" in many.get_suptitle()


@pytest.mark.parametrize("name", ["cycles", "many legs"])
def test_many_legs_and_cycles_share_a_linear_axis(name):
    data = aged(name)
    figure = history_figure(data)
    places, _ = panels(figure)["load"][0]
    np.testing.assert_array_equal(np.sort(places), data["time"].values)
    assert figure.axes[-1].get_xscale() == "linear"
    assert figure.axes[-1].get_xlabel().startswith("time $t$")


def test_a_fall_after_a_jump_is_pointed_at():
    times = np.concatenate([DECADES, 1 + 10 * DECADES])
    data = asp.age(CONTACT, times, protocol=[Hold(1.0), Step(load=4.0), Hold(10.0)]).dataset
    after = int(np.flatnonzero(data["leg"].values == 1)[0])
    for areas, texts in (([9, 8, 8, 9, 9, 10], 1), ([9, 9, 9, 9, 10, 11], 0), ([9, 9, 9, 8, 8, 8], 0)):
        data["area"].values[after:] = areas
        figure = history_figure(data)
        arrows = [text for text in figure.axes[-1].texts if isinstance(text, Annotation)]
        assert len(arrows) == texts
        head = " ".join(figure.axes[0].texts[1].get_text().split())
        assert ("area 9 → 8 at 0.1, then grows" in head) == bool(texts)
        if arrows:
            assert arrows[0].xy[1] == 8
            assert arrows[0].xy[0] in panels(figure)["load"][0][0]
