r"""
How does the area follow a load that rises, stays and drops?
============================================================

The solid is like PMMA, with two relaxation times. The load rises to 5 MPa within 2.4 s, stays for 1000 s and
drops to a quarter. ``asp.predict`` gives the area with its 95 % band for other scans of this size.

While the load :math:`F` does not fall, a viscoelastic half-space has the contact of an elastic one under the
effective load (E. H. Lee and J. R. M. Radok, J. Appl. Mech. 27, 438 (1960)),

.. math:: L(t) = E^* \int_0^t J(t - s)\,dF(s) .

With the drop the contact jumps; then it hardly changes.
"""

import numpy as np

import asperity as asp
from asperity.protocols import Hold, Ramp, Step

polymer = asp.solids.half_space(young="1.8 GPa", poisson=0.38, branches=[(0.102, "8.93 s"), (0.106, "118 s")])
scan = asp.surfaces.spectral(
    (128, 128), hurst=0.8, roll_off=10.0, cutoff=1.6, rms_height=0.05, spacing=0.2, unit="um", seed=0
)
legs = [Ramp("2.4 s", pressure="5 MPa"), Hold("1000 s"), Step(pressure="1.25 MPa"), Hold("4000 s")]
prediction = asp.predict(polymer, scan, protocol=legs, per_decade=4)

axes = prediction.plot("contact_area")

# %%
# The verdict: the area at the end of the hold, and after the drop.

area, leg = prediction.series("area"), prediction.series("leg")
held, dropped = area[leg == 1], area[leg == 3]
print(f"{held[-1]} pixels touch after the hold, {dropped[0]} to {dropped[-1]} after the drop")

# Origin: the effective load in closed form, and the contact of an elastic solid under it.
load = prediction.series("load")[leg == 1][-1]
series = asp.relaxation.PronySeries(prediction.modulus, prediction.branches)
effective = series.effective_load([0.0, 2.4, 1002.4], [0.0, load, load])[-1]
elastic = asp.press(scan, asp.solids.half_space(modulus=prediction.modulus), load=effective)
assert abs(elastic.area / held[-1] - 1) < 0.005
assert 4 * dropped[0] < 3 * held[-1]
np.testing.assert_allclose(dropped, dropped[0], rtol=0.02)
