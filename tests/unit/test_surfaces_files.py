"""Reading matrices of heights: the order of the rules, the record of them, and what is refused."""

import hashlib
import io
import math
import os
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asperity.errors import InputError, SurfaceFileError
from asperity.surfaces import read

AS_IT_IS: dict[str, Any] = {"tilt": "none", "periodic": "wrap"}


@pytest.fixture
def rough() -> Any:
    return np.random.default_rng(4).normal(size=(12, 9)) + 3.0


def saved(tmp_path: Path, array: Any, name: Any = "surface.npy", **options: Any) -> Any:
    np.save(tmp_path / name, array, **options)
    return tmp_path / name


def written(tmp_path: Path, text: Any, name: Any = "surface.txt") -> Any:
    (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path / name


@pytest.mark.parametrize("dtype", ["f8", ">f4", "i2", "u1"])
def test_npy_is_read_as_it_is(tmp_path: Path, dtype: Any) -> None:
    array = np.arange(12).reshape(3, 4).astype(dtype)
    surface = read(saved(tmp_path, array), **AS_IT_IS)
    np.testing.assert_array_equal(surface.heights, array)
    assert surface.heights.dtype == np.float64
    assert (surface.unit, surface.pixel_size, surface.length_unit) == ("1", None, None)
    assert surface.provenance["format"] == "npy"


def test_every_rule_is_recorded(tmp_path: Path, rough: Any) -> None:
    i, j = np.meshgrid(np.arange(12), np.arange(9), indexing="ij")
    tilted = rough + 0.5 * i - 0.25 * j
    tilted[2, 3] = tilted[7, 7] = math.nan
    path = saved(tmp_path, tilted)
    surface = read(str(path), unit="rms")
    record: Any = surface.provenance
    assert record["file"] == "surface.npy"
    assert record["sha256"] == hashlib.sha256(path.read_bytes()).hexdigest()
    assert record["original_shape"] == [12, 9]
    assert record["final_shape"] == list(surface.shape) == [24, 18]
    assert (record["undefined_rule"], record["undefined_pixels"]) == ("fill", 2)
    assert record["undefined_fraction"] == pytest.approx(2 / 108)
    assert (record["tilt_rule"], record["periodic_rule"]) == ("plane", "mirror")
    assert (record["original_unit"], record["unit"], surface.unit) == ("1", "rms", "rms")
    assert record["rms_before"] == pytest.approx(np.nanstd(tilted))
    assert record["rms_after"] == pytest.approx(1.0)
    # The record is enough to get the measured heights back.
    offset, *slopes = record["tilt_coefficients"]
    plane = offset + slopes[0] * i + slopes[1] * j
    back = surface.heights[:12, :9] / record["scale_factor"] + plane
    np.testing.assert_allclose(back[~np.isnan(tilted)], tilted[~np.isnan(tilted)], rtol=1e-12)
    assert surface.describe().undefined_pixels == 2


def test_provenance_holds_plain_values_only(tmp_path: Path, rough: Any) -> None:
    for value in read(saved(tmp_path, rough)).provenance.values():
        for entry in value if isinstance(value, list) else [value]:
            assert type(entry) in (str, int, float, bool)


def test_profiles_are_read_too(tmp_path: Path) -> None:
    profile = np.array([0.0, 1.0, math.nan, 3.0, 5.0])
    surface = read(saved(tmp_path, profile), tilt="mean", max_undefined=0.5)
    assert surface.shape == (10,)
    # The mean of the defined pixels is 2.25; the filled one, 2, takes no part in it.
    np.testing.assert_allclose(surface.heights[:5], np.array([0, 1, 2, 3, 5]) - 2.25)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1 2 3\n4 5 6\n", [[1, 2, 3], [4, 5, 6]]),
        ("# a comment\n\n  1\t2   3 \n4 5 6 # and another\n", [[1, 2, 3], [4, 5, 6]]),
        ("1,2,3\r\n4,5,6", [[1, 2, 3], [4, 5, 6]]),
        ("1; 2; 3\n4; 5; 6\n", [[1, 2, 3], [4, 5, 6]]),
        ("1\t2\t3\n4\t5\t6\n", [[1, 2, 3], [4, 5, 6]]),
        ("1,2,3,\n4,5,6,\n", [[1, 2, 3], [4, 5, 6]]),
        ("\ufeff1e0,+2,3.0\n4,5,6\n", [[1, 2, 3], [4, 5, 6]]),
        ("1\n2\n3\n", [1, 2, 3]),
        ("1 2 3\n", [1, 2, 3]),
        ("0,1,2\n1,,3\n2,3,4\n", [[0, 1, 2], [1, 2, 3], [2, 3, 4]]),
        ("0 1 2\n1 NaN 3\n2 3 4\n", [[0, 1, 2], [1, 2, 3], [2, 3, 4]]),
        ("5\t5\n\t\n5\t5\n", [[5, 5], [5, 5], [5, 5]]),
    ],
)
@pytest.mark.parametrize("suffix", ["txt", "csv", "dat", "TXT"])
def test_text_is_read_with_any_delimiter(tmp_path: Path, text: Any, expected: Any, suffix: Any) -> None:
    surface = read(written(tmp_path, text, f"surface.{suffix}"), max_undefined=0.5, **AS_IT_IS)
    np.testing.assert_allclose(surface.heights, expected, rtol=1e-14)
    assert surface.provenance["format"] == "text"


def test_text_and_npy_agree(tmp_path: Path, rough: Any) -> None:
    text = io.StringIO()
    np.savetxt(text, rough, fmt="%.17g", delimiter=";")
    one, other = read(written(tmp_path, text.getvalue())), read(saved(tmp_path, rough))
    np.testing.assert_array_equal(one.heights, other.heights)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x y z\n1 2 3\n", "expected only numbers in line 1, got 'x'; try a # before header lines"),
        ("# fine\n1,2\nheight,3\n", "expected only numbers in line 3, got 'height'"),
        ("1,5;2,5\n3,5;4,5\n", "expected only numbers in line 1, got '1,5"),
        ("1,5\t2,5\n", "expected only numbers in line 1"),
        ("1 2 3\n4 5\n", "expected 3 numbers in line 2, as in the first row, got 2"),
        ("1 2 3\n\n4 5 6 7\n", "expected 3 numbers in line 3, as in the first row, got 4"),
        ("# nothing\n\n", "expected a matrix of numbers, got no number at all"),
        ("Dear reader,\nthis is a letter.\n", "expected only numbers in line 1"),
        ("1 2\n3 inf\n", r"got 1 infinite of 4, the first at \[1, 1\]"),
        ("1 2\0\n", "expected text in UTF-8, got binary data"),
        (
            "".join(f"{i * 0.1} {i**2}\n" for i in range(9)),
            "got 2 columns that look like coordinates and a height",
        ),
        (
            "".join(f"{i},{j},{i * j}\n" for i in range(4) for j in range(5)),
            "got 3 columns that look like coord",
        ),
    ],
)
def test_text_that_is_no_matrix(tmp_path: Path, text: Any, message: Any) -> None:
    with pytest.raises(SurfaceFileError, match=f"surface.txt: .*{message}"):
        read(written(tmp_path, text))


@pytest.mark.parametrize("encoding", ["utf-16", "latin-1"])
def test_text_in_another_encoding(tmp_path: Path, encoding: Any) -> None:
    path = tmp_path / "surface.csv"
    path.write_bytes("# µm\n1,2\n".encode(encoding))
    with pytest.raises(SurfaceFileError, match="expected text in UTF-8, got a file of another kind"):
        read(path)


def test_narrow_matrices_are_still_matrices(tmp_path: Path) -> None:
    rough = np.random.default_rng(0).normal(size=(20, 3))
    text = "\n".join(" ".join(map(str, row)) for row in rough.tolist())
    np.testing.assert_array_equal(read(written(tmp_path, text), **AS_IT_IS).heights, rough)


@pytest.mark.parametrize("kept", [1, 5, 6, 9, 40, 127, 128, 129, 500, -1])
def test_truncated_npy(tmp_path: Path, rough: Any, kept: Any) -> None:
    path = saved(tmp_path, rough)
    path.write_bytes(path.read_bytes()[:kept])
    with pytest.raises(SurfaceFileError, match=r"surface.npy: .*damaged or truncated") as caught:
        read(path)
    assert "\n" not in str(caught.value)


def test_damaged_npy_headers_never_leak_another_error(tmp_path: Path, rough: Any) -> None:
    whole = saved(tmp_path, rough).read_bytes()
    rng = np.random.default_rng(0)
    refused = 0
    for _ in range(150):
        damaged = bytearray(whole)
        for place in rng.integers(6, 80, size=3):
            damaged[place] = rng.integers(256)
        path = tmp_path / "damaged.npy"
        path.write_bytes(bytes(damaged))
        try:
            read(path, max_undefined=0.99, **AS_IT_IS)
        except SurfaceFileError:
            refused += 1
    assert refused > 100


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"\x89PNG\r\n\x1a\n" + bytes(100), "expected a .npy file, got a file of another kind"),
        (pickle.dumps([1.0, 2.0]), "expected a .npy file, got a file of another kind"),
        (b"1 2 3\n4 5 6\n", "got a file of another kind; try its true extension"),
        (b"", "got an empty file"),
    ],
)
def test_other_kinds_named_npy(tmp_path: Path, content: Any, message: Any) -> None:
    path = tmp_path / "surface.npy"
    path.write_bytes(content)
    with pytest.raises(SurfaceFileError, match=message):
        read(path)


class Trap:
    """Leaves a file behind when it is unpickled."""

    def __init__(self, path: Any) -> None:
        self.path = path

    def __reduce__(self) -> Any:
        return os.mkdir, (self.path,)


def test_pickled_npy_is_refused_and_never_loaded(tmp_path: Path) -> None:
    path = saved(tmp_path, np.array([Trap(str(tmp_path / "sprung"))], dtype=object), allow_pickle=True)
    with pytest.raises(
        SurfaceFileError, match=r"got pickled Python objects; try numpy.save of an array of floats"
    ):
        read(path)
    assert not (tmp_path / "sprung").exists()


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (np.zeros((2, 3, 4)), r"got an array of type float64 and shape \(2, 3, 4\)"),
        (np.float64(1.0), r"shape \(\)"),
        (np.zeros((2, 2), dtype=complex), "type complex128"),
        (np.zeros((2, 2), dtype=bool), "type bool"),
        (np.array([["a"]]), "type <U1"),
        (np.zeros(2, dtype=[("x", "f8"), ("y", "f8")]), "got an array of type"),
    ],
)
def test_arrays_that_are_no_surface(tmp_path: Path, array: Any, message: Any) -> None:
    with pytest.raises(
        SurfaceFileError, match=f"expected real numbers in one or two dimensions, .*{message}"
    ):
        read(saved(tmp_path, array))


def test_empty_arrays(tmp_path: Path) -> None:
    with pytest.raises(SurfaceFileError, match=r"surface.npy: .*(shape \(0, 3\)|damaged)"):
        read(saved(tmp_path, np.zeros((0, 3))))


def test_paths_that_are_no_files(tmp_path: Path) -> None:
    with pytest.raises(SurfaceFileError, match=r"absent.npy: expected a surface file, got no such file"):
        read(tmp_path / "absent.npy")
    with pytest.raises(SurfaceFileError, match="got a directory"):
        read(tmp_path)
    paths: list[Any] = [3, None, "bad\0name.npy"]
    for path in paths:
        with pytest.raises(SurfaceFileError, match="surface file, got"):
            read(path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes on this system")
def test_pipes_are_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.npy")
    with pytest.raises(SurfaceFileError, match="got something that is not a regular file"):
        read(tmp_path / "pipe.npy")


def test_undefined_pixels_beyond_the_limit(tmp_path: Path, rough: Any) -> None:
    rough[0, 2] = rough[5] = math.nan
    path = saved(tmp_path, rough)
    assert read(path, max_undefined=10 / 108).provenance["undefined_pixels"] == 10
    with pytest.raises(
        SurfaceFileError,
        match=r"at most 0.05 .* undefined, got 10 of 108 undefined \(0.0926\), the first at \[0, 2\]",
    ):
        read(path, max_undefined=0.05)
    with pytest.raises(SurfaceFileError, match="expected no undefined pixel, got 10 of 108"):
        read(path, undefined="refuse")
    assert read(saved(tmp_path, np.eye(3)), undefined="refuse").provenance["undefined_rule"] == "refuse"


def test_nothing_defined(tmp_path: Path) -> None:
    with pytest.raises(SurfaceFileError, match=r"got 4 of 4 undefined \(1\)"):
        read(saved(tmp_path, np.full((2, 2), math.nan)), max_undefined=0.999)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"undefined": "zero"}, "undefined: expected one of 'fill', 'refuse', got 'zero'"),
        ({"tilt": "parabola"}, "tilt: expected one of 'plane', 'mean', 'none', got 'parabola'"),
        ({"periodic": True}, "periodic: expected one of 'mirror', 'taper', 'wrap', got True"),
        ({"unit": "furlong"}, "unit: expected one of None, 'm', 'mm', .*, got 'furlong'"),
        ({"unit": ["nm"]}, "unit: expected one of"),
        ({"max_undefined": 1.0}, "max_undefined: expected a fraction from 0 to below 1, got 1.0"),
        ({"max_undefined": -0.1}, "max_undefined: expected a fraction"),
        ({"max_undefined": math.nan}, "max_undefined: expected a fraction"),
        ({"max_undefined": None}, "max_undefined: expected a fraction"),
        ({"unit": "nm"}, "unit: .* got heights without a unit; try unit=None or 'rms'"),
        ({"channel": "Height"}, "expected no channel: this format has a single one, got channel='Height'"),
    ],
)
def test_options_are_checked(tmp_path: Path, rough: Any, options: Any, message: Any) -> None:
    with pytest.raises(InputError, match=message):
        read(saved(tmp_path, rough), **options)


def test_a_plane_has_no_rms_to_divide_by(tmp_path: Path) -> None:
    plane = np.add.outer(0.1 * np.arange(30), 0.3 * np.arange(20))
    with pytest.raises(InputError, match="expected a rough surface for unit='rms', got a flat one"):
        read(saved(tmp_path, plane), unit="rms")


def test_heights_whose_squares_overflow(tmp_path: Path) -> None:
    with pytest.raises(SurfaceFileError, match=r"expected heights of at most 1e\+60, got one of 1e\+200"):
        read(saved(tmp_path, np.array([[0.0, math.nan], [-1e200, 2.0]])), max_undefined=0.5)
