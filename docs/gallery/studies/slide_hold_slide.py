r"""
Why is friction higher after a rest, and how soon is that forgotten?
====================================================================

A rough surface slides under a body that creeps, rests, and slides on. With a constant shear strength
(Tabor's relation) friction is in proportion to the real area of contact. While the bodies rest, the contacts
age; while they slide, old contacts give way to new ones. The law of ageing says

.. math:: \frac{\mu_\mathrm{s}(t)}{\mu} = 1 + b \ln\left(1 + \frac{V t}{D_\mathrm{c}}\right) .

``asperity study slide-hold-slide`` measures b and :math:`D_\mathrm{c}` on more surfaces.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

P = asp.protocols
heights = asp.surfaces.spectral((48, 48), hurst=0.8, roll_off=16.0, cutoff=4.0, rms_height=1.0, seed=0)
contact = asp.press(heights, asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0), load=115.0)

# %%
# Three rests, each ten times as long as the one before; areas at the end of each stay between two shifts.

rests = [1.0, 10.0, 100.0]
slide = P.Slide(10.0, velocity=1.0)
protocol = [slide, *(leg for rest in rests for leg in (P.Hold(rest), slide))]
dataset = asp.age(contact, [1.0], protocol=protocol).dataset
place, leg = dataset["displacement"].values, dataset["leg"].values
last = np.append((np.diff(place) > 0) | (np.diff(leg) > 0), True) & (place > 0)
place, leg = place[last], leg[last]
area = dataset["area"].values[last] / dataset["area"].values[last][leg == 0][-4:].mean()

fig, ax = plt.subplots(figsize=(6.0, 4.0), layout="constrained")
ax.plot(place, area, "-", color="0.6", linewidth=0.8)
ax.plot(place[leg % 2 == 0], area[leg % 2 == 0], "o", color="tab:blue", markersize=3, label="sliding")
ax.plot(place[leg % 2 == 1], area[leg % 2 == 1], "^", color="#D55E00", label="at the end of a rest")
ax.set(xlabel="slip [sites]", ylabel="friction over that of steady sliding")
ax.legend()

# %%
# The verdict.

peaks = area[leg % 2 == 1]
left = np.array([area[leg == at][-4:].mean() for at in (2, 4, 6)])
print("after rests:", peaks.round(2), "ten sites later:", left.round(2))

# Origin: friction of a law of ageing, which grows with the rest, and is that of steady sliding after it.
assert (np.diff(peaks) > 0.03).all()
np.testing.assert_allclose(left, 1.0, atol=0.1)
