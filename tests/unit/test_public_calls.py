"""Walks over the public surface, by the calls of `tests/calls.py`: types of numbers, wrong things, types."""

import dataclasses
import inspect
import math
import re
from collections.abc import Callable, Iterator, Mapping
from decimal import Decimal
from fractions import Fraction
from operator import methodcaller
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import asperity as asp
from asperity.errors import InputError
from tests.calls import CALLS, INFINITY_IS_WELCOME, ROUGH, WITHOUT_NUMBERS, WRONG, functions, public

FLOATS, INTEGERS = ("f2", "f4", "f8", "g", ">f4"), ("int", "i1", "u2", "i8")
SCALARS = {kind: np.dtype(kind).type for kind in (*FLOATS[:4], *INTEGERS[1:])}
REALS: dict[str, Callable[[float], Any]] = {
    **SCALARS,
    **{"int": int, "array": np.array, "Fraction": Fraction, "Decimal": Decimal},
    "DataArray": lambda x: xr.DataArray(x, attrs={"units": "1"}),
}
WHOLES: dict[str, Callable[[int], Any]] = {
    **{kind: SCALARS[kind] for kind in INTEGERS[1:]},
    **{"array": np.array, "DataArray": xr.DataArray},
}
ARRAYS: dict[str, Callable[[np.ndarray], Any]] = {
    **{kind: methodcaller("astype", kind) for kind in (*FLOATS, *INTEGERS[1:])},
    "tuple": lambda x: tuple(x.tolist()),
    "Fortran": lambda x: np.asfortranarray(x),
    "strided": lambda x: np.repeat(x, 2, axis=-1)[..., ::2],
    "DataArray": xr.DataArray,
    "DataFrame": lambda x: pd.DataFrame(x) if x.ndim == 2 else pd.Series(x),
    "Fraction": lambda x: np.vectorize(Fraction, otypes=[object])(x) if x.dtype.kind == "f" else x,
}
SHAPES: dict[str, Callable[[tuple[int, ...]], Any]] = {
    "list": list, "array": np.array, "i1": lambda x: tuple(map(np.int8, x))
}  # fmt: skip

NEITHER = [math.nan, math.inf, True, np.True_, 2j, None, object()]
NO_REALS = [
    *NEITHER,
    *(-math.inf, np.float32("nan"), np.array(math.nan), np.ma.array(8.0, mask=True), 10**400),
    *("8", b"8", {}, Decimal("sNaN"), np.timedelta64(8, "s"), ["8"], [True], [8j], [None]),
]
NO_WHOLES = [*NEITHER, 2.0, 2.5, np.float32(2), "2", [2.0]]
NO_SHAPES = [
    *((4, n) for n in (2.5, 6.0, True, "6", -6)),
    (0, 4),
    (),
    (2, 2, 2),
    None,
    math.nan,
    "46",
    {4: 6},
]

SLOW = (asp.friction.rate_and_state, asp.friction.compare_state_laws)  # a fit of a record for each type
CASES = [
    pytest.param(
        function, arguments, id=function.__qualname__, marks=pytest.mark.slow if function in SLOW else ()
    )
    for function, arguments in CALLS
]
TAKES_OTHERS = {"figures.html_of", "figures.plot_contact", "analysis.observe", "analysis.patch_table"}
THINGS = [
    (name, function)
    for name, function in functions()
    if name.count(".") == 1 and name.startswith(("figures.", "analysis.")) and name not in TAKES_OTHERS
] + [(one.__name__, one) for one in (asp.friction.compare_state_laws, asp.friction.hold_peaks)]

NAMED_OTHERWISE = {
    "areas": ("y",),  # each is the y of a fit
    "branches": ("branch",),
    "run_in": ("distance",),  # of the first slide
    "strength": ("shear_strength",),
    "surface": ("heights",),
    "value": ("load", "separation"),
}
"""How errors call arguments that they do not call by their names."""

WHATEVER = {
    ("Contact.__init__", "_"): "refuses whatever it is given",
    ("Contact.__init__", "__"): "refuses whatever it is given",
    ("errors.InputError.__init__", "got"): "whatever came instead",
    ("figures.Drawing.savefig", "kwargs"): "what matplotlib takes",
    ("figures.html_of", "thing"): "any result, and refuses others",
}
"""Arguments that may be anything, and why."""


def as_type(value: Any, kind: str) -> Any:
    """The same number or numbers of another type; as they are, where that type cannot hold them."""
    exact = np.array(value) if isinstance(value, (float, list)) else np.zeros(0)
    if kind in INTEGERS and exact.size:
        limits = np.iinfo("i8" if kind == "int" else kind)
        if (exact != np.rint(exact)).any() or exact.min() < limits.min or exact.max() > limits.max:
            return value
    makers: Mapping[str, Callable[[Any], Any]] = {}
    if isinstance(value, float):
        makers = REALS
    elif isinstance(value, list):
        makers = ARRAYS if exact.dtype.kind == "f" or kind not in FLOATS else {}
    elif is_shape(value):
        makers = SHAPES
    elif is_whole(value):
        makers = WHOLES
    given = exact if isinstance(value, list) else value
    return makers[kind](given) if kind in makers else value


def is_whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def is_shape(value: Any) -> bool:
    return isinstance(value, tuple) and all(isinstance(n, int) for n in value)


def bad_values(value: Any) -> Iterator[Any]:
    if isinstance(value, float):
        yield from NO_REALS
    elif is_whole(value):
        yield from NO_WHOLES
    elif is_shape(value):
        yield from NO_SHAPES
    elif isinstance(value, list):
        array = np.array(value)
        for wrong in (math.nan, math.inf, -math.inf, None):
            changed = array.astype(object if wrong is None else float)
            changed.flat[-1] = wrong
            yield changed
        yield from (array.astype(kind) for kind in ("?", "U", "c16", "m8[s]", "M8[s]"))
        yield from (None, "rough", {}, object(), [[1.0], [1.0, 2.0]])
        yield np.ma.masked_array(array, mask=array == array.flat[-1])


def is_infinite(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.dtype == float and bool(np.isinf(value).any())


def parts(result: Any) -> Any:
    """A result taken to pieces that can be compared, with the types of its numbers."""
    if dataclasses.is_dataclass(result) and not isinstance(result, type):
        compared = [field.name for field in dataclasses.fields(result) if field.compare]
        return [type(result).__name__, *((name, parts(getattr(result, name))) for name in compared)]
    if isinstance(result, xr.Dataset):
        return [parts(dict(result.attrs)), *((n, parts(v.values)) for n, v in result.variables.items())]
    if isinstance(result, (np.ndarray, np.generic)):
        return [str(result.dtype), result.shape, result.tobytes()]
    if isinstance(result, Mapping):
        return [(key, parts(value)) for key, value in result.items()]
    if isinstance(result, (tuple, list)):
        return [parts(value) for value in result]
    return [type(result).__name__, repr(result)]


def refused(function: Callable[..., Any], arguments: Mapping[str, Any]) -> str:
    """Check that a call is refused in one line; what it is about."""
    with pytest.raises(InputError) as raised:
        function(**arguments)
    assert "\n" not in str(raised.value)
    assert len(str(raised.value)) < 300
    return raised.value.name


def test_every_public_function_is_here():
    called = {function for function, _ in CALLS}
    without = {(room, name) for room, names in WITHOUT_NUMBERS.items() for name in names.split()}
    others = {
        (room, name)
        for room, name, thing in public()
        if isinstance(thing, FunctionType) and thing not in called
    }
    assert others == without


@pytest.mark.parametrize(("function", "arguments"), CASES)
def test_numbers_of_every_type_give_the_same_and_what_is_none_is_refused(
    function, arguments, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    np.save("heights.npy", ROUGH)
    Path("psd.csv").write_text("q,C\n1,2\n3,1\n")
    expected = parts(function(**arguments))
    for kind in {*REALS, *WHOLES, *ARRAYS, *SHAPES}:
        others = {key: as_type(value, kind) for key, value in arguments.items()}
        if any(others[key] is not value for key, value in arguments.items()):
            assert parts(function(**others)) == expected, kind
    optional = {p.name for p in inspect.signature(function).parameters.values() if p.default is None}
    for key, value in arguments.items():
        for wrong in bad_values(value):
            welcome = (function, key) in INFINITY_IS_WELCOME and is_infinite(wrong)
            if not welcome and not (wrong is None and key in optional):
                named = refused(function, arguments | {key: wrong})
                assert any(word in named for word in (key, *NAMED_OTHERWISE.get(key, ()))), named


@pytest.mark.parametrize(("name", "function"), THINGS, ids=[name for name, _ in THINGS])
def test_a_wrong_thing_in_place_of_a_dataset_a_result_or_a_name_is_refused(name, function):
    needed = [one.name for one in inspect.signature(function).parameters.values() if one.default is one.empty]
    for wrong in WRONG:
        refused(function, dict.fromkeys(needed, wrong))


def test_no_public_argument_result_or_attribute_is_any():
    """That each has a type, the type checker sees."""
    owners: list[tuple[str, Any]] = [
        (name, function)
        for name, function in functions()
        if function.__code__.co_filename.startswith(next(iter(asp.__path__)))  # not what a library made
    ]
    attributes = [(f"{room}.{name}", thing) for room, name, thing in public() if inspect.isclass(thing)]
    wrong, seen = [], 0
    for name, owner in owners + attributes:
        for key, kind in inspect.get_annotations(owner).items():
            unknown = re.findall(r"\b(Any|object)\b", str(kind))
            whatever = key == "return" or inspect.isclass(owner) or (name, key) in WHATEVER
            wrong += [f"{name}: {key} is {kind}"] * ("Any" in unknown or (bool(unknown) and not whatever))
            seen += 1
    assert not wrong
    assert seen > 700
