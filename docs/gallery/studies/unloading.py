r"""
Can a linear solid lose contact after the load has fallen?
==========================================================

Under a constant load the contact area grows. After the load has fallen at once, experiments see the area
fall for a while before it grows again. On a separable solid, whose relaxation is the same at all
wavelengths, this cannot be. On other linear solids it can. The smallest example is a line of 4 sites whose
creep conserves the mean,

.. math::

    r = k_0 L u + k_1 (u - u_0), \qquad \dot u_0 = R L k_1 (u - u_0),

:math:`L` minus the Laplacian of the line, with :math:`k_0 = R = 1` and :math:`k_1 = 3`.
"""

from fractions import Fraction

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

P = asp.protocols
heights = [Fraction(k, 9) for k in (1, 3, 4, 5)]
high, low, wait = Fraction(12, 5), Fraction(12, 25), 10.0

solid = asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0)
contact = asp.press(np.array(heights, dtype=float), solid, load=float(high))
since = np.geomspace(1e-3, 100.0, 31)
legs = [P.Hold(wait), P.Step(load=float(low)), P.Hold(100.0)]
history = asp.age(contact, wait + since, protocol=legs)
area, leg = history.dataset["area"].values, history.dataset["leg"].values

fig, axes = plt.subplots(figsize=(5.0, 3.2), layout="constrained")
axes.semilogx(since, area[leg == 2][-since.size :], "o-", color="tab:blue", markersize=4)
axes.axvline(0.171, color="0.6", linestyle="--")
axes.set(
    xlabel="time since the load has fallen", ylabel="contact area [sites]", yticks=[2, 3], ylim=(1.5, 3.5)
)

# %%
# The same without rounding, for an endless wait. Once relaxed, all springs to the bulk carry F/4: the three
# higher sites touch. At that shape the step leaves three contacts with positive forces. Relaxed under the low
# load two can be left: the force that would hold the third is negative.


def laplacian(u):
    return [2 * u[i] - u[i - 1] - u[(i + 1) % 4] for i in range(4)]


first = (heights[1] + heights[3]) / 2 - high / 8  # of a free site: L u = -F/4
relaxed = [first, *heights[1:]]
before = [x + high / 4 for x in laplacian(relaxed)]
assert first > heights[0]
assert min(before[1:]) > 0

# In the step u of the free site and the rigid body move: by a and b, with 5 a = 3 b, as the site bears no
# force, and 3 (a - 4 b) = low - high, as the springs to the bulk bear the load.
b = (high - low) * Fraction(5, 51)
a = b * Fraction(3, 5)
after = [before[0] + 5 * a - 3 * b, before[1] - a - 3 * b, before[2] - 3 * b, before[3] - a - 3 * b]
assert sum(after) == low
assert after[0] == 0
print("forces just after the step:", ", ".join(map(str, after)))

held = [(heights[1] + heights[3]) / 2 - low / 8, *heights[1:]]  # relaxed, if all three were held
forces = [x + low / 4 for x in laplacian(held)]
print("relaxed, if the three were held:", ", ".join(map(str, forces)))

# Origin: exact arithmetic. The third contact is lost: positive just after the step, and negative, which no
# contact can bear, in the end.
assert after[1] == Fraction(1, 7650)
assert min(after[1:]) > 0
assert forces[1] < 0
assert area[leg == 1].tolist() == [3]
assert area[-1] == 2
print(f"contacts: {area[0]} under the high load, {area[leg == 1][0]} after the step, then {area[-1]}")
