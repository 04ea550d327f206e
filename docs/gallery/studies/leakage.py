r"""
When does a seal that relaxes stop leaking?
===========================================

A fluid passes through the gap of a rough contact as long as open sites join the two sides. Under a constant
load a polymer seal creeps, its contacts grow, and the last channel closes when they percolate: on isotropic
roughness at 0.42 of the nominal area (W. B. Dapp, A. Lücke, B. N. J. Persson, M. H. Müser, Phys. Rev. Lett.
108, 244301 (2012); 0.415 in arXiv:2010.13470). Between contacts, which are impermeable, Reynolds' equation
:math:`\nabla \cdot (g^3 \nabla p) = 0` is solved on the gap :math:`g`, by finite volumes and a sparse solver;
the other two sides are walls. On this pad the flow is that of reynoldsflow 0.1.3 to eleven digits; the script
does without that package, which needs two more.
"""

import matplotlib.pyplot as plt
import numpy as np
import scipy.ndimage
import scipy.sparse
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

gigapascal, water = 1e9, 1e-3
rough = 1e-6 * asp.surfaces.spectral((128, 128), hurst=0.8, roll_off=32.0, cutoff=4.0, rms_slope=0.1, seed=3)
pad = asp.surfaces.Surface(rough, "m", (1e-6, 1e-6), "m")
rubber = asp.solids.half_space(modulus=gigapascal, branches=[(0.1, 10.0**n) for n in range(9)])
start = asp.press(pad, rubber, pressure=0.0075 * gigapascal)
times = np.geomspace(1.0, 1e9, 28)
history = asp.age(start, times, fields_at=times).dataset
gaps = (history["u"] - history["heights"]).values
leaks = np.array([flow(gap) for gap in gaps]) / (12 * water)  # m^3/s for each pascal
covered = np.array([(gap <= 0).mean() for gap in gaps])

# %%
# At which area does the last channel close? Thirty-two surfaces, each pressed until nothing joins its sides.


def closing_area(seed):
    """Share of the nominal area in contact when the last channel closes, by bisection of the load."""
    made = asp.surfaces.spectral((128, 128), hurst=0.8, roll_off=32.0, cutoff=4.0, rms_slope=0.1, seed=seed)
    low, high = 0.005, 0.06
    for _ in range(7):
        middle = (low + high) / 2
        contact = asp.press(made, asp.solids.half_space(modulus=1.0), load=middle * made.size)
        low, high = (middle, high) if joined(contact.gap).any() else (low, middle)
    return contact.contact_fraction


closing = np.array([closing_area(seed) for seed in range(32)])
middle, error = closing.mean(), closing.std(ddof=1) / np.sqrt(closing.size)

fig, (left, right) = plt.subplots(1, 2, figsize=(9.4, 3.9), layout="constrained")
left.loglog(times[leaks > 0], 1e15 * leaks[leaks > 0], "o-")
closed = times[leaks == 0]
if closed.size:
    left.axvline(closed[0], color="0.4", linestyle=":", label=f"closed at {closed[0]:.1g} s")
    left.legend()
left.set(xlabel="time [s]", ylabel="leakage of water [µm³/s/mPa]", title="A seal that relaxes")
right.hist(closing, bins=12, color="C0")
right.axvline(0.415, color="C3", label="0.415, arXiv:2010.13470")
right.set(xlabel="share in contact when the last channel closes", ylabel="surfaces of 32")
right.set_title(f"{middle:.3f} ± {error:.3f}")
right.legend()

# %%
# The verdict.

print(f"leakage {leaks[0]:.2g} m^3/s/Pa after 1 s at {covered[0]:.0%} contact; closed after {closed[:1]} s")
print(f"the last channel closes at {middle:.3f} ± {error:.3f} of the nominal area")

# Origin: parallel plates, Q = g^3 W / (12 viscosity L) for each pascal; percolation by arXiv:2010.13470.
assert abs(flow(np.full((10, 20), 3.0)) - 27 * 10 / 20) < 1e-9
assert abs(middle - 0.415) < 0.03
assert (np.diff(leaks) <= 0).all()
