"""Plots of one thing: what is drawn are its numbers, into axes of the user or new ones."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from asperity import Contact, History, age, press, protocols, relax
from asperity.analysis import SiteState, with_limit
from asperity.analysis.maps import maps_between
from asperity.figures import plot_history, plot_spectrum, plot_surface, style
from asperity.figures.contacts import COLORS
from asperity.solids import half_space, spring_lattice
from asperity.surfaces import Surface, gaussian, power_spectrum
from tests.refusals import refuses

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
    assert "% of the sites touch, load 40" in ax.get_title()
    drawn = map_of(ax)
    np.testing.assert_array_equal(np.isfinite(drawn), pressed.in_contact)
    np.testing.assert_array_equal(drawn[pressed.in_contact], pressed.force[pressed.in_contact])


def test_a_map_of_changes_has_a_color_for_each(pressed: Contact, aged: History) -> None:
    ax = aged.final.plot(axes(), since=pressed)
    drawn, before, now = map_of(ax), pressed.in_contact, aged.final.in_contact
    colors = {state: to_rgb(color) for state, color in COLORS.items()}
    sites = {"KEPT": before & now, "NEW": now & ~before, "LOST": before & ~now}
    for state, where in ((SiteState[name], where) for name, where in sites.items()):
        np.testing.assert_array_equal((drawn == colors[state]).all(axis=-1), where)
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
        new = plot()
        assert new is not ax
        assert new.get_figure() is plt.gcf()


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
    part = f"{100 * contact.contact_fraction:.3g} % of the nominal area touches, load 1.024\u00a0mN"
    assert part in ax.get_title()
    bar = ax.get_figure().axes[1]  # type: ignore[union-attr]
    assert bar.get_ylabel() == "contact pressure [MPa]"
    drawn = map_of(ax)
    np.testing.assert_allclose(np.nanmax(drawn), 1e-6 * contact.largest_pressure, rtol=1e-12)
    history = age(contact, [1.0, 2.0])
    drawn_area = history.plot(axes(), quantity="contact_area")
    assert drawn_area.get_ylabel() == "contact area [µm²]"
    np.testing.assert_allclose(
        np.asarray(drawn_area.lines[0].get_ydata(), dtype=float),
        1e12 * history.dataset["contact_area"][1:],
        rtol=1e-12,
    )


def test_a_contact_whose_surface_has_yielded_is_of_the_same_surface() -> None:
    before = press(gaussian((24, 24)), spring_lattice(k0=1.0, k1=3.0, hardness=2.0), load=20.0)
    now = press(before, load=80.0)
    assert now.permanent_indentation.sum() > before.permanent_indentation.sum()
    maps = maps_between(now, before)
    np.testing.assert_allclose(maps.heights, gaussian((24, 24)), rtol=0, atol=1e-12)
    np.testing.assert_array_equal(maps.indentation, now.permanent_indentation)


def test_a_contact_without_load_can_be_drawn() -> None:
    contact = press(gaussian((8, 8)), SOLID, separation=9.0)
    assert contact.area == 0
    contact.plot(axes()).get_figure(root=True).draw_without_rendering()  # type: ignore[union-attr]


def test_an_earlier_contact_is_of_the_same_surface(pressed: Contact) -> None:
    other = press(gaussian((48, 32), seed=5), SOLID, load=40.0)
    with refuses("since"):
        pressed.plot(axes(), since=other)
    with refuses("since"):
        pressed.plot(axes(), since=gaussian((48, 32)))  # type: ignore[arg-type]
    with refuses("ax"):
        pressed.plot(Figure())  # type: ignore[arg-type]
    assert maps_between(pressed).states.max() == SiteState.KEPT


@pytest.mark.parametrize("quantity", ["area", "load", "separation", "residual"])
def test_a_history_is_drawn_over_the_logarithm_of_time(aged: History, quantity: str) -> None:
    ax = aged.plot(axes(), quantity=quantity)
    assert ax.get_xscale() == "log"
    np.testing.assert_array_equal(ax.lines[0].get_xdata(), aged.dataset["time"][1:])
    np.testing.assert_array_equal(ax.lines[0].get_ydata(), aged.dataset[quantity][1:])
    np.testing.assert_array_equal(ax.lines[1].get_ydata(), [aged.dataset[quantity][0]] * 2)


def test_the_limit_is_drawn_where_it_is_known(pressed: Contact, aged: History) -> None:
    limit = relax(pressed)
    for ax in (aged.plot(axes(), limit=limit), plot_history(with_limit(aged.dataset, limit), axes())):
        (dotted,) = (line for line in ax.lines if line.get_linestyle() == ":")
        np.testing.assert_array_equal(dotted.get_ydata(), [limit.area] * 2)
    with refuses("limit"):
        aged.plot(axes(), quantity="approach", limit=limit)


def test_histories_on_axes_of_the_user_take_the_colors_of_those(aged: History) -> None:
    ax = axes()
    ax.set_prop_cycle(color=["red", "green", "blue"])
    ax.plot([1.0, 2.0], [300.0, 300.0])
    for label in ("one", "two"):
        aged.plot(ax, label=label)
    aged.plot(ax, label="three", color=style.VERMILION)
    assert ax.get_legend_handles_labels()[1] == ["one", "two", "three"]
    assert [line.get_color() for line in ax.lines] == ["red", "#008000", "#0000ff", style.VERMILION]
    assert aged.plot().lines[0].get_color() == style.BLUE
    plt.close("all")


def test_a_protocol_has_a_column_for_each_leg(pressed: Contact) -> None:
    legs = [protocols.Hold(10.0), protocols.Step(load=20.0), protocols.Hold(100.0)]
    history = age(pressed, [0.1, 1.0, 10.1, 12.0, 110.0], protocol=legs, rtol=1e-2)
    ax = history.plot(axes())
    markers = [line for line in ax.lines if line.get_marker() in ("o", "D")]
    shown = np.sort(np.concatenate([np.asarray(line.get_ydata()) for line in markers]))
    np.testing.assert_array_equal(shown, np.sort(history.dataset["area"]))
    assert any("load 40" in text.get_text() and "20" in text.get_text() for text in ax.texts)
    assert "each leg" in ax.get_xlabel()


def test_what_a_history_has_not_is_refused(pressed: Contact, aged: History) -> None:
    with refuses("quantity"):
        aged.plot(quantity="friction")
    assert not plt.get_fignums()  # no empty figure is left behind
    with refuses("history"):
        age(pressed, [0.0]).plot(axes())


def test_surfaces_and_spectra_are_drawn() -> None:
    surface = Surface(gaussian((16, 24)), unit="nm")
    np.testing.assert_array_equal(map_of(surface.plot(axes())), surface.heights)
    line = Surface(gaussian((24,))).plot(axes()).lines[0]
    np.testing.assert_array_equal(line.get_ydata(), gaussian((24,)))
    spectrum = power_spectrum(surface)
    np.testing.assert_array_equal(spectrum.plot(axes()).lines[0].get_ydata(), spectrum.power)
    with refuses("surface"):
        plot_surface(gaussian((8, 8)), axes())  # type: ignore[arg-type]
    with refuses("spectrum"):
        plot_spectrum(surface, axes())  # type: ignore[arg-type]


def test_a_film_marks_the_contacts_of_a_profile_where_it_has_yielded() -> None:
    solid = spring_lattice(k0=1.0, k1=3.0, hardness=1.0)
    history = age(press(gaussian((64,)), solid, load=10.0), [1.0], fields_at=[0.0, 1.0])
    film = history.animate()
    assert "<img" in film._repr_html_()
    film._func(1)  # type: ignore[attr-defined]
    left = film._fig.axes[0]  # type: ignore[attr-defined]
    marks = [line for line in left.lines if line.get_marker() == "s"]
    heights = np.sort(np.concatenate([np.asarray(line.get_ydata()) for line in marks]))
    final = history.final
    assert final.permanent_indentation.max() > 0.1
    np.testing.assert_allclose(heights, np.sort(final.heights[final.in_contact]), rtol=0, atol=1e-12)
