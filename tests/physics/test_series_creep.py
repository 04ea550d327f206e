"""Local creep in series with a half-space: the dual problem, by an operator and by gradients of its own."""

import numpy as np
import pytest
import scipy.integrate

import asperity as asp
from asperity.contact.choice import local_solver
from asperity.contact.local_creep import LocalState, Stage
from asperity.solids import Eyring, half_space

SPACING, MODULUS = (2e-8, 1e-8), 3e9
CELL = SPACING[0] * SPACING[1]


def scan(n=16, seed=1):
    rough = 2e-9 * asp.surfaces.self_affine(n, hurst=0.8, delta=0.3, seed=seed)
    return asp.surfaces.Surface(rough - rough.max(), unit="m", pixel_size=SPACING, length_unit="m")


def compliance(shape):
    """Displacement under a unit force at each site, a dense matrix: sums of waves, written out."""
    ny, nx = shape
    y, x = (axis.ravel() for axis in np.indices(shape))
    total = np.zeros((ny * nx, ny * nx))
    for j in range(ny):
        for k in range(nx):
            if j == k == 0:
                continue
            waves = [2 * np.pi * (i if i <= n // 2 else i - n) / n for i, n in ((j, ny), (k, nx))]
            q = np.hypot(waves[0] / SPACING[0], waves[1] / SPACING[1])
            phase = waves[0] * (y[:, None] - y) + waves[1] * (x[:, None] - x)
            total += np.cos(phase) * 2 / (MODULUS * q * CELL * ny * nx)
    return total


def stage(law, tau, pressure):
    start = asp.press(scan(), half_space(modulus=MODULUS, creep=law), pressure=pressure)
    system = start.system()
    guess = LocalState(start.u - system.datum, start.force, 0.0)
    before = start.anchors[0] - system.datum
    solver = local_solver(system)
    found, _ = solver.solve(Stage(tau, before, start.load, 0.0), guess, 1e-20)
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
        low, high = -np.abs(p).max() - load, np.abs(p).max() + load
        for _ in range(200):
            middle = (low + high) / 2
            low, high = (middle, high) if np.maximum(p - middle, 0).sum() > load else (low, middle)
        return np.maximum(p - middle, 0)

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


@pytest.mark.parametrize("s0", [3e7])
def test_histories_are_what_explicit_integration_finds(s0):
    law = Eyring(rate=1e-12, stress=s0)
    start = asp.press(scan(8), half_space(modulus=MODULUS, creep=law), pressure=3e7)
    times = np.array([1.0, 30.0, 1000.0]) * (1e-1 if s0 < 5e7 else 1e1)
    data = asp.age(start, times, rtol=3e-5, fields_at=times).dataset
    h, load = np.asarray(start.heights).ravel(), start.load
    T = compliance(start.heights.shape)
    touching = start.in_contact.ravel()

    def contact(v):
        nonlocal touching
        for _ in range(100):
            n = np.count_nonzero(touching)
            A, b = np.zeros((n + 1, n + 1)), np.append((h - v)[touching], load)
            A[:n, :n], A[:n, n], A[n, :n] = T[np.ix_(touching, touching)], 1.0, 1.0
            found = np.linalg.solve(A * np.append(np.ones(n), 1.0)[:, None], b)
            p = np.zeros(h.size)
            p[touching] = found[:n]
            gap = T @ p + v + found[n] - h
            better = np.where(touching, p > 0, gap < -1e-14 * np.ptp(h))
            if (better == touching).all():
                return p
            touching = better
        raise AssertionError

    def speed(_, v):
        return law.rate * np.sinh(contact(v) / CELL / s0)

    found = scipy.integrate.solve_ivp(
        speed, (0, times[-1]), np.zeros(h.size), t_eval=times, method="LSODA", rtol=1e-8, atol=1e-19
    )
    for number, v in enumerate(found.y.T):
        p = contact(v) / CELL
        assert np.abs(data["pressure"][number].values.ravel() - p).max() < 1e-3 * p.max()


def test_under_small_stresses_it_is_dissolution():
    # flow=(m, 0) has the mobility m at every wave vector but 0, where the rigid body moves anyway
    times = [1.0, 100.0, 1e4]
    law = Eyring(rate=1e-2, stress=1e12)
    runs = [
        asp.age(asp.press(scan(), solid, pressure=5e7), times, rtol=1e-4, fields_at=times).dataset
        for solid in (half_space(modulus=MODULUS, creep=law), half_space(modulus=MODULUS, flow=(1e-14, 0.0)))
    ]
    size = runs[1]["u"][0].values.std()
    apart = (runs[0]["u"] - runs[1]["u"]).values
    assert (
        np.sqrt(np.mean((apart - apart.mean(axis=(1, 2), keepdims=True)) ** 2, axis=(1, 2))).max()
        < 2e-4 * size
    )
    assert runs[1]["area"][-1] > 1.2 * runs[1]["area"][0]
    np.testing.assert_allclose(runs[0]["area"], runs[1]["area"], atol=1)


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
