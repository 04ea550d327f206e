"""``asperity run``: what it writes, and that it can be run again."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from asperity import age, observe, press, relax, results
from asperity.solids import spring_lattice
from asperity.surfaces import exponential, gaussian, read, self_affine, spectral
from tests.cli.conftest import SMALL, Asperity, rows_of, told

BRIEF = ("--times", "1", "--maps-at", "", "--quiet")
"""One time, no map, no word."""


def test_all_files_are_there(finished: Path) -> None:
    names = "aging.csv aging.png config.toml contacts.png history.zarr patches.csv patches.png summary.txt"
    assert sorted(p.name for p in finished.iterdir()) == names.split()
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
    rows = rows_of(finished / "patches.csv")
    assert [float(row["time"]) for row in rows] == dataset["field_time"].values.tolist()
    for name in ("patches", "perimeter", "births", "gained_by_expansion", "mean_contact_age"):
        np.testing.assert_array_equal([float(row[name]) for row in rows], dataset[name])
    for share in (0.05, 0.5, 1.0):
        for name in ("contact_age", "contact_pressure"):
            there = [float(row[f"{name}_{100 * share:g}_percent"]) for row in rows]
            np.testing.assert_array_equal(there, dataset[name].sel(quantile=share))


def test_the_table_holds_the_history(finished: Path) -> None:
    dataset = results.load(finished / "history.zarr")
    rows = rows_of(finished / "aging.csv")
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
    assert f"{int(dataset['steps'].sum())} time steps" in text
    assert str(out) in text
    assert text.startswith((out / "summary.txt").read_text())
    # Not a terminal: plain lines, one a decade, and the start.
    reached = [line.split()[2] for line in progress.splitlines() if line.startswith("  t = ")]
    assert reached == ["0", "0.001", "0.01", "0.1", "1", "10"]
    assert "\x1b" not in progress + text


def test_every_kind_of_surface(asperity: Asperity) -> None:
    for words, heights in (
        ("--shape 16 8", gaussian((16, 8))),
        ("--shape 64 --rms 2", gaussian(64, rms=2.0)),
        ("--surface exponential --shape 16,16 --seed 3", exponential((16, 16), seed=3)),
        ("--surface self_affine --size 16 --hurst 0.8", self_affine(16, hurst=0.8)),
        (
            "--surface spectral --shape 16x8 --spacing .5 --unit um --rms-slope 2",
            spectral((16, 8), spacing=0.5, rms_slope=2.0),
        ),
    ):
        call = ("run", *words.split(), *BRIEF, "--figures", "", "--out", "out", "--overwrite")
        assert asperity(*call) == (0, "", "")
        np.testing.assert_array_equal(results.load("out")["heights"], heights)


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


def test_a_measured_surface(tmp_path: Path, asperity: Asperity) -> None:
    np.save("rough.npy", gaussian((24, 20), seed=4))
    Path("run.toml").write_text("[surface]\npath = 'rough.npy'\nperiodic = 'wrap'\ntilt = 'none'")
    assert asperity("run", "run.toml", *BRIEF, "--out", "out")[0] == 0
    dataset = results.load("out/history.zarr")
    surface = read("rough.npy", periodic="wrap", tilt="none")
    np.testing.assert_array_equal(dataset["heights"], surface.heights)
    assert json.loads(dataset.attrs["surface"])["sha256"] == surface.provenance["sha256"]
    # The written configuration finds the file from anywhere.
    assert f'path = "{tmp_path / "rough.npy"}"' in Path("out/config.toml").read_text()
    words = ("--crop", "0", "6", "1", "9", "--crop-unit", "um", "--pixel-size", "0.5", "--length-unit", "um")
    assert asperity("run", "--file", "rough.npy", *words, *BRIEF, "--out", "part")[0] == 0
    assert "24 x 32 sites (undefined = fill, tilt = plane, periodic = mirror, crop = 0 6 1 9" in (
        Path("part/summary.txt").read_text()
    )
    assert json.loads(results.load("part").attrs["surface"])["crop"] == [0, 12, 2, 18]


def test_results_are_replaced_only_where_overwriting_is_asked_for(asperity: Asperity) -> None:
    words = ("run", "--shape", "8,8", *BRIEF, "--out", "out")
    Path("out").mkdir()
    assert asperity(*words, "--figures", "") == (0, "", "")  # an empty folder is as good as none
    names = "aging.csv config.toml history.zarr summary.txt"
    assert sorted(path.name for path in Path("out").iterdir()) == names.split()
    before = Path("out/config.toml").read_text()
    assert asperity(*words, "--k1", "4")[0] == 2
    assert Path("out/config.toml").read_text() == before
    assert asperity(*words, "--k1", "4", "--overwrite") == (0, "", "")
    assert "k1 = 4.0" in Path("out/config.toml").read_text()
    assert list(Path().iterdir()) == [Path("out")]


REMARKS = {
    ("--shape", "32"): 1,
    ("--shape", "8", "8"): 0,
    ("--shape", "16,16", "--k0", "0", "--separation", "1"): 1,
    ("--file", "ramp.npy", "--periodic", "wrap", "--tilt", "none"): 1,
    ("--file", "ramp.npy"): 1,
    ("--shape", "8,8", "--maps-at", *(f"{0.01 * n:g}" for n in range(100)), "--figures", "png"): 1,
    ("--shape", "8,8", "--load", "0", "--leg", "ramp 2 load=30", "--leg", "hold 4", "--times", "1", "5"): 1,
    ("--shape", "8,8", "--load", "1", "--leg", "ramp 2 load=30", "--leg", "hold 4", "--times", "1", "5"): 0,
    ("--shape", "8,8", "--load", "0", "--leg", "ramp 2 load=30", "--leg", "hold 4"): 0,
}


def test_what_the_user_should_know_is_remarked(asperity: Asperity) -> None:
    np.save("ramp.npy", np.arange(16.0) ** 2 / 100)
    for words, expected in REMARKS.items():
        usual = ("--times", "1") if "--leg" not in words else ()
        quiet = ("--maps-at", "", "--figures", "") if "--maps-at" not in words else ()
        load = () if {"--load", "--separation"} & set(words) else ("--load", "3")
        status, text, _ = asperity("run", *usual, *quiet, *load, *words, "--out", "out", "--overwrite")
        assert status == 0
        lines = text.splitlines()
        remarks = [line.removeprefix("remark").strip() for line in lines if line.startswith("remark")]
        assert len(remarks) == expected, words
        for remark in remarks:
            told(remark)
