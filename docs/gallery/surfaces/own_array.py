r"""
How do I press an array of my own, in metres and pascals?
=========================================================

Any array of floats is a surface. If it says its units, everything that comes out is in SI. Here the array
is a wave, :math:`h = \Delta \cos(2 \pi x/\lambda)`, such as a ruled or printed surface has, because its
contact is known: the part of the wave that touches an elastic half-space under a mean pressure p is

.. math:: \frac{A}{A_0} = \frac{2}{\pi} \arcsin \sqrt{\frac{p}{p^*}},
          \qquad p^* = \frac{\pi E^* \Delta}{\lambda}

(H. M. Westergaard, J. Appl. Mech. 6, 49 (1939)).
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

pixel, wavelength, amplitude = 0.05, 12.8, 0.02  # um
x = pixel * np.arange(256)
heights = np.tile(amplitude * np.cos(2 * np.pi * x / wavelength), (64, 1))
wave = asp.surfaces.Surface(heights, unit="um", pixel_size=(pixel, pixel), length_unit="um")

young, poisson = 3.3e9, 0.37  # Pa, a glassy polymer
modulus = asp.solids.contact_modulus(young, poisson)
solid = asp.solids.half_space(modulus=modulus)

# %%
# A pressure, or a load: one follows from the other, because the surface knows its area.

pressures = np.array([0.02, 0.1, 0.25, 0.5, 0.75, 0.95]) * np.pi * modulus * amplitude / wavelength
contacts = [asp.press(wave, solid, pressure=p) for p in pressures]
half = contacts[3]
print(
    f"{half.mean_pressure / 1e6:.3g} MPa on {half.nominal_area * 1e12:.3g} um^2 are {half.load * 1e6:.4g} uN"
)
print(
    f"in contact: {half.contact_area * 1e12:.4g} um^2, largest pressure {half.largest_pressure / 1e6:.3g} MPa"
)

fig, ax = plt.subplots(layout="constrained")
fine = np.linspace(0, 1, 400) * np.pi * modulus * amplitude / wavelength
exact = asp.theory.westergaard_area(fine, modulus=modulus, amplitude=amplitude, wavelength=wavelength)
ax.plot(fine / 1e6, 100 * exact, "-", color="0.65", linewidth=4, label="Westergaard")
computed = np.array([contact.contact_fraction for contact in contacts])
ax.plot(pressures / 1e6, 100 * computed, "o", color="tab:blue", label="computed")
ax.set(xlabel="mean pressure [MPa]", ylabel="real contact [% of nominal area]")
ax.set_title("A wave under an elastic half-space")
ax.legend()

# %%
# The verdict. Counting sites can be wrong by a part of a pixel at each edge of the contact.

exact = asp.theory.westergaard_area(pressures, modulus=modulus, amplitude=amplitude, wavelength=wavelength)
print(f"largest difference: {np.abs(computed - exact).max() * x.size:.2f} pixels of {x.size}")

# Origin: Westergaard's closed form; a pixel at each of the two edges of the contact.
assert np.abs(computed - exact).max() <= 2 / x.size
assert abs(half.load / (pressures[3] * 64 * 256 * (pixel * 1e-6) ** 2) - 1) < 1e-9
