r"""
How fast does a contact of PMMA grow?
=====================================

A site that flows by Eyring's law under its own pressure :math:`s` bears :math:`s_0` less in every e-fold of
time. If such sites bear all of the load, the area grows by :math:`B = d\ln A/d\ln t = s_0/s`, with
:math:`s_0 = kT/\Omega`. ``asperity study pmma`` measures it for four hardnesses, five temperatures and
three roughnesses; this is one surface of :math:`64 \times 64` sites.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp
from asperity_research.studies.pmma import MODULUS, PREFACTOR, PRESSURE, VOLUME, energy

heights = asp.surfaces.spectral((64, 64), spacing=0.1, hurst=0.8, roll_off=3.2, cutoff=0.8, rms_slope=0.5)
rough = asp.surfaces.Surface(heights, unit="um", pixel_size=(0.1, 0.1), length_unit="um")
times = np.geomspace(10.0, 1e4, 13)

# %%
# The energy of activation is such that the surface sinks by 1 nm/s under the hardness.

fig, ax = plt.subplots(figsize=(6.0, 4.0), layout="constrained")
for hardness, color in ((0.3e9, "black"), (0.5e9, "#0072B2")):
    law = asp.solids.Eyring.activated(
        energy=energy(hardness), volume=VOLUME, temperature="25 degC", prefactor=PREFACTOR
    )
    solid = asp.solids.half_space(modulus=MODULUS, creep=law)
    contact = asp.press(rough, solid, pressure=2 * PRESSURE)
    area = asp.age(contact, times).dataset["area"].values[1:]
    stress = 2 * PRESSURE * heights.size / area
    ax.semilogx(times, stress / 1e6, "o-", color=color, markersize=4, label=f"{hardness / 1e9:g} GPa")
    line = stress[0] - law.stress * np.log(times / times[0])
    ax.semilogx(times, line / 1e6, ":", color=color)
    growth = np.polyfit(np.log(times), np.log(area), 1)[0]
    share = growth * np.exp(np.log(stress).mean()) / law.stress
    print(f"hardness {hardness / 1e9:g} GPa: B = {growth:.3f}, {share:.2f} of s0/s")
    # Origin: B = s0/s where contacts that flow bear all of the load, which is an upper bound.
    assert 0.4 < share < 1.15  # one surface of some 300 contacts
ax.set(xlabel="time [s]", ylabel="mean contact pressure [MPa]")
ax.legend(title="hardness")

# %%
# Dotted: every contact flows. Those under smaller pressures do not yet, so the mean falls more slowly.
