"""Springs that no others join (k0 = 0) on maps: cycles against the equations and dense matrices."""

from copy import deepcopy

import numpy as np
import pytest

import asperity as asp
from asperity.aging import creep
from asperity.aging.spring_steps import SpringSteps
from asperity.contact.multigrid import IndependentSprings, Multigrid
from asperity.contact.multigrid.loops import Sites
from asperity.contact.multigrid.processor import Processor
from asperity.lattice import Lattice
from tests.surfaces import correlated


def laplacian(shape, mirrored):
    """Minus the Laplacian as a matrix."""
    lattice = Lattice(shape, edges="reflecting" if mirrored else "periodic")
    sites = np.eye(lattice.sites).reshape(-1, *shape)
    return np.array([lattice.apply(lattice.lam, site).ravel() for site in sites])


def begun(seed, shape, mirrored, held, spread, drag):
    """A stage: its work space, the least f, the least e and c, as vectors."""
    rng = np.random.default_rng(seed)
    work = IndependentSprings(Sites(shape[0], shape[1], mirrored), Processor())
    work.prepare(np.inf, spread, drag)
    touching = rng.random(shape) < 0.4
    w = np.where(touching, rng.random(shape), 0.0)
    gap = np.where(touching, 0.0, rng.random(shape))
    c = 0.3 * rng.normal(size=shape)
    packed = work.backend.packed
    work.bound.fill(-np.inf)
    for field, values in ((work.bound, -gap), (work.source.e, -w), (work.source.f, c)):
        field[...] = np.where(packed(np.ones(shape)) > 0, packed(values), field)
    work.known_stretch = w.sum()
    work.wanted = None if held else 0.05 * w.sum()
    return work, -w.ravel(), -gap.ravel(), c.ravel()


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize(("shape", "mirrored"), [((16, 12), False), ((11, 13), False), ((9, 14), True)])
@pytest.mark.parametrize(("spread", "drag"), [(0.0, 1.0), (0.01, 0.0), (1.0, 0.5), (300.0, 0.0)])
def test_a_stage_is_what_its_equations_say(shape, mirrored, held, spread, drag):
    work, least, bound, c = begun(1, shape, mirrored, held, spread, drag)
    done, cycles = work.improve(1e-7, 40)
    assert done
    assert cycles < 25
    e, f = (work.backend.unpacked(field, work.sites).ravel() for field in work.correction)
    matrix = (1 + drag) * np.eye(f.size) + spread * laplacian(shape, mirrored)
    left = matrix @ f - e - c - work.shift
    assert np.abs(left).max() < 1e-4 * max(1.0, spread)
    assert (f >= least - 1e-6).all()
    assert (e >= bound - 1e-4 * max(1.0, spread)).all()
    assert np.minimum(f - least, e - bound).max() < 1e-6  # contact, or no force
    if held:
        assert work.shift == 0
    else:
        assert f.sum() == pytest.approx(work.wanted, abs=1e-3 * abs(work.known_stretch))


@pytest.mark.parametrize("spread", [1.0, 1e4, 1e8, 1e17, 1e30])
def test_the_coarsest_grid_is_solved_however_far_creep_spreads(spread):
    work = IndependentSprings(Sites(20, 34, False), Processor())
    work.prepare(np.inf, spread, 0.5)
    work.set_pins(work.correction.f, work.correction.f - 1, 0)
    grid = work.hierarchy.grids[-1]
    cells = grid.areas.ravel()
    np.testing.assert_allclose(work.coarsest @ cells, spread / 1.5, rtol=1e-12)
    stiffness = grid.laplacian + 1.5 / spread * np.diag(cells)
    np.testing.assert_allclose(work.coarsest @ stiffness, np.eye(cells.size), atol=1e-14 * (1e3 + spread))


@pytest.mark.parametrize("control", [{"load": 2e4}, {"separation": -20.0}])
@pytest.mark.parametrize("last", [1e6, 1e12, 1e18, 1e28])
def test_springs_that_all_touch_end_up_alike(control, last):
    contact = asp.press(correlated(24, seed=8), asp.solids.spring_lattice(k0=0.0, k1=1.5, R=1.0), **control)
    assert contact.in_contact.all()
    final = asp.age(contact, [1e-3 * last, last]).final
    np.testing.assert_allclose(final.force, contact.force.mean(), rtol=1e-3)
    assert final.load == pytest.approx(contact.load, rel=1e-3)  # creep on no base keeps the mean


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize(("spread", "drag"), [(0.1, 0.0), (3.0, 0.5), (100.0, 0.0)])
def test_what_is_left_of_an_error_is_estimated(held, spread, drag):
    shape = (16, 12)
    work, least, _, _ = begun(2, shape, False, held, spread, drag)
    assert work.improve(1e-6, 40)[0]
    touching = work.backend.unpacked(work.correction.f, work.sites).ravel() > least
    error = np.random.default_rng(3).normal(size=shape)
    matrix = (1 + drag) * np.eye(error.size) + spread * laplacian(shape, False)
    own = matrix[np.ix_(touching, touching)]
    found, even = (np.linalg.solve(own, x[touching]) for x in (-error.ravel(), np.ones(error.size)))
    f = np.zeros(error.size)
    f[touching] = found if held else found - even * found.sum() / even.sum()
    left = np.where(touching, -f, error.ravel() + matrix @ f)
    expected = np.sqrt(np.mean(left**2)) if held else left.std()
    assert work.left_of(error.astype(np.float32), spread, drag) == pytest.approx(expected, rel=0.25)


@pytest.mark.parametrize("control", [{"load": 20.0}, {"separation": 1.2}])
def test_springs_pressed_bear_what_each_is_compressed_by(control):
    heights = np.random.default_rng(4).normal(size=(21, 18))
    contact = asp.press(heights, asp.solids.spring_lattice(k0=0.0, k1=2.5), **control)
    force = 2.5 * np.maximum(heights - contact.separation, 0.0)
    np.testing.assert_allclose(contact.force, force, atol=1e-12 * force.max())
    np.testing.assert_array_equal(contact.in_contact, force > 0)
    assert force.sum() == pytest.approx(contact.load, rel=1e-12)


@pytest.mark.parametrize("edges", ["periodic", "reflecting"])
@pytest.mark.parametrize("control", [{"load": 20.0}, {"separation": 1.2}])
@pytest.mark.parametrize("mobilities", [(1.0, 0.0), (1.0, 0.2), (0.0, 1.0)])
def test_histories_are_those_of_the_fourier_solver(edges, control, mobilities):
    rough = asp.surfaces.Surface(np.random.default_rng(2).normal(size=(24, 21)), edges=edges)
    solid = asp.solids.spring_lattice(k0=0.0, k1=2.0, R=mobilities[0], R_viscous=mobilities[1])
    contact, times = asp.press(rough, solid, **control), np.geomspace(1e-2, 1e3, 6)
    found, other = (
        list(creep(contact, times, rtol=2e-4, solver=solver)) for solver in (Multigrid(), asp.ActiveSet())
    )
    scale = 0.0
    for one, two in zip(found, other, strict=True):
        assert one.contact.residual < 1e-9
        if two.contact.load > 1e-3 * contact.load:  # less dies out
            assert np.count_nonzero(one.contact.in_contact ^ two.contact.in_contact) <= 2
        scale = max(scale, float(two.contact.u.std()))
        error = one.contact.anchors - two.contact.anchors
        assert (error - error.mean()).std() < 2e-4 * scale
        assert one.contact.load == pytest.approx(two.contact.load, abs=1e-3 * contact.load)


def test_a_march_goes_on_to_the_last_bit():
    contact = asp.press(
        np.random.default_rng(5).normal(size=(20, 20)), asp.solids.spring_lattice(k0=0.0, k1=3.0), load=30.0
    )
    states, times = [], [0.1, 1.0, 10.0]
    frames = list(creep(contact, times, after_step=lambda state: states.append(deepcopy(state))))
    resumed = list(creep(contact, times, midway=states[len(states) // 2]))
    np.testing.assert_array_equal(resumed[-1].contact.anchors, frames[-1].contact.anchors)
    assert resumed[-1].contact.separation == frames[-1].contact.separation


def test_nine_decades_take_few_cycles(monkeypatch):
    heights, steps = np.random.default_rng(6).normal(size=(64, 64)), []
    solve = SpringSteps.attempt

    def counted(self, *values):
        steps.append(self)
        return solve(self, *values)

    monkeypatch.setattr(SpringSteps, "attempt", counted)
    contact = asp.press(heights, asp.solids.spring_lattice(k0=0.0, k1=3.0), load=0.06 * heights.size)
    history = asp.age(contact, np.geomspace(1e-3, 1e6, 37)).dataset
    assert history["area"].values[-1] == heights.size
    assert len(steps) < 135  # 110
    assert int(history["iterations"].sum()) < 4.5 * len(steps)
