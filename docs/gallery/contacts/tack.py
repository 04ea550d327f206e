r"""
How much harder is a rough soft contact to pull apart after a dwell?
====================================================================

A rough rubber rests under a load :math:`P` for a time :math:`t`, and is then pulled apart at once. A contact
opens where that releases the work of adhesion :math:`w` for each area. Under a light load the tack grows with
the contact area, and that with the creep function :math:`J(t)` (C. Creton, L. Leibler, 1996).

Adhesion is left out while the contact ages; its range is below the pixel (`asperity.carried.pull_off`).
"""

import warnings

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

warnings.simplefilter("ignore", asp.errors.Remark)  # of patches of few pixels, and of a strong adhesion
heights = asp.surfaces.spectral(
    (96, 96), hurst=0.8, roll_off=32.0, cutoff=16.0, rms_height=1.0, spacing=1.0, seed=3
)
scan = asp.surfaces.Surface(heights, unit="um", pixel_size=(1.0, 1.0), length_unit="um", edges="reflecting")
rubber = asp.solids.half_space(modulus="1 MPa", branches=[(0.5, "1 s")])
contact = asp.press(scan, rubber, load="60 uN")
dwells = [0.3, 1.0, 3.0, 10.0]
history = asp.age(contact, dwells, carried=asp.Carried(work_of_adhesion="100 mJ/m^2"))
tack = history.dataset["pull_off"].values
area = history.dataset["contact_area_corrected"].values
creep = 2 - np.exp(-np.array([0.0, *dwells]) / 2)
old = history.final.pull_off("100 mJ/m^2")

# %%
# The retreat of the oldest contact, where it opened first, and the tack beside area and creep function.

young = contact.pull_off("100 mJ/m^2")
fig, (upper, middle, lower) = plt.subplots(3, 1, figsize=(5.4, 9.0), layout="constrained")
for pulled, name in ((young, "at once"), (old, "after 10 s")):
    path = pulled.path
    upper.plot(1e6 * path["approach"], 1e6 * path["force"], label=name)
upper.axhline(0, color="black", linewidth=0.8)
upper.set(xlabel="approach since the dwell [µm]", ylabel="normal force [µN]")
upper.legend()
shown = middle.imshow(-1e6 * old.opened, cmap="viridis", extent=[0, 96, 0, 96])
fig.colorbar(shown, ax=middle, label="opens after [µm]")
middle.set(title="the contact after 10 s", xlabel="x [µm]")
times = np.array([0.1, *dwells])
lower.semilogx(times, tack / tack[0], "o-", label="pull-off force")
lower.semilogx(times, area / area[0], "s--", label="area")
lower.semilogx(times, creep, ":", color="black", label="$E_0 J(t)$")
lower.set(xlabel="dwell [s], the first: none", ylabel="over that without a dwell")
lower.legend()

# %%
# The verdict.

print(f"after 10 s: tack {tack[-1] / tack[0]:.2f}, area {area[-1] / area[0]:.2f}, J {creep[-1]:.2f} times")
print(f"load over pull-off force: {old.ratio:.1f}")

# Origin: Creton and Leibler's J(t), from the branches by hand; what they leave out is a tenth here.
assert (np.diff(tack) > 0).all()
assert abs(tack[1:] / tack[0] / creep[1:] - 1).max() < 0.1
