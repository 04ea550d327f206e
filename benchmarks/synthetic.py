"""The surfaces of the benchmark, each made from its size and a seed by numpy alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def white(n: int, seed: int = 0) -> NDArray[np.float64]:
    """Independent Gaussian heights, rms 1: ``default_rng(seed).normal(size=(n, n))``."""
    return np.random.default_rng(seed).normal(size=(n, n))


def self_affine(n: int, seed: int = 0, *, hurst: float = 0.8, waves: int = 8) -> NDArray[np.float64]:
    """Self-affine heights, rms 1, by spectral synthesis.

    The Fourier modes of `white` are multiplied by max(q, q_r)^-(1 + hurst): the power spectrum falls as
    q^(-2 - 2 hurst) from the roll-off q_r = 2 pi waves / n (``waves`` wavelengths fit the side) to the
    corners of the Brillouin zone, and is flat below q_r. The mode q = 0 is removed.
    """
    q = 2 * np.pi * np.hypot(np.fft.fftfreq(n)[:, None], np.fft.rfftfreq(n))
    amplitude = np.maximum(q, 2 * np.pi * waves / n) ** (-1 - hurst)
    amplitude[0, 0] = 0.0
    heights = np.fft.irfft2(amplitude * np.fft.rfft2(white(n, seed)), s=(n, n))
    return heights / heights.std()
