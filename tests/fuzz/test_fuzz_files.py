"""Damaged files of every kind that is read: a result, or one clear line."""

import json
import shutil
from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import asperity as asp
from asperity import campaign
from asperity.app.campaign import sweeping
from asperity.app.campaign.worker import run_task
from asperity.app.cli import main
from asperity.app.config import to_tables
from asperity.errors import AsperityError
from tests.campaign.conftest import do_here, written
from tests.fuzz.fuzzing import Draw, assert_clear, damage_bytes, damage_folder, fuzz, tried

SOLID = asp.solids.spring_lattice(k0=1.0, k1=3.0)
ROUGH = np.random.default_rng(0).normal(size=(8, 8))
TIMES = [0.1, 1.0, 10.0]

PLAN = """
[surface]
shape = [8, 8]
[contact]
load = 6.0
[aging]
times = [1.0, 10.0]
[output]
maps_at = [10.0]
[sweep]
k1 = [1.0, 3.0]
seeds = 2
"""

TABLES = [
    "time,area,error\n0,10,0.5\n1,12,0.5\n10,14.5,0.5\n100,17,0.5\n1000,19.5,1\n",
    "# a comment\nZeit;mu\n1,5;0,60\n10,1;0,61\n100,2;0,615\n1000,3;0,63\n",
    ",t,mu\n0,1,0.6\n1,10,0.61\n2,100,0.62\n3,1000,\n4,10000,nan\n",
    "1.5\t0.6\n10\t0.61\n100\t0.62\n",
    '"t [s]","mu"\n"1.5","0.6"\n"10","0.61"\n',
]
# fmt: off
CELLS = [
    "", "nan", "inf", "-1", "1e400", "0", "1e-320", "x", '"', "1,5", "µ", "\x00", "\x1b[2J", "9" * 400,
    ";", "\t",
]
# fmt: on


def write_surface(draw: Draw, folder: Path) -> Path:
    shape = draw.one([(8, 8), (8, 8), (5, 7), (30,), (1, 9), (2, 2), (3, 3, 3), (1, 0), ()])
    heights = draw.rng.normal(size=shape) * draw.one([1.0, 1e-9, 1e70, 0.0])
    with np.errstate(all="ignore"):
        heights = np.asarray(heights).astype(draw.one([float, float, "f4", ">f8", int, "c16", bool, "f2"]))
    path: Path = folder / draw.one(
        ["a.npy", "a.npy", "a.npz", "a.npz", "a.txt", "a.csv", "a.dat", "a.xyz", "a.sdf", "a"]
    )
    draw.say(f"{path.name} {heights.shape} {heights.dtype}")
    if path.suffix == ".npy":
        np.save(path, heights)
    elif path.suffix == ".npz":
        save = draw.one([np.savez, np.savez_compressed])
        save(path, **dict.fromkeys(["z", "mask", "\x1b[2J", "ü"][: draw.between(1, 4)], heights))
    else:
        rows = np.atleast_2d(heights.reshape(heights.shape[0], -1) if heights.ndim else heights)
        words = np.vectorize("{:.6g}".format, otypes=[object])(rows)
        if words.size and draw.chance(0.5):
            words.flat[draw.between(0, words.size - 1)] = draw.one(CELLS)
        separator = draw.one([",", ";", "\t", " "])
        text = "\n".join(separator.join(row) for row in words)
        path.write_bytes(text.encode(draw.one(["utf-8", "utf-16", "utf-8-sig"])))
    return path


@pytest.mark.filterwarnings("ignore:Casting complex values")
def test_surface_files(tmp_path: Path) -> None:
    def attempt(draw: Draw) -> None:
        path = write_surface(draw, tmp_path)
        if draw.chance(0.8):
            path.write_bytes(damage_bytes(draw, path.read_bytes()))
        options = {
            "undefined": draw.one(["fill", "refuse"]),
            "tilt": draw.one(["plane", "quadratic", "mean", "none"]),
            "periodic": draw.one(["mirror", "reflect", "taper", "wrap"]),
            "unit": draw.one([None, None, "m", "nm", "rms"]),
            "channel": draw.one([None, None, 0, 1, "z", "\x1b[2J", 10**20]),
            "resample": draw.chance(0.2),
            "despike": draw.chance(0.2),
            "crop": draw.one([None, None, [0, 4], [0, 4, 0, 4], [0.2, 0.4, -1, 3]]),
            "crop_unit": draw.one([None, None, "pixel", "nm"]),
            "longest": draw.one([None, None, 5.0, 1e-300]),
            "shortest": draw.one([None, None, 2.5, 1e300]),
            "file_unit": draw.one([None, "nm"]),
            "pixel_size": draw.one([None, None, 1.0, (0.5, 2.0)]),
            "length_unit": draw.one([None, None, "um"]),
        }
        draw.say(options)
        found = tried(lambda: asp.surfaces.read(path, **options))
        if isinstance(found, asp.surfaces.Surface):
            assert found.heights.dtype == np.float64
            assert np.isfinite(found.heights).all()
        path.unlink()

    fuzz("surface files", 300, attempt)


def test_tables(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"

    def attempt(draw: Draw) -> None:
        text = draw.one(TABLES)
        if draw.chance(0.6):
            rows = text.split("\n")
            cells = rows.pop(row := draw.between(0, len(rows) - 1)).split(",")
            cells[draw.between(0, len(cells) - 1)] = draw.one(CELLS)
            text = "\n".join(rows[:row] + [",".join(cells)] * draw.one([1, 1, 2, 300]) + rows[row:])
        content = text.encode(draw.one(["utf-8", "utf-8", "utf-16", "latin-1"]))
        path.write_bytes(damage_bytes(draw, content) if draw.chance(0.5) else content)
        draw.say(path.read_bytes()[:200])
        column = [None, None, None, 0, 1, 2, 99, -1, "t", "1", "", "\x1b[2J"]
        columns = {name: draw.one(column) for name in ("time", "value", "stderr")}
        draw.say(columns)
        data = tried(lambda: asp.fits.read_measurements(path, **columns))
        if isinstance(data, AsperityError):
            return
        window = draw.one([{}, {"first": 1.0}, {"first": 1.0, "last": 100.0}, {"last": 1e-300}])
        found = tried(lambda: asp.fits.measured_growth(data.time, data.value, stderr=data.stderr, **window))
        if not isinstance(found, AsperityError):
            assert np.isfinite(found.shown.x).all()
            for note in found.notes:
                assert_clear(note)

    fuzz("tables", 200, attempt)


@pytest.mark.parametrize("draws", [8, pytest.param(25, marks=pytest.mark.slow)])
def test_histories_on_disk(draws: int, tmp_path: Path) -> None:
    good, bad = tmp_path / "good.zarr", tmp_path / "bad.zarr"
    history = asp.age(asp.press(ROUGH, SOLID, load=10.0), TIMES, fields_at=[0.0, 1.0])
    history.save(good)

    def attempt(draw: Draw) -> None:
        shutil.copytree(good, bad)
        try:
            path = damage_folder(draw, bad)
            dataset = tried(lambda: asp.results.load(bad))
            if isinstance(dataset, xr.Dataset) and "/c/" in str(path) and path.is_file():
                assert dataset.identical(history.dataset)
        finally:
            shutil.rmtree(bad)

    fuzz("histories on disk", draws, attempt)


def test_checkpoints(tmp_path: Path) -> None:
    path = tmp_path / "place.npz"
    contact = asp.press(ROUGH, SOLID, load=10.0)
    whole = asp.age(contact, TIMES, fields_at=[0.0, 1.0])

    def stop(frame: asp.Frame) -> None:
        if frame.time >= 1.0:
            raise InterruptedError

    def go(progress: Callable[[asp.Frame], None] | None = None) -> asp.History:
        place = asp.Checkpoint(path, every=0.0)
        return asp.age(contact, TIMES, fields_at=[0.0, 1.0], checkpoint=place, progress=progress)

    with pytest.raises(InterruptedError):
        go(stop)
    good = path.read_bytes()

    def attempt(draw: Draw) -> None:
        path.write_bytes(damage_bytes(draw, good))
        history = tried(go)
        if not isinstance(history, AsperityError):
            draw.say("resumed")
            xr.testing.assert_identical(history.dataset, whole.dataset)

    fuzz("checkpoints", 25, attempt)


@pytest.mark.parametrize("draws", [3, pytest.param(15, marks=pytest.mark.slow)])
def test_campaigns_on_disk(
    draws: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = campaign.read_plan(written(tmp_path, PLAN))
    good, bad = tmp_path / "good", tmp_path / "bad"
    do_here(plan, good)

    def here(client, store, runs, counts):
        """The work of a round, in this process."""
        for run in runs:
            config = json.dumps(to_tables(run.config))
            report = run_task(str(store.directory), run.identity, config, run.content)
            if not sweeping._is_busy(report):
                counts.take(report)
        return []

    monkeypatch.setattr(sweeping, "_round", here)
    monkeypatch.setattr(sweeping, "connect", lambda *_: nullcontext())
    file = str(tmp_path / "campaign.toml")

    def attempt(draw: Draw) -> None:
        shutil.copytree(good, bad)
        try:
            for _ in range(draw.one([1, 1, 2])):
                damage_folder(draw, bad)
            if draw.chance(0.3):
                run_command(draw, capsys, ["status", str(bad)])
            if draw.chance(0.3):
                run_command(draw, capsys, ["gather", str(bad)])
            opened = tried(lambda: campaign.open(bad))
            draw.say(type(opened))
            tried(lambda: campaign.fields(bad, k1=3.0, seed=1))
            if draw.chance(0.3):
                run_command(draw, capsys, ["sweep", file, "--out", str(bad), *draw.one([[], ["--dry-run"]])])
        finally:
            shutil.rmtree(bad)

    fuzz("campaigns on disk", draws, attempt)


def run_command(draw: Draw, capsys: pytest.CaptureFixture[str], words: list[str]) -> int:
    """Run a command line in this process; judge its exit status and its words."""
    draw.say(" ".join(map(ascii, words)))
    capsys.readouterr()
    status = main(words)
    out, error = capsys.readouterr()
    assert status in (0, 1, 2), status
    lines = error.splitlines()
    assert bool(status) == any(line.startswith("asperity: ") for line in lines), error
    assert not [bad for bad in ("Traceback", "\x1b") if bad in out]
    for line in lines:
        assert_clear(line)
    return status
