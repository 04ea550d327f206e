r"""
Does a contact that sticks come off the way it went on?
=======================================================

A soft, rough body that sticks jumps into contact as it approaches, patch by patch. It jumps out of it later,
as it retreats. Each jump loses energy, so the curve of load against separation is a loop. The area of the
loop is the work that one cycle costs.

``asp.pull`` pulls a contact apart at once, to the last patch, and lets the bodies approach again.
"""

import math

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

x = 2 * np.pi * np.arange(48) / 48
rough = 1.5 * np.cos(2 * x)[:, None] * np.cos(2 * x) + 0.9 * np.sin(x)[:, None] * np.cos(x + 1)
law = asp.solids.Dugdale(work=0.02, range=0.4)
solid = asp.solids.half_space(modulus=1.0, adhesion=law, apparatus=math.inf)
contact = asp.press(rough, solid, separation=1.3)
pulled = asp.pull(contact, steps=15)
curve, back = pulled.curve, pulled.curve["retreat"].values

fig, (ax, area) = plt.subplots(2, 1, figsize=(6, 5.5), layout="constrained", sharex=True)
for which, color, label in ((~back, "#0072B2", "approach"), (back, "#D55E00", "retreat")):
    ax.plot(curve["separation"][which], curve["load"][which], ".-", color=color, label=label)
    area.plot(curve["separation"][which], 100 * curve["contact_fraction"][which], ".-", color=color)
ax.axhline(0, color="#8C8C8C", lw=0.8)
ax.set(ylabel="load", title=f"pull-off force {pulled.force:.2f}, energy lost {pulled.energy_lost:.3f}")
ax.legend(frameon=False)
area.set(xlabel="separation", ylabel="contact [% of nominal]")

# %%
# The verdict.

load, approach, energy = (curve[name].values for name in ("load", "approach", "energy"))
work = (load[1:] + load[:-1]) / 2 * np.diff(approach)
lost = work - np.diff(energy)
print(f"one cycle costs {pulled.energy_lost:.3f}; no step of it gains more than {max(0.0, -lost.min()):.1e}")

# Origin: the balance of energy; no step gains any, but for the error of trapezoids.
assert abs(lost.sum() - pulled.energy_lost) < 1e-6
assert lost.min() > -0.03 * pulled.energy_lost
assert pulled.energy_lost > 0
