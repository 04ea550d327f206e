"""Errors, solids, contacts and solvers survive pickling and copying: pools of processes need it."""

import copy
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity import errors
from tests.surfaces import uncorrelated

SOLID = asp.solids.spring_lattice(k0=1.0, k1=3.0)
WAYS = [copy.copy, copy.deepcopy, lambda thing: pickle.loads(pickle.dumps(thing))]


def input_error(kind: type[errors.InputError]) -> errors.InputError:
    return kind("load", expected="a number", got=np.float64(-1), advice="800.0")


RAISED: dict[type[errors.AsperityError], errors.AsperityError] = {
    errors.AsperityError: errors.AsperityError("something"),
    errors.InputError: input_error(errors.InputError),
    errors.SurfaceFileError: input_error(errors.SurfaceFileError),
    errors.CheckpointError: input_error(errors.CheckpointError),
    errors.ConfigError: errors.ConfigError(["a", "b"]),
    errors.MissingExtraError: errors.MissingExtraError("install it"),
    errors.ConvergenceError: errors.ConvergenceError("stopped"),
    errors.OutputError: errors.OutputError("disk full"),
}


@pytest.mark.parametrize("way", WAYS)
def test_every_error_survives(way: Callable[[Any], Any]) -> None:
    assert {kind.__name__ for kind in RAISED} == set(errors.__all__)
    for kind, error in RAISED.items():
        error.add_note("in run 7")
        again = way(error)
        assert type(again) is kind
        assert (str(again), again.args, vars(again)) == (str(error), error.args, vars(error))


def test_errors_carry_their_parts() -> None:
    error = input_error(errors.InputError)
    assert (error.name, error.expected, error.got, error.advice) == ("load", "a number", "-1.0", "800.0")
    assert str(error) == "load: expected a number, got -1.0; try 800.0"
    config = errors.ConfigError(["a", "b"])
    assert (str(config), config.problems) == ("a; b", ["a", "b"])


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(
    "solid", [SOLID, asp.solids.half_space(modulus=2.0, branches=[(0.5, 1.0)])], ids=lambda solid: solid.kind
)
def test_solids_survive_and_have_a_hash(way: Callable[[Any], Any], solid: asp.solids.Solid) -> None:
    again = way(solid)
    assert again == solid
    assert hash(again) == hash(solid)


def test_a_solid_has_a_short_repr() -> None:
    assert repr(SOLID) == "<Solid: spring_lattice, k0 1, k1 3, R 1, R_viscous 0>"
    own = asp.solids.Solid(SOLID.permanent, SOLID.branches)
    assert asp.solids.Solid(SOLID.permanent, SOLID.branches, SOLID.parameters) == SOLID
    assert repr(own) == "<Solid: of own spectra>"
    assert repr(asp.theory.EmpiricalHeights(np.zeros(10**4))) == "EmpiricalHeights(10000 heights)"


@pytest.mark.parametrize("way", WAYS[1:])
def test_a_contact_survives_and_stays_closed(way: Callable[[Any], Any]) -> None:
    contact = asp.press(uncorrelated(8), SOLID, load=5.0)
    again = way(contact)
    assert repr(again) == repr(contact)
    for name in ("heights", "u", "u0", "force", "in_contact"):
        field = getattr(again, name)
        np.testing.assert_array_equal(field, getattr(contact, name))
        with pytest.raises(ValueError, match="read-only"):
            field[0, 0] = 1
    first, second = (asp.age(start, [1.0]) for start in (contact, again))
    assert way(first).dataset.identical(second.dataset)


@pytest.mark.parametrize("way", WAYS)
def test_a_used_multigrid_survives_without_its_work(way: Callable[[Any], Any]) -> None:
    solver = asp.Multigrid(max_cycles=30)
    contact = asp.press(uncorrelated(16), SOLID, load=20.0, solver=solver)
    again = way(solver)
    assert again == solver
    assert again.max_cycles == 30
    pressed = asp.press(uncorrelated(16), SOLID, load=20.0, solver=again)
    np.testing.assert_array_equal(pressed.u, contact.u)
