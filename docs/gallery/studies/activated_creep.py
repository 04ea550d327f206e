r"""
What does a contact remember whose creep is activated by stress?
================================================================

A contact is held under a load for a time :math:`t_\mathrm{w}`, and then the load falls to a part of it. On
blocks of PMMA the area fell on, and grew again, with a minimum at a time in proportion to
:math:`t_\mathrm{w}` (S. Dillavou, S. M. Rubinstein, Phys. Rev. Lett. 120, 224101, 2018). Here creep follows
Eyring's law, beside permanent springs. The force that a contact bears after a time t is about
:math:`s_0 \ln(2/t)`, so that contacts whose mean force falls from :math:`s_1` to :math:`s_2` should flow
again at

.. math:: t_\mathrm{r} = t_\mathrm{w} \exp\frac{s_1 - s_2}{s_0} .

``asperity study activated-creep`` asks the same of eight solids, and of friction after a rest.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

P = asp.protocols
rough = asp.surfaces.spectral((40, 40), hurst=0.8, roll_off=16.0, cutoff=4.0, rms_height=1.0, seed=1)
s0, load = 0.05, 0.05 * rough.size
law = asp.solids.Eyring(rate=s0 / 3.0, stress=s0)  # a creeping spring relaxes in a time of 1, if s << s0
contact = asp.press(rough, asp.solids.spring_lattice(k0=1.0, k1=3.0, R=0.0, creep=law), load=load)

# %%
# Two loads after the step, and waits over five decades. Times count from the step.

waits, times = np.array([1e-4, 1e-2, 1.0]), np.append(0.0, np.geomspace(1e-2, 1e5, 29))
resumed, expected, lowest = {}, {}, {}
fig, axes = plt.subplots(1, 2, figsize=(8.0, 3.8), sharey=True, layout="constrained")
for ax, ratio in zip(axes, (0.2, 0.8), strict=True):
    for wait, shade in zip(waits, ("0.7", "0.4", "0.0"), strict=True):
        protocol = [P.Hold(wait), P.Step(load=ratio * load), P.Hold(1.01e5 * wait)]
        dataset = asp.age(contact, wait * (1 + times[1:]), protocol=protocol, rtol=1e-2).dataset
        area, leg = dataset["area"].values, dataset["leg"].values
        held, after = area[leg == 0][-1], area[leg >= 1][: times.size]
        grown = after > 1.03 * np.minimum.accumulate(after)
        resumed[ratio, wait] = times[grown.argmax()] if grown.any() else np.inf
        expected[ratio, wait] = np.exp((load / held - ratio * load / after[0]) / s0)
        lowest[ratio, wait] = after.min() / after[0]
        label = rf"$t_\mathrm{{w}} = {wait:g}$"
        ax.semilogx(times[1:], after[1:] / after[0], "o-", color=shade, markersize=3, label=label)
    ax.set(title=f"load × {ratio:g}", xlabel=r"time since the step over $t_\mathrm{w}$")
    ax.legend(fontsize=8)
axes[0].set_ylabel("area over that after the step")

# %%
# The verdict. A light load lets the area fall, after a long wait; under a nearly full one it rests, and grows
# again at about the estimated time.

print("smallest area over that after the step:", {key: round(part, 2) for key, part in lowest.items()})
for key, time in resumed.items():
    print(f"load × {key[0]}, wait {key[1]:g}: grows at {time:.3g} waits, estimate {expected[key]:.3g}")
assert lowest[0.2, 1.0] < 0.92
assert min(lowest[0.8, wait] for wait in waits) > 0.97
# Origin: the mean forces before and after the step; heavier contacts flow earlier, lighter ones later.
found, estimate = (np.log([part[0.8, wait] for wait in waits]) for part in (resumed, expected))
np.testing.assert_allclose(found, estimate, atol=1.6)
