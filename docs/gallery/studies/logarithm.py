r"""
Which relaxation gives a logarithm?
===================================

The area of a rough contact often grows like :math:`\ln t`, by about 1 % in each e-fold. On a half-space with
a creep compliance :math:`J(t)` the contact under a constant load :math:`F` is the elastic one under
:math:`J(t)\,F`, so that the area grows like :math:`\ln t` if :math:`J` does. ``asperity study logarithm``
measures how straight the growth is, and by how much.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

heights = asp.surfaces.spectral((64, 64), hurst=0.8, roll_off=32.0, cutoff=4.0, rms_slope=0.2, seed=1)
load = 0.02 * heights.size
decades = 10.0 ** np.arange(9)
spectra = {
    "one time": asp.relaxation.PronySeries(1.0, ((0.2, 30.0),)),
    "0.03 of compliance a decade": asp.relaxation.from_retardation(1.0, [(0.03, time) for time in decades]),
    "0.05 of modulus a decade": asp.relaxation.PronySeries(1.0, tuple((0.05, time) for time in decades)),
}

# %%
# Points are creeping contacts, lines elastic contacts under :math:`J(t)\,F`.

times = np.geomspace(1.0, 1e7, 8)
fig, ax = plt.subplots(figsize=(6.0, 4.0), layout="constrained")
elastic = asp.solids.half_space(modulus=1.0)
at_first = asp.press(heights, elastic, load=load).area
slopes = {}
for (name, series), color in zip(spectra.items(), ("#56B4E9", "black", "#0072B2"), strict=True):
    solid = asp.solids.half_space(modulus=1.0, branches=series.branches)
    creeping = asp.age(asp.press(heights, solid, load=load), times).dataset["area"].values[1:] / at_first
    pressed = [
        asp.press(heights, elastic, load=load * J).area / at_first for J in series.compliance_at(times)
    ]
    ax.semilogx(times, creeping, "o", color=color, markersize=4, label=name)
    ax.semilogx(times, pressed, "-", color=color, linewidth=0.8)
    slopes[name] = np.polyfit(np.log(times[2:]), creeping[2:], 1)[0]
    # Origin: E. H. Lee and J. R. M. Radok, J. Appl. Mech. 27, 438 (1960); three sites may be on the edge.
    np.testing.assert_allclose(creeping, pressed, atol=3 / at_first)
ax.set(xlabel="time", ylabel="area over first area")
ax.legend()

# %%
# Growth in each e-fold: 0.03 of the compliance in each decade gives about 0.01.

print({name: round(float(slope), 4) for name, slope in slopes.items()})
assert 0.008 < slopes["0.03 of compliance a decade"] < 0.03 / np.log(10)
assert abs(slopes["one time"]) < 0.005
