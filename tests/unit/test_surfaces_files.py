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
from asperity.surfaces import Surface, check_square, read
from tests.refusals import refuses

AS_IT_IS: dict[str, Any] = {"tilt": "none", "periodic": "wrap"}
ROUGH = np.random.default_rng(4).normal(size=(12, 9)) + 3.0


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def saved(array: Any, **options: Any) -> str:
    np.save("surface.npy", array, **options)
    return "surface.npy"


def written(content: str | bytes, name: str = "surface.txt") -> str:
    Path(name).write_bytes(content if isinstance(content, bytes) else content.encode())
    return name


def read_refuses(path: Any, name: str = "", **options: Any) -> None:
    with refuses(name or str(path), kind=InputError if name else SurfaceFileError):
        read(path, **options)


@pytest.mark.parametrize("dtype", [">f4", "i2", "u1"])
def test_npy_is_read_as_it_is(dtype: str) -> None:
    array = np.arange(12).reshape(3, 4).astype(dtype)
    surface = read(saved(array), **AS_IT_IS)
    np.testing.assert_array_equal(surface.heights, array)
    assert surface.heights.dtype == np.float64
    assert (surface.unit, surface.pixel_size, surface.length_unit) == ("1", None, None)
    assert surface.provenance["format"] == "npy"


def test_every_rule_is_recorded() -> None:
    i, j = np.meshgrid(np.arange(12), np.arange(9), indexing="ij")
    tilted = ROUGH + 0.5 * i - 0.25 * j
    tilted[2, 3] = tilted[7, 7] = math.nan
    surface = read(saved(tilted), unit="rms")
    record: Any = surface.provenance
    assert record["file"] == "surface.npy"
    assert record["sha256"] == hashlib.sha256(Path("surface.npy").read_bytes()).hexdigest()
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
    plain = (entry for value in record.values() for entry in (value if isinstance(value, list) else [value]))
    assert {type(entry) for entry in plain} <= {str, int, float, bool}


def test_profiles_are_read_too() -> None:
    profile = np.array([0.0, 1.0, math.nan, 3.0, 5.0])
    surface = read(saved(profile), tilt="mean", max_undefined=0.5)
    assert surface.shape == (10,)
    # The mean of the defined pixels is 2.25; the filled one, 2, takes no part in it.
    np.testing.assert_allclose(surface.heights[:5], np.array([0, 1, 2, 3, 5]) - 2.25)


@pytest.mark.parametrize("suffix", ["txt", "csv", "dat", "TXT"])
def test_text_is_read_with_any_delimiter(suffix: str) -> None:
    texts: dict[str, Any] = {
        "# a comment\n\n  1\t2   3 \n4 5 6 # and another\n": [[1, 2, 3], [4, 5, 6]],
        "1,5;2,5\n3,5;NA\n": [[1.5, 2.5], [3.5, 2.5 + 1 / 2]],
        '"1,5","2"\n"3,5","4,5"\n': [[1.5, 2], [3.5, 4.5]],
        "nan 2\n3 4\n": [[2.5, 2], [3, 4]],
        "1,2,3\r\n4,5,6": [[1, 2, 3], [4, 5, 6]],
        "1; 2; 3\n4; 5; 6\n": [[1, 2, 3], [4, 5, 6]],
        "1,2,3,\n4,5,6,\n": [[1, 2, 3], [4, 5, 6]],
        "\ufeff1e0,+2,3.0\n4,5,6\n": [[1, 2, 3], [4, 5, 6]],
        "1\n2\n3\n": [1, 2, 3],
        "1 2 3\n": [1, 2, 3],
        "0,1,2\n1,,3\n2,3,4\n": [[0, 1, 2], [1, 2, 3], [2, 3, 4]],
        "5\t5\n\t\n5\t5\n": [[5, 5], [5, 5], [5, 5]],
    }
    for text, expected in texts.items():
        surface = read(written(text, f"surface.{suffix}"), max_undefined=0.5, **AS_IT_IS)
        np.testing.assert_allclose(surface.heights, expected, rtol=1e-14, err_msg=text)
        assert surface.provenance["format"] == "text"
    for encoding in ("utf-16", "latin-1")[suffix == "dat" :]:  # .dat with zeros is of an interferometer
        path = written("# µm\n1,2\n".encode(encoding), f"surface.{suffix}")
        np.testing.assert_array_equal(read(path, **AS_IT_IS).heights, [1, 2])


@pytest.mark.parametrize(
    "options", [{}, {"index": False}, {"header": False}, {"index": False, "header": False}]
)
def test_the_labels_of_pandas_are_no_heights(options: Any) -> None:
    pd.DataFrame(ROUGH).to_csv("surface.csv", **options)
    surface = read("surface.csv", **AS_IT_IS)
    np.testing.assert_array_equal(surface.heights, ROUGH)
    told = [remark.rpartition(" ... of the ")[2] for remark in surface.remarks]
    labelled = {0: ["columns and lines"], 1: ["lines" if "header" in options else "columns"], 2: []}
    assert told == labelled[len(options)]


def test_text_npz_and_npy_agree() -> None:
    plain = read(saved(ROUGH)).heights
    text = io.StringIO()
    np.savetxt(text, ROUGH, fmt="%.17g", delimiter=";")
    np.testing.assert_array_equal(read(written(text.getvalue())).heights, plain)
    for options in ({"h": ROUGH}, {"h": np.asfortranarray(ROUGH), "when": np.array("today")}):
        np.savez_compressed("surface.npz", **options)
        other = read("surface.npz")
        np.testing.assert_array_equal(other.heights, plain)
        assert (other.provenance["format"], other.provenance["channel"]) == ("npz", "h")


def test_text_that_is_no_matrix() -> None:
    for text in (
        "x y z\n1 2 3\n",
        "# fine\n1,2\nheight,3\n",
        "1,5;2,5\n3,5;4.5\n",
        '"1,438",2\n',
        "1 2 3\n4 5\n",
        "1 2 3\n\n4 5 6 7\n",
        "# nothing\n\n",
        "1 2\n3 inf\n",
        "1 2\0\n",
        "".join(f"{i * 0.1} {i**2}\n" for i in range(9)),
        "".join(f"{i},{j},{i * j}\n" for i in range(4) for j in range(5)),
    ):
        read_refuses(written(text))


def test_npz_of_several_arrays() -> None:
    np.savez("surface.npz", x=np.arange(9.0), h=ROUGH, names=np.array(["a"]))
    choices: list[Any] = ["h", 1]
    for channel in choices:
        np.testing.assert_array_equal(read("surface.npz", channel=channel, **AS_IT_IS).heights, ROUGH)
    others: list[Any] = [None, "names", 2, -1]
    for channel in others:
        read_refuses("surface.npz", channel=channel)
    np.savez("surface.npz", names=np.array(["a"]), traps=np.array([None]))
    read_refuses("surface.npz")


def test_headers_that_promise_more_than_there_is_allocate_nothing() -> None:
    header = io.BytesIO()
    form = {"descr": "<f8", "fortran_order": False, "shape": (10**7, 10**7)}
    np.lib.format.write_array_header_1_0(header, form)
    read_refuses(written(header.getvalue() + bytes(800), "huge.npy"))
    with zipfile.ZipFile("huge.npz", "w") as archive:
        archive.writestr("h.npy", header.getvalue() + bytes(800))
    read_refuses("huge.npz")


def test_what_is_cut_off_is_refused() -> None:
    whole = Path(saved(ROUGH)).read_bytes()
    for kept in (1, 5, 6, 9, 40, 127, 128, 129, 500, -1):
        with pytest.raises(SurfaceFileError):
            read(written(whole[:kept], "surface.npy"))


class Trap:
    """Leaves a file behind when it is unpickled."""

    def __reduce__(self) -> Any:
        return os.mkdir, ("sprung",)


def test_what_is_no_npy_or_no_surface() -> None:
    for content in (b"\x89PNG\r\n\x1a\n" + bytes(100), pickle.dumps([1.0, 2.0]), b"1 2 3\n4 5 6\n", b""):
        read_refuses(written(content, "surface.npy"))
    for array in (
        np.zeros((2, 3, 4)),
        np.float64(1.0),
        np.zeros((2, 2), dtype=complex),
        np.zeros((2, 2), dtype=bool),
        np.array([["a"]]),
        np.zeros(2, dtype=[("x", "f8"), ("y", "f8")]),
        np.zeros((0, 3)),
        np.full((2, 2), math.nan),
        np.array([[0.0, 1.0], [-1e200, 2.0]]),  # squares overflow
    ):
        read_refuses(saved(array), max_undefined=0.999)
    read_refuses(saved(np.array([Trap()], dtype=object), allow_pickle=True))
    assert not Path("sprung").exists()


def test_paths_that_are_no_files() -> None:
    Path("folder").mkdir()
    for path in ("absent.npy", "folder", *(["pipe.npy"] if hasattr(os, "mkfifo") else [])):
        if path == "pipe.npy":
            os.mkfifo(path)  # which nobody waits for
        read_refuses(path)
    others: list[Any] = [3, None, "bad\0name.npy"]
    for other in others:
        with pytest.raises(SurfaceFileError):
            read(other)


def test_undefined_pixels_beyond_the_limit() -> None:
    holed = ROUGH.copy()
    holed[0, 2] = holed[5] = math.nan
    path = saved(holed)
    assert read(path, max_undefined=10 / 108).provenance["undefined_pixels"] == 10
    read_refuses(path, max_undefined=0.05)
    read_refuses(path, undefined="refuse")
    assert read(saved(np.eye(3)), undefined="refuse").provenance["undefined_rule"] == "refuse"


def test_options_are_checked() -> None:
    path = saved(ROUGH)
    wrong: list[tuple[str, Any]] = [
        ("undefined", "zero"),
        ("tilt", "parabola"),
        ("periodic", True),
        ("unit", "furlong"),
        ("unit", ["nm"]),
        ("unit", "nm"),
        *(("max_undefined", value) for value in (1.0, -0.1, math.nan, None)),
        ("file_unit", "rms"),
        ("length_unit", "nm"),
        ("pixel_size", 0.0),
        ("pixel_size", (1.0, 2.0, 3.0)),
        ("crop", [0, 5, 0, 99]),
    ]
    for name, value in wrong:
        read_refuses(path, name, **{name: value})
    read_refuses(path, "shortest", shortest=3.0, longest=2.0)
    read_refuses(path, channel="Height")
    plane = np.add.outer(0.1 * np.arange(30), 0.3 * np.arange(20))
    read_refuses(saved(plane), "unit", unit="rms")


def test_oblong_pixels_are_refused_where_they_would_be_taken_as_square() -> None:
    surface = read(saved(ROUGH), pixel_size=(1.0, 3.0))
    solid = asperity.solids.spring_lattice(k0=1, k1=1)
    for take in (check_square, lambda taken: asperity.press(taken, solid, load=1)):
        with refuses("heights"):
            take(surface)
    np.testing.assert_array_equal(np.asarray(surface), surface.heights)
    # Pixels that are square, or nearly, or of unknown size, pass, and so does what has none.
    for size in ((2.0, 2.01), (2.0, 2.0), None):
        check_square(Surface(surface.heights, "nm", size, "nm"))
    check_square(surface.heights)


def test_oblong_pixels_are_averaged_when_asked() -> None:
    surface = read(saved(ROUGH), pixel_size=(1.0, 3.0), resample=True, **AS_IT_IS)
    np.testing.assert_allclose(surface.heights, ROUGH.reshape(4, 3, 9).mean(axis=1))
    record = surface.provenance
    assert (record["resampled"], record["pixel_size"], record["final_shape"]) == (True, [3, 3], [4, 9])
    assert record["original_shape"] == [12, 9]
    again = read(saved(ROUGH), pixel_size=(1.0, 3.0), resample=True, unit="rms")
    assert again.heights.std() == pytest.approx(1.0)


def test_outliers_are_counted_not_altered() -> None:
    heights = np.random.default_rng(3).normal(size=(50, 60))
    assert read(saved(heights)).remarks == ()
    heights[10, 7], heights[20, 30], heights[5, 5] = 8.0, 30.0, -30.0
    surface = read(saved(heights), **AS_IT_IS)
    assert len(surface.remarks) == 1
    np.testing.assert_array_equal(surface.heights, heights)
    assert surface.provenance["outlying_pixels"] == 2
    assert surface.provenance["outlying_height"] == pytest.approx(30, rel=0.1)
    # Where most heights are equal, no scale tells which are far.
    assert read(saved(np.eye(9)), **AS_IT_IS).remarks == ()
