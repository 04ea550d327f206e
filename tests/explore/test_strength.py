"""The page has the friction of a strength that depends on velocity or age, as the dataset has it."""

from typing import Any

import numpy as np
import pytest

from asperity.app.config import config_from
from asperity.app.explore.scene import recorded
from asperity.app.runs import Progress, execute

HOLD_AND_SLIDE = [
    {"kind": "hold", "duration": 10.0},
    {"kind": "slide", "distance": 16e-6, "velocity": 1e-6},
    {"kind": "slide", "distance": 16e-6, "velocity": 1e-5},
]


@pytest.mark.parametrize(
    "law",
    [
        {},
        {"rate_coefficient": 0.05, "reference_velocity": 1e-8},
        {"growth": 0.05, "after": 1.0, "renewal": 1e-6},
    ],
)
def test_friction_of_a_recorded_history_is_that_of_its_dataset(law):
    tables: dict[str, Any] = {
        "surface": {"kind": "spectral", "shape": [32, 32], "rms_height": 1e-6, "spacing": 4e-6, "unit": "m"},
        "solid": {"kind": "half_space", "modulus": 3e9, "branches": [[0.3, 1.0]]},
        "contact": {"pressure": 1e7},
        "friction": {"shear_strength": 4e7, **law},
        "protocol": HOLD_AND_SLIDE,
    }
    outcome = execute(config_from(tables, {}, None), Progress())
    recording = recorded(outcome.dataset, outcome.config, job="", title="")
    assert recording.scene is not None
    rows = dict(zip(recording.scene["columns"], np.transpose(recording.rows), strict=True))
    strength = recording.scene["shear_strength"] * rows.get("relative_strength", 1.0)
    friction = strength * rows["contact_area_corrected"] / rows["load"]
    np.testing.assert_allclose(friction, outcome.dataset["friction"], rtol=1e-12)
