"""Fit of a record of a machine: which rows, which stiffness, and what cannot be fitted."""

from __future__ import annotations

import math
import re

import numpy as np
from numpy.typing import NDArray
from scipy.signal import find_peaks

from asperity.base import checks, units
from asperity.base.checks import Floats
from asperity.base.words import as_text
from asperity.errors import InputError
from asperity.fits.result import quality, rms
from asperity.friction.laws import StateLaw
from asperity.friction.loading import Drive, drive_of_slip, variance
from asperity.friction.machine import Machine
from asperity.friction.parameters import MachineFit
from asperity.friction.records import RUN_IN, Record
from asperity.friction.searching import Solved, solve
from asperity.friction.slider import RunsAwayError

_LIKE_NOISE = 6.0
"""An oscillation is one where it rises so many times the noise."""

_LARGE = 0.2
"""And to such a part of the range of friction."""

_CYCLES = 3
_WITH_UNIT = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(\S.*?)\s*")
_EXAMPLE = "a unit, such as 1.6e-3 / um of the friction coefficient, or 0.16 MPa/um of the shear stress"


def stiffness_of(record: Record, given: object) -> float | None:
    """The stiffness over the normal stress (1/length); None to fit it, infinite where slip is known."""
    if given is None:
        return math.inf if record.drive is None else None
    if isinstance(given, str) and given.strip().lower() == "fit":
        return None
    if not record.si or given == math.inf:
        return math.inf if given == math.inf else checks.number("stiffness", given, above=0.0)
    text = _WITH_UNIT.fullmatch(str(as_text(given)))
    if text is None:
        advice = f'"{given} / {record.units[1]}"' if isinstance(given, int | float) else '"1.6e-3 / um"'
        raise InputError("stiffness", expected=_EXAMPLE, got=checks.shown(given), advice=advice)
    unit = re.sub(r"\s*/\s*", "/", f"1{text[2]}" if text[2].startswith("/") else text[2])
    for base, normal in (("1/m", 1.0), ("Pa/m", record.normal_stress), ("N/m", record.normal_force)):
        if (factor := units.factor(unit, base)) is None:
            continue
        if normal is None:
            what = "stress" if base == "Pa/m" else "force"
            expected = f"a normal {what} in the record, or a stiffness over it, such as 1.6e-3 / um"
            raise InputError("stiffness", expected=expected, got=checks.shown(given))
        return checks.number("stiffness", float(text[1]) * factor / normal, above=0.0)
    raise InputError("stiffness", expected=_EXAMPLE, got=checks.shown(given))


def pulled_fit(
    record: Record, law: StateLaw, a: object, V_0: float | None, kinds: tuple[int, ...], k: float | None
) -> MachineFit:
    """Fit a record from its steady sliding on; k is None where it is fitted. `InputError` as there."""
    if record.strength_at_rest:
        expected = "a record of a machine for a stiffness: in simulations the velocity is that of slip"
        raise InputError("record", expected=expected, got="the strength at rest")
    slip, drive = record.slip, record.drive
    if drive is None:
        slip = record.displacement
        drive = drive_of_slip(record.time, slip, record.friction)[0]
    first, drive = _steady_start(record.time, drive)
    time, friction = record.time[first:], record.friction[first:]
    _refuse_steady(record, drive, time)
    _refuse_oscillation(record, drive, time, friction)
    if a is None:
        a = record.a
    used = np.isin(record.events[first:], (RUN_IN, *kinds))
    slip = None if slip is None else slip[first:]
    fixed = None if a is None or a == "fitted" else checks.number("a", a, above=0.0)
    noise = math.sqrt(variance(time, friction)), 1.0 if slip is None else math.sqrt(variance(time, slip))
    measured = np.full(drive.kinks.size, record.load_point is not None)
    machine = Machine(law, time, friction, slip, drive, used, measured, fixed, k, noise)
    try:
        found = solve(machine)
    except RunsAwayError:
        raise _stick_slip("at every a, b and D_c tried friction falls faster than the spring") from None
    return _result(record, found, first, V_0)


def _steady_start(time: Floats, drive: Drive) -> tuple[int, Drive]:
    """First row to fit, half-way through the first slide if the record begins at rest; and the drive then."""
    if drive.velocity[0] > 0 or drive.kinks.size == 0:
        return 0, drive
    start = float(drive.edges(time)[1:3].mean())
    return int(np.searchsorted(time, start)), Drive(drive.kinks[1:], drive.velocity[1:], drive.spread[1:])


def _refuse_steady(record: Record, drive: Drive, time: Floats) -> None:
    if drive.kinks.size:
        return
    first, last = time[0] / record.scales[0], time[-1] / record.scales[0]
    got = f"one velocity, {record.speed(drive.velocity[0])}, from {first:.6g} to {last:.6g} {record.units[0]}"
    raise InputError("record", expected="a hold, or a step of the velocity, to learn b and D_c from", got=got)


def _refuse_oscillation(record: Record, drive: Drive, time: Floats, friction: Floats) -> None:
    """Refuse oscillations that do not die out while the load point goes on steadily."""
    noise = math.sqrt(variance(time, friction))
    edges = drive.edges(time)
    for n, speed in enumerate(drive.velocity):
        inside = friction[(time >= edges[n]) & (time <= edges[n + 1])]
        least = max(_LIKE_NOISE * noise, _LARGE * float(np.ptp(friction)))
        peaks, about = find_peaks(inside, prominence=least)
        heights = about["prominences"]
        if speed > 0 and peaks.size > _CYCLES and heights[-2] >= heights[1]:
            second = record.scales[0]
            span = f"{edges[n] / second:.6g} to {edges[n + 1] / second:.6g} {record.units[0]}"
            text = f"{peaks.size} oscillations from {span} that do not die out, the last of {heights[-2]:.2g}"
            raise _stick_slip(text)


def _stick_slip(text: str) -> InputError:
    return InputError(
        "record",
        expected="stable sliding: below the stiffness (b - a)/D_c a slider sticks and slips, by its inertia",
        got=text,
        advice="a stiffer machine, a lower normal stress, or a part of the record, --from and --to",
    )


def _result(record: Record, found: Solved, first: int, V_0: float | None) -> MachineFit:
    """The numbers in the units of the record, with mu_0 at the reference velocity."""
    machine, shape = found.machine, found.machine.shape(found.point)
    start = float(machine.drive.velocity[0])
    reference = start if V_0 is None else V_0
    a, b, D_c, k = shape
    if k * D_c < b - a:
        unit, length = record.units[1], record.scales[1]
        lost = (b - a) / D_c * length
        raise _stick_slip(f"k = {k * length:.3g} / {unit} below (b - a)/D_c = {lost:.3g} / {unit}")
    # From logarithms to numbers.
    scale = np.array([getattr(shape, name) if name in ("a", "D_c", "k") else 1.0 for name in found.names])
    covariance = found.covariance * np.outer(scale, scale)

    def spread(**weights: float) -> float:
        row = np.array([weights.get(name, 0.0) for name in found.names])
        return math.sqrt(max(0.0, float(row @ covariance @ row)))

    logs = math.log(reference / start)
    parameters, effective = found.names, found.residual.size * found.worth
    elastic, place = found.course.elastic(shape), machine.moved(found.point).place(machine.time)
    mu_0, drift = found.linear.tolist()
    used: NDArray[np.bool_] = np.concatenate([np.zeros(first, bool), machine.used])
    count = len(parameters) + machine.drive.kinks.size

    def course(values: Floats) -> Floats:
        return np.concatenate([np.full(first, np.nan), values])

    return MachineFit(
        **quality(found.residual, record.friction[used], None, count)
        | {"degrees_of_freedom": max(1.0, effective - count)},
        rms_residual=rms(found.residual / record.friction[used]),
        law=machine.law,
        V_0=reference,
        mu_0=mu_0 + (a - b) * logs,
        mu_0_stderr=spread(mu_0=1.0, a=logs, b=-logs),
        a=a,
        a_stderr=spread(a=1.0),
        b=b,
        b_stderr=spread(b=1.0),
        D_c=D_c,
        D_c_stderr=spread(D_c=1.0),
        a_minus_b=a - b,
        a_minus_b_stderr=spread(a=1.0, b=-1.0),
        first_state=D_c / start,
        autocorrelation=found.autocorrelation,
        effective_points=effective,
        residual=found.residual,
        used=used,
        at_edge="D_c" in found.at_edge,
        stiffness=k,
        stiffness_stderr=spread(k=1.0),
        stiffness_at_edge="k" in found.at_edge,
        drift=drift,
        drift_stderr=spread(drift=1.0),
        kinks=found.point[len(machine.names) :],
        released=found.released,
        friction=course(mu_0 + drift * place + elastic),
        slip=course(place - elastic / k),
        state=course(np.exp(found.course.states[:, 1]) * D_c / start),
    )
