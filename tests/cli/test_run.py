"""``asperity run``: what it writes, and that it can be run again."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest

from asperity import age, observe, press, relax, results
from asperity.solids import spring_lattice
from asperity.surfaces import exponential, gaussian, read, self_affine, spectral
from tests.cli.conftest import SMALL, Asperity

BRIEF = ("--times", "1", "--maps-at", "", "--quiet")
"""One time, no map, no word."""


def test_all_files_are_there(finished: Path) -> None:
    assert sorted(p.name for p in finished.iterdir()) == [
        "aging.csv",
        "aging.png",
        "config.toml",
        "contacts.png",
        "history.zarr",
        "patches.csv",
        "patches.png",
        "summary.txt",
    ]
    assert list(finished.parent.iterdir()) == [finished]


def test_the_history_is_that_of_the_verbs(finished: Path) -> None:
    dataset = results.load(finished / "history.zarr")
    assert dataset.identical(results.load(finished))
    contact = press(gaussian((32, 32), seed=7), spring_lattice(k0=1.0, k1=3.0), load=20.5)
    times = np.geomspace(1e-3, 10.0, 9)
    history = age(contact, times, rtol=2e-3, fields_at=dataset["field_time"].values.tolist())
    np.testing.assert_array_equal(dataset["area"], history.dataset["area"])
    np.testing.assert_array_equal(dataset["in_contact"], history.dataset["in_contact"])
    limit = relax(contact)
    assert dataset.attrs["relaxed_area"] == limit.area
    np.testing.assert_array_equal(dataset["in_contact_relaxed"], limit.in_contact)
    assert json.loads(dataset.attrs["surface"])["seed"] == 7
    assert dataset.attrs["config"] == (finished / "config.toml").read_text()
    assert dataset["field_time"].values[0] == 0
    assert dataset["field_time"].size == 6


def test_the_table_of_patches_has_a_row_a_map(finished: Path) -> None:
    dataset = results.load(finished / "history.zarr")
    with (finished / "patches.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [float(row["time"]) for row in rows] == dataset["field_time"].values.tolist()
    for name in ("patches", "perimeter", "births", "gained_by_expansion", "mean_contact_age"):
        np.testing.assert_array_equal([float(row[name]) for row in rows], dataset[name])
    for share in (0.05, 0.5, 1.0):
        for name in ("contact_age", "contact_pressure"):
            there = [float(row[f"{name}_{100 * share:g}_percent"]) for row in rows]
            np.testing.assert_array_equal(there, dataset[name].sel(quantile=share))


def test_the_table_holds_the_history(finished: Path) -> None:
    dataset = results.load(finished / "history.zarr")
    with (finished / "aging.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert list(rows[0])[:6] == ["time", "area", "area_ratio", "load", "separation", "energy"]
    assert list(rows[0])[6:] == ["approach", "contact_fraction", "residual", "rms_gap"]
    for name in set(rows[0]) - {"area_ratio"}:
        np.testing.assert_array_equal([float(row[name]) for row in rows], dataset[name])
    ratio = dataset["area"] / dataset["area"][0]
    np.testing.assert_array_equal([float(row["area_ratio"]) for row in rows], ratio)


def test_a_run_repeated_from_its_own_configuration_is_identical(
    finished: Path, tmp_path: Path, asperity: Asperity
) -> None:
    out = tmp_path / "again"
    assert asperity("run", finished / "config.toml", "--quiet", "--out", out) == (0, "", "")
    first, again = (results.load(folder / "history.zarr") for folder in (finished, out))
    assert first.identical(again)
    assert (out / "config.toml").read_text() == (finished / "config.toml").read_text()
    assert (out / "aging.csv").read_bytes() == (finished / "aging.csv").read_bytes()


def test_the_summary_says_what_was_found(tmp_path: Path, asperity: Asperity) -> None:
    out = tmp_path / "new" / "out"
    status, text, progress = asperity("run", *SMALL, "--out", out)
    dataset = results.load(out / "history.zarr")
    initial, last = int(dataset["area"][0]), int(dataset["area"][-1])
    assert status == 0
    assert f"{initial} of 1024 sites = {100 * initial / 1024:.4g} %" in text
    assert f"{last} of 1024 sites" in text
    assert f"{dataset.attrs['relaxed_area']} of 1024 sites" in text
    limit = dataset.attrs["relaxed_area"] / initial
    assert re.search(rf"^  a +{limit:.5g}, A\(relaxed\)/A\(0\), exact$", text, re.MULTILINE)
    assert "±" not in text
    assert "per decade of time, near t = " in text
    assert "k1 = 3" in text
    assert "no load was given: took 20.5 = 0.005 (k0 + k1) x rms height x sites" in text
    assert f"{int(dataset['steps'].sum())} time steps" in text
    assert str(out) in text
    assert text.startswith((out / "summary.txt").read_text())
    assert "remark: no load was given: took 20.5" in progress
    # Not a terminal: plain lines, one a decade, and the start.
    reached = [line.split()[2] for line in progress.splitlines() if line.startswith("  t = ")]
    assert reached == ["0", "0.001", "0.01", "0.1", "1", "10"]
    assert "\x1b" not in progress + text


@pytest.mark.parametrize(
    ("words", "heights"),
    [
        (("--shape", "16", "8"), gaussian((16, 8))),
        (("--shape", "64", "--rms", "2"), gaussian(64, rms=2.0)),
        (("--surface", "exponential", "--shape", "16,16", "--seed", "3"), exponential((16, 16), seed=3)),
        (("--surface", "self_affine", "--size", "16", "--hurst", "0.8"), self_affine(16, hurst=0.8)),
        (
            (
                "--surface",
                "spectral",
                "--shape",
                "16x8",
                "--spacing",
                ".5",
                "--unit",
                "um",
                "--rms-slope",
                "2",
            ),
            spectral((16, 8), spacing=0.5, rms_slope=2.0),
        ),
    ],
)
def test_every_kind_of_surface(
    words: tuple[str, ...], heights: np.ndarray, tmp_path: Path, asperity: Asperity
) -> None:
    out = tmp_path / "out"
    assert asperity("run", *words, *BRIEF, "--out", out) == (0, "", "")
    np.testing.assert_array_equal(results.load(out / "history.zarr")["heights"], heights)


def test_a_measured_surface(tmp_path: Path, asperity: Asperity) -> None:
    np.save(tmp_path / "rough.npy", gaussian((12, 10), seed=4))
    config = tmp_path / "run.toml"
    config.write_text("[surface]\npath = 'rough.npy'\nperiodic = 'wrap'\ntilt = 'none'")
    out = tmp_path / "out"
    assert asperity("run", config, *BRIEF, "--out", out)[0] == 0
    dataset = results.load(out / "history.zarr")
    surface = read(tmp_path / "rough.npy", periodic="wrap", tilt="none")
    np.testing.assert_array_equal(dataset["heights"], surface.heights)
    assert json.loads(dataset.attrs["surface"])["sha256"] == surface.provenance["sha256"]
    # The written configuration finds the file from anywhere.
    assert f'path = "{tmp_path / "rough.npy"}"' in (out / "config.toml").read_text()


def test_held_separation_and_chosen_maps_and_formats(tmp_path: Path, asperity: Asperity) -> None:
    out = tmp_path / "out"
    words = ("--separation", "1.5", "--maps-at", "0", "0.5", "--figures", "svg", "--times", "0.1", "1")
    status, text, _ = asperity("run", "--shape", "16,16", *words, "--out", out)
    assert status == 0
    assert "separation 1.5" in text
    assert "no fit: " in text
    dataset = results.load(out / "history.zarr")
    np.testing.assert_allclose(dataset["separation"], 1.5)
    loads = dataset["load"].values
    assert f"load at t = 1            {loads[-1]:.8g}, load/load(0) = {loads[-1] / loads[0]:.4g}\n" in text
    assert f"load relaxed             {dataset.attrs['relaxed_load']:.8g}, load/load(0)" in text
    slopes = np.diff(loads[1:]) / loads[0]
    assert f"steepest change of load  {slopes[0]:+.3g} load(0) per decade of time, near t = 0.32\n" in text
    assert dataset["field_time"].values.tolist() == [0.0, 0.5]
    assert dataset["time"].values.tolist() == [0.0, 0.1, 1.0]
    assert (out / "aging.svg").exists()
    assert not (out / "aging.png").exists()


def test_without_maps_there_is_no_map(tmp_path: Path, asperity: Asperity) -> None:
    config = tmp_path / "run.toml"
    config.write_text("[output]\nmaps_at = []")
    out = tmp_path / "out"
    assert asperity("run", config, "--shape", "8,8", "--times", "1", "--quiet", "--out", out)[0] == 0
    assert not (out / "contacts.png").exists()


def test_figures_can_be_turned_off(tmp_path: Path, asperity: Asperity) -> None:
    config = tmp_path / "run.toml"
    config.write_text("[output]\nfigures = []")
    words = ("run", "--shape", "8,8", "--times", "1", "-q")
    assert asperity(*words, config, "-o", tmp_path / "file")[0] == 0
    assert asperity(*words, "--figures", "", "-o", tmp_path / "flag")[0] == 0
    for out in (tmp_path / "file", tmp_path / "flag"):
        assert not list(out.glob("*.png"))
        assert "figures = []" in (out / "config.toml").read_text()


def test_many_maps_are_kept_and_some_are_drawn(tmp_path: Path, asperity: Asperity) -> None:
    times = [f"{0.01 * n:g}" for n in range(100)]
    words = ("--shape", "8,8", "--times", "1", "--maps-at", *times)
    status, text, _ = asperity("run", *words, "--out", tmp_path / "out")
    assert status == 0
    assert "contacts shows 24 of 100 maps; history.zarr holds all" in text
    assert results.load(tmp_path / "out").sizes["field_time"] == 100
    assert (tmp_path / "out" / "contacts.png").exists()


def test_a_line_is_said_to_be_one(tmp_path: Path, asperity: Asperity) -> None:
    words = ("--times", "1", "--maps-at", "", "--figures", "")
    _, text, _ = asperity("run", "--shape", "32", *words, "--out", tmp_path / "line")
    assert "a line contact of 32 sites; for a square: --shape 32 32, or shape = [32, 32] in a file" in text
    _, text, _ = asperity("run", "--shape", "8", "8", *words, "--out", tmp_path / "square")
    assert "a line contact" not in text


def test_a_state_that_depends_on_the_path_is_left_out_with_a_remark(
    tmp_path: Path, asperity: Asperity
) -> None:
    words = ("--shape", "16,16", "--k0", "0", "--separation", "1", "--times", "1", "--maps-at", "")
    status, text, _ = asperity("run", *words, "--out", tmp_path / "out")
    assert status == 0
    assert "no relaxed state: " in text
    assert "contact relaxed" not in text


def test_a_cliff_at_the_seam_deserves_a_remark(tmp_path: Path, asperity: Asperity) -> None:
    np.save(tmp_path / "ramp.npy", np.arange(16.0) ** 2 / 100)
    words = (
        "--file",
        tmp_path / "ramp.npy",
        "--periodic",
        "wrap",
        "--tilt",
        "none",
        "--times",
        "1",
        "--maps-at",
        "",
    )
    _, text, _ = asperity("run", *words, "--out", tmp_path / "out")
    assert "the surface is not periodic: the step at its seam is" in text


def test_a_figure_that_cannot_be_drawn_is_a_remark_and_no_loss(
    tmp_path: Path, asperity: Asperity, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise ValueError("no axis fits")

    monkeypatch.setattr("asperity.app.cli.output.aging_curve", fail)
    status, text, _ = asperity("run", *SMALL, "--out", tmp_path / "out")
    assert status == 0
    assert "the figure 'aging' could not be drawn: no axis fits" in text
    assert results.load(tmp_path / "out" / "history.zarr").sizes["time"] > 1
    assert not (tmp_path / "out" / "aging.png").exists()


def test_results_are_kept_unless_overwriting_is_asked_for(
    finished: Path, tmp_path: Path, asperity: Asperity
) -> None:
    out = tmp_path / "out"
    words = ("run", "--shape", "8,8", *BRIEF, "--out", out)
    out.mkdir()
    assert asperity(*words) == (0, "", "")  # an empty folder is as good as none
    before = (out / "config.toml").read_text()
    status, _, error = asperity(*words, "--k1", "4")
    assert status == 2
    assert error == (
        f"asperity: --out: expected a new folder, got {out}, which holds a run and is kept; "
        "try another name, or --overwrite\n"
    )
    assert (out / "config.toml").read_text() == before
    assert asperity(*words, "--k1", "4", "--overwrite") == (0, "", "")
    assert "k1 = 4.0" in (out / "config.toml").read_text()
    assert list(tmp_path.iterdir()) == [out]
    (out / "notes.txt").write_text("mine")
    status, _, error = asperity(*words, "--overwrite")
    assert status == 2
    assert "which holds notes.txt too and is kept; try another name, or moving that away" in error
    assert (out / "notes.txt").read_text() == "mine"


def test_only_the_folder_of_a_run_is_ever_replaced(
    tmp_path: Path, asperity: Asperity, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "thesis").mkdir()
    (tmp_path / "thesis" / "text").write_text("years of work")
    monkeypatch.chdir(tmp_path / "thesis")
    for out, reason in (
        (tmp_path / "thesis" / "text", "which is a file"),
        (Path(), "expected a folder of its own"),
        (tmp_path, "expected a folder of its own"),
    ):
        status, _, error = asperity("run", "--out", out, "--overwrite")
        assert status == 2
        assert reason in error
    monkeypatch.chdir(tmp_path.parent)
    status, _, error = asperity("run", "--out", tmp_path / "thesis", "--overwrite")
    assert (status, error.count("\n")) == (2, 1)
    assert "holds something else than a run" in error
    assert (tmp_path / "thesis" / "text").read_text() == "years of work"


def test_a_folder_that_cannot_be_made_is_found_before_anything_is_computed(
    tmp_path: Path, asperity: Asperity
) -> None:
    (tmp_path / "file").write_text("")
    out = tmp_path / "file" / "out"
    status, text, error = asperity("run", "--out", out)
    assert (status, text) == (1, "")
    assert error == f"asperity: --out: cannot write {out}: Not a directory: {tmp_path / 'file'}\n"


def test_the_summary_says_how_a_file_was_prepared(tmp_path: Path, asperity: Asperity) -> None:
    np.save(tmp_path / "rough.npy", gaussian((24, 20), seed=4))
    words = ("--crop", "0", "6", "1", "9", "--crop-unit", "um", "--pixel-size", "0.5", "--length-unit", "um")
    out = tmp_path / "out"
    assert asperity("run", "--file", tmp_path / "rough.npy", *words, *BRIEF, "--out", out)[0] == 0
    summary = (out / "summary.txt").read_text()
    assert (
        "24 x 32 sites (undefined = fill, tilt = plane, periodic = mirror, crop = 0 6 1 9, crop_unit = um, "
        "pixel_size = 0.5, length_unit = um)" in summary
    )
    assert "loads and areas are those of 4 mirrored copies of the scan" in summary
    assert json.loads(results.load(out / "history.zarr").attrs["surface"])["crop"] == [0, 12, 2, 18]


def test_an_instrument_looks_at_the_maps(finished: Path, tmp_path: Path, asperity: Asperity) -> None:
    out = tmp_path / "out"
    instrument = ("--pixel", "4", "--blur", "2.5", "--threshold", "0.05")
    status, text, _ = asperity("run", *SMALL, "--seed", "7", *instrument, "--out", out)
    assert status == 0
    dataset, usual = results.load(out), results.load(finished)
    maps = [usual.isel(field_time=number) for number in range(6)]
    seen = [observe(one, pixel=4.0, blur=2.5, threshold=0.05).area for one in maps]
    assert dataset["area_observed"].values.tolist() == seen
    assert dataset["area_observed"].attrs["units"] == "sites"
    assert max(seen) > 0
    assert re.search(rf"seen at t = 10 +{seen[-1]:g}\n", text)
    assert results.load(out).drop_vars("area_observed")["u"].identical(usual["u"])


def test_an_instrument_that_sees_nothing(tmp_path: Path, asperity: Asperity) -> None:
    for words, said in (
        (("--blur", "99"), "blur: expected a finite number >= 0 and <= 32, got 99.0"),
        (("--pixel", "2", "--maps-at", ""), "pixel: expected maps to look at, got maps_at = []"),
        (("--pixel", "2um"), "expected plain numbers for a spring_lattice"),
        (("--threshold", "2"), "--threshold: expected a number of at most 1.0, got 2"),
        (("--threshold", "0.5"), "asperity: --threshold: expected --pixel or --blur beside it, got neither"),
        (
            ("--branch", "0.3", "10"),
            '10: No such file or directory; a pair of numbers is one word: --branch "0.3 10"',
        ),
    ):
        status, _, error = asperity("run", *SMALL, *words, "--quiet", "--out", tmp_path / "out")
        assert status == 2
        assert said in error
    assert list(tmp_path.iterdir()) == []
