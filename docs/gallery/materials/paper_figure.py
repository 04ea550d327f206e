r"""
How do I draw a prediction for a paper, beside what I have measured?
====================================================================

One panel of a prediction, as wide as a column of a journal, with measured areas in it; then the files that
a journal asks for: a PDF, and the numbers as a table. ``asperity predict --measured area.csv --figures pdf``
does the same at the prompt, and draws the ratio of both below.

The modulus relaxes once, by a fifth in 10 s. The measured areas are made up: those of the theory of light
contacts, whose area is proportional to the compliance, with 3 % of noise.
"""

import tempfile
from pathlib import Path

import numpy as np

import asperity as asp

share, tau = 0.2, 10.0  # of the modulus, and its relaxation time in s
solid = asp.solids.half_space(modulus=2e9, branches=[(share, tau)])
heights = asp.surfaces.spectral((128, 128), hurst=0.8, roll_off=8.0, cutoff=1.6, rms_height=0.05, spacing=0.2)
scan = asp.surfaces.Surface(heights, unit="um", pixel_size=(0.2, 0.2), length_unit="um")
prediction = asp.predict(solid, scan, pressure="2 MPa", first="100 ms", last="1000 s", per_decade=3)

# %%
# The compliance of one branch in closed form; times the first area it is what a light contact would show.

time = np.geomspace(0.1, 1000, 9)  # s
compliance = (1 - share * np.exp(-(1 - share) * time / tau)) / (1 - share)
area = 1e12 * prediction.series("contact_area_corrected")  # um^2
noise = np.random.default_rng(0).normal(1, 0.03, time.size)
measured = area[0] * compliance / compliance[0] * noise

axes = prediction.plot("area")
axes.errorbar(time, measured, 0.03 * measured, fmt="D", color="black", markersize=3, label="measured")
axes.figure.set_figheight(3.4)
axes.legend(fontsize=7, loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False)

# %%
# The files: the text in the PDF stays text, and the table has all curves with their units.

with tempfile.TemporaryDirectory() as folder:
    files = asp.figures.write(axes.figure, Path(folder) / "area", ["pdf", "svg"])
    print(*(file.name for file in files))
    table = Path(folder) / "area.csv"
    print(table.read_text().splitlines()[1][:60], "...")
    curve = "corrected for pixel rims: real contact area [um^2]"
    found = asp.fits.read_measurements(table, time="time under load [s]", value=curve)

# Origin: the series of the prediction itself; Lee and Radok with J(t) of one branch in closed form; 85 mm.
np.testing.assert_allclose(found.value, area, rtol=1e-9)
np.testing.assert_allclose(measured / np.interp(np.log(time), np.log(found.time), area), noise, rtol=0.04)
assert abs(axes.figure.get_figwidth() * 25.4 - 85) < 0.1
