r"""
Do my friction data grow like a logarithm, and how fast?
========================================================

Slide-hold-slide tests give the static friction after a hold. The usual law is

.. math:: \mu_s(t) = \mu_0\, [1 + C \ln(1 + t/t_0)] .

``asperity fit data.csv`` fits it and a law that saturates, with 95 % intervals, says which the data
prefer, or that they cannot tell, and draws them. Here the same in Python, for a file that this script
writes: data made up with a known growth of 0.012 for each decade and a scatter of 0.004, three tests at
each of nine hold times.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

growth, scatter = 0.012, 0.004  # per decade
rng = np.random.default_rng(7)
hold = np.repeat(np.geomspace(1.0, 1e4, 9), 3)
true = 0.60 + growth * np.log10(1 + hold / 2.0)
friction = true + rng.normal(scale=scatter, size=hold.size)

with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "friction.csv"
    columns = np.transpose([hold, friction])
    np.savetxt(path, columns, delimiter=";", fmt="%.6g", header="hold_s;mu_s", comments="")
    data = asp.fits.read_measurements(path)

found = asp.fits.measured_growth(data.time, data.value, name=data.value_name)
print("preferred:", found.comparison.verdict)

log = found.fits["logarithm"]
slope, (low, high) = (np.log(10) * np.asarray(x) for x in (log.slope, log.interval("slope")))
print(f"growth per decade {slope:.4f}, 95 % interval {low:.4f} to {high:.4f}; true {growth:g}")

fig, ax = plt.subplots(layout="constrained")
ax.semilogx(data.time, data.value, "o", color="tab:blue", label="measured")
for law, shade, width in (("saturation", "tab:orange", 4), ("logarithm", "black", 1)):
    ax.semilogx(hold, found.fits[law].predict(hold), "-", color=shade, linewidth=width, label=law)
ax.set(xlabel="hold time [s]", ylabel="coefficient of static friction")
ax.set_title(f"{slope:.4f} per decade, 95 % interval {low:.4f} to {high:.4f}")
ax.legend()

# %%
# May the interval be believed? Of a hundred tables like this one, about 95 should have the true growth in
# theirs.

covered = 0
for _ in range(100):
    values = true + rng.normal(scale=scatter, size=hold.size)
    law = asp.fits.logarithm(hold, values)
    low, high = np.log(10) * np.asarray(law.interval("slope"))
    covered += bool(low < growth < high)
print(f"the interval holds the true growth in {covered} of 100 tables")

# Origin: the growth with which the data were made; the number is binomial, 95 with a standard deviation
# of 2.2.
assert 88 <= covered <= 100
assert found.comparison.verdict != "saturation"
