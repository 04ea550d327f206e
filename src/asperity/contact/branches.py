"""Sums over the branches of a creeping solid in Fourier modes, compiled: numpy takes a pass for each term."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from asperity.contact.compiled import compiled
from asperity.lattice import Modes, Spectrum


def weighted_sum(weights: Spectrum, modes: Modes) -> Modes:
    """Sum over the branches of spectra times modes."""
    total = np.zeros(modes.shape[1:], modes.dtype)
    add_weighted(_flat(weights), _flat(modes), total.reshape(-1))
    return total


def weighted_power(weights: Spectrum, modes: Modes) -> Spectrum:
    """Sum over the branches of spectra times squared magnitudes of modes."""
    total = np.zeros(modes.shape[1:])
    add_power(_flat(weights), _flat(modes), total.reshape(-1))
    return total


def damp_difference(damping: Spectrum, u: Modes, modes: Modes) -> None:
    """Put D_b (u - u_b) in the place of u_b."""
    assert modes.flags.c_contiguous  # or a copy would be written to
    subtract_and_damp(_flat(damping), u.reshape(-1), _flat(modes))


def add_creep(modes: Modes, number: float, duration: float, rate: Spectrum, stretch: Modes) -> None:
    """Add w_b to modes in place, a number of times, and what creeps at its rate in a time."""
    assert modes.flags.c_contiguous  # or a copy would be added to
    add_crept(_flat(modes), number, duration, _flat(rate), _flat(stretch))


def _flat(fields: Any) -> Any:
    """Fields of the branches as rows."""
    return np.ascontiguousarray(fields).reshape(len(fields), math.prod(fields.shape[1:]))


@compiled
def add_weighted(weights: Any, modes: Any, total: Any) -> None:
    """Add spectra times modes of all branches to those of one."""
    for b in range(len(modes)):
        for q in range(len(total)):
            total[q] += weights[b, q] * modes[b, q]


@compiled
def add_power(weights: Any, modes: Any, total: Any) -> None:
    """Add spectra times squared magnitudes of all branches to those of one."""
    for b in range(len(modes)):
        for q in range(len(total)):
            total[q] += weights[b, q] * (modes[b, q].real ** 2 + modes[b, q].imag ** 2)


@compiled
def subtract_and_damp(damping: Any, u: Any, modes: Any) -> None:
    """Write D_b (u - u_b) to where u_b is."""
    for b in range(len(modes)):
        for q in range(len(u)):
            modes[b, q] = damping[b, q] * (u[q] - modes[b, q])


@compiled
def add_crept(modes: Any, number: float, duration: float, rate: Any, stretch: Any) -> None:
    """Add (number + duration * rate) w_b to modes."""
    branches, waves = modes.shape
    for b in range(branches):
        for q in range(waves):
            modes[b, q] += (number + duration * rate[b, q]) * stretch[b, q]
