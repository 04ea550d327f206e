"""Quantities as they are written for people."""

from asperity.analysis.scan import written
from asperity.figures import style


def test_a_value_is_written_with_a_prefix_in_si_and_as_it_is_elsewhere():
    for value, unit, text in (
        (1.5e6, "Pa", "1.5 MPa"),
        (3.8e9, "Pa", "3.8 GPa"),
        (-2e-6, "N", "-2 uN"),
        (0.0, "N", "0 N"),
        (6.2e-11, "m^2", "62 um^2"),
        (2.5e-4, "m^2", "250 mm^2"),
        (1.6e-13, "m^2", "0.16 um^2"),
        (9.9e-14, "m^2", "99000 nm^2"),
        (1e-13, "m^2", "0.1 um^2"),
        (1e-30, "m^2", "1e-30 m^2"),
        (1e-3, "m", "1 mm"),
        (1e7, "s", "1e+07 s"),
        (0.01, "s", "10 ms"),
        (1e-6, "1", "1e-06"),
        (float("inf"), "N/m", "inf"),
        (122.88, "stiffness unit * height unit", "122.9"),
    ):
        assert written(value, unit) == text


def test_units_are_spelled_as_they_are_printed():
    spelled = [style.spelled(unit) for unit in ("um", "um^2", "uN", "um^2", "MPa", "rms", "unit")]
    assert spelled == ["µm", "µm²", "µN", "µm²", "MPa", "rms height", "unit"]
    assert style.spaced("62 um^2") == "62\u00a0µm²"
    assert style.spaced("62") == "62"
