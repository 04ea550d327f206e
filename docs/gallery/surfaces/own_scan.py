r"""
How does a scan become a contact?
=================================

A profilometer writes heights on a grid, tilted and with pixels that it could not see.
``asp.surfaces.read`` levels the scan, fills undefined pixels from their neighbors, and gives it units; it
records all of it. Text, and arrays of numpy and MATLAB, are read directly. The formats of instruments need
the extra ``instruments``.

This script writes a scan of which it knows the truth: a made surface, a tilt, and holes in the valleys.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

shape, pixel = (160, 160), 0.5  # um
true = asp.surfaces.spectral(shape, hurst=0.8, cutoff=4.0, rms_height=0.2, spacing=pixel, seed=4)
row, column = np.indices(shape)
measured = true + 3.0 + 0.01 * row - 0.004 * column
measured[true < np.quantile(true, 0.03)] = np.nan

with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "scan.txt"
    np.savetxt(path, measured, fmt="%.9g")
    scan = asp.surfaces.read(path, periodic="wrap", file_unit="um", pixel_size=pixel, length_unit="um")

found = scan.provenance["tilt_coefficients"]
print(
    f"filled {scan.provenance['undefined_pixels']} pixels; removed a plane of {found} um, um/pixel, um/pixel"
)

# %%
# Press it, and the surface without tilt and holes, with the same material: a rigid scan under a polymer.

solid = asp.solids.half_space(modulus="3.8 GPa")
contact = asp.press(scan, solid, pressure="20 MPa")
seen = np.isfinite(measured)
terms = np.stack([np.ones(shape), row, column], axis=-1)
plane = np.linalg.lstsq(terms[seen], measured[seen], rcond=None)[0]
level = true + 3.0 + 0.01 * row - 0.004 * column - terms @ plane
truth = asp.press(
    asp.surfaces.Surface(level, unit="um", pixel_size=(pixel, pixel), length_unit="um"),
    solid,
    pressure="20 MPa",
)

fig, grid = plt.subplot_mosaic("ab;c.", figsize=(5.4, 5.0), layout="constrained")
side = [0, pixel * shape[1], pixel * shape[0], 0]
for ax, field, title in zip(
    grid.values(),
    (
        np.ma.masked_invalid(measured),
        1e3 * np.asarray(scan),
        np.where(contact.in_contact, contact.pressure / 1e6, np.nan),
    ),
    ("the file [µm]", "levelled and filled [nm]", "contact pressure [MPa]"),
    strict=True,
):
    image = ax.imshow(field, cmap="viridis", extent=side)
    fig.colorbar(image, ax=ax, shrink=0.75)
    ax.set_title(title, fontsize=10)
    ax.set(xlabel="x [µm]")

# %%
# The verdict.

different = int((contact.in_contact != truth.in_contact).sum())
print(f"{contact.area} sites touch, {truth.area} without tilt and holes; they differ in {different}")

# Origin: the plane by least squares of numpy, and the surface from before pixels were lost.
np.testing.assert_allclose(found[1:], plane[1:], rtol=1e-5)
assert scan.provenance["undefined_pixels"] == shape[0] * shape[1] - seen.sum()
assert different <= 0.01 * truth.area
