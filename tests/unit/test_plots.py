"""Plots of one thing, figures and animations of a history: what is drawn are its numbers, words are true."""

import re
from functools import partial
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.animation import FFMpegWriter
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.text import Annotation
from numpy.typing import ArrayLike
from PIL import Image

from asperity import Contact, History, age, press, relax
from asperity.analysis import SiteState, with_limit
from asperity.analysis.maps import maps_between
from asperity.errors import OutputError
from asperity.figures import (
    Drawing,
    distribution_figure,
    history_figure,
    plot_history,
    plot_spectrum,
    plot_surface,
    sliding_figure,
)
from asperity.figures.contacts import COLORS
from asperity.figures.style import finish
from asperity.friction import add_friction
from asperity.protocols import Hold, Leg, Ramp, Repeat, Slide, Step
from asperity.protocols.legs import legs_of
from asperity.solids import half_space, spring_lattice
from asperity.surfaces import Surface, gaussian, power_spectrum, spectral
from tests.refusals import each_refuses, refuses
from tests.surfaces import uncorrelated

SOLID = spring_lattice(k0=1.0, k1=3.0)


pytestmark = pytest.mark.usefixtures("no_display")


@pytest.fixture(scope="module")
def pressed() -> Contact:
    return press(gaussian((48, 32)), SOLID, load=40.0)


@pytest.fixture(scope="module")
def aged(pressed: Contact) -> History:
    return age(pressed, [0.1, 1.0, 10.0, 100.0], fields_at=[0.0, 1.0, 100.0], rtol=1e-2)


def axes() -> Axes:
    return Figure(figsize=(5, 4)).subplots()


def map_of(ax: Axes) -> np.ndarray:
    drawn = ax.images[0].get_array()
    assert drawn is not None
    return np.ma.getdata(drawn)


def test_a_map_shows_the_pressure_of_each_site_that_touches(pressed: Contact) -> None:
    ax = pressed.plot(axes())
    assert "% touches, load 40" in ax.get_title()
    drawn = map_of(ax)
    np.testing.assert_array_equal(np.isfinite(drawn), pressed.in_contact)
    np.testing.assert_array_equal(drawn[pressed.in_contact], pressed.force[pressed.in_contact])


def test_a_map_of_changes_has_a_color_for_each(pressed: Contact, aged: History) -> None:
    ax = aged.final.plot(axes(), since=pressed)
    before, now = pressed.in_contact, aged.final.in_contact
    sites = {SiteState.KEPT: before & now, SiteState.NEW: now & ~before, SiteState.LOST: before & ~now}
    for state, where in sites.items():
        np.testing.assert_array_equal((map_of(ax) == to_rgb(COLORS[state])).all(axis=-1), where)
    assert f"new {(now & ~before).sum()}" in ax.get_title()


def test_a_large_map_shows_as_large_a_part_as_touches() -> None:
    contact = press(gaussian((600, 600), seed=2), SOLID, load=20000.0)
    drawn = map_of(contact.plot(Figure(figsize=(2, 2)).subplots()))
    assert drawn.shape < contact.heights.shape
    assert np.isfinite(drawn).mean() == pytest.approx(contact.contact_fraction, rel=0.01)


def test_axes_that_are_given_are_drawn_into_and_others_are_new(pressed: Contact, aged: History) -> None:
    ax = axes()
    for plot in (pressed.plot, aged.plot, Surface(gaussian((8, 8))).plot):
        assert plot(ax) is ax
        assert plot().get_figure() is plt.gcf()
    of_area = aged.plot()
    assert len(of_area.child_axes) == 1  # in percent of the nominal area
    high = 1.2 * of_area.get_ylim()[1]
    of_area.plot(10.0, high, "o")  # what a user adds is in the picture
    assert of_area.get_ylim()[1] > high


def test_a_profile_shows_its_contacts(aged: History) -> None:
    contact = press(gaussian((100,)), SOLID, load=8.0)
    ax = contact.plot(axes())
    (dots,) = (c for c in ax.collections if c.get_array() is not None)
    np.testing.assert_array_equal(dots.get_offsets()[:, 0], np.flatnonzero(contact.in_contact))  # type: ignore[index]
    np.testing.assert_array_equal(dots.get_array(), contact.force[contact.in_contact])
    then_and_now = age(contact, [10.0]).final.plot(axes(), since=contact)
    assert {"then", "now", "new"} <= set(then_and_now.get_legend_handles_labels()[1])


def test_units_are_those_of_the_contact() -> None:
    rough = Surface(gaussian((16, 16)), unit="um", pixel_size=(2.0, 2.0), length_unit="um")
    contact = press(rough, half_space(modulus=1e9), pressure=1e6)
    ax = contact.plot(axes())
    part = f"{100 * contact.contact_fraction:.3g} % touches, load 1.024\u00a0mN"
    assert part in ax.get_title()
    bar = ax.get_figure().axes[1]
    assert bar.get_ylabel() == "contact pressure [MPa]"
    np.testing.assert_allclose(np.nanmax(map_of(ax)), 1e-6 * contact.largest_pressure, rtol=1e-12)
    history = age(contact, [1.0, 2.0])
    drawn_area = history.plot(axes(), quantity="contact_area")
    assert drawn_area.get_ylabel() == "contact area [µm²]"
    areas = np.asarray(drawn_area.lines[0].get_ydata(), dtype=float)
    np.testing.assert_allclose(areas, 1e12 * history["contact_area"][1:], rtol=1e-12)


def test_a_contact_whose_surface_has_yielded_is_of_the_same_surface() -> None:
    before = press(gaussian((24, 24)), spring_lattice(k0=1.0, k1=3.0, hardness=2.0), load=20.0)
    now = press(before, load=80.0)
    assert now.permanent_indentation.sum() > before.permanent_indentation.sum()
    maps = maps_between(now, before)
    assert maps_between(before).states.max() == SiteState.KEPT
    np.testing.assert_allclose(maps.heights, gaussian((24, 24)), rtol=0, atol=1e-12)
    np.testing.assert_array_equal(maps.indentation, now.permanent_indentation)


def test_an_earlier_contact_is_of_the_same_surface(pressed: Contact) -> None:
    for other in (press(gaussian((48, 32), seed=5), SOLID, load=40.0), gaussian((48, 32))):
        with refuses("since"):
            pressed.plot(axes(), since=other)  # type: ignore[arg-type]
    with refuses("ax", "Figure"):
        pressed.plot(Figure())  # type: ignore[arg-type]


def test_a_history_is_drawn_over_the_logarithm_of_time(aged: History) -> None:
    for quantity in ("area", "residual"):
        ax, values = aged.plot(axes(), quantity=quantity), aged.dataset[quantity]
        assert ax.get_xscale() == "log"
        np.testing.assert_array_equal(ax.lines[0].get_xydata(), np.transpose([values["time"], values])[1:])
        np.testing.assert_array_equal(ax.lines[1].get_ydata(), [values[0]] * 2)


def test_the_limit_is_drawn_where_it_is_known(pressed: Contact, aged: History) -> None:
    limit = relax(pressed)
    for ax in (aged.plot(axes(), limit=limit), plot_history(with_limit(aged.dataset, limit), axes())):
        (dotted,) = (line for line in ax.lines if line.get_linestyle() == ":")
        np.testing.assert_array_equal(dotted.get_ydata(), [limit.area] * 2)
    with refuses("limit", "a contact"):
        aged.plot(axes(), quantity="approach", limit=limit)


def test_a_history_that_begins_without_contact_has_its_areas() -> None:
    heights = spectral((16, 16), spacing=1e-6, rms_height=1e-8, seed=1)
    solid = half_space(modulus="2 GPa", branches=[(0.3, 10.0)], apparatus=np.inf)
    above = press(Surface(heights, "m", (1e-6, 1e-6), "m"), solid, separation=heights.max() + 1e-8)
    data = age(above, [1.0, 5.0], protocol=[Ramp(1.0, separation=0.0), Hold(9.0)], fields_at=[0.0]).dataset
    assert data["area"].values[0] == 0 < data["area"].values[-1]
    area = 1e12 * data["contact_area"].values
    for ax in (plot_history(data, axes()), history_figure(data).axes[-1]):
        drawn = np.concatenate([line.get_ydata() for line in ax.lines if line.get_marker() == "o"])
        np.testing.assert_allclose(drawn, area)
    distribution_figure(data).draw_without_rendering()  # of no patches


def test_ticks_within_a_decade_are_few_and_do_not_overlap() -> None:
    ax = Drawing(figsize=(3.3, 2.0)).subplots()
    ax.semilogx([1.2, 9.0], [1, 2])
    finish(ax)
    ax.figure.draw_without_rendering()
    labels = [label for label in ax.get_xticklabels(which="both") if label.get_text()]
    assert {label.get_text() for label in labels} == {"1", "2", "5"}  # the first is beyond the axis


def test_what_a_history_has_not_is_refused(pressed: Contact, aged: History) -> None:
    with refuses("quantity", "'friction'"):
        aged.plot(quantity="friction")
    assert not plt.get_fignums()  # no empty figure is left behind
    with refuses("history", "time 0 alone"):
        age(pressed, [0.0]).plot(axes())


def test_surfaces_and_spectra_are_drawn() -> None:
    surface = Surface(gaussian((16, 24)), unit="nm")
    np.testing.assert_array_equal(map_of(surface.plot(axes())), surface.heights)
    line = Surface(gaussian((24,))).plot(axes()).lines[0]
    np.testing.assert_array_equal(line.get_ydata(), gaussian((24,)))
    spectrum = power_spectrum(surface)
    np.testing.assert_array_equal(spectrum.plot(axes()).lines[0].get_ydata(), spectrum.power)
    each_refuses(
        ("surface", "ndarray", plot_surface, gaussian((8, 8))),
        ("spectrum", "Surface", plot_spectrum, surface),
    )


CONTACT = press(uncorrelated(16), SOLID, load=10.0)
DECADES = np.geomspace(0.01, 1.0, 5)
LAST = [Ramp(4.0, load=8.0, mobility=2.0), Step(load=12.0)]
STEPPED = [Hold(1.0, hold="load"), Step(load=4.0), Hold(100.0), *LAST]
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


def legged(name):
    protocol, times = CASES[name]
    return age(CONTACT, times, protocol=protocol).dataset


def panels(figure):
    """Label -> places and values of all markers, and those of the filled ones."""
    found = {}
    for axes in figure.axes:
        drawn = {kind: np.empty((2, 0)) for kind in "oD"}
        drawn |= {line.get_marker(): line.get_data() for line in axes.lines if line.get_marker() in [*"oD"]}
        found[axes.get_ylabel().split("\n")[0]] = np.hstack([drawn["o"], drawn["D"]]), np.array(drawn["D"])
    return found


@pytest.mark.parametrize("name", CASES)
def test_every_entry_is_drawn_once(name):
    data = legged(name)
    figure = history_figure(data)
    kinds = [type(leg) for leg in legs_of(CASES[name][0] or Hold(1.0))]
    numbers = data["leg"].values if "leg" in data.coords else np.zeros(data.sizes["time"], int)
    after = np.array([kinds[number] is Step for number in numbers]) & (np.arange(numbers.size) > 0)
    drawn = panels(figure)
    assert list(drawn) == ["separation", "load", "contact area [sites]"][name != "separation" :]
    for label, (all_points, filled) in drawn.items():
        values = data[label.replace("contact ", "").split(" ")[0]].values
        np.testing.assert_array_equal(np.sort(all_points[1]), np.sort(values))
        np.testing.assert_array_equal(filled[1], values[after])
    figure.draw_without_rendering()


def test_each_leg_has_its_own_time():
    data = legged("steps after holds")
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


def test_the_shade_of_a_slide_is_explained_and_friction_that_does_not_change_is_flat() -> None:
    still = press(uncorrelated(16), spring_lattice(k0=1.0, k1=3.0, R=0.0), load=80.0)
    series = age(still, [2.0], protocol=[Slide(distance=2.0, velocity=1.0)]).dataset
    ax = sliding_figure(add_friction(series, 0.5)).axes[0]
    assert any("shade" in text for text in ax.get_legend_handles_labels()[1])
    assert ax.get_ylim()[0] == 0.0
    assert ax.get_ylim()[1] > series["area"].values.max() * 0.5 / 80.0


def test_a_fall_after_a_jump_is_pointed_at():
    times = np.concatenate([DECADES, 1 + 10 * DECADES])
    data = age(CONTACT, times, protocol=[Hold(1.0), Step(load=4.0), Hold(10.0)]).dataset
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


def test_each_frame_is_a_map_and_its_time(aged):
    film: Any = aged.animate()
    black = to_rgb("black")
    left_end = film._fig.axes[1].get_xlim()[0]
    for number, time in enumerate((left_end, 1.0, 100.0)):
        film._func(number)
        left, right = film._fig.axes
        drawn = left.images[0].get_array()
        assert right.lines[-1].get_xdata()[0] == pytest.approx(time)
        touching = aged["in_contact"].values[number]
        kept = touching & aged["in_contact"].values[0]
        np.testing.assert_array_equal((drawn == black).all(axis=-1), kept)
        np.testing.assert_array_equal((drawn != 1).any(axis=-1), touching | aged["in_contact"].values[0])
    player = film._repr_html_()
    assert "<img" in player
    assert "▶" in player
    assert not re.search(r"https?://|fa-", player)  # it needs no network


def test_a_gif_has_a_frame_for_each_map(aged, tmp_path):
    path = tmp_path / "aging.gif"
    aged.animate(path, frames_per_second=5, quantity="separation")
    with Image.open(path) as image:
        assert image.n_frames == 3  # type: ignore[attr-defined]
        assert image.info["duration"] == 200
    assert not plt.get_fignums()
    with pytest.raises(OutputError, match="kept"):
        aged.animate(path)
    assert [file.name for file in tmp_path.iterdir()] == ["aging.gif"]


def test_profiles_and_protocols_are_animated():
    contact = press(gaussian((64,)), SOLID, load=6.0)
    legs = [Hold(10.0), Step(load=3.0), Hold(10.0)]
    history = age(contact, [0.1, 11.0], protocol=legs, fields_at=[0.0, 10.0, 20.0], rtol=1e-2)
    film: Any = history.animate()
    film._draw_was_started = True
    left, right = film._fig.axes
    places = []
    for number, touching in enumerate(history["in_contact"].values):
        film._func(number)
        marks = [line.get_xdata() for line in left.lines if line.get_marker() == "s"]
        np.testing.assert_array_equal(np.sort(np.concatenate(marks)), np.flatnonzero(touching))
        places.append(float(right.lines[-1].get_xdata()[0]))
    assert history["field_leg"].values.tolist() == [0, 0, 1, 2]  # before and after the step
    assert places == sorted(set(places))


def test_what_cannot_be_animated_is_refused(aged, tmp_path, monkeypatch: pytest.MonkeyPatch):
    each_refuses(
        ("dataset", "none", age(aged.final, [1.0]).animate),
        ("path", "aging.avi", aged.animate, "aging.avi"),
        ("quantity", "'friction'", partial(aged.animate, quantity="friction")),
        ("frames_per_second", "0", partial(aged.animate, frames_per_second=0)),
    )
    monkeypatch.setattr(FFMpegWriter, "isAvailable", lambda: False)
    with refuses("path", "aging.mp4"):
        aged.animate("aging.mp4")
    assert not plt.get_fignums()
