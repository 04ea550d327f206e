"""Scans as instruments and their programs write them: read as what they are, or refused."""

import math
import struct
import time
import tracemalloc
import zipfile
from typing import Any

import numpy as np
import pytest
import scipy.io

from asperity.errors import SurfaceFileError
from asperity.surfaces import read
from asperity.surfaces.files import record_of
from asperity.surfaces.raw import RawSurface
from tests import instrument_files as files
from tests.instrument_files import needs_library, stored, write
from tests.refusals import refuses

AS_IT_IS: dict[str, Any] = {"tilt": "none", "periodic": "wrap", "max_undefined": 0.5}
RNG = np.random.default_rng(3)
H = RNG.normal(size=(5, 7))
WHOLE = RNG.integers(-99, 99, size=(5, 7))
WIDE = RNG.normal(size=(32, 20))
X, Y = np.meshgrid(0.5 * np.arange(20), 0.3 * np.arange(15) - 7.0)
Z = RNG.normal(size=(15, 20))
SPIP = "# x-pixels = 7\n# y-pixels = 5\n# x-length = 7000\n# y-length = 10000\n"
SPIP = f"# File Format = ASCII\n{SPIP}# x-unit = nm\n# y-unit = nm\n# z-unit = nm\n"
NOVA = "NX = 7\nNY = 5\nScale X = 1\nScale Y = 2\nUnit X = um\nUnit Y = um\nUnit Data = nm\nStart of Data :\n"
BOTH = np.c_[X[0], Z[:2].T]
POINTS = np.stack([X, Y, Z], axis=-1).reshape(-1, 3)
PROFILE = WIDE[:3].ravel()
pytestmark = pytest.mark.usefixtures("here")


def short(value):
    """Name of a case: no content of a file."""
    return value if isinstance(value, str) and len(value) < 12 else ""


def found(name, content=None, **options):
    """A surface, and its record."""
    surface = read(write(name, content) if content is not None else name, **AS_IT_IS, **options)
    return surface, surface.provenance


def hdf5(name, **arrays):
    """Arrays, each with its attributes."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(name, "w") as file:
        for path, (values, attributes) in arrays.items():
            file[path.replace("__", "/")] = values
            file[path.replace("__", "/")].attrs.update(attributes)
    return name


def arrays(name):
    """One matrix as programs for arrays write it: rows first, in memory and in the file."""
    match name:
        case "a.npy":
            np.save(name, H)
        case "a.npz":
            np.savez(name, h=np.asfortranarray(H), when=np.array("today"))
        case "a.mat":
            scipy.io.savemat(name, {"h": H, "dx": 0.5, "mask": H > 0})
        case "matlab.h5":  # columns first, as MATLAB 7.3 does
            word = (np.arange(9, dtype="u2")[:, None], {"MATLAB_class": np.bytes_("char")})
            hdf5(name, h=(H.T, {"MATLAB_class": np.bytes_("double")}), word=word)
        case "a.h5":
            hdf5(name, h=(H, {}))


@pytest.mark.parametrize("name", ["a.npy", "a.npz", "a.mat", "a.h5", "matlab.h5"])
def test_the_first_row_of_an_array_is_row_0(name):
    arrays(name)
    surface, record = found(name)
    np.testing.assert_array_equal(surface.heights, H)
    assert record["orientation"] == "row 0 is the first row of the array"


@needs_library
@pytest.mark.parametrize(
    # Each format stores its lines from the top of the picture; a point is 1 um wide, and a line 2 um.
    ("name", "content", "unit", "heights"),
    [
        ("a.gwy", files.gwy({"Phase": (H + 1, "deg"), "Height": (H, "m")}), "m", H),
        *(("a.sdf", files.sdf(H, f"{kind}-1.0"), "um", H) for kind in ("aISO", "bISO", "aBCR", "bBCR")),
        ("a.sdf", files.sdf(H, "aISO-2.0"), "um", H),
        ("a.txt", files.sdf(H, "aBCR-1.0"), "um", H),
        ("a.txt", files.text(H, SPIP), "nm", H),
        ("a.asc", files.text(H, NOVA), "nm", H),
        ("a.x3p", files.x3p(H), "m", H),
        ("a.x3p", files.x3p(H, revision="ISO5436 \u2013 2000", date="N/A"), "m", H),
        ("a.x3p", files.x3p(H, revision="ISO 5436-2"), "m", H),
        ("a.sur", files.sur(WHOLE), "um", WHOLE / 2),
        ("a.sur", files.sur(WHOLE, unit=b"\xc2\xb5m", month=13), "um", WHOLE / 2),
        ("a.sur", files.sur(WHOLE, unit=b"nm"), "nm", WHOLE / 2),
    ],
    ids=short,
)
def test_the_top_line_of_the_picture_is_row_0(name, content, unit, heights):
    surface, record = found(name, content)
    np.testing.assert_allclose(surface.heights, heights, rtol=1e-15)
    factor = {"m": 1e-6, "um": 1.0, "nm": 1e3}[unit]
    assert (surface.unit, surface.length_unit) == (unit, unit)
    assert surface.pixel_size == pytest.approx((2 * factor, factor))
    assert record["orientation"].startswith("row 0 is the top line of the picture")
    assert (record["size_from"], record["unit_from"]) == ("the file", "the file")


@needs_library
def test_members_of_an_archive_that_are_not_needed_are_not_read():
    for revision in ("ISO5436 - 2000", "ISO 5436-2"):
        write("a.x3p", files.x3p(H, revision=revision))
        with zipfile.ZipFile("a.x3p", "a", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("more/unrelated.bin", bytes(30_000_000))
        found("a.x3p")  # what is imported is no part of it
        tracemalloc.start()
        np.testing.assert_array_equal(found("a.x3p")[0].heights, H)
        most = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert most < 10_000_000


@needs_library
@pytest.mark.parametrize("side", [-48e-6, 0.0, math.nan])
def test_sizes_that_are_none_are_left_out_with_a_remark(side):
    at = f"Width: {7e6 * side:.9g} um\nHeight: 1 um\n"
    for name, content in (
        ("a.x3p", files.x3p(H, dx=side)),
        ("a.txt", files.text(H, at)),
        ("a.asc", files.text(H, f"ncols 7\nnrows 5\ncellsize {side}\n")),
    ):
        surface, record = found(name, content)
        assert surface.pixel_size is None
        assert [remark for remark in surface.remarks if "left out the size of the pixels" in remark]
        assert found(name, pixel_size="2 um")[0].pixel_size == (2.0, 2.0)
        assert record["size_from"] == ""


@pytest.mark.parametrize("separator", [" ", ","])
def test_wide_lines_are_read_as_quickly_as_others(separator):
    values = np.random.default_rng(0).normal(size=(100, 100))

    def seconds(shape):
        write("a.txt", files.text(values.reshape(shape), separator=separator))
        begun = time.process_time()
        np.testing.assert_array_equal(found("a.txt")[0].heights, values.reshape(shape))
        return time.process_time() - begun

    seconds((100, 100))
    assert min(seconds((2, 5_000)) for _ in range(2)) < 6 * min(seconds((100, 100)) for _ in range(2))


@needs_library
def test_one_scan_that_another_program_wrote_both_ways():
    """Its first ten lines are five times as rough: 4.9741 nm about their plane."""
    top = 1e9 * np.loadtxt(stored("scans/top-rough.txt"))[:10]
    terms = np.stack([np.ones(600), *np.indices((10, 60)).reshape(2, -1)], axis=1)
    left = top.ravel() - terms @ np.linalg.lstsq(terms, top.ravel(), rcond=None)[0]
    assert left.std() == pytest.approx(4.9741, abs=5e-5)
    for name in ("top-rough.gwy", "top-rough.txt"):
        level = read(stored(f"scans/{name}"), crop=[0, 10, 0, 60], unit="nm", file_unit="m", periodic="wrap")
        assert level.heights.std() == pytest.approx(left.std(), rel=1e-6)


ESRI = "NCOLS 7\nnrows 5\nXLLCENTER 0.0\nyllcorner 0.0\nCellSize 0.5\nNoData_Value {}\n"


@pytest.mark.parametrize("void", [-9999.0, -32768.0, 0.0, 1e38, -3.4028234663852886e38])
def test_a_value_stands_for_undefined_pixels(void):
    known = np.eye(5, 7) == 0
    holed = np.where(known, H, void)
    for name, content, options in (
        ("a.asc", files.text(holed, ESRI.format(f"{void:g}")), {}),
        ("a.txt", files.text(holed, ESRI.format(f"{void:.9g}").lower()), {}),
        ("a.txt", files.text(holed), {"undefined_value": void}),
    ):
        surface, record = found(name, content, **options)
        assert record["undefined_pixels"] == 5
        np.testing.assert_array_equal(surface.heights[known], H[known])
        assert [rule.rpartition(": ")[2] for rule in record["undefined_by"]] == ["5 pixels"]
        assert surface.pixel_size == (None if options else (0.5, 0.5))
    np.save("a.npy", holed.astype("f4"))
    scipy.io.savemat("a.mat", {"h": holed})
    hdf5("a.h5", h=(holed, {"_FillValue": void}))
    one = np.array([void])  # as netCDF-4 has it
    hdf5("a.nc", h=(holed, {"_FillValue": one, "scale_factor": one**0, "units": np.array([b"um"], "S2")}))
    hdf5("b.nc", h=(holed, {"missing_value": one}))
    for name in ("a.npy", "a.mat", "a.h5", "a.nc", "b.nc"):
        options = {"undefined_value": void} if name in ("a.npy", "a.mat") else {}
        assert found(name, **options)[1]["undefined_pixels"] == 5
    assert found("a.nc")[0].unit == "um"
    holed = np.where(known, H, np.nan)  # which may be the value of a header
    assert found("a.asc", files.text(holed, ESRI.format("nan")))[1]["undefined_pixels"] == 5


@pytest.mark.parametrize(
    ("labels", "numbers"),
    [
        (("Channel", "Width", "Height", "Value units"), ("7.00", "10.00")),
        (("Kanal", "Breite", "H\u00f6he", "Einheiten"), ("7,00", "10,00")),
        (("Canal", "Largeur", "Hauteur", "Unit\u00e9s"), ("7.00", "1e1")),
    ],
)
def test_sizes_and_units_of_the_header(labels, numbers):
    channel, width, height, units = labels
    header = f"# {channel}: H\u00f6he\n# {width}: {numbers[0]} \u00b5m\n# {height}: {numbers[1]} \u03bcm\n"
    header += f"# {units}: nm\n"
    surface, record = found("a.txt", files.text(H, header))
    assert (surface.unit, surface.length_unit, record["channel"]) == ("nm", "um", "H\u00f6he")
    assert surface.pixel_size == pytest.approx((2.0, 1.0))
    np.testing.assert_array_equal(surface.heights, H)
    in_um, record = found("a.txt", unit="um", pixel_size=0.5, length_unit="mm")
    assert (in_um.pixel_size, in_um.length_unit, record["size_from"]) == ((0.5, 0.5), "mm", "pixel_size")


def two(first, second):
    return files.text(H, first) + files.text(WIDE, second)


@pytest.mark.parametrize(
    ("name", "content", "channel", "right"),
    [
        ("a.txt", two("# Channel: Z (trace)\n", "# Channel: Z (retrace)\n"), "Z (retrace)", WIDE),
        ("a.txt", two("# Channel: Z\n# Value units: m\n", "# Channel: Z\n# Value units: m\n"), 1, WIDE),
        ("a.csv", two("", "\n"), 0, H),
        ("a.dat", two("# slice\n", "# slice\n"), "matrix#2", WIDE),
        ("a.csv", files.text(BOTH, "X (mm);Z raw (um);Z level (um)\n", ";"), "Z level (um)", Z[1]),
        ("a.csv", files.text(BOTH, "x_um;z_nm;z_nm\n", ";"), "z_nm#2", Z[1]),
    ],
    ids=short,
)
def test_of_several_channels_in_one_text_none_is_taken(name, content, channel, right):
    with refuses(name, "none", kind=SurfaceFileError):
        found(name, content)
    surface, record = found(name, channel=channel)
    np.testing.assert_array_equal(surface.heights, right)
    assert len(record["channels"]) == 2


def test_of_several_arrays_none_is_taken():
    scipy.io.savemat("a.mat", {"x": X[0], "y": Y[:, 0], "z": Z})
    hdf5("a.h5", scan__z=(Z, {}), x=(X[0], {}))
    for name, channel in (("a.mat", "z"), ("a.h5", "scan/z")):
        with refuses(name, "none", kind=SurfaceFileError):
            found(name)
        np.testing.assert_array_equal(found(name, channel=channel)[0].heights, Z)


def test_what_stands_beside_heights_is_not_pressed():
    beside: dict[str, Any] = {"thumbnail": (WHOLE, {}), "scan__row_index": (WHOLE, {})}
    beside |= {"photo": (WHOLE.astype("u1"), {}), "Phase": (H, {})}
    surface, record = found(hdf5("a.h5", h=(H, {"units": "\u00b5m", "scale_factor": 2.0}), **beside))
    np.testing.assert_array_equal(surface.heights, 2 * H)
    assert (surface.unit, record["channels"]) == ("um", ["h"])
    assert found("a.h5", channel="Phase")[1]["channel"] == "Phase"
    hdf5("volts.h5", h=(H, {"units": "V"}))
    hdf5("a.h5-jpk", Measurement_000__Channel_000__Height=(np.zeros((64, 4)), {}))
    for name in (hdf5("b.h5", **beside), "volts.h5", "a.h5-jpk"):
        with refuses(name, kind=SurfaceFileError):
            found(name)
    with refuses("a.txt", "'Phase' in deg", kind=SurfaceFileError):
        found("a.txt", files.text(H, "# Channel: Phase\n# Width: 1 um\n# Height: 1 um\n# Value units: deg\n"))


TABLE = np.zeros((33, 21))
TABLE[1:, 1:], TABLE[0, 1:], TABLE[1:, 0] = WIDE, 1e-6 * np.arange(20), -0.25e-6 * np.arange(32)
STEP = (0.3, 0.5)
PLANE = np.add.outer(0.1 * np.arange(30), 0.3 * np.arange(20))
STEPS = np.arange(60)
GWYDDION, STYLUS = "# Lateral units: \u00b5m\n# Value units: nm\n", "Tip, 2\nX (mm), Z (um)\n"
WEG = files.text(np.c_[0.1 * STEPS, PROFILE], separator=";").replace(b".", b",")
WEG = "L\u00e4nge [mm];H\u00f6he [\u00b5m]\n".encode("latin-1") + WEG
XY = "x in \u00b5m,y in nm\n"
DEKTAK = files.text(np.c_[np.round(0.156 * STEPS, 1), PROFILE], separator=",").replace(b"\n", b",,\n")
DEKTAK = b"Scan Parameters\nStylus,Radius: 2.5 um\n\nScan Data\nLateral um,Raw Micrometer,\n" + DEKTAK
NUMBERED = np.c_[np.arange(1, 33), WIDE]
PLACES = "Position X (um);Position Y (um);H\u00f6he (nm);z std (nm)\n"
LINE = "x [um] y [um] z [nm]\n"
LEVEL = np.full(60, 2.5)


@pytest.mark.parametrize(
    ("name", "content", "heights", "pixel", "units"),
    [
        ("a.xyz", files.text(np.c_[POINTS, np.arange(300) % 7]), Z[::-1], STEP, ("1", None)),
        ("a.txt", files.text(POINTS), Z[::-1], STEP, ("1", None)),
        ("a.txt", b"\n".join(map(files.text, np.split(POINTS, 15))), Z[::-1], STEP, ("1", None)),
        ("a.csv", files.text(np.c_[np.arange(300), POINTS], "", ","), Z[::-1], STEP, ("1", None)),
        ("a.csv", files.text(POINTS, "X [mm],Y [mm],Z [um]\n", ","), Z[::-1], STEP, ("um", "mm")),
        ("a.csv", files.text(POINTS, "x,y,z\nmm,mm,um\n", ","), Z[::-1], STEP, ("um", "mm")),
        ("a.csv", files.text(POINTS, "X Position [cm],Y [cm],Z_UM\n", ","), Z[::-1], STEP, ("um", "cm")),
        ("a.csv", files.text(POINTS, "x_MM,y_MM,z_m\n", ","), Z[::-1], STEP, ("m", "mm")),
        ("a.xyz", files.text(POINTS, GWYDDION), Z[::-1], STEP, ("nm", "um")),
        ("a.txt", files.text(np.c_[np.round(0.16 * STEPS, 1), PROFILE]), PROFILE, (0.16,), ("1", None)),
        ("a.xyz", files.text(np.c_[np.round(1.57 * STEPS), PROFILE]), PROFILE, (1.57,), ("1", None)),
        ("a.csv", files.text(np.c_[0.1 * STEPS, PROFILE], STYLUS, ","), PROFILE, (0.1,), ("um", "mm")),
        ("a.csv", WEG, PROFILE, (0.1,), ("um", "mm")),
        ("a.csv", DEKTAK, PROFILE, (0.156,), ("um", "um")),
        ("a.csv", files.text(np.c_[0.1 * STEPS, PROFILE], XY, ","), PROFILE, (0.1,), ("nm", "um")),
        (
            "a.csv",
            PLACES.encode() + files.text(np.c_[POINTS, 0 * POINTS[:, 0]], "", ";"),
            Z[::-1],
            STEP,
            ("nm", "um"),
        ),
        ("line.xyz", files.text(np.c_[0.1 * STEPS, LEVEL, PROFILE], LINE), PROFILE, (0.1,), ("nm", "um")),
        (
            "line.xyz",
            files.text(np.c_[LEVEL, 0.1 * STEPS, PROFILE], LINE),
            PROFILE[::-1],
            (0.1,),
            ("nm", "um"),
        ),
        ("a.txt", files.text(TABLE), WIDE, (0.25e-6, 1e-6), ("1", None)),
        ("a.txt", files.text(TABLE[:, 1:]), WIDE, None, ("1", None)),
        ("a.txt", files.text(TABLE[1:]), WIDE, None, ("1", None)),
        ("a.txt", files.text(NUMBERED), WIDE, None, ("1", None)),
        ("a.txt", files.text(np.c_[STEPS, PROFILE]), PROFILE, None, ("1", None)),
        ("a.txt", b"\n\n".join(map(files.text, H[:, None])), H, None, ("1", None)),
        ("a.asc", files.text(PLANE), PLANE, None, ("1", None)),  # of which no line is a label
    ],
    ids=short,
)
def test_coordinates_and_numbers_are_no_heights(name, content, heights, pixel, units):
    surface, _ = found(name, content)
    np.testing.assert_allclose(surface.heights, heights, rtol=1e-15)
    assert (surface.unit, surface.length_unit) == units
    assert surface.pixel_size == (None if pixel is None else pytest.approx(pixel, rel=0.01))


def test_a_profile_with_missing_points():
    x = np.delete(0.5 * np.arange(60), [7, 31])
    surface, record = found("a.xyz", files.text(np.c_[x, np.delete(PROFILE, [7, 31])]))
    assert (surface.shape, record["undefined_pixels"]) == ((60,), 2)
    np.testing.assert_array_equal(np.delete(surface.heights, [7, 31]), np.delete(PROFILE, [7, 31]))


@pytest.mark.parametrize("separator", ["\t", ",", ";"])
def test_empty_cells_at_the_end_of_all_rows_are_undefined_pixels(separator):
    rows = [separator.join([*map(repr, row), "", "", ""]) for row in WIDE.tolist()]
    surface, record = found("a.csv", "\n".join(rows).encode())
    assert (surface.shape, record["undefined_pixels"]) == ((32, 23), 96)
    np.testing.assert_array_equal(surface.heights[:, :20], WIDE)
    ended = files.text(WIDE, "", separator).replace(b"\n", f"{separator}\n".encode())
    assert found("b.csv", ended)[0].shape == (32, 20)


def test_a_remark_is_made_once():
    raw = RawSurface(H, "jpk", "a reader", remarks=("an unknown tag",) * 33)
    assert record_of(raw)["reader_remarks"] == ["an unknown tag"]


def test_headers_that_nobody_understands():
    for content in (
        files.text(H, "Scale = 3\n"),
        files.text(H, ESRI.format("-1").replace("7", "8")),
        files.text(H, "# Width: 5 V\n# Height: 5 V\n"),
        files.text(POINTS, "x (mm),y (um),z (um)\n", ","),
        files.text(np.c_[np.sort(RNG.uniform(size=60)), PROFILE]),
        files.sdf(H, "aISO-3.0"),
    ):
        with refuses("a.asc", kind=SurfaceFileError):
            found("a.asc", content)
    (remark,) = found("a.txt", files.text(H, "# measured today\n# z-scale = 3\n"))[0].remarks
    assert "z-scale = 3" in remark


@needs_library
def test_the_extension_tells_the_format():
    right = 2.0 + (WHOLE + 100) * 3.0 / 65534
    for pixel in (312.5, 312.5e-6):  # in nm, and in mm: no confocal microscope has pixels of a meter
        surface, _ = found("a.nms", files.nms(WHOLE + 100, pixel))
        np.testing.assert_allclose(surface.heights, right, rtol=1e-15)
        assert surface.pixel_size == pytest.approx((0.3125, 0.3125))
    for name in ("confocal-1.nms", "confocal-2.nms"):
        path = stored(f"scans/{name}")
        surface, record = found(path)
        assert record["physical_size"] == pytest.approx((20.0, 20.0))
        nx, ny = struct.unpack("<II", path.read_bytes()[1368:1376])
        low, high = struct.unpack("<dd", path.read_bytes()[16:32])
        raw = np.frombuffer(path.read_bytes(), "<u2", count=nx * ny, offset=3468).reshape(ny, nx)
        np.testing.assert_allclose(surface.heights, low + raw * (high - low) / 65534, rtol=1e-12)


@needs_library
def test_whole_files_of_another_kind_are_not_called_damaged():
    with scipy.io.netcdf_file("a.nc", "w") as file:
        for axis, n in (("x", 7), ("y", 5)):
            file.createDimension(axis, n)
            places: Any = file.createVariable(axis, "d", (axis,))
            places[:], places.unit, places.length = np.arange(n), "um", float(n)
        heights: Any = file.createVariable("heights", "d", ("x", "y"))
        heights[:], heights.unit = H.T, "nm"
    for name, got, content in (
        ("a.nc", "", None),
        ("a.sur", "'%'", files.sur(WHOLE, unit=b"%")),
        ("a.sdf", "'0'", files.sdf(H[:0], "bISO-1.0")),
        ("b.sur", "a compressed one", files.sur(WHOLE, magic=b"DSCOMPRESSED")),
        ("a.gwy", "", files.gwy({"Phase": (H, "deg")})),
    ):
        with refuses(name, got, kind=SurfaceFileError) as raised:
            found(name, content)
        assert "damaged" not in str(raised.value)


def test_heights_without_a_unit_are_given_that_of_the_file(tmp_path):
    np.savetxt(tmp_path / "scan.txt", H)
    with refuses("unit", "heights without a unit", advice="file_unit='um'"):
        read(tmp_path / "scan.txt", unit="um", tilt="none")
    surface = read(tmp_path / "scan.txt", unit="um", tilt="none", file_unit="um")
    np.testing.assert_allclose(surface.heights, H)


@pytest.mark.parametrize("name", ["z*1000", "z/1000", "log z", "ln_z", "Profiltiefe", "profile depth"])
def test_columns_of_other_numbers_are_no_heights(name):
    rows = "".join(f"{0.5 * n};{n % 3}\n" for n in range(20))
    with pytest.raises(SurfaceFileError):
        found("p.csv", f"x (um);{name} (um)\n{rows}".encode())
