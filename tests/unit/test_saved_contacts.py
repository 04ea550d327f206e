"""A contact on disk: all of its maps with units and coordinates, and read again it ages as it would have."""

from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.errors import ConvergenceError
from tests.refusals import refuses
from tests.surfaces import uncorrelated

P = asp.protocols
ROUGH = asp.surfaces.self_affine(32, hurst=0.8, delta=0.1, seed=0)
SCAN = asp.surfaces.Surface(ROUGH * 1e-6, "m", (1e-6, 2e-6), "m", edges="reflecting")
SPRINGS = asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0, R_viscous=0.1)
EYRING = asp.solids.half_space(modulus=1e9, creep=asp.solids.Eyring(rate=1e-9, stress=1e7))
TWO_BRANCHES = asp.solids.half_space(modulus=1e9, branches=[(0.3, 1.0), (0.2, 10.0)])
KINDS: dict[str, tuple[Any, asp.solids.Solid, Any]] = {
    "springs": (ROUGH, SPRINGS, {"load": 30.0}),
    "a line": (uncorrelated(12)[0], SPRINGS, {"separation": 0.5}),
    "elastic": (SCAN, asp.solids.half_space(modulus=1e9), {"load": 1e-3}),
    "two branches": (SCAN, TWO_BRANCHES, {"load": 1e-3}),
    "a law and a hardness": (SCAN, EYRING.with_hardness(3e7), {"load": 1e-3}),
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_contact_that_was_read_ages_as_the_one_that_was_saved(tmp_path, kind):
    heights, solid, control = KINDS[kind]
    contact: asp.Contact = asp.press(heights, solid, **control)
    saved = asp.age(contact, [0.5, 1.0]).final
    saved.save(tmp_path / "contact.zarr")
    read = asp.results.load_contact(tmp_path / "contact.zarr", solid)
    for name in ("heights", "u", "anchors", "in_contact", "permanent_indentation"):
        np.testing.assert_array_equal(getattr(read, name), getattr(saved, name))
    assert (read.control, read.lattice, read.si) == (saved.control, saved.lattice, saved.si)
    assert read.surface == saved.surface
    assert read.residual <= 1e-8
    later, expected = (asp.age(one, [1.0, 100.0]).final for one in (read, saved))
    np.testing.assert_array_equal(later.in_contact, expected.in_contact)
    np.testing.assert_allclose(later.u, expected.u, atol=1e-9 * np.ptp(expected.u))


def test_maps_have_names_units_and_coordinates():
    contact = asp.press(SCAN, EYRING, load=1e-3)
    data = contact.dataset
    for name in ("pressure", "force", "gap", "u", "heights", "in_contact", "anchors"):
        assert data[name].dims[-2:] == ("y", "x")
        np.testing.assert_array_equal(data[name], getattr(contact, name))
    assert all(variable.attrs["long_name"] and variable.attrs["units"] for variable in data.values())
    assert (data["pressure"].attrs["units"], data["x"].attrs["units"]) == ("Pa", "m")
    np.testing.assert_allclose(data["x"], 2e-6 * np.arange(32))
    total = data["pressure"].sum() * 1e-6 * 2e-6
    assert float(total) == pytest.approx(1e-3)
    assert float(data["load"]) == contact.load
    assert int(data["area"]) == contact.area


def test_another_solid_is_refused(tmp_path):
    contact = asp.press(ROUGH, SPRINGS, load=30.0)
    contact.save(tmp_path / "contact.zarr")
    for other in (asp.solids.spring_lattice(k0=1.0, k1=2.0, R=1.0), asp.solids.half_space(modulus=1.0), None):
        with refuses("solid"):
            asp.results.load_contact(tmp_path / "contact.zarr", other)  # type: ignore[arg-type]
    unknown = asp.solids.Solid(asp.solids.LaplacianSpectrum(0.0, 1.0))
    asp.press(ROUGH, unknown, load=30.0).save(tmp_path / "own.zarr")
    with pytest.raises(ConvergenceError, match="residual"):  # without numbers the equilibrium tells
        asp.results.load_contact(
            tmp_path / "own.zarr", asp.solids.Solid(asp.solids.LaplacianSpectrum(1.0, 1.0))
        )


def test_a_saved_history_is_no_contact(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    history = asp.age(asp.press(ROUGH, SPRINGS, load=30.0), [1.0])
    history.save("history.zarr")
    with refuses("path"):
        asp.results.load_contact("history.zarr", SPRINGS)
    with refuses("contact"):
        asp.age(asp.results.load("history.zarr"), [1.0])  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("name", "values"),
    [("load", np.array([10.0, 30.0])), ("pressure", (0.01, 0.03)), ("separation", [0.1, 0.0])],
)
def test_several_loads_give_the_contacts_of_each(name: str, values: Any) -> None:
    found: list[asp.Contact] = asp.press(ROUGH, SPRINGS, **{name: values})
    for one, value in zip(found, values, strict=True):
        np.testing.assert_array_equal(one.u, asp.press(ROUGH, SPRINGS, **{name: value}).u)
    assert found[0].area < found[1].area


def test_several_loads_with_units_or_on_an_aged_contact():
    solid = asp.solids.half_space(modulus=1e9)
    loads = [contact.load for contact in asp.press(SCAN, solid, load=["1 mN", "2 mN"])]
    np.testing.assert_allclose(loads, [1e-3, 2e-3])
    aged = asp.age(asp.press(ROUGH, SPRINGS, load=30.0), [1.0]).final
    lighter = asp.press(aged, load=10.0)
    assert [one.area for one in asp.press(aged, load=[30.0, 10.0])] == [aged.area, lighter.area]
    with refuses("load"):
        asp.press(ROUGH, SPRINGS, load=[1.0, [2.0]])  # type: ignore[arg-type]
