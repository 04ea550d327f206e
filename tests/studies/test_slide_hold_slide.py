"""What the study of slide-hold-slide reads off a history, against steps by hand and an exact decay."""

import numpy as np

import asperity as asp
from asperity.studies.slide_hold_slide import before_shifts, slip_of_memory

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
