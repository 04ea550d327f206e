r"""
When does a film act like its substrate?
========================================

A ball is pressed onto a film of thickness h on a base that is ten times stiffer. If the contact is small
beside h, its radius a is that of a body of the film's material; if it is large, that of a body of the
base's. In between one may quote the modulus that Hertz would need,

.. math:: E_\mathrm{eff} = \frac{3 F R}{4 a^3} .
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

radius, load, sites, pixel = 1e-3, 0.1, 192, 2e-6  # m, N
x = pixel * (np.arange(sites) - sites / 2)
ball = asp.surfaces.Surface(-(x[:, None] ** 2 + x**2) / (2 * radius), "m", (pixel, pixel), "m")
film, base = 1e9, 10e9  # contact moduli, Pa


def effective(solid):
    """Modulus that Hertz needs for this radius, and the radius."""
    contact = asp.press(ball, solid, load=load)
    a = np.sqrt(contact.contact_area_corrected / np.pi)
    return 3 * load * radius / (4 * a**3), a


thickness = np.geomspace(0.2e-6, 200e-6, 13)
modulus, a = np.transpose(
    [
        effective(
            asp.solids.coated_half_space(
                modulus=film, poisson=0.4, thickness=h, base_modulus=base, base_poisson=0.3
            )
        )
        for h in thickness
    ]
)

fig, ax = plt.subplots(layout="constrained")
ax.loglog(thickness / a, modulus / 1e9, "o-", color="tab:blue", label="computed")
ax.axhline(film / 1e9, color="0.5", linestyle="--", label="film")
ax.axhline(base / 1e9, color="0.5", linestyle=":", label="base")
ax.set(xlabel="thickness of the film over radius of the contact", ylabel="effective modulus [GPa]")
ax.set_title("A ball on a film of 1 GPa on a base of 10 GPa")
ax.set_ylim(0.8, 14)
ax.legend()

# %%
# The verdict: how thin, and how thick, for 20 %.

ratio = thickness / a
thin = ratio[modulus > 0.8 * base].max()
thick = ratio[modulus < 1.2 * film].min()
print(f"within 20 % of the base up to h = {thin:.2g} a; of the film from h = {thick:.2g} a on")

# Origin: Hertz, for a ball on a half-space of either material; the film is on neither end quite at the
# limit.
assert (np.diff(modulus) < 0).all()
assert abs(modulus[0] / base - 1) < 0.12
assert abs(modulus[-1] / film - 1) < 0.03
