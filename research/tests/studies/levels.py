"""The theorem on separable solids as a program: contact after any history of load, without space.

On nested elastic contacts the contact of a separable solid under any history of load is the elastic contact
at the load a(t); docs/studies/unloading.md has the proof. Levels l are springs of the same relaxation modulus
E(t) = 1 - sum_b s_b (1 - exp(-t/tau_b)); those below a(t) are held down, those above are free, and the forces
of those that are held sum to F(t).
"""

import numpy as np
from scipy.linalg import expm


def frontier(branches, legs, highest, levels=1000, first=1e-3, per_decade=12):
    """Times and a(t) for legs (duration, load), the first of them from time 0 on."""
    share = np.array([one for one, _ in branches])
    tau = np.array([one for _, one in branches])
    width = highest / levels
    anchors = np.zeros((levels, share.size))  # of each level, its branches
    # A free level has M = sum s_b m_b, so that it bears no force: d m_b/dt = (M - m_b)/tau_b.
    free = (share[None, :] - np.eye(share.size)) / tau[:, None]
    now, found = 0.0, []
    for duration, load in legs:
        ends = np.append(
            np.geomspace(first, duration, round(np.log10(duration / first) * per_decade)), duration
        )
        for step in np.diff(ends, prepend=0.0, append=duration):
            force = 1 - anchors @ share  # if held
            total = np.cumsum(force) * width
            count = np.searchsorted(total, load)
            over = total[count - 1] if count else 0.0
            found.append((now, (count + (load - over) / (force[count] * width)) * width))
            held = np.arange(levels) < count
            decay = np.exp(-step / tau)
            anchors = np.where(held[:, None], 1 + (anchors - 1) * decay, anchors @ expm(free * step).T)
            now += step
    return np.array(found).T
