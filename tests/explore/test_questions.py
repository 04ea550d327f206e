"""Questions other than a run on the page: asked, refused at their fields, and opened from a folder."""

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.app.cli import main
from asperity.app.explore.folders import entries, open_entry
from tests.campaign.conftest import done_here
from tests.campaign.test_questions import SLIDING
from tests.explore.conftest import Server

SURFACE = {"kind": "spectral", "shape": [32, 32], "rms_height": 0.05, "spacing": [0.5], "unit": "um"}
SOLID = {"kind": "half_space", "modulus": 1e9, "branches": [[0.3, 0.01], [0.4, 1.0]]}
PRESSED: dict[str, Any] = {"surface": SURFACE, "solid": SOLID, "contact": {"pressure": 2e7}}


def numbers(table: str, name: str) -> list[float]:
    return [float(row[name]) for row in csv.DictReader(table.splitlines())]


def test_friction_against_speed_is_asked_and_answered_with_a_figure(server: Server) -> None:
    asked = PRESSED | {"sliding": {"speeds": [1e-6, 1e-3], "per_decade": 1}}
    with server.page() as page:
        assert {*page.hello["questions"]} == {"prediction", "law", "sliding"}
        assert page.hello["questions"]["sliding"]["keys"]["speeds"]["required"]
        page.send("run", config=asked)
        answer, _ = page.until("answer", "failed", "mistakes")[-1]
        heights = asp.surfaces.spectral((32, 32), rms_height=0.05, spacing=0.5)
        track = asp.surfaces.Surface(heights, "um", (0.5, 0.5), "um")
        solid = asp.solids.half_space(modulus=1e9, branches=[(0.3, 0.01), (0.4, 1.0)])
        right = asp.steady_sliding(solid, track, pressure=2e7, speeds=[1e-6, 1e-3], per_decade=1)
        name = "hysteresis_friction_coefficient"
        assert numbers(answer["table"], name) == right[name].values.tolist()
        assert answer["picture"].lstrip().startswith("<?xml")
        assert answer["config"]["sliding"]["speeds"] == [1e-6, 1e-3]
        assert "largest friction" in str(answer["rows"])
        page.send("run", config=asked)  # it is kept
        assert page.until("answer")[-1][0] | {"sequence": 0} == answer | {"sequence": 0}
        for wrong, where in (
            ({"sliding": {"speeds": [-1.0]}}, "sliding.speeds"),
            ({"sliding": {}}, "sliding.speeds"),
            ({"sliding": {"speeds": [1e-6, 1e-3]}, "contact": {}}, "contact.pressure"),
            ({"sliding": {"speeds": [1e-3, 1e-6]}}, "sliding.speeds"),
        ):
            page.send("run", config=PRESSED | wrong)
            refused, _ = page.until("answer", "failed", "mistakes")[-1]
            assert [one["where"] for one in refused["mistakes"]] == [where]


def test_a_prediction_is_asked_and_shown_as_it_ages(server: Server) -> None:
    asked = PRESSED | {"prediction": {"ramp": "1 s"}, "aging": {"first": 3.0, "last": 100.0}}
    with server.page() as page:
        messages = page.ran(asked)
    done = messages[-1][0]
    assert done["kind"] == "done"
    assert "95 %" in str(done["rows"])
    scene = next(header for header, _ in messages if header["kind"] == "scene")
    assert "[prediction]" in scene["toml"]


@pytest.fixture(scope="module", name="folder")
def answers(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a law, and with a campaign of steady sliding."""
    folder = tmp_path_factory.mktemp("answers")
    heights = asp.surfaces.spectral((32, 32), rms_height=0.05, spacing=0.5)
    np.savetxt(folder / "scan.txt", heights)
    units = ("--file-unit", "um", "--pixel-size", "0.5", "--length-unit", "um")
    words = ["--surface", str(folder / "scan.txt"), *units, "--modulus", "1GPa", "--figures", "", "-q"]
    asked = ("--pressures", "1MPa", "9MPa", "--per-decade", "3", "--out", str(folder / "law"))
    assert main(["law", *words, *asked]) == 0
    (folder / "campaign").mkdir()
    done_here(folder / "campaign", f"{SLIDING}pressure = ['20 MPa', '40 MPa']")
    return folder


def test_answers_in_a_folder_are_shown_as_they_were_written(folder: Path) -> None:
    found = {one["path"]: one["kind"] for one in entries(folder)}
    assert found == {"law": "law", "campaign/out": "campaign"}
    opened = open_entry(folder, "law")
    assert opened.recording is not None
    assert opened.recording.end is not None
    written, name = (folder / "law" / "law.csv").read_text(), "stiffness_Pa_per_m"
    assert numbers(opened.recording.end["table"], name) == numbers(written, name)
    assert "approach" in str(opened.recording.end["rows"])
    opened = open_entry(folder, "campaign/out")
    assert opened.campaign is not None
    assert opened.recording is not None
    header, arrays = opened.campaign
    assert header["parameters"] == ["pressure", "seed"]
    for run, pressure in zip(header["runs"], ("20 MPa", "40 MPa"), strict=True):
        assert arrays[f"time.{run['id']}"].tolist() == pytest.approx([1e-6, 1e-5, 1e-4, 1e-3])
        recording = open_entry(folder, f"campaign/out/{run['id']}").recording
        assert recording is not None
        assert recording.end is not None
        assert recording.end["title"] == f"pressure = {pressure}"
