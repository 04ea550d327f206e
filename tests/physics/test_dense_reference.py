"""Solids of one and several branches, separable or not, against dense matrices and LSODA."""

import numpy as np
import pytest
import scipy.linalg

import asperity as asp
from asperity.aging.field_steps import FieldSteps
from asperity.aging.tr_bdf2 import Aim
from asperity.contact import ActiveSet
from asperity.contact.problem import TOLERANCE
from asperity.contact.state import AnchorModes
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
    dense = Dense(heights, permanent, branches, spacing)
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


@pytest.mark.parametrize("name", ["layer", "springs"])
def test_positions_are_followed_as_dense_matrices_follow_them(name):
    solid, permanent, branches, spacing, unit = SOLIDS[name]
    heights = correlated(8, hurst=0.8)
    dense = Dense(heights, permanent, branches, spacing)
    contact = pressed(heights, solid, load=unit, spacing=spacing)
    start = contact.separation
    v = dense.creep(np.zeros((len(branches), 64)), 1.0, position_at=lambda _: start)
    v = dense.creep(v, 1.0, position_at=lambda t: start - 0.4 * t)
    y, X, r = dense.contact(v, position=start - 0.4)
    protocol = [P.Hold(1.0, hold="separation"), P.Ramp(1.0, separation=start - 0.4)]
    final = asp.age(contact, [2.0], protocol=protocol, rtol=5e-4).final
    np.testing.assert_array_equal(final.in_contact.ravel(), dense.touching)
    assert np.abs(final.u.ravel() - y - X).max() < 5e-4 * contact.u.std()
    assert final.load == pytest.approx(r.sum(), rel=5e-4)
    assert final.separation == pytest.approx(X, abs=1e-12)


@pytest.mark.parametrize("name", SOLIDS)
def test_equal_steps_of_several_branches_converge_at_second_order(name):
    # All contacts are spikes of nearly one height, which touch all the time: no event spoils the order.
    solid, permanent, branches, spacing, unit = SOLIDS[name]
    rng = np.random.default_rng(0)
    heights = np.full((8, 8), -50.0)
    heights.flat[rng.choice(64, 5, replace=False)] = rng.uniform(0.0, 0.05, 5)
    contact = pressed(heights, solid, load=unit, spacing=spacing)
    assert contact.area == 5
    dense, size = Dense(heights, permanent, branches, spacing), 64 * len(branches)

    def speed(state):
        v = state.reshape(-1, 64)
        y, _, _ = dense.contact(v, unit)
        return np.concatenate([rate @ (y - field) for rate, field in zip(dense.rate, v, strict=True)])

    # The rates are affine in v: a matrix, whose exponential has no error of time.
    constant = speed(np.zeros(size))
    affine = np.zeros((size + 1, size + 1))
    affine[:size, :size] = 1e3 * (np.array([speed(row) for row in 1e-3 * np.eye(size)]) - constant).T
    affine[:size, size] = constant
    exact = scipy.linalg.expm(affine)[:size, size].reshape(-1, 64)
    exact -= exact.mean(axis=1, keepdims=True)
    errors = []
    for steps in (16, 32, 64):
        now = FieldSteps.begin(contact.system(), ActiveSet(), contact)
        for number in range(1, steps + 1):
            now.attempt(1.0 / steps, Aim((TOLERANCE, TOLERANCE), (1e-9, 1e-9)))
            now.accept(number / steps)
        published = now.state().creep
        assert isinstance(published, AnchorModes)
        anchors = contact.lattice.backward(published.modes).reshape(-1, 64)
        errors.append(np.linalg.norm(anchors - anchors.mean(axis=1, keepdims=True) - exact))
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("relative", [0.1, 1.0, 10.0])
def test_a_held_machine_lets_the_force_relax_as_dense_matrices_have_it(relative):
    heights, start, times = correlated(8, hurst=0.8), 3.0, np.array([0.1, 1.0, 10.0])
    free = pressed(heights, asp.solids.half_space(modulus=2.0, branches=THREE), load=start, spacing=SPACING)
    spring = relative * free.normal_stiffness
    solid = asp.solids.half_space(modulus=2.0, branches=THREE, apparatus=spring)
    contact = pressed(heights, solid, load=start, spacing=SPACING)
    np.testing.assert_array_equal(contact.in_contact, free.in_contact)
    series = 1 / (1 / spring + 1 / free.normal_stiffness)
    assert contact.normal_stiffness == pytest.approx(series, rel=1e-8)
    permanent, branches = maxwell(half, THREE)
    area = heights.size * np.prod(SPACING)
    dense = Dense(heights, lambda q, lam: permanent(q, lam) + (q == 0) * spring / area, branches, SPACING)
    _, machine, _ = dense.contact(np.zeros((3, 64)), start)
    assert machine == pytest.approx(contact.separation, abs=1e-8)
    v, forces = np.zeros((3, 64)), []
    for duration in np.diff(times, prepend=0.0):
        v = dense.creep(v, duration, position_at=lambda _: machine)
        _, _, force = dense.contact(v, position=machine)
        forces.append(force.sum())
    history = asp.age(contact, times, hold="separation", rtol=5e-4)
    np.testing.assert_allclose(history.dataset["load"][1:], forces, atol=5e-4 * start)
    np.testing.assert_array_equal(history.final.in_contact.ravel(), dense.touching)


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
