"""Solvers that are tried one after the other, and which of them solved."""

import numpy as np
import pytest

import asperity as asp
from asperity.contact import ActiveSet, Multigrid
from asperity.contact.problem import TOLERANCE


@pytest.mark.parametrize(("max_cycles", "solver"), [(40, "Cycles"), (0, "ActiveSet"), (2, "ActiveSet")])
def test_the_solution_says_who_solved(max_cycles, solver):
    rough = np.random.default_rng(0).normal(size=(32, 32))
    contact = asp.press(rough, asp.solids.spring_lattice(k0=1.0, k1=3.0), load=30.0)
    system = contact.system()
    problem = system.problem(system.mechanics.implicit_step(0.0), 0.0)
    found = Multigrid(max_cycles=max_cycles).solve(problem, None, TOLERANCE)
    alone = ActiveSet().solve(problem, None, TOLERANCE)
    assert found.solver == solver
    assert found.iterations >= max_cycles or solver == "Cycles"
    np.testing.assert_array_equal(found.in_contact, alone.in_contact)
