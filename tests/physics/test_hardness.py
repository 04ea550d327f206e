"""Pressures with an upper bound: against sweeps over dense matrices, closed forms and explicit steps."""

import numpy as np
import pytest

import asperity as asp
from asperity.solids import Eyring, half_space, spring_lattice
from tests.continua import love
from tests.independent import laplacian
from tests.reference import settle
from tests.refusals import each_refuses, refuses
from tests.surfaces import uncorrelated

P = asp.protocols


SITES = np.eye(64).reshape(64, 8, 8)


def swept(S, contact, bound):
    """u with 0 <= S (u - X) <= bound: site by site, the other sites as they are, until none moves."""
    obstacle = (contact.heights + contact.permanent_indentation).ravel()
    b, u, diagonal = S.sum(axis=1) * contact.separation, obstacle.copy(), np.diag(S).copy()
    scale = np.abs(obstacle).max()
    for _ in range(100_000):
        before = u.copy()
        for i in range(u.size):
            free = u[i] - (S[i] @ u - b[i]) / diagonal[i]
            u[i] = min(max(obstacle[i], free), free + bound / diagonal[i])
        if np.abs(u - before).max() < 1e-13 * scale:
            return u
    raise AssertionError


@pytest.mark.parametrize("hardness", [0.5, 2.0])
def test_sites_of_the_lattice_are_those_of_sweeps(hardness):
    rough, (k0, k1) = uncorrelated(8), (1.0, 3.0)
    contact = asp.press(rough, spring_lattice(k0=k0, k1=k1, hardness=hardness), load=20.0)
    S = np.array([(k1 * one - k0 * laplacian(one)).ravel() for one in SITES])
    u = swept(S, contact, hardness)
    left = contact.residual * contact.residual_scale / k1  # rows of S sum to k1, and off its diagonal S <= 0
    assert np.abs(contact.u.ravel() - u).max() < left < 1e-9
    assert np.abs(contact.permanent_indentation.ravel() - np.maximum(rough.ravel() - u, 0)).max() < left
    assert contact.yielding_area == np.count_nonzero(u < rough.ravel()) > 0
    assert contact.load == pytest.approx(20.0, rel=1e-9)
    held = asp.press(rough, contact.solid, separation=contact.separation)
    np.testing.assert_allclose(held.u, contact.u, atol=1e-10)


def test_sites_of_a_half_space_are_those_of_sweeps():
    solid = half_space(modulus=2.0, apparatus=0.3, hardness=0.25)
    contact = asp.press(asp.surfaces.Surface(uncorrelated(8)), solid, load=5.0)
    spectrum = solid.on(contact.lattice).permanent
    S = np.array([contact.lattice.apply(spectrum, one).ravel() for one in SITES])
    assert np.abs(contact.u.ravel() - swept(S, contact, 0.25)).max() < 1e-9
    assert 0 < contact.yielding_area < contact.area


def test_sites_of_a_body_that_ends_are_those_of_sweeps():
    surface = asp.surfaces.Surface(0.3 * uncorrelated(8), pixel_size=(1.0, 0.7), edges="free")
    contact = asp.press(surface, half_space(modulus=2.0, hardness=0.02 / 0.7), load=0.2)
    u = swept(np.linalg.inv(love((8, 8), (1.0, 0.7)) / 0.7 / 2.0), contact, 0.02)
    assert np.abs(contact.u.ravel() - u).max() < 1e-6
    assert contact.load == pytest.approx(0.2, rel=1e-9)
    assert 3 < contact.yielding_area < contact.area


@pytest.mark.parametrize(("load", "hardness"), [(100.0, 0.2), (1000.0, 0.2), (1.0, 0.8), (1.0, 1.2)])
def test_a_paraboloid_yields_from_its_largest_pressure_on_and_at_last_all_but_its_rim(load, hardness):
    x = np.arange(128.0) - 64
    rough, modulus = -(x**2 + x[:, None] ** 2) / (2 * 4000.0), 1000.0
    p0 = (6 * load * modulus**2 / (np.pi**3 * 4000.0**2)) ** (1 / 3)
    if load == 1.0:
        hardness *= p0
    contact = asp.press(rough, half_space(modulus=modulus, hardness=hardness), load=load)
    assert (contact.yielding_area > 0) == (hardness < p0) == bool(contact.permanent_indentation.any())
    assert contact.largest_pressure <= hardness * (1 + 1e-12)
    if hardness < p0 / 2:
        rim = 2 * np.sqrt(np.pi * contact.area)
        assert load / hardness <= contact.area <= load / hardness + 2 * rim


def test_a_bound_that_nothing_reaches_changes_no_bit():
    rough, times = uncorrelated(16), [0.1, 1.0]
    with_bound, without = (half_space(modulus=2.0, flow=(0.5, 1.0), hardness=h) for h in (1e9, None))
    a, b = (asp.press(rough, solid, load=10.0) for solid in (with_bound, without))
    for name in ("u", "force", "anchors", "heights"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name))
    np.testing.assert_array_equal(asp.age(a, times).final.u, asp.age(b, times).final.u)


@pytest.mark.parametrize(
    "solid",
    [spring_lattice(k0=1.0, k1=3.0, hardness=1.0), half_space(modulus=2.0, hardness=0.5)],
    ids=["lattice", "half-space"],
)
def test_what_has_yielded_stays_and_answers_elastically(solid):
    first = asp.press(uncorrelated(16), solid, load=60.0)
    less = asp.press(first, load=20.0)
    again = asp.press(less, load=60.0)
    more = asp.press(again, load=80.0)
    assert first.yielding_area > 0 == less.yielding_area
    np.testing.assert_array_equal(less.permanent_indentation, first.permanent_indentation)
    assert again.area == first.area
    np.testing.assert_allclose(again.u, first.u, atol=1e-9)
    np.testing.assert_allclose(again.permanent_indentation, first.permanent_indentation, atol=1e-9)
    assert (more.permanent_indentation >= again.permanent_indentation).all()
    assert more.permanent_indentation.max() > again.permanent_indentation.max()
    rough = uncorrelated(16)
    np.testing.assert_allclose(more.heights + more.permanent_indentation, rough, atol=1e-12)
    moved = asp.slide(more, [3, 5])
    expected = np.roll(more.permanent_indentation, (3, 5), (0, 1))
    assert (moved.permanent_indentation >= expected).all()


def explicit(rough, hardness, X, steps, dt, *, V, law):
    """Explicit steps of the lattice at a held or moving body; the obstacle is lowered at each of them."""
    k0, k1, viscous = 1.0, 3.0, 0.4
    u0, obstacle = np.full(rough.shape, X), rough.copy()
    u = np.maximum(u0, obstacle)
    for _ in range(steps + 1):
        u = settle(u, u0, obstacle, k0=k0, k1=k1, accuracy=1e-10, most=hardness)
        obstacle, state = np.minimum(obstacle, u), (u, u0, obstacle)
        s = k1 * (u - u0)
        u0 = u0 + dt * (viscous * s + (law.velocity(s)[0] if law else 0.0) + V)
    return state


@pytest.mark.parametrize("law", [None, Eyring(rate=0.05, stress=0.5)], ids=["linear", "eyring"])
def test_creep_is_what_explicit_steps_find(law):
    rough, hardness = np.array(uncorrelated(8)), 1.0
    solid = spring_lattice(k0=1.0, k1=3.0, R=0.0, R_viscous=0.4, creep=law, hardness=hardness)
    X, fall = float(rough.max()) - 0.5, -1.0
    contact = asp.press(rough, solid, separation=X)
    legs = [P.Ramp(0.5, separation=X + 0.5 * fall)]
    history = asp.age(contact, [0.5], protocol=legs, rtol=1e-5)
    coarse, fine = (explicit(rough, hardness, X, n, 0.5 / n, V=fall, law=law) for n in (50, 100))
    u, u0, obstacle = (2 * b - a for a, b in zip(coarse, fine, strict=True))  # steps of first order
    end = history.final
    scale = np.ptp(u)
    assert np.abs(end.u - u).max() < 1e-3 * scale
    assert np.abs(end.u0 - u0).max() < 1e-3 * scale
    assert np.abs(end.heights - obstacle).max() < 1e-3 * scale
    assert end.permanent_indentation.max() > 1.5 * contact.permanent_indentation.max() > 0


def test_loads_beyond_the_hardness_and_parts_of_sites_are_refused():
    rough, solid = uncorrelated(8), spring_lattice(k0=1.0, k1=3.0, hardness=1.0)
    contact = asp.press(rough, solid, load=10.0)
    with refuses("load", "63.99") as refused:
        asp.press(rough, solid, load=63.99)
    error = refused.value
    assert isinstance(error, asp.errors.InputError)
    most = float(error.expected.removeprefix("at most ").split(",")[0])
    assert most < float(error.got)
    assert asp.press(rough, solid, load=0.9999 * most).load == pytest.approx(0.9999 * most)
    in_pa, slide = solid.with_hardness("1 GPa"), P.Slide(2.0, velocity=1.0, substeps=2)
    each_refuses(
        ("load", "64", lambda: asp.press(rough, solid, load=64.0)),
        ("load", "96", lambda: asp.age(contact, [1.0], protocol=[P.Hold(1.0), P.Step(pressure=1.5)])),
        ("slide", "0, 1/2", asp.slide, contact, 0.5),
        ("slide", "0, 1/2", lambda: asp.age(contact, [1.0], protocol=slide)),
        ("hardness", "0.0", lambda: half_space(modulus=2.0, hardness=0.0)),
        ("units", "'1 GPa'", lambda: asp.press(rough, in_pa, load=10.0)),
    )


def yielding_by_a_law(rough, R):
    solid = spring_lattice(k0=1.0, k1=3.0, R=R, creep=Eyring(rate=1e-3, stress=0.3), hardness=0.5)
    contact = asp.press(rough / rough.std(), solid, load=0.2 * rough.size)
    return contact, asp.age(contact, np.geomspace(1e-3, 1e4, 8)).dataset


@pytest.mark.parametrize("R", [0.0, 0.5])
def test_what_yields_by_a_local_law_comes_back_to_the_surface(R):
    contact, data = yielding_by_a_law(np.random.default_rng(2).normal(size=(16, 16)), R)
    assert (np.diff(data["area"]) >= 0).all()
    assert data["area"].values[-1] == asp.relax(contact).area


def test_crowded_sites_that_yield_by_a_local_law_take_few_steps():
    contact, data = yielding_by_a_law(asp.surfaces.self_affine(32, hurst=0.8, delta=0.1, seed=1), 0.0)
    assert data["steps"].sum() < 100
    assert data["area"].values[-1] > 1.4 * contact.area


LAW = Eyring(rate=0.1, stress=0.5)
YIELDING = {
    "springs": spring_lattice(k0=1.0, k1=3.0, R=0.1, creep=LAW, hardness=1.0),
    "springs apart": spring_lattice(k0=0.0, k1=3.0, R=0.1, creep=LAW, hardness=1.0),
    "half-space": half_space(modulus=1.0, creep=LAW, hardness=0.3),
    "half-space, permanent": half_space(modulus=1.0, creep=LAW, permanent=0.3, hardness=0.3),
}


@pytest.mark.parametrize("name", YIELDING)
def test_a_load_little_above_that_of_yielding_sites_is_borne_by_one_more(name):
    """One site bears the rest, however little, while a ramp goes by."""
    solid = YIELDING[name]
    for seed in range(4):
        rough = np.random.default_rng(seed).normal(size=(8, 10))
        for count in (1.0001, 2.002, 3.05):
            load = count * solid.hardness
            legs = [P.Ramp(1.0, load=load), P.Hold(2.0)]
            contact = asp.press(rough, solid, load=0.0)
            history = asp.age(contact, [0.5, 1.0, 3.0], protocol=legs, rtol=0.02)
            assert history.final.load == pytest.approx(load, rel=1e-9)
            assert history.final.force.max() <= solid.hardness * (1 + 1e-8)
            assert (history.dataset["area"][2:] > int(count)).all()
