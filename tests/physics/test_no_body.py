"""Bodies that do not cover their lattice: heights of -inf, as if the surroundings were infinitely deep."""

import math
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.analysis.field_values import distributions
from asperity.app.explore.scene import _scene
from asperity.carried.record import quantities
from asperity.errors import InputError
from asperity.protocols import Hold, Ramp, Step
from asperity.solids import Dugdale, Eyring, half_space, layer, spring_lattice
from asperity.surfaces import Surface, spectral, statistics

N = 24
DEEP = -1e3
Y, X = np.indices((N, N)) - (N - 1) / 2
CORE = np.hypot(X, Y) < 0.38 * N
ROUGH = spectral((N, N), hurst=0.8, rms_height=1.0, seed=3)
EYRING = Eyring(rate=0.1, stress=0.5)
SOLIDS = {
    "springs": spring_lattice(k0=1.0, k1=3.0),
    "springs that yield": spring_lattice(k0=1.0, k1=3.0, hardness=1.0),
    "springs by Eyring": spring_lattice(k0=1.0, k1=3.0, creep=EYRING),
    "half-space": half_space(modulus=1.0, branches=[(0.5, 1.0)], hardness=0.5),
    "half-space held": half_space(modulus=1.0, branches=[(0.5, 1.0)], apparatus=math.inf),
    "half-space by Eyring": half_space(modulus=1.0, creep=EYRING),
    "half-space that sticks": half_space(modulus=1.0, adhesion=Dugdale(work=1.0, range=3.0)),
    "layer": layer(modulus=1.0, thickness=10.0, poisson=0.3, branches=[(0.5, 1.0)]),
}
SHAPES = {"rough": ROUGH, "ball": -(X**2 + Y**2) / 60.0, "punch": np.zeros((N, N))}


def core(around, shape="rough", **how):
    return Surface(np.where(CORE, SHAPES[shape], around), **how)


def same(one, other):
    """The contact of a body that ends is that of the body with deep surroundings."""
    assert np.array_equal(one.in_contact, other.in_contact)
    assert one.force == pytest.approx(other.force, abs=1e-7)
    assert one.u == pytest.approx(other.u, abs=1e-6)
    assert one.permanent_indentation == pytest.approx(other.permanent_indentation, abs=1e-6)
    assert one.energy == pytest.approx(other.energy, rel=1e-6)


@pytest.mark.parametrize("name", SOLIDS)
@pytest.mark.parametrize("edges", ["periodic", "reflecting", "free"])
def test_surroundings_are_infinitely_deep(name, edges):
    solid = SOLIDS[name]
    if edges == "free" and (not solid.half_space or "held" in name):
        return
    shape = list(SHAPES)[len(name) % 3]
    no_body, deep = (
        asp.press(core(around, shape, edges=edges), solid, load=20.0) for around in (-np.inf, DEEP)
    )
    same(no_body, deep)
    assert no_body.contact_fraction == no_body.area / CORE.sum()
    assert no_body.nominal_area == CORE.sum() == pytest.approx(math.pi * (0.38 * N) ** 2, rel=0.03)
    assert no_body.mean_gap == pytest.approx(deep.gap[CORE].mean(), abs=1e-7)
    assert no_body.rms_gap == pytest.approx(np.sqrt(np.mean(deep.gap[CORE] ** 2)), abs=1e-7)


@pytest.mark.parametrize("name", SOLIDS)
def test_histories_leave_the_surroundings_out(name, tmp_path):
    solid, legs = SOLIDS[name], [Ramp(1.0, load=20.0), Hold(1.0), Step(load=7.0), Hold(1.0)]
    histories = [
        asp.age(asp.press(core(around), solid, load=0.0), [0.5, 2.5], protocol=legs, fields_at=[2.5])
        for around in (-np.inf, DEEP)
    ]
    no_body, deep = (history.final for history in histories)
    same(no_body, deep)
    assert histories[0].dataset.attrs["sites"] == CORE.sum()
    no_body.save(tmp_path / "contact.zarr")
    loaded = asp.results.load_contact(tmp_path / "contact.zarr", solid)
    same(loaded, no_body)
    assert loaded.nominal_area == no_body.nominal_area
    same(*(asp.press(contact, load=30.0) for contact in (no_body, deep)))
    moved = asp.slide(no_body, (3, -2))
    same(moved, asp.slide(deep, (3, -2)))
    assert not moved.in_contact[~np.roll(CORE, (3, -2), axis=(0, 1))].any()
    with pytest.raises(InputError, match="whole sites"):
        asp.slide(no_body, (0.5, 0))


@pytest.mark.parametrize("name", ["half-space", "springs by Eyring"])
def test_a_run_resumes_where_the_body_ends(name, tmp_path):
    contact, file = asp.press(core(-np.inf), SOLIDS[name], load=20.0), tmp_path / "place"
    whole = asp.age(contact, [0.1, 1.0, 10.0]).final

    def stop(frame):
        if frame.time >= 1.0:
            raise KeyboardInterrupt

    keep = asp.results.Checkpoint(file, every=0.0)
    with pytest.raises(KeyboardInterrupt):
        asp.age(contact, [0.1, 1.0, 10.0], checkpoint=keep, progress=stop)
    assert file.exists()
    resumed = asp.age(contact, [0.1, 1.0, 10.0], checkpoint=keep).final
    assert np.array_equal(resumed.force, whole.force)
    assert resumed.nominal_area == CORE.sum()


def test_limits_of_bodies_that_end():
    contacts = [asp.press(core(around), SOLIDS["springs"], load=20.0) for around in (-np.inf, DEEP)]
    same(*map(asp.relax, contacts))
    with pytest.raises(InputError, match="permanent stiffness above 0 for a body that ends"):
        asp.relax(asp.press(core(-np.inf), spring_lattice(k0=0, k1=3.0), load=20.0))


BODY = 1e-7 * ROUGH[:20, :17]
PADDED = np.full((29, 31), -np.inf)
PADDED[5:25, 4:21] = BODY
MAXWELL = half_space(modulus="100 MPa", branches=[(0.5, 1.0)])
CARRIED = asp.Carried(poisson=0.3, resistivity="17 nohm m")


def sample(heights, **how):
    return Surface(heights, **{"unit": "m", "pixel_size": "1 um", "edges": "free"} | how)


def test_free_edges_may_be_anywhere_on_the_lattice():
    """Beyond free edges there is no body: they may as well be within the lattice."""
    own, within = (asp.press(sample(heights), MAXWELL, pressure="1 MPa") for heights in (BODY, PADDED))
    assert np.array_equal(within.in_contact[5:25, 4:21], own.in_contact)
    names: tuple[str, ...] = (
        "load",
        "area",
        "contact_fraction",
        "nominal_area",
        "contact_area_corrected",
        "mean_gap",
        "energy",
    )
    names += ("rms_gap", "separation", "mean_pressure", "normal_stiffness", "largest_pressure")
    for name in names:
        assert getattr(within, name) == pytest.approx(getattr(own, name), rel=1e-7), name
    for name, value in quantities(CARRIED, own).items():
        assert quantities(CARRIED, within)[name] == pytest.approx(value, rel=1e-7)
    slip, other = (contact.partial_slip("0.1 mN", friction=0.6, poisson=0.3) for contact in (within, own))
    assert slip.stick.sum() == other.stick.sum()


@pytest.mark.filterwarnings("error", "default::asperity.errors.Remark")
def test_laws_and_predictions_refer_to_the_body():
    asked: dict[str, Any] = {"pressures": [1e4, 1e5, 1e6], "times": [0.0, 1.0], "carried": CARRIED}
    own, within = (asp.law(MAXWELL, sample(heights), **asked) for heights in (BODY, PADDED))
    for name in ("contact_fraction", "mean_gap", "approach", "stiffness", "conductance"):
        assert within[name].values == pytest.approx(own[name].values, rel=1e-4), name
        if name != "approach":
            assert (within[f"{name}_low"] < within[name]).any()
    assert np.isnan(within["hydraulic_gap_x"]).all()  # no channel crosses a body of any shape
    how: dict[str, Any] = {"pressure": "1 MPa", "first": "0.1 s", "last": "10 s", "carried": CARRIED}
    predictions = [asp.predict(MAXWELL, sample(heights), **how) for heights in (BODY, PADDED)]
    for name in ("contact_area", "contact_fraction", "mean_gap", "normal_stiffness"):
        mine, other = (prediction.series(name) for prediction in predictions)
        assert mine == pytest.approx(other, rel=1e-4)
    assert predictions[1].nominal_area == pytest.approx(BODY.size * 1e-12)
    theories = [prediction.theory for prediction in predictions]
    assert theories[1][1] == pytest.approx(theories[0][1])  # type: ignore[index]
    low, high = predictions[1].band("contact_area")
    assert (low < high).all()


def test_statistics_leave_out_what_is_no_body():
    own, within = statistics(BODY), statistics(PADDED)
    for name in ("minimum", "mean", "rms_height", "rms_slope", "rms_curvature", "skewness", "kurtosis"):
        assert getattr(within, name) == pytest.approx(getattr(own, name), rel=1e-12)
    tilted = sample(PADDED + 1e-7 * np.arange(31))
    assert tilted.level().describe().rms_height == pytest.approx(
        sample(BODY + 1e-7 * np.arange(4, 21)).level().describe().rms_height, rel=1e-9
    )
    assert np.array_equal(np.isfinite(tilted.band(shortest=4.0).heights), np.isfinite(PADDED))
    with pytest.raises(InputError, match="covers its lattice"):
        asp.surfaces.power_spectrum(tilted)
    with pytest.raises(InputError, match="120 infinite"):
        sample(np.full((10, 12), -np.inf))


def test_masks_and_nan_are_no_heights():
    """An array says itself where there is no body; what is unknown is asked for."""
    masked = np.ma.masked_less(ROUGH, -10.0)  # nothing
    solid = SOLIDS["springs"]
    assert asp.press(masked, solid, load=20.0).area == asp.press(ROUGH, solid, load=20.0).area
    masked = np.ma.masked_array(ROUGH, mask=~CORE)
    for take in (lambda h: asp.press(h, solid, load=20.0), Surface, statistics, asp.surfaces.power_spectrum):
        with pytest.raises(InputError, match=r"masked of 576.*try -inf where there is no body"):
            take(masked)
        with pytest.raises(InputError, match=r"NaN and 0 infinite.*try -inf where there is no body"):
            take(masked.filled(np.nan))
    same(*(asp.press(h, solid, load=20.0) for h in (np.ma.filled(masked, -np.inf), core(DEEP))))


def scan(tmp_path, name="core.npy"):
    np.save(tmp_path / name, np.where(CORE, 1e-7 * ROUGH + 1e-8 * X, np.nan))
    return tmp_path / name


LENGTHS: dict[str, Any] = {"file_unit": "m", "pixel_size": "1 um"}


@pytest.mark.parametrize("periodic", ["reflect", "mirror", "taper", "wrap", "free"])
@pytest.mark.parametrize(
    "more", [{}, {"shortest": 3e-6, "length_unit": "m"}, {"unit": "nm"}, {"crop": [2, 22, 1, 23]}]
)
def test_undefined_pixels_are_read_as_no_body(tmp_path, periodic, more):
    surface = asp.surfaces.read(scan(tmp_path), undefined="no-body", periodic=periodic, **LENGTHS | more)
    part = CORE[2:22, 1:23] if "crop" in more else CORE
    there = np.isfinite(surface.scan.heights)
    assert np.array_equal(there, part)
    assert surface.filled is None
    assert surface.remarks == ()
    if not more and periodic != "taper":
        measured = 1e-7 * ROUGH[CORE] + 1e-8 * X[CORE]
        plane = np.stack([np.ones(CORE.sum()), X[CORE], Y[CORE]], axis=1)
        level = measured - plane @ np.linalg.lstsq(plane, measured, rcond=None)[0]
        assert surface.scan.heights[there] == pytest.approx(level, abs=1e-18)
    np.save(tmp_path / "none.npy", np.full((N, N), np.nan))
    with pytest.raises(asp.errors.SurfaceFileError, match="576 of 576"):
        asp.surfaces.read(tmp_path / "none.npy", undefined="no-body")


def test_load_on_filled_pixels_is_remarked_by_a_law(tmp_path):
    surface = asp.surfaces.read(scan(tmp_path), max_undefined=0.6, **LENGTHS)
    (share,) = surface.remarks
    assert share.startswith(f"{100 * (~CORE).mean():.3g} % of the pixels are undefined and were filled")
    with pytest.warns(asp.errors.Remark, match="of the load is on filled pixels"):
        asp.law(MAXWELL, surface, pressures=[1e5, 1e6], times=[0.0])


@pytest.mark.filterwarnings("error", "default::asperity.errors.Remark")
def test_pictures_leave_out_what_is_no_body(tmp_path):
    history = asp.age(asp.press(sample(PADDED), MAXWELL, pressure="1 MPa"), [1.0, 10.0], fields_at=[0, 10.0])
    for shown in (history.final, history, sample(PADDED)):
        shown._repr_html_()
    figure: Any = asp.figures.contact_figure(asp.analysis.contact_maps(history.dataset))
    percent = figure.table["contact [%]"]
    assert percent == pytest.approx(100 * history.dataset["contact_fraction"].values[[0, -1]])
    assert {moment.sites for moment in distributions(history.dataset)} == {BODY.size}
    scene, steps = _scene(history.dataset, None, "")
    low, high = scene["height_range"]
    assert scene["ends"]
    assert np.array_equal(steps > 0, np.isfinite(PADDED))
    drawn = low + (high - low) * steps[5:25, 4:21] / 65535
    assert drawn == pytest.approx(BODY, abs=(high - low) / 65535)
