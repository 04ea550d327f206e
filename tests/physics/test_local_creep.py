"""Creep that is local and not linear, against closed forms and LSODA with dense contacts, and its order."""

import numpy as np
import pytest
import scipy.integrate

import asperity as asp
from asperity.aging.local_steps import LocalSteps
from asperity.aging.tr_bdf2 import Aim
from asperity.solids import CreepLaw, Eyring, Garofalo, Norton, half_space, spring_lattice
from tests.dense_reference import Dense
from tests.equal_steps import anchors_after, orders

ROUGH = np.random.default_rng(0).normal(size=(8, 8))
TIMES = [1e-3, 0.1, 1.0, 10.0]


def lattice(creep=None, **others):
    return spring_lattice(**({"k0": 1.0, "k1": 3.0, "R": 0.0} | others), creep=creep)


@pytest.mark.parametrize("s0", [0.05, 0.3, 5.0])
def test_independent_springs_relax_as_eyring_has_it(s0):
    rough = ROUGH - ROUGH.max()
    start = asp.press(rough, lattice(Eyring(rate=0.2, stress=s0), k0=0.0), separation=-1.5)
    times = np.geomspace(1e-6, 1e3, 10)
    history = asp.age(start, times, rtol=1e-5, fields_at=times)
    first = 3.0 * np.maximum(rough + 1.5, 0.0)
    data = history.dataset
    for number, time in enumerate(times):
        stress = 3.0 * (data["u"][number] - data["u0"][number]).values
        # tanh(s/2s0) = tanh(s_i/2s0) exp(-k1 v0 t/s0), with logarithms of tanh where s is large
        ratio = np.tanh(first / (2 * s0)) * np.exp(-3.0 * 0.2 * time / s0)
        ends = first > 30 * s0
        exact = 2 * s0 * np.arctanh(np.where(ends, 0.0, ratio))
        decay = 2 * np.exp(-first / s0) + 0.6 * time / s0
        exact = np.where(ends, -s0 * np.log(np.tanh(decay / 2)), exact)
        assert np.abs(stress - exact).max() < 2e-4 * first.max()


@pytest.mark.parametrize(("hold", "R"), [("load", 0.0), ("separation", 1.0)])
def test_under_small_stresses_it_is_viscous(hold, R):
    runs = [
        asp.age(asp.press(ROUGH, solid, load=20.0), TIMES, hold=hold, rtol=1e-4, fields_at=TIMES).dataset
        for solid in (lattice(Eyring(rate=1e4, stress=1e4), R=R), lattice(R_viscous=1.0, R=R))
    ]
    size = runs[1]["u"][0].values.std()
    for name in ("u", "u0"):
        apart = (runs[0][name] - runs[1][name]).values
        assert np.sqrt(np.mean(apart**2, axis=(1, 2))).max() < 2e-4 * size  # each errs by rtol at most
    np.testing.assert_allclose(runs[0]["approach"], runs[1]["approach"], rtol=1e-4, atol=1e-4 * size)
    np.testing.assert_allclose(runs[0]["load"], runs[1]["load"], rtol=1e-3, atol=1e-3)


@pytest.mark.parametrize(
    ("solid", "law", "share", "compliance"),
    [
        (lattice, Eyring(rate=0.1, stress=0.3), 1.0, 1 / 3),
        (lattice, Norton(rate=0.1, stress=0.3, exponent=4), 1.0, 1 / 3),
        (lambda law: half_space(modulus=1.0, creep=law), Norton(0.1, 0.3, 4), 1.0, 0.0),
        (lambda law: half_space(modulus=1.0, creep=law, permanent=0.4), Eyring(0.1, 0.3), 0.6, 0.0),
    ],
)
def test_a_flat_surface_sinks_by_the_law_alone_while_the_load_rises(law, solid, share, compliance):
    flat = np.full((5, 8), 1e3)
    start = asp.press(flat, solid(law), load=0.1 * flat.size)
    rise = [asp.protocols.Ramp(10.0, load=flat.size), asp.protocols.Hold(10.0)]
    found = asp.age(start, times=[1.0, 5.0, 10.0, 20.0], protocol=rise, rtol=1e-4).dataset["approach"]

    def sunk(time):
        pressure = min(0.1 + 0.09 * time, 1.0)
        crept, _ = scipy.integrate.quad(
            lambda t: law.velocity(np.array([share * min(0.1 + 0.09 * t, 1.0)]))[0].item(),
            0.0,
            time,
            points=[min(time, 10.0)],
        )
        return share * crept + compliance * (pressure - 0.1)

    exact = [sunk(time) for time in found["time"].values[1:]]
    np.testing.assert_allclose(found[1:], exact, rtol=1e-4, atol=1e-4 * compliance)


def dense(heights, rate, held, times, R):
    """(u, X) at each time by LSODA, the contact of each moment by dense matrices."""
    branch = (lambda _q, _lam: 3.0, lambda _, lam: R * lam)
    judge = Dense.of_laws(heights, lambda _, lam: lam, [branch], (1.0, 1.0))

    def speed(_, v):
        y, _, _ = judge.contact([v], **held)
        return rate(3.0 * (y - v)) + judge.rate[0] @ (y - v)

    found = scipy.integrate.solve_ivp(
        speed, (0.0, times[-1]), np.zeros(heights.size), t_eval=times, method="LSODA", rtol=1e-9, atol=1e-11
    )
    contacts = (judge.contact([v], **held) for v in found.y.T)
    return [((y + X).reshape(heights.shape), X) for y, X, _ in contacts]


@pytest.mark.parametrize(
    ("law", "rate", "R", "load"),
    [
        (Eyring(0.1, 0.3), lambda s: 0.1 * np.sinh(s / 0.3), 0.0, 10.0),
        (Eyring(1e-3, 0.1), lambda s: 1e-3 * np.sinh(s / 0.1), 0.3, 30.0),
        (Garofalo(0.2, 0.5, 2.5), lambda s: 0.2 * np.sign(s) * np.abs(np.sinh(s / 0.5)) ** 2.5, 1.0, 60.0),
        (Norton(0.5, 1.0, 3.0), lambda s: 0.5 * s**3, 0.0, 30.0),
        (CreepLaw(lambda s: s + s**3, lambda s: 1 + 3 * s**2), lambda s: s + s**3, 0.2, None),
        (Eyring(0.1, 0.3), lambda s: 0.1 * np.sinh(s / 0.3), 0.0, None),
    ],
)
def test_it_is_what_explicit_integration_finds(law, rate, R, load):
    start = asp.press(ROUGH, lattice(law, R=R), **({"separation": 0.8} if load is None else {"load": load}))
    held = {"position": 0.8} if load is None else {"load": load}
    times = np.array([0.01, 0.3, 3.0])
    history = asp.age(start, times, rtol=1e-5, fields_at=times)
    data = history.dataset
    size = data["u"][0].values.std()
    for number, (u, X) in enumerate(dense(ROUGH, rate, held, times, R)):
        assert np.abs(data["u"][number].values - u).max() < 3e-4 * size
        assert int(data["area"].sel(time=times[number])) == np.count_nonzero(u - ROUGH < 1e-9) or load is None
        if load is not None:
            approach = start.separation - X
            assert float(data["approach"].sel(time=times[number])) == pytest.approx(approach, rel=3e-4)


@pytest.mark.parametrize("hold", ["load", "separation"])
def test_equal_steps_converge_at_second_order(hold):
    # Few spikes of nearly one height: all touch all the time, so that no event spoils the order.
    rng = np.random.default_rng(0)
    rough = np.full((16, 16), -9.0)
    rough.flat[rng.choice(256, 12, replace=False)] = rng.uniform(-0.05, 0.0, 12)
    start = asp.press(rough, lattice(Eyring(0.05, 0.5)), load=20.0)
    control = asp.Load(20.0) if hold == "load" else asp.Separation(start.separation)

    aim = Aim((1e-9, 1e-9), (1e-12, 1e-12))
    exact, *tried = (
        anchors_after(count, LocalSteps, start, start.system(control), 0.5, aim)
        for count in (512, 8, 16, 32, 64)
    )
    errors = [np.abs(found - exact).max() for found in tried]
    assert errors[0] > 1e-6
    assert (orders(errors) > 1.8).all(), errors


@pytest.mark.parametrize(("rtol", "s0"), [(1e-2, 0.1), (1e-3, 1.0)])
def test_errors_stay_below_rtol(rtol, s0):
    rough = asp.surfaces.gaussian((16, 16), rms=1.0, seed=3)
    start = asp.press(rough, lattice(Eyring(0.1, s0)), load=25.0)
    times = np.geomspace(1e-5, 1e3, 5)
    found, exact = (asp.age(start, times, rtol=tol, fields_at=times).dataset for tol in (rtol, 5e-5))
    size = np.maximum.accumulate(exact["u"].values.std(axis=(1, 2)))
    apart = (found["u0"] - exact["u0"]).values
    assert (np.sqrt(np.mean(apart**2, axis=(1, 2))) < rtol * size).all()


def test_energy_falls_at_a_held_separation_and_the_steady_state_is_the_relaxed_one():
    start = asp.press(ROUGH, lattice(Eyring(0.1, 0.2)), load=20.0)
    held = asp.age(start, np.geomspace(1e-5, 1e4, 30), hold="separation").dataset
    energy = held["energy"].values
    assert (np.diff(energy) < 1e-9 * energy[0]).all()
    assert energy[-1] < 1e-6 * energy[0]
    late = asp.age(start, [1e5], fields_at=[1e5])
    limit = asp.relax(start)
    np.testing.assert_allclose(late.final.u, limit.u, atol=2e-3 * limit.u.std())
    assert late.final.area == limit.area


def test_lines_and_edges_that_reflect():
    line = ROUGH[0]
    start = asp.press(line, lattice(Eyring(0.1, 0.3)), load=5.0)
    plane = asp.press(np.tile(line, (8, 1)), lattice(Eyring(0.1, 0.3)), load=40.0)
    pair = [asp.age(one, [1.0], rtol=1e-5).final.u for one in (start, plane)]
    np.testing.assert_allclose(pair[0], pair[1][3], atol=1e-5)
    surface = asp.surfaces.Surface(ROUGH, edges="reflecting")
    mirrored = np.block([[ROUGH, ROUGH[:, ::-1]], [ROUGH[::-1], ROUGH[::-1, ::-1]]])
    one = asp.age(asp.press(surface, lattice(Eyring(0.1, 0.3)), load=20.0), [1.0], rtol=1e-5)
    four = asp.age(asp.press(mirrored, lattice(Eyring(0.1, 0.3)), load=80.0), [1.0], rtol=1e-5)
    np.testing.assert_allclose(one.final.u, four.final.u[:8, :8], atol=1e-5)


@pytest.mark.parametrize(("k1", "R", "stress"), [(31.0, 0.0, 90.0), (40.0, 0.5, 9.0)])
def test_cycles_are_few_where_contacts_crowd(k1, R, stress):
    rough = asp.surfaces.self_affine(64, hurst=0.8, delta=0.1, seed=2)
    solid = lattice(Eyring(1e-3, stress), k1=k1, R=R)
    start = asp.press(rough / rough.std(), solid, load=0.05 * (1.0 + k1) * rough.size)
    frames: list[asp.Frame] = []
    asp.age(start, np.geomspace(1e-3, 1e4, 8), progress=frames.append)
    steps, rejected, cycles = (
        sum(getattr(frame, name) for frame in frames[1:]) for name in ("steps", "rejected", "iterations")
    )
    assert rejected <= 0.3 * steps
    assert cycles <= 5.5 * (steps + rejected)
