"""What a folder holds, and that nothing leads out of it."""

from __future__ import annotations

import base64
import gzip
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

import asperity as asp
import asperity.app.campaign as campaign
from asperity.app.cli import main
from asperity.app.config import config_from
from asperity.app.explore.export import exported_page
from asperity.app.explore.folders import entries, inside, kind_of, open_entry
from asperity.app.explore.scene import unpack
from asperity.base.rows import aligned
from tests.campaign.conftest import do_here, written
from tests.explore.conftest import heights_of, maps
from tests.refusals import refuses


def shown(root, name):
    """The messages that a page gets of a run."""
    recording = open_entry(root, name).recording
    assert recording is not None
    return [unpack(message) for message in recording.messages()]


def test_results_are_found_at_any_depth_and_links_are_not_followed(results_folder: Path) -> None:
    found = [(one["path"], one["kind"], one["title"]) for one in entries(results_folder)]
    assert found == [("a run", "run", "a run"), ("deeper/campaign", "campaign", "deeper/campaign")]
    assert [one["path"] for one in entries(results_folder / "a run")] == ["."]
    assert entries(results_folder / "a run")[0]["title"] == "a run"


def test_a_name_stays_in_its_folder_and_names_a_result_that_is_whole(
    results_folder: Path, tmp_path: Path
) -> None:
    for name in ("a/../..", "/etc/passwd", "link/history.zarr", "a\\..\\b", "x\0y"):
        with refuses("path"):
            inside(results_folder, name)
    for name in ("nothing", "deeper", "deeper/campaign/nothing"):
        with refuses("path", name):
            open_entry(results_folder, name)
    shutil.copytree(results_folder / "a run", tmp_path / "run")
    shutil.rmtree(tmp_path / "run" / "history.zarr" / "area")
    with refuses("path"):
        open_entry(tmp_path, "run")


def test_a_run_is_shown_as_it_was_stored(results_folder: Path) -> None:
    dataset = asp.results.load(results_folder / "a run")
    assert open_entry(results_folder, "a run").campaign is None
    messages = shown(results_folder, "a run")
    (scene, _), (_, arrays), (done, _) = messages
    areas = arrays["rows"][:, scene["columns"].index("area")]
    assert np.array_equal(areas, dataset["area"].values)
    for index, mask in enumerate(dataset["in_contact"].values):
        assert np.array_equal(maps(messages)[index][1], mask)
    assert scene["toml"] == dataset.attrs["config"]
    assert done["limit"]["area"] == dataset.attrs["relaxed_area"]
    summary = (results_folder / "a run" / "summary.txt").read_text(encoding="utf-8")
    assert aligned(done["rows"]) + "\n" == summary  # one list, whoever shows it
    rate = asp.fits.growth_rate(dataset["time"].values, dataset["area"].values)
    low, high = (100 * np.log(10) * end for end in rate.interval("B"))
    growth = f"{100 * np.log(10) * rate.B:.1f} % of A(0) per decade (95 %: {low:.1f} to {high:.1f}), t = "
    assert dict(done["rows"])["growth"].startswith(growth)
    found: dict[str, object] = {}
    exec(scene["python"], found)
    history = found["history"]
    assert isinstance(history, asp.History)
    assert np.array_equal(history.dataset["area"].values, dataset["area"].values)


def test_a_saved_history_is_shown_without_a_configuration(tmp_path: Path) -> None:
    rough = asp.surfaces.self_affine(16, seed=0)
    contact = asp.press(rough, asp.solids.half_space(modulus=2.0, branches=[(0.5, 1.0)]), pressure=0.01)
    history = asp.age(contact, [0.1, 1.0, 10.0], fields_at=[0.0, 10.0])
    history.save(tmp_path / "mine.zarr")
    (scene, _), (_, arrays), (done, _) = shown(tmp_path, "mine.zarr")
    assert (scene["config"], scene["toml"]) == (None, "")
    assert arrays["rows"].shape == (4, len(scene["columns"]))
    assert done["limit"] is None
    assert kind_of(tmp_path) == ""


def test_a_campaign_is_shown_with_its_curves_and_any_of_its_runs(results_folder: Path) -> None:
    folder = results_folder / "deeper" / "campaign"
    opened = open_entry(results_folder, "deeper/campaign")
    assert opened.campaign is not None
    header, curves = opened.campaign
    together = campaign.open(folder)
    assert header["parameters"] == ["load", "seed"]
    assert len(header["runs"]) == 4
    for run in header["runs"]:
        assert run["state"] == "done"
        known = together.sel(load=run["load"], seed=run["seed"])
        assert np.array_equal(curves[f"area.{run['id']}"], known["area"].values)
        messages = shown(results_folder, f"deeper/campaign/{run['id']}")
        scene, _ = messages[0]
        kept = campaign.fields(folder, load=run["load"], seed=run["seed"])
        assert heights_of(messages[0]) == pytest.approx(kept["heights"].values, abs=1e-3)
        for index, mask in enumerate(kept["in_contact"].values):
            assert np.array_equal(maps(messages)[index][1], mask)
        assert scene["title"] == f"load = {run['load']:g}, seed = {run['seed']}"
        assert f"load = {run['load']}" in scene["toml"]


def test_a_campaign_of_runs_without_fields_shows_their_surfaces(results_folder: Path, tmp_path: Path) -> None:
    text = """
    surface = { kind = "spectral", shape = [16, 16], rms_slope = 0.1, spacing = [1e-6], unit = "m" }
    solid = { kind = "half_space", modulus = 3e9, branches = [[0.5, 1.0]] }
    aging = { first = 0.1, last = 10.0, per_decade = 2 }
    output.maps_at = []
    sweep = { pressure = [1e6, 3e6] }
    """
    do_here(campaign.read_plan(written(tmp_path, text)), tmp_path / "campaign")
    first, (_, rows), (done, _) = shown(tmp_path, "campaign")
    scene, _ = first
    heights = campaign.load_plan(tmp_path / "campaign").runs[0].config.surface.build().in_meters()[0]
    assert heights_of(first) == pytest.approx(heights, abs=1e-4 * np.ptp(heights))
    assert scene["units"]["pressure"] == "Pa"
    assert scene["spacing"] == [1e-6, 1e-6]
    area = rows["rows"][:, scene["columns"].index("contact_area")]
    assert area == pytest.approx(rows["rows"][:, scene["columns"].index("area")] * 1e-12)
    assert done["limit"]["contact_area"] == pytest.approx(done["limit"]["area"] * 1e-12)


def test_an_exported_page_holds_everything(results_folder: Path) -> None:
    opened = open_entry(results_folder, "a run")
    assert opened.recording is not None
    messages = list(opened.recording.messages())
    page = exported_page(messages, title="a <run>")
    assert "<title>a &lt;run&gt;</title>" in page
    assert not re.search(r"<(script|link|img)[^>]*\s(src|href)=[\"'](?!data:)", page)
    assert "connect-src data: blob:" in page
    (packed,) = re.findall(r'<script type="application/octet-stream" id="recording">([^<]*)</script>', page)
    stream = gzip.decompress(base64.b64decode(packed))
    found = []
    while stream:
        length = int.from_bytes(stream[:8], "little")
        found.append(stream[8 : 8 + length])
        stream = stream[8 + length :]
    assert found == messages


def test_surfaces_are_read_from_known_places_alone(tmp_path: Path) -> None:
    pytest.importorskip("uvicorn", reason="needs the extra explore")
    from asperity.app.explore.server import Places

    shown, dropped, elsewhere = (tmp_path / name for name in ("shown", "dropped", "elsewhere"))
    for folder in (shown, dropped, elsewhere):
        folder.mkdir()
        (folder / f"{folder.name}.npy").touch()
        (folder / "both.npy").touch()
    places = Places(shown, dropped)
    assert places.find("both.npy") == shown / "both.npy"
    assert places.find("dropped.npy") == dropped / "dropped.npy"
    assert places.find(str(dropped / "both.npy")) == dropped / "both.npy"
    path = str(elsewhere / "elsewhere.npy")
    with refuses("path", "elsewhere.npy"):
        Places(None, dropped).find("elsewhere.npy")
    # A run that the user opened may lie beside its surface's folder; then that one file is known.
    places.allow(config_from({"surface": {"path": path}}, {}, None))
    assert places.find(path) == elsewhere / "elsewhere.npy"
    (shown / "link.npy").symlink_to(elsewhere / "both.npy")
    with refuses("path", "link.npy"):
        places.find("link.npy")


def test_a_prediction_of_a_ramp_with_a_strength_opens_with_its_friction(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    heights = asp.surfaces.spectral((32, 32), hurst=0.8, roll_off=8.0, cutoff=2.0, rms_height=0.05, seed=1)
    np.savetxt("scan.txt", heights)
    scan = "--surface scan.txt --file-unit um --pixel-size 1um --tilt none --quiet"
    solid = "--young 3GPa --pressure 1MPa --ramp 2s --work-of-adhesion 0.05J/m^2"
    drawn = ["--branch", "0.2 30s", "--figures", "", "--out", "found"]
    assert main([*f"predict {scan} {solid} --shear-strength 40MPa".split(), *drawn]) == 0
    recording = open_entry(tmp_path, "found").recording
    assert recording is not None
    assert recording.scene is not None
    assert recording.scene["shear_strength"] == 4e7
    assert len(recording.rows) > 3
    remarks = [line for line in Path("found/summary.txt").read_text("utf-8").split("\n") if "remark" in line]
    assert any("pull_off" in line for line in remarks)
