"""A surface and a solid from a file of one's own, each one line in a list: all doors take them."""

import json
import subprocess
import sys

import pytest

DEFINED = """
import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Ge, Gt

from asperity import protocols, solids, surfaces
from asperity.adhesion import Dugdale
from asperity.base.parameters import Quantity
from asperity.protocols import Leg
from asperity.solids import CreepBranch, LaplacianSpectrum, Solid
from asperity.surfaces.making import Shape, Unit, in_unit

Amplitude = Annotated[float | str, Gt(0), Quantity("amplitude of the stripes", dimension="height unit")]
Width = Annotated[float | str, Gt(0), Quantity("width of a tooth", dimension="length unit")]
Period = Annotated[int, Ge(2), Quantity("sites of a period", dimension="sites", more=", 2 or more.")]
Stiffness = Annotated[float, Gt(0), Quantity("stiffness of the bed", dimension="stiffness unit", usual=2.0)]
Wait = Annotated[float | str, Gt(0), Quantity("time of the bed", "s")]


Slopes = Annotated[tuple[float, float], Quantity("slopes along y and x")]


def stripes(shape: Shape, *, amplitude: Amplitude = 1.0, period: Period = 8, slopes: Slopes | None = None):
    n, m = shape
    slope, along = slopes or (0.0, 0.0)
    heights = np.tile(amplitude * np.cos(2 * math.pi * np.arange(m) / period), (n, 1))
    return heights + slope * np.arange(n)[:, np.newaxis] + along * np.arange(m)


@in_unit
def teeth(shape: Shape, *, width: Width = 2.0, amplitude: Amplitude = 1.0, unit: Unit = None):
    across = np.arange(shape[1]) % (2 * width) < width
    return np.tile(amplitude * across, (shape[0], 1))


@dataclass(frozen=True)
class Shove(Leg):
    duration: Annotated[float, Gt(0), Quantity("how long it lasts", "s")]
    far: Annotated[float, Gt(0), Quantity("how far it goes", "m")]


@dataclass(frozen=True)
class Wax(Dugdale):
    work: Annotated[float, Gt(0), Quantity("work of adhesion", "J/m^2")]
    range: Annotated[float, Gt(0), Quantity("range", "m")]
    formula = "wax"


def bed(*, modulus: Stiffness, wait: Wait = 10.0):
    law, mobility = (LaplacianSpectrum(uniform=value) for value in (modulus / 2, 2 / (modulus * wait)))
    told = {"modulus": modulus, "wait": wait}
    return Solid(permanent=law, branches=(CreepBranch(law, mobility),), parameters=told, kind="bed")


surfaces.stripes, solids.bed = stripes, bed
surfaces.KINDS["stripes"], solids.KINDS["bed"] = stripes, bed
surfaces.KINDS["teeth"], protocols.KINDS["shove"], solids.LAWS["adhesion"]["wax"] = teeth, Shove, Wax
"""

USED = '''
import json, sys
from pathlib import Path

import own
from asperity.app.campaign.plan import read_plan
from asperity.app.cli.flags import flags_for, given
from asperity.app.config import config_from, read_config, to_toml
from asperity.app.config.keys import sections
from asperity.app.config.python import to_python
from asperity.app.explore.server import Places, read_request
from asperity.app.runs import Progress, execute, recorded_times
from asperity.errors import ConfigError
from asperity.results.parameters import PARAMETERS

Path("run.toml").write_text("""
[surface]
kind = "stripes"
shape = [16, 32]
amplitude = 0.5
period = 16
slopes = [0.0, 0.0]
[solid]
kind = "bed"
modulus = 3.0
[contact]
load = 200.0
[aging]
first = 0.1
last = 1e4
per_decade = 2
[output]
maps_at = []
""")
config = read_config("run.toml", {})
outcome = execute(config, Progress())
attrs = outcome.dataset.attrs
Path("copy.toml").write_text(to_toml(outcome.config))
flags = flags_for("surface", "solid")(
    surface_kind="stripes", surface_amplitude="0.5", surface_period="16", surface_slopes=["0 0"],
    solid_kind="bed", solid_modulus="3",
)
laid = read_config("run.toml", given(flags))
sweep = "[sweep]\\nperiod = [8, 16]\\nmodulus = [2.0, 3.0]\\n"
Path("plan.toml").write_text(Path("run.toml").read_text() + sweep)
plan = read_plan("plan.toml")
mistakes = []
for surface, solid in (({"amplitude": -1.0}, {}), ({"perod": 3}, {}), ({}, {"modulus": "2 m"})):
    try:
        config_from({"surface": {"kind": "stripes", **surface}, "solid": {"kind": "bed", **solid}}, {}, None)
    except ConfigError as error:
        mistakes += error.problems
lengths = {
    "surface": {"kind": "teeth", "shape": [4, 8], "width": "2 um", "amplitude": "30 nm", "unit": "um"},
    "solid": {"kind": "half_space", "modulus": 3e9, "adhesion": "wax", "adhesion_work": "5 mJ/m^2"}
    | {"adhesion_range": "0.3 um"},
    "protocol": [{"kind": "shove", "duration": "1 min", "far": "20 um"}],
    "contact": {"load": "1 N"},
}
flags = flags_for("surface", "preparation", "solid", "contact")
words = {f"{part}_{key}": str(one) for part in ("surface", "solid") for key, one in lengths[part].items()}
words |= {"surface_shape": ["4 8"], "contact_load": "1 N"}
doors = [
    config_from(lengths, {}, None),
    config_from({}, given(flags(**words), leg=["shove 1min far=20um"]), None),
    read_request(json.loads(json.dumps(lengths)), Places(None, Path()))[0],
]
doors = [
    [one.surface.width, one.surface.amplitude, *map(vars(one.solid.laws["adhesion"]).get, ("range", "work"))]
    + [one.protocol[0].duration, one.protocol[0].far, one.surface.build().heights.max() * 1e-6]
    for one in doors
]
wax, shove = own.Wax(work="5 mJ/m^2", range="0.3 um"), own.Shove("1 min", far="20 um")
made = own.teeth((4, 8), width="2 um", amplitude="30 nm", unit="um")
doors.append([2.0, 0.03, wax.range, wax.work, shove.duration, shove.far, made.heights.max() * 1e-6])
home = {}
exec(to_python(outcome.config, recorded_times(outcome.config).tolist()).replace("print(history)", ""), home)
keys = sections(short=True)
print(json.dumps({
    "same": [config == laid, read_config("copy.toml", {}) == outcome.config],
    "areas": [outcome.dataset["area"].values.tolist(), home["history"].dataset["area"].values.tolist()],
    "attrs": {name: attrs[name] for name in ("surface_amplitude", "surface_period", "modulus", "wait")},
    "axes": [[axis.section, axis.name, axis.values] for axis in plan.axes],
    "runs": [[run.config.surface.period, run.config.solid.modulus] for run in plan.runs],
    "said": [keys["surface"]["stripes"]["period"].description, keys["solid"]["bed"]["wait"].unit],
    "recorded": [PARAMETERS["amplitude"], PARAMETERS["wait"]],
    "mistakes": mistakes,
    "doors": doors,
}))
'''


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("own")
    (folder / "own.py").write_text(DEFINED)
    (folder / "use.py").write_text(USED)
    done = subprocess.run(
        [sys.executable, "use.py"], cwd=folder, check=False, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def test_a_file_flags_and_python_say_the_same(found):
    assert found["same"] == [True, True]
    assert found["areas"][0] == found["areas"][1]
    # Half of each period is above the mean; of every 16 columns as many touch as the load bends.
    assert all(area % (16 * 2) == 0 or area % 16 == 0 for area in found["areas"][0])
    assert found["areas"][0][-1] > found["areas"][0][0]


def test_lengths_of_a_surface_a_law_and_a_leg_are_the_same_through_all_doors(found):
    for values in found["doors"]:
        assert values == pytest.approx([2.0, 0.03, 3e-7, 0.005, 60.0, 2e-5, 3e-8], rel=1e-12)


def test_keys_are_swept_recorded_and_explained(found):
    assert found["axes"] == [["surface", "period", [8, 16]], ["solid", "modulus", [2.0, 3.0]]]
    assert found["runs"] == [[8, 2.0], [8, 3.0], [16, 2.0], [16, 3.0]]
    assert found["attrs"] == {"surface_amplitude": 0.5, "surface_period": 16, "modulus": 3.0, "wait": 10.0}
    assert found["recorded"] == [["amplitude of the stripes", "height unit"], ["time of the bed", "time"]]
    assert found["said"] == ["Sites of a period, 2 or more.", "s"]


def test_mistakes_are_named_as_those_of_other_kinds(found):
    assert found["mistakes"] == [
        "[surface] amplitude: expected a finite number > 0, got -1.0",
        "[surface] perod: no such key; try period",
        "[solid] modulus: expected a finite number > 0, got '2 m'",
    ]
