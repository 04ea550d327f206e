"""Texts with units: numbers in a stated unit, or one clear line."""

import subprocess
import sys

import pytest

from asperity.base.units import factor, quantity
from tests.refusals import refuses


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


def test_other_texts_are_refused() -> None:
    for text in (
        *(
            "1 furlong",
            "1 mpa",
            "1 s",
            "MPa",
            "1 2 MPa",
            "1,5 MPa",
            "nan Pa",
            "inf",
            "",
            "1 Pa/0",
            "1e400 Pa",
        ),
        *("1 ()", "1 [Pa]", "1 Pa**9**9**9", "1 9**9**9**9", "1 Pa^99", "1 __import__", "1 °", "1 %"),
        "1 " + "Pa " * 50,
    ):
        with refuses("pressure"):
            quantity(text, "Pa", "pressure")
    for wrong in (None, True, float("nan"), 1j):
        with refuses("load"):
            quantity(wrong, "N", "load")
    with refuses("quantity"):
        quantity("1 m", "V")
    assert factor("GPa^-1", "1/Pa") == pytest.approx(1e-9)
    assert factor("GPa", "1/Pa") is None


def test_pint_is_imported_only_for_a_unit() -> None:
    code = (
        "import sys, asperity.base.units as u, asperity.relaxation; u.quantity('3', 'Pa');"
        "early = 'pint' in sys.modules; u.quantity('3 kPa', 'Pa');"
        "sys.exit(early or 'pint' not in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False, timeout=120).returncode == 0
