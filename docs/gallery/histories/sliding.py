r"""
How far must a contact slide to forget that it has rested?
==========================================================

A contact slides, rests, and slides again. While it rests its area grows, and with it the friction that
starts the next slide: Tabor's relation, :math:`\mu = \sigma_S A / F_N`. Sliding brings each height above a
place that has not crept, so the gain is lost over a length. Which one?

The rough surface moves in shifts of half a site. Just before a shift the contact has crept, just after it the
contact is smaller: both states are recorded, and the friction of sliding is between them.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

P = asp.protocols
rough = asp.surfaces.spectral((64, 64), hurst=0.8, roll_off=32.0, cutoff=12.0, rms_height=1.0, seed=0)
solid = asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0)
contact = asp.press(rough, solid, load=400.0)


def slide(distance):
    """Slide at velocity 5, in shifts of half a site."""
    return P.Slide(distance, velocity=5.0, substeps=2)


begin, rest = 8.0 / 5.0, 10.0
protocol = [slide(8.0), P.Hold(rest), slide(24.0)]
rested = asp.age(contact, [0.0], protocol=protocol, fields_at=[begin + rest])
never = asp.age(contact, [0.0], protocol=[slide(8.0), slide(24.0)])

# %%
# The friction of both against displacement: the mean of the states after a shift and before the next one.


def friction_of(history):
    """Displacement since the second slide began, and the friction there."""
    data = asp.friction.add_friction(history.dataset, shear_strength=0.5)
    way, friction = (
        data[name].values[data["leg"] == data["leg"][-1]] for name in ("displacement", "friction")
    )
    return way[0::2] - 8.0, (friction[0::2] + friction[1::2]) / 2


way, after_rest = friction_of(rested)
_, without = friction_of(never)
data = asp.friction.add_friction(rested.dataset, shear_strength=0.5)
peak = float(data["friction"].values[data["leg"] == 1][-1])

fig, axes = plt.subplots(figsize=(6.4, 3.6), layout="constrained")
axes.plot(0, peak, "^", color="tab:red", label="at the end of the rest")
axes.plot(way, after_rest, "o-", color="tab:blue", markersize=3, label="after a rest of 10")
axes.plot(way, without, "s-", color="tab:orange", markersize=3, label="without a rest")
axes.set(xlabel="displacement since the second slide began [sites]", ylabel="friction coefficient")
axes.legend()

# %%
# The verdict. The gain is halved over a length much shorter than the width of a contact. Then friction is a
# little lower than without a rest, where summits pass over places that have crept; after the shortest
# wavelength, 12 sites, next to nothing is left.

gain = after_rest / without - 1
half = way[np.argmax(gain < 0.5 * gain[0])]
left = np.abs(gain[way > 12]).max()
patches = asp.analysis.patches(rested["in_contact"].values[0])
width = np.sqrt(patches.sizes.mean())
print(f"friction {without[0]:.3g} without a rest, {peak:.3g} after it; contacts are {width:.2g} sites wide")
print(f"the gain, {100 * gain[0]:.0f} % after the first shift, is halved after {half:g} sites")
print(f"lowest gain {100 * gain.min():.0f} %; after 12 sites it is {100 * left:.1f} % at most")

# Origin: at infinite velocity nothing creeps, so the contact moves with its surface: a period brings it back,
# to the bit.
around = asp.age(contact, [0.0], protocol=P.Slide(64.0, velocity=np.inf, every=8))
assert (around.area == contact.area).all()
assert np.array_equal(around.final.u, contact.u)
# The friction at the end of the rest is the highest; what has moved by its wavelength is new.
assert peak > after_rest.max() > without.max()
assert 0.5 <= half <= width
assert left < 0.05 * gain[0]
