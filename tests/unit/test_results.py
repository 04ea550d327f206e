"""Histories, the Dataset, and its way to disk and back."""

import json

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


def names(folder):
    return [path.name for path in folder.iterdir()]


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


def test_fields_at_requested_times_only():
    data = HISTORY.dataset
    np.testing.assert_array_equal(data["field_time"], [0.0, 1.0, 3.0])
    assert data["u"].dims == ("field_time", "y", "x")
    np.testing.assert_array_equal(data["u"].values[0], CONTACT.u)
    np.testing.assert_array_equal(data["in_contact"].values[1].sum(), data["area"].sel(time=1.0))
    np.testing.assert_array_equal(data["in_contact"], data["u"] == data["heights"])


def test_everything_explains_itself():
    data = HISTORY.dataset
    for variable in data.variables.values():
        assert variable.attrs["long_name"]
        assert variable.attrs["units"]
    assert data.attrs["k1"] == 3.0
    assert data.attrs["R_viscous"] == 0.1
    assert data.attrs["held"] == "load"
    assert data.attrs["held_load"] == 10.0
    assert data.attrs["asperity_version"] == asp.__version__
    assert data.attrs["rtol"] > 0


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


def test_the_origin_of_measured_heights_is_recorded(tmp_path):
    np.save(tmp_path / "rough.npy", uncorrelated(6))
    surface = asp.surfaces.read(tmp_path / "rough.npy")
    data = asp.age(asp.press(surface, SOLID, load=1.0), [1.0]).dataset
    assert json.loads(data.attrs["surface"])["file"] == "rough.npy"


def test_one_dimensional_contacts_have_one_axis():
    contact = asp.press(uncorrelated(16)[0], SOLID, load=2.0)
    data = asp.age(contact, [1.0], fields_at=[1.0]).dataset
    assert data["u"].dims == ("field_time", "x")


def test_what_is_printed_is_short():
    assert repr(CONTACT).startswith(f"<Contact: {CONTACT.area} of 12 x 12 sites touch, load 10, separation ")
    assert repr(HISTORY).startswith(f"<History: 4 times to 10, area {CONTACT.area} to ")


def test_progress_sees_every_stop():
    seen = []
    asp.age(CONTACT, [0.1, 1.0], fields_at=[0.5], progress=lambda frame: seen.append(frame.time))
    assert seen == [0.0, 0.1, 0.5, 1.0]


def test_saved_and_reopened_without_loss(tmp_path):
    HISTORY.save(tmp_path / "run.zarr")
    xr.testing.assert_identical(asp.results.load(tmp_path / "run.zarr"), HISTORY.dataset)


def test_what_exists_is_kept_unless_told_otherwise(tmp_path):
    path = tmp_path / "run.zarr"
    HISTORY.save(path)
    with pytest.raises(OutputError, match="exists already and is kept"):
        HISTORY.save(path)
    shorter = asp.age(CONTACT, [0.1])
    shorter.save(path, overwrite=True)
    assert asp.results.load(path).sizes["time"] == 2
    assert names(tmp_path) == ["run.zarr"]


@pytest.mark.parametrize("overwrite", [False, True])
def test_a_folder_that_save_did_not_write_is_never_replaced(tmp_path, overwrite):
    (tmp_path / "precious").mkdir()
    (tmp_path / "precious" / "thesis.tex").write_text("years of work")
    with pytest.raises(OutputError, match="kept"):
        HISTORY.save(tmp_path / "precious", overwrite=overwrite)
    assert (tmp_path / "precious" / "thesis.tex").read_text() == "years of work"


def test_a_failed_write_leaves_nothing(tmp_path):
    def write_half():
        with whole_folder(tmp_path / "run") as folder:
            (folder / "half").write_text("written")
            raise OSError(28, "No space left on device")

    with pytest.raises(OutputError, match="No space left on device; nothing was left there"):
        write_half()
    assert names(tmp_path) == []


def test_a_failed_overwrite_keeps_what_was_there(tmp_path):
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "old").write_text("precious")
    with pytest.raises(KeyboardInterrupt), whole_folder(tmp_path / "run", overwrite=True):
        raise KeyboardInterrupt
    assert (tmp_path / "run" / "old").read_text() == "precious"
    assert names(tmp_path) == ["run"]


def test_a_folder_where_none_can_be(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="could not write"):
        HISTORY.save(tmp_path / "file" / "run.zarr")


@pytest.mark.parametrize("kind", ["missing", "empty", "other"])
def test_loading_what_is_no_result(tmp_path, kind):
    path = tmp_path / "thing"
    if kind != "missing":
        path.mkdir()
    if kind == "other":
        (path / "notes.txt").write_text("hello")
    with pytest.raises(InputError, match="path: expected a folder that asperity wrote"):
        asp.results.load(path)


DAMAGES = {
    "a byte of the numbers": ("u/c/0/0/0", lambda content: content[:-9] + b"?" + content[-8:]),
    "half of the numbers": ("area/c/0", lambda content: content[: len(content) // 2]),
    "a description of another type": (
        "area/zarr.json",
        lambda _: b'{"zarr_format": 3, "node_type": "array"}',
    ),
    "a description that is none": ("zarr.json", lambda _: b"[0]"),
    "a name that is none": ("u/zarr.json", lambda content: content.replace(b'"field_time"', b"[0]")),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_results_are_refused_in_one_line(tmp_path, damage):
    HISTORY.save(tmp_path / "run.zarr")
    file, change = DAMAGES[damage]
    (tmp_path / "run.zarr" / file).write_bytes(change((tmp_path / "run.zarr" / file).read_bytes()))
    with pytest.raises(InputError, match=r"path: expected a folder that asperity wrote, got .*: ") as raised:
        asp.results.load(tmp_path / "run.zarr")
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("lost", ["u/c/0/0/0", "rejected/c/0", "time/c/0"])
def test_a_chunk_that_is_missing_is_no_zero(
    tmp_path, lost
):  # rejected is 0 at all times, and a chunk all the same
    HISTORY.save(tmp_path / "run.zarr")
    (tmp_path / "run.zarr" / lost).unlink()
    with pytest.raises(InputError, match=f"path: .*: parts of {lost.split('/')[0]} are missing"):
        asp.results.load(tmp_path / "run.zarr")


def test_results_of_versions_that_left_out_chunks_of_zeros_are_read(tmp_path):
    HISTORY.dataset.to_zarr(tmp_path / "run.zarr", consolidated=False)
    (tmp_path / "run.zarr" / "rejected" / "c" / "0").unlink(missing_ok=True)
    assert (asp.results.load(tmp_path / "run.zarr")["rejected"] == HISTORY.dataset["rejected"]).all()


def test_files_of_others_in_the_folder_of_results_warn_nobody(tmp_path):  # a warning is an error here
    HISTORY.save(tmp_path / "run.zarr")
    (tmp_path / "run.zarr" / ".DS_Store").write_bytes(b"")
    assert asp.results.load(tmp_path / "run.zarr").identical(HISTORY.dataset)


@pytest.mark.parametrize("name", ["history.nc", "history.H5"])
def test_names_of_other_formats_are_refused(tmp_path, name):
    with pytest.raises(InputError, match=r"path: expected a name that ends in \.zarr, got .*to_netcdf"):
        HISTORY.save(tmp_path / name)
    HISTORY.save(tmp_path / "history.zarr")
    assert (
        xr.open_zarr(tmp_path / "history.zarr")["area"].size == 4
    )  # without a warning, which is an error here


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
