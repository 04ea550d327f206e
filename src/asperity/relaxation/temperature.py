"""Shift factors, which multiply every relaxation time, for another temperature."""

from __future__ import annotations

import math

import scipy

from asperity.base import checks
from asperity.errors import LARGEST, InputError


def arrhenius(activation_energy: float, temperature: float, reference: float) -> float:
    """Shift factor of thermally activated relaxation, exp[(Q/R) (1/T - 1/T_ref)].

    Parameters
    ----------
    activation_energy
        Q, not below 0, J/mol.
    temperature, reference
        T and T_ref, above 0, K.

    Returns
    -------
    float
        Relaxation times at T over those at T_ref. `InputError` if it is beyond 1e100.
    """
    Q = checks.number("activation_energy", activation_energy, least=0)
    T, reference = _kelvin("temperature", temperature), _kelvin("reference", reference)
    return _power_of_e(Q / scipy.constants.R * (1 / T - 1 / reference), T)


def wlf(c1: float, c2: float, temperature: float, reference: float) -> float:
    """Shift factor of Williams, Landel and Ferry, log10 a = -c1 (T - T_ref)/(c2 + T - T_ref).

    Parameters
    ----------
    c1
        Not below 0; for the decimal logarithm.
    c2
        Above 0, K.
    temperature, reference
        T and T_ref, above 0, K; T above T_ref - c2, where relaxation would take forever.

    Result and errors are those of `arrhenius`; and T not above T_ref - c2 is refused.

    References
    ----------
    M. L. Williams, R. F. Landel, J. D. Ferry, J. Am. Chem. Soc. 77, 3701 (1955), DOI 10.1021/ja01619a008.
    """
    c1 = checks.number("c1", c1, least=0)
    c2 = checks.number("c2", c2, above=0)
    T, reference = _kelvin("temperature", temperature), _kelvin("reference", reference)
    above = c2 + (T - reference)
    if above <= 0:
        expected = f"more than reference - c2 = {reference - c2:g} K, where the law of WLF ends"
        advice = "arrhenius, which is usual below the glass transition"
        raise InputError("temperature", expected=expected, got=f"{T:g} K", advice=advice)
    return _power_of_e(-math.log(10) * c1 * (T - reference) / above, T)


def _kelvin(name: str, value: float) -> float:
    return checks.number(name, value, above=0, expected="a temperature > 0 in kelvin")


def _power_of_e(exponent: float, temperature: float) -> float:
    if abs(exponent) > math.log(LARGEST):
        what = "above 1e100 (nothing relaxes)" if exponent > 0 else "below 1e-100 (all has relaxed)"
        got = f"one {what} at {temperature:g} K"
        raise InputError("temperature", expected="a shift factor from 1e-100 to 1e100", got=got)
    return math.exp(exponent)
