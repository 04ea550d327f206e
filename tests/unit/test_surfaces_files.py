"""Reading matrices of heights: the order of the rules, the record of them, and what is refused."""

import hashlib
import io
import math
import os
import pickle
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import asperity
from asperity.errors import InputError, SurfaceFileError
from asperity.fits import read_measurements
from asperity.surfaces import Surface, check_square, read

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
        ("1,5;2,5\n3,5;NA\n", [[1.5, 2.5], [3.5, 2.5 + 1 / 2]]),
        ('"1,5","2"\n"3,5","4,5"\n', [[1.5, 2], [3.5, 4.5]]),
        ("nan 2\n3 4\n", [[2.5, 2], [3, 4]]),
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


@pytest.mark.parametrize(
    "options", [{}, {"index": False}, {"header": False}, {"index": False, "header": False}]
)
def test_the_labels_of_pandas_are_no_heights(tmp_path: Path, rough: Any, options: Any) -> None:
    pd.DataFrame(rough).to_csv(tmp_path / "surface.csv", **options)
    surface = read(tmp_path / "surface.csv", **AS_IT_IS)
    np.testing.assert_array_equal(surface.heights, rough)
    told = [remark.rpartition(" ... of the ")[2] for remark in surface.remarks]
    labelled = {0: ["columns and lines"], 1: ["lines" if "header" in options else "columns"], 2: []}
    assert told == labelled[len(options)]


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
        ("1,5;2,5\n3,5;4.5\n", "expected only numbers in line 2, got '4.5'"),
        ('"1,438",2\n', "expected only numbers in line 1, got '1,438'"),
        ("1 2 3\n4 5\n", "expected 3 columns in line 2, as before, got '4 5'"),
        ("1 2 3\n\n4 5 6 7\n", "expected 3 columns in line 3, as before, got '4 5 6 7'"),
        ("# nothing\n\n", "expected a matrix of numbers, got no number at all"),
        ("Dear reader,\nthis is a letter.\n", "expected only numbers in line 1"),
        ("1 2\n3 inf\n", r"got 1 infinite of 4, the first at \[1, 1\]"),
        ("1 2\0\n", "expected text, got binary data"),
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
    np.testing.assert_array_equal(read(path, **AS_IT_IS).heights, [1, 2])


def test_narrow_matrices_are_still_matrices(tmp_path: Path) -> None:
    rough = np.random.default_rng(0).normal(size=(20, 3))
    text = "\n".join(" ".join(map(str, row)) for row in rough.tolist())
    np.testing.assert_array_equal(read(written(tmp_path, text), **AS_IT_IS).heights, rough)


def test_npz_and_npy_agree(tmp_path: Path, rough: Any) -> None:
    one, path = read(saved(tmp_path, rough)), tmp_path / "surface.npz"
    for options in ({"h": rough}, {"h": np.asfortranarray(rough), "when": np.array("today")}):
        np.savez_compressed(path, **options)
        other = read(path)
        np.testing.assert_array_equal(one.heights, other.heights)
        assert (other.provenance["format"], other.provenance["channel"]) == ("npz", "h")


def test_npz_of_several_arrays(tmp_path: Path, rough: Any) -> None:
    path = tmp_path / "surface.npz"
    np.savez(path, x=np.arange(9.0), h=rough, names=np.array(["a"]))
    choices: list[Any] = ["h", 1]
    for channel in choices:
        np.testing.assert_array_equal(read(path, channel=channel, **AS_IT_IS).heights, rough)
    others: list[Any] = [None, "names", 2, -1]
    for channel in others:
        with pytest.raises(SurfaceFileError, match=r"real numbers: 'x' \(number 0\), 'h' \(number 1\), got"):
            read(path, channel=channel)
    np.savez(path, names=np.array(["a"]), traps=np.array([None]))
    with pytest.raises(SurfaceFileError, match=r"expected an array of real numbers .*, got none"):
        read(path)


def test_headers_that_promise_more_than_there_is_allocate_nothing(tmp_path: Path) -> None:
    header = io.BytesIO()
    form = {"descr": "<f8", "fortran_order": False, "shape": (10**7, 10**7)}
    np.lib.format.write_array_header_1_0(header, form)
    (tmp_path / "huge.npy").write_bytes(header.getvalue() + bytes(800))
    with zipfile.ZipFile(tmp_path / "huge.npz", "w") as archive:
        archive.writestr("h.npy", header.getvalue() + bytes(800))
    for name in ("huge.npy", "huge.npz"):
        with pytest.raises(
            SurfaceFileError, match=r"truncated file .the header promises 800000000000000 bytes"
        ):
            read(tmp_path / name)


@pytest.mark.parametrize("kept", [1, 5, 6, 9, 40, 127, 128, 129, 500, -1])
def test_truncated_npy(tmp_path: Path, rough: Any, kept: Any) -> None:
    path = saved(tmp_path, rough)
    path.write_bytes(path.read_bytes()[:kept])
    with pytest.raises(SurfaceFileError, match=r"surface.npy: .*damaged or truncated") as caught:
        read(path)
    assert "\n" not in str(caught.value)


def test_damaged_npy_headers_never_leak_another_error(tmp_path: Path, rough: Any) -> None:
    np.savez_compressed(tmp_path / "surface.npz", h=rough, other=rough.astype("f4"))
    rng = np.random.default_rng(0)
    for path, begin, end in ((saved(tmp_path, rough), 6, 80), (tmp_path / "surface.npz", 0, 2400)):
        whole = path.read_bytes()
        refused = []
        for number in range(150):
            damaged = bytearray(whole[: rng.integers(1, len(whole))] if number % 5 == 0 else whole)
            for place in rng.integers(begin, min(end, len(damaged)), size=3) if len(damaged) > begin else ():
                damaged[place] = rng.integers(256)
            path.write_bytes(damaged)
            try:
                read(path, channel="h" if path.suffix == ".npz" else None, max_undefined=0.99, **AS_IT_IS)
            except SurfaceFileError as error:
                refused.append(str(error))
        assert len(refused) > 50
        assert "\n" not in "".join(refused)


def test_damaged_text_never_leaks_another_error(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    path = tmp_path / "surface.csv"
    pieces = [
        "1,5",
        "nan",
        "inf",
        "x",
        "1e999",
        "0x1",
        "µ",
        "\0",
        "²",
        "",
        "#",
        "%",
        '"',
        "'",
        "\ufeff",
        "\u2028",
    ]
    refused = []
    for _ in range(300):
        mark, shape = rng.choice([" ", ",", ";", "\t"]), rng.integers(1, 7, size=2)
        rows = [mark.join(map(str, row)) for row in rng.integers(1, 9, size=shape).tolist()]
        text = rng.choice(["\n", "\r\n"]).join(rows)
        for _ in range(rng.integers(0, 3)):
            place = rng.integers(len(text) + 1)
            text = text[:place] + rng.choice(pieces) + text[place + rng.integers(2) :]
        path.write_bytes(text.encode(rng.choice(["utf-8", "utf-16", "latin-1"]), errors="replace"))
        for reader in (lambda: read(path, max_undefined=0.9), lambda: read_measurements(path)):
            try:
                reader()
            except InputError as error:
                refused.append(str(error))
    assert 100 < len(refused) < 500
    assert "\n" not in "".join(refused)


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
        ({"tilt": "parabola"}, "tilt: expected one of 'plane', 'quadratic', 'mean', 'none', got 'parabola'"),
        ({"periodic": True}, "periodic: expected one of 'mirror', 'reflect', 'taper', 'wrap', got True"),
        ({"unit": "furlong"}, "unit: expected one of None, 'm', 'mm', .*, got 'furlong'"),
        ({"unit": ["nm"]}, "unit: expected one of"),
        ({"max_undefined": 1.0}, "max_undefined: expected a fraction from 0 to below 1, got 1.0"),
        ({"max_undefined": -0.1}, "max_undefined: expected a fraction"),
        ({"max_undefined": math.nan}, "max_undefined: expected a fraction"),
        ({"max_undefined": None}, "max_undefined: expected a fraction"),
        ({"unit": "nm"}, "unit: .* got heights without a unit; try no unit, or rms$"),
        ({"channel": "Height"}, "expected no channel: this format has a single one, got channel 'Height'"),
    ],
)
def test_options_are_checked(tmp_path: Path, rough: Any, options: Any, message: Any) -> None:
    with pytest.raises(InputError, match=message):
        read(saved(tmp_path, rough), **options)


def test_a_plane_has_no_rms_to_divide_by(tmp_path: Path) -> None:
    plane = np.add.outer(0.1 * np.arange(30), 0.3 * np.arange(20))
    with pytest.raises(InputError, match=r"expected a rough surface, .*, got a flat one"):
        read(saved(tmp_path, plane), unit="rms")


def test_heights_whose_squares_overflow(tmp_path: Path) -> None:
    with pytest.raises(SurfaceFileError, match=r"expected heights of at most 1e\+60, got one of 1e\+200"):
        read(saved(tmp_path, np.array([[0.0, math.nan], [-1e200, 2.0]])), max_undefined=0.5)


@pytest.fixture
def oblong(tmp_path: Path, rough: Any) -> Path:
    """Heights 3 nm apart along x and 1 nm along y, as a file of an instrument."""
    pytest.importorskip("SurfaceTopography", reason="needs asperity[instruments]")
    x, y = np.meshgrid(3.0 * np.arange(12), np.arange(9), indexing="ij")
    np.savetxt(tmp_path / "oblong.xyz", np.stack([x, y, rough], axis=-1).reshape(-1, 3))
    return tmp_path / "oblong.xyz"


def test_oblong_pixels_are_refused_where_they_would_be_taken_as_square(oblong: Path) -> None:
    surface = read(oblong)
    assert surface.pixel_size == pytest.approx((1, 3))
    assert surface.describe().shape == (18, 24)
    solid = asperity.solids.spring_lattice(k0=1, k1=1)
    for take in (check_square, lambda taken: asperity.press(taken, solid, load=1)):
        with pytest.raises(
            InputError,
            match=r"^heights: expected square pixels, got 1 between rows and 3 between columns; "
            r"try resample = true \(--resample\): means over 3$",
        ):
            take(surface)
    np.testing.assert_array_equal(np.asarray(surface), surface.heights)
    # Pixels that are square, or nearly, or of unknown size, pass, and so does what has none.
    for size in ((2.0, 2.01), (2.0, 2.0), None):
        check_square(Surface(surface.heights, "nm", size, "nm"))
    check_square(surface.heights)


def test_oblong_pixels_are_averaged_when_asked(oblong: Path, rough: Any) -> None:
    surface = read(oblong, resample=True, **AS_IT_IS)
    np.testing.assert_allclose(surface.heights, rough.T[::-1].reshape(3, 3, 12).mean(axis=1))
    assert surface.pixel_size == pytest.approx((3, 3))
    record = surface.provenance
    assert (record["resampled"], record["pixel_size"], record["final_shape"]) == (True, [3, 3], [3, 12])
    assert record["original_shape"] == [9, 12]
    assert read(oblong, unit="rms", resample=True).heights.std() == pytest.approx(1.0)


def test_outliers_are_counted_not_altered(tmp_path: Path) -> None:
    heights = np.random.default_rng(3).normal(size=(50, 60))
    calm = read(saved(tmp_path, heights))
    assert calm.remarks == ()
    heights[10, 7], heights[20, 30], heights[5, 5] = 8.0, 30.0, -30.0
    surface = read(saved(tmp_path, heights), **AS_IT_IS)
    (remark,) = surface.remarks
    assert remark.startswith(
        "pixels more than 6 robust standard deviations above the median height: 2, up to"
    )
    np.testing.assert_array_equal(surface.heights, heights)
    assert surface.provenance["outlying_pixels"] == 2
    assert surface.provenance["outlying_height"] == pytest.approx(30, rel=0.1)
    # Where most heights are equal, no scale tells which are far.
    assert read(saved(tmp_path, np.eye(9)), **AS_IT_IS).remarks == ()


class Quantity:
    """What a quantity of pint looks like from outside."""

    magnitude = np.ones((3, 3))
    units = "micrometer"

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        return self.magnitude


def test_heights_with_a_unit_are_refused() -> None:
    with pytest.raises(InputError, match=r"which has a unit; try heights\.magnitude, in the unit"):
        asperity.surfaces.check_heights(Quantity())
