r"""
Does a line contact grow like the logarithm of time?
====================================================

Where two bodies touch along a line, a rough profile takes the place of the rough surface. The dip under
one contact of a line of springs deepens as a power of time, and not as its logarithm:

.. math:: G(x_1, x_2) \to \frac{\Gamma(3/4)}{\pi}\, x_2^{1/4}, \qquad x_1 = k_1/k_0, \quad x_2 = k_0 R t .

So contacts that are far apart let the area grow as :math:`t^{1/4}`, until their dips meet. For a profile
of exponential heights with a mean of 1, theory gives :math:`A(t)/A(0) = G(x_1, x_2)/G(x_1, 0)`; for the
profile at hand, ``EmpiricalHeights`` says how many of its heights are above a plane.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.special import gamma

import asperity as asp

sites, load, k1 = 6000, 45.0, 3.0
profile = asp.surfaces.exponential((sites,), rms=1.0, seed=0)
solid = asp.solids.spring_lattice(k0=1.0, k1=k1, R=1.0)
contact = asp.press(profile, solid, load=load)

# %%
# Seven decades of the simulation, and what the theory of independent contacts says about the same
# profile.

times = np.geomspace(1e-2, 1e5, 15)
area = asp.age(contact, times).dataset["area"].values[1:]
compliance = asp.theory.compliance(k1, times, dimension=1)
heights = asp.theory.EmpiricalHeights(profile)
theory = sites * asp.theory.dilute_area(load / sites, compliance, heights)

fig, ax = plt.subplots(layout="constrained")
ax.loglog(times, theory, "-", color="0.6", linewidth=4, label="theory of independent contacts")
late = load * gamma(0.75) / np.pi * times**0.25
ax.loglog(times, late, "k:", label=r"$F\, \Gamma(3/4)\, t^{1/4} / \pi$: mean of many profiles")
ax.loglog(times, area, "o", color="tab:blue", markersize=4, label="simulation")
ax.set(xlabel=r"hold time $t$ [$1/(k_0 R)$]", ylabel="contact area [sites]")
ax.set_title("A line contact grows as a power of time, until dips meet")
ax.legend()

# %%
# The verdict. The exponent is the slope of ln A against ln t; the law of the dip has 1/4.

growth = asp.fits.growth_rate(times, area, first=10.0, last=1e3, initial=contact.area)
end = asp.fits.growth_rate(times, area, first=1e4, initial=contact.area)
print(f"exponent from t = 10 to 1000: {growth.relative:.3f}; after t = 1e4: {end.relative:.3f}")

# Origin of 1/4: the late compliance above, from the integral over all waves; of the areas: theory that
# knows no simulation.
apart = times <= 1e3
np.testing.assert_allclose(area[apart], theory[apart], rtol=0.06)
assert abs(growth.relative - 0.25) < 0.03
assert end.relative < growth.relative - 0.05
