"""Small rough surfaces for tests, made without Asperity's own generators."""

import numpy as np


def uncorrelated(n, seed=0):
    """Gaussian heights, rms 1, independent at each of n x n sites."""
    return np.random.default_rng(seed).normal(size=(n, n))


def correlated(n, hurst=0.5, seed=1):
    """Self-affine heights, rms 1, by filtering white noise in Fourier space."""
    q = np.hypot(np.fft.fftfreq(n)[:, None], np.fft.fftfreq(n)[None, :])
    q[0, 0] = np.inf
    noise = np.fft.fft2(np.random.default_rng(seed).normal(size=(n, n)))
    heights = np.fft.ifft2(noise * q ** -(1 + hurst)).real
    return heights / heights.std()
