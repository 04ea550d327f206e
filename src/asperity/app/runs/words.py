"""The rows of the summary of a run."""

from __future__ import annotations

from pathlib import Path

import xarray as xr

from asperity.analysis import AgingSummary
from asperity.analysis.rows import history_rows
from asperity.app.config import RunConfig
from asperity.ask.surface import SurfaceSection
from asperity.base.readable import written
from asperity.base.rows import Row
from asperity.results.parameters import PARAMETERS
from asperity.results.quantities import Units, units_named

_ELECTRONVOLT = 1.602176634e-19


def run_rows(config: RunConfig, dataset: xr.Dataset, summary: AgingSummary | None) -> list[Row]:
    """Rows on surface, solid and results."""
    return [
        Row("surface", _surface(config, dataset)),
        *read_rows(config),
        Row("solid", _solid(config, dataset)),
        *history_rows(dataset, summary),
    ]


def read_rows(config: RunConfig) -> list[Row]:
    """Rows on the columns of tables that were read."""
    fit = config.solid.fit
    sources = "" if fit is None else fit.data.source, getattr(config.protocol, "read", "")
    return [Row("read", source) for source in sources if source]


def units_in(dataset: xr.Dataset) -> Units:
    """Units of dimensions, from those of the quantities in a dataset."""
    named = {str(name): str(one.attrs.get("units", "")) for name, one in dataset.variables.items()}
    return units_named(named)


def _surface(config: RunConfig, dataset: xr.Dataset) -> str:
    chosen = config.surface.table
    if chosen["kind"] == "file":
        lattice = " x ".join(str(n) for n in dataset["heights"].shape)
        silent = ("kind", "path", "max_undefined", "channel", "resample", "despike")
        rules = ", ".join(f"{k} = {_word(value, ' ')}" for k, value in chosen.items() if k not in silent)
        rules += ", resampled" if chosen["resample"] else ""
        rules += ", spikes filled" if chosen["despike"] else ""
        return f"{Path(chosen['path']).name}: {lattice} sites ({rules})"
    return described(config.surface)


def described(surface: SurfaceSection) -> str:
    """The parameters of a surface, in a line."""
    facts, apart = surface.table, ("places", "radii", "heights")
    words = (
        f"{k} = {_word(value, ' ' if k in apart else ' x ')}" for k, value in facts.items() if k != "kind"
    )
    return f"{surface.kind}: {', '.join(words)}"


def _word(value: object, between: str) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(_word(one, between) for one in value)})"
    if isinstance(value, list):
        return between.join(_word(one, between) for one in value)
    return f"{value:g}" if isinstance(value, float | int) else str(value)


def _solid(config: RunConfig, dataset: xr.Dataset) -> str:
    described = config.solid.table
    kind, parts = described.pop("kind"), []
    units = units_in(dataset)
    relaxing = {f"{of}relaxing": described.pop(f"{of}branches", []) for of in ("", "base_")}
    for name, value in described.items():
        if isinstance(value, bool):
            parts += [name] * value
        elif isinstance(value, str):
            parts.append(f"{name} = {value}")
        else:
            values = value if isinstance(value, list | tuple) else [value]
            parts.append(f"{name} = " + " and ".join(_of(name, one, units) for one in values))
    for name, branches in relaxing.items():
        unit = "s" if dataset.attrs["si"] else "1"
        times = [f"{share:.3g} in {written(time, unit)}" for share, time in branches]
        parts += [f"{name}: {', '.join(times)}"] * bool(times)
    return f"{kind}: {', '.join(parts)}"


def _of(name: str, value: float, units: Units) -> str:
    """Write a parameter of a solid; an energy of activation in electronvolts."""
    dimension = PARAMETERS.get(name, ("", "1"))[1]
    unit = units.get(dimension, dimension)
    return written(value / _ELECTRONVOLT, "eV") if unit == "J" else written(value, unit)
