"""t -> infinity: the direct limit against very long runs, and what has no limit."""

import numpy as np
import pytest

from asperity import age, press, relax
from asperity.solids import Solid, spring_lattice
from tests.refusals import refuses
from tests.surfaces import uncorrelated

ROUGH = uncorrelated(24)
LATE = [1e2, 1e6]


@pytest.mark.parametrize(("k0", "R_viscous"), [(0.0, 0.3), (1.0, 0.0), (1.0, 0.3)])
def test_a_long_run_under_load_ends_at_the_limit(k0, R_viscous):
    contact = press(ROUGH, spring_lattice(k0=k0, k1=3.0, R_viscous=R_viscous), load=30.0)
    limit, final = relax(contact), age(contact, LATE, rtol=5e-4).final
    np.testing.assert_array_equal(limit.in_contact, final.in_contact)
    np.testing.assert_allclose(limit.u, final.u, atol=1e-6)
    np.testing.assert_allclose(limit.u0, final.u0, atol=1e-6)
    assert limit.load == pytest.approx(30.0, rel=1e-10)


@pytest.mark.parametrize("separation", [1.0, 5.0])
def test_a_long_run_at_constant_separation_ends_at_the_limit(separation):
    contact = press(ROUGH, spring_lattice(k0=1.0, k1=3.0), separation=separation)
    limit, final = relax(contact), age(contact, LATE, rtol=2e-5).final
    np.testing.assert_array_equal(limit.in_contact, final.in_contact)
    np.testing.assert_allclose(limit.u0, final.u0, atol=1e-6)
    assert [limit.separation, final.separation] == pytest.approx([separation] * 2, abs=1e-12)
    assert limit.load == pytest.approx(final.load, rel=1e-6)


def test_viscous_creep_at_constant_separation_lets_the_load_die_out():
    contact = press(ROUGH, spring_lattice(k0=1.0, k1=3.0, R_viscous=0.3), separation=1.0)
    history = age(contact, LATE, rtol=5e-4)
    limit = relax(contact)
    assert limit.load == 0
    assert limit.area == 1
    np.testing.assert_array_equal(limit.u, ROUGH.max())
    assert history.dataset["load"].values[-1] == pytest.approx(0.0, abs=1e-9)
    # Once the last contact has parted, nothing drives the shape any more: what the steps erred by then stays.
    np.testing.assert_allclose(history.final.u0, limit.u0, atol=0.1 * 5e-4)
    assert (history.dataset["approach"].values == 0).all()


def test_viscous_creep_under_load_has_a_limit_of_shape_but_the_body_sinks_without_end():
    R_viscous, load = 0.3, 30.0
    viscous = press(ROUGH, spring_lattice(k0=1.0, k1=3.0, R_viscous=R_viscous), load=load)
    conserving = press(ROUGH, spring_lattice(k0=1.0, k1=3.0), load=load)
    np.testing.assert_allclose(relax(viscous).u, relax(conserving).u, atol=1e-9)
    data = age(viscous, [1e5, 2e5]).dataset
    sinking = np.diff(data["approach"].values[1:])[0] / 1e5
    assert sinking == pytest.approx(R_viscous * load / ROUGH.size, rel=1e-6)
    assert data["separation"].values[-1] == pytest.approx(relax(viscous).separation, abs=1e-6)
    # The mean of u0 cannot fall without end: the surface rests on the heights.
    assert data["separation"].values[-1] > ROUGH.mean() - load / (3.0 * ROUGH.size)


@pytest.mark.parametrize("k0", [0.0, 1.0])
@pytest.mark.parametrize("above", [0.01, 40.0])
def test_a_body_that_hangs_free_stays_as_it_is(k0, above):
    solid = spring_lattice(k0=k0, k1=3.0, R_viscous=0.1)
    contact = press(ROUGH, solid, separation=ROUGH.max() + above)
    history = age(contact, LATE)
    for state in (contact, history.final, relax(contact)):
        assert state.area == 0
        assert np.ptp(state.u) <= 1e-13 * np.abs(contact.u).max()
        np.testing.assert_allclose(state.u0, contact.u0, rtol=1e-13)
    assert history.dataset["rejected"].sum() == 0


def test_independent_springs_let_go_one_by_one_as_the_load_dies_out():
    # Rounding decides here whether a contact pushes or pulls; the solver must not go round in circles.
    spike = np.full((16, 16), -5.0)
    spike[3, 4] = spike[9, 9] = 0.7
    solid = spring_lattice(k0=0.0, k1=3.0, R=0.0, R_viscous=1.0)
    history = age(press(spike, solid, separation=0.0), np.array([1.0, 1e2, 1e4, 1e6]) / 3)
    assert history.dataset["load"].values[-1] == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(history.final.u0[3, 4], 0.7, atol=1e-3)  # within rtol of the stretch


def test_limits_that_depend_on_the_path_or_on_soft_waves_are_refused():
    with refuses("contact"):
        relax(press(ROUGH, spring_lattice(k0=0.0, k1=3.0), separation=1.0))
    branches = spring_lattice(k0=1.0, k1=3.0).branches
    solid = Solid(lambda lattice: np.where(lattice.lam > 4, lattice.lam, 0.0), branches)
    with refuses("solid"):
        relax(press(ROUGH, solid, load=10.0))


def test_without_mobility_nothing_creeps():
    contact = press(ROUGH, spring_lattice(k0=1.0, k1=3.0, R=0.0), load=30.0)
    np.testing.assert_allclose(age(contact, [1.0, 1e6]).final.u0, contact.u0, atol=1e-12)
    np.testing.assert_array_equal(relax(contact).in_contact, contact.in_contact)


def test_an_aged_contact_relaxes_to_the_same_limit():
    contact = press(ROUGH, spring_lattice(k0=1.0, k1=3.0), load=30.0)
    np.testing.assert_allclose(relax(age(contact, [3.0]).final).u, relax(contact).u, atol=1e-8)


@pytest.mark.parametrize("seed", [1, 3])
def test_smooth_heights_on_nearly_independent_springs_relax_to_full_contact(seed):
    """Neighbors alone resist at the end: on sites that all touch, their forces have no sum."""
    squares = sum(np.meshgrid(np.fft.fftfreq(35) ** 2, np.fft.fftfreq(33) ** 2, indexing="ij"))
    white = np.fft.fft2(np.random.default_rng(seed).normal(size=(35, 33)))
    heights = np.fft.ifft2(white / (1e-3 + squares)).real
    heights /= heights.std()
    contact = press(heights, spring_lattice(k0=5.7e-7, k1=82.0), load=0.69 * heights.size)
    relaxed = relax(contact)
    assert contact.area < relaxed.area == heights.size
    assert relaxed.load == pytest.approx(contact.load, rel=1e-9)
