"""Bad input at the doors of press, age and relax: one clear line, and nothing computed.

What is no number of its kind is given to every public function in `test_public_calls`.
"""

from datetime import timedelta

import numpy as np
import pytest
import xarray as xr

import asperity as asp
from asperity.errors import ConvergenceError
from tests.refusals import refuses
from tests.surfaces import uncorrelated

ROUGH = uncorrelated(8)
SOLID = asp.solids.spring_lattice(k0=1.0, k1=3.0)
CONTACT = asp.press(ROUGH, SOLID, load=5.0)


class Quantity(float):
    """As those of pint: a number with a unit, and an array without."""

    magnitude = 3.0

    def __str__(self):
        return f"{self.magnitude} newton"

    def __array__(self, *_, **__):
        raise AssertionError("the unit was dropped")


@pytest.mark.parametrize(
    "heights",
    [
        np.where(ROUGH.max() == ROUGH, np.nan, ROUGH),
        np.where(ROUGH.max() == ROUGH, np.inf, ROUGH),
        ROUGH + 1j,
        np.zeros((0, 4)),
        np.zeros((2, 2, 2)),
        1.0,
    ],
)
def test_heights(heights):
    with refuses("heights"):
        asp.press(heights, SOLID, load=1.0)


@pytest.mark.parametrize("load", [-3.0, 1e-300, 1e308])
def test_loads_that_are_no_load(load):
    with refuses("load"):
        asp.press(ROUGH, SOLID, load=load)


def test_both_or_neither_of_load_and_separation():
    with refuses("load, pressure and separation"):
        asp.press(ROUGH, SOLID, load=1.0, separation=0.0)
    with refuses("load, pressure and separation"):
        asp.press(ROUGH, SOLID)


@pytest.mark.parametrize(
    "load",
    [
        xr.DataArray([[1.0, 2.0]], dims=["leg", "time"]),
        xr.Dataset({"load": 1.0}).load,
        np.timedelta64(3, "s"),
        np.float32("nan"),
        10**400,
        10**5000,
        [[1.0] * 1000],
        Quantity(3.0),
    ],
    ids=range(8),
)
def test_what_was_given_is_shown_in_few_characters(load):
    with refuses("load") as refused:
        asp.press(ROUGH, SOLID, load=load)
    assert len(str(refused.value)) < 150


def test_quantities_are_no_arrays():
    with refuses("heights"):
        asp.press(Quantity(3.0), SOLID, load=1.0)


@pytest.mark.parametrize("solid", [None, {}, ROUGH, asp.solids.Solid])
def test_solids_that_are_none(solid):
    with refuses("solid"):
        asp.press(ROUGH, solid, load=1.0)


@pytest.mark.parametrize("solver", ["fast", asp.Multigrid, object()])
def test_solvers_that_solve_nothing(solver):
    for call in (
        lambda: asp.press(ROUGH, SOLID, load=1.0, solver=solver),
        lambda: asp.age(CONTACT, [1.0], solver=solver),
        lambda: asp.relax(CONTACT, solver=solver),
    ):
        with refuses("solver"):
            call()


def test_a_load_that_no_state_can_carry():
    membrane = asp.solids.spring_lattice(k0=1.0, k1=0.0)
    with refuses("creeping stiffness"):
        asp.press(ROUGH, membrane, load=1.0)


@pytest.mark.parametrize("load", [1e-20, 1e-30, 1e-99])
def test_a_load_too_small_for_double_precision(load):
    with refuses(kind=ConvergenceError):
        asp.press(ROUGH, SOLID, load=load)


def test_heights_too_large_to_compute_with():
    with refuses("heights"):
        asp.press(1e200 * ROUGH, SOLID, load=1.0)


@pytest.mark.parametrize(
    "times",
    [
        [1.0, 0.5],
        [1.0, 1.0],
        [-1.0, 1.0],
        [],
        [timedelta(hours=1)],
    ],
)
def test_times(times):
    with refuses("times"):
        asp.age(CONTACT, times)


@pytest.mark.parametrize("rtol", [0.0, -1.0, 1e-12, 1.0])
def test_tolerances(rtol):
    with refuses("rtol"):
        asp.age(CONTACT, [1.0], rtol=rtol)


def test_other_arguments():
    with refuses("hold"):
        asp.age(CONTACT, [1.0], hold="height")  # type: ignore[arg-type]
    separated = asp.press(ROUGH, SOLID, separation=1.0)
    with refuses("hold"):
        asp.relax(separated, hold="Load")  # type: ignore[arg-type]
    hanging = asp.press(ROUGH, SOLID, separation=ROUGH.max() + 1)
    with refuses("hold"):
        asp.age(hanging, [1.0], hold="load")
    with refuses("contact"):
        asp.age(asp.age(CONTACT, [1.0]), [1.0])  # type: ignore[arg-type]
    with refuses("fields_at"):
        asp.age(CONTACT, [1.0], fields_at=[-1.0])
    with refuses("start"):
        asp.press(ROUGH, SOLID, load=1.0, start=ROUGH)
    with refuses("start"):
        asp.press(uncorrelated(4), SOLID, load=1.0, start=CONTACT)


def test_what_is_published_cannot_be_changed():
    for field in (CONTACT.heights, CONTACT.u, CONTACT.u0, CONTACT.force, CONTACT.in_contact):
        with pytest.raises(ValueError, match="read-only"):
            field[0, 0] = 1


def test_arguments_are_not_changed():
    heights = ROUGH.copy()
    contact = asp.press(heights, SOLID, load=5.0)
    asp.age(contact, [1.0])
    np.testing.assert_array_equal(heights, ROUGH)
    heights[:] = 0
    np.testing.assert_array_equal(contact.heights, ROUGH)
