"""Tables that could be read as other numbers: refused, or read as their headers say."""

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.base.units import factor
from asperity.errors import InputError
from asperity.fits import read_measurements
from asperity.friction import read_record
from asperity.friction.rows import rows_of
from asperity.protocols import measured
from asperity.relaxation import Creep, read
from asperity.sheets.tables import read_table
from tests.refusals import refuses

pytestmark = pytest.mark.usefixtures("here")
MODULI = ("3,200", "3,100", "3,000", "2,900")
FALLING = "1;3.2\n2;3.1\n5;3.0\n10;2.9\n20;2.8\n"
SWEPT = "0.1;5;2\n1;6;2.1\n10;7;2.2\n100;7.5;2.1\n1000;8;2\n"


def written(text: str) -> str:
    Path("t.csv").write_text(text, encoding="utf-8")
    return "t.csv"


COLUMN, TABLE = "column '{}' of t.csv", "t.csv"
CHOSEN = partial(read, kind="relaxation", columns="0 1")
STRAIN = partial(read, stress="1 MPa")
AREA = partial(read_measurements, quantity="area")
ERROR = partial(AREA, stderr=2)
FRICTION = partial(read_measurements, quantity="friction")
TWO, THREE = "1;2\n2;3\n", "1;2;0.1\n2;3;0.1\n"
MULTIPLE = "a multiple or a square of it"
WARM, LOADS = "1;23;5\n2;23.1;6\n", "0;10;0.1\n2;10;3\n62;10;3.3\n"
TURNED = "100;9;5;10\n50;8.5;5;20\n20;8;5;30\n10;7.6;5;40\n5;7.2;5;50\n"


def cases(refused: str, reader: Any, header: str, rows: str, *names: str, got: str = "", **how: Any) -> Any:
    """Cases of a column, or of a table, that is refused: names, in a header above rows, and a reader."""
    for name in names:
        text = f"{header.format(name)}\n{rows}"
        yield pytest.param(partial(reader, **how), text, refused.format(name), got, id=name)


@pytest.mark.parametrize(
    ("reader", "text", "name", "got"),
    [
        # Factors, logarithms, roots and parts of one in a name.
        *cases(COLUMN, CHOSEN, "time_s;{}", FALLING, "E (100 MPa)", "E [1000 MPa]", "E/1000 (MPa)"),
        *cases(COLUMN, CHOSEN, "time_s;{}", FALLING, "E / 10 (MPa)", "E*5 (MPa)", "log. modulus (MPa)"),
        *cases(COLUMN, CHOSEN, "time_s;{}", FALLING, "Modulus log10 (MPa)", "logarithmic modulus (MPa)"),
        *cases(COLUMN, read, "t (s);{}", FALLING, "E x10³ (kPa)", "E x1000 (kPa)"),
        *cases(COLUMN, read, "{};E (MPa)", FALLING, "Time (1000 h)", "time, log10 s", "Log-time (s)"),
        *cases(COLUMN, read, "{};E (MPa)", FALLING, "Time_log_s"),
        *cases(COLUMN, AREA, "{};area (um2)", TWO, "sqrt time (s)", "Root time (min)", columns="0 1"),
        *cases(COLUMN, AREA, "{};area (um2)", TWO, "Time^0.5 (s)", "1/time (s)", columns="0 1"),
        *cases(COLUMN, STRAIN, "t (s);{}", FALLING, "Strain (%) mean", "Dehnung, ‰", "strain_ppm"),
        *cases(COLUMN, STRAIN, "t (s);{}", FALLING, "Microstrain"),
        # Capitals alone do not tell milli from mega, nor points thousands from decimals.
        *cases(COLUMN, measured, "TIME (S);{}", TWO, "LOAD (MN)", got="'MN'"),
        *cases(TABLE, measured, "Zeit (s);{}", "0;500\n10;1.000\n20;1.500\n", "Kraft (N)", got="'1.000'"),
        *cases(TABLE, AREA, "Zeit (s);{}", "1;100\n10;110\n1.000;130\n", "Fläche (um2)", got="'1.000'"),
        *cases(COLUMN, read, "TIME_S;{}", FALLING, "E_MPSI", got="'MPSI'"),
        # A modulus that may be the absolute one; a sweep is no relaxation.
        *cases(TABLE, read, "f (Hz);{};Loss modulus (MPa)", SWEPT, "Dynamic modulus (MPa)"),
        *cases(TABLE, read, "f (Hz);Dynamic modulus (MPa);{}", SWEPT, "Elastic modulus (MPa)"),
        *cases(TABLE, read, "Frequency (Hz);Modulus (MPa);{};Time (s)", TURNED, "Phase angle (°)"),
        # Two forces of a history, or one across.
        *cases(TABLE, measured, "Time (s);{};F (mN)", LOADS, "W (mN)", got="'F (mN)' and 'W (mN)'"),
        *cases(TABLE, measured, "Time (s);{};sigma (MPa)", LOADS, "Sigma_n (MPa)"),
        *cases(TABLE, measured, "Time (s);{}", TWO, "Tensile force (N)", "Horizontal displacement (mm)"),
        # What is no load at each time.
        *cases(TABLE, measured, "Time (s);{}", TWO, "Max load (N)", "Load change (N)", "Δ load (N)"),
        # Friction in newtons is no coefficient; normal forces below 0 are to be turned.
        *cases(COLUMN, read_record, "time_s;slip_um;{}", LOADS, "friction_N", "friction, N", "Friction_mN"),
        *cases(TABLE, read_record, "time_s;x_um;Fx_N;{}", "0;0;5;-10\n1;1;5;-9\n", "Fz_N", got="-10 to -9 N"),
        # What is no area: changes, stiffnesses, lengths, forces.
        *cases(TABLE, AREA, "t (s);{}", TWO, "Area change (%)", "Δ area (um2)", "Flächenänderung (%)"),
        *cases(TABLE, AREA, "time_s;{}", TWO, "contact stiffness (N/m)", "contact conductance (S)"),
        *cases(TABLE, AREA, "time_s;{}", TWO, "area (kN/m)", "contact diameter (um)"),
        *cases(COLUMN, AREA, "time_s;{}", TWO, "contact_um", got="um", columns="0 1"),
        *cases(COLUMN, AREA, "time_s;{}", TWO, "depth_nm", got="nm", value=1),
        *cases(COLUMN, AREA, "Zeit_s;{}", TWO, "Kraft_N", got="N", columns="0 1"),
        # What is no quantity is none as nothing else is; what is first is no time as it is first.
        *cases(TABLE, FRICTION, "t (s);{};Friction force (N)", WARM, "T (°C)", "T [K]", "T_C", "Nr.", "ID"),
        *cases(TABLE, FRICTION, "t (s);{};Friction force (N)", WARM, "Sample", "Run no."),
        *cases(TABLE, AREA, "{};area", TWO, "load", got="columns 'load', 'area'"),
        # What is no standard error.
        *cases(COLUMN, ERROR, "time_s;area_um2;{}", THREE, "2 sigma (um2)", "95 % CI", got=MULTIPLE),
        *cases(COLUMN, ERROR, "t;area_um2;{}", THREE, "variance", "expanded uncertainty (k=2)", got=MULTIPLE),
        *cases(COLUMN, ERROR, "t;area_um2;{}", THREE, "std^2", "σ²", "2*std", "2-sigma", got=MULTIPLE),
        *cases(COLUMN, ERROR, "t;area_um2;{}", THREE, "1.96 SE", "SD x2", "err95", "±2s", got=MULTIPLE),
        *cases(COLUMN, ERROR, "t;area_um2;{}", THREE, "two sigma", "probable error", got=MULTIPLE),
    ],
)
def test_what_a_header_leaves_open_is_asked_for(reader, text, name, got):
    with refuses(name, got):
        reader(written(text))


def test_a_logarithm_of_time_is_read_by_its_base():
    data = read(written(f"lg-time (s);E (MPa)\n{FALLING.replace('20;', '11;')}"))
    np.testing.assert_allclose(data.columns[0], 10.0 ** np.array([1, 2, 5, 10, 11]))


def test_a_power_of_ten_is_one_with_an_exponent():
    """``1000 mN`` was 1 mN."""
    assert [factor(unit, "N") for unit in ("1000 mN", "100 N", "10 N", "103 N")] == [None] * 4
    assert [factor(unit, "Pa") for unit in ("10^3 Pa", "10-3 Pa", "10^6 N/m^2")] == [1e3, 1e-3, 1e6]


@pytest.mark.parametrize("separator", ["\t", ";"])
def test_a_comma_before_three_digits_in_every_number_is_asked_for(separator):
    rows = "".join(f"{t}{separator}{E}\n" for t, E in zip((1, 2, 5, 10), MODULI, strict=True))
    with refuses("t.csv", "'3,200'"):
        read(written(f"Time (s){separator}E (MPa)\n{rows}20{separator}2,800\n"))
    table = read_table(Path(written(f"Time (s){separator}E (MPa)\n{rows}20{separator}2,80\n")))
    np.testing.assert_allclose(table.values[:, 1], [3.2, 3.1, 3.0, 2.9, 2.8])
    table = read_table(Path(written(f"Time (s){separator}E (MPa)\n0,125{separator}3,300\n{rows}")))
    np.testing.assert_allclose(table.values[0], [0.125, 3.3])


def test_rows_of_one_frequency_at_several_temperatures_or_amplitudes_have_no_mean():
    rows = "".join(f"{f};{T};{f + E};{E / 5}\n" for f in (1, 2, 4, 8, 16) for T, E in ((20, 9), (40, 3)))
    for name in ("Temperature (°C)", "T (K)", "strain (%)", "RH (%)", "Pressure (MPa)", "static load (N)"):
        with refuses("t.csv", "20 to 40"):
            read(written(f"Frequency (Hz);{name};E' (MPa);E'' (MPa)\n{rows}"))
    with refuses("t.csv", "PC to PMMA"):
        read(
            written(
                "time_s;material;E (MPa)\n"
                + "".join(f"{t};PMMA;{9 - t}\n{t};PC;{8 - t}\n" for t in range(1, 6))
            )
        )
    data = read(written(f"Frequency (Hz);specimen;E' (MPa);E'' (MPa)\n{rows}"))
    np.testing.assert_allclose(data.columns[1][0], 1e6 * (6.0 + np.array([1, 2, 4, 8, 16])))


@pytest.mark.parametrize(
    ("name", "is_shear"),
    [
        *((name, True) for name in ("Gleitmodul", "Torsionsmodul", "module de Coulomb", "rigidity modulus")),
        *((name, False) for name in ("constrained modulus", "P-wave modulus", "oedometric modulus")),
        *((name, False) for name in ("Bulk modulus", "E*", "|E|", "absolute modulus", "Loss tangent")),
    ],
)
def test_a_modulus_is_that_of_its_name(name, is_shear):
    file = written(f"t (s);{name} (MPa)\n{FALLING}")
    if is_shear:
        assert read(file).measured == "shear"
        return
    with pytest.raises(InputError) as raised:
        read(file)
    assert "columns" not in raised.value.cure  # which would take it for Young's


def test_elastic_and_viscous_moduli_are_storage_and_loss():
    data = read(written(f"f (Hz);Elastic modulus (MPa);Viscous modulus (MPa)\n{SWEPT}"))
    np.testing.assert_allclose(data.columns[1], 1e6 * np.array([[5, 6, 7, 7.5, 8], [2, 2.1, 2.2, 2.1, 2]]))


def test_a_capital_among_small_letters_is_mega():
    assert measured(written("Time (s);F (MN)\n0;1\n2;3\n")).start == {"load": 1e6}
    for name in ("E_Mpsi", "E Mpsi", "E (Mpsi)"):
        data = read(written(f"time_s;{name}\n{FALLING}"))
        assert np.ravel(data.columns[1])[0] == pytest.approx(3.2e6 * 6894.757293)


def test_percent_and_permille_in_words():
    for name, part in (
        ("strain percent", 100),
        ("Percent strain", 100),
        ("Dehnung [‰]", 1000),
        ("creep strain (%)", 100),
    ):
        data = read(written(f"t (s);{name}\n1;2\n2;2.5\n5;3\n10;3.5\n20;3.6\n"), stress="1 MPa")
        assert isinstance(data, Creep)
        np.testing.assert_allclose(data.compliance, np.array([2, 2.5, 3, 3.5, 3.6]) / part / 1e6)
    rows = "".join(f"{t};{t};60\n" for t in range(4))
    assert read_record(written(f"time_s;load point (um);Friction percent\n{rows}")).friction[0] == 0.6


@pytest.mark.parametrize(
    "names",
    [
        *("Normallast (N);Reibkraft (N)", "Effort normal (N);Force de frottement (N)"),
        *("Belastung (N);Zugkraft (N)", "Dead weight (N);Friction force (N)"),
        *("Fn (N);Tensile force (N)", "Load (N);Horizontal load (N)"),
    ],
)
def test_a_history_is_that_of_the_normal_load(names):
    history = measured(written(f"Time (s);{names}\n0;10;1\n2;10;3\n62;10;3.3\n"))
    assert (history.start, len(history)) == ({"load": 10.0}, 1)


def test_rows_that_begin_with_an_empty_cell_are_no_comments():
    found = read_measurements(written("Nr;Zeit;Fläche\n;min;mm²\n1;2;3\n2;3;4\n3;5;6\n"), "area")
    assert (found.time_unit, found.value_unit) == ("min", "mm²")
    table = read_table(Path(written("a;b;c\n1;2;3\n;5;6\n; a comment\n4;5;6\n")))
    np.testing.assert_array_equal(table.values, [[1, 2, 3], [np.nan, 5, 6], [4, 5, 6]])


def test_errors_of_a_spreadsheet_are_missing_cells():
    table = read_table(Path(written("t,E,G\n1,2,3\n2,#DIV/0!,4\n3,#N/A,5\n# 4,5,6\n")))
    np.testing.assert_array_equal(table.values, [[1, 2, 3], [2, np.nan, 4], [3, np.nan, 5]])


def test_a_unit_after_a_colon_and_a_name_that_is_a_unit():
    for name in ("Time:min", "minutes"):
        found = read_measurements(written(f"{name};area:um2\n1;2\n2;3\n"), "area")
        assert (found.time_unit, found.value_unit) == (name[-3:] if ":" in name else name, "um2")


STEPS = asp.friction.velocity_steps([1e-6, 1e-5, 1e-6], distance=2e-4)
LAW = asp.friction.RateAndState(mu_0=0.6, a=0.01, b=0.015, D_c=1e-5, V_0=1e-6)


def recorded(sign: float = 1.0, digits: int = 6) -> asp.friction.Record:
    """A record of synthetic steps as a table has it."""
    made = asp.friction.synthetic_record(STEPS, LAW, per_leg=200)
    columns = np.column_stack([made.time, sign * 1e6 * made.displacement, made.friction.round(digits)])
    np.savetxt("t.csv", columns, delimiter=",", header="time_s,slip_um,friction", comments="")
    return read_record("t.csv")


def test_a_record_may_count_its_displacement_downwards():
    forth, back = recorded(), recorded(sign=-1.0)
    np.testing.assert_array_equal(forth.velocity, back.velocity)


def test_friction_in_steps_beyond_the_misfit_is_noted():
    notes = {}
    for digits in (3, 6):
        laws = asp.friction.compare_state_laws(recorded(digits=digits), stiffness=np.inf)
        notes[digits] = [str(row.value) for row in rows_of(laws) if "in steps of" in str(row.value)]
    assert notes[6] == []
    assert "in steps of 0.001, more than" in notes[3][0]


def test_units_of_several_columns_stand_in_one_text():
    file = written("time,load\n0,1\n2,3\n")
    for units in ("time=min, load=mN", ["time=min", "load=mN"]):
        history = measured(file, units=units)
        assert (history.start, history[0].duration) == ({"load": 1e-3}, 120.0)


def test_a_row_of_units_may_end_with_an_empty_cell():
    rows = "".join(f"{t};{t};0.6\n" for t in range(4))
    record = read_record(written(f"Time;Slip;Friction\nmin;mm;\n{rows}"))
    assert record.si
    np.testing.assert_allclose(record.time, 60 * np.arange(4))
    found = read_measurements(written("Hold time;Contact area;Valid\nmin;um2;\n1;2;1\n2;3;1\n"), "area")
    assert (found.time_unit, found.value_unit) == ("min", "um2")


def test_the_letter_of_static_friction_is_no_second():
    rows = "".join(f"{t};{t};6\n" for t in range(4))
    assert read_record(written(f"time_s;load_point_um;mu_s\n{rows}")).friction[0] == 6


@pytest.mark.parametrize("name", ["Relaxation stress", "Spannungsrelaxation", "Elastic stress"])
def test_a_stress_is_no_modulus(name):
    assert not read(written(f"t (s);{name} (MPa)\n{FALLING}")).absolute


@pytest.mark.parametrize("name", ["Ang. frequency (1/s)", "Radian frequency (1/s)", "Fréq. ang. (1/s)"])
def test_angular_frequencies_are_not_counted_in_turns(name):
    data = read(written(f"{name};E' (MPa);E'' (MPa)\n{SWEPT}"))
    np.testing.assert_allclose(data.columns[0], [0.1, 1, 10, 100, 1000])


def test_points_in_all_numbers_are_those_of_decimals():
    assert measured(written("Zeit (s);Kraft (N)\n0;1.500\n10;1.000\n100;2.500\n")).start == {"load": 1.5}


@pytest.mark.parametrize(
    "name", ["vertical piston (um)", "Axial ram (um)", "Normal velocity (um/s)", "drive velocity (um/s)"]
)
def test_a_motion_across_or_of_a_drive_is_no_slip(name):
    rows = "".join(f"{t};{3 * t};{2 * t};0.6\n" for t in range(4))
    record = read_record(written(f"time_s;{name};slip_um;friction\n{rows}"))
    np.testing.assert_allclose(record.displacement, 2e-6 * np.arange(4))


def test_tabs_separate_below_words_with_blanks():
    found = read_measurements(written("Sample 12\nHold time (min)\tContact area (um2)\n1\t2\n2\t3\n"), "area")
    assert (found.time_unit, found.value_unit) == ("min", "um2")


@pytest.mark.parametrize("name", ["Time (10³ s)", "Time - ks", "ks Time"])
def test_units_that_stand_first_or_are_raised(name):
    data = read(written(f"{name};E (10⁶ Pa)\n{FALLING}"))
    np.testing.assert_allclose(data.columns[0], 1e3 * np.array([1, 2, 5, 10, 20]))
    np.testing.assert_allclose(data.columns[1][0], 1e6 * np.array([3.2, 3.1, 3.0, 2.9, 2.8]))


def test_the_time_of_day_is_no_number_of_days():
    history = measured(written("Time of day;Load (N)\n43200;10\n43260;20\n"), units=["Time of day=s"])
    assert history[0].duration == 60


@pytest.mark.parametrize("unit", ["-", "--", "/", "ohne", "dimensionless"])
def test_pure_numbers_have_units_of_their_own(unit):
    rows = "".join(f"{t};{t};6;10;0.6\n" for t in range(4))
    record = read_record(written(f"time_s;slip_um;Reibkraft (N);Last (N);COF [{unit}]\n{rows}"))
    assert record.friction[0] == 0.6
    french = written(f"t (s);x (um);Contrainte de cisaillement (MPa);Contrainte normale (MPa);y\n{rows}")
    assert read_record(french).friction[0] == 0.6
    assert factor("10³ µm²", "m^2") == pytest.approx(1e-9)
