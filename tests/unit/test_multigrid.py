"""The multigrid solver: its parts against their definitions, its results against the Fourier solver."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import asperity as asp
from asperity.aging.field_steps import FieldSteps
from asperity.contact import ActiveSet, Load, Multigrid, Separation
from asperity.contact.multigrid import operations
from asperity.contact.multigrid.grids import Axis, Hierarchy, empty
from asperity.contact.multigrid.loops import Sites, rows
from asperity.contact.multigrid.pins import compliance
from asperity.contact.multigrid.two_fields import TwoFields
from asperity.contact.pinning import coherent_potential
from asperity.contact.problem import PUBLISHED, Guess
from asperity.solids import Springs
from tests.independent import assert_equilibrium, laplacian
from tests.refusals import each_refuses
from tests.surfaces import correlated, uncorrelated


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("n", [1, 2, 3, 4, 7, 25, 200, 513])
def test_coarser_axes_keep_their_length(n, mirrored):
    axis = Axis.fine(n, mirrored=mirrored)
    while axis.size.size > 1:
        axis = axis.coarser
        assert axis.size.sum() == pytest.approx(n)
        if axis.size.size > 1 and not mirrored:
            assert (1 / axis.coupling).sum() == pytest.approx(n)
        if mirrored:
            assert axis.coupling[-1] == 0


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("shape", [(8, 8), (9, 14), (1, 6), (7, 1), (2, 3)])
def test_restriction_is_the_transpose_of_interpolation(shape, mirrored):
    rng = np.random.default_rng(0)
    sites = Sites(shape[0], shape[1], mirrored)
    coarser = Sites((shape[0] + 1) // 2, (shape[1] + 1) // 2, mirrored)
    coarse, fine = (rng.normal(size=s).astype(np.float32) for s in (coarser[:2], shape))
    up, out = empty(sites), empty(coarser)
    for i in range(shape[0]):
        rows.interpolate_row(coarse, i, sites, up[i])
    operations.restrict(operations.packed(fine), sites, out)
    interpolated, restricted = operations.unpacked(up, sites), operations.unpacked(out, coarser)
    assert np.sum(interpolated * fine) == pytest.approx(np.sum(coarse * restricted), abs=1e-5)
    np.testing.assert_array_equal(interpolated[::2, ::2], coarse)
    level = np.ones(coarser[:2], np.float32)
    for i in range(shape[0]):
        rows.interpolate_row(level, i, sites, up[i])
    np.testing.assert_array_equal(operations.unpacked(up, sites), 1.0)


def zone_mean(springs, level, sigma, points=400):
    """Compliance of a site by summation over the Brillouin zone."""
    q = 2 * np.pi * (np.arange(points) + 0.5) / points
    lam = (4 - 2 * np.cos(q)[:, None] - 2 * np.cos(q)) / 1.0
    mass = 4.0**level
    creep = 1 + springs.drag + springs.spread * lam / mass
    return np.mean(1 / (lam + springs.k1 * mass / creep + sigma))


@pytest.mark.parametrize(
    "springs",
    [Springs(1.0, 3.0), Springs(1.0, 0.1, 2.0), Springs(1.0, 3.0, 40.0, 0.5), Springs(1.0, 1.0, 0.0, 3.0)],
)
@pytest.mark.parametrize(("level", "sigma"), [(0, 0.0), (0, 0.05), (1, 0.3), (3, 2.0)])
def test_compliance_of_a_site_is_the_mean_over_the_zone(springs, level, sigma):
    assert compliance(springs, level, sigma) == pytest.approx(zone_mean(springs, level, sigma), rel=1e-6)


@pytest.mark.parametrize("fraction", [1e-4, 0.03, 0.5, 0.99])
def test_coherent_potential_solves_its_condition(fraction):
    springs = Springs(1.0, 0.5, 10.0)
    sigma = coherent_potential(partial(compliance, springs, 0), fraction, 1.0)
    assert sigma * zone_mean(springs, 0, sigma) == pytest.approx(fraction, rel=0.05)


@pytest.mark.parametrize("contacts", [3, 300])
def test_pins_far_up_hold_like_the_contacts_together(contacts):
    # Springs on the coarsest grid add up to N sigma, the response of the whole surface.
    rng = np.random.default_rng(0)
    heights = np.full((128, 128), -1.0)
    heights.flat[rng.choice(heights.size, contacts, replace=False)] = 0.0
    springs = Springs(1.0, 0.3)
    hierarchy = Hierarchy(Sites(128, 128, False), 1)
    surface, gap = operations.packed(np.zeros_like(heights)), operations.packed(heights)
    hierarchy.set_pins(surface, gap, contacts / heights.size, springs)
    total = float(hierarchy.grids[-1].pins.sum())
    assert total == pytest.approx(
        heights.size * coherent_potential(partial(compliance, springs, 0), contacts / heights.size, 1.0),
        rel=0.15,
    )


def test_a_crowd_of_contacts_does_not_give():
    # Where all sites that share a coarse one are held, so is that, on every grid; a contact alone gives.
    springs = Springs(1.0, 30.0, 1.0)
    for shape, mirrored in (((64, 64), False), ((61, 63), False), ((62, 59), True)):
        hierarchy = Hierarchy(Sites(*shape, mirrored), 2)
        heights = np.full(shape, -1.0)
        heights[:, :36] = heights[5, 50] = 0.0
        surface, gap = operations.packed(np.zeros(shape)), operations.packed(heights)
        hierarchy.set_pins(surface, gap, float(np.mean(heights == 0)), springs)
        for level, grid in enumerate(hierarchy.grids[:3], start=1):
            own = operations.unpacked(grid.pins, grid.sites) / 4.0**level
            inside = slice(2, 36 // 2**level - 2)
            assert (own[2:-2, inside] > 100 * springs.k1).all()
            outside = own[5 // 2**level, 50 // 2**level]
            assert 0 < outside < 10 * springs.k1


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize("crowded", [False, True])
@pytest.mark.parametrize(
    ("bed", "spread", "drag"), [(3.0, 0.1, 0.0), (0.5, 30.0, 0.5), (60.0, 1.0, 0.0), (1e5, 1.0, 0.0)]
)
def test_what_is_left_of_an_error_is_estimated(bed, spread, drag, crowded, held):
    shape, rng = (16, 12), np.random.default_rng(3)
    work = TwoFields(Sites(*shape, False))
    touching = np.zeros(shape, bool)
    if crowded:
        touching[3:11, :8] = True
    else:
        touching = rng.random(shape) < 0.3
    gap = np.where(touching, 0.0, 1.0)
    work.bound[...] = np.where(operations.packed(np.ones(shape)) > 0, operations.packed(-gap), -np.inf)
    work.prepare(bed, spread, drag)
    work.begin(None if held else 1.0, 0.0, 0.0)
    error = rng.normal(size=shape)

    n, free, even = error.size, ~touching.ravel(), np.ones(error.size)
    lap = np.array([laplacian(site).ravel() for site in np.eye(n).reshape(-1, *shape)])
    lag = (1 + drag) * np.eye(n) - spread * lap
    matrix = np.zeros((2 * n + 1, 2 * n + 1))
    matrix[:n, :n], matrix[:n, n:-1] = np.diag(~free) - free[:, None] * lap, bed * np.diag(free)
    matrix[n:-1, :n], matrix[n:-1, n:-1] = -np.eye(n), lag
    if held:
        matrix[-1, -1] = 1.0
    else:
        matrix[n:-1, -1], matrix[-1, n:-1] = -even, even
    found = np.linalg.solve(matrix, np.concatenate([np.zeros(n), -error.ravel(), [0.0]]))
    exact = found[:n] - found[n:-1] + found[-1]
    work.improve_on_grids(float(touching.sum()))
    mean, estimate = work.filtered_error(operations.packed(error))
    assert mean == pytest.approx(exact.mean(), abs=0.02)
    expected = np.sqrt(np.mean(exact**2)) if held else exact.std()
    # Of errors between 1.2 and 30 times as large; stiff springs leave more of what is rough off contact.
    assert (0.65 if bed < 60 else 0.43) * expected <= estimate <= 1.05 * expected


@pytest.mark.slow
def test_fronts_of_smooth_contacts_under_stiff_springs_need_no_other_solver(monkeypatch):
    def give_up(*_):
        raise AssertionError

    monkeypatch.setattr(FieldSteps, "going_on", give_up)
    for k1 in (3.0, 100.0, 1000.0):
        contact = asp.press(correlated(96), asp.solids.spring_lattice(k0=1.0, k1=k1), load=460.0 * (1 + k1))
        frames: list[asp.Frame] = []
        asp.age(contact, np.geomspace(1e-3, 1e6, 10), progress=frames.append)
        assert frames[-1].contact.area > 0.3 * 96**2
        steps = sum(frame.steps + frame.rejected for frame in frames)
        assert sum(frame.iterations for frame in frames) < 12 * steps


CASES = [
    (uncorrelated(64), 3.0, 0.02),
    (uncorrelated(64), 0.01, 0.3),
    (uncorrelated(64), 100.0, 1.0),
    (correlated(96), 0.1, 0.002),
    (correlated(96), 3.0, 0.05),
    (uncorrelated(64)[:51, :37], 1.0, 0.1),
    (correlated(96)[:9, :], 1.0, 0.05),
    (correlated(96)[:4, :], 0.03, 0.05),
    (uncorrelated(64)[:, :5], 0.01, 0.1),
    (correlated(96)[:7, :6], 30.0, 0.3),
]


@pytest.mark.parametrize(("heights", "k1", "p"), CASES)
def test_agrees_with_the_fourier_solver_site_by_site(heights, k1, p):
    solid = asp.solids.spring_lattice(k0=1.0, k1=k1)
    heights = np.ascontiguousarray(heights)
    here, there = (
        asp.press(heights, solid, load=p * heights.size, solver=s) for s in (Multigrid(), ActiveSet())
    )
    np.testing.assert_array_equal(here.in_contact, there.in_contact)
    np.testing.assert_allclose(here.u, there.u, atol=1e-7 * heights.std())
    again = asp.press(heights, solid, separation=here.separation, solver=Multigrid())
    np.testing.assert_array_equal(again.in_contact, here.in_contact)
    ends = [asp.relax(here, solver=s) for s in (Multigrid(), ActiveSet())]
    np.testing.assert_array_equal(ends[0].in_contact, ends[1].in_contact)
    np.testing.assert_allclose(ends[0].u, ends[1].u, atol=1e-7 * heights.std())
    for contact in (here, again, ends[0]):
        assert_equilibrium(contact, k0=1.0, k1=k1)


@pytest.mark.parametrize(("heights", "k1", "p"), CASES)
@pytest.mark.parametrize("R_viscous", [0.0, 0.1])
def test_an_aged_contact_pressed_anew_agrees_with_the_fourier_solver(heights, k1, p, R_viscous):
    heights = np.ascontiguousarray(heights)
    solid = asp.solids.spring_lattice(k0=1.0, k1=k1, R_viscous=R_viscous)
    aged = asp.age(asp.press(heights, solid, load=p * heights.size), [0.3 / k1]).final
    for control in (Load(0.8 * aged.load), Separation(aged.separation - 0.1)):
        system = aged.system(control)
        before = aged.anchors - system.datum
        problem = system.problem(system.mechanics.implicit_step(0.0), before)
        guess = Guess(aged.u - system.datum, aged.in_contact)
        here, there = (solver.solve(problem, guess, PUBLISHED) for solver in (Multigrid(), ActiveSet()))
        np.testing.assert_array_equal(here.in_contact, there.in_contact)
        np.testing.assert_allclose(here.u, there.u, atol=1e-7 * heights.std())
        assert here.iterations < 20
        stretch = here.u - before[0]
        if isinstance(control, Load):
            stretch += control.value / (k1 * heights.size) - stretch.mean()
        force = k1 * stretch - laplacian(here.u)
        scale = force[here.in_contact].mean()
        assert np.abs(force[~here.in_contact]).max() < 1e-7 * scale
        assert force[here.in_contact].min() > -1e-7 * scale


@pytest.mark.parametrize("k1", [0.1, 3.0])
def test_cycles_do_not_grow_with_the_lattice(k1):
    solid = asp.solids.spring_lattice(k0=1.0, k1=k1)
    cycles = []
    for n in (64, 128, 256, 512):
        contact = asp.press(uncorrelated(n), solid, load=0.02 * n * n)
        cycles.append([contact.iterations, asp.relax(contact).iterations])
    assert np.max(cycles) <= 25
    assert (np.ptp(cycles, axis=0) <= 4).all()


def test_what_does_not_suit_is_refused_or_left_to_the_fourier_solver():
    line = np.random.default_rng(0).normal(size=64)
    solid = asp.solids.spring_lattice(k0=1.0, k1=3.0)
    each_refuses(
        ("solver", "another solid or lattice", lambda: asp.press(line, solid, load=1.0, solver=Multigrid())),
        ("max_cycles", "-1", lambda: Multigrid(max_cycles=-1)),
    )
    assert_equilibrium(asp.press(line, solid, load=1.0), k0=1.0, k1=3.0, load=1.0)
    bed = asp.solids.spring_lattice(k0=0.0, k1=3.0)
    assert_equilibrium(asp.press(uncorrelated(16), bed, load=1.0), k0=0.0, k1=3.0, load=1.0)


@pytest.mark.parametrize("shape", [(64, 48), (57, 61)])
def test_mirrors_cost_few_cycles(shape):
    heights = uncorrelated(64)[: shape[0], : shape[1]]
    solid = asp.solids.spring_lattice(k0=1.0, k1=3.0)
    periodic = asp.surfaces.Surface(heights.copy())
    cycles = []
    for surface in (periodic, replace(periodic, edges="reflecting")):
        contact = asp.press(surface, solid, load=0.02 * heights.size, solver=Multigrid(max_cycles=25))
        history = asp.age(contact, np.geomspace(0.1, 1e4, 6), solver=Multigrid(max_cycles=25))
        cycles.append(
            [contact.iterations, asp.relax(contact).iterations, history.dataset["iterations"].sum()]
        )
    assert np.max(np.array(cycles[1]) / cycles[0]) < 1.3
