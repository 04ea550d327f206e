"""One run on the page: its scene, rows, maps and end; and their messages as bytes.

A message is the length of its header (uint32, little endian), the header (JSON, UTF-8), zeros up to a
multiple of 8, and the arrays that the header lists under ``arrays``, each with zeros up to a multiple of 8.
Heights and pressures are whole numbers from 0 to 65535 over a range that the header gives. Where a body
`ends`, 0 is no body. A run that is
computed, a run in a folder and an exported page give the same messages.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from io import BytesIO
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from asperity.aging import Frame
from asperity.analysis.field_values import pressure_of
from asperity.analysis.legs import leg_table, numbers_of, protocol_of
from asperity.analysis.maps import on_the_surface
from asperity.app.config import RunConfig, to_tables, to_toml
from asperity.app.runs import Outcome
from asperity.base.words import finite
from asperity.lattice import Edges, Field, Mask
from asperity.patches import patches
from asperity.protocols.legs import legs_of
from asperity.protocols.schedule import Schedule
from asperity.results.dataset import Moment, dataset_of, moment_of
from asperity.results.quantities import PAGE, Quantity, areas_first, select
from asperity.results.tabor import coming_velocity

Header = dict[str, Any]
Arrays = dict[str, NDArray[Any]]

_STEPS = 65535
"""Values of a height or a pressure, from 0."""

_TYPES = {"<f8": "f8", "<f4": "f4", "<u2": "u2", "|u1": "u1", "<i4": "i4"}

_MOST_MAPS, _FEWEST_MAPS = 40, 6
_BYTES = 64e6
"""Most and fewest maps of a scene, and about how many bytes all of them may take."""

_RISE = 1e-9  # of a load that is more than rounding

_A_MESSAGE = 4e6
"""Bytes of maps after which a message is sent off."""

_STRENGTH = "relative_strength"
"""Shear strength over the one that is stated, where it depends on velocity or age."""

_SERIES, _PATCHES = select("series", table=PAGE), select("map", table=PAGE)

_RELATIVE = "static friction over that at first, or when the load was on: contact area over load (Tabor)"
_GROWN = (
    "growth of the area since the entry before, over that at first, or when the load was on, per decade of "
    "time since the last switch"
)
_MEAN = "load over real contact area"
_FOUND = (
    Quantity("mean_pressure", "pressure", _MEAN, label="mean pressure in contact"),
    Quantity("friction", "1", _RELATIVE, label="contact area over load, relative to first"),
    Quantity("decade_growth", "1", _GROWN, label="growth per decade"),
)
_MADE = {one.name: one for one in _FOUND}
"""Quantities that the page derives from the recorded ones."""


def pack(header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]] | None = None) -> bytes:
    """Make a message of a header and arrays; numbers that are not finite become null."""
    listed, parts, offset = [], [], 0
    for name, array in (arrays or {}).items():
        raw = np.ascontiguousarray(array)
        listed.append(
            {"name": name, "dtype": _TYPES[raw.dtype.str], "shape": list(raw.shape), "offset": offset}
        )
        parts.append(_padded(raw.tobytes()))
        offset += len(parts[-1])
    # In ASCII: a name that is no UTF-8 has halves of pairs, which JSON can write and UTF-8 cannot.
    words = json.dumps(finite({**header, "arrays": listed}), allow_nan=False).encode()
    start = _padded(len(words).to_bytes(4, "little") + words)
    return b"".join([start, *parts])


def unpack(message: bytes) -> tuple[Header, Arrays]:
    """Read a message of `pack`."""
    length = int.from_bytes(message[:4], "little")
    header: Header = json.loads(message[4 : 4 + length])
    start = (4 + length + 7) // 8 * 8
    arrays = {}
    for entry in header.pop("arrays"):
        count = math.prod(entry["shape"])
        values = np.frombuffer(message, np.dtype(f"<{entry['dtype']}"), count, start + entry["offset"])
        arrays[entry["name"]] = values.reshape(entry["shape"])
    return header, arrays


def json_tables(config: RunConfig) -> dict[str, Any]:
    """A configuration as JSON can write it: an infinite stiffness or velocity is a word."""
    text = json.dumps(to_tables(config))
    tables: dict[str, Any] = json.loads(text, parse_constant=lambda _: "inf")
    return tables


def _padded(raw: bytes) -> bytes:
    return raw + bytes(-len(raw) % 8)


@dataclass(frozen=True, eq=False)
class Map:
    """Contacts of one moment.

    The facts are its time, leg, area, scale of the pressure, and number and sizes of the patches. The arrays
    are ``bits``, the sites in contact row after row; ``pressure``, of each of these; and where the solid
    yields ``yielded``, the sites that have, as bits.
    """

    facts: Header
    arrays: Arrays


def map_of(
    time: float,
    leg: int,
    in_contact: Mask,
    pressure: Field,
    edges: Edges = "periodic",
    indentation: Field | None = None,
) -> Map:
    """Take a map from fields over the sites; without a permanent indentation nothing yields."""
    values = pressure[in_contact]
    scale = float(values.max(initial=0.0))
    steps = np.rint(values * (_STEPS / scale)) if scale > 0 else values
    sizes = patches(in_contact, edges=edges).sizes
    some = sizes.astype(np.float64) if sizes.size else np.array([math.nan])
    facts = {
        **{"time": time, "leg": leg, "area": values.size, "pressure_scale": scale, "patches": sizes.size},
        "mean_patch_size": float(some.mean()),
        "median_patch_size": float(np.median(some)),
        "largest_patch_size": float(some.max()),
    }
    arrays: Arrays = {"bits": np.packbits(in_contact), "pressure": steps.astype(np.uint16)}
    return Map(facts, arrays if indentation is None else arrays | {"yielded": np.packbits(indentation > 0)})


@dataclass
class Cursor:
    """The position of one reader in a recording."""

    scene: bool = False
    stage: str = ""
    rows: int = 0
    maps: int = 0
    ended: bool = False


@dataclass(eq=False)
class Recording:
    """The results of one run so far; readers come and go, each with a `Cursor`.

    ``scene`` is the header of the scene, None before the solids touch; ``rows`` are entries of the time
    series, one number a column; ``end`` is the header of the last message, once there is one.
    """

    job: str
    scene: Header | None = None
    heights: NDArray[np.uint16] | None = None
    rows: list[list[float]] = field(default_factory=list)
    maps: list[Map] = field(default_factory=list)
    stage: str = ""
    end: Header | None = None
    _strengths: Sequence[float] = ()
    """Shear strength in each leg, over that stated; without growth. Empty without one."""
    _first: Moment | None = None
    """The reference entry: the first, or after a first load of 0 the end of the rise."""
    _last: Moment | None = None
    _rises: bool = False

    def begin(self, dataset: xr.Dataset, config: RunConfig | None, title: str, **facts: object) -> None:
        """Describe the scene by a dataset of the run, however short."""
        self.scene, self.heights = _scene(dataset, config, title)
        self.scene |= facts
        if config is not None and (law := config.friction.strength) is not None:
            legs = protocol_of(dataset)  # a prediction makes its own of a ramp
            speeds = np.array([leg.speed or 0.0 for leg in (legs_of(legs) if legs else ())] or [0.0])
            self._strengths = (law.at(coming_velocity(speeds)) / law.strength).tolist()

    def add_row(self, row: Moment) -> None:
        """Add an entry of the time series, by the names of the dataset."""
        assert self.scene is not None
        if self._first is None:
            self._first, self._rises = row, row["load"] == 0
        elif self._rises:
            self._rises = row["load"] > self._first["load"] * (1 + _RISE)
            self._first = row if self._rises else self._first
        if self._strengths and _STRENGTH not in row:
            leg = min(int(row.get("leg", 0)), len(self._strengths) - 1)
            strength = self._strengths[leg] + row.get("grown", 0.0)
            row = {**row, _STRENGTH: strength}
        numbers = row | _derived(row, self._first, self._last or row, self.scene["switches"])
        self.rows.append([float(numbers[name]) for name in self.scene["columns"]])
        self._last = row

    def next(self, cursor: Cursor) -> tuple[Header, Arrays] | None:
        """The next message for a reader: all new entries that fit; None if there are none."""
        if self.stage != cursor.stage and self.end is None:
            cursor.stage = self.stage
            return {"kind": "stage", "job": self.job, "text": self.stage}, {}
        if self.scene is not None and self.heights is not None:
            if not cursor.scene:
                cursor.scene = True
                return {"kind": "scene", "job": self.job, **self.scene}, {"heights": self.heights}
            if cursor.rows < len(self.rows) or cursor.maps < len(self.maps):
                return self._more(cursor, self.scene)
        if self.end is not None and not cursor.ended:
            cursor.ended = True
            return {"job": self.job, **self.end}, {}
        return None

    def messages(self) -> Iterator[bytes]:
        """All messages, for a new reader."""
        cursor = Cursor()
        for number, (header, arrays) in enumerate(iter(lambda: self.next(cursor), None), 1):
            yield pack({**header, "sequence": number}, arrays)

    def _more(self, cursor: Cursor, scene: Header) -> tuple[Header, Arrays]:
        arrays: Arrays = {"rows": np.reshape(self.rows[cursor.rows :], (-1, len(scene["columns"])))}
        listed, taken, first = [], 0, cursor.maps
        in_units = {name: scene["cell"] or 1.0 for name, one in _PATCHES.items() if one.dimension == "sites"}
        for number, one in enumerate(self.maps[first:], first):
            after = number > 0 and self.maps[number - 1].facts["time"] == one.facts["time"]
            sizes = {name: cell * one.facts[name] for name, cell in in_units.items()}
            listed.append({"index": number, **one.facts, **sizes, "side": "after" if after else ""})
            arrays |= {f"{name}.{number}": array for name, array in one.arrays.items()}
            taken += sum(array.nbytes for array in one.arrays.values())
            if taken > _A_MESSAGE:
                break
        cursor.rows, cursor.maps = len(self.rows), first + len(listed)
        times = {"time_now": self.rows[-1][0] if self.rows else 0.0, "last_time": scene["last_time"]}
        return {"kind": "rows", "job": self.job, **times, "maps": listed}, arrays


def started(frame: Frame, config: RunConfig) -> xr.Dataset:
    """Describe a run by its first moment."""
    contact, rtol = frame.contact, config.aging.rtol
    row = moment_of(frame, slides=any(leg.speed for leg in config.written_out))
    switches = Schedule.of(config.written_out, np.empty(0)).switches
    return dataset_of(
        contact, contact.control, config.protocol or None, switches, False, [row], [], rtol=rtol
    )


def of_frame(frame: Frame) -> tuple[Moment, Map]:
    """Entry and map of a moment that was just reached."""
    contact = frame.contact
    # The page shows the rough surface at rest, as `on_the_surface` does.
    back, axes = [-round(sites) for sites in frame.shift], tuple(range(len(frame.shift)))
    in_contact, pressure = np.roll(contact.in_contact, back, axes), np.roll(contact.pressure, back, axes)
    yields = contact.solid.yields
    indentation = np.roll(contact.permanent_indentation, back, axes) if yields else None
    edges = contact.lattice.edges
    new_map = map_of(frame.time, frame.leg, in_contact, pressure, edges, indentation)
    grown = frame.ages.means(contact) if frame.ages is not None else {}
    return {**moment_of(frame, slides=True), **grown}, new_map


def recorded(dataset: xr.Dataset, config: RunConfig | None, *, job: str, title: str) -> Recording:
    """Make the recording of a finished history: rows, and the maps that it kept."""
    recording = Recording(job)
    recording.begin(dataset, config, title)
    names = [name for name in ("time", *_SERIES, *_ends(dataset), "mean_contact_pressure") if name in dataset]
    series = {name: dataset[name].values.tolist() for name in names} | {"leg": numbers_of(dataset).tolist()}
    if "strength_mean" in dataset:
        series[_STRENGTH] = (dataset["strength_mean"] / dataset.attrs["shear_strength"]).values.tolist()
    for number in range(dataset.sizes["time"]):
        recording.add_row({name: values[number] for name, values in series.items()})
    count = dataset.sizes["field_time"] if "in_contact" in dataset else 0
    placed, edges = on_the_surface(dataset), dataset.attrs["edges"]
    for number in _spread(count, most_maps(dataset["heights"].size)):
        fields = placed.isel(field_time=number)
        mask = np.asarray(fields["in_contact"], dtype=bool)
        pressure = pressure_of(fields)
        depth = fields["permanent_indentation"].values if "permanent_indentation" in fields else None
        time, leg = float(fields["field_time"]), int(fields.get("field_leg", 0))
        recording.maps.append(map_of(time, leg, mask, pressure, edges, depth))
    return recording


def ending(dataset: xr.Dataset, rows: Iterable[tuple[str, str]]) -> Header:
    """Header of the message that ends a run: the limit, and the rows of its summary."""
    limit = dataset.attrs.get("relaxed_area")
    cell = math.prod(json.loads(dataset.attrs["spacing"])) if "contact_area" in dataset else None
    limit_row = None
    if limit is not None:
        limit_row = {"area": int(limit), "contact_area": None if cell is None else limit * cell}
    return {"kind": "done", "limit": limit_row, "rows": list(rows)}


def pictured(outcome: Outcome, title: str, rows: Iterable[tuple[str, str]], toml: str) -> Header:
    """Header of the message that is an answer without a contact that ages: its figure, table and rows."""
    (draw, *_), (table, *_) = outcome.drawings().values(), outcome.tables().values()
    stream = BytesIO()
    draw().savefig(stream, format="svg")
    return {
        "kind": "answer",
        "title": title,
        "config": json_tables(outcome.config),
        "toml": toml,
        "picture": stream.getvalue().decode(),
        "table": table.to_csv(index=False, lineterminator="\n"),
        "rows": list(rows),
    }


def most_maps(sites: int) -> int:
    """Most maps that fit in `_BYTES` with a quarter of the sites in contact."""
    return int(min(_MOST_MAPS, max(_FEWEST_MAPS, _BYTES / (0.625 * sites))))


def mapped(times: Sequence[float], switches: Sequence[float], sites: int) -> set[float]:
    """Times at which to take a map: spread over those recorded, and always the first, last and switches."""
    recorded = sorted({0.0, *times})
    chosen = [recorded[number] for number in _spread(len(recorded), most_maps(sites))]
    return {*chosen, *switches[: _MOST_MAPS - 1]}


def _spread(count: int, most: int) -> list[int]:
    """Whole numbers below ``count``, evenly spread, with the first and the last."""
    if count <= most:
        return list(range(count))
    return sorted(set(np.linspace(0, count - 1, most).round().astype(int).tolist()))


def _ends(dataset: xr.Dataset) -> list[str]:
    """Names of the ends of 95 % bands."""
    return [f"{name}_{end}" for name in _SERIES if f"{name}_low" in dataset for end in ("low", "high")]


def _scene(dataset: xr.Dataset, config: RunConfig | None, title: str) -> tuple[Header, NDArray[np.uint16]]:
    heights = np.atleast_2d(np.asarray(dataset["heights"], dtype=np.float64))
    ends = not (body := np.isfinite(heights)).all()
    low, high = float(heights[body].min()), float(heights.max())
    low -= ends * ((high - low) / (_STEPS - 1) or 1.0)  # 0 is no body
    steps = np.where(body, heights - low, 0.0) * (_STEPS / (high - low) if high > low else 0.0)
    lengths = "contact_area" in dataset
    series = [name for name in (*_SERIES, *_ends(dataset)) if name in dataset]
    law = None if config is None else config.friction.strength
    varies = law is not None and (law.rate_coefficient or law.ages)
    columns = ["time", "leg", *series, *_MADE, *([_STRENGTH] if varies else [])]
    more = _MADE | _PATCHES
    shown = {name: _SERIES[name] for name in areas_first(_SERIES) if name in series} | more
    unit = {name: str(dataset[name].attrs.get("units", "1")) for name in ("time", "heights", *series)}
    pressure = dataset["mean_contact_pressure"].attrs["units"] if lengths else f"{unit['load']} / site"
    area = unit["contact_area" if lengths else "area"]
    column_units = unit | {
        name: area if one.dimension == "sites" else one.dimension for name, one in more.items()
    }
    spacing = json.loads(dataset.attrs["spacing"])
    steps_between = [1.0, *spacing][-2:]
    switches = [row.begin for row in leg_table(dataset)[1:]]
    header = {
        "title": title,
        "config": None if config is None else json_tables(config),
        "toml": "" if config is None else to_toml(config),
        "shape": list(heights.shape),
        "spacing": steps_between if lengths else None,
        "cell": math.prod(spacing) if lengths else None,
        "length_unit": str(dataset["x"].attrs.get("units", "")) if lengths else None,
        "units": {
            **{name: unit[name] for name in ("time", "load", "separation")},
            **{"area": area, "height": unit["heights"]},
            "pressure": pressure,
        },
        "names": {name: one.long_name for name, one in shown.items()},
        "labels": {name: one.label for name, one in shown.items() if not (lengths and name == "area")},
        "column_units": column_units | {"leg": "1", "mean_pressure": pressure},
        "columns": columns,
        "map_columns": list(_PATCHES),
        "switches": sorted(set(switches)),
        "last_time": float(dataset["time"][-1]),
        "height_range": [low, high],
        "ends": ends,
        "shear_strength": None if law is None else law.strength,
    }
    return header, np.rint(steps).astype(np.uint16)


def _derived(row: Moment, first: Moment, last: Moment, switches: Sequence[float]) -> Moment:
    """Leg and derived quantities of an entry; NaN where they are undefined."""
    area, load, time, leg = (float(row.get(name, 0.0)) for name in ("area", "load", "time", "leg"))
    numbers = {"leg": leg, "friction": math.nan, "decade_growth": math.nan}
    numbers["mean_pressure"] = row.get("mean_contact_pressure", load / area if area else 0.0)
    if load > 0 and first["load"] > 0 and first["area"] > 0:
        numbers["friction"] = (area / first["area"]) * (first["load"] / load)
    since = max((switch for switch in switches if switch < time), default=0.0)
    earlier = last["time"] - since
    if 0 < earlier < time - since and leg == last.get("leg", 0.0) and first["area"] > 0:
        growth = (area - last["area"]) / first["area"]
        numbers["decade_growth"] = growth / math.log10((time - since) / earlier)
    return numbers
