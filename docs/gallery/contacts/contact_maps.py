r"""
Are contacts lost while the area grows?
=======================================

Under a constant load the area grows, but does every contact stay? It does where all stiffness relaxes
alike at every wavelength, as in a viscoelastic half-space (T. C. T. Ting, J. Appl. Mech. 33, 845 (1966)).
The lattice of springs is no such solid: its permanent stiffness :math:`k_0 \lambda(q)` and its creeping
one, :math:`k_1`, differ in shape. As new contacts take over some of the load, old ones can open there.

``plot(since=...)`` tells contacts from the start, new ones and lost ones apart.
"""

import matplotlib.pyplot as plt

import asperity as asp

rough = asp.surfaces.self_affine(128, hurst=0.5, delta=0.1, seed=1)
springs = asp.press(rough, asp.solids.spring_lattice(k0=1.0, k1=1.0, R=1.0), load=150.0)
polymer = asp.solids.half_space(modulus=1.0, branches=[(0.4, 1.0), (0.3, 100.0)])
body = asp.press(rough, polymer, load=20.0)

fig, grid = plt.subplot_mosaic("ab;c.", figsize=(5.4, 6.0), layout="constrained")
lost = []
for ax, (name, contact, time) in zip(
    grid.values(),
    [("springs", springs, 100.0), ("springs", springs, 1e4), ("half-space", body, 1e4)],
    strict=True,
):
    aged = asp.age(contact, [time]).final
    lost.append(int((contact.in_contact & ~aged.in_contact).sum()))
    aged.plot(ax, since=contact, colorbar=False)
    ax.set_title(f"{name}, $t$ = {time:g}: {contact.area} → {aged.area}\n{lost[-1]} lost", fontsize=10)

fig.text(0.55, 0.25, "black: in contact from the start\norange: new\nblue: lost", fontsize=11)

# %%
# The verdict.

print(
    f"lattice of springs: {lost[0]} of {springs.area} first contacts lost at t = 100, {lost[1]} at t = 10000"
)
print(f"half-space: {lost[2]} of {body.area}")

# Origin: Ting's theorem for a solid of which all stiffness has one spectrum.
assert lost[2] == 0
assert 0 < lost[0] < lost[1]
