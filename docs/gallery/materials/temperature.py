r"""
What do twenty degrees more do?
===============================

Creep is activated by heat. If temperature changes nothing but the rate, all relaxation times change by
one factor,

.. math:: a_T = \exp\left[\frac{Q}{R}\left(\frac1T - \frac1{T_0}\right)\right] \quad\text{(Arrhenius)}, \qquad
          \log_{10} a_T = \frac{-c_1 (T - T_0)}{c_2 + T - T_0} \quad\text{(WLF)},

and the area at T after t is that at :math:`T_0` after :math:`t/a_T`: curves of all temperatures fall onto
one.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

heights = asp.surfaces.spectral((128, 128), hurst=0.8, roll_off=64.0, cutoff=8.0, rms_height=0.5, seed=1)
scan = asp.surfaces.Surface(heights, unit="um", pixel_size=(1.0, 1.0), length_unit="um")
series = asp.relaxation.fractional_zener(
    instantaneous=3.5e9, relaxed=0.5e9, exponent=0.3, time=1e4, first=1e-3, last=1e8
)  # Pa, s, at 23 degrees
times = np.geomspace(1.0, 1e4, 13)  # s
reference = 296.15  # K

fig, (upper, lower) = plt.subplots(2, 1, figsize=(5.4, 7.0), sharey=True, layout="constrained")
curves = {}
for celsius, marker, color in ((3, "v", "tab:blue"), (23, "o", "black"), (43, "^", "tab:red")):
    factor = asp.relaxation.arrhenius(100e3, celsius + 273.15, reference)
    warm = series.shifted(factor)
    solid = asp.solids.half_space(modulus=warm.modulus, branches=warm.branches)
    area = asp.age(asp.press(scan, solid, pressure="1 MPa"), times).dataset["contact_fraction"].values[1:]
    curves[celsius] = factor, area
    style = {"color": color, "label": f"{celsius} °C"}
    upper.semilogx(times, 100 * area, f"{marker}-", linewidth=0.8, **style)
    lower.semilogx(times / factor, 100 * area, marker, **style)
upper.set(xlabel="hold time $t$ [s]", ylabel="real contact [% of nominal area]")
lower.set(xlabel="$t / a_T$ [s]", title="shifted: one curve")
upper.legend()

# %%
# The verdict: how much sooner the same contact is reached, and another way to the same curve: a factor on
# the clock, as ``mobility`` of a leg, for a temperature that changes within a history.

factor, area = curves[43]
glass = asp.relaxation.wlf(17.44, 51.6, 43 + 273.15, reference)
print(
    f"43 °C in place of 23 °C: {1 / factor:.3g} times faster; "
    f"after 100 s {area[6] / curves[23][1][6] - 1:+.1%} of area"
)
print(f"by WLF, for a polymer with its glass transition at 23 °C, {1 / glass:.3g} times faster")

solid = asp.solids.half_space(modulus=series.modulus, branches=series.branches)
contact = asp.press(scan, solid, pressure="1 MPa")
leg = asp.protocols.Hold(times[-1], mobility=1 / factor)
clock = asp.age(contact, times, protocol=leg).dataset["contact_fraction"].values[1:]

# Origin: superposition of time and temperature is exact for this solid, whichever way it is computed.
np.testing.assert_allclose(clock, area, rtol=2e-3)
np.testing.assert_allclose(
    asp.age(contact, times / factor).dataset["contact_fraction"].values[1:], area, rtol=2e-3
)
assert 1 / factor > 5
