r"""Power-law and fractional Zener relaxation, as Prony series of a stated accuracy over stated times.

Both laws are integrals of exponentials with a positive spectrum of relaxation times. Non-negative least
squares give the shares, for as many log-spaced times as the accuracy needs. They fit G(t) between the times,
and its Carson transform s G(s) at rates s above 1/last. The transform of the compliance J is the inverse of
that, so J is right too: it depends on what relaxes before `first`, and the transform at s > 1/first shows it.

The fractional Zener solid relaxes with the Mittag-Leffler function E_n. Integrated over the cumulative
distribution c of its spectrum,

    E_n(-x^n) = integral_0^1 exp(-x r(c)) dc ,        r(c) = [ sin(n pi c) / sin(n pi (1 - c)) ]^(1/n)

(the substitution makes the peak of the spectrum at n -> 1 harmless). With c = 1/(1 + exp(-w)) the
trapezoidal rule converges exponentially.

References
----------
R. Gorenflo, A. A. Kilbas, F. Mainardi, S. V. Rogosin, *Mittag-Leffler Functions, Related Topics and
Applications* (Springer 2020), DOI 10.1007/978-3-662-61550-8.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np
import scipy

from asperity.base import checks
from asperity.base.checks import Floats
from asperity.base.positive_sums import log_times, positive_weights
from asperity.errors import LARGEST, InputError
from asperity.relaxation.series import PronySeries, of_weights

_DENSITIES = (1, 1.25, 1.5, 1.75, 2, 2.5, 3, 3.5, 4, 5, 6, 8, 10)  # times per decade, tried in this order

_DECADES, _ABOVE_0 = 40, "a finite number > 0"


def power_law(
    *, modulus: float, exponent: float, time: float, first: float, last: float, accuracy: float = 0.01
) -> PronySeries:
    """Approximate the modulus ``modulus * (t / time)**-exponent`` between two times.

    Before `first` the series tends to a finite instantaneous modulus, unlike the law; long after `last` it
    vanishes, before the law does.

    Parameters
    ----------
    modulus
        G at `time`, above 0.
    exponent
        Above 0 and below 1.
    time
        Time of reference, above 0.
    first, last
        Times between which the series approximates the law: its `span`.
    accuracy
        Largest relative error of G between them, and of its Carson transform, from 1e-6 to 0.5. The creep
        compliance J, and the area under a constant load, err no more over a decade or more; over less up to
        three times as much (measured).

    Raises
    ------
    InputError
        A number is out of its range, or the times are in the wrong order.
    """
    modulus = checks.number("modulus", modulus, least=1 / LARGEST, expected=_ABOVE_0)
    n = checks.number("exponent", exponent, above=0, below=1)
    time, first, last, accuracy = _checked(time, first, last, accuracy)

    def law(t: Floats) -> Floats:
        return np.asarray((t / first) ** -n)

    def transform(s: Floats) -> Floats:
        return np.asarray(math.gamma(1 - n) * (s * first) ** n)

    series = _approximate(law, transform, first, last, accuracy, through=first)
    return dataclasses.replace(series, modulus=modulus * (first / time) ** -n * series.modulus)


def fractional_zener(
    *,
    instantaneous: float,
    relaxed: float,
    exponent: float,
    time: float,
    first: float,
    last: float,
    accuracy: float = 0.01,
) -> PronySeries:
    """Approximate the fractional Zener solid between two times; its ends G(0) and G(infinity) are exact.

        G(t) = relaxed + (instantaneous - relaxed) E_n(-(t/time)^n)

    with the Mittag-Leffler function E_n of the exponent n: a stretched exponential at first, a power law
    t^-n at last, and an exponential for n = 1.

    Parameters
    ----------
    instantaneous, relaxed
        Moduli at time 0, above 0, and at infinite time, not below 0 and below the first.
    exponent, time
        n, from 0.02 to 1; relaxation time, above 0.

    Other arguments, result and errors are those of `power_law`.
    """
    modulus = checks.number("instantaneous", instantaneous, least=1 / LARGEST, expected=_ABOVE_0)
    permanent = checks.number("relaxed", relaxed, least=0, below=modulus) / modulus
    n = checks.number("exponent", exponent, least=0.02, most=1)
    time, first, last, accuracy = _checked(time, first, last, accuracy)

    def law(t: Floats) -> Floats:
        return np.asarray(permanent + (1 - permanent) * mittag_leffler(n, t / time))

    def transform(s: Floats) -> Floats:
        return np.asarray(permanent + (1 - permanent) / (1 + (s * time) ** -n))

    series = _approximate(law, transform, first, last, accuracy, through=time, permanent=permanent)
    return dataclasses.replace(series, modulus=modulus)


def mittag_leffler(exponent: float, time: Floats) -> Floats:
    """E_n(-t^n), for 0.02 <= n <= 1 and t >= 0 of any shape, to about 1e-13 of it where it is above 1e-40."""
    n = exponent
    if n == 1:
        return np.exp(-time)
    step = min(0.28 * n, 0.2)
    w = step * np.arange(-125 // step, 38 / step + 1)
    c, rest = scipy.special.expit(w), scipy.special.expit(-w)
    # sin(n pi c) = sin(pi (1 - n) + n pi (1 - c)), which is exact where c is near 1
    upper = np.where(c < 0.5, np.sin(n * math.pi * c), np.sin(math.pi * (1 - n) + n * math.pi * rest))
    lower = np.where(rest < 0.5, np.sin(n * math.pi * rest), np.sin(math.pi * (1 - n) + n * math.pi * c))
    log_rate = np.log(upper / lower) / n
    weights = step * c * rest
    flat = np.atleast_1d(time).ravel()
    with np.errstate(divide="ignore", over="ignore"):
        values = [weights @ np.exp(-np.exp(log_rate + np.log(t))) for t in flat]
    return np.reshape(values, np.shape(time))


def _checked(time: float, first: float, last: float, accuracy: float) -> tuple[float, ...]:
    time = checks.number("time", time, least=1 / LARGEST, expected=_ABOVE_0)
    first = checks.number("first", first, least=1 / LARGEST, expected=_ABOVE_0)
    last = checks.number("last", last, above=first)
    if (decades := math.log10(last / first)) > _DECADES:
        raise InputError("last", expected=f"at most {_DECADES} decades after `first`", got=f"{decades:.1f}")
    return time, first, last, checks.number("accuracy", accuracy, least=1e-6, most=0.5)


def _approximate(
    law: Callable[[Floats], Floats],
    transform: Callable[[Floats], Floats],
    first: float,
    last: float,
    accuracy: float,
    *,
    through: float,
    permanent: float = 0.0,
) -> PronySeries:
    """Approximate a law by a series of its Carson transform, which tends to G(0) at an infinite rate."""
    between = _grid(first, last, 60)
    exact = law(between)
    if exact[-1] < 1 / LARGEST:
        at = f"a modulus of 0 at {last:g}"
        raise InputError("last", expected="times before all has relaxed, or a relaxed modulus", got=at)
    best = math.inf
    start = float(transform(np.array(math.inf)))
    fastest = first / (2 * math.log(4 / accuracy))  # at `first` all that is faster has relaxed and crept
    for density in _DENSITIES:
        # Far faster times act as a dashpot; far slower ones have not begun to relax.
        times = log_times(min(fastest / 300, through), 100 * last / accuracy, density, through)
        per_decade = max(10, 4 * density)
        t, s = _grid(first, last, per_decade), _grid(1 / last, 1 / fastest, per_decade)
        s = np.append(s, [math.inf] * math.isfinite(start))
        columns = np.vstack([np.exp(-t[:, None] / times), 1 / (1 + 1 / (s[:, None] * times))])
        values = np.append(law(t), transform(s))
        shares = positive_weights(columns, values - permanent, values)
        if math.isfinite(start):
            shares *= (start - permanent) / shares.sum()
        series = of_weights(np.append(shares, permanent), times)
        fitted = (columns @ shares + permanent) / values
        error = float(np.abs(np.append(series.modulus_at(between) / exact, fitted) - 1).max())
        best = min(best, error)
        if error <= accuracy:
            return dataclasses.replace(series, span=(first, last), error=error)
    expected = f"{best:.1g} or more, for this law between these times"
    raise InputError("accuracy", expected=expected, got=f"{accuracy:g}")


def _grid(first: float, last: float, per_decade: float) -> Floats:
    count = max(9, 1 + math.ceil(per_decade * math.log10(last / first)))
    return np.geomspace(first, last, count)
