"""Texts with units in Python: the same numbers as plain ones in SI, and a refusal where nothing has units."""

from __future__ import annotations

from typing import Any

import numpy as np
import pint
import pytest

from asperity import Contact, age, press
from asperity.base.units import quantity
from asperity.protocols import Hold, Ramp, Repeat, Step
from asperity.solids import Solid, coated_half_space, half_space, layer, spring_lattice
from asperity.surfaces import Surface, gaussian
from tests.refusals import refuses

SCAN = Surface(gaussian((16, 16)), unit="um", pixel_size=(2.0, 2.0), length_unit="um")
RIDGES = Surface(gaussian((32,)), unit="um", pixel_size=(2.0,), length_unit="um")
BARE = gaussian((16, 16))
HALF_SPACE = half_space(modulus=3e9, branches=[(0.3, 1e-2), (0.2, 60.0)])
PAIRS: list[tuple[Solid, Solid]] = [
    (HALF_SPACE, half_space(modulus="3 GPa", branches=[(0.3, "10 ms"), (0.2, "1 min")])),
    (half_space(modulus=3e9, apparatus=1e6), half_space(modulus="3000 MPa", apparatus="1 MN/m")),
    (layer(modulus=3e9, poisson=0.3, thickness=4e-6), layer(modulus="3 GPa", poisson=0.3, thickness="4 um")),
    (
        coated_half_space(modulus=3e9, poisson=0.3, thickness=4e-6, base_modulus=1e10, base_poisson=0.2),
        coated_half_space(
            modulus="3 GPa", poisson=0.3, thickness="4 µm", base_modulus="10 GPa", base_poisson=0.2
        ),
    ),
]


def same(one: Contact, other: Contact) -> None:
    np.testing.assert_array_equal(one.u, other.u)
    assert one.load == other.load


@pytest.mark.parametrize(("plain", "written"), PAIRS, ids=["relaxing", "machine", "layer", "film"])
def test_solids_take_units(plain: Solid, written: Solid) -> None:
    assert written == plain
    same(press(SCAN, written, pressure=1e7), press(SCAN, plain, pressure=1e7))
    with refuses("units"):
        press(BARE, written, load=1.0)


def test_loads_pressures_and_separations_take_units() -> None:
    same(press(SCAN, HALF_SPACE, load="10 mN"), press(SCAN, HALF_SPACE, load=0.01))
    same(press(SCAN, HALF_SPACE, pressure="10 MPa"), press(SCAN, HALF_SPACE, pressure=1e7))
    machine = PAIRS[1][0]
    same(press(SCAN, machine, separation="1 um"), press(SCAN, machine, separation=1e-6))
    same(press(RIDGES, HALF_SPACE, load="2 kN/m"), press(RIDGES, HALF_SPACE, load=2000.0))
    aged = press(SCAN, HALF_SPACE, load=0.01)
    same(press(aged, load="20 mN"), press(aged, load=0.02))


def test_quantities_of_pint_are_texts_with_units() -> None:
    of: Any = pint.UnitRegistry().Quantity
    same(press(SCAN, HALF_SPACE, load=of(10, "mN")), press(SCAN, HALF_SPACE, load=0.01))
    same(press(SCAN, HALF_SPACE, pressure=of(1, "kgf/mm^2")), press(SCAN, HALF_SPACE, pressure=9806650.0))
    assert half_space(modulus=of(3, "GPa")) == half_space(modulus=3e9)
    assert quantity(of(5, "kg") * of(2e-3, "m/s^2"), "N") == pytest.approx(0.01)
    held = press(SCAN, half_space(modulus=3e9, branches=[(0.5, of(2, "ms"))]), load=0.01)
    aged = age(held, [of(1, "ms"), of(1, "min")], protocol=[Hold(of(1, "s")), Ramp(59, load=of(20, "mN"))])
    np.testing.assert_allclose(aged.time, [0, 1e-3, 1, 60])
    assert float(aged.load[-1]) == pytest.approx(0.02, rel=1e-12)
    scan = Surface(BARE, unit="um", pixel_size=(of(2, "um"), of(2000, "nm")))
    assert (scan.pixel_size, scan.length_unit) == (SCAN.pixel_size, "um")
    assert quantity(of(0.5, "1/GPa"), "1/Pa") == pytest.approx(5e-10)
    assert quantity(of(25, "degC"), "K") == pytest.approx(298.15)
    both = press(SCAN, HALF_SPACE, load=of([5, 10], "mN"))
    np.testing.assert_allclose([one.load for one in both], [0.005, 0.01])
    np.testing.assert_allclose(age(both[0], of([1, 2], "ms")).time, [0, 1e-3, 2e-3])
    with refuses("load"):
        press(SCAN, HALF_SPACE, load=of(10, "MPa"))
    with refuses("units"):
        press(BARE, HALF_SPACE, load=of(1, "N"))


def test_units_are_refused_where_there_are_none_and_others_than_expected() -> None:
    for wrong in ("10 MPa", "ten N", "5", "10 mN 5"):
        with refuses("load"):
            press(SCAN, HALF_SPACE, load=wrong)
    with refuses("units"):
        press(BARE, HALF_SPACE, load="1 N")
    with refuses("units"):
        press(SCAN, spring_lattice(k0=1.0, k1=3.0), load="1 N")
    plain = press(BARE, HALF_SPACE, load=1e6)
    with refuses("units"):
        age(plain, ["1 s", "1 min"])
    with refuses("units"):
        age(plain, [1.0], protocol=[Repeat((Hold("1 min"),), 2)])  # type: ignore[arg-type]
    with refuses("load"):
        press(RIDGES, HALF_SPACE, load="1 N")
    with refuses("load"):
        age(press(RIDGES, HALF_SPACE, load=2000.0), [1.0], protocol=[Step(load="1 N")])  # type: ignore[arg-type]


def test_times_and_legs_take_units() -> None:
    contact = press(SCAN, HALF_SPACE, load=0.01)
    written = age(contact, ["10 ms", "1 s", "2 min"], fields_at="1 s")
    plain = age(contact, [0.01, 1.0, 120.0], fields_at=[1.0])
    assert written.dataset.identical(plain.dataset)
    legs = [Hold("1 min"), Ramp("10 s", load="20 mN"), Step(load="5 mN"), Hold("1 s")]  # type: ignore[arg-type]
    plain_legs = [Hold(60.0), Ramp(10.0, load=0.02), Step(load=0.005), Hold(1.0)]
    assert legs == plain_legs
    written = age(contact, "30 s", protocol=legs)
    assert written.dataset.identical(age(contact, [30.0], protocol=plain_legs).dataset)
    with refuses("times"):
        age(contact, ["10 m"])
    with refuses("times"):
        age(contact, ["10 s", "soon"])
