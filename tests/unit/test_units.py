"""Numbers in words, and texts with units: the same numbers as plain ones in SI, or one clear line."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
import pint
import pytest

from asperity import Contact, age, press
from asperity.base.units import _PREFIXES, factor, quantity
from asperity.base.words import data_size, duration, thousands, uncertain
from asperity.protocols import Hold, Ramp, Repeat, Step
from asperity.solids import half_space, spring_lattice
from asperity.surfaces import Surface, gaussian
from tests.refusals import each_refuses, refuses

SCAN = Surface(gaussian((16, 16)), unit="um", pixel_size=(2.0, 2.0), length_unit="um")
RIDGES = Surface(gaussian((32,)), unit="um", pixel_size=(2.0,), length_unit="um")
BARE = gaussian((16, 16))
HALF_SPACE = half_space(modulus=3e9, branches=[(0.3, 1e-2), (0.2, 60.0)])
MACHINE = half_space(modulus=3e9, apparatus=1e6)


def same(one: Contact, other: Contact) -> None:
    np.testing.assert_array_equal(one.u, other.u)
    assert one.load == other.load


def test_numbers_in_words() -> None:
    for value, error, text in (
        (3.0612, 0.0229, "3.061 ± 0.023"),
        (55.2, 13.9, "55 ± 14"),
        (35.0, 212.0, "35 ± 200"),
        (0.5, math.inf, "0.5 (undetermined)"),
        (2.0, 0.0, "2"),
    ):
        assert uncertain(value, error) == text
    assert thousands(40000) == "40\u202f000"
    assert [data_size(n) for n in (999, 2.5e6, 2e10, 3e15)] == ["999 B", "2.5 MB", "20 GB", "3e+03 TB"]
    for seconds, text in (
        (0.26, "0.26 seconds"),
        (59.6, "60 seconds"),
        (200.0, "3.3 minutes"),
        (7260.0, "2 hours"),
        (1e6, "12 days"),
        (math.nan, "not determined"),
    ):
        assert duration(seconds) == text


def test_a_text_becomes_a_number() -> None:
    texts: list[tuple[object, str, float]] = [
        ("1 MPa", "Pa", 1e6),
        ("1MPa", "Pa", 1e6),
        ("2.5e-1 GPa", "Pa", 2.5e8),
        ("3 N/mm^2", "Pa", 3e6),
        ("3 N/mm2", "Pa", 3e6),
        ("-4 mN", "N", -4e-3),
        ("2 h", "s", 7200.0),
        ("1.5 µm", "m", 1.5e-6),
        ("25 degC", "K", 298.15),
        ("80 kJ/mol", "J/mol", 80e3),
        ("50 mJ/m²", "J/m^2", 0.05),
        (" .5 ", "Pa", 0.5),
        (4, "Pa", 4.0),
    ]
    for text, unit, value in texts:
        found = quantity(text, unit)
        assert type(found) is float
        assert found == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(
    "unit", ["Pa", "N", "m", "s", "m/s", "Hz", "J", "K", "J/mol", "J/m^2", "ohm m", "W/m/K"]
)
def test_prefixes_are_those_of_pint_to_the_last_bit(unit: str) -> None:
    registry: pint.UnitRegistry[Any] = pint.UnitRegistry()
    random = np.random.default_rng(0)
    for prefix in _PREFIXES:
        for amount in (1.0, 0.3, *random.lognormal(0, 10, 20).tolist()):
            expected = registry.Quantity(amount, f"{prefix}{unit}").to(unit).magnitude
            assert quantity(f"{amount} {prefix}{unit}", unit) == expected, (prefix, amount)


def test_other_texts_are_refused() -> None:
    for text in (
        *("1 furlong", "1 mpa", "1 s", "MPa", "1 2 MPa", "1,5 MPa", "nan Pa", "inf", "", "1 Pa/0"),
        *("1e400 Pa", "1 ()", "1 [Pa]", "1 Pa**9**9**9", "1 Pa^99", "1 __import__", "1 °", "1 %"),
        "1 " + "Pa " * 50,
    ):
        with refuses("pressure"):
            quantity(text, "Pa", "pressure")
    each_refuses(
        *(("load", quantity, wrong, "N", "load") for wrong in (None, True, float("nan"), 1j)),
        got="None | True | nan | 1j",
    )
    with refuses("quantity", "'1 m'"):
        quantity("1 m", "V")
    assert factor("GPa^-1", "1/Pa") == pytest.approx(1e-9)
    assert factor("GPa", "1/Pa") is None


@pytest.mark.parametrize(
    ("written", "unit", "meant"),
    [
        ("1mpa", "Pa", 1e6),
        ("3 GPA", "Pa", 3e9),
        ("2 UM", "m", 2e-6),
        ("5 Mn", "N", 5e-3),
        ("3 HZ", "Hz", 3.0),
    ],
)
def test_a_unit_in_another_case_is_refused_with_the_one_that_is_meant(written, unit, meant) -> None:
    with refuses("quantity", written) as raised:
        quantity(written, unit)
    error: Any = raised.value
    advised, reason = error.advice.split(", ")
    assert quantity(advised, unit) == pytest.approx(meant)
    assert reason == "as case matters"


def test_loads_pressures_and_separations_take_units() -> None:
    same(press(SCAN, HALF_SPACE, load="10 mN"), press(SCAN, HALF_SPACE, load=0.01))
    same(press(SCAN, HALF_SPACE, pressure="10 MPa"), press(SCAN, HALF_SPACE, pressure=1e7))
    same(press(SCAN, MACHINE, separation="1 um"), press(SCAN, MACHINE, separation=1e-6))
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
    with refuses("load", "'10 MPa'"):
        press(SCAN, HALF_SPACE, load=of(10, "MPa"))
    with refuses("units", "'1 N'"):
        press(BARE, HALF_SPACE, load=of(1, "N"))


def test_units_are_refused_where_there_are_none_and_others_than_expected() -> None:
    plain, line = press(BARE, HALF_SPACE, load=1e6), press(RIDGES, HALF_SPACE, load=2000.0)
    legs: tuple[Any, Any] = [Repeat((Hold("1 min"),), 2)], [Step(load="1 N")]  # type: ignore[arg-type]
    others = ("10 MPa", "ten N", "5", "10 mN 5")
    each_refuses(
        *(("load", partial(press, load=wrong), SCAN, HALF_SPACE) for wrong in others),
        ("units", partial(press, load="1 N"), BARE, HALF_SPACE),
        ("units", partial(press, load="1 N"), SCAN, spring_lattice(k0=1.0, k1=3.0)),
        ("units", age, plain, ["1 s", "1 min"]),
        ("units", partial(age, protocol=legs[0]), plain, [1.0]),
        ("load", partial(press, load="1 N"), RIDGES, HALF_SPACE),
        ("protocol", partial(age, protocol=legs[1]), line, [1.0]),
        got="'10 MPa' | 'ten N' | '5' | '10 mN 5' | '1 N' | '1 N' | '1 s' | '1 min' | '1 N' | '1 N'",
    )


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
    each_refuses(
        ("times", "'10 m'", age, contact, ["10 m"]), ("times", "'soon'", age, contact, ["10 s", "soon"])
    )
