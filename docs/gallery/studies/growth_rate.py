r"""
What sets the growth rate B?
============================

The area of contacts that creep grows by :math:`B = \mathrm{d}(A/A(0))/\mathrm{d}\ln t` in an e-fold. While
contacts are too far apart to feel each other, :math:`A` follows from the heights and from the compliance
:math:`G(k_1/k_0,\,k_0 R t)` of one site, so that :math:`B` has a closed form without a free parameter.
``asperity study growth-rate`` measures :math:`B` on larger and more surfaces, against all parameters.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp
from asperity import theory

heights = asp.surfaces.gaussian((224, 224), seed=0)
times = np.geomspace(10.0, 1e3, 5)


def rates(load, x1=3.0, viscous=0.0):
    """B that is simulated, and B of the closed form with the same heights; the load is that of a site."""
    solid = asp.solids.spring_lattice(k0=1.0, k1=x1, R=1.0, R_viscous=viscous)
    run = asp.age(asp.press(heights, solid, load=load * heights.size), times).dataset
    compliance = theory.compliance(x1, run["time"].values, viscous)
    closed = theory.dilute_area(load, compliance, theory.EmpiricalHeights(heights))
    return [
        asp.fits.growth_rate(run["time"].values, area, *times[[0, -1]]).B for area in (run["area"], closed)
    ]


# %%
# Under a light load the closed form holds at any stiffness ratio. Under heavier loads it fails.

ratios, loads = [1.0, 3.0, 10.0], [2e-3, 1e-2, 5e-2]
by_ratio = np.array([rates(loads[0], x1) for x1 in ratios])
by_load = np.array([by_ratio[1], *(rates(load) for load in loads[1:])])
viscous = rates(loads[0], viscous=0.1)

fig, (upper, lower) = plt.subplots(2, 1, figsize=(5.4, 7.0), layout="constrained")
for ax, at, B, label in ((upper, ratios, by_ratio, r"$k_1/k_0$"), (lower, loads, by_load, "load a site")):
    ax.loglog(at, B[:, 0], "o", color="tab:blue", label="simulated")
    ax.loglog(at, B[:, 1], "-", color="black", linewidth=0.8, label="closed form")
    ax.set(xlabel=label, ylabel="$B$")
    ax.set_xticks(at, [f"{one:g}" for one in at])
    ax.tick_params(axis="x", which="minor", bottom=False, labelbottom=False)
upper.plot(3.0, viscous[0], "^", color="#D55E00", label=r"$\tilde R/R = 0.1$")
upper.plot(3.0, viscous[1], "_", color="#D55E00")
upper.legend()

# %%
# B over that of the closed form.

print("k1/k0:", dict(zip(ratios, (by_ratio[:, 0] / by_ratio[:, 1]).round(3).tolist(), strict=True)))
print("load:", dict(zip(loads, (by_load[:, 0] / by_load[:, 1]).round(3).tolist(), strict=True)))
print("R_viscous/R = 0.1:", round(viscous[0] / viscous[1], 3))

# Origin: theory.dilute_area, with the heights of the same surface; dips meet at k0 R t near (N0/A)^2.
np.testing.assert_allclose(by_ratio[:, 0], by_ratio[:, 1], rtol=0.15)
assert (np.diff(by_ratio[:, 0]) > 0).all()
assert by_load[2, 0] < 0.6 * by_load[2, 1]
assert 1.0 < viscous[0] / by_load[0, 0] < 2.0  # the slope of G is twice as large with R_viscous, in the end
