"""The page as one meets it: what is in view, what a wrong value does, what the next press gives."""

import io
import re

import numpy as np
import pytest
from PIL import Image

from tests.browser.conftest import SMALL, again, move_the_change_to_10, rows, state, until

WIDE, NARROW = {"width": 1280, "height": 900}, {"width": 390, "height": 844}
SEEN = """one => {
  const box = document.querySelector(one).getBoundingClientRect(), there = [];
  for (const y of [box.top + 2, box.bottom - 2]) there.push(document.elementFromPoint(box.left + 5, y));
  return there.every(found => document.querySelector(one).contains(found)); }"""
"""Whether both ends of an element are on the screen, and nothing lies over them."""


def seen(page, selector):
    return page.evaluate(SEEN, selector)


def opened(page):
    """The form of a page, opened where it is folded."""
    page.evaluate("document.querySelector('#setup').open = true")
    return page


@pytest.mark.parametrize(
    ("viewport", "key"), [(WIDE, "contact.load"), (NARROW, "contact.load"), (WIDE, "aging.first")]
)
def test_a_wrong_value_is_seen(live, viewport, key):
    page = opened(live(viewport=viewport))
    field = f"[id='{key}']"
    page.evaluate("for (const one of document.querySelectorAll('#sections details')) one.open = true")
    page.fill(field, "0,5")
    page.click("#press")
    until(page, "asperity.state.mistakes.length")
    assert "got '0,5'; try 0.5" in page.locator(f"[id='mistake-{key}']").text_content()
    assert seen(page, f"[id='mistake-{key}']")
    assert seen(page, field)
    label = key.split(".")[1].replace("_", " ")
    assert page.locator("#form-mistakes").text_content().startswith(f"{label}: expected")
    if viewport is WIDE:
        assert seen(page, "#form-mistakes")
        assert seen(page, "#press")
    assert page.locator(field).get_attribute("aria-invalid") == "true"
    assert page.evaluate("document.activeElement.id") == key
    page.fill(field, "20")
    again(page, lambda: page.click("#press"))
    assert page.locator("[aria-invalid]").count() == 0


def test_a_wrong_change_is_seen(live):
    page = live(viewport=NARROW)
    page.fill("#after", "-5")
    page.click("#branch button")
    until(page, "asperity.state.mistakes.length")
    assert page.locator("#branch-mistake").text_content().startswith("duration: expected")
    assert seen(page, "#branch-mistake")


def test_what_no_field_says_is_seen_by_the_button(live):
    page = live()
    page.select_option("[id='solid.kind']", "half_space")
    page.fill("[id='solid.modulus']", "")
    page.evaluate("document.querySelector('#setup').scrollTop = 1e6")
    page.click("#press")
    until(page, "asperity.state.mistakes.length")
    assert page.locator("#form-mistakes").text_content().startswith("Solid: expected modulus")
    assert seen(page, "#form-mistakes")


def test_another_solid_can_be_pressed_at_once(live):
    page = live(SMALL | {"contact": {"load": 46.0}})
    page.select_option("[id='solid.kind']", "coated_half_space")
    after = again(page, lambda: page.click("#press"))
    assert after["config"]["solid"]["modulus"] == 3e9
    assert "load" not in after["config"]["contact"]  # that of the lattice is in other units
    series = rows(page)
    first, last = np.array(series["contact_fraction"])[[0, -1]]
    assert 0.005 < first < last < 0.1
    assert page.locator("#number-load").text_content().endswith("N")
    page.select_option("[id='solid.kind']", "spring_lattice")
    again(page, lambda: page.click("#press"))
    assert 0.005 < rows(page)["contact_fraction"][0] < 0.1
    assert "contact_area" not in rows(page)


def test_what_was_typed_stays_with_another_solid(live):
    page = live()
    page.select_option("[id='solid.kind']", "half_space")
    page.fill("[id='solid.modulus']", "1e9")
    page.fill("[id='solid.branches']", "0.5 2")
    page.fill("[id='surface.hurst']", "0.6")
    page.select_option("[id='solid.kind']", "layer")
    config = page.evaluate("app.form.read()")
    typed = {"kind": "layer", "modulus": 1e9, "branches": [[0.5, 2]]}
    assert config["solid"] == typed | {"poisson": 0.35, "thickness": 1e-4}
    assert config["surface"]["hurst"] == 0.6


def test_balls_stay_with_another_solid_and_are_pressed(live):
    page = live()
    page.select_option("[id='surface.kind']", "array")
    balls = {"shape": "48 48", "pixel_size": "1 um", "places": "20um 12um\n20um 34um", "radii": "1 mm"}
    for name, text in balls.items():
        page.fill(f"[id='surface.{name}']", text)
    page.select_option("[id='solid.kind']", "half_space")
    page.fill("[id='contact.pressure']", "1 MPa")
    after = again(page, lambda: page.click("#press"))
    assert after["config"]["surface"]["kind"] == "array"
    assert page.locator("#number-load").text_content().endswith("N")
    assert rows(page)["contact_fraction"][0] > 0.02


def test_an_uninterrupted_curve_is_that_of_the_same_time(live):
    page = live({"surface": {"shape": [96, 96]}, "aging": {"per_decade": 2}})
    series = rows(page)
    times, areas = np.array(series["time"]), np.array(series["area"])
    move_the_change_to_10(page)
    page.fill("#new-value", "60")
    again(page, lambda: page.click("#branch button"))
    here, there = 10.0, 10**1.5  # two rows of the first run; between them its area goes with log t
    before, then = (areas[np.isclose(times, time)][0] for time in (here, there))
    places = [page.evaluate(f"app.curveView.axis.place({time}, true)") for time in (here, 15.0, there)]
    true = before + (then - before) * np.log(15.0 / here) / np.log(there / here)
    straight = before + (then - before) * (places[1] - places[0]) / (places[2] - places[0])
    x, y, other = page.evaluate(
        f"[app.curveView.x({places[1]}), app.curveView.y({true}), app.curveView.y({straight})]"
    )
    assert abs(y - other) > 12
    shot = Image.open(io.BytesIO(page.locator("#curve").screenshot())).convert("RGB")
    dark = np.asarray(shot)[:, round(x) - 4 : round(x) + 5].max(axis=-1) < 190
    assert dark[round(y) - 4 : round(y) + 5].any()
    assert not dark[round(other) - 4 : round(other) + 5].any()
    assert page.locator(".earlier").inner_text().strip() == "without the change (dotted)"
    load = page.input_value("[id='contact.load']")
    page.fill("[id='contact.load']", "300")
    again(page, lambda: page.click("#press"))
    assert page.locator(".earlier").inner_text().strip() == f"with load {load} (dotted)"
    page.fill("[id='surface.seed']", "8")  # another surface is not compared
    assert again(page, lambda: page.click("#press"))["earlier"] is None
    assert not page.locator(".earlier").is_visible()


def test_a_wrong_change_stays_out_of_the_configuration(live):
    page = live()
    before = state(page)
    address = page.url
    page.fill("#new-value", "-3")
    page.click("#branch button")
    until(page, "document.querySelector('#branch-mistake').textContent && !asperity.state.busy")
    assert "got -3" in page.locator("#branch-mistake").text_content()
    assert not page.locator("#history").is_visible()
    assert (page.url, state(page)["job"]) == (address, before["job"])
    page.fill("[id='contact.load']", "60")
    assert "protocol" not in again(page, lambda: page.click("#press"))["config"]
    page.fill("#new-value", "30")
    assert len(again(page, lambda: page.click("#branch button"))["config"]["protocol"]) == 3
    words = page.locator("#history span").text_content()
    assert "mobility" not in words
    assert not re.search(r"\d{6}", words)
    assert page.url != address  # from here a reload has the change


def test_pressures_are_told_apart_by_their_logarithms(live):
    page = live()
    page.select_option("#colored", "pressure")
    pressures = page.evaluate("Array.from(app.scene.pressures(app.map)).filter((one) => one > 0)")
    low, high = page.evaluate("app.scene.pressureRange(app.map)")
    assert (low, high) == pytest.approx((np.quantile(pressures, 0.02, method="lower"), max(pressures)))
    assert "(logarithmic)" in page.locator("#legend").text_content()


def test_the_change_of_load_and_the_numbers_are_in_view(live):
    page = live()
    named = ("#branch button", "#curve", "#map", "#number-load")
    button, curve, area, load = (page.locator(one).bounding_box() for one in named)
    assert max(one["y"] + one["height"] for one in (button, load)) < 900
    assert max(one["x"] + one["width"] for one in (area, load)) <= curve["x"]


def test_on_a_phone_the_results_come_first(live):
    page = opened(live(viewport=NARROW))
    page.fill("[id='surface.seed']", "3")
    again(page, lambda: page.click("#press"))
    assert seen(page, "#map-title")
    assert seen(page, "#map")
    page.fill("#new-value", "20")
    again(page, lambda: page.click("#branch button"))
    assert seen(page, "#curve-title")
    assert seen(page, "#curve")


@pytest.mark.parametrize("viewport", [WIDE, NARROW])
def test_another_question_is_chosen_asked_and_left_again(live, viewport):
    page = opened(live(viewport=viewport))
    page.select_option("#question", "sliding")
    assert page.locator("#press").text_content() == "Slide"
    assert not page.locator("#section-aging").is_visible()
    page.fill("[id='surface.shape']", "32 32")
    page.fill("[id='sliding.speeds']", "1 mm/s 1 um/s")
    page.click("#press")
    until(page, "asperity.state.mistakes.length")
    assert "the lowest first" in page.locator("[id='mistake-sliding.speeds']").text_content()
    opened(page).fill("[id='sliding.speeds']", "1 um/s 1 mm/s")
    page.click("#press")
    until(page, "!asperity.state.busy && !document.querySelector('#answer').hidden")
    assert "largest friction" in page.locator("#answer").text_content()
    assert page.evaluate("document.querySelector('#answer img').naturalWidth") > 100
    assert page.evaluate("document.documentElement.scrollWidth") == viewport["width"]
    assert not page.locator("#panels").is_visible()
    page.reload()  # the address asks again
    until(page, "asperity.state.connected && !document.querySelector('#answer').hidden")
    assert page.locator("#question").input_value() == "sliding"
    opened(page).select_option("#question", "")
    page.click("#press")
    until(page, "asperity.state.finished")
    assert page.locator("#answer").is_hidden()
    assert page.locator("#panels").is_visible()
