"""Compiled integration of a slider through a segment, in which time goes from 0 to 1.

RODAS is an L-stable Rosenbrock method of order 4, with an error estimate, and values between its steps of
order 3 (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., IV.7, Springer, 1996):

    (1/(h gamma) - J) k_i = f(y + sum A_ij k_j) + sum C_ij k_j/h + h D_i df/dt,    gamma = 1/4

Its steps depend on real parts alone. So an imaginary part of a parameter, however small, gives the exact
derivative of the course (W. Squire, G. Trapp, SIAM Rev. 40, 110 (1998), doi:10.1137/S003614459631241X).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from asperity.contact.compiled import compiled, inlined

_LAST = 1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950
_A = [1.544, 0.9466785280815826, 0.2557011698983284, 3.314825187068521, 2.896124015972201]
_A += [0.9986419139977817, *_LAST, *_LAST, 1.0]
_C = [-5.6688, -2.430093356833875, -0.2063599157091915, -0.1073529058151375, -9.594562251023355]
_C += [-20.47028614809616, 7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160]
_C += [8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054]
_FIRST = [10.12623508344586, -7.487995877610167, -34.80091861555747, -7.992771707568823, 1.025137723295662]
_NEXT = [-0.6762803392801253, 6.087714651680015, 16.43084320892478, 24.76722511418386, -6.594389125716872]
_OF_TIME = [0.25, -0.1043, 0.1035, -0.0362, 0.0, 0.0]
_PLACES = [0.0, 0.386, 0.21, 0.63, 1.0, 1.0]
METHOD = tuple(np.array(numbers) for numbers in (_A, _C, _FIRST, _NEXT, _OF_TIME, _PLACES))
"""A and C, row after row; weights of values within a step; D; and places of the stages."""


@inlined
def _rate(aging: bool, numbers: Any, w: Any, s: Any, t: float) -> Any:
    """Derivatives of w and s."""
    a, b, D_c, k, alpha, first, pulled, mu_1, sigma, rise = numbers
    V, turn = first * np.exp(w), rise / (sigma + rise * t)
    grown = (first * np.exp(-s) - V) / D_c if aging else -V / D_c * (w + s)
    spring = k * (pulled - V) / (sigma + rise * t)
    lost = alpha / b * turn if rise != 0 else 0 * turn
    return (spring - (mu_1 + a * w + b * s - alpha) * turn - b * grown) / a, grown - lost


@inlined
def _slopes(aging: bool, numbers: Any, w: Any, s: Any, t: float) -> Any:
    """Derivatives of the two rates in w, in s and in time."""
    a, b, D_c, k, alpha, first, pulled, mu_1, sigma, rise = numbers
    V, turn = first * np.exp(w), rise / (sigma + rise * t)
    k = k / (sigma + rise * t)
    in_w = -V / D_c if aging else -V / D_c * (w + s + 1)
    in_s = -first * np.exp(-s) / D_c if aging else -V / D_c
    in_t = ((mu_1 + a * w + b * s - alpha) * turn - k * (pulled - V)) * turn / a
    lost = alpha / b * turn * turn if rise != 0 else 0 * turn
    return -(k * V + b * in_w) / a - turn, -b / a * (turn + in_s), in_t, in_w, in_s, lost


@compiled
def march(
    aging: bool, numbers: Any, places: Any, tolerance: float, most: int, method: Any, work: Any, states: Any
) -> bool:
    """States (w, s) at `places`, in order; False if it takes more than `most` steps.

    The first of `states` is that at time 0. `numbers` are a, b, D_c, k, alpha; the velocities V_1 and V_lp
    times the duration; friction at the beginning; the normal stress at time 0, and its change.
    """
    A, C, first, second, of_time, stages = method
    kw, ks = work[0], work[1]
    w, s = states[0, 0], states[0, 1]
    t, n, h = 0.0, 1, 0.0
    for _ in range(most):
        w_w, w_s, w_t, s_w, s_s, s_t = _slopes(aging, numbers, w, s, t)
        if h == 0:
            h = 0.1 / (abs(w_w.real) + abs(w_s.real) + abs(s_w.real) + abs(s_s.real) + 10.0)
        end = t + h >= 1
        if end:
            h = 1 - t
        m_ww, m_ss = 4 / h - w_w, 4 / h - s_s
        det = m_ww * m_ss - w_s * s_w
        u, v, error = w, s, 0.0
        for i in range(6):
            u, v, x, y = w, s, h * of_time[i] * w_t, h * of_time[i] * s_t
            for j in range(i):
                at = i * (i - 1) // 2 + j
                u, v = u + A[at] * kw[j], v + A[at] * ks[j]
                x, y = x + C[at] / h * kw[j], y + C[at] / h * ks[j]
            if max(u.real, -v.real) > 200:  # before an exponential overflows
                error = np.inf
                break
            at_w, at_s = _rate(aging, numbers, u, v, t + stages[i] * h)
            x, y = x + at_w, y + at_s
            kw[i], ks[i] = (m_ss * x + w_s * y) / det, (m_ww * y + s_w * x) / det
        if error == 0:
            error = max(abs(kw[5].real) / (1 + abs(w.real)), abs(ks[5].real) / (1 + abs(s.real))) / tolerance
        size = h * min(5.0, max(0.1, 0.9 / max(error, 1e-9) ** 0.25))
        if error > 1:
            h = size
            continue
        u, v = u + kw[5], v + ks[5]
        while n < places.size and (end or places[n].real <= t + h):
            x = (places[n] - t) / h
            y, z = x * (1 - x), x * x * (1 - x)
            p, q = w + x * (u - w), s + x * (v - s)
            for j in range(5):
                weight = first[j] * y + second[j] * z
                p, q = p + weight * kw[j], q + weight * ks[j]
            states[n, 0], states[n, 1] = p, q
            n += 1
        w, s, t, h = u, v, t + h, size
        if end:
            return True
    return False
