r"""
How will the friction of my polymer grow?
=========================================

From a relaxation test, a scan and a pressure to the growth of the real contact and of static friction, in
units: ``asp.predict``, or ``asperity predict`` at the prompt. That relaxation of the bulk alone predicts
how contacts and friction grow was shown by H. Farain and D. Bonn, Nat. Commun. 14, 3606 (2023).

The table is made up: :math:`E(t) = 350 + 3150 \exp[-(t/10^7)^{0.16}]` MPa, like PMMA at room temperature.
The same numbers are in ``docs/data/pmma_like_relaxation.csv``.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

time = np.geomspace(1e-3, 1e6, 37)  # s
young = 350 + 3150 * np.exp(-((time / 1e7) ** 0.16))  # MPa
heights = asp.surfaces.spectral(
    (128, 128), hurst=0.8, roll_off=10.0, cutoff=1.6, rms_height=0.05, spacing=0.2
)
scan = asp.surfaces.Surface(heights, unit="um", pixel_size=(0.2, 0.2), length_unit="um")

with tempfile.TemporaryDirectory() as folder:
    table = Path(folder) / "relaxation.csv"
    np.savetxt(table, np.transpose([time, young]), delimiter=",", header="time_s,E_MPa", comments="")
    material = asp.relaxation.material(table, poisson=0.35)

prediction = asp.predict(material, scan, pressure="5 MPa", shear_strength="50 MPa", per_decade=2)

growth = prediction.growth
low, high = growth.ratio_band
print(f"{prediction.between('A')} = {growth.ratio:.3f}, 95 % band {low:.3f} to {high:.3f}")

fig, (upper, lower) = plt.subplots(2, 1, figsize=(5.4, 7.0), layout="constrained")
upper.semilogx(prediction.time, prediction.friction, "o-", color="tab:blue", markersize=4)
upper.set(xlabel="hold time [s]", ylabel="coefficient of static friction", ylim=(0, None))
least, most = (100 * slope for slope in growth.range)
upper.set_title(f"contact grows by {least:.1f} to {most:.1f} % in each decade", fontsize=10)
last = prediction.dataset.isel(field_time=-1)
image = lower.imshow(
    last["pressure"].where(last["in_contact"]) / 1e6,
    cmap="plasma",
    extent=[0, 25.6, 25.6, 0],
    interpolation="nearest",
)
lower.set(xlabel="x [µm]", title="where it touches after eleven days")
fig.colorbar(image, ax=lower, label="contact pressure [MPa]")

# %%
# What of this does the scan resolve? Patches of a few pixels are not resolved.

resolved = prediction.resolved[-1]
print(
    f"{resolved.patches} patches of {resolved.mean:.0f} pixels; "
    f"{resolved.in_small:.0%} of the area is in patches of fewer than ten"
)

# %%
# The verdict: compare with an elastic solid that has the modulus of the table's last line. No fit of
# exponentials enters there. Creep at constant load is a little less than that: E(t) J(t) is below 1, and
# close to 1 where E falls slowly.

modulus = asp.solids.contact_modulus(1e6 * young[-1], 0.35)
elastic = asp.press(scan, asp.solids.half_space(modulus=modulus), pressure="5 MPa")
ratio = prediction.series("area")[-1] / elastic.area
print(f"area after eleven days over that of an elastic solid of E(t): {ratio:.3f}")

# Origin: Lee and Radok with the quasi-elastic J(t) = 1 / E(t); Tabor's friction, strength times area over
# load.
assert 0.9 < ratio <= 1.0
corrected, load = (prediction.series(name) for name in ("contact_area_corrected", "load"))
np.testing.assert_allclose(prediction.friction, 50e6 * corrected / load, rtol=1e-12)
assert low < growth.ratio < high
