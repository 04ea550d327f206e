"""Small files as instruments and their programs write them, made of bytes, without any reading library.

And where measured ones are, which are no part of the repository.
"""

import importlib.util
import io
import os
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest

DATA = Path(os.environ.get("ASPERITY_DATA", Path(__file__).parents[1].parent / "shared" / "data"))
needs_library = pytest.mark.skipif(
    importlib.util.find_spec("SurfaceTopography") is None, reason="SurfaceTopography is not installed"
)
X3P = """<?xml version="1.0" encoding="UTF-8"?>
<p:ISO5436_2 xmlns:p="http://www.opengps.eu/2008/ISO5436_2"><Record1><Revision>{revision}</Revision>
<FeatureType>SUR</FeatureType><Axes><CX><AxisType>I</AxisType><DataType>D</DataType><Increment>{dx}</Increment>
<Offset>0</Offset></CX><CY><AxisType>I</AxisType><DataType>D</DataType><Increment>{dy}</Increment><Offset>0</Offset></CY>
<CZ><AxisType>A</AxisType><DataType>D</DataType><Increment>1</Increment><Offset>0</Offset></CZ></Axes></Record1>
<Record2><Date>{date}</Date></Record2><Record3><MatrixDimension><SizeX>{nx}</SizeX><SizeY>{ny}</SizeY><SizeZ>1</SizeZ>
</MatrixDimension><DataLink><PointDataLink>bindata/data.bin</PointDataLink></DataLink></Record3></p:ISO5436_2>"""


def text(heights: np.ndarray, header: str = "", separator: str = " ") -> bytes:
    """A matrix, below a header."""
    rows = (separator.join(f"{value:.17g}" for value in row) for row in np.atleast_2d(heights))
    return (header + "\n".join(rows) + "\n").encode()


def x3p(
    heights: np.ndarray, revision: str = "ISO5436 - 2000", date: str = "2026-11-26T13:33:41", dx: float = 1e-6
) -> bytes:
    """ISO 25178-72: points 1 um apart, lines 2 um apart, heights in m; lines from the first."""
    ny, nx = heights.shape
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        facts = {"revision": revision, "date": date, "nx": nx, "ny": ny, "dx": dx, "dy": 2e-6}
        archive.writestr("main.xml", X3P.format(**facts))
        archive.writestr("bindata/data.bin", heights.astype("<f8").tobytes())
    return file.getvalue()


def sdf(heights: np.ndarray, magic: str = "aISO-1.0") -> bytes:
    """ISO 25178-71: points 1 um apart, lines 2 um apart, heights in um; binary if the magic begins with b."""
    ny, nx = heights.shape
    if magic[0] == "b":
        head = struct.pack("<10s12s12sHHddddBBB", b"X", b"", b"", nx, ny, 1e-6, 2e-6, 1e-6, -1, 0, 7, 0)
        return magic.encode() + head + heights.astype("<f8").tobytes()
    lines = f"{magic}\nManufacID = X\nNumPoints = {nx}\nNumProfiles = {ny}\nXscale = 1e-6\nYscale = 2e-6\n"
    lines += "Zscale = 1e-6\nZresolution = -1\nCompression = 0\nDataType = 7\nCheckType = 0\n*\n"
    return text(heights, lines) + b"*\n"


def sur(raw: np.ndarray, unit: bytes = b"\xb5m", magic: bytes = b"DIGITAL SURF", month: int = 1) -> bytes:
    """Digital Surf: points 1 um apart, lines 2 um apart, whole heights in steps of 0.5 of the unit."""
    ny, nx = raw.shape
    head = magic + struct.pack("<HHHH30s30sHHHHH8xH", 0, 1, 1, 2, b"", b"", 0, 0, 0, 0, 0, 16)
    head += struct.pack("<iiiiIfff", raw.min(), raw.max(), nx, ny, nx * ny, 1.0, 2.0, 0.5)
    for word in (b"X", b"Y", b"Z", *[b"\xb5m", b"\xb5m", unit] * 2):
        head += struct.pack("<16s", word)
    head += struct.pack("<fffHHH12x", 1, 1, 1, 0, 0, 0)
    head += struct.pack("<7HfIIHHH128sfff34x", 0, 0, 0, 1, month, 2026, 1, 0.0, 0, 0, 0, 0, 0, b"", 0, 0, 0)
    return head + raw.astype("<i2").tobytes()


def gwy(fields: dict[str, tuple[np.ndarray, str]]) -> bytes:
    """Gwyddion: fields of 1 um a point and 2 um a line, from top to bottom, with units of their values."""

    def item(name: str, kind: str, value: bytes) -> bytes:
        return name.encode() + b"\0" + kind.encode() + value

    def whole(name: str, content: bytes) -> bytes:
        return name.encode() + b"\0" + struct.pack("<I", len(content)) + content

    def unit(name: str, text: str) -> bytes:
        return item(name, "o", whole("GwySIUnit", item("unitstr", "s", text.encode() + b"\0")))

    content = b""
    for number, (title, (heights, units)) in enumerate(fields.items()):
        ny, nx = heights.shape
        field = item("xres", "i", struct.pack("<i", nx)) + item("yres", "i", struct.pack("<i", ny))
        field += item("xreal", "d", struct.pack("<d", nx * 1e-6)) + item(
            "yreal", "d", struct.pack("<d", ny * 2e-6)
        )
        field += unit("si_unit_xy", "m") + unit("si_unit_z", units)
        data = struct.pack("<I", heights.size) + heights.astype("<f8").tobytes()
        field += item("data", "D", data)
        content += item(f"/{number}/data/title", "s", title.encode() + b"\0")
        content += item(f"/{number}/data", "o", whole("GwyDataField", field))
    return b"GWYP" + whole("GwyContainer", content)


def nms(raw: np.ndarray, pixel: float, lowest: bytes = struct.pack("<d", 2.0)) -> bytes:
    """NanoFocus: heights from 2 to 5 um in 65534 steps, and the distance of the pixels as it stands there."""
    ny, nx = raw.shape
    head = bytearray(3468)
    head[16:32] = lowest + struct.pack("<d", 5.0)
    head[1368:1392] = struct.pack("<IIdd", nx, ny, pixel, pixel)
    return bytes(head) + raw.astype("<u2").tobytes()


def stored(name: str) -> Path:
    """A measured file; the test is skipped without it."""
    if not (DATA / name).is_file():
        pytest.skip(f"{name} is not in {DATA}; set ASPERITY_DATA")
    return DATA / name


def write(name: str, content: bytes) -> str:
    """Write a file into the current folder."""
    Path(name).write_bytes(content)
    return name
