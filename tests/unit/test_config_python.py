"""A configuration as Python: executed, the text gives the areas and energies of the run, to the last bit."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asperity.app.config import RunConfig, config_from
from asperity.app.config.python import to_python
from asperity.app.runs import Progress, execute, recorded_times
from tests.refusals import refuses

MAXWELL = {"kind": "half_space", "modulus": 3.1e9, "branches": [[0.3, 0.1], [0.2, 7.0]]}
SHORT = {"first": 0.1, "last": 20.0, "per_decade": 2}
CASES = {
    "exponential": """
    surface = { kind = "exponential", shape = [16, 12], rms = 0.7, seed = 3 }
    solid = { kind = "spring_lattice", k1 = 5.0, R_viscous = 0.3 }
    aging = { first = 0.1, last = 20.0, per_decade = 2, hold = "separation", rtol = 1e-3 }""",
    "self-affine": """
    surface = { kind = "self_affine", size = 16, hurst = 0.7, seed = 1 }
    contact.separation = 0.05""",
    "line": """
    surface = { shape = [64], rms = 0.7, seed = 3 }
    contact.load = 1.5
    output.maps_at = [0.0, 0.77]""",
    "waves without units": """
    surface = { kind = "spectral", shape = [16, 16], spacing = [1.0, 1.0] }
    aging.times = [0.0, 0.3, 0.3333333333333333, 9.0]""",
    "free edges without units": """
    surface = { shape = [16, 12], rms = 0.7, seed = 3, edges = "free" }
    solid = { kind = "half_space", modulus = 2.0, branches = [[0.3, 0.1], [0.2, 7.0]] }""",
    "carried": """
    surface.edges = "free"
    surface.kind = "spectral"
    surface.shape = [16, 16]
    surface.rms_slope = 0.1
    surface.spacing = [2e-6]
    surface.unit = "m"
    solid = { kind = "half_space", young = ["3 GPa", "7 GPa"], poisson = [0.3, 0.3] }
    carried.stiffness = true
    carried.resistivity = [1e-8, 2e-8]
    carried.shear = "1 uN"
    carried.friction_coefficient = 0.4""",
    "flow": """
    surface = { shape = [16, 12], rms = 0.7, seed = 3 }
    solid = { kind = "half_space", modulus = 2.0, flow = [0.5, 1.0] }""",
    "coated": """
    surface = { kind = "spectral", shape = [16, 16], rms_slope = 0.1, spacing = [2e-6], unit = "m", seed = 2 }
    contact.pressure = "2 MPa"
    [solid]
    kind = "coated_half_space"
    modulus = 3.1e9
    branches = [[0.3, 0.1], [0.2, 7.0]]
    poisson = 0.4
    thickness = 1e-5
    base_modulus = 9e9
    base_poisson = 0.3
    base_branches = [[0.5, 1.0]]
    apparatus = inf""",
    "paraboloid": """
    surface.kind = "paraboloid"
    surface.shape = [16, 12]
    surface.radius = ["50 um", 3e-5]
    surface.pixel_size = 1e-6
    surface.edges = "periodic"
    solid = { kind = "half_space", modulus = 3.1e9, branches = [[0.3, 0.1], [0.2, 7.0]] }""",
    "balls": """
    solid = { kind = "half_space", modulus = 3.1e9, branches = [[0.3, 0.1], [0.2, 7.0]] }
    [surface]
    kind = "array"
    shape = [16, 12]
    places = [[4e-6, 4e-6], ["1e-5 m", "8 um"]]
    radii = 6e-6
    pixel_size = [1e-6, "2 um"]
    heights = [0, -1e-7]""",
    "protocol": """
    surface = { shape = [24, 24], rms = 0.7, seed = 3 }
    contact.load = 60.0
    aging.per_decade = 2
    protocol = [
        { kind = "hold", duration = 3.0, hold = "area" },
        { kind = "step", load = 15.0 },
        { kind = "hold", duration = 1.0, mobility = 2.5 },
        { kind = "repeat", count = 2, legs = [
            { kind = "ramp", duration = 0.7, load = 30.0 },
            { kind = "ramp", duration = 0.1, load = 20.0, mobility = 0.5 },
        ] },
    ]""",
}


def completed(tables: dict[str, Any]) -> tuple[RunConfig, Any]:
    tables = {"aging": {} if "protocol" in tables else SHORT, **tables}
    outcome = execute(config_from(tables, {}, None), Progress())
    return outcome.config, outcome.dataset


def repeated(tables: dict[str, Any]) -> dict[str, Any]:
    """What the Python text of a run leaves, whose numbers are those of the run."""
    config, dataset = completed(tables)
    text = to_python(config, recorded_times(config).tolist())
    assert max(map(len, text.splitlines())) <= 110
    found: dict[str, Any] = {}
    exec(compile(text, "<copied>", "exec"), found)
    again = found["history"].dataset
    for name in ("time", "area", "energy", "load", "separation"):
        assert np.array_equal(again[name].values, dataset[name].values)
    if "limit" in found:
        assert found["limit"].energy == dataset.attrs["relaxed_energy"]
    return found


@pytest.mark.filterwarnings("ignore::asperity.errors.Remark")
@pytest.mark.parametrize("text", CASES.values(), ids=CASES)
def test_the_text_gives_the_same_numbers(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    repeated(tomllib.loads(text))
    assert capsys.readouterr().out.startswith("<History: ")


def test_a_measured_surface_and_a_spectrum_are_read_again(tmp_path: Path) -> None:
    path = tmp_path / "it's a 'scan'.npy"
    np.save(path, np.random.default_rng(0).normal(size=(14, 12)))
    surface: dict[str, Any] = {"kind": "file", "path": str(path), "periodic": "taper", "file_unit": "nm"}
    surface |= {"crop": [0, 12, 0, 12], "pixel_size": [3e-8], "length_unit": "m"}
    repeated({"surface": surface, "solid": MAXWELL})
    for shape in ([16, 12], [64]):
        power = 2 + len(shape)
        (tmp_path / "psd.csv").write_text(f"q_1/um,C_nm^{power}\n0.1,4e12\n1,4e12\n4,1e10\n")
        surface = {"kind": "spectrum", "path": str(tmp_path / "psd.csv"), "shape": shape, "unit": "um"}
        found = repeated({"surface": surface | {"spacing": [0.5], "seed": 2}, "solid": MAXWELL})
        assert found["rough"].heights.std() > 0.01 * 10.0 ** (-3 * (power - 2) / 2)


def test_a_load_that_is_left_open_is_refused() -> None:
    with refuses("contact"):
        to_python(config_from({}, {}, None), [1.0])
