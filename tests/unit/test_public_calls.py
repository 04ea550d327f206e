"""Walks over the public surface, by a call of every function: types of numbers, wrong things, types.

A float in `CALLS` stands for a real number, an integer for a whole one, a list for an array of either, a
tuple for the shape of a lattice. All of them are exact in half precision, so that other types of the same
numbers must lead to the same bits.
"""

import dataclasses
import inspect
import math
import re
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
from asperity.errors import CallError, InputError

ROUGH = (np.round(8 * np.random.default_rng(1).normal(size=(8, 8))) / 8 + 0.0).tolist()
LATTICE = asp.solids.spring_lattice(k0=1.0, k1=3.0)
CONTACT = asp.press(ROUGH, LATTICE, load=8.0)
STUCK = asp.press(ROUGH, asp.solids.half_space(modulus=8.0, adhesion=asp.solids.Dugdale(1.0, 1.0)), load=8.0)
HISTORY = asp.age(CONTACT, [1.0], fields_at=[0.0, 1.0])
MASK = np.asarray(CONTACT.in_contact)
THEORY = asp.theory
LAWS: list[asp.theory.HeightLaw] = [
    asp.theory.GaussianHeights(2.0),
    asp.theory.ExponentialHeights(2.0),
    asp.theory.EmpiricalHeights([0.5, 1.0, 4.0]),
]
TIME = (2.0 ** np.arange(9)).tolist()
AREA = (np.round(8 * (10 + 3 * np.log1p(TIME))) / 8 + 0.0).tolist()
ERROR = [0.25] * 9
CURVE = {"time": TIME, "area": AREA, "stderr": ERROR}
MEASURED = {"time": TIME, "value": AREA, "stderr": ERROR, "first": 1.0, "last": 64.0}
SATURATION, LOGARITHM = asp.fits.saturation(TIME, AREA), asp.fits.logarithm(TIME, AREA)
CREEP = {"x1": 3.0, "x2": [0.5, 2.0], "viscous": 0.5, "dimension": 2}
FORCES = {"x1": 3.0, "x2": [0.0, 1.0, 2.0], "viscous": 0.5, "dimension": 1}
MAXWELL = [[0.25, 0.5], [0.5, 8.0]]
SERIES = asp.relaxation.PronySeries(2.0, ((0.25, 0.5), (0.5, 8.0)))
ZENER = asp.relaxation.PronySeries(4.0, ((0.5, 1.0),))
RELAXED = (np.round(8 * SERIES.modulus_at(TIME)) / 8 + 0.0).tolist()
STIFFENING = RELAXED[::-1]
FADING = {"exponent": 0.5, "time": 4.0, "first": 0.5, "last": 64.0, "accuracy": 0.125}
FILM = {"modulus": 2.0, "poisson": 0.25, "thickness": 4.0, "branches": [[0.5, 4.0]]}
SUMMITS = {"load": 8.0, "rms": 2.0, "x1": 3.0, "k0": 0.5}
RATE_AND_STATE = asp.friction.RateAndState(a=0.0, b=0.25, D_c=2.0, mu_0=1.0, V_0=1.0)
STEPPED = asp.protocols.Repeat(asp.friction.velocity_steps([1.0, 4.0], distance=8.0), count=1)
SLID = {
    "time": [0.0, 1.0, 2.0, 4.0, 8.0, 9.0, 10.0, 12.0, 16.0],
    "velocity": [1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0],
}
SHEARED = [1.0, 1.0, 1.0, 1.5, 1.75, 1.25, 1.0, 0.75, 0.75]
RECORD = asp.friction.Record(*map(np.array, [*SLID.values(), SHEARED]), strength_at_rest=True)
WAVES = {"shape": (8, 12), "hurst": 0.5, "seed": 3}
ONE_BALL = {"shape": (4, 6), "pixel_size": [0.5, 2.0]}
BALLS = ONE_BALL | {"places": [[0.5, 2.0], [1.0, 8.0]], "radii": [4.0, 2.0], "heights": [0.0, 0.5]}
BAND = {"shape": (8, 12), "spectrum": ([0.1, 9.0], [2.0, 1.0]), "pixel_size": [0.5, 2.0], "seed": 3}


def call(function: Callable[..., Any], /, **arguments: Any) -> tuple[Callable[..., Any], dict[str, Any]]:
    return function, arguments


CALLS: list[tuple[Callable[..., Any], dict[str, Any]]] = [
    call(asp.press, heights=ROUGH, solid=LATTICE, load=8.0),
    call(asp.press, heights=ROUGH, solid=LATTICE, separation=0.5),
    call(asp.age, contact=CONTACT, times=[1.0, 2.0], rtol=2.0**-5, fields_at=[0.0, 2.0]),
    call(asp.relax, contact=CONTACT),
    call(asp.Load, value=8.0),
    call(asp.Separation, value=0.5),
    call(asp.slide, contact=CONTACT, shift=[1.0, 0.5]),
    call(asp.slide, contact=CONTACT, distance=2.0),
    call(asp.observe, image=MASK, pixel=2.0, blur=1.5, threshold=0.5, spacing=[0.5, 1.0]),
    call(asp.Checkpoint, path="place", every=2.0),
    call(asp.Multigrid, max_cycles=20),
    call(asp.ActiveSet, max_iterations=9),
    call(asp.protocols.Hold, duration=8.0, mobility=2.0),
    call(asp.protocols.Ramp, duration=8.0, load=0.5, mobility=2.0),
    call(asp.protocols.Step, load=8.0),
    call(asp.protocols.Step, separation=0.5),
    call(asp.protocols.Slide, distance=8.0, velocity="inf", substeps=2, every=3, mobility=2.0),
    call(asp.protocols.Repeat, legs=(asp.protocols.Hold(1.0),), count=2),
    call(asp.protocols.measured, file={"time": [0.0, 8.0], "load": [1.0, 2.0]}, within=0.5),
    call(asp.friction.ShearStrength, strength=8.0, rate_coefficient=0.5, reference_velocity=2.0),
    call(asp.friction.ShearStrength(8.0, 0.5, 2.0).at, velocity=[1.0, 2.0]),
    call(asp.friction.slide_hold_slide, holds=[1.0, 8.0], velocity=2.0, distance=8.0, run_in=4.0),
    call(asp.friction.velocity_steps, velocities=[1.0, 4.0], distance=8.0),
    call(asp.friction.synthetic_record, protocol=STEPPED, law=RATE_AND_STATE, per_leg=4, noise=0.25, seed=1),
    call(asp.friction.RateAndState, a=0.25, b=0.5, D_c=2.0, mu_0=1.0, V_0=4.0),
    *(call(one, **SLID, start=2.0) for one in (RATE_AND_STATE.state, RATE_AND_STATE.friction)),
    call(RATE_AND_STATE.steady_friction, velocity=[1.0, 4.0]),
    call(asp.friction.Record, **SLID, friction=SHEARED),
    call(asp.friction.rate_and_state, record=RECORD, a=0.0, V_0=2.0),
    call(asp.friction.compare_state_laws, records=RECORD, a=0.0, V_0=2.0),
    call(asp.solids.spring_lattice, k0=1.0, k1=3.0, R=2.0, R_viscous=0.5, hardness=2.0),
    call(asp.solids.Eyring, rate=2.0, stress=0.5),
    call(asp.pull, contact=STUCK, steps=4),
    call(asp.solids.Dugdale, work=2.0, range=0.5),
    call(asp.solids.Norton, rate=2.0, stress=0.5, exponent=2.0),
    call(asp.solids.half_space, modulus=2.0, branches=[[0.5, 4.0], [0.25, 8.0]], hardness=0.5),
    call(LATTICE.with_hardness, hardness=0.5),
    call(asp.solids.layer, **FILM),
    call(asp.solids.coated_half_space, **FILM, base_modulus=8.0, base_poisson=0.5),
    call(asp.solids.contact_modulus, young=[2.0, 4.0], poisson=[0.25, 0.5]),
    call(asp.solids.PowerMobility, mobility=2.0, exponent=0.5),
    call(asp.solids.LaplacianSpectrum, laplacian=2.0, uniform=0.5),
    call(asp.solids.WaveNumberSpectrum, slope=2.0),
    call(asp.relaxation.check_branches, branches=MAXWELL),
    call(asp.relaxation.PronySeries, modulus=2.0, branches=MAXWELL, error=0.5),
    call(asp.relaxation.Relaxation, time=TIME, modulus=RELAXED, noise=0.5),
    call(asp.relaxation.Creep, time=TIME, compliance=STIFFENING, noise=0.5),
    call(asp.relaxation.Dynamic, frequency=TIME, storage=STIFFENING, loss=ERROR, noise=0.5),
    call(asp.relaxation.material, young=3.0, poisson=0.25, hardness=1.0),
    call(asp.relaxation.fit, data=asp.relaxation.Relaxation(*np.array([TIME, RELAXED])), per_decade=2.0),
    call(asp.relaxation.from_retardation, compliance=0.5, delayed=MAXWELL, fluidity=2.0),
    call(asp.relaxation.power_law, modulus=2.0, **FADING),
    call(asp.relaxation.fractional_zener, instantaneous=2.0, relaxed=0.5, **FADING),
    call(asp.relaxation.arrhenius, activation_energy=64.0, temperature=320.0, reference=300.0),
    call(asp.relaxation.wlf, c1=16.0, c2=52.0, temperature=320.0, reference=300.0),
    *(call(method, time=[0.25, 0.5]) for method in (SERIES.modulus_at, SERIES.compliance_at)),
    *(call(method, frequency=[0.25, 0.5]) for method in (SERIES.storage, SERIES.loss)),
    call(SERIES.shifted, factor=2.0),
    call(SERIES.effective_load, times=[0.0, 0.5, 0.5, 2.0], loads=[0.5, 1.0, 2.0, 4.0]),
    call(asp.surfaces.gaussian, shape=(4, 6), rms=2.0, seed=3),
    call(asp.surfaces.exponential, shape=(4, 6), rms=2.0, seed=3),
    call(asp.surfaces.self_affine, size=4, hurst=0.5, delta=0.25, seed=3),
    call(asp.surfaces.spectral, **WAVES, roll_off=8.0, cutoff=4.0, spacing=[0.5, 2.0]),
    call(asp.surfaces.spectral, **WAVES, spacing=0.5, rms_height=2.0),
    *(call(asp.surfaces.spectral, **WAVES, **{rms: 2.0}) for rms in ("rms_slope", "rms_curvature")),
    call(asp.surfaces.sphere, **ONE_BALL, radius=8.0),
    call(asp.surfaces.paraboloid, **ONE_BALL, radius=[8.0, 4.0]),
    call(asp.surfaces.punch, **ONE_BALL, radius=2.0),
    call(asp.surfaces.array, **BALLS),
    call(asp.surfaces.Surface, heights=ROUGH, unit="nm", pixel_size=[0.5, 2.0]),
    call(asp.surfaces.from_spectrum, **BAND),
    call(asp.surfaces.read_spectrum, path="psd.csv", dimension=2),
    call(asp.surfaces.power_spectrum, surface=ROUGH, pixel_size=[0.5, 2.0]),
    call(asp.surfaces.power_spectrum, surface=ROUGH, longest=8.0, shortest=2.0),
    call(asp.surfaces.check_heights, heights=ROUGH),
    call(asp.surfaces.statistics, heights=ROUGH, pixel_size=[0.5, 2.0]),
    call(asp.surfaces.read, path="heights.npy", max_undefined=0.25),
    call(asp.surfaces.read, path="heights.npy", longest=8.0, shortest=2.0, pixel_size=[0.5, 2.0]),
    call(asp.surfaces.read, path="heights.npy", crop=[1.0, 6.0, 2.0, 8.0], pixel_size=0.5),
    *(call(one, **CURVE) for one in (asp.fits.saturation, asp.fits.logarithm, asp.fits.compare)),
    call(asp.fits.growth_rate, **CURVE, first=1.0, last=64.0, initial=10.0, initial_stderr=0.5),
    call(asp.fits.power_law, x=TIME, y=AREA, stderr=ERROR),
    call(asp.fits.local_exponent, x=TIME, y=AREA),
    call(asp.fits.ensemble, fit=asp.fits.power_law, time=TIME, areas=[AREA, [2 * area for area in AREA]]),
    call(asp.fits.measured_growth, **MEASURED, laws=("logarithm",)),
    call(SATURATION.predict, time=[0.0, 2.0]),
    call(LOGARITHM.area_ratio, time=[0.0, 2.0]),
    call(asp.fits.power_law(TIME, AREA).predict, x=[1.0, 2.0]),
    call(asp.fits.growth_rate(TIME, AREA, initial=10.0).predict, time=[1.0, 2.0]),
    *(call(one, **CREEP) for one in (THEORY.compliance, THEORY.compliance_rate, THEORY.compliance_asymptote)),
    call(asp.theory.compliance_asymptote_paper, x2=4.0),
    *(call(one, **CREEP) for one in (THEORY.exponential_growth, THEORY.exponential_growth_paper)),
    call(asp.theory.displacement, offset=[1, 2], **CREEP),
    call(asp.theory.torus_compliance, x1=3.0, x2=[0.5, 2.0], viscous=0.5, shape=(4, 6)),
    call(asp.theory.site_stiffness, x1=3.0, dimension=1),
    call(asp.theory.late_slope, x1=[1.0, 3.0], viscous=0.5, dimension=2),
    call(asp.theory.late_slope_paper, x1=3.0),
    *(call(one, **FORCES, force=[1.0, 2.0, 1.0]) for one in (THEORY.response, THEORY.response_rate)),
    call(asp.theory.dilute_area, load_per_site=[0.25, 0.5], compliance=0.5, heights=LAWS[0]),
    call(asp.theory.winkler_area, load_per_site=[0.25, 0.5], k1=3.0, heights=LAWS[0]),
    call(asp.theory.dilute_horizon, area_fraction=0.25, dimension=2),
    call(asp.theory.dilute_history, **FORCES, load_per_site=[0.5, 0.5, 0.5], k0=2.0, heights=LAWS[0]),
    call(asp.theory.contacts_at_start, **SUMMITS, dimension=2),
    call(asp.theory.contacts_at_start_paper, **SUMMITS),
    call(asp.theory.static_friction, area=[1.0, 2.0], load=8.0, shear_strength=0.5),
    call(asp.theory.flowing_area, time=[1.0, 2.0], load=8.0, area=0.5, at=1.0, stress=0.5),
    call(asp.theory.full_contact_load, heights=ROUGH, k0=2.0, k1=3.0),
    call(asp.theory.full_contact_load_relaxed, heights=ROUGH, k0=2.0),
    call(THEORY.ting, time=[0.0, 1.0, 2.0, 2.25], depth=[-1.0, 2.0, 2.0, 1.0], series=ZENER, radius=8.0),
    call(asp.theory.hertz, load=[0.0, 0.5], modulus=2.0, radius=8.0, period=16.0),
    call(asp.theory.westergaard_area, pressure=[0.0, 0.25], modulus=2.0, amplitude=0.5, wavelength=8.0),
    call(asp.theory.persson_area, pressure=[0.0, 0.25], modulus=2.0, slope=0.5),
    *(call(one, rms=2.0) for one in (THEORY.GaussianHeights, THEORY.ExponentialHeights)),
    call(asp.theory.EmpiricalHeights, heights=[0.5, 1.0, 4.0]),
    *(call(law.separation_for, mean_excess=[0.25, 0.5]) for law in LAWS),
    *(call(one, separation=[0.25, 0.5]) for law in LAWS for one in (law.exceedance, law.mean_excess)),
    call(asp.analysis.patches, in_contact=MASK, connectivity=2),
    call(asp.analysis.clustering, in_contact=MASK, box=2),
    call(asp.analysis.link_patches, before=MASK, after=MASK, connectivity=2),
    call(asp.analysis.patch_table, image=CONTACT, connectivity=2),
    call(asp.analysis.patch_tracks, dataset=HISTORY.dataset, connectivity=2),
]

INFINITY_IS_WELCOME = {
    (asp.theory.torus_compliance, "x2"),
    (SATURATION.predict, "time"),
    (LOGARITHM.area_ratio, "time"),
    *((law.exceedance, "separation") for law in LAWS),
    *((law.mean_excess, "separation") for law in LAWS),
}

WRONG: tuple[Any, ...] = (CONTACT, HISTORY, xr.Dataset(), "nope", None, {}, 3)
"""What is given in place of a dataset, a result or a name."""

WITHOUT_NUMBERS = {
    "analysis": "aging_summary contact_ages contact_maps distributions leg_table turnover with_limit",
    "asperity": "infer law predict steady_sliding",
    "campaign": "estimate fields load_plan open read_plan sweep table tally",
    "contact_law": "closure_fits law law_for",
    "figures": " ".join(
        name for name, one in vars(asp.figures).items() if inspect.isfunction(one) and name[0] != "_"
    ),
    "fits": "jackknife read_measurements",
    "inference": "infer inference_page inference_pictures read_indentation",
    "friction": "add_friction events_figure events_of events_table fit_events hold_peaks read_record "
    "record_of rate_and_state_figure save_parameters",
    "prediction": "predict",
    "relaxation": "combined read",
    "results": "load load_contact read_table save whole_file whole_folder",
    "sliding": "steady_sliding",
    "surfaces": "check_square combined",
}
"""Functions of files, datasets, masks, labels and numbers of workers or columns, or samples of any type."""


def public() -> Iterator[tuple[str, str, Any]]:
    """Every public thing: its room, its name, and what it is."""
    for name in asp.__all__:
        member = getattr(asp, name)
        if isinstance(member, ModuleType):
            yield from ((name, inner, getattr(member, inner)) for inner in member.__all__)
        else:
            yield "asperity", name, member


def functions() -> Iterator[tuple[str, FunctionType]]:
    """Public functions, and the public methods, properties and makers of public classes, by name."""
    for room, name, thing in public():
        path = f"{room}.{name}".removeprefix("asperity.")
        if isinstance(thing, FunctionType):
            yield path, thing
        elif inspect.isclass(thing):
            for inner, member in vars(thing).items():
                found = member.fget if isinstance(member, property) else member
                found = getattr(found, "__func__", getattr(found, "func", found))
                if isinstance(found, FunctionType) and (not inner.startswith("_") or inner == "__init__"):
                    yield f"{path}.{inner}", found


FLOATS, INTEGERS = ("f2", "f4", "f8", "g", ">f4"), ("int", "i1", "u2", "i8")
SCALARS = {kind: np.dtype(kind).type for kind in (*FLOATS[:4], *INTEGERS[1:])}
REALS: dict[str, Callable[[float], Any]] = {
    **SCALARS,
    **{"int": int, "array": np.array, "Fraction": Fraction, "Decimal": Decimal},
    "DataArray": lambda x: xr.DataArray(x, attrs={"units": "1"}),
}
WHOLES: dict[str, Callable[[int], Any]] = {
    **{kind: SCALARS[kind] for kind in INTEGERS[1:]},
    **{"array": np.array, "DataArray": xr.DataArray},
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
    "list": list, "array": np.array, "i1": lambda x: tuple(map(np.int8, x))
}  # fmt: skip

NEITHER = [math.nan, math.inf, True, np.True_, 2j, None, object()]
NO_REALS = [
    *NEITHER,
    *(-math.inf, np.float32("nan"), np.array(math.nan), np.ma.array(8.0, mask=True), 10**400),
    *("8", b"8", {}, Decimal("sNaN"), np.timedelta64(8, "s"), ["8"], [True], [8j], [None]),
]
NO_WHOLES = [*NEITHER, 2.0, 2.5, np.float32(2), "2", [2.0]]
NO_SHAPES = [
    *((4, n) for n in (2.5, 6.0, True, "6", -6)),
    (0, 4),
    (),
    (2, 2, 2),
    None,
    math.nan,
    "46",
    {4: 6},
]

SLOW = (asp.friction.rate_and_state, asp.friction.compare_state_laws, asp.pull)  # for each type
CASES = [
    pytest.param(one, given, id=one.__qualname__, marks=[pytest.mark.slow] * (one in SLOW))
    for one, given in CALLS
]
SEEDED = [(function, given) for function, given in CALLS if "seed" in given]
TAKES_OTHERS = {"figures.html_of", "figures.plot_contact", "analysis.observe", "analysis.patch_table"}
THINGS = [
    (name, function)
    for name, function in functions()
    if name.count(".") == 1 and name.startswith(("figures.", "analysis.")) and name not in TAKES_OTHERS
] + [(one.__name__, one) for one in (asp.friction.compare_state_laws, asp.friction.hold_peaks)]

NAMED_OTHERWISE = {
    "areas": ("y",),  # each is the y of a fit
    "branches": ("branch",),
    "run_in": ("distance",),  # of the first slide
    "strength": ("shear_strength",),
    "surface": ("heights",),
    "value": ("load", "separation"),
}
"""How errors call arguments that they do not call by their names."""

WHATEVER = {
    ("Contact.__init__", "_"): "refuses whatever it is given",
    ("Contact.__init__", "__"): "refuses whatever it is given",
    ("errors.InputError.__init__", "got"): "whatever came instead",
    ("figures.Drawing.add_subplot", "args"): "what matplotlib takes",
    ("figures.Drawing.add_subplot", "kwargs"): "what matplotlib takes",
    ("figures.Drawing.savefig", "kwargs"): "what matplotlib takes",
    ("figures.html_of", "thing"): "any result, and refuses others",
}
"""Arguments that may be anything, and why."""


def as_type(value: Any, kind: str) -> Any:
    """The same number or numbers of another type; as they are, where that type cannot hold them."""
    exact = np.array(value) if isinstance(value, (float, list)) else np.zeros(0)
    if kind in INTEGERS and exact.size:
        limits = np.iinfo("i8" if kind == "int" else kind)
        if (exact != np.rint(exact)).any() or exact.min() < limits.min or exact.max() > limits.max:
            return value
    makers: Mapping[str, Callable[[Any], Any]] = {}
    if isinstance(value, float):
        makers = REALS
    elif isinstance(value, list):
        makers = ARRAYS if exact.dtype.kind == "f" or kind not in FLOATS else {}
    elif is_shape(value):
        makers = SHAPES
    elif is_whole(value):
        makers = WHOLES
    given = exact if isinstance(value, list) else value
    return makers[kind](given) if kind in makers else value


def is_whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def is_shape(value: Any) -> bool:
    return isinstance(value, tuple) and all(isinstance(n, int) for n in value)


def bad_values(value: Any) -> Iterator[Any]:
    if isinstance(value, float):
        yield from NO_REALS
    elif is_whole(value):
        yield from NO_WHOLES
    elif is_shape(value):
        yield from NO_SHAPES
    elif isinstance(value, list):
        array = np.array(value)
        for wrong in (math.nan, math.inf, -math.inf, None):
            changed = array.astype(object if wrong is None else float)
            changed.flat[-1] = wrong
            yield changed
        yield from (array.astype(kind) for kind in ("?", "U", "c16", "m8[s]", "M8[s]"))
        yield from (None, "rough", {}, object(), [[1.0], [1.0, 2.0]])
        yield np.ma.masked_array(array, mask=array == array.flat[-1])


def is_infinite(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.dtype == float and bool(np.isinf(value).any())


def ends_the_body(key: str, value: Any) -> bool:
    """Whether these are heights that are -inf where there is no body."""
    heights = key in ("heights", "surface") and isinstance(value, np.ndarray) and value.dtype == float
    return heights and bool(np.isneginf(value).any())


def parts(result: Any) -> Any:
    """A result taken to pieces that can be compared, with the types of its numbers."""
    if dataclasses.is_dataclass(result) and not isinstance(result, type):
        compared = [field.name for field in dataclasses.fields(result) if field.compare]
        return [type(result).__name__, *((name, parts(getattr(result, name))) for name in compared)]
    if isinstance(result, xr.Dataset):
        return [parts(dict(result.attrs)), *((n, parts(v.values)) for n, v in result.variables.items())]
    if isinstance(result, (np.ndarray, np.generic)):
        return [str(result.dtype), result.shape, result.tobytes()]
    if isinstance(result, Mapping):
        return [(key, parts(value)) for key, value in result.items()]
    if isinstance(result, (tuple, list)):
        return [parts(value) for value in result]
    return [type(result).__name__, repr(result)]


def refused(function: Callable[..., Any], arguments: Mapping[str, Any]) -> str:
    """Check that a call is refused in one line; what it is about."""
    with pytest.raises(InputError) as raised:
        function(**arguments)
    assert "\n" not in str(raised.value)
    assert len(str(raised.value)) < 300
    return raised.value.name


def test_every_public_function_is_here():
    called = {function for function, _ in CALLS}
    without = {(room, name) for room, names in WITHOUT_NUMBERS.items() for name in names.split()}
    functions = {(room, name): thing for room, name, thing in public() if isinstance(thing, FunctionType)}
    assert {place for place, function in functions.items() if function not in called} == without


@pytest.mark.parametrize(("function", "arguments"), CASES)
def test_numbers_of_every_type_give_the_same_and_what_is_none_is_refused(function, arguments, here):
    np.save("heights.npy", ROUGH)
    Path("psd.csv").write_text("q,C\n1,2\n3,1\n")
    expected = parts(function(**arguments))
    for kind in {*REALS, *WHOLES, *ARRAYS, *SHAPES}:
        others = {key: as_type(value, kind) for key, value in arguments.items()}
        if any(others[key] is not value for key, value in arguments.items()):
            assert parts(function(**others)) == expected, kind
    optional = {p.name for p in inspect.signature(function).parameters.values() if p.default is None}
    for key, value in arguments.items():
        for wrong in bad_values(value):
            welcome = (function, key) in INFINITY_IS_WELCOME and is_infinite(wrong)
            welcome = welcome or ends_the_body(key, wrong)
            if not welcome and not (wrong is None and key in optional):
                named = refused(function, arguments | {key: wrong})
                assert any(word in named for word in (key, *NAMED_OTHERWISE.get(key, ()))), named


def test_an_argument_that_does_not_exist_or_is_missing_is_answered():
    for function, arguments in (one for one in CALLS if isinstance(one[0], FunctionType | type)):
        with pytest.raises(CallError) as unknown:
            function(**arguments, nope=1)
        assert (unknown.value.got, isinstance(unknown.value, TypeError)) == ("'nope'", True)
    springs: Any = asp.solids.spring_lattice
    for call, got in ((lambda: springs(k0=1.0), "'k1'"), (lambda: springs(1.0, 3.0), "too many")):
        with pytest.raises(CallError, match=got):
            call()


@pytest.mark.parametrize(("name", "function"), THINGS, ids=[name for name, _ in THINGS])
def test_a_wrong_thing_in_place_of_a_dataset_a_result_or_a_name_is_refused(name, function):
    needed = [one.name for one in inspect.signature(function).parameters.values() if one.default is one.empty]
    for wrong in WRONG:
        refused(function, dict.fromkeys(needed, wrong))


@pytest.mark.parametrize(("function", "arguments"), SEEDED)
def test_a_generator_or_its_seed_may_stand_in_place_of_the_seed(function, arguments):
    seeded = {key: value for key, value in arguments.items() if key != "seed"}
    expected, random = parts(function(**arguments)), np.random.default_rng(arguments["seed"])
    assert parts(function(**seeded, rng=arguments["seed"])) == expected
    assert parts(function(**seeded, rng=random)) == expected
    assert parts(function(**seeded, rng=random)) != expected  # it advances
    for wrong in (-1, 1.0, "1", True, np.random.RandomState(1)):
        assert refused(function, seeded | {"rng": wrong}) == "rng"
    assert refused(function, arguments | {"rng": 1}) == "seed and rng"


def test_what_takes_a_seed_takes_a_generator():
    taken = [set(inspect.signature(function).parameters) & {"seed", "rng"} for _, function in functions()]
    assert {"seed", "rng"} in taken
    assert {"seed"} not in taken


def test_no_public_argument_result_or_attribute_is_any():
    """That each has a type, the type checker sees."""
    owners: list[tuple[str, Any]] = [
        (name, function)
        for name, function in functions()
        if inspect.unwrap(function).__code__.co_filename.startswith(
            next(iter(asp.__path__))
        )  # not what a library made
    ]
    attributes = [(f"{room}.{name}", thing) for room, name, thing in public() if inspect.isclass(thing)]
    wrong, seen = [], 0
    for name, owner in owners + attributes:
        for key, kind in inspect.get_annotations(owner).items():
            unknown = re.findall(r"\b(Any|object)\b", str(kind))
            whatever = key == "return" or inspect.isclass(owner) or (name, key) in WHATEVER
            wrong += [f"{name}: {key} is {kind}"] * ("Any" in unknown or (bool(unknown) and not whatever))
            seen += 1
    assert not wrong
    assert seen > 700
