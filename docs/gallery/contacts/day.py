r"""
What becomes of a contact in a day?
===================================

A scan in micrometres, a polymer of 3 GPa of which 40 % relaxes, and a pressure of 5 MPa. Where do the bodies
touch after a second and after a day, and how much has the real area grown?

The band is the 95 % interval over scans: twelve surfaces with the same power spectrum. The three pictures
are those of the first page.
"""

# sphinx_gallery_thumbnail_number = 3
import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

DAY = 86400.0
times = np.geomspace(1.0, DAY, 21)
branches = [(0.08, 10.0**decade) for decade in range(5)]
polymer = asp.solids.half_space(young="3 GPa", poisson=0.35, branches=branches)


def scan(seed):
    return asp.surfaces.spectral(
        (128, 128), hurst=0.8, roll_off=10.0, cutoff=1.6, rms_height=0.05, spacing=0.2, unit="um", seed=seed
    )


contact = asp.press(scan(0), polymer, pressure="5 MPa")
history = asp.age(contact, times)
side = [0, 25.6, 25.6, 0]  # um

fig, ax = plt.subplots(figsize=(4.2, 3.6), layout="constrained")
image = ax.imshow(1e3 * scan(0).heights, cmap="viridis", extent=side)
fig.colorbar(image, label="height [nm]")
ax.set(xlabel="x [µm]", ylabel="y [µm]", title="a scan")

# %%
# The contact after a day, with its pressure.

final = history.final
fig, ax = plt.subplots(figsize=(4.2, 3.6), layout="constrained")
image = ax.imshow(
    np.where(final.in_contact, final.pressure / 1e6, np.nan),
    cmap="plasma",
    extent=side,
    interpolation="nearest",
)
fig.colorbar(image, label="contact pressure [MPa]")
ax.set(xlabel="x [µm]", ylabel="y [µm]", title="where it touches after a day")

# %%
# The growth, over twelve scans.

areas = []
for seed in range(12):
    area = asp.age(asp.press(scan(seed), polymer, pressure="5 MPa"), times)["contact_area_corrected"]
    areas.append(1e12 * np.asarray(area)[1:])
mean, spread = np.mean(areas, axis=0), 2.2 * np.std(areas, axis=0, ddof=1)  # Student's t of 11

fig, ax = plt.subplots(figsize=(4.2, 3.6), layout="constrained")
ax.fill_between(times, mean - spread, mean + spread, color="tab:orange", alpha=0.3, label="95 % of scans")
ax.semilogx(times, mean, color="tab:orange", linewidth=2.5, label="mean of scans")
ax.semilogx(times, areas[0], "o", color="tab:blue", markersize=4, label="this scan")
ax.set(xlabel="time [s]", ylabel="real contact area [µm²]", title="how the contact grows")
ax.legend(loc="upper left")

# %%
# The verdict.

growth = np.array(areas)[:, -1] / np.array(areas)[:, 0]
print(f"the area of this scan grows {growth[0]:.3f} times from a second to a day")
print(f"twelve scans: {growth.mean():.3f} ± {growth.std(ddof=1):.3f}")

# Origin: Lee and Radok. A separable solid under a load touches where an elastic one of 1/J(t) does, with J
# from its branches.
J = asp.relaxation.PronySeries(1.0, tuple(branches)).compliance_at(DAY)
softer = asp.solids.half_space(young=3e9 / J, poisson=0.35)
assert asp.press(scan(0), softer, pressure="5 MPa").area == final.area
assert 1.2 < growth.mean() < 1 / 0.6
