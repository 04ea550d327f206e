"""Reading matrices of heights: the order of the rules, the record of them, and what is refused."""

import hashlib
import io
import math
import os
import pickle
import zipfile
from itertools import cycle, product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from asperity.errors import InputError, SurfaceFileError
from asperity.surfaces import read
from tests.refusals import refuses

AS_IT_IS: dict[str, Any] = {"tilt": "none", "periodic": "wrap"}
ROUGH = np.random.default_rng(4).normal(size=(12, 9)) + 3.0
pytestmark = pytest.mark.usefixtures("here")


def saved(array, **options):
    np.save("surface.npy", array, **options)
    return "surface.npy"


def written(content, name="surface.txt"):
    Path(name).write_bytes(content if isinstance(content, bytes) else content.encode())
    return name


def read_refuses(path, name="", **options):
    with refuses(name or str(path), kind=InputError if name else SurfaceFileError):
        read(path, **options)


def test_every_rule_is_recorded():
    i, j = np.meshgrid(np.arange(12), np.arange(9), indexing="ij")
    tilted = ROUGH + 0.5 * i - 0.25 * j
    tilted[2, 3] = tilted[7, 7] = math.nan
    surface = read(saved(tilted), unit="rms", periodic="mirror")
    record: Any = surface.provenance
    known = {
        **{"file": "surface.npy", "format": "npy", "original_shape": [12, 9], "final_shape": [24, 18]},
        **{"undefined_rule": "fill", "undefined_pixels": 2, "undefined_fraction": pytest.approx(2 / 108)},
        **{"tilt_rule": "plane", "periodic_rule": "mirror", "original_unit": "1", "unit": "rms"},
        **{"rms_before": pytest.approx(np.nanstd(tilted)), "rms_after": pytest.approx(1.0)},
        "sha256": hashlib.sha256(Path("surface.npy").read_bytes()).hexdigest(),
    }
    assert {name: record[name] for name in known} == known
    assert (surface.shape, surface.unit, surface.pixel_size) == ((24, 18), "rms", None)
    # The record is enough to get the measured heights back.
    offset, *slopes = record["tilt_coefficients"]
    plane = offset + slopes[0] * i + slopes[1] * j
    back = surface.heights[:12, :9] / record["scale_factor"] + plane
    np.testing.assert_allclose(back[~np.isnan(tilted)], tilted[~np.isnan(tilted)], rtol=1e-12)
    for axis in (0, 1):  # its mirror images
        np.testing.assert_array_equal(surface.heights, np.flip(surface.heights, axis))
    plain = (entry for value in record.values() for entry in (value if isinstance(value, list) else [value]))
    assert {type(entry) for entry in plain} <= {str, int, float, bool}


def test_profiles_are_read_too():
    profile = np.array([0.0, 1.0, math.nan, 3.0, 5.0])
    surface = read(saved(profile), tilt="mean", max_undefined=0.5)
    assert (surface.shape, surface.edges) == ((5,), "reflecting")
    # The mean of the defined pixels is 2.25; the filled one, 2, takes no part in it.
    np.testing.assert_allclose(surface.heights, np.array([0, 1, 2, 3, 5]) - 2.25)


def test_text_is_read_with_any_delimiter():
    texts: dict[str, Any] = {
        "# a comment\n\n  1\t2   3 \n4 5 6 # and another\n": [[1, 2, 3], [4, 5, 6]],
        "1,5;2,5\n3,5;NA\n": [[1.5, 2.5], [3.5, 2.5 + 1 / 2]],
        '"1,5","2"\n"3,5","4,5"\n': [[1.5, 2], [3.5, 4.5]],
        "1,2,3\r\n4,5,6": [[1, 2, 3], [4, 5, 6]],
        "1,2,3,\n4,5,6,\n": [[1, 2, 3], [4, 5, 6]],
        "\ufeff1e0,+2,3.0\n4,5,6\n": [[1, 2, 3], [4, 5, 6]],
        "1\n2\n3\n": [1, 2, 3],
        "1 2 3\n": [1, 2, 3],
        "0,1,2\n1,,3\n2,3,4\n": [[0, 1, 2], [1, 2, 3], [2, 3, 4]],
        "5\t5\n\t\n5\t5\n": [[5, 5], [5, 5], [5, 5]],
    }
    for (text, expected), suffix in zip(texts.items(), cycle(("txt", "csv", "dat", "TXT")), strict=False):
        surface = read(written(text, f"surface.{suffix}"), max_undefined=0.5, **AS_IT_IS)
        np.testing.assert_allclose(surface.heights, expected, rtol=1e-14, err_msg=text)
        assert surface.provenance["format"] == "text"
    for encoding in ("utf-16", "latin-1"):
        surface = read(written("# µm\n1,2\n".encode(encoding)), **AS_IT_IS)
        np.testing.assert_array_equal(surface.heights, [1, 2])


def test_the_labels_of_pandas_are_no_heights():
    for index, header in product((True, False), repeat=2):
        pd.DataFrame(ROUGH).to_csv("surface.csv", index=index, header=header)
        surface = read("surface.csv", **AS_IT_IS)
        np.testing.assert_array_equal(surface.heights, ROUGH)
        told = [remark.rpartition(" ... of the ")[2] for remark in surface.remarks]
        assert told == ["lines"] * index + ["columns"] * header


def test_text_npz_and_npy_of_any_numbers_agree():
    whole = np.round(ROUGH, 2)
    for dtype in (">f4", "f8"):
        surface = read(saved(whole.astype(dtype)))
        np.testing.assert_allclose(surface.heights, read(saved(whole)).heights, atol=1e-5)
    plain = read(saved(ROUGH)).heights
    np.savetxt("surface.txt", ROUGH, fmt="%.17g", delimiter=";")
    np.testing.assert_array_equal(read("surface.txt").heights, plain)
    np.savez_compressed("surface.npz", h=ROUGH)
    other = read("surface.npz")
    np.testing.assert_array_equal(other.heights, plain)
    assert (other.provenance["format"], other.provenance["channel"]) == ("npz", "h")


def test_text_that_is_no_matrix():
    for text in (
        "x y z\n1 2 3\n",
        "1,5;2,5\n3,5;4.5\n",
        '"1,438",2\n',
        "1 2 3\n4 5\n",
        "1 2 3\n\n4 5 6 7\n",
        "# nothing\n\n",
        "1 2\n3 inf\n",
        "1 2\0\n",
    ):
        read_refuses(written(text))


def test_npz_of_several_arrays():
    np.savez("surface.npz", x=np.arange(9.0), h=ROUGH, names=np.array(["a"]))
    choices: list[Any] = ["h", 1]
    for channel in choices:
        np.testing.assert_array_equal(read("surface.npz", channel=channel, **AS_IT_IS).heights, ROUGH)
    for channel in (None, "names", 2, -1):
        read_refuses("surface.npz", channel=channel)
    np.savez("surface.npz", names=np.array(["a"]), traps=np.array([None]))
    read_refuses("surface.npz")


class Trap:
    """Leaves a file behind when it is unpickled."""

    def __reduce__(self):
        return os.mkdir, ("sprung",)


def test_what_is_damaged_or_no_surface():
    header = io.BytesIO()  # of an array that promises more than there is, and for which nothing is allocated
    form = {"descr": "<f8", "fortran_order": False, "shape": (10**7, 10**7)}
    np.lib.format.write_array_header_1_0(header, form)
    read_refuses(written(header.getvalue() + bytes(800), "huge.npy"))
    with zipfile.ZipFile("huge.npz", "w") as archive:
        archive.writestr("h.npy", header.getvalue() + bytes(800))
    read_refuses("huge.npz")
    for content in (b"\x89PNG\r\n\x1a\n" + bytes(100), pickle.dumps([1.0, 2.0]), b"1 2 3\n4 5 6\n", b""):
        read_refuses(written(content, "surface.npy"))
    for array in (
        np.zeros((2, 3, 4)),
        np.zeros((2, 2), dtype=complex),
        np.zeros(2, dtype=[("x", "f8"), ("y", "f8")]),
        np.zeros((0, 3)),
        np.full((2, 2), math.nan),
        np.array([[0.0, 1.0], [-1e200, 2.0]]),  # squares overflow
    ):
        read_refuses(saved(array), max_undefined=0.999)
    read_refuses(saved(np.array([Trap()], dtype=object), allow_pickle=True))
    assert not Path("sprung").exists()
    whole = Path(saved(ROUGH)).read_bytes()
    for kept in (1, 6, 9, 40, 127, 128, 129, -1):
        with pytest.raises(SurfaceFileError):
            read(written(whole[:kept], "surface.npy"))


def test_paths_that_are_no_files():
    Path("folder").mkdir()
    for path in ("absent.npy", "folder", *(["pipe.npy"] if hasattr(os, "mkfifo") else [])):
        if path == "pipe.npy":
            os.mkfifo(path)  # which nobody waits for
        read_refuses(path)
    others: list[Any] = [3, None, "bad\0name.npy"]
    for other in others:
        with pytest.raises(SurfaceFileError):
            read(other)


def test_undefined_pixels_beyond_the_limit():
    holed = ROUGH.copy()
    holed[0, 2] = holed[5] = math.nan
    path = saved(holed)
    assert read(path, max_undefined=10 / 108).provenance["undefined_pixels"] == 10
    read_refuses(path, max_undefined=0.05)
    read_refuses(path, undefined="refuse")
    assert read(saved(np.eye(3)), undefined="refuse").provenance["undefined_rule"] == "refuse"


def test_options_are_checked():
    path = saved(ROUGH)
    wrong: list[tuple[str, Any]] = [
        ("undefined", "zero"),
        ("tilt", "parabola"),
        ("periodic", True),
        *(("unit", value) for value in ("furlong", ["nm"], "nm")),
        *(("max_undefined", value) for value in (1.0, -0.1, None)),
        ("file_unit", "rms"),
        ("length_unit", "nm"),
        ("pixel_size", (1.0, 2.0, 3.0)),
        ("crop", [0, 5, 0, 99]),
    ]
    for name, value in wrong:
        read_refuses(path, name, **{name: value})
    read_refuses(path, channel="Height")
    plane = np.add.outer(0.1 * np.arange(30), 0.3 * np.arange(20))
    read_refuses(saved(plane), "unit", unit="rms")
