"""Every number of every public function: any type gives the result of a Python float, or a refusal.

`CALLS` has a valid call of each public function. A float in it stands for a real number, an integer for a
whole one, a list for an array of either, a tuple for the shape of a lattice. All of them are exact in half
precision, so that other types of the same numbers must lead to the same bits.
"""

import dataclasses
import inspect
import math
from collections.abc import Callable, Iterator, Mapping
from decimal import Decimal
from fractions import Fraction
from operator import methodcaller
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import asperity as asp
from asperity.errors import InputError

Arguments = dict[str, Any]

ROUGH = (np.round(8 * np.random.default_rng(1).normal(size=(8, 8))) / 8 + 0.0).tolist()
LATTICE = asp.solids.spring_lattice(k0=1.0, k1=3.0)
CONTACT = asp.press(ROUGH, LATTICE, load=8.0)
MASK = np.asarray(CONTACT.in_contact)
LAW = asp.theory.GaussianHeights(2.0)
LAWS: list[asp.theory.HeightLaw] = [
    LAW,
    asp.theory.ExponentialHeights(2.0),
    asp.theory.EmpiricalHeights([0.5, 1.0, 4.0]),
]
TIME = (2.0 ** np.arange(9)).tolist()
AREA = (np.round(8 * (10 + 3 * np.log1p(TIME))) / 8 + 0.0).tolist()
ERROR = [0.25] * 9
CURVE = {"time": TIME, "area": AREA, "stderr": ERROR}
SATURATION, LOGARITHM = asp.fits.saturation(TIME, AREA), asp.fits.logarithm(TIME, AREA)
CREEP = {"x1": 3.0, "x2": [0.5, 2.0], "viscous": 0.5, "dimension": 2}
FORCES = {"x1": 3.0, "x2": [0.0, 1.0, 2.0], "viscous": 0.5, "dimension": 1}

MAXWELL = [[0.25, 0.5], [0.5, 8.0]]
SERIES = asp.relaxation.PronySeries(2.0, ((0.25, 0.5), (0.5, 8.0)))
RELAXED = (np.round(8 * SERIES.modulus_at(TIME)) / 8 + 0.0).tolist()
STIFFENING = RELAXED[::-1]
RATE_AND_STATE = asp.friction.RateAndState(a=0.0, b=0.25, D_c=2.0, mu_0=1.0, V_0=1.0)
STEPPED = asp.protocols.Repeat(asp.friction.velocity_steps([1.0, 4.0], distance=8.0), count=1)
SLID = {
    "time": [0.0, 1.0, 2.0, 4.0, 8.0, 9.0, 10.0, 12.0, 16.0],
    "velocity": [1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0],
}
RECORD = asp.friction.Record(
    np.array(SLID["time"]),
    np.array(SLID["velocity"]),
    np.array([1.0, 1.0, 1.0, 1.5, 1.75, 1.25, 1.0, 0.75, 0.75]),
    strength_at_rest=True,
)

CALLS: list[tuple[Callable[..., Any], Arguments]] = [
    (asp.press, {"heights": ROUGH, "solid": LATTICE, "load": 8.0}),
    (asp.press, {"heights": ROUGH, "solid": LATTICE, "separation": 0.5}),
    (asp.age, {"contact": CONTACT, "times": [1.0, 2.0], "rtol": 2.0**-5, "fields_at": [0.0, 2.0]}),
    (asp.relax, {"contact": CONTACT}),
    (asp.Load, {"value": 8.0, "rate": 2.0, "since": 0.5}),
    (asp.Separation, {"value": 0.5, "rate": 2.0, "since": 0.5}),
    (asp.protocols.Hold, {"duration": 8.0, "mobility": 2.0}),
    (asp.protocols.Ramp, {"duration": 8.0, "load": 0.5, "mobility": 2.0}),
    (asp.protocols.Step, {"load": 8.0}),
    (asp.protocols.Step, {"separation": 0.5}),
    (asp.protocols.Slide, {"distance": 8.0, "velocity": "inf", "substeps": 2, "every": 3, "mobility": 2.0}),
    (asp.slide, {"contact": CONTACT, "shift": [1.0, 0.5]}),
    (asp.slide, {"contact": CONTACT, "distance": 2.0}),
    (asp.friction.ShearStrength, {"strength": 8.0, "rate_coefficient": 0.5, "reference_velocity": 2.0}),
    (asp.friction.ShearStrength(8.0, 0.5, 2.0).at, {"velocity": [1.0, 2.0]}),
    (asp.protocols.Repeat, {"legs": (asp.protocols.Hold(1.0),), "count": 2}),
    (asp.friction.slide_hold_slide, {"holds": [1.0, 8.0], "velocity": 2.0, "distance": 8.0, "run_in": 4.0}),
    (asp.friction.velocity_steps, {"velocities": [1.0, 4.0], "distance": 8.0}),
    (
        asp.friction.synthetic_record,
        {"protocol": STEPPED, "law": RATE_AND_STATE, "per_leg": 4, "noise": 0.25, "seed": 1},
    ),
    (asp.friction.RateAndState, {"a": 0.25, "b": 0.5, "D_c": 2.0, "mu_0": 1.0, "V_0": 4.0}),
    (RATE_AND_STATE.state, {**SLID, "start": 2.0}),
    (RATE_AND_STATE.friction, {**SLID, "start": 2.0}),
    (RATE_AND_STATE.steady_friction, {"velocity": [1.0, 4.0]}),
    (asp.friction.Record, {**SLID, "friction": RECORD.friction.tolist()}),
    (asp.friction.rate_and_state, {"record": RECORD, "a": 0.0, "V_0": 2.0}),
    (asp.friction.compare_state_laws, {"records": RECORD, "a": 0.0, "V_0": 2.0}),
    (asp.Checkpoint, {"path": "place", "every": 2.0}),
    (asp.Multigrid, {"max_cycles": 20}),
    (
        asp.ActiveSet,
        {"reduction": 0.5, "max_iterations": 9, "patience": 2, "careful_after": 3, "max_revisions": 4},
    ),
    (asp.solids.spring_lattice, {"k0": 1.0, "k1": 3.0, "R": 2.0, "R_viscous": 0.5, "hardness": 2.0}),
    (asp.solids.Eyring, {"rate": 2.0, "stress": 0.5}),
    (asp.solids.Norton, {"rate": 2.0, "stress": 0.5, "exponent": 2.0}),
    (asp.solids.half_space, {"modulus": 2.0, "branches": [[0.5, 4.0], [0.25, 8.0]], "hardness": 0.5}),
    (LATTICE.with_hardness, {"hardness": 0.5}),
    (asp.solids.layer, {"modulus": 2.0, "poisson": 0.25, "thickness": 4.0, "branches": [[0.5, 4.0]]}),
    (
        asp.solids.coated_half_space,
        {
            "modulus": 2.0,
            "poisson": 0.25,
            "thickness": 4.0,
            "base_modulus": 8.0,
            "base_poisson": 0.5,
            "branches": [[0.5, 4.0]],
        },
    ),
    (asp.solids.contact_modulus, {"young": [2.0, 4.0], "poisson": [0.25, 0.5]}),
    (asp.solids.PowerMobility, {"mobility": 2.0, "exponent": 0.5}),
    (asp.solids.SpringConstants, {"k0": 1.0, "k1": 3.0, "R": 2.0, "R_viscous": 0.5}),
    (asp.solids.LaplacianSpectrum, {"laplacian": 2.0, "uniform": 0.5}),
    (asp.solids.WaveNumberSpectrum, {"slope": 2.0}),
    (asp.solids.FixedRate, {"rate": 2.0, "stiffness": LATTICE.permanent}),
    (asp.relaxation.check_branches, {"branches": MAXWELL}),
    (asp.relaxation.PronySeries, {"modulus": 2.0, "branches": MAXWELL, "error": 0.5}),
    (asp.relaxation.Relaxation, {"time": TIME, "modulus": RELAXED, "noise": 0.5}),
    (asp.relaxation.Creep, {"time": TIME, "compliance": STIFFENING, "noise": 0.5}),
    (asp.relaxation.Dynamic, {"frequency": TIME, "storage": STIFFENING, "loss": ERROR, "noise": 0.5}),
    (
        asp.relaxation.fit,
        {"data": asp.relaxation.Relaxation(np.array(TIME), np.array(RELAXED)), "per_decade": 2.0},
    ),
    (asp.relaxation.from_retardation, {"compliance": 0.5, "delayed": MAXWELL, "fluidity": 2.0}),
    (
        asp.relaxation.power_law,
        {"modulus": 2.0, "exponent": 0.5, "time": 4.0, "first": 0.5, "last": 64.0, "accuracy": 0.125},
    ),
    (
        asp.relaxation.fractional_zener,
        {
            "instantaneous": 2.0,
            "relaxed": 0.5,
            "exponent": 0.5,
            "time": 4.0,
            "first": 0.5,
            "last": 64.0,
            "accuracy": 0.125,
        },
    ),
    (asp.relaxation.arrhenius, {"activation_energy": 64.0, "temperature": 320.0, "reference": 300.0}),
    (asp.relaxation.wlf, {"c1": 16.0, "c2": 52.0, "temperature": 320.0, "reference": 300.0}),
    *(
        (method, {argument: [0.25, 0.5]})
        for argument, methods in {
            "time": (SERIES.modulus_at, SERIES.compliance_at),
            "frequency": (SERIES.storage, SERIES.loss),
        }.items()
        for method in methods
    ),
    (SERIES.shifted, {"factor": 2.0}),
    (SERIES.effective_load, {"times": [0.0, 0.5, 0.5, 2.0], "loads": [0.5, 1.0, 2.0, 4.0]}),
    (asp.surfaces.gaussian, {"shape": (4, 6), "rms": 2.0, "seed": 3}),
    (asp.surfaces.exponential, {"shape": (4, 6), "rms": 2.0, "seed": 3}),
    (asp.surfaces.self_affine, {"size": 4, "hurst": 0.5, "delta": 0.25, "seed": 3}),
    *(
        (asp.surfaces.spectral, {"shape": (8, 12), "hurst": 0.5, "seed": 3, **options})
        for options in (
            {"roll_off": 8.0, "cutoff": 4.0, "spacing": [0.5, 2.0]},
            {"spacing": 0.5, "rms_height": 2.0},
            {"rms_slope": 2.0},
            {"rms_curvature": 2.0},
        )
    ),
    (asp.surfaces.Surface, {"heights": ROUGH, "unit": "nm", "pixel_size": [0.5, 2.0]}),
    (
        asp.surfaces.from_spectrum,
        {"shape": (8, 12), "spectrum": ([0.1, 9.0], [2.0, 1.0]), "pixel_size": [0.5, 2.0], "seed": 3},
    ),
    (asp.surfaces.read_spectrum, {"path": "psd.csv", "dimension": 2}),
    (asp.surfaces.power_spectrum, {"surface": ROUGH, "pixel_size": [0.5, 2.0]}),
    (asp.surfaces.power_spectrum, {"surface": ROUGH, "longest": 8.0, "shortest": 2.0}),
    (asp.surfaces.check_heights, {"heights": ROUGH}),
    (asp.surfaces.statistics, {"heights": ROUGH, "pixel_size": [0.5, 2.0]}),
    (asp.surfaces.read, {"path": "heights.npy", "max_undefined": 0.25}),
    (asp.surfaces.read, {"path": "heights.npy", "longest": 8.0, "shortest": 2.0, "pixel_size": [0.5, 2.0]}),
    (asp.surfaces.read, {"path": "heights.npy", "crop": [1.0, 6.0, 2.0, 8.0], "pixel_size": 0.5}),
    (asp.fits.saturation, CURVE),
    (asp.fits.logarithm, CURVE),
    (asp.fits.compare, CURVE),
    (asp.fits.growth_rate, CURVE | {"first": 1.0, "last": 64.0, "initial": 10.0, "initial_stderr": 0.5}),
    (asp.fits.power_law, {"x": TIME, "y": AREA, "stderr": ERROR}),
    (asp.fits.local_exponent, {"x": TIME, "y": AREA}),
    (
        asp.fits.ensemble,
        {"fit": asp.fits.power_law, "time": TIME, "areas": [AREA, [2 * area for area in AREA]]},
    ),
    (SATURATION.predict, {"time": [0.0, 2.0]}),
    (LOGARITHM.area_ratio, {"time": [0.0, 2.0]}),
    (asp.fits.power_law(TIME, AREA).predict, {"x": [1.0, 2.0]}),
    (asp.fits.growth_rate(TIME, AREA, initial=10.0).predict, {"time": [1.0, 2.0]}),
    (asp.theory.compliance, CREEP),
    (asp.theory.compliance_rate, CREEP),
    (asp.theory.compliance_asymptote, CREEP),
    (asp.theory.compliance_asymptote_paper, {"x2": 4.0}),
    (asp.theory.exponential_growth, CREEP),
    (asp.theory.exponential_growth_paper, CREEP),
    (asp.theory.displacement, {"offset": [1, 2], **CREEP}),
    (asp.theory.torus_compliance, {"x1": 3.0, "x2": [0.5, 2.0], "viscous": 0.5, "shape": (4, 6)}),
    (asp.theory.site_stiffness, {"x1": 3.0, "dimension": 1}),
    (asp.theory.late_slope, {"x1": [1.0, 3.0], "viscous": 0.5, "dimension": 2}),
    (asp.theory.late_slope_paper, {"x1": 3.0}),
    (asp.theory.response, FORCES | {"force": [1.0, 2.0, 1.0]}),
    (asp.theory.response_rate, FORCES | {"force": [1.0, 2.0, 1.0]}),
    (asp.theory.dilute_area, {"load_per_site": [0.25, 0.5], "compliance": 0.5, "heights": LAW}),
    (asp.theory.winkler_area, {"load_per_site": [0.25, 0.5], "k1": 3.0, "heights": LAW}),
    (asp.theory.dilute_horizon, {"area_fraction": 0.25, "dimension": 2}),
    (asp.theory.dilute_history, FORCES | {"load_per_site": [0.5, 0.5, 0.5], "k0": 2.0, "heights": LAW}),
    (asp.theory.contacts_at_start, {"load": 8.0, "rms": 2.0, "x1": 3.0, "k0": 0.5, "dimension": 2}),
    (asp.theory.contacts_at_start_paper, {"load": 8.0, "rms": 2.0, "x1": 3.0, "k0": 0.5}),
    (asp.theory.static_friction, {"area": [1.0, 2.0], "load": 8.0, "shear_strength": 0.5}),
    (asp.theory.flowing_area, {"time": [1.0, 2.0], "load": 8.0, "area": 0.5, "at": 1.0, "stress": 0.5}),
    (asp.theory.full_contact_load, {"heights": ROUGH, "k0": 2.0, "k1": 3.0}),
    (asp.theory.full_contact_load_relaxed, {"heights": ROUGH, "k0": 2.0}),
    (asp.theory.hertz, {"load": [0.0, 0.5], "modulus": 2.0, "radius": 8.0, "period": 16.0}),
    (
        asp.theory.westergaard_area,
        {"pressure": [0.0, 0.25], "modulus": 2.0, "amplitude": 0.5, "wavelength": 8.0},
    ),
    (asp.theory.persson_area, {"pressure": [0.0, 0.25], "modulus": 2.0, "slope": 0.5}),
    (asp.theory.GaussianHeights, {"rms": 2.0}),
    (asp.theory.ExponentialHeights, {"rms": 2.0}),
    (asp.theory.EmpiricalHeights, {"heights": [0.5, 1.0, 4.0]}),
    *((law.separation_for, {"mean_excess": [0.25, 0.5]}) for law in LAWS),
    *((law.exceedance, {"separation": [0.25, 0.5]}) for law in LAWS),
    *((law.mean_excess, {"separation": [0.25, 0.5]}) for law in LAWS),
    (asp.analysis.patches, {"in_contact": MASK, "connectivity": 2}),
    (asp.observe, {"image": MASK, "pixel": 2.0, "blur": 1.5, "threshold": 0.5, "spacing": [0.5, 1.0]}),
    (asp.analysis.clustering, {"in_contact": MASK, "box": 2}),
    (asp.analysis.link_patches, {"before": MASK, "after": MASK, "connectivity": 2}),
    (asp.analysis.patch_table, {"image": CONTACT, "connectivity": 2}),
    (
        asp.analysis.patch_tracks,
        {"dataset": asp.age(CONTACT, [1.0], fields_at=[0.0, 1.0]).dataset, "connectivity": 2},
    ),
    (
        asp.fits.measured_growth,
        {"time": TIME, "value": AREA, "stderr": ERROR, "first": 1.0, "last": 64.0, "laws": ("logarithm",)},
    ),
]

WITHOUT_NUMBERS: set[Callable[..., Any]] = {
    asp.analysis.aging_summary,
    asp.analysis.leg_table,
    asp.figures.history_figure,
    asp.figures.patch_figure,
    asp.analysis.contact_ages,
    asp.analysis.contact_maps,
    asp.surfaces.check_square,
    asp.surfaces.combined,
    asp.analysis.turnover,
    asp.analysis.with_limit,
    asp.campaign.estimate,
    asp.campaign.fields,
    asp.campaign.load_plan,
    asp.campaign.open,
    asp.campaign.read_plan,
    asp.campaign.sweep,
    asp.campaign.table,
    asp.campaign.tally,
    asp.figures.aging_curve,
    asp.analysis.distributions,
    asp.figures.campaign_figure,
    asp.figures.distribution_figure,
    asp.figures.prediction_page,
    asp.figures.prediction_pictures,
    asp.predict,
    asp.results.load_contact,
    asp.figures.contact_figure,
    asp.figures.fit_figure,
    asp.figures.animate_history,
    asp.figures.html_of,
    asp.figures.plot_contact,
    asp.figures.plot_history,
    asp.figures.plot_spectrum,
    asp.figures.plot_surface,
    asp.figures.relaxation_figure,
    asp.figures.sliding_figure,
    asp.friction.add_friction,
    asp.figures.surface_figure,
    asp.figures.rate_and_state_figure,
    asp.fits.jackknife,
    asp.friction.hold_peaks,
    asp.friction.read_record,
    asp.friction.record_of,
    asp.friction.save_parameters,
    asp.fits.read_measurements,
    asp.relaxation.combined,
    asp.relaxation.read,
    asp.results.load,
    asp.results.save,
}
"""What takes files, datasets, masks, labels and numbers of workers or columns, or samples of any type."""

FLOATS, INTEGERS = ("f2", "f4", "f8", "g", ">f4"), ("int", "i1", "u2", "i8")
REALS: dict[str, Callable[[float], Any]] = {
    "int": int,
    **{kind: np.dtype(kind).type for kind in (*FLOATS[:4], *INTEGERS[1:])},
    "array": np.array,
    "DataArray": lambda x: xr.DataArray(x, attrs={"units": "1"}),
    "Fraction": Fraction,
    "Decimal": Decimal,
}
WHOLES: dict[str, Callable[[int], Any]] = {
    **{kind: np.dtype(kind).type for kind in INTEGERS[1:]},
    "array": np.array,
    "DataArray": xr.DataArray,
}
ARRAYS: dict[str, Callable[[np.ndarray], Any]] = {
    **{kind: methodcaller("astype", kind) for kind in (*FLOATS, *INTEGERS[1:])},
    "tuple": lambda x: tuple(x.tolist()),
    "Fortran": lambda x: np.asfortranarray(x),
    "strided": lambda x: np.repeat(x, 2, axis=-1)[..., ::2],
    "DataArray": xr.DataArray,
    "DataFrame": lambda x: pd.DataFrame(x) if x.ndim == 2 else pd.Series(x),
    "Fraction": lambda x: np.vectorize(Fraction, otypes=[object])(x) if x.dtype.kind == "f" else x,
}
SHAPES: dict[str, Callable[[tuple[int, ...]], Any]] = {
    "list": list,
    "array": np.array,
    "i1": lambda x: tuple(map(np.int8, x)),
}
TYPES = sorted({*REALS, *WHOLES, *ARRAYS, *SHAPES})

NO_REALS = [
    math.nan,
    math.inf,
    -math.inf,
    np.float32("nan"),
    "8",
    b"8",
    True,
    np.True_,
    8j,
    None,
    {},
    object(),
]
NO_REALS += [
    np.timedelta64(8, "s"),
    np.array(math.nan),
    np.ma.array(8.0, mask=True),
    10**400,
    Decimal("sNaN"),
    ["8"],
    [True],
    [8j],
    [None],
]
NO_WHOLES = [2.0, 2.5, np.float32(2), math.nan, math.inf, "2", True, np.True_, 2j, None, [2.0], object()]
NO_SHAPES = [
    (4, 2.5),
    (4, 6.0),
    (4, True),
    (4, "6"),
    (0, 4),
    (4, -6),
    (),
    (2, 2, 2),
    None,
    math.nan,
    "46",
    {4: 6},
]
INFINITY_IS_WELCOME = {
    (function, argument)
    for function, argument in (
        (asp.theory.torus_compliance, "x2"),
        (SATURATION.predict, "time"),
        (LOGARITHM.area_ratio, "time"),
        *((law.exceedance, "separation") for law in LAWS),
        *((law.mean_excess, "separation") for law in LAWS),
    )
}


def name(function: Callable[..., Any]) -> str:
    return f"{function.__module__.removeprefix('asperity.')}.{function.__qualname__}"


def as_type(value: Any, kind: str) -> Any:
    """The same number or numbers of another type; as they are, where that type cannot hold them."""
    exact = np.array(value) if isinstance(value, (float, list)) else np.zeros(0)
    if kind in INTEGERS and exact.size:
        limits = np.iinfo("i8" if kind == "int" else kind)
        if (exact != np.rint(exact)).any() or exact.min() < limits.min or exact.max() > limits.max:
            return value
    if isinstance(value, float):
        return REALS[kind](value) if kind in REALS else value
    if isinstance(value, list):
        meant = kind in ARRAYS and (exact.dtype.kind == "f" or kind not in FLOATS)
        return ARRAYS[kind](exact) if meant else value
    if isinstance(value, tuple) and is_shape(value):
        return SHAPES[kind](value) if kind in SHAPES else value
    whole = isinstance(value, int) and not isinstance(value, bool)
    return WHOLES[kind](value) if whole and kind in WHOLES else value


def is_shape(value: tuple[Any, ...]) -> bool:
    return all(isinstance(n, int) for n in value)


def bad_values(value: Any) -> Iterator[Any]:
    if isinstance(value, float):
        yield from NO_REALS
    elif isinstance(value, int) and not isinstance(value, bool):
        yield from NO_WHOLES
    elif isinstance(value, tuple) and is_shape(value):
        yield from NO_SHAPES
    elif isinstance(value, list):
        array = np.array(value)
        for wrong in (math.nan, math.inf, -math.inf):
            changed = array.astype(float)
            changed.flat[-1] = wrong
            yield changed
        yield from (array.astype(kind) for kind in ("?", "U", "c16", "m8[s]", "M8[s]"))
        yield from (None, "rough", {}, object(), [[1.0], [1.0, 2.0]])
        holed = array.astype(object)
        holed.flat[-1] = None
        yield holed
        yield np.ma.masked_array(array, mask=array == array.flat[-1])


def is_infinite(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.dtype == float and bool(np.isinf(value).any())


def parts(result: Any) -> Any:
    """A result taken to pieces that can be compared, with the types of its numbers."""
    if dataclasses.is_dataclass(result) and not isinstance(result, type):
        fields = dataclasses.fields(result)
        return [
            type(result).__name__,
            *((f.name, parts(getattr(result, f.name))) for f in fields if f.compare),
        ]
    if isinstance(result, xr.Dataset):
        return [parts(dict(result.attrs)), *((n, parts(v.values)) for n, v in result.variables.items())]
    if isinstance(result, (np.ndarray, np.generic)):
        return [str(result.dtype), result.shape, result.tobytes()]
    if isinstance(result, Mapping):
        return [(key, parts(value)) for key, value in result.items()]
    if isinstance(result, (tuple, list)):
        return [parts(value) for value in result]
    return [type(result).__name__, repr(result)]


def public_functions() -> Iterator[Callable[..., Any]]:
    for public in asp.__all__:
        member = getattr(asp, public)
        inside = [getattr(member, n) for n in member.__all__] if isinstance(member, ModuleType) else [member]
        yield from (thing for thing in inside if isinstance(thing, FunctionType))


@pytest.fixture(autouse=True)
def _files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    np.save("heights.npy", ROUGH)
    Path("psd.csv").write_text("q,C\n1,2\n3,1\n")


def test_every_public_function_is_here():
    called = {function for function, _ in CALLS}
    assert set(public_functions()) <= called | WITHOUT_NUMBERS
    assert not called & WITHOUT_NUMBERS


@pytest.mark.parametrize(("function", "arguments"), CALLS, ids=[name(function) for function, _ in CALLS])
def test_numbers_of_every_type(function, arguments):
    expected = parts(function(**arguments))
    for kind in TYPES:
        others = {key: as_type(value, kind) for key, value in arguments.items()}
        if any(others[key] is not value for key, value in arguments.items()):
            assert parts(function(**others)) == expected, kind


@pytest.mark.parametrize(("function", "arguments"), CALLS, ids=[name(function) for function, _ in CALLS])
def test_what_is_no_number_is_refused(function, arguments):
    optional = {p.name for p in inspect.signature(function).parameters.values() if p.default is None}
    for key, value in arguments.items():
        for wrong in bad_values(value):
            if wrong is None and key in optional:
                continue
            if (function, key) in INFINITY_IS_WELCOME and is_infinite(wrong):
                continue
            with pytest.raises(InputError) as raised:
                function(**(arguments | {key: wrong}))
            assert "\n" not in str(raised.value)
            assert len(str(raised.value)) < 300
