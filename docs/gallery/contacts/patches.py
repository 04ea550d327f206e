r"""
Do contacts grow, join, or appear?
==================================

Between two maps of the contact, patches that share a site are linked. Of :math:`m` later patches,
:math:`p_j` is the number of predecessors of one; of :math:`n` earlier ones, :math:`s_i` that of successors:

.. math::

   \underbrace{\#\{p_j = 0\}}_\text{births} - \underbrace{\#\{s_i = 0\}}_\text{deaths}
   + \underbrace{\sum_{s_i > 0} (s_i - 1)}_\text{splits} - \underbrace{\sum_{p_j > 0} (p_j - 1)}_\text{merges}
   = m - n .

A site that is gained belongs to a patch without predecessor (a new patch), with one (expansion), or with
several (coalescence). One rough surface is pressed against two bodies: a viscoelastic half-space, and the
lattice of springs, of which the crept material flows aside and is conserved.
"""

from itertools import pairwise

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

rough = asp.surfaces.spectral((96, 96), hurst=0.6, roll_off=32.0, rms_slope=0.5, seed=1)
times = np.geomspace(1e-2, 1e4, 13)
bodies = {
    "half-space": (asp.solids.half_space(modulus=1.0, branches=[(0.8, 1.0)]), 40.0),
    "springs": (asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0, R_viscous=0.02), 100.0),
}
parts = {"expansion": "tab:blue", "coalescence": "tab:cyan", "births": "tab:orange"}

fig, grid = plt.subplots(2, 2, figsize=(6.0, 5.4), sharex=True, layout="constrained")
histories = {}
for (name, (solid, load)), (above, below) in zip(bodies.items(), grid.T, strict=True):
    history = asp.age(asp.press(rough, solid, load=load), times, fields_at=[0.0, *times])
    histories[name] = history
    above.semilogx(times, history["patches"][1:], "o-", color="tab:blue", markersize=4)
    above.set(title=name, ylabel="patches", ylim=(0, None))
    gained = [history[f"gained_by_{part}"].cumsum().values[1:] for part in parts]
    lost = (history["lost_by_shrinkage"] + history["lost_by_deaths"]).cumsum().values[1:]
    labels = ["expansion", "coalescence", "new patches"]
    below.stackplot(times, gained, labels=labels, colors=list(parts.values()))
    below.fill_between(times, -lost, 0.0, facecolor="white", edgecolor="black", hatch="//", label="lost")
    below.set(xlabel="hold time", ylabel="sites gained and lost")
    below.legend(fontsize=8, loc="upper left")

# %%
# What each body did, and how a single patch fared.

for name, history in histories.items():
    gained = {part: int(history[f"gained_by_{part}"].sum()) for part in parts}
    shares = ", ".join(f"{part} {sites / sum(gained.values()):.0%}" for part, sites in gained.items())
    events = ", ".join(f"{int(history[one].sum())} {one}" for one in ("births", "deaths", "merges", "splits"))
    print(f"{name}: {shares}; {events}")

tracks = asp.analysis.patch_tracks(histories["springs"].dataset).tracks.to_dataframe()
print(tracks.sort_values("largest_size").tail(3))

# Origin: on a solid whose branches have one spectrum (separable), under a constant load, contacts only gain
# sites. Then nothing is lost, dies or splits, and the sites of new patches are the detached ones of a count
# that knows of no links.
quiet = histories["half-space"]
assert not any(quiet[one].any() for one in ("deaths", "splits", "lost_by_shrinkage", "lost_by_deaths"))
maps = quiet["in_contact"].values
apart = [asp.analysis.turnover(*pair).gained_detached for pair in pairwise(maps)]
assert quiet["gained_by_births"].values[1:].tolist() == apart
for history in histories.values():
    change = history["births"] - history["deaths"] + history["splits"] - history["merges"]
    assert (history["patches"][0] + change.cumsum() == history["patches"]).all()
