"""Measured values against hold time, from a table in a text file."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np

from asperity.base import units, views
from asperity.base.checks import Floats
from asperity.errors import InputError, Value
from asperity.sheets.columns import (
    TIME,
    Chosen,
    Columns,
    Role,
    Units,
    check_one_series,
    in_line,
    normal,
    position,
)
from asperity.sheets.columns import named as columns_named
from asperity.sheets.tables import Table, read_table

_EXPECTED = {
    "s": ("in a unit such as s or min", "a header such as time_s"),
    "m^2": ("in a unit such as um^2, or as a fraction", "a header such as area_um2, or contact_fraction"),
    "1": ("without a unit, as the run has none", "a header such as time, area, or contact_fraction"),
    "m": ("in a unit such as nm", "a header such as depth_nm"),
    "N": ("in a unit such as nN", "a header such as force_nN"),
}
Quantity = Literal["area", "friction", "depth", "radius", "force"]
"""What a table may be read for."""
QUANTITIES: tuple[Quantity, ...] = get_args(Quantity)

_ERRORS = (
    r"\b(std\w*|err\w*|sd|se|sem|sigma|uncert\w*|deviation|abweichung|fehler|ecart\w*)\b|±|\+/-|(std|err)$"
)
_MULTIPLE = r"(?<![\d.])([23]|1[.,]96|two|three|zwei|drei|deux|trois)[ *×·x-]*(std|sigma|σ|s\b|s[de]|err)"
_NO_STANDARD_ERROR = (
    rf"\bvar|²|\^ ?2|\*\* ?2|squared?\b|quadrat|{_MULTIPLE}|[×x*·] ?[23]\b|\bci\b|\bk ?= ?[23]"
    r"|(?<!\d)9\d ?(%|$)|expanded|erweitert|elargi|probable|wahrscheinlich"
)
_IN_PERCENT = r"percent|prozent|%"
_OF_WHOLE = rf"\ba ?/ ?a ?n(om)?\b|fraction|anteil|\bpart\b|{_IN_PERCENT}"
"""Names and units of values that are a fraction of the nominal area."""

_OF_VALUES: dict[str, Role] = {
    "radius": Role("radius", "m", r"radius|rayon"),
    "depth": Role("depth", "m", r"depth|indent|tiefe|eindring|profondeur|deplacement|displac"),
    "friction": Role("friction", "1", r"fric|reib|frott|\bmu\b|[µμ]"),
    "area": Role("area", "m^2", rf"area|flache|\baire\b|surface|contact|a ?/ ?a ?\(?0|{_OF_WHOLE}"),
    "force": Role("force", "N", r"force|kraft"),
}
_ERROR_OF_TIME = Role("", "", rf"(\btime\b|hold|^t\b).*({_ERRORS})")
_ERROR = Role("stderr", "", _ERRORS)
_ROLES = (
    _ERROR_OF_TIME,
    _ERROR,
    Role("time", "s", rf"{TIME.words}|hold|halte"),
    Role(
        "",
        "",
        r"load|\blast\b|press|druck|temp|humid|\brh\b|feucht|segment|cycle|volt|speed|residual"
        r"|stiff|steif|raideur|conduct|leitw|resist|widerst|diamet|durchmesser|change|anderung|delta|δ"
        r"|increase|decrease|zunahme|abnahme|\bloss|verlust|^(nr|no|id|run|lap|index|sample|probe|point|row|count)\W*(nr|no|id)?\W*$",
    ),
    *_OF_VALUES.values(),
    Role("value", "", ""),
)
"""In this order, as a name may have the words of several; without a name are those that no values have."""


@dataclass(frozen=True, eq=False, repr=False)
class Measurements(views.Brief):
    """Columns of a table of measurements.

    Attributes
    ----------
    time, value
        Hold times, not below 0, and values above 0, in the order of the file, shape (n,).
    stderr
        Standard errors of the values, above 0, shape (n,); or None.
    time_name, value_name
        Names of the columns in the file's header, or "" without any.
    quantity
        What the values are, by the name of their column; "" where it says nothing known.
    remarks
        Decisions about the table.
    time_unit, value_unit
        Units of times and values in the table or by the user, or "".
    source
        File and columns.
    """

    time: Floats
    value: Floats
    stderr: Floats | None
    time_name: str
    value_name: str
    quantity: str = ""
    remarks: tuple[str, ...] = ()
    time_unit: str = ""
    value_unit: str = ""
    source: str = ""

    def in_units(self, time: str, value: str, names: tuple[str, str]) -> Measurements:
        """The same in other units; `InputError`, with the name of those, if they do not convert."""
        factors = []
        of_both = (("times", self.time_unit, time), ("values", self.value_unit, value))
        for name, (quantity, unit, target) in zip(names, of_both, strict=True):
            written = units.spelled(unit or "1") or ""
            factor = 1.0 if written == target else units.factor(written, target)
            if factor is None:
                expected, advice = _EXPECTED[target]
                raise InputError(name, expected=f"{quantity} {expected}", got=unit or "none", advice=advice)
            factors.append(factor)
        by, up = factors
        stderr = None if self.stderr is None else up * self.stderr
        numbers: dict[str, Any] = {"time": by * self.time, "value": up * self.value, "stderr": stderr}
        return replace(self, **numbers, time_unit=time, value_unit=value)


def read_measurements(
    path: Path | str,
    quantity: Quantity | Sequence[Quantity] | None = None,
    *,
    time: int | str | None = None,
    value: int | str | None = None,
    stderr: int | str | None = None,
    columns: Chosen | None = None,
    units: Units | None = None,
) -> Measurements:
    """Read hold times and values, and if asked standard errors, from a table in a text file.

    Lines that begin with #, % or ; are comments; semicolons, tabs, commas or blanks separate columns; numbers
    may have decimal commas. The last line before the numbers that has as many cells is the header; a row of
    units may follow it, and metadata may precede it. Numbers stay in the units of the table; a column such as
    ``log10(t/s)`` becomes its antilogarithms.

    Parameters
    ----------
    path
        A text file with one line for each measurement; also the ``aging.csv`` of a run.
    quantity
        What the values are: ``"area"``, ``"friction"``, ``"depth"``, ``"radius"``, ``"force"``, or several;
        default any but force.
    time, value, stderr
        The columns: a name in the file's header, or a number, counted from 0. By default those with the name
        or the unit of a time and of the quantity; without names the first two.
    columns
        The same in one list or text, such as ``"0,2"``.
    units
        Units of columns by name or number, in place of those of the table: ``{"t": "min"}`` or ``"t=min"``.

    Raises
    ------
    InputError
        There is no such column, or several; the unit is that of another quantity; a cell is not a finite
        number, a time is below 0, a value or standard error not above 0. The message names the line.
    """
    columns_read = Columns(path, _ROLES, columns, units)
    table, indexed = columns_read.table, _begins_with_index(columns_read.table)
    quantities: Sequence[str] = (quantity,) if isinstance(quantity, str) else quantity or QUANTITIES[:-1]
    asked: dict[str, int | str | None] = {"time": time, "value": value, "stderr": stderr}
    if columns is not None:
        if asked != dict.fromkeys(asked) or len(columns_read.chosen) not in (2, 3):
            expected = "time, value and perhaps stderr, and no other choice"
            raise InputError("columns", expected=expected, got=" ".join(map(str, columns_read.chosen)))
        asked |= zip(asked, columns_read.chosen, strict=False)
    places = {name: position(table, column) for name, column in asked.items() if column is not None}
    if "time" not in places:
        places["time"] = _time(columns_read, first=int(indexed))
    if "value" not in places:
        places["value"] = _value(columns_read, places["time"], {*places.values()}, quantities)
    _check_kind(columns_read, places["value"], quantities)
    places = {name: places[name] for name in asked if name in places}
    if len(set(places.values())) < len(places):
        got = " and ".join(f"column {at}" for at in places.values())
        raise InputError(str(path), expected=f"{' and '.join(places)} in different columns", got=got)
    check_one_series(table, places["time"])
    read = {name: _checked(columns_read, at, name) for name, at in places.items()}
    if (at := places.get("stderr")) is not None and re.search(
        _NO_STANDARD_ERROR, columns_read.label(at).lower().replace("_", " ")
    ):
        about = f"column {table.names[at]!r} of {path}"
        raise InputError(about, expected="a standard error of each value", got="a multiple or a square of it")
    of_values, of_errors = (columns_read.unit(name, places[name]) for name in ("value", list(places)[-1]))
    if len(places) == 3 and of_errors not in ("", of_values):
        about = f"column {table.names[places['stderr']]!r} of {path}"
        raise InputError(about, expected=f"the unit of the values, {of_values or 'none'}", got=of_errors)
    role = columns_read.roles[places["value"]]
    time_name, value_name = table.names[places["time"]], table.names[places["value"]]
    remark = f"column 0, without a name, counts the lines: took {time_name!r} for the hold times"
    return Measurements(
        time=read["time"],
        value=read["value"],
        stderr=read.get("stderr"),
        time_name=time_name,
        value_name=value_name,
        quantity=role if role in _OF_VALUES else "",
        remarks=(remark,) if indexed and asked["time"] is None else (),
        time_unit=columns_read.unit("time", places["time"]),
        value_unit=of_values,
        source=columns_read.read,
    )


def measured_area(source: Path | str | Measurements, nominal: float, *, si: bool) -> Measurements:
    """Read measured areas, with the column of their errors if there is one, in SI or without units.

    Parameters
    ----------
    source
        A table, as for `read_measurements`, or its result.
    nominal
        The nominal area, of which values in percent, or called a fraction, are that fraction.
    si
        Whether times are in s and areas in m^2, or both without a unit.

    Raises
    ------
    InputError
        As for `read_measurements`; or the units of the table do not convert.
    """
    name = "measured"
    if not isinstance(source, Measurements):
        name = str(source)
        errors = errors_beside(read_table(Path(source)).names)
        try:
            source = read_measurements(source, "area", stderr=errors)
        except InputError as error:  # columns cannot be chosen here
            raise error.about(error.name, keys={}) from None
    time, value = ("s", "m^2") if si else ("1", "1")
    called = normal(f"{source.value_name} {source.value_unit}")
    is_part = re.search(_OF_WHOLE, called)
    if not source.value_unit and re.search(_IN_PERCENT, called):
        source = replace(source, value_unit="%")
    found = source.in_units(time, "1" if is_part else value, (name, name))
    if is_part:
        if (largest := float(found.value.max())) > 1:
            expected, advice = "fractions of the nominal area, up to 1", "a header such as area_percent"
            raise InputError(name, expected=expected, got=f"{largest:g}", advice=advice)
        stderr = None if found.stderr is None else nominal * found.stderr
        found = replace(found, value=nominal * found.value, stderr=stderr, value_unit=value)
    return found


def errors_beside(names: Sequence[str], advice: str = "one such name in the header") -> str | None:
    """Name of the column of standard errors, or None; `InputError` if that is not clear."""
    of_time, error = (re.compile(role.words) for role in (_ERROR_OF_TIME, _ERROR))
    matching = [name for name in names if error.search(normal(name)) and not of_time.search(normal(name))]
    if len(matching) > 1 or any(re.search("%|percent|rel", name, re.I) for name in matching):
        expected = "one column of standard errors, in the unit of the values and not in % of each"
        got = ", ".join(map(repr, matching))
        raise InputError("stderr", expected=expected, got=got, advice=advice)
    return matching[0] if matching else None


def _time(columns: Columns, first: int) -> int:
    """Column of the hold times: that with such a name, or the first one if its name says nothing else."""
    named = [at for at in columns.chosen if columns.roles[at] == "time"]
    says_nothing = columns.roles[first] == "value" or not columns.table.names[first]
    return _only(columns, named or [first] * says_nothing, "time", {"columns": "TIME VALUE"})


def _value(columns: Columns, time: int, taken: set[int], quantities: Sequence[str]) -> int:
    """Column of the values: that with name or unit of a quantity, or the first one that is not taken."""
    others = [at for at in columns.chosen if at not in taken and columns.roles[at] not in ("time", "stderr")]
    what, cure = " or ".join(quantities), dict[str, Value]()
    if not any(columns.table.names):
        return _only(columns, others[:1], what, cure)
    wanted = {_OF_VALUES[name].unit for name in quantities}
    kinds = {at: _kind(columns, at) for at in others}
    named = [at for at in others if columns.roles[at] in quantities and kinds[at] not in _KINDS - wanted]
    called = [at for at in named if normal(columns.label(at)) in quantities]
    unnamed = [at for at in others if columns.roles[at] == "value" and kinds[at] in {"", *wanted}]
    known = [columns.roles[at] for at in others if columns.roles[at] in _OF_VALUES and not named]
    if len(known) == 1 and set(quantities) < set(QUANTITIES[:-1]):
        cure = {"quantity": known[0]}
    elif possible := [at for at in others if columns.roles[at] and kinds[at] in {"", *wanted}]:
        cure = {"columns": f"{time} {possible[0]}"}
    return _only(columns, called if len(called) == 1 else named or unnamed, what, cure)


def _only(columns: Columns, found: Sequence[int], what: str, cure: Mapping[str, Value]) -> int:
    """The one column that was found; `InputError` unless there is one."""
    if len(found) != 1:
        expected, got = f"one column of {what}", columns_named(columns.table)
        raise InputError(columns.table.name, expected=expected, got=got, cure=cure)
    return found[0]


_KINDS = {"m", "m^2", "N", "Pa", "K", "N/m", "S", "ohm"}
"""Units of which a value has that of its quantity, if any: a length is no area."""


def _kind(columns: Columns, at: int) -> str | None:
    """The one of the kinds of units, or "1", that the unit of a column is of; "" without a unit."""
    unit = units.spelled(columns.unit_text(at).strip("-") or "1")
    if unit in ("1", None):
        return None if unit is None else ""
    return next((kind for kind in sorted({*_KINDS, "1"}) if units.factor(unit, kind) is not None), None)


def _check_kind(columns: Columns, at: int, quantities: Sequence[str]) -> None:
    """Refuse a chosen column in the unit of something else."""
    wanted = [_OF_VALUES[name].unit for name in quantities]
    if _kind(columns, at) in _KINDS.difference(wanted):
        about = f"column {columns.table.names[at] or at!r} of {columns.table.name}"
        expected = f"a unit of {' or '.join(quantities)}"
        raise InputError(about, expected=expected, got=columns.unit_text(at))


def _begins_with_index(table: Table) -> bool:
    """Whether the first column is an index of pandas: 0, 1, 2, ..., without a name among named columns."""
    name, *others = table.names
    counting = np.arange(len(table.lines))
    return (
        len(others) > 1
        and all(others)
        and name in ("", "Unnamed: 0")
        and np.array_equal(table.values[:, 0], counting)
    )


def _checked(columns: Columns, column: int, name: str) -> Floats:
    values = columns.values(name, column, convert=False)
    bad = values < 0 if name == "time" else values <= 0
    if bad.any():
        expected = "not below 0" if name == "time" else "above 0"
        raise in_line(columns.table, int(np.argmax(bad)), column, name, expected)
    return values
