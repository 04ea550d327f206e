r"""
Which patches of contact grow while the area is constant?
=========================================================

T. Pilvelait et al. (Phys. Rev. Research 2, 012056, 2020) hold the real area of contact constant, and let the
load follow: small contacts shrink, and large ones coarsen. J. H. Dieterich and B. D. Kilgore (Tectonophysics
256, 219, 1996) see that load leaves the distribution of sizes alone. ``asperity study patch-sizes`` asks both
of many surfaces; here is one of each.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp
from asperity_research.studies.patch_sizes import growth

heights = asp.surfaces.spectral((64, 64), hurst=0.8, roll_off=16.0, cutoff=4.0, rms_slope=1.0, seed=0)
branches = [(0.25, 1.0), (0.25, 10.0), (0.25, 100.0)]
half_space = asp.solids.half_space(modulus=1.0, branches=branches)

fig, (upper, lower) = plt.subplots(2, 1, figsize=(5.4, 7.0), layout="constrained")
for pressure, look in ((0.01, "o"), (0.02, "^"), (0.04, "s")):
    contact = asp.press(heights, half_space, load=pressure * heights.size)
    sizes = asp.analysis.patches(contact.in_contact).sizes
    upper.loglog(sizes, np.arange(1, sizes.size + 1) / sizes.size, f"{look}-", markersize=3, label=pressure)
upper.set(xlabel="size [sites]", ylabel="part of the patches\nof this size or larger")
upper.legend(title="load a site")

# Now the area is held, on this half-space and on a lattice of springs whose creep conserves the mean.

rough = asp.surfaces.spectral((64, 64), hurst=0.8, roll_off=12.0, cutoff=4.0, rms_height=1.0, seed=0)
springs = asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0)
hold = asp.protocols.Hold(100.0, hold="area")
ends = {}
for name, start, mark in (
    ("half-space", contact, "D"),
    ("springs", asp.press(rough, springs, load=0.08 * rough.size), "^"),
):
    maps = asp.age(start, [100.0], protocol=hold, fields_at=[0.0, 100.0]).dataset["in_contact"].values
    before, net, born = growth(maps[0], maps[-1])
    small = before < 16
    ends[name] = net[small].sum() / before[small].sum(), net[~small].sum() / before[~small].sum()
    lower.semilogx(before, net / before, mark, markersize=4, label=name)
    # Origin: every site of the later map is of a patch before, or of a new one.
    assert abs(net.sum() + born - (maps[-1].sum() - maps[0].sum())) < 1e-9
lower.axhline(0.0, color="0.7")
lower.set(xlabel="initial size [sites]", ylabel="growth at constant area,\nover initial size")
lower.legend()

# %%
# The verdict: growth of patches of fewer than 16 sites, and of the others.

for name, (of_small, of_large) in ends.items():
    print(f"{name}: small {of_small:+.2f}, large {of_large:+.2f}")

# Origin: a separable solid at constant contacts relaxes like its modulus, and no contact changes.
np.testing.assert_allclose(ends["half-space"], 0.0, atol=0.01)
# On the lattice of springs large patches shrink, unlike in the experiment.
assert ends["springs"][1] < -0.05
