"""Fit of a record of a machine, with its stiffness; refusal of stick-slip."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d
from scipy.signal import find_peaks

from asperity.base import checks, units
from asperity.base.checks import Floats
from asperity.base.words import as_text, number
from asperity.errors import InputError
from asperity.friction.events import rows_of
from asperity.friction.laws import STATE_LAWS, StateLaw
from asperity.friction.loading import Drive, drive_of_slip, variance
from asperity.friction.machine import Machine
from asperity.friction.normal_stress import NormalStress
from asperity.friction.parameters import MISSES, MachineFit, described
from asperity.friction.records import Record
from asperity.friction.searching import solve
from asperity.friction.slider import RunsAwayError

_LIKE_NOISE = 6.0
"""Least rise of an oscillation over the noise."""

_LARGE = 0.2
"""Least rise of an oscillation over the range of friction."""

_CYCLES, _SMOOTHED = 3, 3
"""Largest number of peaks that are no oscillation; times to look for them, each by the period before."""

_BAND, _PERIODIC, _LASTS = 1.3, 0.7, 0.8
"""Ratio of frequencies about a period, least share of the power there, and of the first rises in the last."""

_ABRUPT, _SHARP, _RECOVERS = 2.5, 4.0, 0.7
"""Of stick-slip of two cycles: least height over that of many, rows of a rise over those of a fall, and rise
over the fall before."""

_STEADY, _FINE = 10, 1e-3
"""Least number of rows of steady sliding that show the noise; least noise, over the range of friction."""

_EXAMPLE = "a unit, such as 1.6e-3 / um of the friction coefficient, or 0.16 MPa/um of the shear stress"


def stiffness_of(record: Record, stiffness: object) -> float | None:
    """The stiffness over the normal stress (1/length); None to fit it, infinite if the record has slip."""
    stiffness = as_text(stiffness)
    word = stiffness.strip().lower() if isinstance(stiffness, str) else stiffness
    if word is None:
        return math.inf if record.drive is None else None
    if word == "fit":
        return None
    if word in (math.inf, "inf", "infinity"):
        return math.inf
    if not record.si:
        return checks.number("stiffness", stiffness, above=0.0)
    written = stiffness if isinstance(stiffness, str) and isinstance(number(stiffness), str) else ""
    advice = f'"{stiffness} / {record.units[1]}"' if isinstance(stiffness, int | float) else '"1.6e-3 / um"'
    for base, normal in (("1/m", 1.0), ("Pa/m", record.normal_stress), ("N/m", record.normal_force)):
        try:
            in_base = units.quantity(written, base)
        except InputError:
            continue
        if normal is None:
            quantity = "stress" if base == "Pa/m" else "force"
            expected = f"a normal {quantity} in the record, or a stiffness over it, such as 1.6e-3 / um"
            raise InputError("stiffness", expected=expected, got=checks.shown(stiffness))
        return checks.number("stiffness", in_base / normal, above=0.0)
    raise InputError("stiffness", expected=_EXAMPLE, got=checks.shown(stiffness), advice=advice)


def pulled_fit(
    record: Record, law: StateLaw, a: object, V_0: float | None, events: object, k: float | None
) -> MachineFit:
    """Fit a record from its steady sliding on, and a and k if they are None.

    Errors are those of `rate_and_state`.
    """
    if record.strength_at_rest:
        expected = "a record of a machine for a stiffness: in simulations the velocity is that of slip"
        raise InputError("record", expected=expected, got="the strength at rest")
    rows, drive = record.time.size, record.drive
    if drive is None:
        drive, _ = drive_of_slip(record.time, record.displacement, record.friction * record.pressing)
        record = replace(record, slip=record.displacement, drive=drive, velocity=drive.per_row(record.time))
    if drive.velocity[0] == 0 and drive.kinks.size:  # steady from the middle of the first slide on
        record = record.between(float(drive.edges(record.time)[1:3].mean()))
        drive = drive.between(record.time[0], math.inf)
    used, time, friction, slip = rows_of(record, events), record.time, record.friction, record.slip
    normal = NormalStress.of(time, record.pressing, friction, drive.kinks)
    refusal = oscillation(record, drive, normal.edges(drive.edges(time)))
    fixed = None if a is None else checks.number("a", a, above=0.0)
    noise = math.sqrt(variance(time, friction)), 1.0 if slip is None else math.sqrt(variance(time, slip))
    measured = np.full(drive.kinks.size, record.load_point is not None)
    alpha = None if record.presses_anew else 0.0
    machine = Machine(law, time, friction, slip, drive, used, measured, fixed, k, noise, normal, alpha)

    def fitted(each: StateLaw) -> MachineFit:
        try:
            solution = solve(replace(machine, law=each))
        except RunsAwayError:
            raise _stick_slip("at every a, b and D_c tried friction falls faster than the spring") from None
        return _result(record, *solution, rows - time.size, V_0)

    # Near the limit of stability oscillations die out so slowly that only a law tells them from stick-slip.
    if refusal is None:
        return fitted(law)
    try:
        fits = {each: fitted(each) for each in STATE_LAWS}
    except InputError:
        raise refusal from None
    if min(float(np.std(fit.residual)) for fit in fits.values()) >= MISSES * noise[0]:
        raise refusal
    return fits[law]


def oscillation(record: Record, drive: Drive, edges: Floats) -> InputError | None:
    """What refuses oscillations of one period that do not die out while nothing of the machine changes."""
    time, friction, second = record.time, record.friction, record.scales[0]
    least = max(_LIKE_NOISE * math.sqrt(variance(time, friction)), _LARGE * float(np.ptp(friction)))
    for n, speed in enumerate(drive.along(edges)):
        rows = (time >= edges[n]) & (time <= edges[n + 1])
        if speed > 0 and (cycles := _cycles(friction[rows], least)) is not None:
            peaks, height = cycles
            period = float(np.median(np.diff(time[rows][peaks])))
            span = f"{edges[n] / second:.6g} to {edges[n + 1] / second:.6g} {record.units[0]}"
            slip = f"{period * speed / record.scales[1]:.3g} {record.units[1]}"
            text = f"{peaks.size} oscillations from {span} with a period of {period / second:.3g}"
            text = f"{text} {record.units[0]}, {slip} of the load point, that do not die out"
            return _stick_slip(f"{text}, the last of {height:.2g}")
    return None


def _cycles(friction: Floats, least: float) -> tuple[NDArray[np.intp], float] | None:
    """Peaks of oscillations that last, and the rise of the last but one; None for noise.

    Two are enough if friction falls much faster than it rises, and recovers.

    Noise, of which rows may correlate, is less after a mean over a quarter of a period, and has no period:
    less of its power is at that of its peaks.
    """
    smooth, period = friction, 1
    peaks, about = find_peaks(friction, prominence=_ABRUPT * least)
    if peaks.size > 1 and _sticks(friction, peaks):
        return peaks, float(about["prominences"][-2])
    for _ in range(_SMOOTHED):
        peaks, about = find_peaks(smooth, prominence=least)
        if peaks.size <= _CYCLES:
            return None
        period = int(np.median(np.diff(peaks)))
        smooth = uniform_filter1d(friction, max(1, period // 4))
    periodic = (smooth - uniform_filter1d(friction, period))[peaks[0] : peaks[-1]]
    power, heights = np.abs(np.fft.rfft(periodic))[1:] ** 2, about["prominences"]
    frequency = np.arange(1, power.size + 1) / (peaks.size - 1)
    share = power[(frequency > 1 / _BAND) & (frequency < _BAND)].sum() / power.sum()
    half = peaks.size // 2
    early, late = np.median(heights[:half]), np.median(heights[half:])
    return (peaks, float(heights[-2])) if share > _PERIODIC and late > _LASTS * early else None


def _sticks(friction: Floats, peaks: NDArray[np.intp]) -> bool:
    """Whether friction falls much faster than it rises between some peaks, and recovers."""
    falls, rises = [], []
    for first, last in pairwise(peaks.tolist()):
        low = first + int(friction[first : last + 1].argmin())
        falls.append(_middle(friction[first : low + 1]))
        rises.append(_middle(friction[low : last + 1]))
    recovered = (friction[last] - friction[low]) / (friction[first] - friction[low])
    return bool(_SHARP * np.median(falls) < np.median(rises) and recovered > _RECOVERS)


def _middle(friction: Floats) -> int:
    """Number of rows in the middle half of a rise or a fall."""
    part = (friction - friction.min()) / np.ptp(friction)
    return max(1, int(np.count_nonzero((part > 0.25) & (part < 0.75))))


def _stick_slip(text: str) -> InputError:
    expected = "stable sliding: below the stiffness (b - a)/D_c a slider sticks and slips, by its inertia"
    advice = "a stiffer machine, a lower normal stress, or a part of the record"
    return InputError("record", expected=expected, got=text, advice=advice)


def _steady_noise(record: Record, kink: float) -> float:
    """Scatter of friction about a line before the first kink; between rows if these are few."""
    steady = record.time < kink
    time, friction = record.time[steady], record.friction[steady]
    if time.size < _STEADY:
        noise = math.sqrt(variance(record.time, record.friction))
    else:
        line = np.polynomial.Polynomial.fit(time, friction, 1)
        noise = float(np.std(friction - line(time), ddof=2))
    return max(noise, _FINE * float(np.ptp(record.friction)))


def _result(
    record: Record,
    machine: Machine,
    point: Floats,
    released: tuple[int, ...],
    tried: tuple[float, ...],
    first: int,
    V_0: float | None,
) -> MachineFit:
    """The fit in units of the record, with mu_0 at the reference velocity."""
    shape, start = machine.shape(point), float(machine.drive.velocity[0])
    a, b, D_c, k, _ = shape
    k = k / float(machine.normal.value.max())
    changes = np.append(point[len(machine.names) :], machine.normal.kinks)
    if k * D_c < b - a:
        unit, length = record.units[1], record.scales[1]
        lost = (b - a) / D_c * length
        raise _stick_slip(f"k = {k * length:.3g} / {unit} below (b - a)/D_c = {lost:.3g} / {unit}")
    machine, rho, worth = machine.judged(point)
    course = machine.course(point)
    elastic, place = course.elastic(shape), machine.moved(point).place(machine.time)
    (mu_0, drift), (friction, *_) = machine.compared(point, course)
    drift /= (whole := machine.drive.place(machine.time)[-1])
    reference = start if V_0 is None else V_0
    logs = math.log(reference / start)
    # From logarithms to numbers, and from the first velocity to the reference; fixed numbers come last.
    names = ("mu_0", "drift", *machine.names)
    scale = [getattr(shape, name) if name in ("a", "D_c", "k") else 1.0 for name in machine.names]
    turned = np.diag([1.0, 1 / whole, *scale])
    turned[0] += logs * ((np.array(names) == "a") * a - (np.array(names) == "b") * 1.0)
    linear = {"mu_0": float(mu_0 + (a - b) * logs), "drift": float(drift)}
    values = linear | dict.fromkeys(machine.names, 0.0) | shape._asdict()
    values = {"stiffness" if name == "k" else name: value for name, value in values.items()}
    residual = -machine.noise[0] * friction
    at_edge = machine.at_edge(point)
    whole_course = partial(np.pad, pad_width=(first, 0), constant_values=np.nan)
    return MachineFit(
        **described(
            residual,
            record.friction[machine.used],
            residual.size * worth,
            len(names) + machine.drive.kinks.size,
            values,
            turned @ machine.covariance(point) @ turned.T,
        ),
        law=machine.law,
        V_0=reference,
        first_state=D_c / start,
        autocorrelation=rho,
        used=np.append(np.zeros(first, bool), machine.used),
        at_edge="D_c" in at_edge,
        stiffness_at_edge="k" in at_edge,
        kinks=point[len(machine.names) :],
        released=released,
        noise=_steady_noise(record, float(changes.min())),
        tried=tried,
        friction=whole_course(mu_0 + drift * place + elastic),
        slip=whole_course(place - course.stretch(shape)),
        state=whole_course(np.exp(course.states[:, 1]) * D_c / start),
    )
