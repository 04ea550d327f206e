r"""Curves of area or friction as functions of a few parameters, for many values of these at once.

A curve is a size times a growth. Light contacts of separable solids, by J the creep compliance:

    relaxation  J(t)/J(0) of a Maxwell solid, by the share and the time of each of its branches
    power       1 + (t/time)^exponent, a spring and a spring-pot in series
    logarithm   1 + slope ln(1 + t/time)
                size = area_factor load/(modulus rms_slope), the factor from 1.6 (B. N. J. Persson, J. Chem.
                Phys. 115, 3840 (2001), doi:10.1063/1.1388626) to 2.2 (S. Hyun et al., Phys. Rev. E 70, 026117
                (2004), doi:10.1103/PhysRevE.70.026117)
    lattice     G(x1, rate t)/G(x1, 0), x1 = k1/k0, rate = k0 R: `asperity.theory.exponential_growth`
                size = load/(k0 rms k_eff(x1)), the load that of a site, the area over the nominal one
    eyring      s(first)/s(t), s = stress ln(2 length/(rate t)): `asperity.theory.flowing_area`
                size = load/s(first)
    healing     static friction, 1 + (B/scale) ln(1 + t/time)
    held        force at a held depth, E(t)/E(0) of a Maxwell solid
    ball        depth^(3/2), contact radius^3 or area^(3/2) of a ball under a held load, J(t)/J(0)
                size = `asperity.theory.hertz` (E. H. Lee, J. R. M. Radok, J. Appl. Mech. 27, 438 (1960),
                doi:10.1115/1.3644020)

Without a unit of the values, the parameter `scale` is the size.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import RectBivariateSpline, RegularGridInterpolator

from asperity.base import checks
from asperity.base.checks import Floats
from asperity.base.words import closest, counted
from asperity.errors import InputError
from asperity.inference.priors import Given, Prior
from asperity.relaxation import Creep, fit
from asperity.theory import exponential_growth, hertz, site_stiffness

Values = Mapping[str, Floats]
"""Parameters by name, each of shape (m,)."""

Curve = Callable[[Floats, Values], Floats]
"""A curve at times of shape (n,): shape (m, n)."""

MOST_BRANCHES = 3
_LEAST = 1e-4
"""Least size by default, over the smallest value."""
_RAMP = 16
"""Nodes of the quadrature over a ramp."""
BEYOND = 1e5
"""End, over the last time, of the branches that approximate another creep."""
_RATIOS, _TIMES = (1e-2, 1e2), (1e-8, 1e16)
"""Ranges of k1/k0 and of k0 R t in which the lattice's compliance is tabulated."""


def _nothing(_: Values) -> float:
    return 0.0


@dataclass(frozen=True)
class Model:
    """A curve, and its parameters with their priors.

    Attributes
    ----------
    growth, power
        The curve over its size is a power of the growth: 1 for areas, 2/3 for the depth of a ball, 1/3 for
        the radius of its contact.
    size
        The value before any growth, in absolute units; or None.
    excess
        By how much sets of parameters leave what is allowed, shape (m, ...); at most 0 inside.
    held
        Load at a held displacement over its first value; None without a closed form.
    solid
        Section ``[solid]`` of a configuration, of one set of parameters; or None.
    ramp
        Duration of the ramp of the load, s: the growth is its mean over the ramp.
    scaled
        Whether the size of the curve is the parameter ``scale``.
    times
        Number of relaxation times, 0 for another creep.
    """

    name: str
    growth: Curve
    priors: dict[str, Prior]
    size: Callable[[Values], Floats] | None = None
    excess: Callable[[Values], Floats | float] = _nothing
    held: Curve | None = None
    solid: Callable[[Mapping[str, float]], dict[str, object]] | None = None
    ramp: float = 0.0
    scaled: bool = False
    power: float = 1.0
    times: int = 0

    @property
    def words(self) -> str:
        """The number of relaxation times, or the name of another curve."""
        return counted(self.times, "relaxation time") if self.times else self.name

    def curve(self, time: Floats, p: Values) -> Floats:
        """Observed quantity, shape (m, n)."""
        grown = self.growth(time, p)
        if self.ramp:
            rule = zip(*np.polynomial.legendre.leggauss(_RAMP), strict=True)
            parts = [w / 2 * self.growth(time - self.ramp * (1 + at) / 2, p) for at, w in rule]
            grown = np.sum(parts, axis=0)
        if self.power != 1:
            grown = grown**self.power
        if self.scaled:
            return np.asarray(p["scale"][:, None] * grown)
        return grown if self.size is None else np.asarray(self.size(p)[:, None] * grown)

    def with_priors(self, stated: Mapping[str, Given]) -> Model:
        """The same with other priors of some parameters; `InputError` for what is none."""
        priors = dict(self.priors)
        for name, prior in stated.items():
            if name not in priors:
                expected, advice = f"a parameter: {', '.join(priors)}", closest(str(name), priors) or ""
                raise InputError(f"prior of {name}", expected=expected, got=name, advice=advice)
            priors[name] = Prior.of(name, prior, priors[name].unit)
        return replace(self, priors=priors)


def of_name(
    name: object,
    time: Floats,
    value: Floats,
    *,
    priors: Mapping[str, Given] | None = None,
    branches: int = 1,
    absolute: bool = False,
    ramp: float = 0.0,
    quantity: str | None = None,
) -> Model:
    """Make a model by its name, with default priors that are wide for the data; or of a user's function."""
    if ramp and name not in (*CREEP, "ball"):
        expected = f"a load applied instantly, or a separable solid: model {', '.join(CREEP)} or ball"
        raise InputError("ramp", expected=expected, got=checks.shown(name))
    if callable(name):
        if absolute:
            raise InputError("absolute", expected="a model of Asperity", got="a function of your own")
        return _own(name, priors)
    checks.choice("model", name, (*MODELS, "ball", "a function of time and parameters"))
    ends = float(time[time > 0][0]), float(time[-1])
    built = MODELS["relaxation" if name == "ball" else str(name)](*ends, branches)
    if quantity is not None:
        creep = {key: prior for key, prior in built.priors.items() if key not in _BODY}
        size = functools.partial(_of_ball, quantity=quantity)
        named = built.name if name in CREEP[1:] else "ball"
        built = replace(built, name=named, priors=_BALL | creep, size=size, power=OF_BALL[quantity])
    if absolute and built.size is None:
        raise InputError("absolute", expected="none, for only ratios count", got=f"model {name!r}")
    if not absolute:
        least, most = float(value.min()), float(value.max())
        scale = Prior("log_uniform", _LEAST * least, 2 * most)
        built = replace(built, priors={"scale": scale, **built.priors})
        if (relative := built.priors.get("B")) is not None:  # B has the unit of the values
            built = built.with_priors({"B": (most * relative.first, most * relative.second)})
    built = built.with_priors(priors or {})
    if x1 := built.priors.get("x1"):
        low, high = x1.at(np.array(x1.reach)) / _RATIOS
        if low < 1 - 1e-9 or high > 1 + 1e-9:
            expected = f"values from {_RATIOS[0]:g} to {_RATIOS[1]:g}, where the theory is tabulated"
            raise InputError("prior of x1", expected=expected, got=str(x1))
    return replace(built, ramp=ramp, scaled=not absolute)


_MODULUS = Prior("log_uniform", 1.0, 1e12, "Pa")  # softest gels to stiffer than diamond

_BODY = {
    "load": Prior("log_uniform", 1e-6, 1e6, "N"),
    "modulus": _MODULUS,
    "rms_slope": Prior("log_uniform", 1e-3, 10.0),
    "area_factor": Prior("uniform", 1.6, 2.2),
}


_BALL = {
    "load": Prior("log_uniform", 1e-11, 1e6, "N"),
    "modulus": _MODULUS,
    "radius": Prior("log_uniform", 1e-9, 1.0, "m"),
}
OF_BALL = {"depth": 2 / 3, "radius": 1 / 3, "area": 2 / 3}
"""Measured quantities of a ball under a held load, and their powers of J."""


def _of_ball(p: Values, *, quantity: str) -> Floats:
    contact = hertz(p["load"], modulus=p["modulus"], radius=p["radius"])
    radius = contact.contact_radius
    return {"depth": contact.approach, "radius": radius, "area": np.pi * radius**2}[quantity]


def _of_body(p: Values) -> Floats:
    return np.asarray(p["area_factor"] * p["load"] / (p["modulus"] * p["rms_slope"]))


def _half_space(p: Mapping[str, float], **creep: Any) -> dict[str, object]:
    modulus = {"modulus": f"{p['modulus']:.6g} Pa"} if "modulus" in p else {}
    return {"kind": "half_space", **modulus, **creep}


def _fitted(p: Mapping[str, float], *, growth: Curve, span: tuple[float, float]) -> dict[str, object]:
    """Approximate creep by branches, one a decade of the span."""
    t = np.geomspace(*span, round(8 * np.log10(span[1] / span[0])))
    values = growth(t, {name: np.array([value]) for name, value in p.items()})[0]
    return _half_space(p, branches=_rounded(fit(Creep(t, values), per_decade=1).series.branches))


def _rounded(branches: Iterable[tuple[float, float]]) -> list[list[float | str]]:
    return [[float(f"{share:.4g}"), f"{time:.4g} s"] for share, time in branches]


def _spectrum(first: float, last: float, branches: int) -> dict[str, Prior]:
    """Shares and relaxation times, which are in rising order."""
    numbers = range(1, branches + 1)
    priors = {f"share_{n}": Prior("uniform", 0.0, 1.0) for n in numbers}
    return priors | {f"time_{n}": Prior("log_uniform", first / 100, 100 * last, "s") for n in numbers}


def relaxation(first: float, last: float, branches: int) -> Model:
    """A separable half-space with relaxation times."""
    priors = _BODY | _spectrum(first, last, branches)
    return Model("relaxation", _maxwell, priors, _of_body, _beyond, relaxed, _maxwell_solid, times=branches)


def held(first: float, last: float, branches: int) -> Model:
    """Force of a half-space at a held depth, with relaxation times."""
    priors = _spectrum(first, last, branches)
    return Model("held", relaxed, priors, excess=_beyond, solid=_maxwell_solid, times=branches)


def branches_of(p: Values) -> tuple[Floats, Floats]:
    """Shares and times, shape (m, branches)."""
    shares, times = (
        [values for name, values in p.items() if name.startswith(kind)] for kind in ("share_", "time_")
    )
    return np.stack(shares, -1), np.stack(times, -1)


def _beyond(p: Values) -> Floats:
    """By how much shares sum to more than 1, and times fall, in ln."""
    shares, times = branches_of(p)
    return np.column_stack([shares.sum(-1) - 1, -np.diff(np.log(times))])


def _maxwell(time: Floats, p: Values) -> Floats:
    r"""Compliance J(t)/J(0) of many Maxwell solids.

    Under a constant stress the relaxed parts q_b of the branches follow dq/dt = D (1 + (1 g^T - I) q) with
    D = 1/tau. In the variables q_b sqrt(g_b tau_b) the matrix is symmetric; minus its eigenvalues are the
    retardation rates.
    """
    shares, times = branches_of(p)
    root = np.sqrt(np.maximum(shares, 0) / times)  # a difference may begin beyond 0
    matrix = root[:, :, None] * root[:, None, :] - np.eye(times.shape[1]) / times[:, :, None]
    minus, vectors = np.linalg.eigh(matrix)
    weights = (root[:, None, :] @ vectors)[:, 0] ** 2  # of (1 - exp(-rate t))/rate
    rates = np.maximum(-minus, 1e-12 / time[-1])[:, None, :]  # a fluid has a rate of 0
    return np.asarray(1 - (weights[:, None, :] / rates * np.expm1(-rates * time[:, None])).sum(-1))


def relaxed(time: Floats, p: Values) -> Floats:
    """Relaxation over its first value of many Maxwell solids."""
    shares, times = branches_of(p)
    return np.asarray(1 + (shares[:, None, :] * np.expm1(-time[:, None] / times[:, None, :])).sum(-1))


def _maxwell_solid(p: Mapping[str, float]) -> dict[str, object]:
    shares, times = branches_of({name: np.array(value) for name, value in p.items()})
    shares = shares / max(shares.sum(), 1.0)  # a search exceeds 1 a little
    return _half_space(p, branches=_rounded(zip(shares.tolist(), times.tolist(), strict=True)))


def _creeping(growth: Curve, first: float, last: float, **creep: Prior) -> Model:
    """A separable half-space whose creep has a name, and is approximated by branches in a configuration."""
    solid = functools.partial(_fitted, growth=growth, span=(first / 100, BEYOND * last))
    return Model(growth.__name__[1:], growth, _BODY | creep, _of_body, solid=solid)


def power(first: float, last: float, _: int) -> Model:
    """A separable half-space whose creep is a power of time."""
    time = Prior("log_uniform", first / 1e6, last * 1e9, "s")
    return _creeping(_power, first, last, exponent=Prior("uniform", 0.0, 1.0), time=time)


def _power(time: Floats, p: Values) -> Floats:
    return np.asarray(1 + (time / p["time"][:, None]) ** p["exponent"][:, None])


def logarithm(first: float, last: float, _: int) -> Model:
    """A separable half-space whose creep is a logarithm of time."""
    time = Prior("log_uniform", first / 1e4, 100 * last, "s")
    return _creeping(_logarithm, first, last, slope=Prior("log_uniform", 1e-4, 10.0), time=time)


def _logarithm(time: Floats, p: Values) -> Floats:
    return np.asarray(1 + p["slope"][:, None] * np.log1p(time / p["time"][:, None]))


def lattice(first: float, last: float, _: int) -> Model:
    """Light contacts of exponential heights on the lattice of springs."""
    priors = {
        "load": Prior("log_uniform", 1e-8, 1.0),
        "k0": Prior("log_uniform", 1e-3, 1e3),
        "rms": Prior("log_uniform", 1e-3, 1e3),
        "x1": Prior("log_uniform", *_RATIOS),
        "rate": Prior("log_uniform", 1e-3 / last, 1e4 / first, "1/s"),
    }
    return Model("lattice", _lattice, priors, _of_lattice, solid=_lattice_solid)


def _of_lattice(p: Values) -> Floats:
    return np.asarray(p["load"] / (p["k0"] * p["rms"] * site_stiffness(p["x1"])))


@functools.cache
def _growth() -> RegularGridInterpolator:
    """Logarithm of G(x1, x2)/G(x1, 0) against ln x1 and ln x2: linear between points of a spline, to 1e-4."""
    x1, x2 = (np.log(np.geomspace(*ends, n)) for ends, n in ((_RATIOS, 33), (_TIMES, 193)))
    spline = RectBivariateSpline(x1, x2, np.log(exponential_growth(np.exp(x1)[:, None], np.exp(x2))))
    rows, columns = (np.linspace(x[0], x[-1], 8 * (x.size - 1) + 1) for x in (x1, x2))
    fine = spline(rows, columns)
    return RegularGridInterpolator((rows, columns), fine, bounds_error=False, fill_value=None)


def _lattice(time: Floats, p: Values) -> Floats:
    both = np.broadcast_arrays(p["x1"][:, None], p["rate"][:, None] * time)
    logs = [np.log(np.clip(x, *ends)) for x, ends in zip(both, (_RATIOS, _TIMES), strict=True)]
    return np.asarray(np.exp(_growth()(np.stack(logs, -1))))


def _lattice_solid(p: Mapping[str, float]) -> dict[str, object]:
    k0 = p.get("k0", 1.0)  # else it is the unit
    keys: dict[str, object] = {"kind": "spring_lattice", "k0": k0}
    keys |= {"k1": p["x1"] * k0} if "x1" in p else {}
    return keys | ({"R": p["rate"] / k0} if "rate" in p else {})


def eyring(first: float, last: float, _: int) -> Model:
    """Contacts that flow by Eyring's law at pressures above its stress, and bear the whole load."""
    priors = {
        "load": Prior("log_uniform", 1e-6, 1e6, "N"),
        "stress": Prior("log_uniform", 1e4, 1e10, "Pa"),
        "rate": Prior("log_uniform", 1e-50, 1e-3, "m/s"),
        "length": Prior("log_uniform", 1e-9, 1e-3, "m"),
        "modulus": _MODULUS,
    }
    growth, size = (functools.partial(of_time, first=first) for of_time in (_eyring, _of_flow))
    return Model("eyring", growth, priors, size, functools.partial(_held_up, last=last), solid=_eyring_solid)


def _pressure(time: Floats | float, p: Values) -> Floats:
    """Pressure of the contacts over the stress of Eyring's law."""
    pressure = np.log(2 * p["length"] / p["rate"])[:, None] - np.log(time)
    return np.asarray(np.where(pressure < 1, np.exp(np.minimum(pressure, 1) - 1), pressure))  # finite below


def _held_up(p: Values, *, last: float) -> Floats:
    """By how much the pressure is below the stress of the law, over this."""
    return 1 - _pressure(last, p)[:, 0]


def _of_flow(p: Values, *, first: float) -> Floats:
    return np.asarray(p["load"] / (p["stress"] * _pressure(first, p)[:, 0]))


def _eyring(time: Floats, p: Values, *, first: float) -> Floats:
    return np.asarray(_pressure(first, p) / _pressure(np.maximum(time, 1e-3 * first), p))


def _eyring_solid(p: Mapping[str, float]) -> dict[str, object]:
    units = {"rate": "m/s", "stress": "Pa"}
    keys = {f"creep_{name}": f"{p[name]:.6g} {unit}" for name, unit in units.items() if name in p}
    return _half_space(p, creep="eyring", **keys)


def healing(first: float, last: float, _: int) -> Model:
    """Static friction against hold time; B here over the largest value."""
    priors = {"B": Prior("log_uniform", 1e-5, 1.0), "time": Prior("log_uniform", first / 1e4, 10 * last, "s")}
    return Model("healing", _healing, priors)


def _healing(time: Floats, p: Values) -> Floats:
    return np.asarray(1 + (p["B"] / p["scale"])[:, None] * np.log1p(time / p["time"][:, None]))


def _own(function: Callable[..., ArrayLike], priors: Mapping[str, Given] | None) -> Model:
    ranges = {name: Prior.of(name, stated, "") for name, stated in (priors or {}).items()}
    try:
        if not ranges:
            raise TypeError("none")
        inspect.signature(function).bind(np.ones(2), **dict.fromkeys(ranges, 1.0))
    except TypeError as error:
        expected = "one for each parameter of the function, which takes the times first"
        advice = "priors={'slope': (1e-3, 1)}"
        raise InputError("priors", expected=expected, got=str(error), advice=advice) from None
    curve = functools.partial(_own_curve, function=function)
    return Model(getattr(function, "__name__", "own"), curve, ranges)


def _own_curve(time: Floats, p: Values, *, function: Callable[..., ArrayLike]) -> Floats:
    rows = zip(*p.values(), strict=True)
    curves = [np.asarray(function(time, **dict(zip(p, map(float, row), strict=True)))) for row in rows]
    for curve in curves:
        if curve.shape != time.shape:
            expected = f"a function that returns shape {time.shape}, a value for each time"
            raise InputError("model", expected=expected, got=f"shape {curve.shape}")
    return np.array(curves, dtype=np.float64).reshape(-1, time.size)


OF_BRANCHES = ("relaxation", "ball", "held")
"""Models of relaxation times."""

CREEP = ("relaxation", "power", "logarithm")
"""Models of a separable half-space."""

MODELS: dict[str, Callable[[float, float, int], Model]] = {
    make.__name__: make for make in (relaxation, held, power, logarithm, lattice, eyring, healing)
}
"""Models by name: functions of the first and the last time and a number of branches."""
