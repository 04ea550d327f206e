r"""
Does friction grow by more contact, or by better contact?
=========================================================

A contact slides, rests, and slides again. At rest its area grows, and so may its shear strength: each site
has an age, and slip renews it. How large is the part of each, and how far must the contact slide to lose it?

Three histories: the solid creeps and the strength is constant; the solid is elastic and the strength ages;
both. The first is also in the third, as ``friction_by_area``.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

P = asp.protocols
rough = asp.surfaces.spectral((64, 64), hurst=0.8, roll_off=32.0, cutoff=16.0, rms_height=1.0, seed=0)
relaxing = asp.solids.half_space(modulus=1.0, branches=[(0.06, 10.0**n) for n in range(-1, 4)])
elastic = asp.solids.half_space(modulus=1.0)
strength = asp.friction.ShearStrength(0.05, growth=0.02, after=1e-3, renewal=2.0)
protocol = [P.Slide(12.0, velocity=1.0), P.Hold(1000.0), P.Slide(16.0, velocity=1.0)]
times = 12 + np.geomspace(0.1, 1000.0, 17)


def slid(solid):
    """The history of a contact under the same load, with friction of the strength that ages."""
    contact = asp.press(rough, solid, pressure=0.02)
    return asp.age(contact, times, protocol=protocol, carried=asp.Carried(strength=strength))


both, rigid = slid(relaxing), slid(elastic)

# %%
# Friction over that at the end of the first slide, through all three legs. While the contact slides, it is
# the mean of the states after a shift and before the next one.


def legs_of(history, name):
    """Friction in each leg: at each shift, at each time of the rest, at each shift."""
    friction, leg = (history.dataset[series].values for series in (name, "leg"))
    before, rest, after = (friction[leg == n] for n in range(3))
    before, after = (
        friction[-2 * n :].reshape(n, 2).mean(axis=1) for friction, n in ((before, 12), (after, 16))
    )
    steady = before[-4:].mean()
    return before / steady, rest[-times.size :] / steady, after / steady


cases = {
    "both": (both, "friction", "tab:blue"),
    "area alone": (both, "friction_by_area", "tab:orange"),
    "strength alone": (rigid, "friction", "tab:green"),
}
ways = np.arange(12) + 1.0, times - 12, np.arange(16) + 1.0
fig, panels = plt.subplots(1, 3, figsize=(8.4, 3.4), sharey=True, layout="constrained")
peaks, ends = {}, {}
for name, (history, series, color) in cases.items():
    legs = legs_of(history, series)
    for axes, way, friction in zip(panels, ways, legs, strict=True):
        axes.plot(way, friction, ".-", color=color, label=name)
    peaks[name], ends[name] = legs[1][-1], legs[2][-1]
panels[1].set(xscale="log", xlabel="time at rest")
for axes, when in zip(panels[::2], ("first", "second"), strict=True):
    axes.set_xlabel(f"{when} slide [sites]")
panels[0].set_ylabel("friction over that before the rest")
panels[1].legend()

# %%
# The verdict.

(growth,) = (row for row in both.rows() if row.name.startswith("growth of friction"))
print(growth.name, growth.words())
for name, peak in peaks.items():
    print(
        f"{name}: {100 * (peak - 1):.0f} % higher after the rest, {100 * (ends[name] - 1):+.1f} % at the end"
    )

# Origin: at a constant area the peak is s(1000 + D/V) over s(D/V). Here sites open, too, and lose their age.
alone = (1 + strength.grown(1000 + 2)) / (1 + strength.grown(2)) - 1
assert 0.95 < (peaks["strength alone"] - 1) / alone < 1.1
assert peaks["both"] > max(peaks["area alone"], peaks["strength alone"]) > 1.05
assert all(abs(end - 1) < 0.02 for end in ends.values())
