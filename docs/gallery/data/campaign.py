r"""
How large are the error bars of an aging curve?
===============================================

One rough surface is one sample. A campaign runs many, in processes of its own, keeps each as soon as it
is finished, and goes on where it was if it is stopped. Its file is that of a run with lists in it.
Campaigns need the extra ``campaign``.

Exponential heights of mean 1 under a light load have a closed form for the mean area of all surfaces: one
site touches at no load, and each unit of load adds as many as the compliance of one contact says,

.. math:: \langle A(t) \rangle = 1 + F\, G(k_1/k_0,\, k_0 R t)/k_0 .
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

CAMPAIGN = """
[surface]
kind = "exponential"
shape = [64, 64]

[solid]
k1 = 3.0

[contact]
load = 20.0

[aging]
first = 0.1
last = 1e3
per_decade = 2

[sweep]
seeds = 24
"""


def study():
    """Run the campaign in a temporary folder, and return its Dataset."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "campaign.toml"
        file.write_text(CAMPAIGN)
        tally = asp.campaign.sweep(asp.campaign.read_plan(file), Path(folder) / "study", workers=2)
        print(tally)
        return asp.campaign.open(Path(folder) / "study").load()


# %%
# Worker processes import this script. So what starts them stands behind this line. The error of the
# growth comes from the scatter of the surfaces (jackknife), because the areas along one run are not
# independent.

if __name__ == "__main__":
    data = study()
    time, area = data["time"].values[1:], data["area"].values
    mean, error = data["area_mean"].values, data["area_stderr"].values
    growth = asp.fits.ensemble(lambda t, A: asp.fits.growth_rate(t, A, first=10.0), data["time"].values, area)
    B = growth.parameters["B"]
    theory = 1 + 20.0 * asp.theory.compliance(3.0, time)

    fig, ax = plt.subplots(layout="constrained")
    ax.semilogx(time, area.T[1:], "-", color="0.8", linewidth=0.8)
    ax.semilogx(time, theory, "k--", label="theory")
    ax.errorbar(
        time,
        mean[1:],
        2 * error[1:],
        fmt="o",
        color="tab:blue",
        markersize=4,
        capsize=3,
        label="mean of 24 surfaces, ± 2 standard errors",
    )
    ax.plot([], [], "-", color="0.8", label="one surface each")
    ax.set(xlabel=r"hold time $t$ [$1/(k_0 R)$]", ylabel="contact area [sites]")
    ax.legend()
    print(f"B = dA/A(0)/d ln t = {B.value:.3f} ± {B.stderr:.3f}, 95 % interval {B.low:.3f} to {B.high:.3f}")

    # Origin: the theory of independent contacts, within three standard errors of the mean of 24 surfaces.
    assert (np.abs(mean[1:] - theory) < 3 * error[1:]).all()
    assert B.low > 0
