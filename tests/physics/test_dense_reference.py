"""Solids of one and several branches, separable or not, against dense matrices and LSODA."""

import numpy as np
import pytest

import asperity as asp
from asperity.solids import CreepBranch, LaplacianSpectrum, Solid
from tests.continua import pressed
from tests.dense_reference import Dense
from tests.surfaces import correlated

P = asp.protocols
THREE = [(0.3, 0.1), (0.25, 1.0), (0.35, 20.0)]
SPACING = (1.5, 0.5)


def half(q, _):
    return 2.0 * q / 2


def maxwell(law, branches):
    """Permanent stiffness and branches of a generalized Maxwell solid."""

    def part(share, time):
        def relaxing(q, lam):
            stiffness = share * law(q, lam)
            return np.divide(1 / time, stiffness, out=np.zeros_like(stiffness), where=stiffness > 0)

        return lambda q, lam: share * law(q, lam), relaxing

    rest = 1 - sum(share for share, _ in branches)
    return lambda q, lam: rest * law(q, lam), [part(*branch) for branch in branches]


def two_springs():
    branches = (
        CreepBranch(LaplacianSpectrum(uniform=2.0), LaplacianSpectrum(laplacian=1.0, uniform=0.1)),
        CreepBranch(LaplacianSpectrum(laplacian=0.5, uniform=1.0), LaplacianSpectrum(uniform=0.05)),
    )
    return Solid(permanent=LaplacianSpectrum(laplacian=1.0, uniform=0.2), branches=branches)


def slab(q, lam):
    """A sliding layer of thickness 2: E* q (sinh 2x + 2x) / (2 (cosh 2x - 1)), and E*/t at q = 0."""
    x = 2.0 * np.maximum(q, 1e-30)
    found = 2.0 * q * (np.sinh(2 * x) + 2 * x) / (2 * np.maximum(np.cosh(2 * x) - 1, 1e-300))
    return np.where(q > 0, found, 1.0)


SOLIDS = {
    "half-space": (asp.solids.half_space(modulus=2.0, branches=THREE), *maxwell(half, THREE), SPACING, 3.0),
    "layer": (
        asp.solids.layer(modulus=2.0, poisson=0.3, thickness=2.0, branches=THREE[1:], bonded=False),
        *maxwell(slab, THREE[1:]),
        SPACING,
        3.0,
    ),
    "diffusion": (
        asp.solids.half_space(modulus=2.0, flow=(0.7, 1.0)),
        lambda q, _: 0 * q,
        [(half, lambda q, _: 0.7 * q)],
        SPACING,
        3.0,
    ),
    "springs": (
        two_springs(),
        lambda _, lam: lam + 0.2,
        [
            (lambda _q, _lam: 2.0, lambda _, lam: lam + 0.1),
            (lambda _, lam: 0.5 * lam + 1, lambda _q, _lam: 0.05),
        ],
        (1.0, 1.0),
        20.0,
    ),
}
CHANGES = [
    (0.5, 1.0, 1.0),
    (1.0, 1.0, 2.0),
    (0.0, 2.0, 0.4),
    (1.0, 0.4, 0.4),
    (0.5, 0.4, 1.5),
    (0.5, 1.5, 0.5),
]
"""Duration of each leg, and the load at its beginning and end: hold, ramp, step, hold, and a cycle."""


@pytest.mark.parametrize("name", SOLIDS)
def test_loads_are_followed_as_dense_matrices_follow_them(name):
    solid, permanent, branches, spacing, unit = SOLIDS[name]
    heights = correlated(8, hurst=0.8)
    dense = Dense.of_laws(heights, permanent, branches, spacing)
    v, expected, protocol = np.zeros((len(branches), 64)), [], []
    for duration, *ends in CHANGES:
        begin, end = unit * ends[0], unit * ends[1]
        protocol.append(P.Ramp(duration, load=end) if duration else P.Step(load=end))
        if duration:
            v = dense.creep(v, duration, lambda t, b=begin, e=end, d=duration: b + (e - b) * t / d)
        y, X, _ = dense.contact(v, end)
        expected.append((y, v, X, dense.touching.copy()))
    frames: list[asp.Frame] = []
    contact = pressed(heights, solid, load=unit, spacing=spacing)
    asp.age(contact, [3.5], protocol=protocol, rtol=5e-4, progress=frames.append)
    for frame, (y, v, X, touching) in zip(frames[1:], expected, strict=True):
        state = frame.contact
        np.testing.assert_array_equal(state.in_contact.ravel(), touching)
        allowed = 5e-4 * contact.u.std()
        assert np.sqrt(np.mean((state.u.ravel() - y - X) ** 2)) < allowed
        assert state.separation == pytest.approx(X, abs=allowed)
        anchors = state.anchors.reshape(v.shape) - X - v
        if not dense.hangs:  # there the means of anchors mean nothing
            anchors -= anchors.mean(axis=1, keepdims=True)
        assert np.sqrt(np.mean(anchors**2)) < allowed
        assert state.energy == pytest.approx(dense.energy(y, v), rel=1e-3)


def machine(relative):
    """A half-space pressed through a spring, relative to the stiffness of its contacts under a load of 3."""
    free = pressed(correlated(8, hurst=0.8), SOLIDS["half-space"][0], load=3.0, spacing=SPACING)
    spring = relative * free.normal_stiffness
    permanent, branches = maxwell(half, THREE)
    solid = asp.solids.half_space(modulus=2.0, branches=THREE, apparatus=spring)
    area = 64 * np.prod(SPACING)
    return solid, lambda q, lam: permanent(q, lam) + (q == 0) * spring / area, branches, SPACING, 3.0


@pytest.mark.parametrize("case", [SOLIDS["layer"], SOLIDS["springs"], *map(machine, (0.1, 1.0, 10.0))])
def test_positions_are_followed_as_dense_matrices_follow_them(case):
    solid, permanent, branches, spacing, unit = case
    heights = correlated(8, hurst=0.8)
    dense = Dense.of_laws(heights, permanent, branches, spacing)
    contact = pressed(heights, solid, load=unit, spacing=spacing)
    _, start, _ = dense.contact(np.zeros((len(branches), 64)), unit)
    assert contact.separation == pytest.approx(start, abs=1e-8)
    if "apparatus" in solid.parameters:
        free = pressed(heights, SOLIDS["half-space"][0], load=unit, spacing=spacing)
        series = 1 / (1 / solid.parameters["apparatus"] + 1 / free.normal_stiffness)
        assert contact.normal_stiffness == pytest.approx(series, rel=1e-8)
    v = dense.creep(np.zeros((len(branches), 64)), 1.0, position_at=lambda _: start)
    loads = [dense.contact(v, position=start)[2].sum()]
    v = dense.creep(v, 1.0, position_at=lambda t: start - 0.4 * t)
    y, X, r = dense.contact(v, position=start - 0.4)
    protocol = [P.Hold(1.0, hold="separation"), P.Ramp(1.0, separation=start - 0.4)]
    history = asp.age(contact, [2.0], protocol=protocol, rtol=5e-4)
    final = history.final
    np.testing.assert_array_equal(final.in_contact.ravel(), dense.touching)
    assert np.abs(final.u.ravel() - y - X).max() < 5e-4 * contact.u.std()
    np.testing.assert_allclose(history["load"][1:], [*loads, r.sum()], rtol=5e-4)
    assert final.separation == pytest.approx(X, abs=1e-12)


@pytest.mark.parametrize("pressure", [1e-4, 1e-3, 0.1])
def test_a_rigid_machine_keeps_contacts_of_a_separable_solid_and_the_force_is_its_modulus(pressure):
    heights, times = correlated(32, hurst=0.8), np.array([0.01, 0.1, 1.0, 10.0, 100.0])
    solid = asp.solids.half_space(modulus=2.0, branches=THREE, apparatus=np.inf)
    load = pressure * heights.size
    contact = asp.press(heights, solid, load=load)
    free = asp.press(heights, asp.solids.half_space(modulus=2.0), load=load)
    np.testing.assert_array_equal(contact.in_contact, free.in_contact)
    assert contact.separation == pytest.approx(contact.u.mean(), abs=1e-4 * contact.u.std())
    history = asp.age(contact, times, hold="separation", rtol=2e-4, fields_at=times)
    modulus = 1 - sum(share * -np.expm1(-times / time) for share, time in THREE)
    np.testing.assert_allclose(history.dataset["load"][1:] / load, modulus, atol=3e-4)
    assert (history.dataset["in_contact"] == contact.in_contact).all()
    assert asp.relax(contact, hold="separation").load == pytest.approx(load * 0.1, rel=1e-3)


SELF_AFFINE = asp.surfaces.self_affine(32, hurst=0.8, delta=0.1, seed=1)
NEAR_HALF = (0.5, 0.4999999, 0.49999999999)


def layer_on_its_base(poisson, thickness):
    """K of a bonded layer by its formula (K. L. Johnson, section 5.8), without its mean."""

    def law(q, _):
        x = np.where(q > 0, q, 1.0) * thickness
        sinh, cosh = np.sinh(2 * x), np.cosh(2 * x)
        nu = poisson
        yields = ((3 - 4 * nu) * sinh - 2 * x) / ((3 - 4 * nu) * cosh + 2 * x**2 + 5 - 12 * nu + 8 * nu**2)
        return np.where(q > 0, x / thickness / (2 * yields), 0.0)

    return law


HELD = [
    *(
        (asp.solids.layer(modulus=1.0, poisson=nu, thickness=0.2), layer_on_its_base(nu, 0.2))
        for nu in NEAR_HALF
    ),
    *((asp.solids.half_space(modulus=1.0, apparatus=stiff), lambda q, _: q / 2) for stiff in (np.inf, 1e15)),
]


@pytest.mark.parametrize("load", [0.01, 102.4])
@pytest.mark.parametrize(("solid", "law"), HELD)
def test_a_mean_held_rigidly_is_solved_under_any_load(solid, law, load):
    """It takes no digits from the rest."""
    heights = SELF_AFFINE / SELF_AFFINE.std()
    contact = asp.press(heights, solid, load=load)
    dense = Dense.of_laws(heights, law, [], (1.0, 1.0))  # the mean of its surface is free under a load
    y, mean, force = dense.contact([], load=load)
    np.testing.assert_array_equal(contact.in_contact.ravel(), dense.touching)
    np.testing.assert_allclose(contact.force.ravel(), np.where(dense.touching, force, 0.0), atol=1e-8 * load)
    np.testing.assert_allclose(contact.u.ravel(), y + mean, atol=1e-9)
    assert contact.load == pytest.approx(load, rel=1e-9)
    # Held where the load has put it, the rigid body bears the same: as far as its place has digits.
    held = asp.press(heights, solid, separation=contact.separation)
    np.testing.assert_array_equal(held.in_contact, contact.in_contact)
    assert held.load == pytest.approx(load, rel=1e-5)
