r"""
What does a microscope see of a contact?
========================================

A microscope blurs a contact over its point spread function, samples it on pixels, and a threshold decides
what counts as contact. ``asp.observe`` does the same to a computed contact, exactly. How much of the area
is left?
"""

import math

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

heights = asp.surfaces.spectral(
    (256, 256), hurst=0.8, roll_off=10.0, cutoff=0.8, rms_height=0.05, spacing=0.1, seed=3
)
scan = asp.surfaces.Surface(heights, unit="um", pixel_size=(0.1, 0.1), length_unit="um")
contact = asp.press(scan, asp.solids.half_space(modulus="3.8 GPa"), pressure="10 MPa")

# %%
# Pixels of 0.2 µm count as contact where at least half of their light is there.

blurs = np.array([0.05, 0.1, 0.2, 0.4, 0.8, 1.6])  # um, full width at half maximum
views = [asp.observe(contact, pixel="0.2 um", blur=f"{blur} um", threshold=0.5) for blur in blurs]
part = np.array([view.area for view in views]) / contact.contact_area

fig, grid = plt.subplot_mosaic("ab;cc", figsize=(5.4, 5.6), layout="constrained")
side = [0, 25.6, 25.6, 0]
for ax, map_, title in (
    (
        grid["a"],
        contact.in_contact,
        f"the contact:\n{asp.analysis.patches(contact.in_contact).count} patches",
    ),
    (grid["b"], views[4].seen, f"seen through {blurs[4]:g} µm:\n{views[4].patches.count} patches"),
):
    ax.imshow(map_, cmap="Blues", extent=side, interpolation="nearest")
    ax.set_title(title, fontsize=10)
    ax.set(xlabel="x [µm]")
grid["c"].semilogx(blurs, 100 * part, "o-", color="tab:blue")
grid["c"].set(xlabel="full width at half maximum [µm]", ylabel="area seen [% of the contact]", ylim=(0, 105))
print(f"through {blurs[4]:g} um, {part[4]:.0%} of the area is seen")

# %%
# Two checks. Blur moves light and loses none, so that without a threshold the area is that of the
# contact. And one bright site of side d, through a Gaussian of standard deviation s, leaves on its own
# pixel the square of erf(d / (sqrt(2) s)) - sqrt(2/pi) s/d [1 - exp(-d^2 / (2 s^2))].

light = asp.observe(contact, pixel="0.2 um", blur="0.8 um")
spot = np.zeros((33, 33))
spot[16, 16] = 1.0
seen = asp.observe(spot, blur=3.0).image[16, 16]
s = 3.0 / math.sqrt(8 * math.log(2))
expected = math.erf(1 / (math.sqrt(2) * s)) - math.sqrt(2 / math.pi) * s * (1 - math.exp(-0.5 / s**2))

# Origin: conservation of light, and the integral of a Gaussian over a pixel and a site, both of side 1.
assert math.isclose(light.area, contact.contact_area, rel_tol=1e-12)
assert math.isclose(seen, expected**2, rel_tol=1e-9)
assert (np.diff(part) < 0).all()
