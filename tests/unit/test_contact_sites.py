"""Contacts of few sites, solved for the forces there: against the whole lattice, and a dense matrix."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from asperity.contact import ActiveSet, active_set
from asperity.contact.contact_sites import _CloseSites, _Kernel, solved_on_contacts
from asperity.contact.problem import TOLERANCE, Guess
from asperity.lattice import Lattice
from asperity.solids import half_space, layer
from tests.problems import problem_of
from tests.surfaces import correlated

LAWS = {
    "half-space": half_space(modulus=1.0).on,
    "held half-space": half_space(modulus=1.0, apparatus=50.0).on,
    "layer": layer(modulus=1.0, thickness=6.0, poisson=0.3).on,
}


def stiffness_of(law, lattice):
    if law in LAWS:
        return LAWS[law](lattice).permanent
    one, two = lattice.angles  # no mirror symmetry
    return np.sqrt(one**2 + two**2 + one * two)


def contact_problem(law, shape=(128, 128), spacing=(), load=2e-4, crept=False, level=0.1, edges="periodic"):
    lattice = Lattice(shape, spacing, edges).embedding
    heights = 3 * correlated(max(shape), hurst=0.8)[: shape[0], : shape[1]]
    stiffness = stiffness_of(law, lattice)
    pull = stiffness * lattice.forward(0.2 * np.roll(heights, 7, axis=1)) if crept else 0 * stiffness + 0j
    held = stiffness.flat[0] > 0
    pull.flat[0] = lattice.sites * (
        -stiffness.flat[0] * level * np.ptp(heights) if held else -load * lattice.cell
    )
    return problem_of(lattice, lattice.extended(heights, -np.inf), stiffness, pull)


CASES: dict[str, dict[str, Any]] = {
    "half-space": {"law": "half-space"},
    "oblong": {"law": "half-space", "shape": (100, 144), "spacing": (1.5, 1.0)},
    "stretched": {"law": "half-space", "shape": (64, 1536), "spacing": (37.0, 0.9)},
    "odd": {"law": "half-space", "shape": (125, 131)},
    "one site": {"law": "half-space", "load": 1e-9},
    "crept": {"law": "half-space", "crept": True},
    "held": {"law": "held half-space"},
    "held and crept": {"law": "held half-space", "crept": True},
    "layer": {"law": "layer", "level": 0.02},
    "free": {"law": "half-space", "shape": (100, 128), "edges": "free"},
    "slanted": {"law": "slanted", "shape": (125, 131)},
}


@pytest.mark.parametrize("name", CASES)
def test_contacts_are_those_of_the_whole_lattice(name, monkeypatch):
    problem = contact_problem(**CASES[name])
    found = ActiveSet().solve(problem, None, TOLERANCE)
    monkeypatch.setattr(active_set, "solved_on_contacts", lambda _, guess, *__: (guess, 0))
    whole = ActiveSet().solve(problem, None, TOLERANCE)
    assert name == "stretched" or found.iterations <= 5 < whole.iterations
    np.testing.assert_array_equal(found.in_contact, whole.in_contact)
    scale = np.ptp(whole.u)
    np.testing.assert_allclose(found.u, whole.u, atol=1e-8 * scale)


@pytest.mark.parametrize("name", ["half-space", "oblong", "held", "layer"])
def test_forces_displace_other_sites_as_on_the_whole_lattice(name):
    problem = contact_problem(**CASES[name])
    lattice, stiffness = problem.lattice, problem.stiffness
    rng = np.random.default_rng(0)
    sites = rng.uniform(size=lattice.shape) < 0.02
    sites |= np.roll(sites, 1, axis=0)
    close = _CloseSites(_Kernel(lattice, stiffness, stiffness.max()), sites)
    compliance = np.divide(stiffness.max(), stiffness, out=np.zeros_like(stiffness), where=stiffness > 0)
    for force in (rng.normal(size=lattice.shape), np.ones(lattice.shape)):
        exact = lattice.apply(compliance, np.where(sites, force, 0.0))[sites]
        error = close.displacement(force[sites].astype(np.float32)) - exact
        assert np.abs(error - error.mean()).max() < 5e-3 * exact.std()


def test_crowded_or_reflected_contacts_are_left_to_other_methods():
    problem = contact_problem("half-space", load=0.1)
    crowded = Guess(np.zeros(problem.lattice.shape), problem.heights > -2.0)
    assert solved_on_contacts(problem, crowded, TOLERANCE) == (crowded, 0)
    mirrored = Lattice(problem.lattice.shape, edges="reflecting")
    few = Guess(np.zeros(problem.lattice.shape), problem.heights > -0.5)
    other = replace(problem, lattice=mirrored, stiffness=stiffness_of("half-space", mirrored))
    assert solved_on_contacts(other, few, TOLERANCE) == (few, 0)
    assert solved_on_contacts(problem, few, TOLERANCE)[1] > 1


def test_a_poor_guess_of_the_contacts_is_mended():
    problem = contact_problem("half-space")
    exact = ActiveSet().solve(problem, None, TOLERANCE)
    poor = Guess(np.zeros(problem.lattice.shape), np.roll(exact.in_contact, 20, axis=0))
    found = ActiveSet().solve(problem, poor, TOLERANCE)
    np.testing.assert_array_equal(found.in_contact, exact.in_contact)
