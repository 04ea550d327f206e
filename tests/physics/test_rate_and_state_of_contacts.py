"""Simulated contacts that slide, rest and change their velocity: the numbers of docs/rate_and_state.md."""

import dataclasses

import numpy as np
import pytest

import asperity as asp

F = asp.friction
SURFACES = range(6)


def records(shape, waves, shares, distance, rtol):
    """Slide-hold-slide and velocity steps on each surface."""
    solid = asp.solids.half_space(modulus=1.0, branches=[(shares, 10.0**n) for n in range(-1, 6)])
    protocols = (
        F.slide_hold_slide([10.0, 100.0, 1000.0], velocity=1.0, distance=distance),
        F.velocity_steps([1.0, 0.1, 1.0, 0.01, 1.0], distance=distance),
    )
    found: tuple[list[F.Record], list[F.Record]] = [], []
    for seed in SURFACES:
        rough = asp.surfaces.spectral(
            shape, hurst=0.8, roll_off=4 * waves, cutoff=waves, rms_height=1.0, seed=seed
        )
        contact = asp.press(rough, solid, load=0.02 * rough.size)
        for protocol, several in zip(protocols, found, strict=True):
            history = asp.age(contact, times=[distance], protocol=protocol, rtol=rtol)
            several.append(F.record_of(history, shear_strength=1.0))
    return found


def b_and_D_c(several):
    laws = F.compare_state_laws(several)
    assert laws.verdict == "aging"
    return [laws.estimates["aging"][name] for name in ("b", "D_c")]


@pytest.mark.slow
def test_on_surfaces_b_from_steps_is_above_b_from_holds():
    holds, steps = records((64, 64), 8.0, 0.05, 14.0, 1e-2)
    (b, D_c), (b_of_steps, D_c_of_steps) = b_and_D_c(holds), b_and_D_c(steps)
    assert [b.value, b_of_steps.value] == pytest.approx([0.151, 0.196], abs=0.002)
    assert [D_c.value, D_c_of_steps.value] == pytest.approx([0.72, 0.92], abs=0.02)
    ratios = [
        F.rate_and_state(two).b / F.rate_and_state(one).b for one, two in zip(holds, steps, strict=True)
    ]
    assert 1.25 < min(ratios) < np.mean(ratios) < max(ratios) < 1.38
    # Healing is no exact logarithm: the slope grows with the age.
    peaks = np.mean([F.hold_peaks(one).peak for one in holds], axis=0)
    assert np.diff(peaks) / np.log(10) == pytest.approx([0.16, 0.22], abs=0.01)


@pytest.mark.slow
def test_on_lines_where_slip_is_resolved_both_agree():
    holds, steps = (b_and_D_c(several) for several in records((512,), 32.0, 0.08, 24.0, 0.02))
    assert [holds[0].value, steps[0].value] == pytest.approx([0.81, 0.96], abs=0.01)
    assert [holds[1].value, steps[1].value] == pytest.approx([2.42, 2.56], abs=0.05)
    for one, other in zip(holds, steps, strict=True):
        assert abs(one.value - other.value) < np.hypot(one.high - one.low, other.high - other.low) / 2


@pytest.mark.slow
@pytest.mark.parametrize("waves", [32.0, 64.0])
def test_whole_sites_are_nearly_short_shifts_where_slip_is_resolved(waves):
    """Of the states before each shift, against eight shifts a site."""
    solid = asp.solids.half_space(modulus=1.0, branches=[(0.1, 10.0**n) for n in range(4)])
    protocol = [
        *F.slide_hold_slide([10.0, 100.0, 1000.0], velocity=1.0, distance=20.0),
        *F.velocity_steps([0.1, 1.0], distance=20.0),
    ]
    for seed in range(3):
        rough = asp.surfaces.spectral(
            (512,), hurst=0.8, roll_off=4 * waves, cutoff=waves, rms_height=1.0, seed=seed
        )
        contact = asp.press(rough, solid, load=160.0 / waves)
        fits = []
        for substeps in (1, 8):
            legs = [
                dataclasses.replace(leg, substeps=substeps) if isinstance(leg, asp.protocols.Slide) else leg
                for leg in protocol
            ]
            history = asp.age(contact, times=[10.0], protocol=legs, rtol=1e-3)
            fits.append(F.rate_and_state(F.record_of(history, shear_strength=1.0)))
        whole, short = fits
        assert short.D_c > 2.0
        # With time steps that no longer matter: 0.006 to 0.078, -0.016 to 0.041 and -0.0006 to 0.0061.
        assert -0.01 < whole.D_c / short.D_c - 1 < 0.085
        assert -0.025 < whole.b / short.b - 1 < 0.045
        assert -0.002 < whole.mu_0 / short.mu_0 - 1 < 0.0075
