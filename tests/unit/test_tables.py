"""One reader of tables: what laboratories write above their numbers, and what is not understood."""

import math
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asperity.app.config import config_from
from asperity.ask.solid import HalfSpace
from asperity.base.units import factor
from asperity.errors import ConfigError, InputError
from asperity.fits import read_measurements
from asperity.friction import read_record
from asperity.relaxation import Creep, Dynamic, Relaxation, fit, read
from asperity.sheets.tables import read_table
from tests.refusals import refuses

pytestmark = pytest.mark.usefixtures("here")
FALLING = np.array([[1, 50], [2, 40], [4, 30], [8, 25], [16, 22.5]])
RISING = np.array([[1, 20, 6], [2, 25, 5], [4, 30, 4], [8, 40, 3], [16, 50, 2.5]])
TURN = 2 * math.pi
SURFACE = {"kind": "spectral", "shape": [8, 8], "rms_height": 0.2, "unit": "um"}


def written(header: str, numbers: Any, decimal: str = ",") -> str:
    """A table with semicolons and decimal commas, as a European spreadsheet writes it."""
    rows = [";".join(f"{number:.12g}".replace(".", decimal) for number in row) for row in numbers]
    Path("t.csv").write_text("\n".join([header, *rows, ""]), encoding="utf-8-sig")
    return "t.csv"


@pytest.mark.parametrize(
    ("header", "second", "pascals", "measured"),
    [
        # What is above the names is no name; a row of units below them counts.
        ("Operator;M. Huber;2026-03-04\nProbe;7\nZeit;Modul\nmin;GPa", 60, 1e9, None),
        ("Zeit;E-Modul\n[Stunden];[N/mm²]", 3600, 1e6, "young"),
        ("t;E\ns;Pa", 1, 1, "young"),
        ("sep=;\ntime_s;E_MPa", 1, 1e6, "young"),
        ('"time, s";"E, MPa"', 1, 1e6, "young"),
        ("t/s;E/GPa", 1, 1e9, "young"),
        ("t [ms];relaxation modulus (psi)", 1e-3, 6894.757293168361, None),
        ("elapsed time (min);G in N/mm^2", 60, 1e6, "shear"),
        # Words of three languages, and ways to write units.
        ("Zeit (min);Relaxationsmodul E(t) / MPa", 60, 1e6, "young"),
        ("elapsed [min];E_rel [MPa]", 60, 1e6, "young"),
        ("temps en s [s];module de relaxation_N/mm²", 1, 1e6, None),
        ("Belastungsdauer / d;Elastizitätsmodul in GPa", 86400, 1e9, "young"),
        ("durée (h);module d\u2019élasticité [GPa]", 3600, 1e9, "young"),
        # Units in other cases, where one reading is left.
        ("time [Min];E [Mpa]", 60, 1e6, "young"),
        ("time [SEC];E [KPA]", 1, 1e3, "young"),
        ("t/H;E/pa", 3600, 1, "young"),
        ("time_s;E_kgf/cm2", 1, 98066.5, "young"),
        # Which modulus it is.
        ("t [min];shear modulus [MPa]", 60, 1e6, "shear"),
        ("t [s];G(t) [MPa];G_std [MPa];T", 1, 1e6, "shear"),
        ("t [s];Schubmodul/MPa", 1, 1e6, "shear"),
        ("time_s;Relaxation modulus G(t) (MPa)", 1, 1e6, "shear"),
        ("temps (s);module de cisaillement (MPa)", 1, 1e6, "shear"),
        ("t [s];plane strain modulus [GPa]", 1, 1e9, "contact"),
    ],
)
def test_headers_of_relaxation(header, second, pascals, measured):
    others = np.zeros((5, header.count(";T") + header.count(";G_std")))
    data = read(written(header, np.hstack([FALLING, others])))
    assert isinstance(data, Relaxation)
    np.testing.assert_allclose(data.time, second * FALLING[:, 0], rtol=1e-12)
    np.testing.assert_allclose(data.modulus, pascals * FALLING[:, 1], rtol=1e-12)
    assert data.measured == measured
    assert data.source.startswith("t.csv: time from ")
    assert ", 5 rows" in data.source


FREQUENCIES = {
    "frequency_Hz": TURN,
    "Frequenz [kHz]": 1e3 * TURN,
    "fréquence (mHz)": 1e-3 * TURN,
    "f / hz": TURN,
    "frequency_rpm": TURN / 60,
    "omega [rpm]": TURN / 60,
    "frequency [1/min]": TURN / 60,
    "Frequenz [U/min]": TURN / 60,
    "frequency [cycles/s]": TURN,
    "frequency [rev/min]": TURN / 60,
    "frequency [r/min]": TURN / 60,
    "omega [rps]": TURN,
    "ω [cpm]": TURN / 60,
    "frequency [1/s]": TURN,
    "frequency [s^-1]": TURN,
    "angular frequency (1/s)": 1,
    "omega [1/s]": 1,
    "Kreisfrequenz / s⁻¹": 1,
    "pulsation [rad/s]": 1,
    "omega_rad_s": 1,
    "frequency [rad/s]": 1,
    "frequency [deg/s]": math.pi / 180,
    "ω [°/s]": math.pi / 180,
}
"""Angular frequency over the number in a column of this name."""


@pytest.mark.parametrize(
    ("header", "per_second", "pascals"),
    [
        *((f"{name};Speichermodul [MPa];Verlustmodul [MPa]", one, 1e6) for name, one in FREQUENCIES.items()),
        ("frequency_Hz;storage_MPa;loss_MPa", TURN, 1e6),
        ("omega_rad_s;G' (kPa);G'' (kPa)", 1, 1e3),
        ("f [Hz];E' [MPa];E'' [MPa];tan delta", TURN, 1e6),
        ("angular frequency (1/s);E'(omega) [Pa];E''(omega) [Pa]", 1, 1),
        ("Frequency (Hz);Storage Modulus (MPa);Loss Modulus (MPa);T [degC]", TURN, 1e6),
    ],
)
def test_headers_of_dynamic_moduli(header, per_second, pascals):
    others = np.zeros((5, header.count(";") - 2))
    data = read(written(header, np.hstack([RISING, others])))
    assert isinstance(data, Dynamic)
    np.testing.assert_allclose(data.frequency, per_second * RISING[:, 0], rtol=1e-12)
    np.testing.assert_allclose([data.storage, data.loss], pascals * RISING[:, 1:].T, rtol=1e-12)


def test_the_marks_of_storage_and_loss_are_kept_in_any_order():
    words = "Loss modulus G'' [MPa];Storage modulus G' [MPa]"
    for marks in (words, "G'' [MPa];G' [MPa]", "G″ [MPa];G′ [MPa]", "G'';G'\nMPa;MPa"):
        head, _, units = marks.partition("\n")
        header = f"{head};omega" + (f"\n{units};rad/s" if units else " [rad/s]")
        data = read(written(header, RISING[:, [2, 1, 0]]))
        assert isinstance(data, Dynamic)
        np.testing.assert_allclose([data.storage, data.loss], 1e6 * RISING[:, 1:].T)
        assert data.measured == "shear"


def test_logarithms_are_read_by_their_base():
    numbers = np.array([[0, 1], [0.5, 2], [1, 3], [2, 4], [3, 5.0]])
    for header, base in (("log10(t/min);J [1/GPa]", 10), ("ln t [min];Kriechnachgiebigkeit [1/GPa]", math.e)):
        data = read(written(header, numbers))
        assert isinstance(data, Creep)
        np.testing.assert_allclose(data.time, 60 * base ** numbers[:, 0], rtol=1e-12)
        np.testing.assert_allclose(data.compliance, 1e-9 * numbers[:, 1])
    swept = read(written("lg(f/Hz);G' [MPa];G'' [MPa]", np.column_stack([np.arange(5), RISING[:, 1:]])))
    np.testing.assert_allclose(swept.columns[0], TURN * 10.0 ** np.arange(5), rtol=1e-12)
    curve = read_measurements(written("log10(time/s);area", numbers))
    np.testing.assert_allclose(curve.time, 10 ** numbers[:, 0], rtol=1e-12)
    assert curve.time_unit == "s"
    both = np.column_stack([10 ** numbers[:, 0], numbers])
    np.testing.assert_allclose(read(written("t [s];log t;J [1/GPa]", both)).columns[0], both[:, 0])
    with refuses("column 'log t' of t.csv", "none"):
        read_measurements(written("log t;area", numbers))


@pytest.mark.parametrize(
    ("header", "name", "got", "how"),
    [
        ("time [furlong];E [MPa]", "column 'time [furlong]' of t.csv", "'furlong'", {}),
        ("Zeit;E\nfurlong;GPa", "column 'Zeit' of t.csv", "'furlong'", {}),
        ("time_m;E_MPa", "column 'time_m' of t.csv", "'m'", {}),
        ("time_furlong;E_MPa", "column 'time_furlong' of t.csv", "'furlong'", {}),
        ("time_s;E", "column 'E' of t.csv", "none", {}),
        ("time [s];E [mPa]", "column 'E [mPa]' of t.csv", "'mPa'", {}),  # millipascals, or in haste
        ("time [s];E [mpa]", "column 'E [mpa]' of t.csv", "'mpa'", {}),
        ("time [Ms];E [MPa]", "column 'time [Ms]' of t.csv", "'Ms'", {}),
        ("time [s];E [GPa]\nmin;GPa", "column 'time [s]' of t.csv", "'min'", {}),
        ("log t [s];E [MPa]", "column 'log t [s]' of t.csv", "none", {}),
        ("time_s;E_MPa", "units", "'furlong'", {"units": "E_MPa=furlong"}),
        ("time_s;E_MPa", "units", "'E_MPa'", {"units": "E_MPa"}),
        ("time_s;shear modulus [MPa]", "modulus", "'young'", {"modulus": "young"}),
        ("time_s;E_MPa", "modulus", "'bulk'", {"modulus": "bulk"}),
        ("relaxation time [s];bulk modulus [MPa]", "t.csv", "'relaxation time [s]'", {}),
    ],
)
def test_what_is_not_understood_is_refused(header, name, got, how):
    with refuses(name, got):
        read(written(header, FALLING), **how)


def test_what_only_the_user_knows():
    millipascals = read(written("time [s];E [mPa]", FALLING), units={1: "mPa"})
    np.testing.assert_allclose(millipascals.columns[1][0], 1e-3 * FALLING[:, 1])
    assert read(written("time_s;E_MPa", FALLING), modulus="contact").measured == "contact"  # E is a letter
    file = written("a [s];b [MPa];c [MPa]", np.column_stack([FALLING, 2 * FALLING[:, 1]]))
    for columns in (["a [s]", "c [MPa]"], [0, 2], "0,2", "[0,2]", "0 2", ["0 2"], ["[0,", "2]"]):
        data = read(file, kind="relaxation", columns=columns)
        np.testing.assert_allclose(data.columns[1][0], 2e6 * FALLING[:, 1])
    with refuses("units", "one of column 1"):  # of a column that is not read
        read(file, kind="relaxation", columns="0,2", units="1=MPa")
    for name, unit in (("omega [Hz]", "Hz"), ("n", "U/min")):
        file = written(f"{name};storage [Pa];loss [Pa]", RISING)
        with pytest.raises(InputError):
            read(file, kind="dynamic", columns="0 1 2")
        turning = read(file, kind="dynamic", columns="0 1 2", units={0: unit}).columns[0]
        np.testing.assert_allclose(turning, TURN / (1 if unit == "Hz" else 60) * RISING[:, 0])


@pytest.mark.parametrize(
    "header",
    [
        "Operator;M. Huber;2026-03-04;1\nZeit [s];Gleitweg [mm];Reibungskoeffizient [-];Nr",
        "time_s;displacement_mm;COF;T",
        "temps;déplacement;coefficient de frottement;-\ns;mm;-;-",
        "t;x;mu;T\ns;mm;1;°C",
        "t / s;s / mm;µ / -;Temperatur / °C",
        "time_s;slip_mm;mu_s;angle_deg",
        "Zeit [s];Gleitweg [mm];Reibwert;log t",
    ],
)
def test_headers_of_friction(header):
    numbers = np.column_stack([np.arange(5), 0.1 * np.arange(5), np.full(5, 0.6), np.arange(5)])
    record = read_record(written(header, numbers))
    assert record.si
    np.testing.assert_allclose(record.displacement, 1e-4 * np.arange(5), atol=1e-18)
    np.testing.assert_allclose(record.friction, 0.6)


@pytest.mark.parametrize(
    ("header", "load_point", "slip"),
    [
        ("Time(s);Displ(microns);Friction;Effective_Normal_stress(MPa)", 1, None),
        ("Time (sec);LP_Disp (mic);Shr_stress (MPa);nor_disp (mic);Nor_stress (MPa);on_board (mic)", 1, 5),
        ("time_s;vdcdt_um;mu;hdcdt_um;effns_MPa;vobdcdt_um;LP_vel_um/s", 1, 5),
        ("time_s;lp_displacement_um;vstress_MPa;normal displacement (um);sigma_n (MPa);Ec_disp (um)", 1, 5),
        ("time_s;disp_um;tau (MPa);layer_thick (um);NS_MPa;strain", 1, None),
        ("time_s;load_point_um;mu;axial displacement (um);Normalverschiebung (um)", 1, None),
        ("time_s;load_point_um;mu;vertical_disp_um;déplacement normal (um);slip_um", 1, 5),
    ],
)
def test_headers_of_machines_of_friction(header, load_point, slip):
    """Words of xlook, of biaxial machines and of their scripts; the layer's thickness is no slip."""
    numbers = np.full((5, header.count(";") + 1), 5.0)
    for at in (0, load_point, slip):
        if at is not None:
            numbers[:, at] = (at + 1) * np.arange(5)
    record = read_record(written(header, numbers))
    assert record.load_point is not None
    np.testing.assert_allclose(record.load_point, 1e-6 * numbers[:, load_point])
    assert (record.slip is None) == (slip is None)
    if record.slip is not None:
        np.testing.assert_allclose(record.slip, 1e-6 * numbers[:, slip])


def test_friction_is_a_ratio_of_numbers_in_units_or_of_numbers_without():
    numbers = np.column_stack([np.arange(5), 0.1 * np.arange(5), np.full(5, 30), np.full(5, 50)])
    for header in (
        "t [s];Weg [µm];Fx [N];Fz [kN]",
        "t/s;s/um;F_T/N;F_N/kN",
        "time_s;x_um;Reibkraft_N;load_kN",
    ):
        np.testing.assert_allclose(read_record(written(header, numbers)).friction, 30 / 50e3)
    half = written("time_s;displacement_um;shear_stress_MPa;normal_stress", numbers)
    with refuses("column 'normal_stress' of t.csv", "none"):
        read_record(half)
    record = read_record(half, units={"normal_stress": "MPa"})
    np.testing.assert_allclose(record.friction, 0.6)
    assert record.normal_stress == pytest.approx(50e6)
    bare = read_record(written("time_s;displacement_um;shear_stress;normal_stress", numbers))
    np.testing.assert_allclose(bare.friction, 0.6)
    assert bare.normal_stress is None


def test_a_curve_keeps_its_units_and_says_them():
    numbers = np.column_stack([FALLING, 0.1 * FALLING[:, 1]])
    data = read_measurements(
        written("Versuch 5;;\nHaltezeit;area;error\nmin;mm2;mm2", numbers), columns="0,1,2"
    )
    np.testing.assert_array_equal([data.time, data.value], FALLING.T)
    assert data.stderr is not None
    assert (data.time_name, data.time_unit) == ("Haltezeit", "min")
    assert data.source.startswith("t.csv: time from 'Haltezeit' in min, value from 'area' in mm2, ")
    assert read_measurements("t.csv", units={"Haltezeit": "h"}).time_unit == "h"
    for name in ("time [furlong]", "time_furlong", "hold time / furlong"):
        with refuses(f"column {name!r} of t.csv", "'furlong'"):
            read_measurements(written(f"{name};area", FALLING))
    with refuses("column 'stderr_um2' of t.csv", "um2"):
        read_measurements(written("t;area_mm2;stderr_um2", numbers), stderr=2)
    with refuses("columns", "0 1"):
        read_measurements(written("t;area", FALLING), columns="0,1", time=1)


def test_units_beside_names_in_brackets_between_blanks():
    Path("t.txt").write_text("Zeit [h]   E Modul [GPa]\n")
    with Path("t.txt").open("a") as stream:
        np.savetxt(stream, FALLING)
    data = read("t.txt")
    np.testing.assert_allclose(data.columns[0], 3600 * FALLING[:, 0])


def test_a_run_takes_a_table_of_any_names_and_of_a_shear_modulus():
    def contact_modulus(**keys: Any) -> float:
        solid = {"kind": "half_space", "relaxation": "t.csv", "poisson": 0.3} | keys
        section = config_from(
            {"surface": SURFACE, "solid": solid, "contact": {"pressure": "1 MPa"}}, {}, None
        ).solid
        assert isinstance(section, HalfSpace)
        return float(section.build().modulus)

    numbers = np.column_stack([FALLING[:, 0], 40 + 10 * np.exp(-FALLING[:, 0] / 5)])
    how: dict[str, Any] = {"table_kind": "relaxation", "columns": [0, "b"], "units": ["a=min", "1=MPa"]}
    written("a;b", numbers)
    stiffness = {name: contact_modulus(modulus=name, **how) for name in ("young", "shear", "contact")}
    at_once = fit(Relaxation(60 * numbers[:, 0], 1e6 * numbers[:, 1])).series.modulus
    assert stiffness["contact"] == pytest.approx(at_once)
    assert stiffness["young"] == pytest.approx(stiffness["contact"] / (1 - 0.3**2))
    assert stiffness["shear"] == pytest.approx(stiffness["young"] * 2 * 1.3)
    written("t [min];G [MPa]", numbers)
    assert contact_modulus() == pytest.approx(stiffness["shear"])
    with pytest.raises(ConfigError):
        contact_modulus(units="0=kg")


@pytest.mark.parametrize(
    ("header", "factor_of_values"),
    [
        ("time [s];J(t) [GPa^-1]", 1e-9),
        ("time_s;compliance_per_MPa", 1e-6),
        ("t/aT (s);J (10^-6/MPa)", 1e-12),
        ("aT*t [s];J (µε/MPa)", 1e-12),
        ("t/a_T [s];J (10^-3 1/GPa)", 1e-12),
        ("Zeit (s);J (microstrain/kPa)", 1e-9),
        ("time_s;J (10-6/psi)", 1e-6 / 6894.757293168361),
    ],
)
def test_powers_of_ten_strains_and_reduced_times(header, factor_of_values):
    data = read(written(header, RISING[:, :2]))
    assert isinstance(data, Creep)
    np.testing.assert_array_equal(data.time, RISING[:, 0])
    np.testing.assert_allclose(data.compliance, factor_of_values * RISING[:, 1], rtol=1e-12)


def test_rows_of_equal_times_count_as_their_mean():
    doubled = np.repeat(FALLING, 2, axis=0).astype(float)
    doubled[1::2, 1] -= 1
    data = read(written("time_s;E_MPa", doubled))
    assert isinstance(data, Relaxation)
    np.testing.assert_array_equal([data.time, data.modulus / 1e6], [FALLING[:, 0], FALLING[:, 1] - 0.5])
    assert data.source.endswith("10 rows; means of rows of equal time: 5")
    with refuses("t.csv, time", "2 after 4"):
        read(written("time_s;E_MPa", FALLING[[0, 2, 1, 3, 4]]))


def test_a_labelled_comment_names_columns_and_another_fact_does_not():
    facts = "# date: Mon Jan 2015\n# columns: height vDeflection time\n# slots: nominal force elapsed\n"
    Path("t.txt").write_text(f"{facts}# units: m N s\n# 1 2 3\n1 2 3\n4 5 6\n")
    table = read_table(Path("t.txt"))
    assert (table.names, table.units) == (["height", "vDeflection", "time"], ["m", "N", "s"])
    with Path("t.txt").open("a") as file:
        file.write("# segment: retract\n# columns: height vDeflection time\n7 8 9\n")
    with refuses("t.txt", "header in line 9"):
        read_table(Path("t.txt"))
    for header in ("Rec #;time_s;area", "Pt #,time_s,area", "no.#\ttime_s\tarea"):
        separator = re.findall(r"[;,\t]", header)[0]
        Path("t.txt").write_text(f"{header}\n{separator.join('123')} # noted\n{separator.join('456')}\n")
        assert [*read_measurements("t.txt").value] == [3, 6]
    for facts in ("# date: Mon Jan 2015\n", "# Mon Jan 05\n", "# run-id: a b c\n", "# 1 2 3\n"):
        Path("t.txt").write_text(f"{facts}1 2 3\n4 5 6\n")
        assert read_table(Path("t.txt")).names == ["", "", ""]


@pytest.mark.parametrize("unit", ["hh", "kd", "mmin", "ms/kd"])
def test_days_hours_and_minutes_have_no_prefix(unit):
    assert factor(unit, "s" if "/" not in unit else "1") is None
    assert factor("h", "s") == 3600


def test_a_table_is_refused_before_the_engine_is_imported():
    written("time [furlong];E [MPa];area", np.insert(FALLING, 2, 1.0, axis=1))
    words = [
        ["predict", "t.csv", "--surface", "x", "--pressure", "1MPa"],
        ["fit", "t.csv"],
        ["infer", "t.csv"],
    ]
    code = f"import sys\nfrom asperity.app.cli import main\nprint([main(words) for words in {words}])\n"
    code += "print({'numba', 'xarray', 'matplotlib'} & set(sys.modules))"
    done = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True, timeout=60
    )
    assert done.stdout == "[2, 2, 2]\nset()\n"
    assert done.stderr.count("column 'time [furlong]' of t.csv: expected a unit of time") == 3


@pytest.mark.parametrize(
    ("name", "percent", "measured"),
    [
        ("E/E0", 1, "young"),
        ("G / G_0", 1, "shear"),
        ("E(t)/E(0) [%]", 100, "young"),
        ("normalized modulus [-]", 1, None),
    ],
)
def test_a_modulus_over_the_first_is_one_up_to_a_factor(name, percent, measured):
    data = read(written(f"time_s;{name}", FALLING * [1, percent / FALLING[0, 1]]))
    assert isinstance(data, Relaxation)
    np.testing.assert_allclose(data.modulus, FALLING[:, 1] / FALLING[0, 1], rtol=1e-12)
    assert (data.absolute, data.measured) == (False, measured)


@pytest.mark.parametrize("name", ["creep modulus E_c [GPa]", "Kriechmodul [GPa]", "module de fluage [GPa]"])
def test_a_creep_modulus_is_the_inverse_of_a_compliance(name):
    data = read(written(f"time_s;{name}", FALLING))
    assert isinstance(data, Creep)
    np.testing.assert_allclose(data.compliance, 1e-9 / FALLING[:, 1], rtol=1e-12)
    assert data.absolute


def test_names_say_the_order_of_columns_that_are_chosen():
    data = read(written("time_s;E_MPa", FALLING), columns="1 0")
    assert isinstance(data, Relaxation)
    np.testing.assert_allclose(data.modulus, 1e6 * FALLING[:, 1])
    twice = written("time_s;E_MPa;E of the second (MPa)", np.insert(FALLING, 2, 1.0, axis=1))
    with refuses("t.csv", "columns 'time_s', 'E_MPa', 'E of the second (MPa)'"):
        read(twice, columns="0 1 2")
    with refuses("columns", "0 1 2"):
        read(twice, columns="0 1 2", kind="relaxation")
    file = written("time_s;J (1/GPa);E (GPa)", np.insert(FALLING, 1, 1 / FALLING[:, 1], axis=1))
    with refuses("t.csv", "columns 'time_s', 'J (1/GPa)', 'E (GPa)'", advice="kind='relaxation'"):
        read(file)
    assert isinstance(read(file, kind="relaxation"), Relaxation)


@pytest.mark.parametrize("name", ["E x 10^3", "E·1e3", "E 10³", "E ×1000"])
def test_a_power_of_ten_in_a_name_is_asked_for(name):
    """Axes of figures multiply by it, tables of numbers divide."""
    with refuses(f"column '{name} [MPa]' of t.csv", "a factor in the name"):
        read(written(f"time_s;{name} [MPa]", FALLING), columns="0 1", kind="relaxation")
    data = read(written(f"time_s;{name} [MPa]", FALLING), columns="0 1", kind="relaxation", units="1=GPa")
    assert isinstance(data, Relaxation)
    np.testing.assert_allclose(data.modulus, 1e9 * FALLING[:, 1], rtol=1e-12)
    Path("t.csv").write_text("time_s,area x 1000\n1,2\n2,3\n")
    with refuses("column 'area x 1000' of t.csv", "a factor in the name"):
        read_measurements("t.csv")
