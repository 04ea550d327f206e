"""Local creep on a half-space: the dual problem, by an operator and by gradients of its own, and limits."""

from typing import Literal

import numpy as np
import pytest
import scipy.integrate

import asperity as asp
from asperity.aging.local_steps import LocalSteps
from asperity.aging.tr_bdf2 import Aim
from asperity.contact.choice import local_solver
from asperity.contact.local_creep import LocalState, Stage
from asperity.errors import ConvergenceError
from asperity.protocols import Hold, Step
from asperity.solids import CreepBranch, Eyring, Norton, Solid, half_space
from asperity.solids.laws import PowerMobility, WaveNumberSpectrum
from tests.dense_reference import Dense, matrix_of
from tests.equal_steps import orders, shape_after
from tests.refusals import refuses

SPACING, MODULUS = (2e-8, 1e-8), 3e9
CELL = SPACING[0] * SPACING[1]


def scan(n=16, seed=1):
    rough = 2e-9 * asp.surfaces.self_affine(n, hurst=0.8, delta=0.3, seed=seed)
    return asp.surfaces.Surface(rough - rough.max(), unit="m", pixel_size=SPACING, length_unit="m")


def compliance(shape):
    """Displacement under a unit force at each site, a dense matrix."""
    q = 2 * np.pi * np.hypot(*np.ix_(*map(np.fft.fftfreq, shape, SPACING)))
    q[0, 0] = np.inf
    return matrix_of(2 / (MODULUS * q * CELL))


def stage(law, tau, pressure, **more):
    solid = half_space(modulus=MODULUS, creep=law, **more)
    start = asp.press(scan(), solid, pressure=pressure)
    system = start.system()
    before = start.anchors[0] - system.datum
    force = system.mechanics.creeping_force(start.u - start.anchors, system.load)
    guess = LocalState(start.u - system.datum, force, 0.0)
    solver = local_solver(system)
    found = solver.solve(Stage(tau, before, start.load, 0.0), guess, 1e-20).state()
    return found, system.heights, before, start.load


def projected_gradients(T, heights, before, law, tau, load):
    """Forces p >= 0 of sum F that minimize the dual energy: steps down, and back to what is allowed."""
    h = (heights - before).ravel()
    p = np.full(h.size, load / h.size)

    def energy(p):
        return (
            p @ T @ p / 2
            + tau * law.rate * law.stress * CELL * np.sum(np.cosh(p / CELL / law.stress) - 1)
            - p @ h
        )

    def allowed(p):
        falling = np.sort(p)[::-1]
        less = (np.cumsum(falling) - load) / np.arange(1, p.size + 1)
        return np.maximum(p - less[falling > less][-1], 0)

    step, q, momentum = 1 / np.linalg.eigvalsh(T)[-1], p, 1.0
    for _ in range(2500):
        gradient = T @ q + tau * law.rate * np.sinh(q / CELL / law.stress) - h
        while True:
            new = allowed(q - step * gradient)
            d = new - q
            if energy(new) <= energy(q) + gradient @ d + d @ d / (2 * step) * (1 + 1e-9):
                break
            step /= 2
        if (q - new) @ (new - p) > 0:  # past the lowest point: without momentum again
            momentum = 1.0
        faster = (1 + np.sqrt(1 + 4 * momentum**2)) / 2
        q, p, momentum = np.maximum(new + (momentum - 1) / faster * (new - p), 0), new, faster
        step *= 1.05
    return p


@pytest.mark.parametrize(("s0", "tau", "pressure"), [(5e6, 1e-9, 3e7), (2e7, 1e-3, 3e7), (1e9, 1.0, 1e8)])
def test_newton_and_projected_gradients_agree_and_are_optimal(s0, tau, pressure):
    law = Eyring(rate=1e-7, stress=s0)
    found, heights, before, load = stage(law, tau, pressure)
    T = compliance(heights.shape)
    p = found.force.ravel()
    size = np.ptp(heights)
    gap = T @ p + tau * law.rate * np.sinh(p / CELL / s0) - (heights - before).ravel()
    gap -= gap[p > 0].mean()  # the rise of the body
    assert p.min() >= 0
    assert p.sum() == pytest.approx(load, rel=1e-9)
    assert np.abs(gap[p > 0]).max() < 1e-9 * size
    assert gap.min() > -1e-9 * size
    slow = projected_gradients(T, heights, before, law, tau, load)
    assert np.abs(slow - p).max() < 2e-4 * p.max()


@pytest.mark.parametrize(
    ("s0", "tau", "pressure", "share"), [(5e6, 1e-9, 3e7, 0.6), (2e7, 1e-3, 3e7, 0.1), (1e9, 1.0, 1e8, 0.9)]
)
def test_a_step_beside_a_permanent_share_is_optimal(s0, tau, pressure, share):
    law = Eyring(rate=1e-7, stress=s0)
    found, heights, before, load = stage(law, tau, pressure, permanent=1 - share)
    T, n, size = compliance(heights.shape), heights.size, np.ptp(heights)
    s, u = found.force.ravel(), found.u.ravel()
    creep = tau * law.rate * np.sinh(s / CELL / s0)
    even = np.full((n, n), 1.0 / n)
    p = s + (1 - share) * np.linalg.pinv(T) @ u
    p += load / n - p.mean()
    assert np.abs(p[u > heights.ravel()]).max(initial=0.0) < 1e-7 * p.max()
    assert p.min() > -1e-7 * p.max()
    assert (u - heights.ravel()).min() >= 0
    assert s.sum() == pytest.approx(share * load, rel=1e-9)
    lacking = T @ s / share + before.ravel() + creep - u
    assert np.abs(lacking - even @ lacking).max() < 1e-9 * size


def test_a_step_of_sites_that_yield_is_optimal():
    law, bound, counts = Eyring(rate=1e-9, stress=2e7), 6e7, []
    for tau in (1e-12, 1e-3):
        found, heights, before, load = stage(law, tau, 3e7, hardness="60 MPa")
        p, size = found.force.ravel() / CELL, np.ptp(heights)
        crept = tau * law.velocity(p)[0] + (before - heights).ravel()
        gap = compliance(heights.shape) @ found.force.ravel() + crept + found.position
        assert found.force.sum() == pytest.approx(load, rel=1e-9)
        assert 0 <= p.min() <= p.max() <= bound * (1 + 1e-12)
        yields = p >= bound * (1 - 1e-9)
        assert np.abs(gap[(p > 0) & ~yields]).max() < 1e-9 * size
        assert gap[p == 0].min(initial=0.0) > -1e-9 * size
        assert gap[yields].max(initial=0.0) < 1e-9 * size
        counts.append(np.count_nonzero(yields))
    assert counts[0] > 10 > counts[1]


@pytest.mark.parametrize(
    ("share", "apparatus"), [(1.0, None), (1.0, 30.0), (0.7, None), (0.7, np.inf), (0.3, None), (0.3, 30.0)]
)
def test_histories_are_what_explicit_integration_finds(share, apparatus):
    law = Eyring(rate=1e-12, stress=3e7)
    solid = half_space(modulus=MODULUS, creep=law, permanent=1 - share, apparatus=apparatus)
    start = asp.press(scan(8), solid, pressure=3e7)
    times = np.array([0.1, 3.0, 100.0])
    hold: Literal["load", "separation"] = "load" if apparatus is None else "separation"
    data = asp.age(start, times, hold=hold, rtol=3e-5, fields_at=times).dataset
    heights, area = np.asarray(start.heights), start.heights.size * CELL
    spring = 0.0 if apparatus is None else min(apparatus, 1e7 * start.normal_stiffness) / area
    judge = Dense.of_laws(
        heights,
        lambda q, _: (1 - share) * MODULUS * q / 2 + (q == 0) * spring,
        [(lambda q, _: share * MODULUS * q / 2, lambda q, _: 0 * q)],
        SPACING,
    )
    _, body, _ = judge.contact([np.zeros(heights.size)], load=start.load)

    def contact(v):
        """What creeps evenly moves the rigid body."""
        held = {"load": start.load} if apparatus is None else {"position": body + share * v.mean()}
        return judge.contact([v - v.mean()], **held)

    def speed(_, v):
        y, _, force = contact(v)
        s = judge.C[0] @ (y - v) + share * force.mean()
        return law.rate * np.sinh(s / CELL / law.stress)

    found = scipy.integrate.solve_ivp(
        speed, (0, times[-1]), np.zeros(heights.size), t_eval=times, method="LSODA", rtol=1e-8, atol=1e-19
    )
    for number, v in enumerate(found.y.T):
        _, _, force = contact(v)
        p = np.where(judge.touching, force, 0.0)
        assert np.abs(data["pressure"][number].values.ravel() - p / CELL).max() < 1e-3 * p.max() / CELL
        assert float(data["load"][number + 1]) == pytest.approx(p.sum(), rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("share", [1.0, 0.6])
def test_under_small_stresses_it_is_dissolution(share):
    # flow=(m, 0) has the mobility m at every wave vector but 0, where the rigid body moves anyway
    times = [1.0, 100.0, 1e4]
    law, (own, rest) = (
        Eyring(rate=1e-2, stress=1e12),
        (WaveNumberSpectrum(part * MODULUS / 2) for part in (share, 1 - share)),
    )
    branch = CreepBranch(own, PowerMobility(1e-14, 0.0))
    linear = Solid(rest, (branch,), loaded_from_afar=True, in_lengths=True)
    runs = [
        asp.age(asp.press(scan(), solid, pressure=5e7), times, rtol=1e-4, fields_at=times).dataset
        for solid in (half_space(modulus=MODULUS, creep=law, permanent=1 - share), linear)
    ]
    size = runs[1]["u"][0].values.std()
    apart = (runs[0]["u"] - runs[1]["u"]).values
    apart -= apart.mean(axis=(1, 2), keepdims=True)
    assert np.sqrt(np.mean(apart**2, axis=(1, 2))).max() < 2e-4 * size
    assert runs[1]["area"][-1] > 1.2 * runs[1]["area"][0]
    np.testing.assert_allclose(runs[0]["area"], runs[1]["area"], atol=1)


@pytest.mark.slow
def test_pressures_of_a_hundred_stresses_fall_through_all_decades():
    """Numbers of PMMA in SI: Q = 180 kJ/mol, 1.5 nm^3, 25 degrees C. At first the rate is 1e41 m/s.

    A site whose pressure falls has crept by more than v(p) t, and by less than the heights span, so that
    p < s0 arsinh(span / v0 t); it stays near that, for v falls by e where p falls by s0.
    """
    law = Eyring(rate=np.exp(-180e3 / 8.314 / 298.15), stress=1.380649e-23 * 298.15 / 1.5e-27)
    heights = asp.surfaces.spectral((64, 64), spacing=0.5, hurst=0.8, roll_off=16.0, rms_slope=0.1, seed=3)
    rough = asp.surfaces.Surface(heights, unit="um", pixel_size=(0.5, 0.5), length_unit="um")
    contact = asp.press(rough, half_space(modulus=3.8e9, creep=law), pressure=5e6)
    assert contact.largest_pressure > 160 * law.stress
    for time in (1e-3, 1e4):
        history = asp.age(contact, [time])
        assert int(history.dataset["steps"].sum()) < 300
        most = law.stress * np.arcsinh(np.ptp(heights) * 1e-6 / (law.rate * time))
        assert 0.85 * most < history.final.largest_pressure < most


@pytest.mark.parametrize("permanent", [pytest.param(0.02, marks=pytest.mark.slow), 0.4])
def test_beside_a_permanent_share_the_end_is_the_elastic_contact_of_that(permanent):
    solid = half_space(modulus=MODULUS, creep=Eyring(rate=1e-9, stress=2e7), permanent=permanent)
    start = asp.press(scan(), solid, pressure=3e7)
    elastic = asp.press(scan(), half_space(modulus=permanent * MODULUS), pressure=3e7)
    limit = asp.relax(start)
    np.testing.assert_array_equal(limit.in_contact, elastic.in_contact)
    np.testing.assert_allclose(limit.force, elastic.force, atol=1e-6 * elastic.force.max())
    times = np.geomspace(1e-4, 1e6, 23)
    data = asp.age(start, times, fields_at=times[-8:], rtol=1e-3).dataset
    force = CELL * data["pressure"].values
    assert np.abs(force - elastic.force).max() < 1e-5 * elastic.force.max()
    assert (data["area"][-8:] == elastic.area).all()


@pytest.mark.parametrize("apparatus", [np.inf, 5.0])
@pytest.mark.parametrize("hardness", [None, 2.0])
def test_at_a_held_separation_the_mean_creeps_until_nothing_is_borne(apparatus, hardness):
    """A permanent share resists waves, and not the mean: this sinks while any force is left."""
    heights = asp.surfaces.spectral((16, 16), roll_off=8, cutoff=3, rms_height=1.0, seed=2)
    law = Norton(rate=0.1, stress=0.4, exponent=1.0)
    solid = half_space(modulus=1.0, creep=law, permanent=0.4, apparatus=apparatus, hardness=hardness)
    contact = asp.press(asp.surfaces.Surface(heights, pixel_size=(1.0, 1.0)), solid, load=5.0)
    limit, late = asp.relax(contact, hold="separation"), asp.age(contact, [1e7], hold="separation").final
    assert (limit.load, limit.area) == (0.0, 1)
    np.testing.assert_allclose(late.u, limit.u, atol=1e-7)
    assert late.load < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("permanent", [0.0, 0.4])
def test_equal_steps_converge_at_second_order(permanent):
    # Few spikes, all of which touch all the time, so that no event spoils the order.
    rng = np.random.default_rng(0)
    rough = np.full((16, 16), -1e-7)
    rough.flat[rng.choice(256, 12, replace=False)] = rng.uniform(-1e-10, 0.0, 12)
    surface = asp.surfaces.Surface(rough, unit="m", pixel_size=SPACING, length_unit="m")
    solid = half_space(modulus=MODULUS, creep=Eyring(rate=1e-9, stress=3e8), permanent=permanent)
    start = asp.press(surface, solid, pressure=2e7)
    assert start.area == 12

    aim = Aim((1e-9, 1e-9), (1e-22, 1e-22))
    exact, *tried = (
        shape_after(count, LocalSteps, start, start.system(), 0.05, aim) for count in (256, 4, 8, 16, 32)
    )
    errors = [np.abs(found - exact).max() for found in tried]
    assert errors[0] > 1e-6 * exact.std()
    assert (orders(errors) > 1.8).all(), errors


@pytest.mark.slow
@pytest.mark.parametrize("hardness", [None, "0.3 GPa"])
@pytest.mark.parametrize("permanent", [0.0, 0.3])
def test_steep_laws_take_few_revisions_through_nine_decades(permanent, hardness):
    # Stresses of 65 s0 at first: creep at the contacts differs by 25 orders of magnitude.
    rough = asp.surfaces.self_affine(32, hurst=0.8, delta=0.1, seed=1)
    surface = asp.surfaces.Surface(
        5e-7 * rough / rough.std(), unit="m", pixel_size=(1e-6, 1e-6), length_unit="m"
    )
    law = Eyring(rate=1e-9, stress=12e6)
    solid = half_space(modulus="4 GPa", creep=law, permanent=permanent, hardness=hardness)
    start = asp.press(surface, solid, pressure="20 MPa")
    assert start.largest_pressure > (20 if hardness else 60) * law.stress
    frames: list[asp.Frame] = []
    asp.age(start, np.geomspace(1e-3, 1e6, 10), progress=frames.append)
    steps, rejected, iterations = (
        sum(getattr(frame, name) for frame in frames[1:]) for name in ("steps", "rejected", "iterations")
    )
    assert rejected <= 0.2 * steps
    assert iterations <= 35 * (steps + rejected)


def test_what_stands_beside_a_permanent_share_is_refused():
    law = Eyring(rate=1e-9, stress=1e7)
    with refuses("permanent", "none"):
        half_space(modulus=1.0, permanent=0.3)
    for share in (1.0, 0.01):
        with refuses("permanent", share):
            half_space(modulus=1.0, permanent=share, creep=law)
    uneven = Solid(
        WaveNumberSpectrum(0.15 * MODULUS),
        (CreepBranch(PowerMobility(MODULUS / 2e7 * CELL**2, 2.0)),),
        loaded_from_afar=True,
        in_lengths=True,
        creep=law,
    )
    with refuses("creep"):
        asp.age(asp.press(scan(), uneven, pressure=1e7), [1.0])


@pytest.mark.parametrize("hardness", [None, 3e7])
def test_bodies_that_are_taken_apart_relax_beside_a_permanent_share(hardness):
    law = Eyring(rate=1e-9, stress=2e7)
    solid = half_space(modulus=MODULUS, creep=law, permanent=0.4, apparatus=np.inf, hardness=hardness)
    start = asp.press(scan(), solid, pressure=2e7)
    legs = [Hold(10.0, hold="separation"), Step(approach=-3e-6), Hold(1e5)]
    history = asp.age(start, times=[1.0], protocol=legs)
    assert history.final.area == 0
    energy = history.dataset["energy"].values
    assert energy[-1] < 1e-12 * energy[0]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("softer", "reached"), [(100.0, True), pytest.param(1000.0, False, marks=pytest.mark.slow)]
)
def test_a_law_too_stiff_for_a_step_is_followed_by_shorter_ones_or_refused(softer, reached):
    rough = np.round(np.random.default_rng(0).normal(size=(16, 16)))
    law = Norton(rate=1.0, stress=0.2 / softer, exponent=6.0)
    start = asp.press(rough, half_space(modulus=1.0, creep=law, permanent=0.02), load=0.2 * rough.size)
    if reached:  # the weight presses the permanent share flat
        elastic = asp.press(rough, half_space(modulus=0.02), load=start.load)
        assert asp.age(start, [1e-3, 1.0, 1e3, 1e6]).final.area == elastic.area
    else:
        with pytest.raises(ConvergenceError, match=r"too stiff|steps shrank"):
            asp.age(start, [1e-3, 1.0, 1e3, 1e6])
