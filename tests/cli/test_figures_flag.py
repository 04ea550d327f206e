"""``--figures`` and ``--measured``: every command that draws writes what is asked for, and nothing else."""

import csv
from pathlib import Path

import numpy as np
import pytest

import asperity as asp
from asperity.app.campaign import read_plan
from asperity.app.cli import main
from asperity.errors import ConfigError

LENGTHS = 'file_unit = "nm"\npixel_size = 50.0\nlength_unit = "nm"'
SOLID = '[solid]\nkind = "half_space"\nyoung = "3 GPa"\npoisson = 0.4\nbranches = [[0.2, "1 s"]]\n'
TIMES = '[contact]\npressure = "40 MPa"\n[aging]\nfirst = "0.1 s"\nlast = "10 s"\nper_decade = 2\n'


@pytest.fixture
def asked(tmp_path: Path) -> Path:
    """A TOML file of a prediction that asks for PDF, with a scan."""
    heights = asp.surfaces.spectral((24, 24), spacing=50.0, hurst=0.8, rms_height=20.0, seed=3)
    np.savetxt(tmp_path / "scan.txt", heights)
    (tmp_path / "area.csv").write_text("time_s,area_um2,std_um2\n0.5,0.3,0.02\n5,0.4,0.02\n")
    path = tmp_path / "asked.toml"
    path.write_text(f'[surface]\npath = "scan.txt"\n{LENGTHS}\n{SOLID}{TIMES}[output]\nfigures = ["pdf"]\n')
    return path


def suffixes(out: Path) -> set[str]:
    """Suffixes of the pictures in a folder."""
    return {path.suffix for path in out.iterdir()} & {".png", ".pdf", ".svg"}


@pytest.mark.parametrize(
    ("command", "flags", "found"),
    [("run", (), {".pdf"}), ("predict", ("--figures", "svg,png"), {".svg", ".png"})],
)
def test_a_file_and_flags_say_the_formats(asked, command, flags, found):
    assert main([command, str(asked), *flags, "--quiet", "--measured", "area.csv", "--out", "out"]) == 0
    assert suffixes(Path("out")) == found
    table = Path("out", "growth.csv" if command == "predict" else "aging_data.csv").read_text("utf-8")
    assert ("measured / computed" if command == "predict" else "measured / corrected") in table
    assert "measured times" not in Path("out/summary.txt").read_text("utf-8")
    assert main([command, str(asked), "--quiet", "--figures", "", "--out", "bare"]) == 0
    assert not suffixes(Path("bare"))


@pytest.mark.parametrize("command", ["run", "predict"])
def test_measured_times_outside_the_computed_ones_are_remarked(asked, command):
    Path("late.csv").write_text("time_s,area_um2\n0,0.2\n0.5,0.3\n20,0.4\n")
    assert main([command, str(asked), "--quiet", "--measured", "late.csv", "--out", "out"]) == 0
    text = "2 of 3 measured times are outside the computed ones, 100 ms to 10 s"
    for name in ("summary.txt", *["prediction.html"] * (command == "predict")):
        assert text in Path("out", name).read_text("utf-8")


RAMP = '[[protocol]]\nkind = "ramp"\nduration = "10 s"\npressure = "60 MPa"\n'


@pytest.mark.parametrize("protocol", ["", RAMP])
def test_measured_areas_are_over_those_corrected_for_pixel_rims(asked, protocol):
    text = asked.read_text()
    asked.write_text(text.replace('last = "10 s"\n', "") + protocol if protocol else text)
    assert main(["run", str(asked), "--quiet", "--figures", "", "--out", "out"]) == 0
    data = asp.results.load("out")
    rows = np.c_[data["time"].values[1:], 1e12 * data["contact_area_corrected"].values[1:]]
    np.savetxt("own.csv", rows, delimiter=",", header="time_s,area_um2", comments="")
    assert main(["run", str(asked), "--quiet", "--measured", "own.csv", "--out", "again"]) == 0
    name = "history" if protocol else "aging_data"
    table = Path(f"again/{name}.csv").read_text("utf-8")
    ratios = csv.DictReader(line for line in table.splitlines() if line and line[0] != "#")
    found = [float(row["measured / corrected"]) for row in ratios if row["measured / corrected"]]
    assert found == pytest.approx(np.ones(len(rows)), rel=1e-9)


@pytest.mark.slow
def test_single_figures_never_replace_the_table_that_they_are_about(asperity):
    text = "time_s,area\n" + "".join(f"{t},{1 + 0.1 * np.log(t)}\n" for t in (1, 3, 10, 30, 100, 300))
    Path("fit.csv").write_text(text)
    for more in ((), ("--overwrite",)):
        status, said, _ = asperity("fit", "fit.csv", "--figures", "pdf, svg", *more)
        assert (status, Path("fit.csv").read_text()) == (0, text)
        assert "fit.pdf, fit.svg; its data: fit_data.csv" in said
    # Nor is that of another figure replaced by its own.
    assert asperity("fit", "fit_data.csv", "--columns", "0 1", "--out", "fit_data.png", "--overwrite")[0] == 0
    assert Path("fit_data_data.csv").exists()
    assert asperity("fit", "fit.csv", "--figures", "pdf")[0] == 2  # it is there
    assert "expected some of png, pdf, svg, got jpg" in asperity("fit", "fit.csv", "--figures", "jpg")[2]
    np.savetxt("rough.csv", np.arange(64.0).reshape(8, 8) % 5, delimiter=",")
    before = Path("rough.csv").read_bytes()
    assert asperity("surface", "rough.csv", "--figures", "pdf", "png")[0] == 0
    assert Path("rough.csv").read_bytes() == before
    assert {path.name for path in Path().glob("rough*")} == {
        "rough.csv",
        "rough.pdf",
        "rough.png",
        "rough_data.csv",
    }


def test_no_figures_are_written_where_none_are_asked_for(asperity):
    text = "time_s,friction\n" + "".join(f"{t},{0.6 + 0.01 * np.log(t)}\n" for t in (1, 3, 10, 30, 100, 300))
    Path("fit.csv").write_text(text)
    np.savetxt("rough.csv", np.arange(64.0).reshape(8, 8) % 5, delimiter=",")
    for command in (("fit", "fit.csv"), ("surface", "rough.csv")):
        status, said, _ = asperity(*command, "--figures", "")
        assert status == 0
        assert "written" not in said
    assert {path.name for path in Path().iterdir()} == {"fit.csv", "rough.csv"}


@pytest.mark.slow
def test_a_campaign_is_drawn_in_the_formats_of_its_file(asperity):
    plan = Path("plan.toml")
    base = "[surface]\nshape = [8, 8]\n[aging]\nlast = 1.0\nper_decade = 1\n"
    base += "[sweep]\nload = [2.0, 4.0]\n[output]\n"
    plan.write_text(base + 'figures = ["svg"]\n')
    assert asperity("sweep", "plan.toml", "--out", "study", "--workers", "1", "--quiet")[0] == 0
    assert asperity("gather", "study")[0] == 0
    names = {path.name for path in Path("study").glob("gathered*")}
    assert names == {"gathered.csv", "gathered.svg", "gathered.zarr", "gathered_data.csv"}
    assert asperity("gather", "study", "--figures", "pdf")[0] == 0
    assert Path("study", "gathered.pdf").exists()
    assert asperity("gather", "study", "--to", "bare.zarr", "--figures", "")[0] == 0
    assert {path.name for path in Path().glob("bare*")} == {"bare.csv", "bare.zarr"}
    plan.write_text(base + 'measured = "area.csv"\n')
    with pytest.raises(ConfigError, match="measured: expected none in a campaign"):
        read_plan(plan)


def test_the_table_of_another_figure_is_not_replaced(asperity, tmp_path):
    np.savetxt("scan.txt", np.random.default_rng(0).normal(size=(16, 16)))
    scan = ("surface", "scan.txt", "--file-unit", "um", "--pixel-size", "1um")
    assert asperity(*scan, "--out", "b.pdf")[0] == 0
    table = Path("b.csv").read_bytes()
    status, _, errors = asperity(*scan, "--tilt", "none", "--out", "b.svg")
    assert (status, "b.csv, which exists" in errors) == (2, True)
    assert Path("b.csv").read_bytes() == table
    assert not Path("b.svg").exists()
    assert asperity(*scan, "--tilt", "none", "--out", "b.svg", "--overwrite")[0] == 0
    assert Path("b.csv").read_bytes() != table
