"""The page with its server: what is pressed, changed, dropped and copied gives the library's numbers."""

import io
import re
from typing import Any

import numpy as np
import pytest
from PIL.GifImagePlugin import GifImageFile

from asperity.app.config import config_from
from asperity.app.runs import Progress, execute
from asperity.ask.files import read_tables
from tests.browser.conftest import SMALL, again, finished, move_the_change_to_10, rows, state, until


def computed(config):
    return execute(config_from(config, {}, None), Progress()).dataset


def test_a_folder_is_opened_without_computing(tab, served, outcome):
    page = tab(served)
    finished(page)
    assert rows(page)["area"] == outcome.dataset["area"].values.tolist()
    assert page.url.endswith("#open=first.zarr")
    assert page.locator("#entries button").all_inner_texts() == ["first.zarr", "second.zarr"]
    again(page, lambda: page.click("text=second.zarr"))
    page.reload()
    assert finished(page)["job"] == "second.zarr"


def test_friction_of_a_given_shear_strength_and_a_picture_in_readable_units(live):
    surface = {"kind": "spectral", "shape": [64, 64], "rms_height": 1e-6, "spacing": [2e-5], "unit": "m"}
    solid = {"kind": "half_space", "modulus": 3e9, "branches": [[0.5, 1.0]]}
    page = live({**SMALL, "surface": surface, "solid": solid, "contact": {"pressure": 5e6}})
    assert state(page)["quantity"] == "contact_area"
    series = rows(page)
    load = 5e6 * (64 * 2e-5) ** 2
    assert series["load"][0] == pytest.approx(load)
    page.fill("#shear", "5e7")
    expected = 5e7 * np.array(series["contact_area_corrected"]) / series["load"]
    np.testing.assert_allclose(rows(page)["friction"], expected, rtol=1e-12)
    page.fill("[id='friction.shear_strength']", "2e7")  # of the run, which ends what was tried
    again(page, lambda: page.click("#press"))
    series = rows(page)
    np.testing.assert_allclose(series["friction"], expected[: len(series["load"])] * 2 / 5, rtol=1e-12)
    said = page.evaluate("""() => {
      const said = [], kept = CanvasRenderingContext2D.prototype.fillText;
      CanvasRenderingContext2D.prototype.fillText = (text) => said.push(text);
      picture(app, app.map);
      CanvasRenderingContext2D.prototype.fillText = kept;
      return said; }""")
    assert 1e-7 < series["contact_area"][-1] < 1e-6  # 100 000 µm² and more
    assert "contact area [mm²]" in said
    number = f"{load:.4g}\u00a0N"
    assert any(f"load {number}" in one for one in said)
    assert page.locator("#number-load").text_content() == number


def test_friction_of_a_strength_that_ages_is_that_of_the_run(live):
    surface = {
        "kind": "spectral",
        "shape": [48, 48],
        "rms_height": 1e-6,
        "spacing": [4e-6],
        "cutoff": 4e-5,
        "unit": "m",
    }
    config = SMALL | {
        "surface": surface,
        "solid": {"kind": "half_space", "modulus": 3e9, "branches": [[0.3, 1.0], [0.3, 1e3]]},
        "contact": {"pressure": 1e6},
        "friction": {"shear_strength": 4e7, "growth": 0.05, "after": 1.0, "renewal": 1e-6},
    }
    np.testing.assert_allclose(rows(live(config))["friction"], computed(config)["friction"], rtol=1e-12)


def test_another_question_keeps_what_it_does_not_use(live):
    page = live()
    page.get_by_role("button", name="Polymer half-space").click()
    finished(page, after=None)
    page.fill("[id='contact.pressure']", "3 MPa")
    page.select_option("#question", "law")
    assert page.input_value("[id='aging.times']") == "0 1000"
    page.select_option("#question", "")
    assert page.input_value("[id='contact.pressure']") == "3 MPa"
    for kind in ("layer", "half_space"):
        page.select_option("[id='solid.kind']", kind)
    assert "poisson" not in page.evaluate("app.form.read().solid")


def test_another_load_is_another_run(live):
    page = live()
    page.fill("[id='contact.load']", "120")
    again(page, lambda: page.keyboard.press("Enter"))
    dataset = computed(SMALL | {"contact": {"load": 120.0}})
    assert rows(page)["area"] == dataset["area"].values.tolist()
    assert page.locator("#number-load").text_content() == "120"
    page.fill("[id='contact.load']", "")  # then it follows from the surface again
    page.fill("[id='surface.rms']", "3")
    again(page, lambda: page.click("#press"))
    assert rows(page)["load"][0] == pytest.approx(138.0)
    assert page.locator("[id='contact.load']").get_attribute("placeholder") == "138"


CHANGES = [{"kind": "step", "load": 20.0}, {"kind": "ramp", "duration": 5.0, "load": 20.0}]


@pytest.mark.parametrize("change", CHANGES, ids=["step", "ramp"])
def test_a_change_of_load_branches_from_its_moment_and_shows_its_end(live, change):
    page = live(reduced_motion="no-preference")
    first = state(page)
    areas = rows(page)["area"]
    moment = move_the_change_to_10(page)
    page.select_option("#how", change["kind"])
    if "duration" in change:
        page.fill("#ramp", "5")
    page.fill("#new-value", "20")
    page.fill("#after", "100")
    again(page, lambda: page.click("#branch button"))
    page.wait_for_timeout(300)
    seen = state(page)
    assert not seen["playing"]  # nothing plays by itself
    assert seen["maps"][seen["map"]]["leg"] == 1
    assert seen["maps"][seen["map"]]["time"] == pytest.approx(moment + change.get("duration", 0.0))
    assert page.locator("#number-load").text_content() == "20"
    protocol = [{"kind": "hold", "duration": moment}, change, {"kind": "hold", "duration": 100.0}]
    load = rows(page)["load"][0]
    dataset = computed(SMALL | {"contact": {"load": float(f"{load:.3g}")}, "protocol": protocol})
    assert rows(page)["area"] == dataset["area"].values.tolist()
    assert rows(page)["area"][:8] == areas[:8]
    assert seen["earlier"] == first["job"]
    page.focus("#moment")
    page.keyboard.press("End")
    assert state(page)["counts"][3] > 0
    assert seen["config"]["protocol"][1].items() >= change.items()
    told = page.locator("#history span").text_content()
    assert all(f"{name} {value:g}" in told for name, value in change.items() if name != "kind")
    with_it = page.evaluate("document.querySelector('#curve').toDataURL()")
    page.uncheck("#earlier")
    assert page.evaluate("document.querySelector('#curve').toDataURL()") != with_it
    again(page, lambda: page.click("#no-history"))
    assert "protocol" not in state(page)["config"]


def test_a_dropped_file_becomes_the_surface(live):
    page = live()
    heights = np.random.default_rng(4).standard_normal((40, 40))
    stream = io.BytesIO()
    np.save(stream, heights)
    drop = """data => {
      const files = new DataTransfer();
      files.items.add(new File([new Uint8Array(data)], "own scan.npy"));
      dispatchEvent(new DragEvent("drop", {dataTransfer: files, cancelable: true})); }"""
    seen = again(page, lambda: page.evaluate(drop, list(stream.getvalue())))
    assert seen["shape"] == [40, 40]
    assert seen["config"]["surface"]["periodic"] == "reflect"  # once, as a prediction takes it
    assert page.input_value("[id='surface.kind']") == "file"
    assert re.fullmatch(r"[0-9a-f]{16}/own scan\.npy", page.input_value("[id='surface.path']"))
    page.click("#section-surface summary")
    page.select_option("[id='surface.tilt']", "none")
    page.select_option("[id='surface.periodic']", "wrap")
    assert again(page, lambda: page.click("#press"))["shape"] == [40, 40]
    assert state(page)["config"]["surface"]["periodic"] == "wrap"
    site = page.evaluate("asperity.site(41)")
    assert site["height"] == pytest.approx(heights.flat[41], abs=np.ptp(heights) / 60000)
    page.set_input_files("#file", {"name": "notes.txt", "mimeType": "text/plain", "buffer": b"not heights"})
    until(page, "asperity.state.mistakes.length && !asperity.state.busy")
    assert "notes.txt" in page.locator("#form").inner_text()
    assert state(page)["finished"]  # what was there before is still shown


def test_the_keyboard_is_enough(live):
    page = live()
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.textContent") == "Skip to the results"
    reached = []
    for _ in range(60):
        page.keyboard.press("Tab")
        named = "document.activeElement.id || document.activeElement.dataset.save || ''"
        reached.append(page.evaluate(named))
        if page.evaluate("document.activeElement === document.body"):
            break  # the end of the page
        style = page.evaluate("getComputedStyle(document.activeElement).outlineStyle")
        assert style != "none", reached[-1]
        if reached[-1] == "contact.load":
            page.keyboard.press("Control+a")
            page.keyboard.type("60")
    results = {"map", "colored", "quantity", "moment", "play", "when", "new-value", "gif"}
    assert {"surface.kind", "contact.load", "press", *results} <= set(reached)
    page.focus("#press")
    again(page, lambda: page.keyboard.press("Space"))
    assert rows(page)["load"][0] == pytest.approx(60.0)


def test_a_reload_restores_and_two_tabs_share_a_run(live):
    page = live()
    page.fill("[id='surface.seed']", "5")
    seen = again(page, lambda: page.click("#press"))
    areas = rows(page)["area"]
    page.reload()
    assert finished(page)["job"] == seen["job"]
    assert rows(page)["area"] == areas
    assert page.input_value("[id='surface.seed']") == "5"
    other = page.context.new_page()
    other.goto(page.url)
    assert finished(other)["job"] == seen["job"]
    other.close()


def test_what_is_copied_gives_the_same_numbers(live, tmp_path):
    page = live(permissions=["clipboard-read", "clipboard-write"], color_scheme="dark")
    assert page.evaluate("theme().dark")
    areas = rows(page)["area"]
    page.click('[data-copy="toml"]')
    until(page, "document.querySelector('#taken').textContent === 'Copied.'")
    path = tmp_path / "copied.toml"
    path.write_text(page.evaluate("navigator.clipboard.readText()"))
    config = config_from(read_tables(path), {}, path)
    assert execute(config, Progress()).dataset["area"].values.tolist() == areas
    page.click("#take summary")
    page.select_option("#language", "python")
    text = page.evaluate("document.querySelector('#text').value")
    names: dict[str, Any] = {}
    exec(compile(text, "copied", "exec"), names)
    assert names["history"].dataset["area"].values.tolist() == areas
    page.click('[data-copy="link"]')
    until(page, "navigator.clipboard.readText().then((text) => text.startsWith('http'))")
    address = page.evaluate("navigator.clipboard.readText()")
    other = page.context.new_page()
    other.goto(address)
    assert finished(other)["job"] == state(page)["job"]
    other.close()


def test_the_page_as_a_file_opens_without_a_server(live, tab, tmp_path):
    page = live()
    with page.expect_download() as saved:
        page.click('[data-save="page"]')
    path = tmp_path / "saved.html"
    saved.value.save_as(path)
    alone = tab(path.as_uri())
    assert not state(alone)["live"]
    assert rows(alone) == rows(page)
    assert state(alone)["counts"] == state(page)["counts"]
    assert alone.evaluate("document.querySelector('#map').toDataURL()").startswith("data:image/png")
    with alone.expect_download() as saved:
        alone.click('[data-save="gif"]')
    with GifImageFile(io.BytesIO(saved.value.path().read_bytes())) as animation:
        assert animation.n_frames == len(state(page)["maps"])


def test_a_long_run_can_be_stopped(live):
    page = live()
    page.fill("[id='surface.shape']", "1500 1500")
    page.click("#press")
    until(page, "asperity.state.busy && /pressing|aging/.test(document.querySelector('#stage').textContent)")
    page.focus("#stop")
    page.keyboard.press("Enter")
    until(page, "!asperity.state.busy")
    assert page.evaluate("document.activeElement.id") == "press"
    assert not page.locator("#stop").is_visible()
    assert page.locator("#form-mistakes").text_content() == "stopped"
    page.fill("[id='surface.shape']", "32 32")
    assert again(page, lambda: page.click("#press"))["shape"] == [32, 32]


def test_a_lost_connection_is_said_and_mended(live, tab):
    page = live()
    page.evaluate("""() => {
      window.heard = [];
      const place = document.querySelector("#connection");
      const hear = () => heard.push([asperity.state.connected, place.textContent]);
      new MutationObserver(hear).observe(place, {childList: true});
      app.socket.close(); }""")
    until(page, "heard.length > 1 && asperity.state.connected")
    (connected, told), *_ = page.evaluate("heard")
    assert (connected, "lost" in told) == (False, True)
    assert page.locator("#connection").text_content() == ""
    page.fill("[id='surface.seed']", "9")
    again(page, lambda: page.click("#press"))


def test_a_damaged_link_is_said(tab, served):
    page = tab(f"{served}#config=%%%")
    until(page, "document.querySelector('#failure').textContent")
    assert "damaged" in page.locator("#failure").text_content()
