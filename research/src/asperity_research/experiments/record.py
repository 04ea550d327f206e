"""What was measured: numbers with unit, uncertainty, source and how each was read, from one TOML file."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
import xarray as xr
from pydantic import BaseModel, ConfigDict, Field, StringConstraints, ValidationError, model_validator

from asperity.errors import InputError
from asperity_research import doors

Words = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1)]
Error = Annotated[float, Field(ge=0, allow_inf_nan=False)] | Literal["not stated"]


class _Stated(BaseModel):
    """Whatever is stated: in which unit, how surely, and from where.

    ``uncertainty`` is a standard error in that unit, or a part of the value where it is ``relative``.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    unit: Words
    uncertainty: Error
    relative: bool = False
    source: Words
    how: Words


class Quantity(_Stated):
    """One number."""

    value: Annotated[float, Field(allow_inf_nan=False)]


class Column(_Stated):
    """Several numbers of one kind."""

    values: Annotated[list[Annotated[float, Field(allow_inf_nan=False)]], Field(min_length=1)]

    @property
    def errors(self) -> np.ndarray:
        """Standard errors of the values; NaN where they are not stated."""
        if self.uncertainty == "not stated":
            return np.full(len(self.values), np.nan)
        return self.uncertainty * (np.abs(self.values) if self.relative else np.ones(len(self.values)))


class _Series(BaseModel):
    """Columns of one length; the first rises, and is what the others are recorded against."""

    model_config = ConfigDict(extra="allow", frozen=True)
    __pydantic_extra__: dict[str, Column]
    what: Words

    @model_validator(mode="after")
    def _rises(self) -> Self:
        if len(self.columns) < 2:
            raise ValueError(f"expected two columns or more, got {len(self.columns)}")
        (first, along), *others = self.columns.items()
        for name, column in others:
            if len(column.values) != len(along.values):
                raise ValueError(f"{name}: expected {len(along.values)} values, got {len(column.values)}")
        if (np.diff(along.values) <= 0).any():
            at = int(np.argmax(np.diff(along.values) <= 0))
            before, after = along.values[at : at + 2]
            raise ValueError(f"{first}: expected values that rise, got {after:g} after {before:g}")
        return self

    @property
    def columns(self) -> dict[str, Column]:
        return self.__pydantic_extra__ or {}


class _File(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)
    title: Words
    doi: Words | None = None
    missing: list[Words]
    sources: Annotated[dict[str, Words], Field(min_length=1)]
    input: dict[str, Quantity] = {}
    series: dict[str, _Series] = {}

    @model_validator(mode="after")
    def _sources_are_told(self) -> Self:
        sources = {f"input.{name}": one.source for name, one in self.input.items()}
        for name, series in self.series.items():
            sources |= {f"series.{name}.{column}": one.source for column, one in series.columns.items()}
        for place, source in sources.items():
            if source not in self.sources:
                names = ", ".join(self.sources)
                raise ValueError(f"{place}.source: expected one of [sources]: {names}, got {source!r}")
        return self


@dataclass(frozen=True, eq=False)
class Experiment:
    """A measured contact: what went in, what came out, and what is not known.

    Attributes
    ----------
    name, title, doi
        What it is called, what was done, and the paper's DOI where it was found.
    sources
        Papers by short names.
    inputs
        Numbers by name, each with value, unit, uncertainty, source and how it was read.
    series
        Datasets by name: variables against the first column, with attributes ``units``, ``source``, ``how``;
        NAME_error has standard errors in the unit of NAME, NaN where none is stated.
    columns
        What is stated of the columns of the series, by the names of both.
    missing
        What a full comparison would need.
    """

    name: str
    title: str
    doi: str | None
    sources: Mapping[str, str]
    inputs: Mapping[str, Quantity]
    series: Mapping[str, xr.Dataset]
    columns: Mapping[tuple[str, str], Column]
    missing: tuple[str, ...]

    def __getitem__(self, name: str) -> float:
        """Return the value of an input."""
        return self.inputs[name].value


_FOLDER = Path(str(files("asperity_research.experiments") / "data"))


def names() -> tuple[str, ...]:
    """Return the names of the experiments that come with the package, a file each."""
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.toml")))


def load(name: str | Path) -> Experiment:
    """Read an experiment by its name, or from a file of your own (.toml).

    Raises
    ------
    InputError
        There is none of that name; the nearest names are given. Or as `read`.
    """
    if isinstance(name, str | Path) and Path(name).suffix == ".toml":
        return read(Path(name))
    return read(doors.named("experiment", name, {one: _FOLDER / f"{one}.toml" for one in names()}))


def read(path: Path) -> Experiment:
    """Read an experiment; the name is that of the file.

    Raises
    ------
    InputError
        There is no such file, it is no TOML, or a number lacks its unit, uncertainty, source or how it was
        read; a series runs backward; a source is not listed.
    """
    try:
        file = _File.model_validate(tomllib.loads(path.read_text(encoding="utf-8")))
    except OSError as error:
        raise InputError(str(path), expected="a file", got=error.strerror or str(error)) from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise InputError(str(path), expected="TOML", got=str(error)) from None
    except ValidationError as error:
        raise _explained(path, error) from None
    series = {name: _dataset(one) for name, one in file.series.items()}
    columns = {
        (name, key): column for name, one in file.series.items() for key, column in one.columns.items()
    }
    facts = (file.title, file.doi, file.sources, file.input, series, columns, tuple(file.missing))
    return Experiment(path.stem, *facts)


def _dataset(series: _Series) -> xr.Dataset:
    along, *_ = series.columns
    variables: dict[str, Any] = {}
    for name, column in series.columns.items():
        about = {"units": column.unit, "source": column.source, "how": column.how}
        variables[name] = (along, column.values, about)
        variables[f"{name}_error"] = (along, column.errors, {"units": column.unit})
    return xr.Dataset(variables, attrs={"what": series.what}).set_coords(along)


def _explained(path: Path, error: ValidationError) -> InputError:
    """The first mistake of a file, in one line."""
    first = error.errors()[0]
    place = [str(one) for one in first["loc"] if "float" not in str(one)]
    message = first["msg"].removeprefix("Value error, ")
    if first["type"] == "missing":
        expected, got = f"{place.pop()}; each number has value, unit, uncertainty, source and how", "none"
        advice = 'uncertainty = "not stated" where the source has none' if "uncertainty;" in expected else ""
    else:
        head, _, rest = message.rpartition("expected ")
        expected, _, got = rest.partition(", got ") if ", got " in rest else (message, "", "")
        place += [head.rstrip(": ")] if got and head else []
        expected, got, advice = expected.removeprefix("Input should be "), got or repr(first["input"]), ""
    where = ".".join(place)
    return InputError(
        f"{path.name}: {where}" if where else path.name, expected=expected, got=got, advice=advice
    )
