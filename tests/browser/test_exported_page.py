"""The page in a file, without a server: it shows what the library computed."""

import base64
import io
from typing import Any

import numpy as np
import pytest
from PIL import Image
from PIL.GifImagePlugin import GifImageFile

import asperity as asp
from asperity.app.explore.export import exported_page
from asperity.app.explore.scene import Recording, ending, map_of, pack, recorded
from asperity.results.quantities import select
from tests.browser.conftest import rows, state, until

KEPT, NEW, LOST = 1, 2, 3


def classes(in_contact, number):
    """State of each site in a map: touching then and first, only then, only first."""
    first, now = in_contact[0], in_contact[number]
    return np.select([now & first, now, first], [KEPT, NEW, LOST], 0)


def colors(page):
    """Colors of the states, free first, as the page has them."""
    return np.array(page.evaluate("theme().states"))


def pixels(page, selector="#map"):
    """What a canvas shows, shape (rows, columns, 3)."""
    written = page.evaluate("one => document.querySelector(one).toDataURL()", selector)
    with Image.open(io.BytesIO(base64.b64decode(written.split(",")[1]))) as picture:
        return np.asarray(picture.convert("RGB"))


def middle(drawn, site, columns):
    """Where the middle of a site is drawn."""
    row, column = divmod(site, columns)
    return drawn["left"] + (column + 0.5) * drawn["across"], drawn["top"] + (row + 0.5) * drawn["down"]


def test_it_shows_the_series_of_the_run(tab, exported, outcome):
    page = tab(exported)
    series, dataset = rows(page), outcome.dataset
    patches = ("patches", "largest_patch_size", "mean_patch_size", "median_patch_size")
    for name in ("time", "leg", "area", "contact_fraction", "load", "separation", "residual", *patches):
        assert series[name] == dataset[name].values.tolist()  # this run has a map in each row
    np.testing.assert_allclose(series["mean_pressure"], dataset["load"] / dataset["area"], rtol=1e-12)
    tabor = (dataset["area"] / dataset["load"]) / (dataset["area"][0] / dataset["load"][0])
    np.testing.assert_allclose(series["friction"], tabor, rtol=1e-12)
    assert page.locator("#title").text_content() == 'Unloading <&> "quoted"'
    assert not page.locator("#form").is_visible()
    largest = int(dataset["largest_patch_size"][-1])
    for name, text in (
        ("area", f"{int(dataset['area'][-1])} sites"),
        ("patches", f"{int(dataset['patches'][-1])}"),
        ("largest_patch_size", f"{largest}\u00a0{'site' if largest == 1 else 'sites'}"),
    ):
        assert page.locator(f"#number-{name}").text_content() == text
    area = pixels(page, "#curve")
    for quantity in ("residual", "decade_growth", "largest_patch_size", "patches"):
        page.select_option("#quantity", quantity)
        assert state(page)["quantity"] == quantity
        assert (pixels(page, "#curve") != area).sum() > 500
    said = page.locator("#curve").get_attribute("aria-label")
    assert said.startswith(f"patches against time: {int(dataset['patches'][0])} at first touch")


def test_every_map_has_the_classes_of_the_fields(tab, exported, outcome):
    page = tab(exported)
    in_contact = outcome.dataset["in_contact"].values
    page.focus("#moment")
    page.keyboard.press("Home")
    legs = outcome.dataset["field_leg"].values
    for number in range(len(in_contact)):
        seen = state(page)
        assert seen["map"] == number
        assert seen["maps"][number]["time"] == outcome.dataset["field_time"].values[number]
        assert seen["maps"][number]["leg"] == legs[number]
        assert seen["counts"] == np.bincount(classes(in_contact, number).ravel(), minlength=4).tolist()
        assert page.locator("#number-area").text_content() == f"{in_contact[number].sum()} sites"
        load = outcome.dataset["load"].values[outcome.dataset["leg"].values == legs[number]][0]
        assert page.locator("#number-load").text_content() == f"{load:.4g}"
        page.keyboard.press("ArrowRight")
    assert state(page)["counts"][LOST] > 0  # the unloading has lost some


def test_a_site_reads_height_pressure_and_age(tab, exported, outcome):
    page = tab(exported)
    dataset, last = outcome.dataset, state(page)["map"]
    in_contact, times = dataset["in_contact"].values, dataset["field_time"].values
    heights = dataset["heights"].values
    for number in (0, 4, last):
        for site in np.flatnonzero(in_contact[number])[:40:8].tolist():
            read = page.evaluate(f"asperity.site({site}, {number})")
            assert abs(read["height"] - heights.flat[site]) <= np.ptp(heights) / 65535
            history = in_contact[: number + 1].reshape(number + 1, -1)[:, site]
            changes = np.flatnonzero(np.diff(history))
            assert read["since"] == times[changes[-1] + 1 if changes.size else 0]
    pressed = asp.press(heights, asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0), load=150.0)
    for site in np.flatnonzero(in_contact[0]).tolist():
        read = page.evaluate(f"asperity.site({site}, 0)")["pressure"]
        assert read == pytest.approx(pressed.force.flat[site], abs=pressed.force.max() / 65535)
    sites = np.flatnonzero(in_contact[last]).tolist()
    total = page.evaluate(f"{sites}.reduce((sum, site) => sum + asperity.site(site).pressure, 0)")
    assert total == pytest.approx(50.0, rel=1e-4)

    kept = int(np.flatnonzero(in_contact.all(axis=0))[5])
    x, y = middle(state(page)["drawn"], kept, 64)
    box = page.locator("#map").bounding_box()
    page.mouse.move(box["x"] + x, box["y"] + y)
    assert state(page)["cursor"] == kept
    said = page.locator("#site").text_content()
    assert f"row {kept // 64}, column {kept % 64}" in said
    assert "since first touch: age 110" in said
    assert f"height {heights.flat[kept]:.4g}"[:10] in said


def test_keys_move_between_sites_and_zoom(tab, exported, outcome):
    page = tab(exported)
    touching = np.flatnonzero(outcome.dataset["in_contact"].values[-1])
    page.focus("#map")
    page.keyboard.press("n")
    assert state(page)["cursor"] == touching[0]
    page.keyboard.press("n")
    assert state(page)["cursor"] == touching[1]
    page.keyboard.press("p")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Shift+ArrowRight")
    column = min(63, touching[0] % 64 + 10)
    assert state(page)["cursor"] == (touching[0] // 64 + 1) * 64 + column
    assert state(page)["zoom"] == 1
    for _ in range(3):
        page.keyboard.press("+")
    zoomed = state(page)
    assert zoomed["zoom"] == pytest.approx(1.5**3)
    width = page.locator("#map").bounding_box()["width"]
    for place in middle(zoomed["drawn"], zoomed["cursor"], 64):  # still in view
        assert 0 <= place <= width
    page.keyboard.press("0")
    assert state(page)["zoom"] == 1
    said = page.locator("#map").get_attribute("aria-label")
    assert "64 × 64 sites" in said
    assert f"{touching.size}\u00a0sites in contact" in said


def test_two_fingers_zoom(tab, exported):
    page = tab(exported, viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True)
    box = page.locator("#map").bounding_box()
    x, y = box["x"] + 150, box["y"] + 160
    session = page.context.new_cdp_session(page)
    moves = [("touchMove", apart) for apart in (30, 50, 80)]
    for kind, apart in (("touchStart", 20), *moves, ("touchEnd", 0)):
        points = [{"x": x - apart, "y": y, "id": 1}, {"x": x + apart, "y": y, "id": 2}] if apart else []
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    drawn = state(page)["drawn"]
    assert 2.5 < state(page)["zoom"] <= 4.1
    assert drawn["left"] < -150
    page.click("#whole")
    assert state(page)["zoom"] == 1


def test_a_drag_on_the_curve_scrubs_and_play_runs_through_all_maps(tab, exported):
    page = tab(exported)
    box = page.locator("#curve").bounding_box()
    page.mouse.move(box["x"] + 75, box["y"] + 100)
    page.mouse.down()
    assert state(page)["map"] == 0
    before = pixels(page)
    page.mouse.move(box["x"] + box["width"] - 16, box["y"] + 100)
    page.mouse.up()
    last = len(state(page)["maps"]) - 1
    assert state(page)["map"] == last
    assert (pixels(page) != before).any()
    assert page.locator("#shown").text_content() == "t = 110"
    begun = page.evaluate("() => { document.querySelector('#play').click(); return asperity.state; }")
    assert (begun["playing"], begun["map"]) == (True, 0)
    until(page, "!asperity.state.playing")
    assert state(page)["map"] == last


def test_yielded_sites_are_marked_on_the_heights(tab, tmp_path):
    rough = asp.surfaces.gaussian((32, 32), seed=2)
    solid = asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0).with_hardness(1.0)
    slides = [asp.protocols.Hold(10.0), asp.protocols.Slide(4.0, velocity=1.0)]
    contact = asp.press(rough, solid, load=60.0)
    history = asp.age(contact, [1.0, 10.0, 14.0], protocol=slides, fields_at=[0.0, 14.0])
    yielding = history.dataset  # maps before and after a slide by four sites
    recording = recorded(yielding, None, job="yields", title="yields")
    recording.end = ending(yielding, ())
    path = tmp_path / "page.html"
    path.write_text(exported_page(recording.messages(), title="yields"), encoding="utf-8")
    page = tab(path.as_uri())
    assert page.locator("#number-displacement").text_content() == "4\u00a0lattice spacings"
    page.select_option("#colored", "heights")
    color = page.evaluate("theme().yielded")
    depths = yielding["permanent_indentation"].values > 0
    for number, moved in ((0, 0), (1, -4)):
        page.focus("#moment")
        page.keyboard.press("End" if number else "Home")
        yielded = np.roll(depths[number], moved, axis=1)
        picture, drawn = pixels(page), state(page)["drawn"]
        for site in range(yielded.size):
            x, y = middle(drawn, site, 32)
            assert (picture[int(y), int(x)] == color).all() == yielded.flat[site]
        words = f"{yielded.sum()}\u00a0{'site' if yielded.sum() == 1 else 'sites'}"
        assert f"{words} yielded" in page.locator("#legend").text_content()
        assert f"has yielded at {words}" in page.locator("#map").get_attribute("aria-label")
    site = int(np.flatnonzero(yielded)[0])
    assert "has yielded" in page.evaluate(f"app.scene.describe(1, {site})")
    # A row without a map has no patches, and the others have those of their maps.
    known = [row for row in rows(page)["patches"] if row == row and row is not None]
    assert known == yielding["patches"].values.tolist()


def test_table_picture_and_animation_are_read_by_others(tab, exported, outcome):
    page = tab(exported)
    with page.expect_download() as saved:
        page.click('[data-save="csv"]')
    lines = saved.value.path().read_text().splitlines()
    names = lines[0].split(",")
    assert names[:3] == ["time [1 / (stiffness unit * R unit)]", "leg", "area [sites]"]
    table = np.genfromtxt(lines[1:], delimiter=",")  # every digit
    for name, there in (("time", 0), ("area", 2), ("residual", None), ("patches", None)):
        column = table[:, names.index(name) if there is None else there]
        np.testing.assert_array_equal(column, outcome.dataset[name])
    with page.expect_download() as saved:
        page.click('[data-save="png"]')
    with Image.open(io.BytesIO(saved.value.path().read_bytes())) as picture:
        assert picture.size == (2080, 1180)
    with page.expect_download() as saved:
        page.click('[data-save="gif"]')
    animation = GifImageFile(io.BytesIO(saved.value.path().read_bytes()))
    in_contact = outcome.dataset["in_contact"].values
    assert (animation.size, animation.n_frames) == ((1040, 590), len(in_contact))
    assert animation.info["loop"] == 0
    palette = colors(page)
    for number in (0, 5, len(in_contact) - 1):
        animation.seek(number)
        frame = np.asarray(animation.convert("RGB"))[50:490, 30:480]
        drawn = [(frame == palette[one]).all(axis=-1).sum() for one in (KEPT, NEW, LOST)]
        counts = np.bincount(classes(in_contact, number).ravel(), minlength=4)[1:]
        scale = (448 / 64) ** 2  # pixels of a site
        np.testing.assert_allclose(drawn[1:], counts[1:] * scale, rtol=0.1, atol=40)


def page_of(folder, masks, times=None, campaign=None):
    """Address of the page of a scene that nobody computed: heights are 0, and each map is known."""
    times = [0.0, *(10.0 ** np.arange(len(masks) - 1)).tolist()] if times is None else times
    columns, areas = ["time", "leg", "area"], [float(mask.sum()) for mask in masks]
    facts: dict[str, Any] = dict.fromkeys(("config", "spacing", "length_unit", "cell"))
    facts |= {"title": "made", "toml": "", "python": "", "shape": list(masks[0].shape)}
    facts |= {"names": {}, "columns": columns, "column_units": dict.fromkeys(columns, "1")}
    facts["units"] = dict.fromkeys(("time", "area", "load", "pressure", "height", "separation"), "1")
    facts["labels"] = {name: one.label for name, one in select("series").items() if name in columns}
    facts |= {"switches": [], "height_range": [0.0, 1.0]}
    recording = Recording("made", facts | {"last_time": times[-1]}, np.zeros(masks[0].shape, np.uint16))
    recording.rows = [[time, 0.0, area] for time, area in zip(times, areas, strict=True)]
    if any(areas):
        maps = zip(times, masks, strict=True)
        recording.maps = [map_of(time, 0, mask, mask.astype(float)) for time, mask in maps]
    recording.end = {"kind": "done", "limit": None, "rows": []}
    messages = [*([] if campaign is None else [campaign]), *recording.messages()]
    path = folder / f"made{len(messages)}.html"
    path.write_text(exported_page(messages, title="made"), encoding="utf-8")
    return path.as_uri()


def test_no_contact_of_a_large_map_is_lost_and_zoom_shows_each(tab, tmp_path):
    draws = np.random.default_rng(0)
    first = draws.random((1024, 1024)) < 2e-4
    later = first | (draws.random((1024, 1024)) < 2e-4)
    page = tab(page_of(tmp_path, [first, later]))
    whole = state(page)
    assert whole["side"] == 2
    free = colors(page)[0]
    marked = (pixels(page) != free).any(axis=-1)
    for site in np.flatnonzero(later).tolist():
        x, y = middle(whole["drawn"], site, 1024)
        near = marked[max(0, int(y) - 1) : int(y) + 2, max(0, int(x) - 1) : int(x) + 2]
        assert near.any()
    box = page.locator("#map").bounding_box()
    new = np.flatnonzero(later & ~first)
    site = int(new[new.size // 2])
    x, y = map(round, middle(whole["drawn"], site, 1024))  # a pointer is at whole pixels
    page.mouse.move(box["x"] + x, box["y"] + y)
    for _ in range(12):
        page.mouse.wheel(0, -150)
    until(page, "asperity.state.zoom > 20")
    page.wait_for_timeout(100)
    seen = state(page)
    assert seen["side"] == 1
    at_x, at_y = middle(seen["drawn"], site, 1024)
    assert max(abs(at_x - x), abs(at_y - y)) < seen["zoom"]  # what lay below the pointer still does
    np.testing.assert_array_equal(pixels(page)[int(at_y), int(at_x)], colors(page)[NEW])
    page.mouse.down()
    page.mouse.move(box["x"] + x + 40, box["y"] + y + 25)
    page.mouse.up()
    moved = middle(state(page)["drawn"], site, 1024)
    assert moved == pytest.approx((at_x + 40, at_y + 25), abs=1)


def test_curves_of_a_campaign_stand_behind_its_run(tab, tmp_path):
    mask = np.zeros((8, 8), dtype=bool)
    mask[2:4, 3:6] = True
    runs = [{"id": f"run{number}", "state": "done", "load": 10.0 * number} for number in range(3)]
    arrays = {f"time.run{number}": np.array([0.0, 1.0, 10.0]) for number in range(3)}
    arrays |= {f"area.run{number}": np.array([1.0, 2.0, 3.0]) * (number + 1) for number in range(3)}
    campaign = pack(
        {"kind": "campaign", "path": "camp", "parameters": ["load"], "units": {}, "runs": runs}, arrays
    )
    page = tab(page_of(tmp_path, [mask, mask], campaign=campaign))
    alone = tab(page_of(tmp_path, [mask, mask]))
    assert state(page)["runs"] == 3
    cells = [text.strip() for text in page.locator("#campaign td").all_inner_texts()]
    assert cells == ["run0", "0", "run1", "10", "run2", "20"]
    ink = [(pixels(one, "#curve").max(axis=-1) < 200)[:, 80:].sum() for one in (page, alone)]
    assert ink[0] > ink[1] + 300  # three more lines


def test_a_run_without_maps_shows_its_heights(tab, tmp_path):
    page = tab(page_of(tmp_path, [np.zeros((8, 8), dtype=bool)] * 3, times=[0.0, 1.0, 10.0]))
    assert len(state(page)["maps"]) == 3
    assert page.locator("#number-area").text_content() == "0 sites"
    assert "kept no maps" in page.locator("#legend").text_content()


def test_a_crowded_map_shows_its_area(tab, tmp_path):
    draws = np.random.default_rng(1)
    mask = draws.random((1024, 1024)) < 0.25
    mask[100:200, 300:400] = True
    mask[500:600, 700:800] = False
    page = tab(page_of(tmp_path, [mask]))
    drawn, marked = state(page)["drawn"], (pixels(page) != colors(page)[0]).any(axis=-1)
    whole = marked[: int(1024 * drawn["down"])]
    assert whole.mean() == pytest.approx(mask.mean(), abs=0.02)
    step = drawn["across"]
    patch = [slice(int(low * step) + 2, int(high * step) - 2) for low, high in ((100, 200), (300, 400))]
    assert marked[tuple(patch)].all()
    gap = [slice(int(low * step) + 2, int(high * step) - 2) for low, high in ((500, 600), (700, 800))]
    assert not marked[tuple(gap)].any()
    assert "the true area" in page.locator("#legend").text_content()


def test_a_line_contact_is_drawn_against_time(tab, tmp_path):
    masks = [np.zeros((1, 300), dtype=bool) for _ in range(5)]
    for number, mask in enumerate(masks):
        mask[0, 100 : 103 + 10 * number] = True
    page = tab(page_of(tmp_path, masks))
    drawn, picture, palette = state(page)["drawn"], pixels(page), colors(page)
    for number in range(len(masks)):
        y = int(drawn["top"] + (number + 0.5) * drawn["down"])
        seen = [picture[y, int(drawn["left"] + (site + 0.5) * drawn["across"])] for site in range(3, 297)]
        expected = palette[classes(np.array(masks), number)[0, 3:297]]
        np.testing.assert_array_equal(seen, expected)


def luminance(color):
    """Relative luminance of WCAG 2 of colors from 0 to 255, last axis."""
    part = np.asarray(color) / 255
    linear = np.where(part <= 0.04045, part / 12.92, ((part + 0.055) / 1.055) ** 2.4)
    return linear @ [0.2126, 0.7152, 0.0722]


def contrast(one, other):
    low, high = sorted([luminance(one), luminance(other)])
    return (high + 0.05) / (low + 0.05)


# G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, IEEE Trans. Vis. Comput. Graph. 15, 1291 (2009): full
# loss of the long, the middle and the short cones, for linear red, green and blue.
CONES = np.reshape(
    [
        *(0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998),
        *(0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881),
        *(1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.303900),
    ],
    (3, 3, 3),
)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_sites_have_colors_that_are_told_apart_in_gray_by_all_eyes_and_read(tab, exported, outcome, scheme):
    page = tab(exported, color_scheme=scheme)
    expected = classes(outcome.dataset["in_contact"].values, state(page)["map"]).ravel()
    picture, palette, drawn = pixels(page), colors(page), state(page)["drawn"]
    for site in np.flatnonzero(expected).tolist() + list(range(0, expected.size, 97)):
        x, y = middle(drawn, site, 64)
        np.testing.assert_array_equal(picture[int(y), int(x)], palette[expected[site]])
    assert np.diff(np.sort(luminance(palette) ** (1 / 2.2))).min() > 0.15  # gray: steps of lightness
    linear = (palette / 255) ** 2.2
    for cones in CONES:
        seen = np.clip(linear @ np.transpose(cones), 0, 1) ** (1 / 2.2)
        apart = np.linalg.norm(seen[:, np.newaxis] - seen, axis=-1)
        assert apart[~np.eye(4, dtype=bool)].min() > 0.25
    texts = [(text, ground) for text in ("ink", "muted", "wrong") for ground in ("page", "panel")]
    lines = [("accent", "page"), ("curve", "page")]
    for name, ground in (*texts, ("button", "button-ink"), *lines):
        one, other = (page.evaluate(f"theme().rgb({color!r})") for color in (name, ground))
        assert contrast(one, other) >= (3 if (name, ground) in lines else 4.5)
    paper = page.evaluate("theme().rgb('page')")
    background = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert background == f"rgb({', '.join(map(str, paper))})"


def test_everything_has_a_name_and_a_phone_needs_no_sideways_scrolling(tab, exported):
    phone = {"has_touch": True, "is_mobile": True, "device_scale_factor": 2}
    page = tab(exported, viewport={"width": 390, "height": 844}, **phone)
    wide = page.evaluate("[document.documentElement.scrollWidth, innerWidth]")
    assert wide[0] <= wide[1] == 390
    tops = [page.locator(one).bounding_box()["y"] for one in ("#map", "#curve")]
    assert tops[0] + 300 < tops[1]
    assert page.locator("#moment").is_visible()
    nameless = page.evaluate(
        """[...document.querySelectorAll("button, input, select, textarea, canvas[tabindex], [role=img]")]
        .filter(one => !(one.getAttribute("aria-label") || one.labels?.length || one.textContent.trim()))
        .map(one => one.outerHTML)"""
    )
    assert nameless == []
    assert page.evaluate("document.documentElement.lang") == "en"
    assert page.title() == 'Unloading <&> "quoted" · Asperity'
