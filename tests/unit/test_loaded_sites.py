"""Independent springs (k0 = 0) on maps, solved for contact forces, against dense matrices and histories."""

import numpy as np
import pytest

import asperity as asp
from asperity.aging import step_errors
from asperity.contact import active_set
from asperity.contact.free_sites import Accuracy
from asperity.contact.loaded_sites import LoadedSites
from asperity.contact.problem import SpringLaw
from asperity.lattice import Lattice


def test_displacements_are_those_of_dense_matrices():
    rng = np.random.default_rng(0)
    tried = 0
    for number in range(150):
        shape = tuple(int(n) for n in rng.integers(1, 9, size=2))
        lattice = Lattice(shape, edges="reflecting" if number % 2 else "periodic")
        k1, lag = 10 ** rng.uniform(-3, 3), 1 + rng.choice([0.0, 10 ** rng.uniform(-6, 4)])
        spread = rng.choice([0.0, 10 ** rng.uniform(-6, 6)])
        stiffness = k1 / (lag + spread * lattice.lam)
        stiffness[0, 0] = rng.choice([0.0, k1 / lag])
        in_contact = rng.random(shape) < rng.random()
        in_contact.flat[rng.integers(in_contact.size)] = True
        free = ~in_contact.ravel()
        sites = np.eye(lattice.sites).reshape(-1, *shape)
        matrix = np.array([lattice.apply(stiffness, site).ravel() for site in sites])
        own = matrix[np.ix_(free, free)]
        if not free.any() or np.linalg.cond(own) > 1e6:
            continue
        force, wanted = rng.normal(size=shape), np.zeros(lattice.sites)
        wanted[free] = np.linalg.solve(own, -force.ravel()[free])
        law = SpringLaw(0.0, k1, lag, spread, float(stiffness[0, 0]))
        worst = float(abs(force[~in_contact]).max())
        found = LoadedSites(lattice, law, in_contact).correct(
            force, worst, Accuracy(goal=1e-13, imbalance=0.1, most=1, patience=1)
        )
        np.testing.assert_allclose(found.displacement.ravel(), wanted, atol=1e-8 * abs(wanted).max())
        after = force.ravel() + matrix @ wanted
        np.testing.assert_allclose(found.force.ravel(), after, atol=1e-8 * abs(after).max())
        tried += 1
    assert tried > 80


@pytest.mark.parametrize("edges", ["periodic", "reflecting"])
@pytest.mark.parametrize("control", [{"load": 20.0}, {"separation": 1.2}])
@pytest.mark.parametrize("creep", [(1.0, 0.2), (0.0, 1.0)])
def test_histories_are_those_of_conjugate_gradients(edges, control, creep, monkeypatch):
    rough = asp.surfaces.Surface(np.random.default_rng(2).normal(size=(12, 13)), edges=edges)
    solid = asp.solids.spring_lattice(k0=0.0, k1=2.0, R=creep[0], R_viscous=creep[1])

    def history():
        contact = asp.press(rough, solid, **control)
        frames: list[asp.Frame] = []
        times, solver = np.geomspace(1e-2, 10, 4), asp.ActiveSet()
        return asp.age(contact, times, progress=frames.append, solver=solver), frames

    direct, frames = history()
    solutions = sum(frame.iterations for frame in frames)
    for module in (active_set, step_errors):
        monkeypatch.setattr(module, "spring_sites", lambda *_: None)
    other, frames = history()
    assert solutions < sum(frame.iterations for frame in frames)
    assert direct["residual"].max() < 1e-8
    np.testing.assert_allclose(direct["area"], other["area"], atol=2)
    np.testing.assert_allclose(direct["separation"], other["separation"], rtol=1e-3)
    np.testing.assert_allclose(direct["load"], other["load"], rtol=1e-3)


@pytest.mark.parametrize("load", [4.0, 400.0])
def test_linear_solutions_are_few(load):
    axis = np.arange(40) - 20.0
    ball = asp.surfaces.Surface(-(axis[:, np.newaxis] ** 2 + axis**2) / 20)
    frames: list[asp.Frame] = []
    contact = asp.press(ball, asp.solids.spring_lattice(k0=0.0, k1=1.0), load=load)
    asp.age(contact, [1.0, 10.0, 100.0], progress=frames.append, solver=asp.ActiveSet())
    steps = sum(frame.steps + frame.rejected for frame in frames)
    assert sum(frame.iterations for frame in frames) < 12 * steps  # conjugate gradients need 40
