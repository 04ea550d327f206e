r"""
How does a self-affine surface age, and where does it end?
==========================================================

Rock, glass and machined metal are rough on many scales. On such a surface neighboring heights are alike,
and contacts are patches in place of single sites. The law that experiments usually fit,

.. math:: A(t) = A(0)\, [1 + C \ln(1 + t/t_0)] ,

is compared here with nine decades of growth, and with the end of it: the relaxed state, in which
:math:`k_0 \nabla^2 u = -F/N` off contact. There the springs to the bulk, of stiffness :math:`k_1`, carry
the mean load and nothing else, so that the limit does not depend on :math:`k_1`.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

rough = asp.surfaces.self_affine(256, hurst=0.5, delta=0.01, seed=0)
times = np.geomspace(1e-3, 1e6, 28)

fig, ax = plt.subplots(layout="constrained")
limits, fits = [], []
for k1, marker in ((3.0, "o"), (10.0, "s")):
    solid = asp.solids.spring_lattice(k0=1.0, k1=k1, R=1.0)
    contact = asp.press(rough, solid, load=100.0)
    area = asp.age(contact, times).dataset["area"].values[1:]
    limits.append(asp.relax(contact).area)
    fits.append(asp.fits.logarithm(times, area))
    percent = 100 / rough.size
    ax.semilogx(times, percent * fits[-1].predict(times), "-", color="0.7", linewidth=3)
    ax.semilogx(
        times,
        percent * area,
        marker,
        markersize=5,
        label=f"simulation, $k_1/k_0$ = {k1:g}",
    )
ax.plot([], [], "-", color="0.7", linewidth=3, label="logarithm, fitted")
ax.axhline(percent * limits[0], color="black", linestyle="--", linewidth=1, label="relaxed state of both")
ax.set(xlabel=r"hold time $t$ [$1/(k_0 R)$]", ylabel="real contact [% of nominal area]", ylim=(0, None))
ax.set_title("A self-affine surface: slow, fast, and slow again")
ax.legend()

# %%
# The verdict: no single logarithm describes the nine decades, which are an S.

for fit in fits:
    print(f"the logarithm misses the areas by {fit.rms_residual:.0%} rms")
print(f"relaxed: {limits[0]} and {limits[1]} sites")

# Origin: the relaxed state solves k0 Lap u = F/N off contact, in which k1 does not occur.
assert limits[0] == limits[1]
assert all(fit.rms_residual > 0.03 for fit in fits)
assert area[-1] <= limits[1]
