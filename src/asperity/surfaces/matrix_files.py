"""Arrays of heights in files: numpy's ``.npy`` and ``.npz``, MATLAB's ``.mat``, and HDF5.

They state no pixel size, and a unit only in HDF5. The first axis is the rows, the second the columns.
"""

from __future__ import annotations

import contextlib
import math
import re
import warnings
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from asperity.base import checks
from asperity.base.readable import is_length
from asperity.base.units import factor
from asperity.base.words import reason_of
from asperity.errors import SurfaceFileError
from asperity.lattice import Field
from asperity.surfaces.prepare import spelled
from asperity.surfaces.raw import RawSurface, choose, without

_EXPECTED = "real numbers in one or two dimensions"
_NUMERIC = re.compile("double|single|u?int(8|16|32|64)")  # MATLAB's classes of numbers
# HDF5 of JPK and of pycroscopy, in which the pixels of an image are a column.
_FLATTENED = re.compile(r"(^|/)Measurement_\d+/Channel_\d+/", re.IGNORECASE)
# Arrays beside heights in files of instruments.
_OTHERS = re.compile("(?i)thumb|preview|phase|index|indices|mask|valid|error|ampl|intens|deflection")


def read_npy(path: Path, channel: str | int | None) -> RawSurface:
    """Read a ``.npy`` file of real numbers; pickled objects are refused, not loaded."""
    if channel is not None:
        choose(str(path), channel, {})
    with _one_error(path, ".npy", npy.MAGIC_PREFIX), path.open("rb") as file:
        _, fault = _header(file, path.stat().st_size)
        if fault:
            advice = "numpy.save of an array of floats" if "objects" in fault else ""
            raise SurfaceFileError(str(path), expected=_EXPECTED, got=fault, advice=advice)
        file.seek(0)
        return RawSurface(_heights(npy.read_array(file)), format="npy")


def read_npz(path: Path, channel: str | int | None) -> RawSurface:
    """Read one array of a ``.npz`` file, by its name or number; by None the only one."""
    with _one_error(path, ".npz", b"PK"), zipfile.ZipFile(path) as archive:
        shapes: dict[str, tuple[int, ...]] = {}
        for info in archive.infolist():
            with archive.open(info) as file:
                if info.filename.endswith(".npy"):
                    shape, fault = _header(file, info.file_size)
                    shapes |= {} if fault else {info.filename.removesuffix(".npy"): shape}
        chosen = _chosen(path, channel, shapes)
        with archive.open(f"{chosen}.npy") as file:
            heights = _heights(npy.read_array(file))
    return RawSurface(heights, format="npz", channel=chosen, channels=tuple(shapes))


def read_mat(path: Path, channel: str | int | None) -> RawSurface:
    """Read one matrix of a MATLAB file; of version 7.3 see `read_hdf5`."""
    from scipy.io import loadmat, whosmat

    with path.open("rb") as file:
        if file.read(10) == b"MATLAB 7.3":
            return read_hdf5(path, channel)
    with _one_error(path, ".mat"):
        matrices = [(name, shape) for name, shape, kind in whosmat(path) if _NUMERIC.fullmatch(kind)]
        shapes = {name: shape for name, shape in matrices if len(shape) == 2 and math.prod(shape) > 1}
        chosen = _chosen(path, channel, shapes)
        heights = _heights(loadmat(path, variable_names=[chosen])[chosen])
    return RawSurface(heights, format="mat", channel=chosen, channels=tuple(shapes))


def read_hdf5(path: Path, channel: str | int | None) -> RawSurface:
    """Read one array of an HDF5 file; by None the only one whose name and unit may be those of heights.

    Arrays of MATLAB, which it marks, have columns first; all others have rows first.
    """
    with checks.extra("instruments", f"{path}: reading HDF5"):
        import h5py
    arrays: dict[str, Any] = {}

    def visit(name: str, node: Any) -> None:
        if name[0] == "#" or not isinstance(node, h5py.Dataset) or node.is_scale:
            return  # data of MATLAB's cells, a group, or coordinates
        real = node.dtype.kind in "iuf" and len(node.shape or ()) in (1, 2) and node.size > 1
        named = _NUMERIC.fullmatch(_text(node, "MATLAB_class") or "double")
        if real and named and "MATLAB_empty" not in node.attrs:
            arrays[name] = node

    with _one_error(path, "HDF5"), h5py.File(path) as file:
        file.visititems(visit)
        if any(map(_FLATTENED.search, arrays)):
            got = "images or spectra whose pixels are one column"
            advice = "a single image, exported in another format"
            raise SurfaceFileError(str(path), expected="a matrix of heights", got=got, advice=advice)
        units = {name: spelled(_text(node, "units") or _text(node, "unit")) for name, node in arrays.items()}
        lengths = [name for name in arrays if units[name] == "1" or is_length(units[name])]
        likely = [name for name in lengths if arrays[name].dtype.itemsize > 1 and not _OTHERS.search(name)]
        listed = likely if channel is None else list(arrays)
        if arrays and not listed:
            got = ", ".join(f"{name!r} in {units[name]}".removesuffix(" in 1") for name in arrays)
            first = next(iter(arrays))
            cure = {"channel": first} | ({"file_unit": "mm"} if factor(units[first], "m") else {})
            raise SurfaceFileError(str(path), expected="the name of an array of heights", got=got, cure=cure)
        chosen = _chosen(path, channel, {name: arrays[name].shape for name in listed})
        node = arrays[chosen]
        void = float(_attribute(node, "_FillValue", _attribute(node, "missing_value", math.nan)))
        values, rule = without(_heights(node[...]), void, "fill value")
        values = values * _attribute(node, "scale_factor", 1.0) + _attribute(node, "add_offset", 0.0)
        turned = "MATLAB_class" in node.attrs or _axes(node) == ["x", "y"]
        heights = _heights(values.T if turned else values)
    return RawSurface(
        heights,
        "hdf5",
        unit=units[chosen],
        channel=chosen,
        channels=tuple(likely),
        undefined_by=(rule,) * math.isfinite(void),
    )


def _axes(node: Any) -> list[str]:
    """Names of the axes, in small letters; empty where they have none."""
    names = (next((scale.name for scale in axis.values()), axis.label) for axis in node.dims)
    return [str(name).rpartition("/")[2].lower() for name in names]


@contextlib.contextmanager
def _one_error(path: Path, kind: str, magic: bytes = b"") -> Iterator[None]:
    """Check how a file begins; turn all errors of libraries into one."""
    with path.open("rb") as file:
        begin = file.read(len(magic))
    if begin != magic[: len(begin)]:
        got, advice = "a file of another kind", "its true extension"
        raise SurfaceFileError(str(path), expected=f"a {kind} file", got=got, advice=advice)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about headers of Python 2
            yield
    except (SurfaceFileError, MemoryError):
        raise
    # Damaged headers and members raise errors of many classes.
    except Exception as error:
        got = f"a damaged or truncated file ({reason_of(error)})"
        raise SurfaceFileError(str(path), expected=f"a {kind} file of numbers", got=got) from error


def _header(file: IO[bytes], size: int) -> tuple[tuple[int, ...], str]:
    """Read the shape of an array, and why it cannot be heights; "" if it can.

    `ValueError` if the header is damaged, or promises more than the `size` bytes of the file.
    """
    try:
        header = npy.read_array_header_1_0 if npy.read_magic(file) == (1, 0) else npy.read_array_header_2_0
        shape, _, dtype = header(file)
    except (MemoryError, RecursionError) as error:  # of the parser
        raise ValueError("a damaged header") from error
    if dtype.hasobject:
        return shape, "pickled Python objects"
    if dtype.kind not in "iuf" or len(shape) not in (1, 2) or min(shape) == 0:
        return shape, f"an array of type {dtype} and shape {shape}"
    promised, present = math.prod(shape) * dtype.itemsize, size - file.tell()
    if min(shape) < 0 or promised > present:
        raise ValueError(f"the header promises {promised} bytes, there are {present}")
    return shape, ""


def _chosen(path: Path, channel: str | int | None, shapes: Mapping[str, tuple[int, ...]]) -> str:
    if not shapes:
        raise SurfaceFileError(str(path), expected=f"an array of {_EXPECTED}", got="none")
    return choose(str(path), channel, shapes)


def _attribute(node: Any, name: str, default: Any) -> Any:
    """An attribute of one value, which netCDF-4 keeps as an array."""
    return np.ravel(node.attrs.get(name, default))[0]


def _text(node: Any, attribute: str) -> str:
    value = _attribute(node, attribute, "")
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def _heights(array: NDArray[np.generic]) -> Field:
    return np.array(array, dtype=np.float64, order="C")
