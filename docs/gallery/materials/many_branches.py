r"""
How do I follow a polymer over nine decades, and is it right?
=============================================================

A real solid has many relaxation times. Here a power law, :math:`E(t) \propto t^{-0.1}`, becomes a sum of
exponentials, about one a decade. Such a half-space is separable: under a load that never falls, its
contact at time t is that of an elastic solid under another load (E. H. Lee, J. R. M. Radok, J. Appl.
Mech. 27, 438 (1960)),

.. math:: F_\mathrm{eff}(t) = E(0) \int J(t - s)\, dF(s) .

So there are three ways to one curve: ``age`` as it is, which uses this where it holds;
``age(exact=False)``, which takes time steps as for any solid; and ``press`` with the effective load,
which knows nothing of time.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

spacing, pressure = 1.0, 1e6  # um, Pa
heights = asp.surfaces.spectral((128, 128), hurst=0.8, roll_off=64.0, cutoff=8.0, rms_height=0.5, seed=0)
scan = asp.surfaces.Surface(heights, unit="um", pixel_size=(spacing, spacing), length_unit="um")
series = asp.relaxation.power_law(modulus=3e9, exponent=0.1, time=1.0, first=1e-3, last=1e6)
solid = asp.solids.half_space(modulus=series.modulus, branches=series.branches)
print(
    f"{len(series.branches)} branches; E* falls from {series.modulus_at(1e-3) / 1e9:.2f} to "
    f"{series.modulus_at(1e6) / 1e9:.2f} GPa"
)

contact = asp.press(scan, solid, pressure=pressure)
times = np.geomspace(1e-3, 1e6, 10)
one, other = asp.age(contact, times), asp.age(contact, times, exact=False)
exact, marched = one.area.values[1:], other.area.values[1:]

# %%
# The third way: elastic contacts under the effective load.

elastic = asp.solids.half_space(modulus=series.modulus)
alone = [
    asp.press(scan, elastic, pressure=pressure * factor).area
    for factor in series.modulus * series.compliance_at(times)
]

fig, (above, below) = plt.subplots(
    2, 1, sharex=True, figsize=(6.4, 5.4), height_ratios=(3, 2), layout="constrained"
)
above.loglog(
    times, 100 * exact / heights.size, "-", color="0.65", linewidth=4, label="exact for such a solid"
)
above.loglog(times, 100 * marched / heights.size, "o", color="tab:blue", markersize=4, label="time steps")
above.set(ylabel="real contact [% of nominal area]")
above.legend()
apart = 1e6 * np.abs(other["mean_gap"] / one["mean_gap"] - 1)[1:]
below.semilogx(times, apart, "o", color="tab:blue", markersize=4)
below.set(xlabel="hold time [s]", ylabel="difference of the\nmean gap [millionths]", ylim=(0, None))

# %%
# The verdict.

print(f"time steps against exact: at most {np.abs(marched - exact).max()} of {exact[-1]} sites")
print(f"elastic contacts against exact: at most {np.abs(alone - exact).max()} sites")

# Origin: Lee and Radok's theorem, by elastic contacts that share no time with the others.
assert np.abs(exact - alone).max() <= 1
np.testing.assert_allclose(marched, exact, rtol=0.003)
