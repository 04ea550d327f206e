r"""
Does a contact remember how long it was held?
=============================================

A contact is held at one displacement for a time :math:`t_\mathrm{w}`, and then the bodies are brought apart
by a little. The force rises, and later falls: Y. Lahini et al. (Phys. Rev. Lett. 118, 085501, 2017) saw that
on crumpled sheets and foams, with the greatest force at a time in proportion to :math:`t_\mathrm{w}`. If all
contacts stay, the forces after both displacements add up,

.. math:: \frac{F(t)}{F_0} = \frac{E(t + t_\mathrm{w})}{E(0)} - \frac{F_1}{F_0} \frac{E(t)}{E(0)} .

Here :math:`E(t)` falls like :math:`\ln t`. ``asperity study release`` asks the same of six solids.
"""

import math

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

P = asp.protocols
heights = asp.surfaces.spectral((16, 16), hurst=0.8, roll_off=8.0, cutoff=4.0, rms_height=1.0, seed=3)
series = asp.relaxation.PronySeries(1.0, tuple((0.07, time) for time in np.geomspace(1e-3, 1e5, 9)))
solid = asp.solids.half_space(modulus=1.0, branches=series.branches, apparatus=math.inf)
contact = asp.press(heights, solid, separation=0.5)

# %%
# Three waiting times, and one release. Times count from the release.

waits, times = np.array([1.0, 10.0, 100.0]), np.geomspace(0.02, 20.0, 25)
fig, ax = plt.subplots(figsize=(6.0, 4.0), layout="constrained")
latest, linear = [], []
for wait in waits:
    protocol = [P.Hold(wait), P.Step(approach=-0.2), P.Hold(20 * wait)]
    dataset = asp.age(contact, wait * (1 + times), protocol=protocol).dataset
    force, leg = dataset["load"].values / contact.load, dataset["leg"].values
    after = force[leg == 2]
    fall = force[leg == 0][-1] - force[leg == 1][-1]
    added = series.modulus_at(wait * (1 + times)) - fall * series.modulus_at(wait * times)
    latest.append(wait * times[after.argmax()])
    linear.append(wait * times[added.argmax()])
    ax.semilogx(wait * times, after, "o-", color="tab:blue", markersize=3, linewidth=0.8)
    ax.semilogx(wait * times, added, ":", color="0.5")
    ax.plot(latest[-1], after.max(), "o", color="#D55E00", markersize=8)
ax.set(xlabel="time since the release", ylabel="force over first force")

# %%
# The verdict: the time of the maximum, in waiting times.

print("time of the maximum / waiting time:", latest / waits, "superposition:", linear / waits)

# Origin: superposition for fixed contacts; the times are a third of an e-fold apart.
slope = np.polyfit(np.log(waits), np.log(latest), 1)[0]
assert abs(slope - 1) < 0.1
np.testing.assert_allclose(latest, linear, rtol=0.4)
