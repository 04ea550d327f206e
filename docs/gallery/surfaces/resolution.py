r"""
Which lattice resolves my contact?
==================================

A contact is resolved if a finer lattice gives the same area. Here one surface, whose shortest wave is 32
µm long, is sampled with 16, 8, 4, 2 and 1 µm, and pressed with the same pressure.

Counting sites overestimates the area by a part of each pixel at the border of a contact, so its error is in
proportion to the spacing. ``contact_area_corrected`` subtracts that part, :math:`(\pi - 1 + \ln 2)/24` times
the length of the border times the spacing (V. A. Yastrebov, G. Anciaux, J.-F. Molinari, Tribol. Int. 114, 161
(2017)).
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

finest, cutoff = 1.0, 32.0  # um
heights = asp.surfaces.spectral((512, 512), hurst=0.8, roll_off=256.0, cutoff=cutoff, rms_height=1.0, seed=1)
solid = asp.solids.half_space(modulus="3.8 GPa")

steps = np.array([16, 8, 4, 2, 1])
counted, corrected = [], []
for step in steps:
    rough = asp.surfaces.Surface(heights[::step, ::step], "um", (finest * step, finest * step), "um")
    contact = asp.press(rough, solid, pressure="2 MPa")
    counted.append(contact.contact_area / contact.nominal_area)
    corrected.append(contact.contact_area_corrected / contact.nominal_area)
counted, corrected = np.array(counted), np.array(corrected)

fig, ax = plt.subplots(layout="constrained")
waves = cutoff / (finest * steps)
ax.semilogx(waves, 100 * counted, "s-", color="tab:orange", label="counted sites")
ax.semilogx(waves, 100 * corrected, "o-", color="tab:blue", label="corrected for pixels at the border")
ax.set(xlabel="sites in the shortest wavelength of the surface", ylabel="real contact [% of nominal area]")
ax.set_xticks(waves, [f"{wave:g}" for wave in waves])
ax.minorticks_off()
ax.set_ylim(0, None)
ax.set_title("The same contact on five lattices")
ax.legend()

# %%
# The verdict. Errors of a first order halve with the spacing, so that 2 A(h) - A(2 h) is free of them: a
# second way to the area of an infinitely fine lattice.

extrapolated = 2 * counted[-1] - counted[-2]
for wave, many, few in zip(waves, counted, corrected, strict=True):
    print(
        f"{wave:3g} sites in a wave: counted {many / extrapolated - 1:+.1%}, "
        f"corrected {few / extrapolated - 1:+.1%}"
    )
order = np.polyfit(np.log(steps), np.log(counted - extrapolated), 1)[0]
print(f"order of the counted area: {order:.2f}")

# Origin: the extrapolation, which does not correct pixels.
assert abs(corrected[-1] / extrapolated - 1) < 0.015
assert np.abs(corrected / extrapolated - 1)[waves >= 8].max() < 0.03
assert 0.8 < order < 1.3
