"""Reading instrument files, through an optional library whose errors must not come through."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asperity.errors import MissingExtraError, SurfaceFileError
from asperity.surfaces import power_spectrum, read

DATA = Path(os.environ.get("ASPERITY_DATA", Path(__file__).resolve().parents[2].parent / "shared" / "data"))
FILES = ("di-1.di", "mi-1.mi", "opd-1.opd")

needs_library = pytest.mark.skipif(
    importlib.util.find_spec("SurfaceTopography") is None, reason="SurfaceTopography is not installed"
)


TIFF_ENTRIES = b"".join(
    tag.to_bytes(2, "little") + b"\x03\0\x01\0\0\0" + value.to_bytes(4, "little")
    for tag, value in ((256, 1), (257, 1), (273, 50))
)


def instrument_file(name: Any) -> Any:
    if not (DATA / name).is_file():
        pytest.skip(f"instrument file {name} is not in {DATA}; set ASPERITY_DATA to its folder")
    return DATA / name


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
def test_instrument_files_keep_their_size_and_height(
    name: Any, shape: Any, size: Any, unit: Any, rms: Any, undefined: int
) -> None:
    surface = read(instrument_file(name), tilt="none", periodic="wrap")
    assert surface.shape == shape
    assert (surface.unit, surface.length_unit) == (unit, unit)
    assert surface.pixel_size == pytest.approx([s / n for s, n in zip(size, shape, strict=True)], rel=5e-3)
    assert surface.heights.std() == pytest.approx(rms, rel=0.02)
    assert surface.provenance["physical_size"] == pytest.approx(size, rel=5e-3)
    assert surface.provenance["format"] == name.rpartition(".")[2]
    assert "SurfaceTopography" in str(surface.provenance["reader"])
    assert surface.provenance["undefined_pixels"] == surface.describe().undefined_pixels == undefined


@needs_library
@pytest.mark.parametrize("name", FILES)
def test_defaults_make_instrument_files_periodic(name: Any) -> None:
    path = instrument_file(name)
    surface, cliff = read(path), read(path, periodic="wrap")
    assert surface.shape == tuple(2 * n for n in cliff.shape)
    np.testing.assert_array_equal(surface.heights[tuple(slice(n) for n in cliff.shape)], cliff.heights)
    assert surface.describe().seam_ratio == 0
    assert cliff.describe().seam_ratio > 2
    assert read(path, periodic="taper").describe().seam_ratio < 1
    np.testing.assert_allclose(read(path, unit="rms").heights.std(), 1, rtol=1e-12)


@needs_library
def test_rows_are_scan_lines_and_run_downward() -> None:
    # The microscope scans line by line: neighbors along a row are alike, those in a column are not.
    surface = read(instrument_file("di-1.di"), tilt="none", periodic="wrap")
    down, along = surface.describe().neighbor_steps
    assert along < down / 2
    from SurfaceTopography import read_topography

    upward = read_topography(str(instrument_file("di-1.di"))).heights()  # x first, y upward
    np.testing.assert_array_equal(surface.heights[-1], upward[:, 0])


@needs_library
def test_units_are_converted() -> None:
    path = instrument_file("mi-1.mi")
    micro, nano = read(path), read(path, unit="nm")
    np.testing.assert_allclose(nano.heights, 1000 * micro.heights, rtol=1e-15)
    assert (nano.unit, nano.length_unit, nano.provenance["scale_factor"]) == ("nm", "um", 1000)


@needs_library
def test_channels_by_name_and_number() -> None:
    path = instrument_file("di-1.di")
    default = read(path)
    assert default.provenance["channel"] == "Height#1"
    assert default.provenance["channels"] == ["Height#1", "Height#2"]
    for channel in ("Height#1", "Height", 0):
        np.testing.assert_array_equal(read(path, channel=channel).heights, default.heights)
    second = read(path, channel="Height#2")
    assert second.provenance["channel"] == "Height#2"
    np.testing.assert_array_equal(read(path, channel=1).heights, second.heights)
    assert not np.array_equal(second.heights, default.heights)
    others: list[Any] = ["Phase", "Hight", 7, -1]
    for channel in others:
        with pytest.raises(SurfaceFileError, match=r"'Height#1' .*, 'Height#2' .*, got channel"):
            read(path, channel=channel)


@needs_library
@pytest.mark.parametrize("name", FILES)
def test_truncated_and_damaged_instrument_files(
    tmp_path: Path, name: Any, capfd: pytest.CaptureFixture[str]
) -> None:
    """Wrong bytes, most of them in the header, lead to heights or to one line; missing ones to a line."""
    whole = instrument_file(name).read_bytes()
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
def test_other_kinds_of_files(tmp_path: Path) -> None:
    for name, content in {
        "picture.png": b"\x89PNG\r\n\x1a\n" + np.random.default_rng(0).bytes(2000),
        # The library takes any file of 2 n^2 bytes for a map of the Earth, which has no signature.
        "noise.bin": np.random.default_rng(1).bytes(2 * 64 * 64),
        "zeros.dat": bytes(8192),
        "letter.di": b"Dear reader, this is\nno surface, not even 1.\n",
        "archive.zip": b"PK\x03\x04" + bytes(300),
        # A picture: the smallest TIFF, of one pixel.
        "picture.tif": b"II*\0\x08\0\0\0\x03\0" + TIFF_ENTRIES + bytes(5),
    }.items():
        (tmp_path / name).write_bytes(content)
        with pytest.raises(SurfaceFileError) as caught:
            read(tmp_path / name)
        assert "Error" not in str(caught.value)


@needs_library
def test_files_without_a_size_have_no_pixel_size(tmp_path: Path) -> None:
    heights = np.random.default_rng(0).normal(size=(6, 5))
    np.savetxt(tmp_path / "matrix.asc", heights, fmt="%.17g")
    surface = read(tmp_path / "matrix.asc", tilt="none", periodic="wrap")
    assert sorted(surface.shape) == [5, 6]
    assert (surface.unit, surface.pixel_size, surface.length_unit) == ("1", None, None)
    assert sorted(surface.heights.ravel().tolist()) == pytest.approx(sorted(heights.ravel().tolist()))


def test_without_the_library_it_says_how_to_install_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    monkeypatch.setitem(sys.modules, "SurfaceTopography.IO", None)
    (tmp_path / "afm.di").write_bytes(b"\\*File list\r\n")
    with pytest.raises(MissingExtraError, match=r"try pip install 'asperity\[instruments\]'$"):
        read(tmp_path / "afm.di")


def test_the_library_is_not_imported_before_it_is_needed() -> None:
    code = "import sys, asperity.surfaces; sys.exit('SurfaceTopography' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False, timeout=120).returncode == 0


def test_the_range_of_a_hurst_exponent_holds_no_waves_of_too_little_power() -> None:
    found = power_spectrum(read(instrument_file("mi-1.mi"), periodic="wrap"))
    assert found.fit is not None
    q = found.wave_number
    inside = (q > 2 * np.pi / found.fit.longest) & (q < 2 * np.pi / found.fit.shortest)
    ratio = found.power[inside] / np.array([float(found.fit.power(one)) for one in q[inside]])
    assert inside.sum() > 8
    assert ratio.min() > 0.4  # the plateau of the long waves has a sixth of the line's
    assert ratio.max() < 2.5
