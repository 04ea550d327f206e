"""The direct solution on lines of springs against dense matrices, and against conjugate gradients."""

import numpy as np
import pytest

import asperity as asp
from asperity.contact import active_set
from asperity.contact.free_sites import Accuracy
from asperity.contact.line_sites import LineSites
from asperity.contact.problem import SpringLaw
from asperity.errors import ConvergenceError
from asperity.lattice import Lattice
from tests.refusals import refuses


def problems(count):
    """Random lines of both kinds of edges, under both controls, from no creep to long creep."""
    rng = np.random.default_rng(0)
    for _ in range(count):
        lattice = Lattice(
            (int(rng.integers(1, 40)),), edges="reflecting" if rng.random() < 0.5 else "periodic"
        )
        k0, k1 = rng.choice([0.0, 1.0]), 10 ** rng.uniform(-3, 3)
        lag = 1 + rng.choice([0.0, 10 ** rng.uniform(-6, 4)])
        spread = rng.choice([0.0, 10 ** rng.uniform(-6, 9)])
        if rng.random() < 0.1:
            k0, k1 = 1.0, 0.0  # relaxed
        stiffness = k0 * lattice.lam + k1 / (lag + spread * lattice.lam)
        stiffness[0] = rng.choice([0.0, k1 / lag if k1 else 0.7])
        in_contact = rng.random(lattice.shape) < rng.random()
        in_contact[rng.integers(in_contact.size)] = True
        yield lattice, stiffness, SpringLaw(k0, k1, lag, spread, float(stiffness[0])), in_contact, rng


def test_displacements_are_those_of_dense_matrices():
    tried = 0
    for lattice, stiffness, law, in_contact, rng in problems(300):
        free = ~in_contact
        if not free.any():
            continue
        matrix = np.array([lattice.apply(stiffness, site) for site in np.eye(lattice.sites)])
        own = matrix[np.ix_(free, free)]
        if np.linalg.cond(own) > 1e6:
            continue
        force, wanted = rng.normal(size=lattice.sites), np.zeros(lattice.sites)
        wanted[free] = np.linalg.solve(own, -force[free])
        found = LineSites(lattice, law, in_contact).correct(
            force, 1.0, Accuracy(goal=0.1, imbalance=0.1, most=1)
        )
        np.testing.assert_allclose(found.displacement, wanted, atol=1e-9 * abs(wanted).max())
        np.testing.assert_allclose(found.force, force + matrix @ wanted, atol=1e-8 * abs(force).max())
        tried += 1
    assert tried > 200


@pytest.mark.parametrize("solid", [{"k0": 1.0, "k1": 300.0}, {"k0": 0.0, "k1": 1.0}, {"k0": 1.0, "k1": 0.03}])
@pytest.mark.parametrize("edges", ["periodic", "reflecting"])
def test_histories_are_those_of_conjugate_gradients(solid, edges, monkeypatch):
    rough = np.random.default_rng(2).normal(size=157)
    surface = asp.surfaces.Surface(rough, edges=edges)

    def history():
        contact = asp.press(surface, asp.solids.spring_lattice(**solid), load=0.02 * 157)
        return asp.age(contact, np.geomspace(1e-3, 1e4, 8), rtol=5e-4)

    direct = history()
    monkeypatch.setattr(active_set, "line_sites", lambda *_: None)
    iterated = history()
    np.testing.assert_array_equal(direct["area"], iterated["area"])
    np.testing.assert_allclose(direct["energy"], iterated["energy"], rtol=1e-3)
    assert direct["iterations"].sum() < iterated["iterations"].sum() / 2
    assert direct["residual"].max() < 1e-10  # rounding; the tolerance is 1e-9


def test_free_sites_that_nothing_holds_are_refused():
    law = SpringLaw(k0=0.0, k1=0.0, lag=1.0, spread=0.0, mean=0.0)
    with refuses(kind=ConvergenceError):
        LineSites(Lattice((6,)), law, np.arange(6) == 2)
