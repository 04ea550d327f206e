"""Histories, the Dataset, and its way to disk and back."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import asperity as asp
from asperity.errors import InputError, OutputError
from asperity.results.store import whole_folder
from tests.independent import prove
from tests.refusals import refuses
from tests.surfaces import uncorrelated

SOLID = asp.solids.spring_lattice(k0=1.0, k1=3.0, R_viscous=0.1)
CONTACT = asp.press(uncorrelated(12), SOLID, load=10.0)
HISTORY = asp.age(CONTACT, [0.1, 1.0, 10.0], fields_at=[0.0, 1.0, 3.0])


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    """Refusals have paths in them, which are short here."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_time_series():
    data = HISTORY.dataset
    np.testing.assert_array_equal(data["time"], [0.0, 0.1, 1.0, 10.0])
    assert data["area"].values[0] == CONTACT.area
    assert data["area"].values[-1] == HISTORY.final.area
    assert data["area"].dtype.kind == "i"
    np.testing.assert_allclose(data["load"], 10.0, rtol=1e-10)
    assert data["separation"].values[0] == CONTACT.separation
    assert data["energy"].values[-1] == HISTORY.final.energy
    for time in (0.0, 1.0):
        u, u0 = (data[name].sel(field_time=time).values for name in ("u", "u0"))
        proof = prove(data["heights"].values, u, u0, k0=1.0, k1=3.0)
        worst = max(proof.largest_pull, proof.largest_force_off_contact, abs(proof.load / 10.0 - 1))
        assert float(data["residual"].sel(time=time)) == pytest.approx(worst, abs=1e-13)
    assert (data["steps"].values[1:] >= 1).all()
    assert (data["iterations"].values[1:] >= 1).all()
    np.testing.assert_allclose(data["contact_fraction"], data["area"] / 144)
    np.testing.assert_array_equal(data["field_time"], [0.0, 1.0, 3.0])
    assert data["u"].dims == ("field_time", "y", "x")
    np.testing.assert_array_equal(data["u"].values[0], CONTACT.u)
    np.testing.assert_array_equal(data["in_contact"].values[1].sum(), data["area"].sel(time=1.0))
    np.testing.assert_array_equal(data["in_contact"], data["u"] == data["heights"])
    line = asp.age(asp.press(uncorrelated(16)[0], SOLID, load=2.0), [1.0], fields_at=[1.0]).dataset
    assert line["u"].dims == ("field_time", "x")


def needs_no_parsing(attributes):
    """Whether each attribute is a number, a word, or a flat list, as netCDF wants it."""
    flat = (str, int, float)
    return all(
        isinstance(value, flat) or (value and all(isinstance(one, flat) for one in value))
        for value in attributes.values()
    )


def test_every_parameter_is_an_attribute_of_its_own(tmp_path):
    heights = asp.surfaces.spectral((16, 16), hurst=0.8, spacing=1e-6, rms_slope=0.1, seed=1)
    rough = asp.surfaces.Surface(
        heights, "m", (1e-6, 1e-6), "m", {"kind": "spectral", "hurst": 0.8, "cut": ""}
    )
    film = asp.solids.coated_half_space(
        modulus=3e9, poisson=0.3, thickness=3e-6, branches=[(0.3, 0.1), (0.2, 5.0)],
        base_modulus=1e9, base_poisson=0.4, base_branches=[(0.1, 2.0)],
    )  # fmt: skip
    legs = [asp.protocols.Hold(1.0), asp.protocols.Repeat([asp.protocols.Step(load=2e-4)], 2)]
    data = asp.age(asp.press(rough, film, load=1e-4), [1.0], protocol=legs).dataset
    attrs = data.attrs
    assert (attrs["held"], attrs["held_load"], attrs["asperity_version"]) == ("load", 1e-4, asp.__version__)
    assert attrs["rtol"] > 0
    assert json.loads(attrs["surface"])["hurst"] == 0.8
    assert needs_no_parsing(attrs)
    assert (attrs["branch_shares"], attrs["branch_times"]) == ([0.3, 0.2], [0.1, 5.0])
    assert (attrs["base_branch_shares"], attrs["base_branch_times"]) == ([0.1], [2.0])
    assert (attrs["surface_hurst"], "surface_cut" in attrs) == (0.8, False)
    assert attrs["protocol_in_words"] == "hold 1, repeat 2 (step load=0.0002)"
    units = dict(one.split() for one in attrs["parameter_units"].split(", "))
    assert units == {
        "modulus": "Pa", "thickness": "m", "branch_times": "s", "base_modulus": "Pa",
        "base_branch_times": "s", "held_load": "N",
    }  # fmt: skip
    flowing = asp.solids.half_space(modulus=3e9, flow=(1e-12, -1.0))
    attrs = asp.age(asp.press(rough, flowing, load=1e-4), [1.0]).dataset.attrs
    assert (attrs["flow_mobility"], attrs["flow_exponent"]) == (1e-12, -1.0)
    assert asp.age(CONTACT, [1.0]).dataset.attrs["parameter_units"].startswith("held_load stiffness unit * ")


def test_netcdf_and_back(tmp_path):
    HISTORY.dataset.to_netcdf(tmp_path / "history.nc")
    again = xr.load_dataset(tmp_path / "history.nc")
    for name, values in HISTORY.dataset.variables.items():
        np.testing.assert_array_equal(again[name], values)
        assert again[name].attrs["units"] == values.attrs["units"]
    assert again.attrs["held_load"] == 10.0


def test_results_of_versions_that_left_out_chunks_of_zeros_are_read(tmp_path):
    HISTORY.dataset.to_zarr(tmp_path / "run.zarr", consolidated=False)
    (tmp_path / "run.zarr" / "rejected" / "c" / "0").unlink(missing_ok=True)
    assert (asp.results.load(tmp_path / "run.zarr")["rejected"] == HISTORY.dataset["rejected"]).all()


def test_the_table_of_a_history_has_a_row_for_each_time():
    legs = [asp.protocols.Hold(1.0), asp.protocols.Step(load=5.0)]
    history = asp.age(CONTACT, [0.5], protocol=legs, fields_at=[0.5])
    table = history.table
    assert table.index.name == "time"
    assert len(table) == history.time.size == 4
    assert {"area", "load", "separation", "residual", "leg"} <= set(table)
    assert not {"heights", "u", "in_contact", "patches"} & set(table)
    for name in map(str, table):
        np.testing.assert_array_equal(table[name], history[name])


def test_a_history_gives_its_series_by_name():
    for name in ("time", "area", "load", "separation", "energy", "u", "heights"):
        assert HISTORY[name].identical(HISTORY.dataset[name])
    for name in ("time", "area", "load", "separation"):
        assert getattr(HISTORY, name).identical(HISTORY.dataset[name])
    for wrong in ("seperation", "dims", 3):
        with refuses("name"):
            HISTORY[wrong]  # type: ignore[index]


def test_what_was_saved_is_read_again_and_kept_unless_told_otherwise(here):
    HISTORY.save("run.zarr")
    (here / "run.zarr" / ".DS_Store").write_bytes(b"")  # files of others warn nobody: a warning is an error
    xr.testing.assert_identical(asp.results.load("run.zarr"), HISTORY.dataset)
    assert xr.open_zarr("run.zarr")["area"].size == 4
    with refuses(kind=OutputError):
        HISTORY.save("run.zarr")
    asp.age(CONTACT, [0.1]).save("run.zarr", overwrite=True)
    assert asp.results.load("run.zarr").sizes["time"] == 2
    assert [path.name for path in here.iterdir()] == ["run.zarr"]


def test_what_cannot_be_written_is_left_alone(here):
    (here / "precious").mkdir()
    (here / "precious" / "thesis.tex").write_text("years of work")
    for overwrite in (False, True):
        with refuses(kind=OutputError):
            HISTORY.save("precious", overwrite=overwrite)
    with pytest.raises(OutputError, match="could not write"):
        HISTORY.save("precious/thesis.tex/run.zarr")
    for name in ("history.nc", "history.H5"):
        with refuses("path"):
            HISTORY.save(name)

    def write_half(*, overwrite):
        with whole_folder(Path("precious" if overwrite else "run"), overwrite=overwrite) as folder:
            (folder / "half").write_text("written")
            raise KeyboardInterrupt if overwrite else OSError(28, "No space left on device")

    with pytest.raises(OutputError, match="No space left on device; nothing was left there"):
        write_half(overwrite=False)
    with pytest.raises(KeyboardInterrupt):
        write_half(overwrite=True)
    assert [path.name for path in here.rglob("*")] == ["precious", "thesis.tex"]
    assert (here / "precious" / "thesis.tex").read_text() == "years of work"


def test_what_is_no_result_is_refused(here):
    (here / "empty").mkdir()
    (here / "other").mkdir()
    (here / "other" / "notes.txt").write_text("hello")
    for name in ("missing", "empty", "other"):
        with refuses("path"):
            asp.results.load(name)


DAMAGES = {
    "a byte of the numbers": ("u/c/0/0/0", lambda content: content[:600] + b"?" + content[601:]),
    "half of the numbers": ("area/c/0", lambda content: content[: len(content) // 2]),
    "a description of another type": (
        "area/zarr.json",
        lambda _: b'{"zarr_format": 3, "node_type": "array"}',
    ),
    "a description that is none": ("zarr.json", lambda _: b"[0]"),
    "a name that is none": ("u/zarr.json", lambda content: content.replace(b'"field_time"', b"[0]")),
    "a lost chunk of zeros": ("rejected/c/0", None),  # which zarr would read as zeros
    "lost times": ("time/c/0", None),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_results_are_refused_in_one_line(here, damage):
    HISTORY.save("run.zarr")
    name, change = DAMAGES[damage]
    file = here / "run.zarr" / name
    if change is None:
        file.unlink()
    else:
        file.write_bytes(change(file.read_bytes()))
    with pytest.raises(InputError, match=r"path: expected a folder that asperity wrote, got .*: ") as raised:
        asp.results.load("run.zarr")
    assert "\n" not in str(raised.value)
