"""Sums over branches against numpy, and branches that go to sites only when they are asked for."""

import pickle

import numpy as np
import pytest

import asperity as asp
from asperity.contact import branches, state
from asperity.errors import ConvergenceError
from tests.surfaces import correlated


@pytest.mark.parametrize("shape", [(3, 5, 4), (2, 6), (0, 4)])
@pytest.mark.parametrize("kind", [float, complex])
def test_sums_over_branches_are_those_of_numpy(shape, kind):
    rng = np.random.default_rng(0)
    spectra, unit = rng.random(shape), 1 if kind is float else 1 - 2j
    modes, stretch = unit * rng.normal(size=(2, *shape))
    u = unit * rng.normal(size=shape[1:])
    np.testing.assert_allclose(branches.weighted_sum(spectra, modes), (spectra * modes).sum(axis=0))
    power = (spectra * np.abs(modes) ** 2).sum(axis=0)
    np.testing.assert_allclose(branches.weighted_power(spectra, modes), power)
    expected = modes + (0.5 - 2 * spectra) * stretch
    branches.add_creep(modes, 0.5, -2.0, spectra, stretch)
    np.testing.assert_allclose(modes, expected)
    branches.damp_difference(spectra, u, modes)
    np.testing.assert_allclose(modes, spectra * (u - expected))


def aged(*, exact=False, edges="periodic", apparatus=None):
    branches = [(0.3, 0.1), (0.5, 2.0)]
    solid = asp.solids.half_space(modulus=1.0, branches=branches, apparatus=apparatus)
    contact = asp.press(asp.surfaces.Surface(correlated(32), edges=edges), solid, load=20.0)
    return asp.age(contact, [1.0], exact=exact, hold="separation" if apparatus else None).final


WAYS = [{}, {"exact": True}, {"edges": "reflecting"}, {"apparatus": 30.0}]


@pytest.mark.parametrize("way", WAYS)
def test_branches_asked_for_late_are_in_equilibrium_with_the_surface(way):
    contact = aged(**way)
    system = contact.system()
    u, stretch = contact.u - system.datum, contact.u - contact.anchors
    force = system.force(u, stretch, contact.separation - system.datum)
    assert np.abs(force[~contact.in_contact]).max() <= 1e-8 * contact.residual_scale
    np.testing.assert_allclose(force[contact.in_contact], contact.force[contact.in_contact], rtol=1e-7)
    energy = system.energy(u, stretch, contact.separation - system.datum)
    assert contact.energy == pytest.approx(energy, rel=1e-9)
    assert contact.anchors is contact.anchors
    assert not contact.anchors.flags.writeable


def test_branches_asked_for_late_are_judged(monkeypatch):
    contact = aged()
    monkeypatch.setattr(state, "ACCEPTED_RESIDUAL", 1e-18)
    with pytest.raises(ConvergenceError, match="after rounding"):
        _ = contact.anchors


def test_branches_nobody_asked_for_survive_a_pickle():
    contact = aged()
    again = pickle.loads(pickle.dumps(contact))
    np.testing.assert_array_equal(again.anchors, aged().anchors)
    assert not again.anchors.flags.writeable
