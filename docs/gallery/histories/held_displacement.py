r"""
What happens when the displacement is held in place of the load?
================================================================

A bolt, a seal or a stiff test rig holds the bodies and not the force. The load then relaxes. On a
viscoelastic half-space whose stiffness relaxes alike at every wavelength, the surface stays where it is,
so that all forces fall with the relaxation modulus,

.. math:: \frac{F(t)}{F(0)} = \frac{E(t)}{E(0)}, \qquad A(t) = A(0) .

``apparatus`` is the stiffness of the rig: infinite, or finite as a real one is.
"""

import math

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

heights = asp.surfaces.spectral((96, 96), hurst=0.8, roll_off=64.0, cutoff=8.0, rms_height=0.5, seed=1)
scan = asp.surfaces.Surface(heights, unit="um", pixel_size=(1.0, 1.0), length_unit="um")
series = asp.relaxation.fractional_zener(
    instantaneous=3.5e9, relaxed=0.5e9, exponent=0.4, time=10.0, first=1e-3, last=1e6
)
times = np.geomspace(1e-2, 1e5, 8)

# %%
# Three rigs: one that is infinitely stiff, one about as stiff as the contact, and a dead weight.

stiffness = asp.press(scan, asp.solids.half_space(modulus=series.modulus), pressure="1 MPa").normal_stiffness
rigs = {"infinitely stiff rig": math.inf, "rig as stiff as the contact": stiffness, "dead weight": None}

fig, (upper, lower) = plt.subplots(2, 1, figsize=(5.4, 7.0), layout="constrained")
upper.semilogx(
    times, series.modulus_at(times) / series.modulus, "-", color="0.7", linewidth=5, label="$E(t)/E(0)$"
)
found = {}
for (name, apparatus), marker in zip(rigs.items(), "os^", strict=True):
    solid = asp.solids.half_space(modulus=series.modulus, branches=series.branches, apparatus=apparatus)
    contact = asp.press(scan, solid, pressure="1 MPa")
    history = asp.age(contact, times, hold="load" if apparatus is None else "separation").dataset
    found[name] = history["load"].values[1:] / contact.load, history["area"].values[1:] / contact.area
    for ax, values in zip((upper, lower), found[name], strict=True):
        ax.semilogx(times, values, f"{marker}-", linewidth=0.7, label=name)
upper.set(xlabel="hold time [s]", ylabel="load over instantaneous load", ylim=(0, 1.05))
lower.set(xlabel="hold time [s]", ylabel="area over instantaneous area")
lower.legend(loc="upper left", fontsize=9)
upper.legend(*(entries[:1] for entries in upper.get_legend_handles_labels()), loc="lower left")

# %%
# The verdict.

load, area = found["infinitely stiff rig"]
print(
    f"infinitely stiff: load falls to {load[-1]:.1%}, "
    f"E(t) to {series.modulus_at(times[-1]) / series.modulus:.1%}; "
    f"area {area.min():.2f} to {area.max():.2f}"
)

# Origin: correspondence principle; with the displacement given, only forces change (Lee and Radok 1960).
np.testing.assert_allclose(load, series.modulus_at(times) / series.modulus, rtol=2e-3)
np.testing.assert_array_equal(area, 1.0)
stiff, soft = (found[name][1][-1] for name in list(rigs)[1:])
assert 1 < stiff < soft
