r"""
How long do contacts under a light load stay independent?
=========================================================

Contacts that are far apart do not feel each other. Each height :math:`\xi` above a plane at :math:`d` is
then a contact, and all share the load as in the theory of Greenwood and Williamson, with the compliance
:math:`J(t) = G(k_1/k_0, k_0 R t)/k_0` of one contact that creeps:

.. math:: N_0\, \langle (\xi - d)_+ \rangle = F J(t), \qquad A(t) = N_0\, P(\xi > d) .

The dip beside each contact widens as :math:`(k_0 R t)^{1/4}`. So in the end contacts meet, and the theory
fails. When?
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

k1, load = 3.0, 160.0
rough = asp.surfaces.gaussian((400, 400), rms=1.0, seed=0)
solid = asp.solids.spring_lattice(k0=1.0, k1=k1, R=1.0)
contact = asp.press(rough, solid, load=load)

times = np.geomspace(1e-2, 1e6, 25)
area = asp.age(contact, times).dataset["area"].values[1:]

# %%
# The theory takes any law of heights: those of this very surface, or a Gaussian law. The difference
# between the two is the scatter of a single surface.

compliance = asp.theory.compliance(k1, times)
same, gaussian = (
    rough.size * asp.theory.dilute_area(load / rough.size, compliance, law)
    for law in (asp.theory.EmpiricalHeights(rough), asp.theory.GaussianHeights(1.0))
)

fig, ax = plt.subplots(layout="constrained")
ax.semilogx(times, same, "-", color="0.65", linewidth=4, label="theory, heights of this surface")
ax.semilogx(times, gaussian, "k--", linewidth=1, label="theory, Gaussian heights")
ax.semilogx(times, area, "o", color="tab:blue", markersize=4, label="simulation")
ax.set(xlabel=r"hold time $t$ [$1/(k_0 R)$]", ylabel="contact area [sites]")
ax.set_title(f"{rough.shape[0]} × {rough.shape[1]} sites, of which {contact.area} touch at t = 0")
ax.legend()

# %%
# The verdict: the first time at which simulation and theory of this surface differ by more than 5 %. The
# estimate of the theory is an order of magnitude, from spacing and width of the dips.

deviation = np.abs(area / same - 1)
leaves = times[np.argmax(deviation > 0.05)]
horizon = asp.theory.dilute_horizon(area[-1] / rough.size)
print(
    f"at most {deviation[times <= 1e4].max():.1%} off up to t = 1e4; more than 5 % from t = {leaves:.2g} on"
)
print(f"dips as wide as the spacing of the contacts: t = {horizon:.2g}")

# Origin: the dilute theory (asperity.theory.dilute), which shares no code with the simulation.
at_once = asp.theory.dilute_area(
    load / rough.size, asp.theory.compliance(k1, 0.0), asp.theory.EmpiricalHeights(rough)
)
assert contact.area == round(rough.size * at_once)
assert deviation[times <= 1e4].max() < 0.04
assert horizon / 10 < leaves < horizon * 10
