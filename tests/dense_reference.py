"""Any solid on a small lattice, by dense matrices: the slow and obvious judge of creep.

Relative to the rigid body at X, with v_b = u_b - X,

    r = H (u - X) + sum_b C_b (u - X - v_b),     dv_b/dt = M_b C_b (u - X - v_b),

r = 0 off contact and u = h in contact; sum r = F, or X is given. Where nothing hangs on the rigid body (H and
C vanish at wave vector 0), F is applied evenly and X is the mean of u. In time LSODA integrates.
"""

import numpy as np
import scipy.integrate
import scipy.linalg


def matrix_of(spectrum):
    """The matrix that multiplies Fourier modes of a periodic field by a spectrum."""
    n, axes = spectrum.size, range(1, spectrum.ndim + 1)
    unit = np.fft.fftn(np.eye(n).reshape(n, *spectrum.shape), axes=axes)
    return np.fft.ifftn(spectrum * unit, axes=axes).real.reshape(n, n).T


class Dense:
    """A solid given by H, by C and M C of each branch, and whether anything hangs on the rigid body."""

    def __init__(self, heights, H, C=(), rate=(), *, hangs):
        self.heights, self.n, self.H, self.C, self.rate = heights.ravel(), heights.size, H, C, rate
        self.hangs, self.touching = hangs, np.zeros(self.n, dtype=bool)

    @classmethod
    def of_laws(cls, heights, permanent, branches, spacing):
        """Functions of the magnitude q of the wave vector and of lam(q), for each area.

        ``branches`` are pairs of stiffness C and mobility M; both are finite at q = 0.
        """
        angles = np.meshgrid(*(2 * np.pi * np.fft.fftfreq(n) for n in heights.shape), indexing="ij")
        q = np.sqrt(sum((angle / d) ** 2 for angle, d in zip(angles, spacing, strict=True)))
        lam = sum(2 - 2 * np.cos(angle) for angle in angles)
        cell = np.prod(spacing)
        stiffness = [cell * law(q, lam) * np.ones_like(q) for law in (permanent, *(c for c, _ in branches))]
        rates = [c * m(q, lam) / cell for c, (_, m) in zip(stiffness[1:], branches, strict=True)]
        H, *C = map(matrix_of, stiffness)
        return cls(heights, H, C, [*map(matrix_of, rates)], hangs=sum(c.flat[0] for c in stiffness) > 0)

    @classmethod
    def of_compliance(cls, heights, compliance, branches=()):
        """A Maxwell solid of branches (share, time): the displacement at once by forces of sites."""
        S, rest = np.linalg.inv(compliance), 1 - sum(share for share, _ in branches)
        rates = [np.eye(heights.size) / time for _, time in branches]
        return cls(heights, rest * S, [share * S for share, _ in branches], rates, hangs=True)

    def contact(self, v, load=None, position=None, known=0.0):
        """The surface u, X and r for given anchors, by guesses of the set of contacts that get better.

        An external force acts beside r; the load is the sum of both.
        """
        n, one = self.n, np.ones(self.n)
        S = self.H + sum(self.C)
        pull = sum((C @ field for C, field in zip(self.C, v, strict=True)), np.zeros(n))
        even = 0.0 if self.hangs else load / n
        if not self.touching.any():
            self.touching[np.argmax(self.heights)] = True
        seen: list[np.ndarray] = []
        while True:
            A, b = np.zeros((n + 1, n + 1)), np.zeros(n + 1)
            # Unknown: y = u - X, and X.
            A[:n, :n] = np.where(self.touching[:, None], np.eye(n), S)
            A[:n, n] = np.where(self.touching, 1.0, 0.0)
            b[:n] = np.where(self.touching, self.heights, pull - even + known)
            if position is not None:
                A[n, n], b[n] = 1.0, position
            elif self.hangs:
                A[n, :n], b[n] = one @ S, load + one @ pull
            else:
                A[n, :n] = 1.0
            found = np.linalg.solve(A, b)
            y, X = found[:n], found[n]
            r = S @ y - pull + even - known
            scale = np.abs(r).max() + np.abs(S).max() * np.ptp(self.heights)
            better = np.where(
                self.touching, r > -1e-13 * scale, y + X < self.heights - 1e-13 * np.ptp(self.heights)
            )
            if (better == self.touching).all():
                return y, X, r
            assert not any((better == old).all() for old in seen)
            seen.append(better)
            self.touching = better

    def creep(self, v, duration, load_at=None, position_at=None):
        """Anchors after a while of a prescribed load or position, functions of time since its beginning."""

        def speed(time, state):
            v = state.reshape(len(self.C), self.n)
            load = None if load_at is None else load_at(time)
            position = None if position_at is None else position_at(time)
            y, _, _ = self.contact(v, load, position)
            return np.concatenate([rate @ (y - field) for rate, field in zip(self.rate, v, strict=True)])

        found = scipy.integrate.solve_ivp(
            speed, (0.0, duration), np.ravel(v), method="LSODA", rtol=1e-8, atol=1e-10 * np.ptp(self.heights)
        )
        assert found.success
        return found.y[:, -1].reshape(len(self.C), self.n)

    def exactly(self, duration, load=None, position=None):
        """Anchors after a while, from none, while contacts stay: affine rates, by an exponential."""
        size = self.n * len(self.C)

        def speed(state):
            v = state.reshape(-1, self.n)
            y, _, _ = self.contact(v, load, position)
            return np.concatenate([rate @ (y - field) for rate, field in zip(self.rate, v, strict=True)])

        constant = speed(np.zeros(size))
        affine = np.zeros((size + 1, size + 1))
        affine[:size, :size] = 1e3 * (np.array([speed(row) for row in 1e-3 * np.eye(size)]) - constant).T
        affine[:size, size] = constant
        return scipy.linalg.expm(duration * affine)[:size, size].reshape(-1, self.n)

    def energy(self, y, v):
        """Elastic energy."""
        stretched = sum(((y - field) @ C @ (y - field) for C, field in zip(self.C, v, strict=True)), 0.0)
        return (y @ self.H @ y + stretched) / 2
