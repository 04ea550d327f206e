r"""
What does a contact remember of a higher load?
==============================================

A contact is held under a load, then four fifths of the load are taken off at once. The shape that has
crept stays. Does the area show it, and for how long?

A protocol is a list of legs. States just before and just after a step are both recorded, so a time can
stand twice in the Dataset; ``leg`` tells them apart.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

P = asp.protocols
rough = asp.surfaces.gaussian((128, 128), rms=1.0, seed=0)
solid = asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0)
high, low, switch, end = 400.0, 80.0, 100.0, 1e6
since = np.geomspace(1e-2, end, 33)

loaded = asp.press(rough, solid, load=high)
protocol = [P.Hold(switch), P.Step(load=low), P.Hold(end)]
times = np.union1d(np.geomspace(1e-2, switch, 13), switch + since)
unloaded = asp.age(loaded, times, protocol=protocol)
never = asp.age(asp.press(rough, solid, load=low), since)

# %%
# The area of both, against the time since the load became what it is.

data = unloaded.dataset
area = data["area"].values
before, after = area[data["leg"] == 0], area[data["leg"] == 2]
fresh = never.dataset["area"].values[1:]

fig, (upper, lower) = plt.subplots(2, 1, figsize=(5.4, 7.0), sharey=True, layout="constrained")
upper.semilogx(times[times <= switch], before[1:], "o-", color="tab:blue", markersize=4)
upper.set(xlabel=r"hold time [$1/(k_0 R)$]", ylabel="contact area [sites]", title=f"load {high:g}")
lower.semilogx(since, after, "o-", color="tab:blue", markersize=4, label=f"had carried {high:g}")
lower.semilogx(since, fresh, "s-", color="tab:orange", markersize=4, label="had carried nothing")
lower.axhline(asp.relax(never.final).area, color="0.5", linestyle="--", label="relaxed state")
lower.set(xlabel=r"time since the load is 80 [$1/(k_0 R)$]", title=f"load {low:g}")
upper.set_ylim(0, None)
lower.legend()

# %%
# The verdict. The area remembers until the other contact has caught up, which takes about as long as the
# hold did; meanwhile it changes little. Two statements hold exactly: pressing again at once brings the
# old contact back, and in the end nothing is remembered.

catches_up = since[np.argmax(fresh >= 0.95 * after)]
print(f"area {before[-1]} under {high:g}, {after[0]} just after under {low:g}, {fresh[0]} without a past")
meanwhile = after[since < catches_up]
print(f"meanwhile it stays between {meanwhile.min()} and {meanwhile.max()} sites")
print(f"the past is forgotten to 5 % after t = {catches_up:.3g}; the hold took {switch:g}")

held = asp.age(loaded, [switch]).final
again = asp.press(asp.press(held, load=low), load=high)

# Origin: at a given crept shape contact is elastic, and the relaxed state solves k0 Lap u = F/N, without
# a history.
assert np.array_equal(again.in_contact, held.in_contact)
assert asp.relax(unloaded.final).area == asp.relax(never.final).area
assert after[0] > 2 * fresh[0]
assert np.abs(meanwhile / after[0] - 1).max() < 0.1
assert 0.1 * switch < catches_up < 100 * switch
