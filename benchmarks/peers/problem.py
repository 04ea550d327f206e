"""What every solver is given and what it hands back; needs nothing but numpy.

One problem: find the surface u of an elastic solid that a load presses onto rigid heights,

    r = S u + load / sites,      0 <= r   perpendicular to   u - heights >= 0,      sum of r = load,

where S multiplies each Fourier mode by the stiffness of the `Law` and vanishes at wave vector 0, so u is
known up to a constant until it touches. Stiffness, length and force are in units of k0 (or of the contact
modulus) and of the spacing of the sites; or, where the spacing is given, in SI.
"""

from __future__ import annotations

import math
import os
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

Field = NDArray[np.float64]
Mask = NDArray[np.bool_]
THREADS = int(os.environ.get("OMP_NUM_THREADS", "1"))


@dataclass(frozen=True)
class Law:
    """How stiff the surface is against a wave.

    ``kind`` is "lattice" (k0 lam + k1), "relaxed" (k0 lam: the same lattice after infinite time),
    "step" (k0 lam + k1 / (1 + tau k1 R lam): an implicit step of its creep),
    "half-space" (modulus |q| / 2) or "free half-space", whose rough body ends at its edges: it has no modes.
    ``branches`` of a half-space are the shares of the modulus that relax, and the relaxation times.
    """

    kind: str
    k0: float = 1.0
    k1: float = 0.0
    R: float = 1.0
    tau: float = 0.0
    modulus: float = 1.0
    branches: Sequence[tuple[float, float]] = ()


@dataclass(frozen=True, eq=False)
class Problem:
    """One contact problem; ``start`` are contact forces to start from, ``separation`` what the load leads to.

    A solver that only knows separation control is told the answer's ``separation`` and is thereby spared the
    search for it. With ``spacing``, of the sites along each axis in m, all is in SI; without, it
    is 1.
    """

    heights: Field
    law: Law
    load: float
    start: Field | None = None
    separation: float | None = None
    spacing: tuple[float, ...] = ()

    @property
    def sizes(self) -> list[float]:
        """Length of the lattice along each axis."""
        shape = self.heights.shape
        return [n * d for n, d in zip(shape, self.spacing or (1.0,) * len(shape), strict=True)]

    @property
    def cell(self) -> float:
        """Area of a site."""
        return math.prod(self.spacing)

    @property
    def mean_force(self) -> float:
        """Load per site."""
        return self.load / self.heights.size

    def stiffness(self) -> Field:
        """S on the half spectrum of `numpy.fft.rfft2`; zero at wave vector 0."""
        n, m = self.heights.shape
        qx, qy = 2 * np.pi * np.fft.fftfreq(n)[:, None], 2 * np.pi * np.fft.rfftfreq(m)
        law = self.law
        lam = 4 * np.sin(qx / 2) ** 2 + 4 * np.sin(qy / 2) ** 2
        if law.kind == "half-space":
            dx, dy = self.spacing or (1.0, 1.0)
            values = law.modulus * np.hypot(qx / dx, qy / dy) / 2 * self.cell
        elif law.kind == "relaxed":
            values = law.k0 * lam
        else:
            tau = law.tau if law.kind == "step" else 0.0
            values = law.k0 * lam + law.k1 / (1 + tau * law.k1 * law.R * lam)
        values[0, 0] = 0.0
        assert law.kind != "free half-space", "its modes have no stiffness of their own"
        return values

    def compliance(self) -> Field:
        """1 / S, and 0 at wave vector 0."""
        stiffness = self.stiffness()
        return np.divide(1.0, stiffness, out=np.zeros_like(stiffness), where=stiffness > 0)

    def small_gap(self) -> float:
        """Length that moves the contact force by about its mean: tolerances on gaps scale with it."""
        return self.mean_force / 0.05 / float(self.stiffness().max())


@dataclass(frozen=True)
class Answer:
    """A surface (up to a constant), the sites it touches, and what it took; some tell the forces too."""

    u: Field
    in_contact: Mask
    iterations: int
    watch: Watch
    note: dict[str, float | str] = field(default_factory=dict)
    force: Field | None = None


class Watch:
    """Wall-clock and processor time spent in a ``with`` block."""

    def __enter__(self) -> Watch:
        self._cpu, self._wall = time.process_time(), time.perf_counter()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.seconds = time.perf_counter() - self._wall
        self.cpu_seconds = time.process_time() - self._cpu


def convolution(problem: Problem):
    """Return displacement of forces, ``field -> field``, by pyFFTW where there is one, else by scipy.fft."""
    compliance, shape = problem.compliance(), problem.heights.shape
    try:
        import pyfftw
    except ImportError:
        import scipy.fft

        def apply(force):
            modes = scipy.fft.rfft2(force, workers=THREADS)
            modes *= compliance
            return scipy.fft.irfft2(modes, s=shape, workers=THREADS, overwrite_x=True)

        return apply
    real = pyfftw.empty_aligned(shape, "float64")
    modes = pyfftw.empty_aligned(compliance.shape, "complex128")
    forward = pyfftw.FFTW(real, modes, axes=(0, 1), threads=THREADS, flags=("FFTW_MEASURE",))
    back = pyfftw.FFTW(
        modes, real, axes=(0, 1), direction="FFTW_BACKWARD", threads=THREADS, flags=("FFTW_MEASURE",)
    )

    def apply_fftw(force):
        real[...] = force
        forward()
        np.multiply(modes, compliance, out=modes)
        return back().copy()

    return apply_fftw
