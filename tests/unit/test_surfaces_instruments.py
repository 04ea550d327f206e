"""Instrument files and points x, y, z, through an optional library whose errors must not come through."""

import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asperity.errors import MissingExtraError, SurfaceFileError
from asperity.surfaces import power_spectrum, read
from tests.instrument_files import needs_library, stored
from tests.refusals import refuses

AS_IT_IS: dict[str, Any] = {"tilt": "none", "periodic": "wrap"}
pytestmark = pytest.mark.usefixtures("here")


@needs_library
@pytest.mark.parametrize(
    # Pixels, size and rms height as the data's own README gives them (opd: rms measured once, in nm).
    ("name", "shape", "size", "unit", "rms", "undefined"),
    [
        ("di-1.di", (512, 512), (500.0, 500.0), "nm", 10.0, 0),
        ("mi-1.mi", (256, 256), (20.0, 20.0), "um", 0.033, 0),
        ("opd-1.opd", (480, 640), (0.094, 0.126), "mm", 8.4e-6, 116),
    ],
)
def test_instrument_files_keep_their_size_and_height(name, shape, size, unit, rms, undefined):
    surface = read(stored(name), **AS_IT_IS)
    assert surface.shape == shape
    assert (surface.unit, surface.length_unit) == (unit, unit)
    assert surface.pixel_size == pytest.approx([s / n for s, n in zip(size, shape, strict=True)], rel=5e-3)
    assert surface.heights.std() == pytest.approx(rms, rel=0.02)
    assert surface.provenance["physical_size"] == pytest.approx(size, rel=5e-3)
    assert surface.provenance["format"] == name.rpartition(".")[2]
    assert "SurfaceTopography" in str(surface.provenance["reader"])
    assert surface.provenance["undefined_pixels"] == surface.describe().undefined_pixels == undefined
    in_pm = read(stored(name), unit="pm", **AS_IT_IS)
    factor = {"nm": 1e3, "um": 1e6, "mm": 1e9}[unit]
    np.testing.assert_allclose(in_pm.heights, factor * surface.heights, rtol=1e-15)
    assert (in_pm.unit, in_pm.length_unit, in_pm.provenance["scale_factor"]) == ("pm", unit, factor)
    from SurfaceTopography import read_topography  # which warns, if it is imported first here

    theirs = np.ma.filled(read_topography(str(stored(name))).heights(), np.nan).T
    known = ~np.isnan(theirs)
    np.testing.assert_allclose(surface.heights[known], theirs[known], rtol=1e-15)


@needs_library
def test_rows_run_downward_as_the_lines_of_the_picture():
    # The microscope scans line by line: neighbors along a row are alike, those in a column are not.
    surface = read(stored("di-1.di"), **AS_IT_IS)
    down, along = surface.describe().neighbor_steps
    assert along < down / 2
    # NanoScope stores whole numbers, the lowest line first: its header says where, and as how many bytes.
    content = stored("di-1.di").read_bytes()
    offset, size = map(int, re.findall(rb"\\Data offset: (\d+)\s+\\Data length: (\d+)", content)[0])
    lines = np.frombuffer(content[offset : offset + size], dtype=f"<i{size // 512**2}").reshape(512, 512)
    scale = surface.heights[-1, 0] / lines[0, 0]
    np.testing.assert_allclose(surface.heights, scale * lines[::-1], rtol=1e-12)


@needs_library
def test_channels_by_name_and_number():
    path = stored("di-1.di")
    default, second = read(path), read(path, channel="Height#2")
    assert default.provenance["channels"] == ["Height#1", "Height#2"]
    assert [one.provenance["channel"] for one in (default, second)] == ["Height#1", "Height#2"]
    assert not np.array_equal(second.heights, default.heights)
    for channel, same in (("Height", default), (0, default), (1, second)):
        np.testing.assert_array_equal(read(path, channel=channel).heights, same.heights)
    others: list[Any] = ["Phase", 7, -1]
    for channel in others:
        with pytest.raises(SurfaceFileError, match=r"'Height#1' .*, 'Height#2' .*, got channel"):
            read(path, channel=channel)


@needs_library
@pytest.mark.parametrize("name", ["di-1.di", "mi-1.mi", "opd-1.opd"])
def test_truncated_and_damaged_instrument_files(tmp_path, name, capfd):
    """Wrong bytes, most of them in the header, lead to heights or to one line; missing ones to a line."""
    whole = stored(name).read_bytes()
    path = tmp_path / name
    rng = np.random.default_rng(len(whole))
    refused = []
    for part in (1, 30, 1000, 9000, *(int(part * len(whole)) for part in (0.25, 0.6, 0.97))):
        path.write_bytes(whole[:part])
        with pytest.raises(SurfaceFileError) as caught:
            read(path)
        refused.append(str(caught.value))
    for _ in range(12):
        damaged = bytearray(whole)
        for place in rng.integers(0, rng.choice([300, 3000, len(whole)]), size=rng.integers(1, 30)):
            damaged[place] = rng.integers(256)
        path.write_bytes(damaged)
        try:
            surface = read(path, tilt="mean", periodic="wrap", max_undefined=0.99)
        except SurfaceFileError as error:
            refused.append(str(error))
        else:
            assert np.isfinite(surface.heights).all()
    assert 7 < len(refused) < 19
    assert max(map(len, refused)) < 350 + len(str(tmp_path))
    assert "\n" not in "".join(refused)
    assert "Error" not in "".join(refused)
    assert capfd.readouterr() == ("", "")


@needs_library
def test_other_kinds_of_files():
    for name, content in {
        "picture.png": b"\x89PNG\r\n\x1a\n" + np.random.default_rng(0).bytes(2000),
        # The library takes any file of 2 n^2 bytes for a map of the Earth, which has no signature.
        "noise.bin": np.random.default_rng(1).bytes(2 * 64 * 64),
        "zeros.dat": bytes(8192),
        "letter.di": b"Dear reader, this is\nno surface, not even 1.\n",
    }.items():
        Path(name).write_bytes(content)
        with pytest.raises(SurfaceFileError) as caught:
            read(name)
        assert "Error" not in str(caught.value)


def test_without_the_library_it_says_how_to_install_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    monkeypatch.setitem(sys.modules, "SurfaceTopography.IO", None)
    Path("afm.di").write_bytes(b"\\*File list\r\n")
    with pytest.raises(MissingExtraError, match=r"try pip install '.*\[instruments\]'$"):
        read("afm.di")


def test_the_range_of_a_hurst_exponent_holds_no_waves_of_too_little_power():
    found = power_spectrum(read(stored("mi-1.mi"), periodic="wrap"))
    assert found.fit is not None
    q = found.wave_number
    inside = (q > 2 * np.pi / found.fit.longest) & (q < 2 * np.pi / found.fit.shortest)
    ratio = found.power[inside] / np.array([float(found.fit.power(one)) for one in q[inside]])
    assert inside.sum() > 8
    assert ratio.min() > 0.4  # the plateau of the long waves has a sixth of the line's
    assert ratio.max() < 2.5


X, Y = np.meshgrid(0.5 * np.arange(20), 0.3 * np.arange(15) - 7.0, indexing="ij")
GRID = np.stack([X, Y, np.sin(X) + np.cos(2 * Y)], axis=-1).reshape(-1, 3)
HOLES = [17, 100, 101, 230]


def as_found(points, name="points.xyz", digits="%.9g", **options):
    np.savetxt(name, points, fmt=digits)
    return read(name, **AS_IT_IS, **options)


def test_points_that_are_left_out_are_undefined_pixels():
    whole = as_found(np.vstack([GRID, GRID[7]]))  # the same point twice is one
    holed = as_found(np.random.default_rng(0).permutation(np.delete(GRID, HOLES, axis=0)))
    assert holed.provenance["undefined_pixels"] == len(HOLES)
    assert (holed.shape, holed.provenance["format"]) == (whole.shape, "xyz") == ((15, 20), "xyz")
    assert holed.pixel_size == pytest.approx((0.3, 0.5))
    filled = np.zeros(300, dtype=bool)
    filled[HOLES] = True
    where = filled.reshape(20, 15).T[::-1]  # rows run downward, y upward
    np.testing.assert_array_equal(holed.heights[~where], whole.heights[~where])
    assert (holed.heights[where] != whole.heights[where]).all()


def test_coordinates_with_few_digits_and_lines_without_points():
    points = GRID[(np.abs(GRID[:, 0] - 3.0) > 0.1) & (np.abs(GRID[:, 1] + 6.1) > 0.1)]  # a column and a row
    rounded = points * [0.025, 0.041, 1]  # 0.0125 apart: with three digits 0.012 or 0.013
    found = as_found(rounded, digits="%.3f", max_undefined=0.2)
    assert found.shape == (15, 20)
    assert found.provenance["undefined_pixels"] == 20 + 15 - 1
    assert found.pixel_size == pytest.approx((0.0123, 0.0125), rel=0.01)


def test_points_of_no_grid_are_refused():
    rng = np.random.default_rng(0)
    bent = GRID.copy()
    bent[:, 0] += 0.2 * np.sin(GRID[:, 1])
    endless, sparse = np.delete(GRID, 3, axis=0), np.delete(GRID, slice(None, None, 5), axis=0)
    endless[5, 1], endless[7, 0] = np.inf, np.nan
    far = np.vstack([GRID, [1e308, -1e308, 0], [-1e308, 1e308, 0]])
    line, twice = GRID * [1, 0, 1], np.vstack([GRID, GRID[64] + [0, 0, 0.5]])
    for points in (rng.uniform(0, 20, (300, 3)), bent, line, endless, far, sparse, twice):
        with refuses("points.xyz", kind=SurfaceFileError):
            as_found(points)


def test_three_columns_of_text_are_points_or_remarked():
    holed = as_found(np.delete(GRID, HOLES, axis=0), "points.txt")
    assert (holed.shape, holed.provenance["undefined_pixels"]) == ((15, 20), len(HOLES))
    with refuses("points.txt", "1", kind=SurfaceFileError):
        as_found(np.vstack([GRID, GRID[7] + 0.1 * np.eye(3)[2]]), "points.txt")
    matrix = np.random.default_rng(1).normal(size=(300, 3))
    found = as_found(matrix, "heights.txt")
    assert found.shape == (300, 3)
    (remark,) = found.remarks
    assert remark.startswith("three columns, taken as pixels")
    assert as_found(matrix[:, :2].T, "heights.txt").remarks == ()
