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
PARTS: dict[str, Any] = {"expected": "a number", "got": np.float64(-1), "advice": "800.0"}
OF_ARGUMENTS = (errors.InputError, errors.CallError, errors.SurfaceFileError, errors.CheckpointError)
OF_MACHINES = (errors.MissingExtraError, errors.ConvergenceError, errors.OutputError, errors.TooLargeError)
RAISED: dict[type[errors.AsperityError], errors.AsperityError] = {
    errors.AsperityError: errors.AsperityError("something"),
    **{kind: kind("load", **PARTS) for kind in OF_ARGUMENTS},
    errors.ConfigError: errors.ConfigError(["a", "b"]),
    **{kind: kind("install it") for kind in OF_MACHINES},
    errors.PulledOff: errors.PulledOff(-2.0),
}


@pytest.mark.parametrize("way", WAYS)
def test_every_error_survives_with_its_parts(way: Callable[[Any], Any]) -> None:
    assert {kind.__name__ for kind in RAISED} == set(errors.__all__)
    for kind, error in RAISED.items():
        error.add_note("in run 7")
        again = way(error)
        assert type(again) is kind
        assert (str(again), again.args, vars(again)) == (str(error), error.args, vars(error))
    error = way(RAISED[errors.InputError])
    assert (error.name, error.expected, error.got, error.advice) == ("load", "a number", "-1.0", "800.0")
    assert str(error) == "load: expected a number, got -1.0; try 800.0"
    config = way(RAISED[errors.ConfigError])
    assert (str(config), config.problems) == ("a; b", ["a", "b"])


@pytest.mark.parametrize("way", WAYS)
def test_solids_and_solvers_survive(way: Callable[[Any], Any]) -> None:
    for solid in (SOLID, asp.solids.half_space(modulus=2.0, branches=[(0.5, 1.0)])):
        assert way(solid) == solid
        assert hash(way(solid)) == hash(solid)
    solver = asp.Multigrid(max_cycles=30)
    contact = asp.press(uncorrelated(16), SOLID, load=20.0, solver=solver)
    again = way(solver)  # without the work of the press
    assert again == solver
    assert again.max_cycles == 30
    pressed = asp.press(uncorrelated(16), SOLID, load=20.0, solver=again)
    np.testing.assert_array_equal(pressed.u, contact.u)


@pytest.mark.parametrize("way", WAYS[1:])
def test_a_contact_survives_and_stays_closed(way: Callable[[Any], Any]) -> None:
    contact = asp.press(uncorrelated(8), SOLID, load=5.0)
    again = way(contact)
    for name in ("heights", "u", "u0", "force", "in_contact"):
        field = getattr(again, name)
        np.testing.assert_array_equal(field, getattr(contact, name))
        with pytest.raises(ValueError, match="read-only"):
            field[0, 0] = 1
    first, second = (asp.age(start, [1.0]) for start in (contact, again))
    assert way(first).dataset.identical(second.dataset)
