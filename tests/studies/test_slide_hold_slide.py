"""What the study of slide-hold-slide reads off a history, against steps by hand and an exact decay."""

from dataclasses import replace

import numpy as np
import pytest

import asperity as asp
from asperity.studies.slide_hold_slide import (
    HOLDS,
    VELOCITIES,
    Records,
    before_shifts,
    correlation_length,
    slip_of_memory,
)

P = asp.protocols


def test_areas_before_shifts_are_those_of_a_slide_by_hand():
    heights = asp.surfaces.spectral((16, 16), hurst=0.8, roll_off=8.0, cutoff=4.0, rms_height=1.0, seed=1)
    contact = asp.press(heights, asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0), load=20.0)
    protocol: list[P.Slide | P.Hold] = [P.Slide(3.0, velocity=0.5), P.Hold(10.0), P.Slide(2.0, velocity=0.5)]
    dataset = asp.age(contact, [1.0], protocol=protocol).dataset
    areas, now = [], contact
    for leg in protocol:
        if isinstance(leg, P.Hold):
            now = asp.age(now, [leg.duration]).final
            continue
        for _ in range(round(leg.distance)):
            now = asp.age(asp.slide(now, shift=(0, 1)), [2.0]).final
            areas.append(now.area)
    found = [*before_shifts(dataset, 0), *before_shifts(dataset, 2)]
    np.testing.assert_allclose(found, areas, atol=1)


def test_an_exponential_decay_has_the_slip_of_its_exponent():
    for slip in (0.5, 2.0, 5.0):
        assert abs(slip_of_memory(3.0 * np.exp(-np.arange(200) / slip)) - slip) < 1e-6


def test_the_correlation_length_is_in_proportion_to_the_waves():
    one, two = correlation_length(16.0, 4.0), correlation_length(32.0, 8.0)
    assert two / one == pytest.approx(2.0, rel=0.02)
    assert one < correlation_length(32.0, 4.0) < two


@pytest.mark.parametrize("law", ["aging", "slip"])
def test_a_known_law_is_found_in_its_records(law):
    """b = 0.04 and D_c = 3, the same from rests and from steps, where the records follow the aging law."""
    known = asp.friction.RateAndState(law=law, a=0.0, b=0.04, D_c=3.0, mu_0=1.0, V_0=1.0)
    again = P.Slide(60.0, velocity=1.0)
    protocol: list[P.Slide | P.Hold] = [again, *(leg for time in HOLDS for leg in (P.Hold(time), again))]
    protocol += [P.Slide(30.0, velocity=velocity) for velocity in VELOCITIES]
    made = [
        asp.friction.synthetic_record(
            protocol, known, per_leg=20, noise=1e-3, seed=seed, strength_at_rest=True, si=False
        )
        for seed in range(3)
    ]
    found = Records("half_space", 0.02, [replace(one, a=0.0) for one in made], np.ones((3, 4)))
    rows = {(row["events"], row["law"]): row for row in found.laws()}
    for events in (
        ("holds", "steps", "all") if law == "aging" else ("steps",)
    ):  # the slip law: no aging at rest
        row = rows[events, law]
        assert row["b"] == pytest.approx(0.04, rel=0.05)
        assert row["D_c"] == pytest.approx(3.0, rel=0.1)
    if law == "aging":
        assert found.ratio_of_b().value == pytest.approx(1.0, abs=0.05)
        assert found.explained().value > 0.98
        np.testing.assert_allclose(found.rest[:, -1], 1 + 0.04 * np.log(1 + HOLDS[-1] / 3), atol=0.01)
    else:
        assert found.explained().value < 0.95
