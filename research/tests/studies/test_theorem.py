"""On a separable solid with nested contacts no contact is lost while the load does not fall.

`frontier` is the theorem as a program: contact after any history of load, without space. On nested elastic
contacts the contact of a separable solid is the elastic one at the load a(t); docs/studies/unloading.md has
the proof. Levels l are springs of the same relaxation modulus E(t) = 1 - sum_b s_b (1 - exp(-t/tau_b)); those
below a(t) are held down, those above are free, and the forces of those that are held sum to F(t).
"""

import numpy as np
import pytest
from scipy.linalg import expm

import asperity as asp

P = asp.protocols


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


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("branches", [[(0.7, 10.0)], [(0.25, 1.0), (0.25, 10.0), (0.25, 100.0)]])
def test_contact_of_a_half_line_after_a_fall_of_the_load(branches, seed):
    heights = asp.surfaces.spectral((64,), hurst=0.8, cutoff=4.0, rms_slope=1.0, seed=seed)
    high, low, wait, end = 6.0, 1.5, 20.0, 1e4
    contact = asp.press(heights, asp.solids.half_space(modulus=1.0, branches=branches), load=high)
    since = np.geomspace(1e-2, end, 13)
    history = asp.age(
        contact,
        np.union1d([1.0, wait], wait + since),
        protocol=[P.Hold(wait), P.Step(load=low), P.Hold(end)],
        rtol=5e-3,
    )
    area, leg = history.dataset["area"].values, history.dataset["leg"].values
    assert (np.diff(area[leg >= 1]) >= 0).all()  # the theorem
    # And the contact is the elastic one at the load a(t).
    times, at = frontier(branches, [(wait, high), (end, low)], highest=4.2 * high)
    expected = np.interp(wait + since, times[times >= wait], at[times >= wait])
    elastic = asp.solids.half_space(modulus=1.0)
    for load, sites in zip(expected[::3], area[leg == 2][-since.size :][::3], strict=True):
        fewest, most = (asp.press(heights, elastic, load=load * x).area for x in (0.95, 1.05))
        assert fewest <= sites <= most
