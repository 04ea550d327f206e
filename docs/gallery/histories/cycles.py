r"""
Does a cycling load age a contact faster than a constant one?
=============================================================

Vibrations, tides and machines load contacts in cycles. Here the load goes up and down by a half around
its mean, eight times, and the area is compared with contacts that were held at the mean, or at the
maximum, all the time.

Contacts are few and far apart here, so that a theory follows the same cycles: a population of independent
contacts that form, creep and open again, each with its own past (``theory.dilute_history``).
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

P = asp.protocols
rough = asp.surfaces.gaussian((256, 256), rms=1.0, seed=0)
k1, mean, swing, period, cycles = 3.0, 130.0, 0.5, 20.0, 8
solid = asp.solids.spring_lattice(k0=1.0, k1=k1, R=1.0)
low, high = mean * (1 - swing), mean * (1 + swing)

protocol = P.Repeat([P.Ramp(period / 2, load=high), P.Ramp(period / 2, load=low)], count=cycles)
times = period / 8 * np.arange(1, 8 * cycles + 1)
cycled = asp.age(asp.press(rough, solid, load=low), times, protocol=protocol).dataset
held = {load: asp.age(asp.press(rough, solid, load=load), times).dataset["area"] for load in (mean, high)}
theory = rough.size * asp.theory.dilute_history(
    cycled["time"], cycled["load"] / rough.size, k0=1.0, x1=k1, heights=asp.theory.EmpiricalHeights(rough)
)

fig, ax = plt.subplots(layout="constrained")
ax.plot(cycled["time"], theory, "-", color="0.7", linewidth=4, label="theory of independent contacts")
ax.plot(cycled["time"], cycled["area"], ".-", color="tab:blue", linewidth=0.8, label="load in cycles")
for (load, area), line in zip(held.items(), ("--", ":"), strict=True):
    ax.plot(area["time"], area, line, color="black", label=f"load {load:g} held")
ax.set(xlabel=r"time [$1/(k_0 R)$]", ylabel="contact area [sites]", ylim=(0, None))
ax.set_title(f"Load between {low:g} and {high:g}")
ax.legend(ncols=2, loc="lower center")

# %%
# The verdict, at the last maximum, and at the last passage of the mean on the way down.

area = cycled["area"].values
peak, passage = area[-5], area[-3]
print(f"at the maximum {peak} sites, {int(held[high][-5])} where it was held")
print(f"at the mean {passage} sites, {int(held[mean][-3])} where it was held")

# Origin: the theory of a population of contacts, which shares no code with the simulation.
np.testing.assert_allclose(area, theory, rtol=0.06)
assert peak < held[high][-5]
assert passage < held[mean][-3]
assert area[-1] > area[0]  # the same load, older
