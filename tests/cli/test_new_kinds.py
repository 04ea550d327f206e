"""A surface and a solid from a file of one's own, each one line in a list: all doors take them."""

import os
import subprocess
import sys
from pathlib import Path

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
Period = Annotated[int, Ge(2), Quantity("sites of a period, 2 or more.", dimension="sites")]
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

USED = """
import tomllib
from pathlib import Path

import own
import pytest
from asperity.app.campaign.plan import read_plan
from asperity.app.config import config_from, read_config, to_toml
from asperity.app.config.keys import sections
from asperity.app.config.python import to_python
from asperity.app.runs import Progress, execute, recorded_times
from asperity.errors import ConfigError
from asperity.results.parameters import PARAMETERS
from tests.unit.test_doors import check_doors

STRIPES = {"kind": "stripes", "shape": [16, 32], "amplitude": 0.5, "period": 16, "slopes": [0.0, 0.0]}
BED = {"kind": "bed", "modulus": 3.0}
TEETH = {"kind": "teeth", "shape": [4, 8], "unit": "um"}
WAX = {"kind": "half_space", "modulus": 3e9, "adhesion": "wax"}
FAR = {"kind": "shove", "duration": 60.0, "far": 2e-5}
for section, keys, numbers, texts in (
    ("surface", STRIPES, {}, {}),
    ("solid", BED, {}, {}),
    ("surface", TEETH, {"width": 2.0, "amplitude": 0.03}, {"width": "2 um", "amplitude": "30 nm"}),
    ("solid", WAX, {"adhesion_work": 0.005, "adhesion_range": 3e-7},
     {"adhesion_work": "5 mJ/m^2", "adhesion_range": "0.3 um"}),
    ("protocol", FAR, {}, {"duration": "1 min", "far": "20 um"}),
):
    check_doors(section, keys | numbers, keys | texts, Path())

aging = {"first": 0.1, "last": 1e4, "per_decade": 2}
asked = {"surface": STRIPES, "solid": BED, "contact": {"load": 200.0}, "aging": aging}
asked["output"] = {"maps_at": []}
outcome = execute(config_from(asked, {}, None), Progress())
attrs = outcome.dataset.attrs
Path("copy.toml").write_text(to_toml(outcome.config))
assert read_config("copy.toml", {}) == outcome.config
program = to_python(outcome.config, recorded_times(outcome.config).tolist()).replace("print(history)", "")
exec(program, home := {})
area = outcome.dataset["area"].values.tolist()
assert area == home["history"].dataset["area"].values.tolist()
# Half of each period is above the mean; of every 16 columns as many touch as the load bends.
assert all(one % 16 == 0 for one in area) and area[-1] > area[0]
kept = {name: attrs[name] for name in ("surface_amplitude", "surface_period", "modulus", "wait")}
assert kept == {"surface_amplitude": 0.5, "surface_period": 16, "modulus": 3.0, "wait": 10.0}
assert tuple(PARAMETERS["amplitude"]) == ("amplitude of the stripes", "height unit")
assert tuple(PARAMETERS["wait"]) == ("time of the bed", "time")
keys = sections(short=True)
assert keys["solid"]["bed"]["wait"].unit == "s"
assert keys["surface"]["stripes"]["period"].description == "Sites of a period, 2 or more."

swept = "[sweep]\\nperiod = [8, 16]\\nmodulus = [2.0, 3.0]\\n"
Path("plan.toml").write_text(Path("copy.toml").read_text() + swept)
plan = read_plan("plan.toml")
axes = [[axis.section, axis.name, list(axis.values)] for axis in plan.axes]
assert axes == [["surface", "period", [8, 16]], ["solid", "modulus", [2.0, 3.0]]]
found = [[run.config.surface.period, run.config.solid.modulus] for run in plan.runs]
assert found == [[8, 2.0], [8, 3.0], [16, 2.0], [16, 3.0]]

for surface, solid, line in (
    ({"amplitude": -1.0}, {}, "[surface] amplitude: expected a finite number > 0, got -1.0"),
    ({"perod": 3}, {}, "[surface] perod: no such key; try period"),
    ({}, {"modulus": "2 m"}, "[solid] modulus: expected a finite number > 0, got '2 m'"),
):
    with pytest.raises(ConfigError) as refused:
        config_from({"surface": {"kind": "stripes", **surface}, "solid": {"kind": "bed", **solid}}, {}, None)
    assert refused.value.problems == [line]
"""


def test_kinds_of_a_file_of_ones_own_pass_every_door(tmp_path):
    (tmp_path / "own.py").write_text(DEFINED)
    (tmp_path / "use.py").write_text(USED)
    paths = os.pathsep.join([str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, "use.py"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": paths},
        check=False,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
