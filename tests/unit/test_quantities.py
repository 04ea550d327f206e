"""The table of recorded quantities: what it says is so, in every table that is read from it."""

from __future__ import annotations

import csv
import math
import re
from pathlib import Path

import numpy as np
import pytest

import asperity as asp
from asperity.app.cli import main
from asperity.app.explore.folders import open_entry
from asperity.results.quantities import QUANTITIES, select
from tests.campaign.conftest import do_here, written

P = asp.protocols
ROUGH = np.random.default_rng(1).normal(size=(8, 8))
SPRINGS = asp.solids.spring_lattice(k0=1.0, k1=3.0)
SCAN = asp.surfaces.Surface(ROUGH, unit="um", pixel_size=(2.0, 1.0), length_unit="um")
LAYER = asp.solids.layer(modulus=1e9, poisson=0.3, thickness=1e-5)


@pytest.mark.parametrize(
    ("heights", "solid"),
    [(ROUGH, SPRINGS), (ROUGH.ravel(), SPRINGS), (ROUGH, asp.solids.half_space(modulus=2.0))],
    ids=["springs", "line", "half-space"],
)
def test_the_rms_gap_is_that_of_the_heights_at_first_touch_and_nothing_in_full_contact(
    heights: np.ndarray, solid: asp.solids.Solid
) -> None:
    # An undeformed body at the highest site: the gap is max(h) - h.
    touching = asp.press(heights, solid, load=0.0)
    expected = math.hypot(np.std(heights), np.max(heights) - np.mean(heights))
    assert touching.rms_gap == pytest.approx(expected, rel=1e-12)
    assert asp.press(heights, solid, load=1e6).rms_gap == 0.0
    some = asp.press(heights, solid, load=20.0)
    expected = float(np.linalg.norm(some.u - heights)) / math.sqrt(heights.size)
    assert some.rms_gap == pytest.approx(expected, rel=1e-12)


def test_the_rms_gap_is_in_the_tables_of_runs_campaigns_and_the_page(tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = "run --surface gaussian --shape 8 8 --load 6 --times 1 10 --maps-at 0 1 10 --quiet"
    assert main([*words.split(), "--figures", "", "--out", str(out)]) == 0
    data = asp.results.load(out)
    known = ((data["u"] - data["heights"]) ** 2).mean(["y", "x"]).values ** 0.5
    said = {"long_name": "root mean square of the gap over all sites", "units": "height unit"}
    assert data["rms_gap"].attrs == said
    with (out / "aging.csv").open(newline="") as stream:
        assert [float(row["rms_gap"]) for row in csv.DictReader(stream)] == pytest.approx(known, rel=1e-12)
    recording = open_entry(tmp_path, "out").recording
    assert recording is not None
    assert recording.scene is not None
    assert recording.scene["labels"]["rms_gap"] == "rms gap"
    assert recording.scene["column_units"]["rms_gap"] == "height unit"
    at = recording.scene["columns"].index("rms_gap")
    assert [row[at] for row in recording.rows] == data["rms_gap"].values.tolist()

    text = "[surface]\nshape = [8, 8]\n[aging]\ntimes = [1.0, 10.0]\n[sweep]\nload = [6.0]\nseeds = 2\n"
    do_here(asp.campaign.read_plan(written(tmp_path, text)), tmp_path / "camp")
    swept = asp.campaign.open(tmp_path / "camp")
    assert swept["rms_gap"].sel(load=6.0, seed=0).values == pytest.approx(known, rel=1e-12)
    assert asp.campaign.table(swept)["final_rms_gap"][0] == pytest.approx(known[-1], rel=1e-12)
    assert swept["rms_gap_mean"].dims == ("load", "time")


HISTORIES: dict[str, asp.History] = {
    "sites": asp.age(asp.press(ROUGH, SPRINGS, load=8.0), [1.0], fields_at=[1.0]),
    "continua": asp.age(asp.press(SCAN, LAYER, load=1e-4), [1.0], fields_at=[1.0]),
    "yielding": asp.age(asp.press(ROUGH, SPRINGS.with_hardness(1.0), load=8.0), [1.0], fields_at=[1.0]),
    "sliding": asp.age(
        asp.press(ROUGH, SPRINGS, load=8.0), [1.0], protocol=[P.Slide(2.0, velocity=1.0)], fields_at=[1.0]
    ),
}


@pytest.mark.parametrize("kind", HISTORIES)
def test_a_history_has_what_the_table_says_each_with_its_name_and_unit(kind: str) -> None:
    history = HISTORIES[kind]
    base = "continua" if kind == "continua" else "sites"
    said = select(of=("all", base, kind))
    here = set(map(str, history.dataset.variables))
    optional = {"branch", "leg", "field_leg", "clustering", "displacement"}  # of several branches; of legs
    assert said.keys() - select("contact") - optional <= here <= said.keys()
    assert set(map(str, history.final.dataset.variables)) >= select("contact", of=("all", base)).keys()
    for name in here - {"branch"}:
        assert history.dataset[name].attrs["long_name"] == said[name].long_name
        assert history.dataset[name].attrs["units"]
        assert not said[name].whole or history.dataset[name].dtype.kind == "i"


def test_forces_of_springs_are_kept_and_follow_from_the_fields_where_they_are_not() -> None:
    history = HISTORIES["sites"]
    kept = history.dataset.isel(field_time=0)
    np.testing.assert_array_equal(kept["force"], history.final.force)
    # k0 (u - mean of the four neighbors) and k1 (u - u0), site by site.
    u = kept["u"].values
    around = sum(np.roll(u, way, axis) for axis in (0, 1) for way in (1, -1))
    np.testing.assert_allclose(kept["force"], 4 * u - around + 3.0 * (u - kept["u0"].values), atol=1e-8)
    with_them = asp.analysis.patch_table(kept)
    changed = kept.assign(force=2 * kept["force"])  # what is recorded is read
    np.testing.assert_array_equal(asp.analysis.patch_table(changed)["load"], 2 * with_them["load"])
    before = kept.drop_vars(["force", "rms_gap"])  # as versions up to 0.4.7 wrote it
    np.testing.assert_allclose(asp.analysis.patch_table(before)["load"], with_them["load"], rtol=1e-8)


def test_histories_without_forces_and_gaps_are_shown(tmp_path: Path) -> None:
    dataset = HISTORIES["sites"].dataset
    asp.results.save(dataset.drop_vars(["force", "rms_gap"]), tmp_path / "old.zarr")
    asp.results.save(dataset, tmp_path / "new.zarr")
    old, new = (open_entry(tmp_path, name).recording for name in ("old.zarr", "new.zarr"))
    assert old is not None
    assert new is not None
    assert old.scene is not None
    assert "rms_gap" not in old.scene["columns"]
    np.testing.assert_array_equal(old.maps[0].arrays["pressure"], new.maps[0].arrays["pressure"])


def test_the_page_on_notation_has_every_quantity_with_its_symbol() -> None:
    page = (Path(__file__).parents[2] / "docs" / "notation.md").read_text(encoding="utf-8")
    symbols: dict[str, set[str]] = {}
    for line in page.splitlines():
        if line.startswith("| ") and len(cells := [cell.strip() for cell in line.split("|")[1:-1]]) == 5:
            _, symbol, equation, names, _ = cells
            told = symbol.replace("*", "") + (f", Eq. {equation}" if equation else "")
            for name in re.findall(r"`(\w+)`", names):
                symbols.setdefault(name, set()).add(told)
    assert not [one.name for one in QUANTITIES if one.name not in symbols]
    wrong = [one for one in QUANTITIES if one.symbol and one.symbol not in symbols[one.name]]
    assert not wrong
