"""Tables of measurements: whatever separates, whatever stands around, and mistakes with their line."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from asperity.errors import InputError
from asperity.fits import measured_growth, read_measurements

TABLES = {
    "commas": "time,mu\n1.5,0.6\n10,0.61\n",
    "blanks after commas": "1.5, 0.6\n10, 0.61\n",
    "decimal commas": "Zeit;mu\n1,5;0,6\n10;0,61\n",
    "decimal commas, tabs": "1,5\t0,6\n10,0\t0,61\n",
    "decimal commas, blanks": "1,5 0,6\n10,0 0,61\n",
    "decimal commas, powers": "1,5E+00;6,0E-01\n1,0E+01;6,1E-01\n",
    "tabs": "t\tmu\n1.5\t0.6\n10\t0.61\n",
    "blanks": "   1.5   0.6 \n  10   0.61\n",
    "comments": "% a\n# b\n1.5 0.6\n\n; c\n10 0.61 # d\n",
    "trailing separators": "1.5,0.6,\n10,0.61,\n",
    "quoted decimal commas": '"t","mu"\n"1,5","0,6"\n"10","0,61"\n',
    "empty rows": ";;\nt;mu;\n1.5;0.6;\n;;\n10;0.61;\n;;\n",
    "quotes": '"time","mu"\n"1.5","0.6"\n"10","0.61"\n',
    "units": "time,mu\ns,-\n1.5,0.6\n10,0.61\n",
    "Windows": "time,mu\r\n1.5,0.6\r\n10,0.61\r\n",
    "old Macintosh": "time,mu\r1.5,0.6\r10,0.61\r",
    "no end": "1.5,0.6\n10,0.61",
}


@pytest.mark.parametrize("text", TABLES.values(), ids=TABLES.keys())
def test_tables_of_many_kinds(tmp_path: Path, text: str) -> None:
    for encoding in ("utf-8", "utf-8-sig", "utf-16"):
        file = tmp_path / encoding
        file.write_bytes(text.encode(encoding))
        data = read_measurements(file)
        np.testing.assert_array_equal(data.time, [1.5, 10])
        np.testing.assert_array_equal(data.value, [0.6, 0.61])
        assert data.stderr is None


def test_columns_by_name_and_number(tmp_path: Path) -> None:
    file = tmp_path / "mu.csv"
    file.write_text("sample,hold,mu,error\nA,1,0.6,0.01\nB,10,0.61,0.02\n")
    named = read_measurements(file, time="hold", value="mu", stderr="error")
    counted = read_measurements(file, time=1, value="2", stderr=3)
    for data in (named, counted):
        np.testing.assert_array_equal(data.time, [1, 10])
        np.testing.assert_array_equal(data.value, [0.6, 0.61])
        np.testing.assert_array_equal(data.stderr, [0.01, 0.02])
        assert (data.time_name, data.value_name) == ("hold", "mu")
    with pytest.raises(InputError, match=r"column 'x'.*one of 'sample', 'hold', 'mu', 'error', or a number"):
        read_measurements(file, value="x")
    with pytest.raises(InputError, match="a number from 0 to 3, got no such column"):
        read_measurements(file, value=4)
    with pytest.raises(InputError, match="time and value in different columns, got column 1 and column 1"):
        read_measurements(file, time="hold", value=1)


def test_names_in_a_comment(tmp_path: Path) -> None:
    file = tmp_path / "mu.txt"
    np.savetxt(file, [[1, 0.6], [10, 0.61]], header="made today\nhold mu")
    assert read_measurements(file, value="mu").value_name == "mu"


def test_a_header_in_an_old_encoding(tmp_path: Path) -> None:
    file = tmp_path / "mu.txt"
    file.write_bytes("t µ\n1 0.6\n2 0.7\n".encode("latin-1"))
    assert read_measurements(file).value_name == "µ"


def test_the_index_that_pandas_writes_is_no_hold_time(tmp_path: Path) -> None:
    file = tmp_path / "mu.csv"
    frame = pd.DataFrame({"hold": [1.5, 10.0], "mu": [0.6, 0.61]})
    frame.to_csv(file)
    data = read_measurements(file)
    np.testing.assert_array_equal(data.time, [1.5, 10])
    np.testing.assert_array_equal(data.value, [0.6, 0.61])
    assert data.remarks == ("column 0, without a name, counts the lines: took 'hold' for the hold times",)
    np.testing.assert_array_equal(read_measurements(file, value="mu").time, [1.5, 10])
    counted = read_measurements(file, time=0, value=2)
    np.testing.assert_array_equal(counted.time, [0, 1])
    assert counted.remarks == ()
    # An index that is not counted, or that leaves one column only, is the hold time.
    frame.set_index(pd.Index([3.0, 4.0])).to_csv(file)
    np.testing.assert_array_equal(read_measurements(file).time, [3, 4])
    frame[["mu"]].to_csv(file)
    np.testing.assert_array_equal(read_measurements(file).time, [0, 1])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "expected a table of numbers, got no line besides comments"),
        ("# a\n\n", "got no line besides comments"),
        ("1\n2\n", "expected two columns of numbers or more, got one"),
        ("hello you\nand you\n", "expected two columns of numbers or more, got 'and you'"),
        (
            "t,m\n1,2\n\n2,nan\n",
            "expected 'm' to be a number in line 4, got '2,nan', where it is missing; try a #",
        ),
        ("1,2\n2,inf\n", "expected a value to be a number in line 2, got '2,inf', where it is infinite"),
        ("1,2\n2,\n", "expected a value to be a number in line 2, got '2,', where it is missing"),
        ("t,mu\n1,2\n2,N/A\n", "expected 'mu' to be a number in line 3, got '2,N/A', where it is missing"),
        ("t,mu\n1,2\n2,-3\n", "expected 'mu' above 0 in line 3, got '2,-3'; try a #"),
        ("1,2\n2\n", "expected a value to be a number in line 2, got '2', where it is missing"),
        ("1,2\n2,-3\n", "expected a value above 0 in line 2, got '2,-3'"),
        ("# c\n1,2\n# d\n-1,3\n", "expected a time not below 0 in line 4, got '-1,3'"),
        (
            "1,2\nabc,3\n",
            "expected a time to be a number in line 2, got 'abc,3', where it is not a number; try a #",
        ),
        ("1,5;2,5\n2,5;x\n", "expected a value to be a number in line 2, got '2,5;x'"),
        ("1,2\n\n2,3,4\n", "expected 2 columns in line 3, as before, got '2,3,4'"),
        ("Experiment 5 of 7\n1 2\n", "expected a time to be a number in line 1, got 'Experiment 5 of 7'"),
        ("1\0 2\n", "expected text, got binary data"),
        ("sample,t,mu\nA,1,2\nB,2,3\n", r"choose columns of numbers \('t', 'mu'\)$"),
        ("A,1,2\nB,2,3\n", r"choose columns of numbers \(1, 2\)$"),
        ("day,mu\n2024-01-01,2\n2024-01-02,3\n", r"\('mu'\); a hold time is a number, not a date$"),
        ('t,mu\n"1,438",2\n"5,438",3\n', "try numbers without separators between thousands$"),
        ("t;mu\n1,438.45;2\n5,438.45;3\n", "try numbers without separators between thousands$"),
        ('t,mu\n"1,438.45",2\n"5,438.45",3\n', "try numbers without separators between thousands$"),
    ],
)
def test_mistakes_are_named_with_their_line(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "mu.csv"
    file.write_text(text)
    with pytest.raises(InputError, match=message) as raised:
        read_measurements(file)
    assert str(file) in str(raised.value)


def test_no_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="got no such file"):
        read_measurements(tmp_path / "none.csv")
    with pytest.raises(InputError, match="got a folder"):
        read_measurements(tmp_path)


@pytest.mark.parametrize("cell", ["1e-320", "1e120"])
def test_numbers_that_would_overflow_are_refused(tmp_path: Path, cell: str) -> None:
    file = tmp_path / "mu.csv"
    file.write_text(f"1,0.6\n{cell},0.61\n10,0.62\n100,0.63\n")
    data = read_measurements(file)
    with pytest.raises(InputError, match=r"time: expected numbers up to 1e\+100 \(0, or from 1e-100\), got"):
        measured_growth(data.time, data.value)
