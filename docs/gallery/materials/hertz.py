r"""
Are balls pressed as Hertz, and Lee and Radok, have it?
=======================================================

A rigid ball of radius R under a load F touches a half-space of contact modulus E* in a circle of radius a,

.. math:: a^3 = \tfrac34 R\, F / E^*, \qquad p(r) = \frac{2 E^*}{\pi R} \sqrt{a^2 - r^2},
   \qquad \delta = a^2 / R

(Hertz). Where the half-space creeps under a constant load, its creep compliance J(t) takes the place of 1/E*
(Lee and Radok). Two balls at a distance d lower each other by the far field :math:`F / (\pi E^* d)`.

``asp.surfaces.sphere`` and ``array`` make balls in metres. Their edges are free: nothing lies beyond them.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

R, E, pixel = 1e-3, 3.8e9, 1e-6
solid = asp.solids.half_space(modulus=E)
fig, (upper, middle, lower) = plt.subplots(3, 1, figsize=(5.4, 9.0), layout="constrained")

# Hertz: the pressure along a line through the middle.

ball = asp.surfaces.sphere((128, 128), radius=R, pixel_size=pixel)
x, fine = pixel * (np.arange(128) - 63.5), np.linspace(-64e-6, 64e-6, 1001)
for load in ("20 mN", "100 mN", "400 mN"):
    hertz = asp.press(ball, solid, load=load)
    a = np.cbrt(0.75 * R * hertz.load / E)
    law = 2 * E / (np.pi * R) * np.sqrt(np.maximum(a**2 - fine**2, 0))
    upper.plot(1e6 * fine, law / 1e6, "-", color="0.65", linewidth=4)
    upper.plot(1e6 * x, hertz.pressure[64] / 1e6, ".", markersize=3)
    upper.text(0, law.max() / 1e6, f"{load}\n", ha="center", va="center", fontsize=9)
upper.set(xlabel="x [µm]", ylabel="contact pressure [MPa]", title="one ball: Hertz", ylim=(0, 120))

# Lee and Radok: a standard linear solid, which loses three quarters of its modulus, under 100 mN.

share, tau = 0.75, 100.0
polymer = asp.solids.half_space(modulus=E, branches=[(share, tau)])
times = np.geomspace(1.0, 1e4, 13)
crept = asp.age(asp.press(ball, polymer, load="100 mN"), times).dataset
creep = (1 - share * np.exp(-(1 - share) * times / tau)) / (1 - share)  # E* J(t)
a_of_t = np.cbrt(0.75 * R * 0.1 * creep / E)
found = np.sqrt(crept["contact_area"].values[1:] / np.pi)
middle.semilogx(times, 1e6 * a_of_t, "-", color="0.65", linewidth=4, label="closed form")
middle.semilogx(times, 1e6 * found, "o", markersize=4, label="computed")
middle.set(xlabel="time [s]", ylabel="contact radius [µm]", title="the same for hours: Lee and Radok")
middle.legend(loc="upper left")

# Two balls, each under 20 mN, beside one alone under 20 mN.

near, further = pixel * np.array([80, 120, 160, 240, 320]), []
for d in near:
    shape, first = (64, 64 + round(d / pixel)), (32 * pixel, 32 * pixel)
    one = asp.surfaces.array(shape, places=[first], radii=R, pixel_size=pixel)
    two = asp.surfaces.array(shape, places=[first, (first[0], first[1] + d)], radii=R, pixel_size=pixel)
    alone, both = asp.press(one, solid, load=0.02), asp.press(two, solid, load=0.04)
    further.append(alone.separation - both.separation)
far_field, d = 0.02 / (np.pi * E * near), np.linspace(70, 330, 200)
lower.plot(d, 1e15 * 0.02 / (np.pi * E * d), "-", color="0.65", linewidth=4, label=r"$F / (\pi E^* d)$")
lower.plot(1e6 * near, 1e9 * np.array(further), "o", markersize=4, label="computed")
lower.set(xlabel="distance d of two balls [µm]", ylabel="further approach [nm]", ylim=(0, None))
lower.set_title("two balls: they feel each other")
lower.legend()

# %%
# The verdict.

print(f"Hertz: a pressure of {hertz.largest_pressure / (2 * E * a / (np.pi * R)):.5f} of the closed form")
print(f"Lee and Radok: radii off by at most {1e6 * np.abs(found - a_of_t).max():.2f} pixels")
print(f"two balls: {np.round(100 * (further / far_field - 1), 2)} % beyond the far field")

# Origin: the closed forms above (K. L. Johnson, Contact Mechanics, sections 3.2, 4.2 and 6.5).
np.testing.assert_allclose(hertz.largest_pressure, 2 * E * a / (np.pi * R), rtol=1e-3)
np.testing.assert_allclose(-crept["separation"][1:], a_of_t**2 / R, rtol=1e-3)
np.testing.assert_allclose(found, a_of_t, atol=0.5 * pixel)
np.testing.assert_allclose(further, far_field, rtol=0.02)
