"""Histories and contacts: their Datasets, what the table of quantities says of them, and the way to disk."""

import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import asperity as asp
from asperity.errors import ConvergenceError, InputError, OutputError
from asperity.results.quantities import QUANTITIES, select
from asperity.results.store import whole_folder
from tests.independent import laplacian, prove
from tests.refusals import each_refuses, refuses
from tests.surfaces import uncorrelated

SPRINGS = asp.solids.spring_lattice(k0=1.0, k1=3.0, R_viscous=0.1)
CONTACT = asp.press(uncorrelated(12), SPRINGS, load=10.0)
HISTORY = asp.age(CONTACT, [0.1, 1.0, 10.0], fields_at=[0.0, 1.0, 3.0])
ROUGH = asp.surfaces.self_affine(32, hurst=0.8, delta=0.1, seed=0)
SCAN = asp.surfaces.Surface(ROUGH * 1e-6, "m", (1e-6, 2e-6), "m", edges="reflecting")
ELASTIC = asp.solids.half_space(modulus=1e9)
EYRING = asp.solids.half_space(modulus=1e9, creep=asp.solids.Eyring(rate=1e-9, stress=1e7))
LAYER = asp.solids.layer(modulus=1e9, poisson=0.3, thickness=1e-5)
pytestmark = pytest.mark.usefixtures("here")


def test_the_series_and_fields_are_those_of_the_contacts():
    data = HISTORY.dataset
    np.testing.assert_array_equal(data["time"], [0.0, 0.1, 1.0, 10.0])
    np.testing.assert_array_equal(data["field_time"], [0.0, 1.0, 3.0])
    for name in ("area", "separation", "energy", "load", "rms_gap"):
        ends = [getattr(contact, name) for contact in (CONTACT, HISTORY.final)]
        np.testing.assert_array_equal(data[name].values[[0, -1]], ends)
    np.testing.assert_allclose(data["load"], 10.0, rtol=1e-10)
    for time in (0.0, 1.0):
        u, u0 = (data[name].sel(field_time=time).values for name in ("u", "u0"))
        proof = prove(data["heights"].values, u, u0, k0=1.0, k1=3.0)
        worst = max(proof.largest_pull, proof.largest_force_off_contact, abs(proof.load / 10.0 - 1))
        assert float(data["residual"].sel(time=time)) == pytest.approx(worst, abs=1e-13)
    assert min(data[name].values[1:].min() for name in ("steps", "iterations")) >= 1
    np.testing.assert_allclose(data["contact_fraction"], data["area"] / 144)
    assert data["u"].dims == ("field_time", "y", "x")
    np.testing.assert_array_equal(data["u"].values[0], CONTACT.u)
    assert data["in_contact"].values[1].sum() == data["area"].sel(time=1.0)
    np.testing.assert_array_equal(data["in_contact"], data["u"] == data["heights"])
    line = asp.age(asp.press(uncorrelated(16)[0], SPRINGS, load=2.0), [1.0], fields_at=[1.0]).dataset
    assert line["u"].dims == ("field_time", "x")


def test_every_parameter_is_an_attribute_of_its_own(tmp_path):
    heights = asp.surfaces.spectral((16, 16), hurst=0.8, spacing=1e-6, rms_slope=0.1, seed=1)
    origin = {"kind": "spectral", "hurst": 0.8, "cut": ""}
    rough = asp.surfaces.Surface(heights, "m", (1e-6, 1e-6), "m", origin)
    film = asp.solids.coated_half_space(
        modulus=3e9, poisson=0.3, thickness=3e-6, branches=[(0.3, 0.1), (0.2, 5.0)],
        base_modulus=1e9, base_poisson=0.4, base_branches=[(0.1, 2.0)],
    )  # fmt: skip
    legs = [asp.protocols.Hold(1.0), asp.protocols.Repeat([asp.protocols.Step(load=2e-4)], 2)]
    data = asp.age(asp.press(rough, film, load=1e-4), [1.0], protocol=legs).dataset
    attrs = data.attrs
    assert attrs["rtol"] > 0
    assert json.loads(attrs["surface"])["hurst"] == 0.8
    for value in attrs.values():  # numbers, words, or flat lists, as netCDF wants them
        assert value == [] or all(isinstance(one, (str, int, float)) for one in np.atleast_1d(value).tolist())
    assert "surface_cut" not in attrs
    assert attrs.items() >= {
        "held": "load", "held_load": 1e-4, "asperity_version": asp.__version__, "surface_hurst": 0.8,
        "branch_shares": [0.3, 0.2], "branch_times": [0.1, 5.0], "base_branch_shares": [0.1],
        "base_branch_times": [2.0], "protocol_in_words": "hold 1, repeat 2 (step load=0.0002)",
    }.items()  # fmt: skip
    units = dict(one.split() for one in attrs["parameter_units"].split(", "))
    assert units == {
        "modulus": "Pa", "thickness": "m", "branch_times": "s", "base_modulus": "Pa",
        "base_branch_times": "s", "held_load": "N",
    }  # fmt: skip
    flowing = asp.solids.half_space(modulus=3e9, flow=(1e-12, -1.0))
    attrs = asp.age(asp.press(rough, flowing, load=1e-4), [1.0]).dataset.attrs
    assert (attrs["flow_mobility"], attrs["flow_exponent"]) == (1e-12, -1.0)
    assert asp.age(CONTACT, [1.0]).dataset.attrs["parameter_units"].startswith("held_load stiffness unit * ")


def test_netcdf_and_back(here):
    HISTORY.dataset.to_netcdf("history.nc")
    xr.testing.assert_identical(xr.load_dataset("history.nc"), HISTORY.dataset)


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
        assert table.attrs["units"][name] == history[name].attrs["units"]
    assert table.attrs["units"]["time"] == history.time.attrs["units"]


def test_a_history_gives_its_series_by_name():
    for name in ("time", "area", "load", "separation"):
        assert getattr(HISTORY, name).identical(HISTORY[name])
    assert HISTORY["u"].identical(HISTORY.dataset["u"])
    each_refuses(
        *(("name", HISTORY.__getitem__, wrong) for wrong in ("seperation", "dims", 3)),
        got="'seperation' | 'dims' | 3",
    )


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
    each_refuses(
        *(("path", HISTORY.save, name) for name in ("history.nc", "history.H5")),
        got="history.nc | history.H5",
    )

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
    for name in ("empty", "other"):
        (here / name).mkdir()
    (here / "other" / "notes.txt").write_text("hello")
    each_refuses(*(("path", name, asp.results.load, name) for name in ("missing", "empty", "other")))


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("u/c/0/0/0", lambda content: content[:600] + b"?" + content[601:]),
        ("area/c/0", lambda content: content[: len(content) // 2]),
        ("area/zarr.json", lambda _: b'{"zarr_format": 3, "node_type": "array"}'),
        ("zarr.json", lambda _: b"[0]"),
        ("u/zarr.json", lambda content: content.replace(b'"field_time"', b"[0]")),
        ("rejected/c/0", None),  # lost; zarr would read it as zeros
    ],
)
def test_damaged_results_are_refused_in_one_line(here, name, change):
    HISTORY.save("run.zarr")
    file = here / "run.zarr" / name
    content = file.read_bytes()
    file.unlink()
    if change is not None:
        file.write_bytes(change(content))
    with pytest.raises(InputError, match=r"path: expected a folder that asperity wrote, got .*: ") as raised:
        asp.results.load("run.zarr")
    assert "\n" not in str(raised.value)


def test_the_rms_gap_is_that_of_the_heights_at_first_touch_and_nothing_in_full_contact() -> None:
    half_space = asp.solids.half_space(modulus=2.0)
    for heights, solid in (
        (uncorrelated(8), SPRINGS),
        (uncorrelated(8)[0], SPRINGS),
        (uncorrelated(8), half_space),
    ):
        # An undeformed body at the highest site: the gap is max(h) - h.
        expected = math.hypot(np.std(heights), np.max(heights) - np.mean(heights))
        assert asp.press(heights, solid, load=0.0).rms_gap == pytest.approx(expected, rel=1e-12)
        assert asp.press(heights, solid, load=1e6).rms_gap == 0.0
        some = asp.press(heights, solid, load=20.0)
        expected = float(np.linalg.norm(some.u - heights)) / math.sqrt(heights.size)
        assert some.rms_gap == pytest.approx(expected, rel=1e-12)


SPRUNG = asp.press(uncorrelated(8), SPRINGS, load=8.0)
HISTORIES: dict[str, asp.History] = {
    "sites": asp.age(SPRUNG, [1.0], fields_at=[1.0]),
    "continua": asp.age(asp.press(SCAN, LAYER, load=1e-4), [1.0], fields_at=[1.0]),
    "yielding": asp.age(
        asp.press(uncorrelated(8), SPRINGS.with_hardness(1.0), load=8.0), [1.0], fields_at=[1.0]
    ),
    "sliding": asp.age(SPRUNG, [1.0], protocol=[asp.protocols.Slide(2.0, velocity=1.0)], fields_at=[1.0]),
}


@pytest.mark.parametrize("kind", HISTORIES)
def test_a_history_has_what_the_table_says_each_with_its_name_and_unit(kind: str) -> None:
    history = HISTORIES[kind]
    base = "continua" if kind == "continua" else "sites"
    said = select(of=("all", base, kind))
    here = set(map(str, history.dataset.variables))
    optional = {"branch", "leg", "field_leg", "clustering", "displacement"}  # of several branches; of legs
    assert said.keys() - select("contact") - optional <= here <= said.keys()
    assert set(map(str, history.final.dataset.variables)) >= select("contact", of=("all", base)).keys()
    for name in here - {"branch"}:
        assert history.dataset[name].attrs["long_name"] == said[name].long_name
        assert history.dataset[name].attrs["units"]
        assert not said[name].whole or history.dataset[name].dtype.kind == "i"


def test_forces_of_springs_are_kept_and_follow_from_the_fields_where_they_are_not() -> None:
    history = HISTORIES["sites"]
    kept = history.dataset.isel(field_time=0)
    np.testing.assert_array_equal(kept["force"], history.final.force)
    u, u0 = kept["u"].values, kept["u0"].values
    np.testing.assert_allclose(kept["force"], 3.0 * (u - u0) - laplacian(u), atol=1e-8)
    with_them = asp.analysis.patch_table(kept)
    changed = kept.assign(force=2 * kept["force"])  # what is recorded is read
    np.testing.assert_array_equal(asp.analysis.patch_table(changed)["load"], 2 * with_them["load"])


def test_the_page_on_notation_has_every_symbol() -> None:
    page = (Path(__file__).parents[2] / "docs" / "notation.md").read_text(encoding="utf-8")
    symbols: dict[str, set[str]] = {}
    for line in page.splitlines():
        if line.startswith("| "):
            _, symbol, names, _ = (cell.strip() for cell in line.split("|")[1:-1])
            for name in re.findall(r"`(\w+)`", names):
                symbols.setdefault(name, set()).add(symbol.replace("*", ""))
    wrong = [one.name for one in QUANTITIES if one.symbol and one.symbol not in symbols.get(one.name, ())]
    assert not wrong


KINDS: dict[str, tuple[Any, asp.solids.Solid, Any]] = {
    "springs": (ROUGH, SPRINGS, {"load": 30.0}),
    "a line": (uncorrelated(12)[0], SPRINGS, {"separation": 0.5}),
    "elastic": (SCAN, ELASTIC, {"load": 1e-3}),
    "two branches": (
        SCAN,
        asp.solids.half_space(modulus=1e9, branches=[(0.3, 1.0), (0.2, 10.0)]),
        {"load": 1e-3},
    ),
    "an offset": (uncorrelated(16) + 1e3, SPRINGS, {"load": 1e-2}),
    "a law and a hardness": (SCAN, EYRING.with_hardness(3e7), {"load": 1e-3}),
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_contact_that_was_read_ages_as_the_one_that_was_saved(tmp_path, kind):
    heights, solid, control = KINDS[kind]
    contact: asp.Contact = asp.press(heights, solid, **control)
    saved = asp.age(contact, [0.5, 1.0]).final
    saved.save(tmp_path / "contact.zarr")
    read = asp.results.load_contact(tmp_path / "contact.zarr", solid)
    for name in ("heights", "in_contact", "permanent_indentation"):
        np.testing.assert_array_equal(getattr(read, name), getattr(saved, name))
    for name in ("u", "anchors"):
        last_digit = np.spacing(np.abs(getattr(saved, name)).max(initial=0.0))
        np.testing.assert_allclose(getattr(read, name), getattr(saved, name), atol=2 * last_digit, rtol=0)
    assert (read.control, read.lattice, read.si) == (saved.control, saved.lattice, saved.si)
    assert read.surface == saved.surface
    assert read.residual <= 1e-8
    later, expected = (asp.age(one, [1.0, 100.0]).final for one in (read, saved))
    np.testing.assert_array_equal(later.in_contact, expected.in_contact)
    np.testing.assert_allclose(later.u, expected.u, atol=1e-9 * np.ptp(expected.u))


def test_another_solid_is_refused(tmp_path):
    contact = asp.press(ROUGH, SPRINGS, load=30.0)
    contact.save(tmp_path / "contact.zarr")
    others = asp.solids.spring_lattice(k0=1.0, k1=2.0, R=1.0), asp.solids.half_space(modulus=1.0), None
    each_refuses(
        *(("solid", asp.results.load_contact, tmp_path / "contact.zarr", one) for one in others),
        got="k1 2.0, R_viscous 0.0 | 1.0 | NoneType",
    )
    mine, other = (asp.solids.Solid(asp.solids.LaplacianSpectrum(k0, 1.0)) for k0 in (0.0, 1.0))
    asp.press(ROUGH, mine, load=30.0).save(tmp_path / "own.zarr")
    with pytest.raises(ConvergenceError, match="residual"):  # without numbers the equilibrium tells
        asp.results.load_contact(tmp_path / "own.zarr", other)


def test_a_saved_history_is_no_contact():
    asp.age(asp.press(ROUGH, SPRINGS, load=30.0), [1.0]).save("history.zarr")
    each_refuses(
        ("path", asp.results.load_contact, "history.zarr", SPRINGS),
        ("contact", "Dataset", asp.age, asp.results.load("history.zarr"), [1.0]),
    )


def test_several_loads_give_the_contacts_of_each():
    given: dict[str, Any] = {
        "load": np.array([10.0, 30.0]),
        "pressure": (0.01, 0.03),
        "separation": [0.1, 0.0],
    }
    for name, values in given.items():
        found: list[asp.Contact] = asp.press(ROUGH, SPRINGS, **{name: values})
        for one, value in zip(found, values, strict=True):
            np.testing.assert_array_equal(one.u, asp.press(ROUGH, SPRINGS, **{name: value}).u)
        assert found[0].area < found[1].area


def test_several_loads_with_units_or_on_an_aged_contact():
    loads = [contact.load for contact in asp.press(SCAN, ELASTIC, load=["1 mN", "2 mN"])]
    np.testing.assert_allclose(loads, [1e-3, 2e-3])
    aged = asp.age(asp.press(ROUGH, SPRINGS, load=30.0), [1.0]).final
    lighter = asp.press(aged, load=10.0)
    assert [one.area for one in asp.press(aged, load=[30.0, 10.0])] == [aged.area, lighter.area]
    with refuses("load", "[2.0]"):
        asp.press(ROUGH, SPRINGS, load=[1.0, [2.0]])  # type: ignore[arg-type]
