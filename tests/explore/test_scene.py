"""Messages: what was packed comes out; what a scene makes of areas and loads is what it says."""

from __future__ import annotations

import json
import math
import shutil
import struct
import subprocess
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

import asperity as asp
from asperity.app.config import config_from
from asperity.app.config.keys import sections
from asperity.app.explore.mistakes import mistakes_of
from asperity.app.explore.scene import mapped, most_maps, of_frame, pack, recorded, started, unpack
from asperity.errors import InputError

ARRAYS: dict[str, Any] = {
    "rows": np.arange(6.0).reshape(3, 2),
    "bits.0": np.array([3, 255, 7], dtype=np.uint8),
    "none": np.empty((0, 2)),
    "pressure": np.array([[1], [65535]], dtype=np.uint16),
    "small": np.array([1.5], dtype=np.float32),
    "whole": np.array([-7, 2**31 - 1], dtype=np.int32),
}

LATTICE = asp.solids.spring_lattice(k0=1.0, k1=3.0)


def test_what_was_packed_comes_out_and_everything_begins_at_multiples_of_eight() -> None:
    message = pack({"kind": "rows", "text": "µ–∞"}, ARRAYS)
    header, arrays = unpack(message)
    assert header == {"kind": "rows", "text": "µ–∞"}
    assert arrays.keys() == ARRAYS.keys()
    for name, array in ARRAYS.items():
        assert arrays[name].dtype == array.dtype
        assert np.array_equal(arrays[name], array)
    for length in (0, 3):
        message = pack({"text": "x" * length}, {"a": np.zeros(3, np.uint8), "b": np.ones(2)})
        assert len(message) % 8 == 0
        (count,) = struct.unpack("<I", message[:4])
        assert [one["offset"] for one in json.loads(message[4 : 4 + count])["arrays"]] == [0, 8]
        start = math.ceil((4 + count) / 8) * 8
        assert np.frombuffer(message[start + 8 : start + 24], "<f8").tolist() == [1.0, 1.0]
    # What is not finite is null.
    header, _ = unpack(pack({"a": math.nan, "b": [math.inf, np.float64(2.5)], "c": {"d": -math.inf}}))
    assert header == {"a": None, "b": [None, 2.5], "c": {"d": None}}


def test_which_moments_are_mapped() -> None:
    times = np.geomspace(1e-3, 1e6, 400).tolist()
    chosen = mapped(times, [123.0], 200**2)
    assert {0.0, times[-1], 123.0} <= chosen
    assert len(chosen) <= most_maps(200**2) + 1 <= 41
    steps = np.diff(np.log10(sorted(chosen - {0.0, 123.0})))
    assert steps.max() < 2 * steps.min()
    assert most_maps(4096**2) == 6


def test_a_history_becomes_rows_and_maps() -> None:
    contact = asp.press(asp.surfaces.gaussian((24, 24), seed=2), LATTICE, load=30.0)
    legs = [asp.protocols.Hold(10.0), asp.protocols.Step(load=15.0), asp.protocols.Hold(10.0)]
    history = asp.age(contact, [0.1, 1.0, 10.0, 11.0, 20.0], protocol=legs, fields_at=[0.0, 10.0, 20.0])
    aged = history.dataset
    scene = recorded(aged, None, job="one", title="two")
    assert scene.scene is not None
    columns = scene.scene["columns"]
    rows = np.array(scene.rows)
    for name in ("time", "leg", "area", "load", "separation", "residual"):
        assert np.array_equal(rows[:, columns.index(name)], aged[name].values)
    assert scene.scene["switches"] == [10.0]
    assert scene.heights is not None
    low, high = scene.scene["height_range"]
    back = low + (high - low) * scene.heights / 65535
    assert np.abs(back - aged["heights"].values).max() <= 0.51 * (high - low) / 65535
    area, load = aged["area"].values, aged["load"].values
    friction = rows[:, columns.index("friction")]
    assert friction == pytest.approx(area / load / (area[0] / load[0]), rel=1e-12)
    assert [one.facts["time"] for one in scene.maps] == aged["field_time"].values.tolist()
    for one, mask in zip(scene.maps, aged["in_contact"].values, strict=True):
        assert np.array_equal(np.unpackbits(one.arrays["bits"]).reshape(24, 24), mask)
        # Forces of springs come from u and u0: their sum is the load, and none is off contact.
        total = one.arrays["pressure"].astype(float).sum() * one.facts["pressure_scale"] / 65535
        time, leg = one.facts["time"], one.facts["leg"]
        at = np.flatnonzero((aged["time"].values == time) & (aged["leg"].values == leg))
        assert total == pytest.approx(aged["load"].values[at[0]], rel=1e-4)
        assert "yielded" not in one.arrays
    for name in scene.scene["map_columns"]:
        assert [one.facts[name] for one in scene.maps] == aged[name].values.tolist()
        assert scene.scene["column_units"][name] == aged[name].attrs["units"]
    # Growth per decade counts from the last switch.
    found = dict(zip(map(tuple, rows[:, :2]), rows[:, columns.index("decade_growth")], strict=True))
    known = dict(zip(zip(aged["time"].values, aged["leg"].values, strict=True), area, strict=True))
    assert found[1.0, 0] == pytest.approx((known[1.0, 0] - known[0.1, 0]) / area[0])
    assert found[20.0, 2] == pytest.approx((known[20.0, 2] - known[11.0, 2]) / area[0])
    assert np.isnan([found[0.0, 0], found[0.1, 0], found[10.0, 1], found[11.0, 2]]).all()


def test_a_history_that_slides_and_yields_has_its_displacement_and_yielding_sites() -> None:
    solid = LATTICE.with_hardness(1.0)
    contact = asp.press(np.random.default_rng(2).normal(size=(8, 8)), solid, load=16.0)
    slides = [asp.protocols.Slide(distance=2.0, velocity=1.0), asp.protocols.Hold(3.0)]
    series = asp.age(contact, [1.0, 2.0, 5.0], protocol=slides, fields_at=[0.0, 5.0]).dataset
    recording = recorded(series, None, job="", title="")
    assert recording.scene is not None
    columns = recording.scene["columns"]
    got = [row[columns.index("displacement")] for row in recording.rows]
    assert got == series["displacement"].values.tolist()
    assert recording.scene["column_units"]["displacement"] == series["displacement"].attrs["units"]
    yielding = [row[columns.index("yielding_area")] for row in recording.rows]
    assert yielding == series["yielding_area"].values.tolist()
    assert yielding[0] > 0
    bits = [np.unpackbits(one.arrays["yielded"]).reshape(8, 8) for one in recording.maps]
    depths = series["permanent_indentation"].values
    shifts = series["field_shift_x"].values.astype(int).tolist()
    assert (shifts[0], shifts[-1]) == (0, 2)
    for found, depth, moved in zip(bits, depths, shifts, strict=True):
        assert np.array_equal(found, np.roll(depth > 0, -moved, axis=1))  # the surface is shown at rest
    assert bits[-1].sum() >= bits[0].sum() > 0
    frames: list[Any] = []
    asp.age(contact, [5.0], protocol=slides, progress=frames.append)
    config = config_from({"protocol": [{"kind": "slide", "distance": 2.0, "velocity": 1.0}]}, {}, None)
    assert started(frames[0], config)["displacement"].values.tolist() == [0.0]
    row, seen = of_frame(frames[-1])
    assert (row["displacement"], row["yielding_area"]) == (2.0, yielding[-1])
    assert np.array_equal(seen.arrays["yielded"], recording.maps[-1].arrays["yielded"])


@pytest.mark.skipif(shutil.which("node") is None, reason="needs node")
@pytest.mark.parametrize(
    ("loads", "reference"),
    [([0, 5, 9, 9, 9, 4], 2), ([3, 9, 9, 4], 0), ([0, 9], 1), ([0], 0), ([0, 0, 5], 0)],
)
def test_the_page_compares_with_the_end_of_a_ramp_from_no_load(loads: list[float], reference: int) -> None:
    rng = np.random.default_rng(1)
    touching = rng.integers(0, 2, (len(loads), 16)).astype(bool)
    maps = [{"time": n, "leg": 0, "bits": np.packbits(one).tolist()} for n, one in enumerate(touching)]
    known = {"shape": [4, 4], "sites": 16, "maps": maps, "columns": ["time", "leg", "load"]}
    known |= {"rows": [[n, 0, load] for n, load in enumerate(loads)], "units": {"time": "s"}}
    page = Path(asp.__file__).parent / "app/explore/page/scene.js"
    script = f"""{page.read_text()}
        const quantity = (value, unit) => `${{value}} ${{unit}}`;
        const given = {json.dumps(known)};
        const scene = Object.assign(Object.create(Scene.prototype), given, {{ decoded: new Map() }});
        const states = scene.maps.map((_, map) => Array.from(scene.states(map).states));
        console.log(JSON.stringify([scene.reference, scene.start, states]));"""
    run = subprocess.run(["node"], input=script, capture_output=True, text=True, check=True, timeout=30)
    found, start, states = json.loads(run.stdout)
    assert found == reference
    assert start == (f"t = {reference} s" if reference else "first touch")
    then = touching[reference]
    for number, now in enumerate(touching):
        lost = 3 if number >= reference else 0
        np.testing.assert_array_equal(states[number], np.select([now & then, now, then], [1, 2, lost], 0))


def test_growth_and_friction_after_a_ramp_are_over_its_end_and_sizes_are_areas() -> None:
    rough = asp.surfaces.spectral((32, 32), spacing=1e-6, rms_slope=0.1, unit="m", seed=1)
    solid = asp.solids.half_space(modulus=3e9, branches=[(0.5, 1.0)])
    legs: Any = [asp.protocols.Ramp(1.0, load=cast(Any, "3 mN")), asp.protocols.Hold(99.0)]
    contact = asp.press(rough, solid, load=0.0)
    times = [0.5, 1.0, 2.0, 11.0, 100.0]
    aged = asp.age(contact, times, protocol=legs, fields_at=[1.0], carried=asp.Carried(resistivity=1e-6))
    recording = recorded(aged.dataset, None, job="", title="")
    assert recording.scene is not None
    columns, rows = recording.scene["columns"], np.array(recording.rows)
    time, area, load = (rows[:, columns.index(name)] for name in ("time", "area", "load"))
    end = int(np.flatnonzero(time == 1.0)[-1])
    assert (time[end], load[0]) == (1.0, 0.0)
    late, before = (int(np.flatnonzero(time == moment)[0]) for moment in (11.0, 2.0))
    growth = rows[late, columns.index("decade_growth")]
    assert growth == pytest.approx((area[late] - area[before]) / area[end])  # times since the ramp: 1 and 10
    friction = rows[late, columns.index("friction")]
    assert friction == pytest.approx(area[late] / area[end])
    for name in ("normal_stiffness", "resistance"):
        assert rows[:, columns.index(name)].tolist() == aged[name].values.tolist()
    header = next(header for header, _ in map(unpack, recording.messages()) if header.get("maps"))
    assert header["maps"][0]["largest_patch_size"] == aged["largest_patch_size"].values[0] * 1e-12
    assert recording.scene["column_units"]["largest_patch_size"] == "m^2"
    assert "area" not in recording.scene["labels"]


def test_the_page_says_nothing_of_flags() -> None:
    form = json.dumps({kind: str(keys) for kind, keys in sections(short=True).items()})
    assert "--" not in form
    assert "flag" not in form


def test_a_mistake_stands_at_its_key_in_any_section_of_the_form():
    for name, place in (
        ("resistivity", "carried.resistivity"),
        ("load", "contact.load"),
        ("young", "solid.young"),
        ("pixel_size", "surface.pixel_size"),
        ("--maps-at", "output.maps_at"),
        ("scan", ""),
    ):
        (found,) = mistakes_of(InputError(name, expected="more", got=0))
        assert found["where"] == place
