r"""
Which law does a rough joint give to a finite element model?
============================================================

A model of two blocks that touch has flat faces. What roughness adds is a law between them: the pressure
:math:`p` against the approach :math:`a` of the rough layer, its stiffness, and what it conducts,

.. math:: a = \max h - \langle u \rangle, \qquad \frac{dp}{da} = \frac{1}{A\,c}, \qquad
   h_c = \frac{2}{E^*}\,\frac{dp}{da}\,\left(\frac{1}{k_1} + \frac{1}{k_2}\right)^{-1},

with the heights :math:`h`, the surface :math:`u` of the solid, and the lowering :math:`c` of its mean by a
unit of load. ``asp.law`` tabulates it at each age. After an hour the joint is stiffer, and when the pressure
falls the law is another one.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.interpolate import CubicHermiteSpline

import asperity as asp

heights = asp.surfaces.spectral((96, 96), roll_off=32.0, cutoff=4.0, rms_slope=0.1, seed=2)
joint = asp.surfaces.Surface(heights, unit="um", pixel_size="1 um")
polymer = asp.solids.half_space(modulus="3 GPa", branches=[(0.3, "1 min"), (0.2, "20 min")])
carried = asp.Carried(conductivity="0.2 W/m/K")
law = asp.law(
    polymer, joint, pressures=["0.5 MPa", "20 MPa"], times=["0 s", "1 h"], per_decade=6, carried=carried
)

# %%
# What the model asks for: pressure against approach, and conductance against pressure.

fig, (upper, lower) = plt.subplots(2, 1, figsize=(5.4, 7.0), layout="constrained")
for time, color in ((0.0, "tab:blue"), (3600.0, "tab:orange")):
    for direction, dashes in (("loading", "-"), ("unloading", "--")):
        one = law.sel(time=time, direction=direction)
        upper.plot(1e9 * one["approach"], 1e-6 * one["pressure"], dashes, color=color)
    one = law.sel(time=time, direction="loading")
    lower.loglog(1e-6 * one["pressure"], one["thermal_conductance"], color=color, label=f"age {time:g} s")
    ends = one["thermal_conductance_low"], one["thermal_conductance_high"]
    lower.fill_between(1e-6 * one["pressure"], *ends, color=color, alpha=0.2)
upper.set(xlabel="approach [nm]", ylabel="pressure [MPa]", title="dashed: the pressure falls again")
lower.set(xlabel="pressure [MPa]", ylabel="thermal conductance [W/m²/K]")
lower.set_title("bands: 95 %, of the mean over such scans")
lower.legend()

# %%
# The same in the words of CalculiX, in N, mm, s, MPa.

print(asp.contact_law.law_for("calculix", law, age="1 h", millimeters=True)[:420])

# %%
# The verdict.

young = law.sel(time=0.0, direction="loading")
a, p = young["approach"].values, young["pressure"].values
work = CubicHermiteSpline(a, p, young["stiffness"].values).integrate(a[0], a[-1])
first, last = (asp.press(joint, polymer, pressure=one) for one in p[[0, -1]])
stored = (last.energy - first.energy) / last.nominal_area
print(f"work of the joint {work:.5f} J/m^2, elastic energy {stored:.5f} J/m^2")

# Origin: without creep the work of the pressure is the elastic energy; 1/R = 2 k / (E* (rho_1 + rho_2)),
# J. R. Barber, Proc. R. Soc. A 459, 53 (2003).
np.testing.assert_allclose(work, stored, rtol=1e-3)
conducted = 1 / (last.thermal_resistance("0.2 W/m/K") * last.nominal_area)
np.testing.assert_allclose(young["thermal_conductance"][-1], conducted, rtol=1e-6)
aged, falling = (law["approach"].sel(time=3600.0, direction=one) for one in ("loading", "unloading"))
assert (falling[:-1] > aged[:-1]).all()
