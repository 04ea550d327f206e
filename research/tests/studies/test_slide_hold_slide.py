"""What the study of slide-hold-slide reads off a history, against steps by hand and an exact decay."""

from dataclasses import replace

import numpy as np
import pytest

import asperity as asp
from asperity_research.studies.campaigns import Prepared
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.slide_hold_slide import HOLDS, VELOCITIES, Records, slip_of_memory
from asperity_research.studies.sliding import (
    Lines,
    before_shifts,
    correlation_length,
    line_campaigns,
    slip_to_one_over_e,
)
from research.tests.conftest import do_here

P = asp.protocols


def test_areas_before_shifts_are_those_of_a_slide_by_hand():
    heights = asp.surfaces.spectral((16, 16), hurst=0.8, roll_off=8.0, cutoff=4.0, rms_height=1.0, seed=1)
    now = asp.press(heights, asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0), load=20.0)
    protocol: list[P.Slide | P.Hold] = [P.Slide(3.0, velocity=0.5), P.Hold(10.0), P.Slide(2.0, velocity=0.5)]
    dataset = asp.age(now, [1.0], protocol=protocol).dataset
    areas = []
    for shifts, rest in ((3, 10.0), (2, 0.0)):
        for _ in range(shifts):
            now = asp.age(asp.slide(now, shift=(0, 1)), [2.0]).final
            areas.append(now.area)
        now = asp.age(now, [rest]).final if rest else now
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


def test_on_lines_the_slip_is_that_at_which_the_mean_excess_is_1_over_e():
    slips = np.arange(40.0)
    for decay in (2.0, 6.5):
        assert slip_to_one_over_e(3 * np.exp(-slips / decay)) == pytest.approx(decay, abs=0.05)
    assert np.isnan(slip_to_one_over_e(np.ones(5)))
    length, lines = np.array([10.0, 20.0, 40.0]), np.arange(1.0, 5.0)[:, np.newaxis]
    excess = tuple(lines * np.maximum(1 - slips / (3 * one**0.5), 0) for one in length)
    patch = tuple(one**2 * np.ones(4) for one in length)
    found = Lines("line_lattice", length, excess, patch=patch)
    assert found.of_length().value == pytest.approx(0.5, abs=0.01)
    assert found.of_patch().value == pytest.approx(0.25, abs=0.01)


def test_what_a_rest_adds_on_a_line_is_read_at_the_same_slips(tmp_path):
    """Two short lines from campaign to table: the excess at a slip of 0 is that of two histories by hand."""
    campaign = next(one for one in line_campaigns(2) if one.name == "line_lattice_64_16")
    tables = {**campaign.tables, "surface": {**campaign.tables["surface"], "shape": [256]}}
    tables["contact"] = {"load": 0.3 * 256}
    short = replace(campaign, tables=tables)
    plan = short.write(tmp_path / short.name)
    do_here([Prepared(short, plan, tmp_path / short.name)])
    found = Lines.of(Evidence(tmp_path), "line_lattice", ((64.0, 16.0),))
    assert found.excess[0].shape == (2, 1 + 24)
    heights = asp.surfaces.spectral((256,), hurst=0.8, roll_off=64.0, cutoff=16.0, rms_height=1.0, seed=0)
    contact = asp.press(heights, asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0), load=0.3 * 256)
    ends = []
    for rest in (1.0, 10.0):
        protocol: list[P.Slide | P.Hold] = [P.Slide(16.0, velocity=1.0), P.Hold(rest)]
        ends.append(asp.age(contact, [1.0], protocol=protocol, rtol=0.05).final.area)
    assert found.excess[0][0, 0] == pytest.approx(ends[1] - ends[0], abs=2)
