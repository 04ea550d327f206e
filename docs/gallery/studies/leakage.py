r"""
When does a seal that relaxes stop leaking?
===========================================

A fluid passes through the gap of a rough contact as long as open sites join the two sides. Under a constant
load a polymer seal creeps, its contacts grow, and the last channel closes when they percolate. Between the
contacts, which are impermeable, Reynolds' equation
:math:`\nabla \cdot (g^3 \nabla p) = 0` is solved on the gap :math:`g`, by finite volumes and a sparse solver;
the other two sides are walls. On this pad the flow is that of reynoldsflow 0.1.3 to eleven digits; the script
does without that package, which needs two more.
"""

import matplotlib.pyplot as plt
import numpy as np
import scipy.ndimage
import scipy.sparse.linalg

import asperity as asp


def joined(gap):
    """Open sites that join the left side to the right one."""
    labels, _ = scipy.ndimage.label(gap > 0)
    through = np.intersect1d(labels[:, 0], labels[:, -1])
    return np.isin(labels, through[through > 0])


def flow(gap):
    """Flow from left to right by a pressure drop of 1, times 12 viscosities; pixels are squares."""
    wet = joined(gap)
    if not wet.any():
        return 0.0
    number, cubes, count = np.cumsum(wet).reshape(gap.shape) - 1, gap**3, int(wet.sum())
    matrix = scipy.sparse.csc_array((count, count))
    for here, there in ((np.s_[:-1, :], np.s_[1:, :]), (np.s_[:, :-1], np.s_[:, 1:])):
        both = wet[here] & wet[there]
        a, b = cubes[here][both], cubes[there][both]
        i, j, k = number[here][both], number[there][both], 2 * a * b / (a + b)
        ends = np.r_[i, j, i, j], np.r_[i, j, j, i]
        matrix += scipy.sparse.coo_array((np.r_[k, k, -k, -k], ends), shape=(count, count)).tocsc()
    into, out = np.zeros(count), np.zeros(count)  # half a pixel from either side
    for sides, column in ((into, 0), (out, -1)):
        open_ = wet[:, column]
        sides[number[open_, column]] = 2 * cubes[open_, column]
    pressure = scipy.sparse.linalg.spsolve(matrix + scipy.sparse.diags_array(into + out).tocsc(), into)
    return float(out @ pressure)


# %%
# A pad of 128 µm that relaxes over nine decades of time, and the flow through it in an hour, a day and years.


rough = asp.surfaces.spectral((128, 128), roll_off=32.0, cutoff=4.0, rms_slope=0.1, seed=3)
pad = asp.surfaces.Surface(1e-6 * rough, "m", (1e-6, 1e-6), "m")
rubber = asp.solids.half_space(modulus="1 GPa", branches=[(0.1, 10.0**n) for n in range(9)])
start = asp.press(pad, rubber, pressure="7.5 MPa")
times = np.geomspace(1.0, 1e9, 28)
history = asp.age(start, times, fields_at=times).dataset
gaps = (history["u"] - history["heights"]).values
leaks = np.array([flow(gap) for gap in gaps]) / (12 * 1e-3)  # of water, m^3/s for each pascal

closed = times[leaks == 0][0]
fig, axes = plt.subplots(figsize=(6.4, 4.0), layout="constrained")
axes.loglog(times[leaks > 0], 1e15 * leaks[leaks > 0], "o-")
axes.axvline(closed, color="0.4", linestyle=":")
axes.set(xlabel="time [s]", ylabel="leakage of water [µm³/s/mPa]", title=f"closed after {closed:.1g} s")

# %%
# The verdict.

print(f"leakage {leaks[0]:.2g} m^3/s/Pa after 1 s, closed after {closed:.2g} s")

# Origin: parallel plates, Q = g^3 W / (12 viscosity L) for each pascal.
assert abs(flow(np.full((10, 20), 3.0)) - 27 * 10 / 20) < 1e-9
assert (np.diff(leaks) <= 0).all()
