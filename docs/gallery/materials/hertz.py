r"""
Does a ball on a plane give Hertz, in newtons and metres?
=========================================================

A ball of radius R under a load F touches a body of contact modulus E* in a circle of radius a:

.. math:: a^3 = \frac{3 F R}{4 E^*}, \qquad p_0 = \frac{3 F}{2 \pi a^2}, \qquad \frac{dF}{d\delta} = 2 E^* a

Here a rigid ball of 1 mm is pressed onto a glassy polymer. The lattice is periodic, so that there is a
ball in every period; ``theory.hertz(..., period=...)`` knows what the others add.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

radius, period, sites = 1e-3, 400e-6, 256  # m
pixel = period / sites
x = pixel * (np.arange(sites) - sites / 2)
ball = -(x[:, None] ** 2 + x**2) / (2 * radius)
surface = asp.surfaces.Surface(ball, unit="m", pixel_size=(pixel, pixel), length_unit="m")
modulus = asp.solids.contact_modulus(3.3e9, 0.37)
solid = asp.solids.half_space(modulus=modulus)

loads = np.geomspace(5e-3, 0.5, 7)  # N
contacts = [asp.press(surface, solid, load=load) for load in loads]
area = np.array([contact.contact_area_corrected for contact in contacts])
exact = asp.theory.hertz(loads, modulus=modulus, radius=radius, period=period)

fig, (left, right) = plt.subplots(1, 2, figsize=(8.0, 3.8), layout="constrained")
left.loglog(loads, 1e6 * exact.contact_radius, "-", color="0.65", linewidth=4, label="Hertz")
left.loglog(loads, 1e6 * np.sqrt(area / np.pi), "o", color="black", label="computed")
left.set(xlabel="load [N]", ylabel="contact radius [µm]")
left.legend()
a, last = exact.contact_radius[-1], contacts[-1]
shape = 1 - np.minimum(np.abs(x) / a, 1) ** 2
right.plot(1e6 * x, exact.largest_pressure[-1] * np.sqrt(shape) / 1e6, "-", color="0.65", linewidth=4)
right.plot(1e6 * x, last.pressure[sites // 2] / 1e6, ".", color="black", markersize=4)
right.set(xlabel="x [µm]", ylabel="contact pressure [MPa]", xlim=(-80, 80), title=f"under {loads[-1]:g} N")

# %%
# The verdict, against how many sites the radius of the contact has.

pressure = np.array([contact.largest_pressure for contact in contacts])
stiffness = np.array([contact.normal_stiffness for contact in contacts])
print("sites  area     pressure  stiffness (computed over Hertz, less 1)")
for row in zip(
    exact.contact_radius / pixel,
    area / exact.area,
    pressure / exact.largest_pressure,
    stiffness / exact.stiffness,
    strict=True,
):
    print("{:5.1f}  {:+.4f}  {:+.4f}   {:+.4f}".format(row[0], *(ratio - 1 for ratio in row[1:])))

# Origin: H. Hertz's closed form (K. L. Johnson, Contact Mechanics, Eqs. 4.22 to 4.24), with the periodic
# images.
np.testing.assert_allclose(pressure, exact.largest_pressure, rtol=2e-3)
np.testing.assert_allclose(area[2:], exact.area[2:], rtol=0.02)
np.testing.assert_allclose(stiffness[2:], exact.stiffness[2:], rtol=0.01)
