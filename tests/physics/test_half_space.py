"""An elastic and a viscoelastic half-space through the public functions."""

import numpy as np
import pytest

import asperity as asp
from tests.refusals import refuses
from tests.surfaces import correlated, uncorrelated


def forces(heights, u, modulus, load):
    """E*|q|/2 applied by numpy's complex transform, and the load spread evenly: no code of the package."""
    ny, nx = heights.shape
    q = 2 * np.pi * np.hypot(np.fft.fftfreq(ny)[:, None], np.fft.fftfreq(nx)[None, :])
    return np.fft.ifft2(modulus * q / 2 * np.fft.fft2(u)).real + load / heights.size


@pytest.mark.parametrize(
    "heights", [uncorrelated(64), correlated(128, hurst=0.8)], ids=["white", "self-affine"]
)
@pytest.mark.parametrize("pressure", [0.002, 0.1])
def test_contact_is_in_equilibrium_by_an_independent_operator(heights, pressure):
    load = pressure * heights.size
    contact = asp.press(heights, asp.solids.half_space(modulus=2.0), load=load)
    force = forces(heights, contact.u, 2.0, load)
    touching = contact.u == heights
    mean = load / touching.sum()
    assert (contact.u >= heights).all()
    assert np.abs(force[~touching]).max() <= 1e-8 * mean
    assert force[touching].min() >= -1e-8 * mean
    np.testing.assert_array_equal(touching, contact.in_contact)
    assert contact.load == pytest.approx(load, rel=1e-8)
    assert contact.separation == pytest.approx(contact.u.mean(), rel=1e-9)


def test_a_zener_solid_goes_from_its_full_to_its_permanent_modulus():
    heights, load = correlated(64, hurst=0.8), 30.0
    solid = asp.solids.half_space(modulus=1.0, branches=[(0.6, 2.0)])
    start = asp.press(heights, solid, load=load)
    stiff, soft = (asp.press(heights, asp.solids.half_space(modulus=m), load=load) for m in (1.0, 0.4))
    np.testing.assert_array_equal(start.in_contact, stiff.in_contact)
    limit = asp.relax(start)
    np.testing.assert_array_equal(limit.in_contact, soft.in_contact)
    np.testing.assert_allclose(limit.u - limit.u.mean(), soft.u - soft.u.mean(), atol=1e-6)
    history = asp.age(start, [0.1, 1.0, 10.0, 200.0])
    area = history.dataset["area"].values
    assert (np.diff(area) >= 0).all()
    assert start.area < area[2] < limit.area
    assert area[-1] == pytest.approx(limit.area, rel=0.01)
    np.testing.assert_allclose(history.dataset["load"], load, rtol=1e-8)


def test_full_contact_relaxes_at_the_rate_of_the_solid():
    # In full contact u is given, and every mode of u - u0 decays with the relaxation time.
    heights = 1e-3 * uncorrelated(16)
    solid = asp.solids.half_space(modulus=1.0, branches=[(0.5, 3.0)])
    start = asp.press(heights, solid, load=10.0 * heights.size)
    assert start.area == heights.size
    later = asp.age(start, [2.0], rtol=1e-5).final
    stretch = [contact.u - contact.u0 for contact in (start, later)]
    np.testing.assert_allclose(
        stretch[1], np.exp(-2.0 / 3.0) * stretch[0], atol=1e-4 * np.abs(stretch[0]).max()
    )


@pytest.mark.parametrize("above", [1e-3, 3.0])
def test_heights_of_mean_zero_touch_everywhere_from_the_load_that_flattens_them_on(above):
    # The datum is then 0 but for rounding, beside which the last digit of the heights is large.
    heights = asp.surfaces.spectral((64, 64), rms_slope=0.1, seed=1)
    flattening = -forces(heights, heights, 1.0, 0.0).min()
    contact = asp.press(heights, asp.solids.half_space(modulus=1.0), pressure=flattening * (1 + above))
    assert contact.area == heights.size
    assert contact.load == pytest.approx(flattening * (1 + above) * heights.size, rel=1e-12)
    less = asp.press(heights, asp.solids.half_space(modulus=1.0), pressure=flattening * (1 - 1e-3))
    assert less.area < heights.size


def test_a_separation_cannot_be_held():
    with refuses("separation"):
        asp.press(uncorrelated(16), asp.solids.half_space(modulus=1.0), separation=1.0)
    contact = asp.press(uncorrelated(16), asp.solids.half_space(modulus=1.0), load=1.0)
    with refuses("separation"):
        asp.age(contact, [1.0], hold="separation")
