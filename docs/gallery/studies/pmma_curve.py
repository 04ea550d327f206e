r"""
What do four areas of a measured contact determine?
===================================================

S. Dillavou and S. M. Rubinstein imaged the contact of two pieces of PMMA under a load that was put on within
2.4 s and held (Phys. Rev. Lett. 120, 224101 (2018)). From four areas, read from the pixels of a figure, one
can ask which relaxation they determine, and whether that of another PMMA (W. W. Chen et al., J. Tribol. 133,
041404 (2011)) is among those that they allow.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

time = np.array([2.4, 10.0, 100.0, 1000.0])  # s
area = np.array([2.32, 2.58, 2.90, 3.20])  # mm²
error = 0.007
power = asp.infer(time, area, error, model="power", ramp=2.4)
single = asp.infer(time, area, error, model="relaxation", branches=1, ramp=2.4)
print(*power.sentences, *power.remarks, *single.remarks, sep="\n")

# %%
# The published relaxation, of two times, with the size that fits best. Its curve is the effective load.

published = asp.relaxation.PronySeries(1.0, ((0.10226, 8.93), (0.105828, 117.96)))
at = np.geomspace(2.4, 1000.0, 100)
knots = np.concatenate([[0.0, 2.4], at])
load = published.effective_load(knots, np.minimum(knots / 2.4, 1.0))[2:]
shape = np.interp(np.log(time), np.log(at), load)
size = area @ shape / (shape @ shape)
missed = np.sum((area - size * shape) ** 2) / error**2

fig, ax = plt.subplots(figsize=(6.8, 4.2), layout="constrained")
for found, color, label in ((power, "C0", "power law"), (single, "C1", "one relaxation time")):
    low, middle, high = found.predicted(at)
    ax.fill_between(at, low, high, color=color, alpha=0.3)
    ax.plot(at, middle, color=color, label=rf"{label}, $\chi^2$ = {found.chi_squared:.0f}")
ax.plot(at, size * load, "k--", label=rf"published, two times, $\chi^2$ = {missed:.0f}")
ax.errorbar(time, area, error, fmt="ks", markerfacecolor="white", label="measured")
ax.set(xscale="log", xlabel="time since the loading began [s]", ylabel="area [mm²]")
ax.legend()

# %%
# The verdict. Four areas bound the exponent of a power law and its time from above: a smaller exponent with a
# much smaller time is as good. They tell nothing of modulus or roughness. One relaxation time is excluded,
# and so is the published relaxation.

exponent = power.verdicts["exponent"]
print(f"exponent below {exponent.high:.3f}, time below {power.verdicts['time'].high:.2g} s")

# Origin: ln(3.20/2.58)/ln(100) = 0.047 is the slope from 10 to 1000 s, which the exponent, of an area with an
# elastic part, cannot be below.
assert exponent.verdict == power.verdicts["time"].verdict == "bounded above"
assert 0.047 < exponent.high < 0.08
assert power.verdicts["modulus"].verdict == "not identified"
assert power.chi_squared < 20 < 300 < single.chi_squared < missed
