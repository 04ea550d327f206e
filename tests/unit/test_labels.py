"""Units and labels of summaries and figures."""

from __future__ import annotations

import numpy as np

import asperity as asp
from asperity.analysis.scan import written
from asperity.app.cli.reports.run import _solid
from asperity.app.config import config_from
from asperity.figures.style import spelled

P = asp.protocols
ROUGH = np.random.default_rng(3).normal(size=(16, 16))


def test_quantities_have_a_prefix_where_that_is_short() -> None:
    given = [(1e-6, "m/s"), (7e-21, "m/s"), (5e-28, "m^3"), (2e-17, "m^3"), (2e-15, "J"), (1.2, "eV")]
    said = ["1 um/s", "7e-21 m/s", "0.5 nm^3", "20 um^3", "0.002 pJ", "1.2 eV", "300 K", "0 m/s"]
    assert [written(*one) for one in (*given, (300.0, "K"), (0.0, "m/s"))] == said
    assert [spelled(unit) for unit in ("um/s", "nm^3", "um^2", "K")] == ["µm/s", "nm³", "µm²", "K"]


def test_the_summary_states_the_units_of_activated_creep() -> None:
    tables = {
        "surface": {"kind": "spectral", "shape": [8, 8], "hurst": 0.8, "roll_off": 8.0, "cutoff": 2.0}
        | {"rms_height": 0.1, "spacing": [1.0], "unit": "um"},
        "solid": {"kind": "half_space", "modulus": "4 GPa", "creep": "eyring", "temperature": "25 degC"}
        | {"creep_energy": "100 kJ/mol", "creep_volume": "2 nm^3", "creep_prefactor": "1 m/s"},
        "contact": {"pressure": "20 MPa"},
    }
    config = config_from(tables, {}, None)
    surface = asp.surfaces.Surface(ROUGH * 1e-7, unit="m", pixel_size=(1e-6, 1e-6), length_unit="m")
    contact = asp.press(surface, asp.solids.half_space(modulus=4e9), pressure=2e7)
    said = _solid(config, asp.age(contact, [1.0]).dataset)
    assert "modulus = 4 GPa" in said
    assert "creep_energy = 1.036 eV, creep_volume = 2 nm^3, creep_prefactor = 1 m/s" in said
    assert "temperature = 298.1 K" in said


def test_the_shade_of_a_slide_is_explained_and_friction_that_does_not_change_is_flat() -> None:
    contact = asp.press(ROUGH, asp.solids.spring_lattice(k0=1.0, k1=3.0, R=0.0), load=80.0)
    series = asp.age(contact, [2.0], protocol=[P.Slide(distance=2.0, velocity=1.0)]).dataset
    axes = asp.figures.sliding_figure(asp.friction.add_friction(series, 0.5)).axes[0]
    assert any("shade" in text for text in axes.get_legend_handles_labels()[1])
    assert axes.get_ylim()[0] == 0.0
    assert axes.get_ylim()[1] > series["area"].values.max() * 0.5 / 80.0
