r"""
Does rest make a contact stiffer, and when does it begin to slip?
=================================================================

Under a shear force :math:`Q` below the friction limit :math:`\mu P` a contact slips from the border of its
patches inwards, and the rest sticks. What sticks is nearly the contact that the same bodies have under the
load :math:`P - Q/\mu` (Ciavarella; Jaeger): exactly at :math:`\nu = 0`. With rest the contact grows, and with
it grow its stiffness, the current that it passes, and the part that sticks at a given shear force.

The pad is a viscoelastic square of 64 µm that ends at its edges.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

MU, NU, LOAD = 0.4, 0.45, 0.004
heights = asp.surfaces.spectral(
    (128, 128), spacing=0.5, hurst=0.8, roll_off=16.0, cutoff=2.0, rms_height=0.1, seed=4
)
pad = asp.surfaces.Surface(heights, unit="um", pixel_size=(0.5, 0.5), length_unit="um", edges="free")
polymer = asp.solids.half_space(modulus="1 GPa", branches=[(0.4, "1 s"), (0.3, "100 s")])
young = asp.press(pad, polymer, load=LOAD)
old = asp.age(young, ["1000 s"]).final

# %%
# Where it sticks under half of the limit, and how far it gives way up to nine tenths of it.

fig, grid = plt.subplot_mosaic("ab;cc", figsize=(5.4, 6.0), layout="constrained")
sides = [0, 64, 0, 64]
for ax, (name, contact) in zip(
    (grid["a"], grid["b"]), {"young": young, "after 1000 s": old}.items(), strict=True
):
    slip = contact.partial_slip(MU * LOAD / 2, MU, NU)
    shown = np.where(slip.stick, 2.0, np.where(slip.slip, 1.0, 0.0))
    ax.imshow(shown, cmap=plt.matplotlib.colors.ListedColormap(["white", "#d55e00", "black"]), extent=sides)
    ax.set(title=f"{name}: {slip.stick_fraction:.0%} of the\ncontact sticks (black)", xlabel="x [µm]")
for name, contact, style in (("young", young, "C0o-"), ("after 1000 s", old, "C1s-")):
    parts = np.linspace(0.1, 0.9, 7)
    ways = [contact.partial_slip(part * MU * LOAD, MU, NU).displacement for part in parts]
    grid["c"].plot(1e9 * np.array([0, *ways]), [0, *parts], style, label=name)
grid["c"].set(
    xlabel="displacement along the shear force [nm]", ylabel="shear force over its limit, $Q/(\\mu P)$"
)
grid["c"].legend()

# %%
# The verdict.

stiffer = old.tangential_stiffness(NU) / young.tangential_stiffness(NU)
conducts = young.resistance("17 nohm m") / old.resistance("17 nohm m")
grown = old.area / young.area
print(
    f"area {grown:.2f}, stiffness {stiffer:.2f}, conductance {conducts:.2f} times those of the young contact"
)

# Origin: conductance is the normal stiffness times a constant (Barber 2003); the tangential one is nearly so.
assert abs(stiffer / conducts - 1) < 0.01
assert stiffer > 1.1
