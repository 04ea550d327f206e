"""Tables of measurements: whatever separates, whatever stands around, and mistakes with their line."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from asperity import relaxation
from asperity.fits import measured_growth, read_measurements
from tests.refusals import each_refuses, refuses

TABLES = {
    "commas": "time,mu\n1.5,0.6\n10,0.61\n",
    "blanks after commas": "1.5, 0.6\n10, 0.61\n",
    "decimal commas": "Zeit;mu\n1,5;0,6\n10;0,61\n",
    "decimal commas, tabs": "1,5\t0,6\n10,0\t0,61\n",
    "decimal commas, blanks, powers": "1,5E+00 6,0E-01\n1,0E+01 6,1E-01\n",
    "blanks": "   1.5   0.6 \n  10   0.61\n",
    "comments": "% a\n# b\n1.5 0.6\n\n; c\n10 0.61 # d\n",
    "quoted decimal commas": '"t","mu"\n"1,5","0,6"\n"10","0,61"\n',
    "empty rows": ";;\nt;mu;\n1.5;0.6;\n;;\n10;0.61;\n;;\n",
    "units": "time,mu\ns,-\n1.5,0.6\n10,0.61\n",
    "Windows": "time,mu\r\n1.5,0.6\r\n10,0.61\r\n",
    "old Macintosh": "time,mu\r1.5,0.6\r10,0.61\r",
    "no end": "1.5,0.6\n10,0.61",
}
pytestmark = pytest.mark.usefixtures("here")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_tables_of_many_kinds(encoding):
    for kind, text in TABLES.items():
        Path("mu.csv").write_bytes(text.encode(encoding))
        data = read_measurements("mu.csv")
        np.testing.assert_array_equal([data.time, data.value], [[1.5, 10], [0.6, 0.61]], err_msg=kind)
        assert data.stderr is None


def test_columns_by_name_and_number():
    Path("mu.csv").write_text("sample,hold,mu,error\nA,1,0.6,0.01\nB,10,0.61,0.02\n")
    named = read_measurements("mu.csv", time="hold", value="mu", stderr="error")
    counted = read_measurements("mu.csv", time=1, value="2", stderr=3)
    for data in (named, counted):
        found = [data.time, data.value, data.stderr]
        np.testing.assert_array_equal(found, [[1, 10], [0.6, 0.61], [0.01, 0.02]])
        assert (data.time_name, data.value_name) == ("hold", "mu")
    for name, column in (("column 'x' of mu.csv", "x"), ("column 4 of mu.csv", 4)):
        with refuses(name, "no such column"):
            read_measurements("mu.csv", value=column)
    with refuses("mu.csv", "1"):
        read_measurements("mu.csv", time="hold", value=1)


def test_names_in_a_comment_and_in_an_old_encoding():
    Path("mu.txt").write_bytes("# made today\n# hold µ\n1 0.6\n10 0.61\n".encode("latin-1"))
    assert read_measurements("mu.txt").value_name == "µ"


def test_the_index_that_pandas_writes_is_no_hold_time():
    frame = pd.DataFrame({"hold": [1.5, 10.0], "mu": [0.6, 0.61]})
    frame.to_csv("mu.csv")
    data = read_measurements("mu.csv")
    np.testing.assert_array_equal([data.time, data.value], [[1.5, 10], [0.6, 0.61]])
    assert data.remarks == ("column 0, without a name, counts the lines: took 'hold' for the hold times",)
    np.testing.assert_array_equal(read_measurements("mu.csv", value="mu").time, [1.5, 10])
    counted = read_measurements("mu.csv", time=0, value=2)
    np.testing.assert_array_equal(counted.time, [0, 1])
    assert counted.remarks == ()
    # An index that is not counted is the hold time where no other column is, or one that leaves one column.
    frame.set_index(pd.Index([3.0, 4.0])).to_csv("mu.csv")
    np.testing.assert_array_equal(read_measurements("mu.csv").time, [1.5, 10])
    frame.rename(columns={"hold": "t1"}).set_index(pd.Index([3.0, 4.0])).to_csv("mu.csv")
    np.testing.assert_array_equal(read_measurements("mu.csv").time, [3, 4])
    frame[["mu"]].to_csv("mu.csv")
    np.testing.assert_array_equal(read_measurements("mu.csv").time, [0, 1])


def test_mistakes_are_named_with_their_line():
    for text in (
        "",
        "1\n2\n",
        "hello you\nand you\n",
        "t,m\n1,2\n\n2,nan\n",
        "1,2\n2,inf\n",
        "1,2\n2,\n",
        "t,mu\n1,2\n2,N/A\n",
        "t,mu\n1,2\n2,-3\n",
        "1,2\n2\n",
        "# c\n1,2\n# d\n-1,3\n",
        "1,2\nabc,3\n",
        "1,5;2,5\n2,5;x\n",
        "1,2\n\n2,3,4\n",
        "Experiment 5 of 7\n1 2\n",
        "1\0 2\n",
        "A,1,2\nB,2,3\n",
        "day,mu\n2024-01-01,2\n2024-01-02,3\n",
        't,mu\n"1,438",2\n"5,438",3\n',
        "t;mu\n1,438.45;2\n5,438.45;3\n",
        "t,mu\n1,5,0,6\n10,0,0,61\n",
    ):
        Path("mu.csv").write_text(text)
        with refuses("mu.csv"):
            read_measurements("mu.csv")
    each_refuses(
        *((path, read_measurements, path) for path in ("none.csv", str(Path()))),
        got="no such file | a folder",
    )


@pytest.mark.parametrize(
    ("header", "quantity", "taken"),
    [
        ("time_s,load_N,area_um2", "area", "area_um2"),
        ("T_C,time_s,area", "area", "area"),
        ("temperature_degC,A (mm^2),time_s", "area", "A (mm^2)"),
        ("time_s,RH_%,mu_s", "friction", "mu_s"),
        ("time_s,time_std_s,friction", ("area", "friction"), "friction"),
        ("time under load (s),time_std_s,area", "area", "area"),
        ("force_nN,indentation_nm,time_s", ("depth", "radius"), "indentation_nm"),
        ("time_s,contact_area_m2,area", "area", "area"),
        ("Zeit (s),Kraft (N),Kontaktradius (um)", ("depth", "radius"), "Kontaktradius (um)"),
        ("time_s,load_N,depth_nm", "area", None),
        ("time_s,contact_um,load_N", "area", None),
        ("time_s,load_N,area_px", "area", "area_px"),
        ("time_s,area_1_um2,area_2_um2", "area", None),
        ("time_s,x,y", "area", None),
        ("time_s,segment,length_nm", "area", None),
        ("time_s,load_N,sd", "friction", None),
    ],
)
def test_values_are_found_by_name_and_unit_whatever_their_place(header, quantity, taken):
    Path("t.csv").write_text(f"{header}\n1,2,3\n2,3,4\n")
    if taken is None:
        with refuses("t.csv", f"columns '{header.split(',')[0]}'"):
            read_measurements("t.csv", quantity)
        return
    found, place = read_measurements("t.csv", quantity), header.split(",").index(taken)
    assert found.value_name == taken
    np.testing.assert_array_equal(found.value, [[1, 2], [2, 3], [3, 4]][place])


@pytest.mark.parametrize("between", ["", "# second hold", "; time area", "time,area"])
def test_blocks_whose_times_overlap_are_no_series(between):
    Path("t.csv").write_text(f"time,area\n1,2\n2,3\n4,5\n{between}\n1,2\n2,4\n")
    apart = "one up to line 4, another from line 6 on"
    with refuses("t.csv", between if between == "time,area" else apart):
        read_measurements("t.csv")
    Path("t.csv").write_text("time_s,E_MPa\n1,5\n2,4\n4,3\n\n1,5\n2,4\n")
    with refuses("t.csv", apart):
        relaxation.read("t.csv")


@pytest.mark.parametrize("text", ["9,2\n1,3\n3,4\n1,2\n", "9,2\n\n1,3\n\n3,4\n", "1,2\n2,3\n\n2,4\n5,6\n"])
def test_rows_in_any_order_and_blocks_that_follow_each_other_are_a_series(text):
    Path("t.csv").write_text(f"time,area\n{text}")
    assert read_measurements("t.csv").time.size == text.count(",")


@pytest.mark.parametrize("name", ["A/A0", "A / A_0", "A(t)/A(0)", "A/A0 [%]", "Reibung/Reibung_max"])
def test_a_ratio_is_no_unit(name):
    Path("t.csv").write_text(f"time_s,{name}\n1,2\n2,3\n")
    assert [*read_measurements("t.csv").value] == [2, 3]


def test_two_columns_without_names_hold_no_errors_beside_values():
    Path("t.csv").write_text("1,2\n2,3\n")
    with refuses("t.csv", "2 columns without names"):
        read_measurements("t.csv", stderr=1)


@pytest.mark.filterwarnings("error")
def test_values_at_one_hold_time_do_not_grow():
    with refuses("mu", "1 ... 9"):
        measured_growth(np.full(9, 25.0), np.arange(1.0, 10.0), name="mu")


def test_a_row_in_the_line_of_the_header_and_units_with_a_point_are_read():
    Path("t.txt").write_text("Depth (nm)\tTime (sec.)\tVoltage (V)4\t1\t0.5\n5\t2\t0.6\n6\t3\t0.7\n")
    read = read_measurements("t.txt", "depth")
    np.testing.assert_array_equal([read.time, read.value], [[1, 2, 3], [4, 5, 6]])
    assert (read.time_name, read.value_name, read.time_unit) == ("Time (sec.)", "Depth (nm)", "sec.")
    Path("t.txt").write_text("Zeit [Std.];Reibung beim Start;x\n1;0.2;7\n2;0.3;8\n")
    read = read_measurements("t.txt", columns="Zeit [Std.], Reibung beim Start")
    assert (read.time_unit, read.value_name) == ("Std.", "Reibung beim Start")
