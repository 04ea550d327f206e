"""The door: what comes from outside is checked here, number by number and array by array.

A number becomes a Python float, an array one of float64, whatever they were. In NumPy 2 a ``float32`` stays
one beside Python floats, and solvers that need double precision would not converge.
"""

from __future__ import annotations

import math
import reprlib
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from decimal import Decimal
from numbers import Real
from pathlib import Path, PurePath
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from asperity.base.words import InUnits, closest, has_decimal_comma
from asperity.errors import LARGEST, InputError, MissingExtraError

Floats = NDArray[np.float64]
T = TypeVar("T")

_FILLING = (
    "-inf where there is no body, such as np.ma.filled(heights, -np.inf), or filling them: "
    "asperity.surfaces.read(path) does for files"
)


def number(
    name: str,
    value: object,
    *,
    least: float = -LARGEST,
    above: float = -math.inf,
    most: float = LARGEST,
    below: float = math.inf,
    expected: str = "",
    advice: str = "",
) -> float:
    """One real number, as a float: of Python, NumPy or xarray, or an array without axes.

    It is at most 1e100 in magnitude in any case. `InputError`, by default in words of the bounds, for a truth
    value, a text, a complex number, an array, a quantity with a unit, NaN, and what is out of bounds.
    """
    real = _real(value)
    if real is None or not (least <= real <= most and above < real < below):
        signs = {">=": least, ">": above, "<=": most, "<": below}
        bounds = " and ".join(f"{sign} {bound:g}" for sign, bound in signs.items() if abs(bound) < LARGEST)
        wanted = expected or f"a finite number {bounds}".rstrip()
        raise InputError(name, expected=wanted, got=shown(value), advice=advice or _hint(name, value))
    return real


def integer(
    name: str, value: object, *, least: int, most: int | None = None, expected: str = "", advice: str = ""
) -> int:
    """One integer, as a Python int; `InputError` for anything else.

    A float is refused even if it is whole: it mostly comes of a division that was meant to be exact.
    """
    item: Any = value if isinstance(value, int) else _scalar(value, kinds="iu")
    if item is None or isinstance(item, bool) or item < least or (most is not None and item > most):
        wanted = expected or (
            f"a whole number >= {least}" if most is None else f"a whole number from {least} to {most}"
        )
        raise InputError(name, expected=wanted, got=shown(value), advice=advice)
    return int(item)


def seed(value: object, rng: object = None) -> int:
    """Seed of random numbers, or a draw of a generator; never None: a surface can be made again."""
    if isinstance(rng, np.random.Generator):
        return int(rng.integers(2**63))
    name, value = ("seed", value) if rng is None else ("rng", rng)
    return integer(name, value, least=0, expected="an integer, 0 or more")


def generator(value: object, rng: object = None) -> np.random.Generator:
    """Generator of random numbers: `rng`, or one of this seed."""
    return rng if isinstance(rng, np.random.Generator) else np.random.default_rng(seed(value, rng))


def lattice_shape(
    value: object, advice: str = "(200, 200), or (4096,) for a line contact"
) -> tuple[int, ...]:
    """Lengths of a lattice of one or two axes; one integer is the length of a profile."""
    expected = "one or two positive lengths, which are integers"
    several = isinstance(value, (tuple, list)) or (isinstance(value, np.ndarray) and value.ndim == 1)
    lengths: tuple[object, ...] = tuple(value) if several else (value,)  # type: ignore[arg-type]
    if len(lengths) not in (1, 2):
        raise InputError("shape", expected=expected, got=shown(value), advice=advice)
    return tuple(integer("shape", n, least=1, expected=expected, advice=advice) for n in lengths)


def line_or_plane(value: object) -> int:
    """Dimension of a lattice."""
    return integer("dimension", value, least=1, most=2, expected="1 (line contact) or 2")


def one_of(advice: str, **values: object) -> str:
    """Name of the only argument that is not None; `InputError` for none and for more."""
    names = [name for name, value in values.items() if value is not None]
    if len(names) != 1:
        *some, last = values
        got = " and ".join(names) or "none"
        expected = "exactly one of them"
        raise InputError(f"{', '.join(some)} and {last}", expected=expected, got=got, advice=advice)
    return names[0]


def choice(name: str, value: object, choices: Sequence[object]) -> Any:
    """One of the choices; `InputError`, with the nearest of them, for anything else."""
    if value in choices:
        return value
    meant = closest(value, map(str, choices)) if isinstance(value, str) else None
    expected = f"{'one of ' * (len(choices) > 1)}{any_of(map(repr, choices))}"
    raise InputError(name, expected=expected, got=shown(value), cure={name: meant} if meant else {})


def any_of(words: Iterable[str]) -> str:
    """Words of which one is meant: ``one, two or three``."""
    *some, last = words
    return f"{', '.join(some)} or {last}" if some else last


def switch(name: str, value: object) -> bool:
    """True or False, and nothing that counts as one of them."""
    if not isinstance(value, bool):
        raise InputError(name, expected="true or false", got=shown(value))
    return value


def text(name: str, value: object) -> str:
    """A text, or a path as one."""
    if not isinstance(value, str | PurePath):
        raise InputError(name, expected="text in quotes", got=shown(value))
    return str(value)


def instance(name: str, value: object, kind: type[T], advice: str) -> T:
    """Return an instance of this class; `InputError` for anything else."""
    if not isinstance(value, kind):
        article = "an" if kind.__name__[0] in "AEIO" else "a"
        raise InputError(name, expected=f"{article} {kind.__name__}", got=kind_of(value), advice=advice)
    return value


def kind_of(value: object) -> str:
    """Name of its class."""
    return f"the class {value.__name__}" if isinstance(value, type) else type(value).__name__


def floats(name: str, value: object, *, expected: str = "real numbers", advice: str = "") -> Floats:
    """Real numbers of any shape, without NaN, as float64: what is float64 already, itself."""
    array = _as_floats(name, value, expected, advice)
    if np.isnan(array).any():
        raise InputError(name, expected=expected, got="NaN among them", advice=advice)
    return array


def positive(name: str, value: object) -> Floats:
    """Finite numbers above 0, of any shape."""
    array = floats(name, value)
    wrong = ~(np.isfinite(array) & (array > 0))
    if wrong.any():
        raise InputError(name, expected="finite numbers above 0", got=float(array[wrong].flat[0]))
    return array


def positives(**values: object) -> list[Floats]:
    """`positive` of each, broadcast against each other."""
    return broadcast(**{name: positive(name, value) for name, value in values.items()})


def not_negative(name: str, value: object, *, infinity: str = "") -> Floats:
    """Numbers >= 0; infinity is refused with this advice, or allowed for ``"welcome"``."""
    array = floats(name, value)
    wrong = (array < 0) | (np.isinf(array) & (infinity != "welcome"))
    if wrong.any():
        least = float(array[wrong].min())
        advice = infinity if least == math.inf else ""
        raise InputError(name, expected="finite numbers >= 0", got=least, advice=advice)
    return array


def line(name: str, value: object) -> Floats:
    """Finite numbers in a row, shape (n,)."""
    array = _as_floats(name, value, "real numbers")
    if array.ndim != 1:
        raise InputError(name, expected="an array of one dimension", got=f"shape {array.shape}")
    _check_finite(name, array, ~np.isfinite(array), "leaving these points out")
    return array


def _check_finite(name: str, array: Floats, wrong: NDArray[np.bool_], advice: str) -> None:
    """Refuse an array with entries that are wrong, and say how many and where."""
    if wrong.any():
        nans, first = int(np.isnan(array).sum()), np.argwhere(wrong)[0].tolist()
        got = f"{nans} NaN and {int(wrong.sum()) - nans} infinite of {array.size}, the first at {first}"
        raise InputError(name, expected="finite numbers", got=got, advice=advice)


def times(name: str, value: object, *, at_least: int = 1) -> Floats:
    """Strictly increasing times >= 0, shape (n,), n `at_least` so many."""
    advice = "np.geomspace(1e-3, 1e6, 37)"
    array = np.atleast_1d(_as_floats(name, value, "a list of times", advice))
    if array.ndim != 1 or array.size < at_least:
        raise InputError(name, expected="a list of times", got=f"shape {array.shape}", advice=advice)
    wrong = ~((array == 0) | ((array >= 1 / LARGEST) & (array <= LARGEST)))
    if wrong.any():
        expected = f"finite times >= 0 (0, or from {1 / LARGEST:g} to {LARGEST:g})"
        raise InputError(name, expected=expected, got=float(array[wrong][0]), advice=advice)
    if not (np.diff(array) > 0).all():
        at = int(np.argmin(np.diff(array)))
        got = f"{array[at]} before {array[at + 1]}"
        raise InputError(name, expected="strictly increasing times", got=got, advice="np.unique(times)")
    return array


def history(**values: object) -> list[Floats]:
    """Check times that never decrease, the first of some values, and the others: shape (n,), n at least 1."""
    arrays = {name: line(name, value) for name, value in values.items()}
    first, times = next(iter(arrays.items()))
    for name, array in arrays.items():
        if array.shape != times.shape or not times.size:
            expected = f"a number for each of {times.size or 'one or more'} times"
            raise InputError(name, expected=expected, got=f"shape {array.shape}")
    if (falls := np.diff(times) < 0).any():
        at = int(np.argmax(falls))
        got, advice = f"{times[at]} before {times[at + 1]}", "the same time twice for a jump"
        raise InputError(first, expected="times that do not decrease", got=got, advice=advice)
    return list(arrays.values())


def heights(name: str, value: object, *, holes: bool = False) -> Floats:
    """Heights over the sites of a lattice, shape (n,) or (n, m), finite: a copy in C order.

    With ``holes`` they may be -inf, where there is no body, but not everywhere.
    """
    advice = _FILLING if holes else "filling them"
    if np.ma.isMaskedArray(value):
        masked = np.argwhere(np.ma.getmaskarray(value)).tolist()
        if masked:
            got = f"{len(masked)} masked of {np.size(value)}, the first at {masked[0]}"
            raise InputError(name, expected="an array without masked entries", got=got, advice=advice)
    array = np.array(_as_floats(name, value, "an array of real numbers"), order="C")
    if array.ndim not in (1, 2):
        got = f"{array.ndim} dimensions, shape {array.shape}"
        raise InputError(name, expected="one or two dimensions", got=got)
    if array.size == 0:
        raise InputError(name, expected="at least one height", got=f"an empty array, shape {array.shape}")
    wrong = ~(finite := np.isfinite(array))
    _check_finite(name, array, wrong & (array != -math.inf) if holes and finite.any() else wrong, advice)
    if max(float(array.max()), -float(array.min(where=finite, initial=0.0))) > LARGEST:
        raise InputError(name, expected=f"heights up to {LARGEST:g}", got="larger ones")
    return array


def broadcast(**arrays: Floats) -> list[Floats]:
    """Broadcast arrays against each other; `InputError` names them where their shapes do not match."""
    try:
        return list(np.broadcast_arrays(*arrays.values()))
    except ValueError as error:
        expected, got = "shapes that broadcast against each other", [array.shape for array in arrays.values()]
        advice = "x1[:, None] with x2[None, :] for a table"
        raise InputError(", ".join(arrays), expected=expected, got=got, advice=advice) from error


def shown(value: object) -> str:
    """A value in few characters, on one line, with units as they were written."""
    if isinstance(value, list) and value:
        value = [one.written if isinstance(one, InUnits) else one for one in value]
    value = value.written if isinstance(value, InUnits) else value
    if _has_unit(value):
        return f"{' '.join(str(value).split())[:60]}, which has a unit"
    scalar = _scalar(value, kinds="iufcbmM")
    if scalar is not None:
        return str(scalar)
    if isinstance(value, type):
        return kind_of(value)
    if hasattr(value, "__qualname__"):  # such as ds.load, in place of ds["load"]
        return f"the {type(value).__name__} {value.__qualname__}"
    if hasattr(value, "dtype") and hasattr(value, "shape"):
        return f"{type(value).__name__} of type {value.dtype}, shape {tuple(value.shape)}"
    try:
        return " ".join(_REPR.repr(value).split())
    except ValueError:  # an integer of thousands of digits
        return f"a huge {type(value).__name__}"


_REPR = reprlib.Repr()
_REPR.maxstring = _REPR.maxother = 60


def _real(value: object) -> float | None:
    """A float of one real number, infinite if it is too large for one; None of anything else."""
    if hasattr(value, "__array__"):
        scalar = _scalar(value, kinds="iuf")
        return None if scalar is None else float(scalar)
    if isinstance(value, bool) or not isinstance(value, (Real, Decimal)):
        return None
    try:
        return float(value)
    except (OverflowError, ValueError):
        return math.inf


def _scalar(value: object, *, kinds: str) -> Any:
    """Item of an array without axes, or a scalar of NumPy, of one of these kinds; else None."""
    if not hasattr(value, "__array__") or isinstance(value, type) or _has_unit(value):
        return None
    if np.ma.is_masked(value):
        return None
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):  # such as a Dataset
        return None
    return array[()] if array.ndim == 0 and array.dtype.kind in kinds else None


def _as_floats(name: str, value: object, expected: str, advice: str = "") -> Floats:
    """Real numbers as float64, NaN and infinity included."""
    if _has_unit(value):
        raise InputError(name, expected=expected, got=shown(value), advice=_hint(name, value))
    try:
        array = np.asarray(value)
    except InputError:  # of a Surface whose pixels are not square
        raise
    except (TypeError, ValueError) as error:
        got = f"{type(value).__name__} ({error})"
        raise InputError(name, expected=expected, got=got, advice=advice) from error
    if array.dtype.kind == "O":  # of Python's own numbers, perhaps
        reals = [_real(item) for item in array.flat]
        if None not in reals:
            return np.array(reals, dtype=np.float64).reshape(array.shape)
    if array.dtype.kind not in "iuf":
        got = shown(value) if array.ndim == 0 else f"{type(value).__name__} of type {array.dtype}"
        raise InputError(name, expected=expected, got=got, advice=_hint(name, array) or advice)
    if np.ma.is_masked(value):
        raise InputError(name, expected=expected, got="masked entries among them", advice=advice)
    with np.errstate(over="ignore"):  # a long double that overflows becomes infinite
        return np.asarray(array, dtype=np.float64)


def _has_unit(value: object) -> bool:
    return hasattr(type(value), "magnitude") or hasattr(type(value), "to_value")


def _hint(name: str, value: object) -> str:
    if has_decimal_comma(value):
        return str(value).replace(",", ".")
    if _has_unit(value):
        number = "magnitude" if hasattr(type(value), "magnitude") else "value"
        return f"{name}.{number}, in the unit of the other arguments"
    return ""


@contextmanager
def extra(name: str, purpose: str) -> Iterator[None]:
    """Context for imports of an extra of the package, such as ``"campaign"``.

    `MissingExtraError` has the purpose of a missing package, and how to install it.
    """
    try:
        yield
    except ImportError as error:
        raise MissingExtraError(
            f"{purpose} needs the extra {name}: {error}; try pip install '{installed_from()}[{name}]'"
        ) from error


def installed_from(package: str = "asperity") -> str:
    """What pip installs a package of this repository from: the clone or file of this one, else its name."""
    import json
    from importlib import metadata
    from urllib.parse import urlsplit
    from urllib.request import url2pathname

    try:
        written = metadata.distribution("asperity").read_text("direct_url.json") or "{}"
    except metadata.PackageNotFoundError:  # it is imported from its source
        return package
    url = urlsplit(json.loads(written).get("url", ""))
    source = Path(url2pathname(url.path)) if url.scheme == "file" else Path("nowhere")
    folder = source if package == "asperity" else source / package.removeprefix("asperity-")
    return str(folder) if folder.exists() else package
