r"""
What does a hardness change?
============================

Where the pressure would exceed the hardness H the rough surface yields: it is lowered for good. Of an elastic
half-space the area grows like the load over :math:`E^* h'`, with :math:`h'` the rms slope. With a hardness
the area is never less than

.. math:: A \ge \frac{F}{H},

and comes near it where the whole contact yields. On the way back the contact is elastic, above a surface that
fits better than before: the area under the same load is larger.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

modulus, heights = (
    2.0,
    asp.surfaces.spectral((128, 128), hurst=0.8, roll_off=64.0, cutoff=4.0, rms_height=1.0),
)
slope = np.sqrt(2) * np.std(np.roll(heights, 1, axis=1) - heights)
unit = modulus * slope * heights.size  # of a load
loads = unit * np.geomspace(1e-3, 0.1, 7)

fig, (upper, lower) = plt.subplots(2, 1, figsize=(5.4, 7.0), layout="constrained")
areas = {}
for hardness, marker in zip((None, 0.3, 0.1), "osv", strict=True):
    solid = asp.solids.half_space(
        modulus=modulus, hardness=None if hardness is None else hardness * modulus * slope
    )
    name = "elastic" if hardness is None else f"H = {hardness} E* h'"
    up = [
        asp.press(heights, solid, load=load) for load in loads if not hardness or load < 0.9 * hardness * unit
    ]
    areas[hardness] = np.array([contact.contact_fraction for contact in up])
    along = loads[: len(up)] / unit
    upper.loglog(along, areas[hardness], f"{marker}-", linewidth=0.8, label=name)
    if hardness is not None:
        upper.loglog(along, along / hardness, "--", color="gray", linewidth=0.8)
    if hardness == 0.3:
        down, contact = [], up[-1]
        for load in loads[len(up) - 1 :: -1]:
            contact = asp.press(contact, load=load)
            down.append(contact.contact_fraction)
        lower.plot(along, areas[hardness], "s-", color="tab:blue", linewidth=0.8, label="load rises")
        lower.plot(along[::-1], down, "s--", color="tab:orange", label="load falls")
upper.set(xlabel="load over $E^* h' A_0$", ylabel="contact fraction")
upper.legend()
lower.set(xlabel="load over $E^* h' A_0$", ylabel="contact fraction, H = 0.3 E* h'")
lower.legend()

# %%
# The verdict.

for hardness in (0.3, 0.1):
    plastic = loads[: len(areas[hardness])] / unit / hardness
    print(f"H = {hardness} E* h': area over F/H", np.round(areas[hardness] / plastic, 2))
    # Origin: no site bears more than H.
    assert (areas[hardness] >= plastic).all()
# The soft one flows nearly everywhere; the harder one is between both limits.
assert areas[0.1][3] < 1.15 * loads[3] / unit / 0.1
assert (areas[0.3] >= areas[None][: len(areas[0.3])]).all()
# On the way back more touches, but for the first load.
np.testing.assert_allclose(down[0], areas[0.3][-1], rtol=1e-3)
assert (np.array(down[1:]) > areas[0.3][-2::-1]).all()
