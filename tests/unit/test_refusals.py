"""Bad input at the doors of press, age and relax: one clear line, and nothing computed."""

from datetime import timedelta

import numpy as np
import pytest
import xarray as xr

import asperity as asp
from asperity.errors import ConvergenceError, InputError
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
    ("heights", "message"),
    [
        (np.where(ROUGH.max() == ROUGH, np.nan, ROUGH), "NaN"),
        (np.where(ROUGH.max() == ROUGH, np.inf, ROUGH), "infinite"),
        (np.zeros((0, 4)), "empty|shape"),
        (np.zeros((2, 2, 2)), "dimension"),
        (1.0, "dimension"),
        (np.array([["a", "b"]]), "number"),
        (ROUGH + 1j, "real"),
    ],
)
def test_heights(heights, message):
    with pytest.raises(InputError, match=message):
        asp.press(heights, SOLID, load=1.0)


@pytest.mark.parametrize("load", [0.0, -3.0, np.nan, np.inf, 1e-300, 1e308, "800", True])
def test_loads_that_are_no_load(load):
    with pytest.raises(InputError, match=r"load: expected a finite number > 0 .*, got"):
        asp.press(ROUGH, SOLID, load=load)


@pytest.mark.parametrize("separation", [np.nan, -np.inf, "1"])
def test_separations_that_are_none(separation):
    with pytest.raises(InputError, match="separation: expected a finite number, got"):
        asp.press(ROUGH, SOLID, separation=separation)


def test_both_or_neither_of_load_and_separation():
    with pytest.raises(InputError, match=r"expected exactly one of the two, got both; try load=800\.0"):
        asp.press(ROUGH, SOLID, load=1.0, separation=0.0)
    with pytest.raises(InputError, match="expected exactly one of the two, got neither"):
        asp.press(ROUGH, SOLID)


@pytest.mark.parametrize(
    ("load", "shown"),
    [
        (xr.DataArray([1.0, 2.0], dims="time"), r"DataArray of type float64, shape \(2,\)$"),
        (xr.Dataset({"load": 1.0}).load, "the method Dataset.load$"),
        (np.timedelta64(3, "s"), r"3 seconds; try load / np\.timedelta64\(1, \"s\"\)$"),
        (np.float32("nan"), "nan$"),
        (10**400, r"10{17}\.\.\.0+$"),
        (10**5000, "a huge int$"),
        ([1.0] * 1000, r"\[1\.0, 1\.0, 1\.0, 1\.0, 1\.0, 1\.0, \.\.\.\]$"),
        (Quantity(3.0), r"3\.0 newton, which has a unit; try load\.magnitude, in the unit of"),
    ],
    ids=range(8),
)
def test_what_was_given_is_shown_in_few_characters(load, shown):
    with pytest.raises(InputError, match=rf"^load: expected a finite number > 0 \(.*\), got {shown}"):
        asp.press(ROUGH, SOLID, load=load)


def test_quantities_are_no_arrays():
    with pytest.raises(InputError, match=r"heights: .*, got 3\.0 newton, which has a unit; try heights\.mag"):
        asp.press(Quantity(3.0), SOLID, load=1.0)


@pytest.mark.parametrize(
    ("solid", "got"),
    [(None, "NoneType"), ({}, "dict"), (ROUGH, "ndarray"), (asp.solids.Solid, "the class Solid")],
)
def test_solids_that_are_none(solid, got):
    with pytest.raises(
        InputError, match=rf"^solid: expected a Solid, got {got}; try asperity\.solids\.spring_l"
    ):
        asp.press(ROUGH, solid, load=1.0)


@pytest.mark.parametrize("solver", ["fast", asp.Multigrid, object()])
def test_solvers_that_solve_nothing(solver):
    for call in (
        lambda: asp.press(ROUGH, SOLID, load=1.0, solver=solver),
        lambda: asp.age(CONTACT, [1.0], solver=solver),
        lambda: asp.relax(CONTACT, solver=solver),
    ):
        with pytest.raises(InputError, match=r"^solver: expected an object that solves, got .*; try solver="):
            call()


def test_a_load_that_no_state_can_carry():
    membrane = asp.solids.spring_lattice(k0=1.0, k1=0.0)
    with pytest.raises(InputError, match="no load can be carried; try k1 > 0"):
        asp.press(ROUGH, membrane, load=1.0)


@pytest.mark.parametrize("load", [1e-20, 1e-30, 1e-99])
def test_a_load_too_small_for_double_precision(load):
    with pytest.raises(ConvergenceError, match="too small for these heights in double precision"):
        asp.press(ROUGH, SOLID, load=load)


def test_heights_too_large_to_compute_with():
    with pytest.raises(InputError, match=r"heights: expected heights up to 1e\+100"):
        asp.press(1e200 * ROUGH, SOLID, load=1.0)


@pytest.mark.parametrize(
    ("times", "message"),
    [
        ([1.0, 0.5], "strictly increasing times, got 1.0 before 0.5"),
        ([1.0, 1.0], "strictly increasing"),
        ([-1.0, 1.0], "finite times >= 0 .*, got -1"),
        ([1.0, np.inf], "finite times"),
        ([np.nan], "finite times"),
        ([], "a list of times"),
        (["soon"], "a list of times"),
        (np.array([1, 2], "timedelta64[s]"), r'try times / np\.timedelta64\(1, "s"\)$'),
        ([timedelta(hours=1)], r'try times / np\.timedelta64\(1, "s"\)$'),
    ],
)
def test_times(times, message):
    with pytest.raises(InputError, match=message):
        asp.age(CONTACT, times)


@pytest.mark.parametrize("rtol", [0.0, -1.0, 1e-12, 1.0, np.nan, "small"])
def test_tolerances(rtol):
    with pytest.raises(InputError, match=r"rtol: expected a number from 1e-06 to 0\.1, got"):
        asp.age(CONTACT, [1.0], rtol=rtol)


def test_other_arguments():
    with pytest.raises(InputError, match="hold: expected 'load', 'separation' or 'area', got 'height'"):
        asp.age(CONTACT, [1.0], hold="height")  # type: ignore[arg-type]
    separated = asp.press(ROUGH, SOLID, separation=1.0)
    with pytest.raises(InputError, match="hold: expected 'load', 'separation' or 'area', got 'Load'"):
        asp.relax(separated, hold="Load")  # type: ignore[arg-type]
    hanging = asp.press(ROUGH, SOLID, separation=ROUGH.max() + 1)
    with pytest.raises(InputError, match="hold: expected a contact that carries a load"):
        asp.age(hanging, [1.0], hold="load")
    with pytest.raises(InputError, match=r"expected a Contact, got History; try asperity\.press"):
        asp.age(asp.age(CONTACT, [1.0]), [1.0])  # type: ignore[arg-type]
    with pytest.raises(InputError, match="fields_at: expected finite times >= 0"):
        asp.age(CONTACT, [1.0], fields_at=[-1.0])
    with pytest.raises(InputError, match=r"start: expected a Contact, got ndarray"):
        asp.press(ROUGH, SOLID, load=1.0, start=ROUGH)
    with pytest.raises(InputError, match=r"start: expected a contact of shape \(4, 4\), got \(8, 8\)"):
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
