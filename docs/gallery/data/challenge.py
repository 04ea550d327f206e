r"""
Does my code compute the same contact?
======================================

Eight reference problems have certified answers with error bars, for any code. In one of them an elastic
half-space is pressed onto a self-affine surface that is known between the sites, too. "My code" is here a
short one in numpy: conjugate gradients on the pressures (I. A. Polonsky and L. M. Keer, Wear 231, 206
(1999)), which looks for

.. math:: u = K p, \qquad 0 \le p \perp u - h \ge 0, \qquad \sum p\, \Delta^2 = F .

It counts the sites under pressure, on the sites of the problem, on every second, and on every fourth of them.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp


def press(heights, spacing, modulus, load):
    """Contact area and mean gap of an elastic half-space, m^2 and m."""
    frequencies = np.fft.fftfreq(len(heights), spacing)[:, None], np.fft.rfftfreq(len(heights), spacing)
    q = 2 * np.pi * np.hypot(*frequencies)
    compliance = 2 / (modulus * np.where(q > 0, q, np.inf))
    mean = load / (heights.size * spacing**2)
    p, t, before, fresh = np.full(heights.shape, mean), 0.0, 1.0, True
    while True:
        gap = np.fft.irfft2(compliance * np.fft.rfft2(p)) - heights
        touching = p > 0
        gap -= gap[touching].mean()
        if max(np.abs(gap[touching]).max(), -gap.min()) < 1e-9 * np.ptp(heights):
            return touching.sum() * spacing**2, gap.mean()
        norm = (gap[touching] ** 2).sum()
        t = np.where(touching, gap + (0 if fresh else norm / before) * t, 0)
        r = np.fft.irfft2(compliance * np.fft.rfft2(t))
        step = (gap * t)[touching].sum() / ((r - r[touching].mean()) * t)[touching].sum()
        p, before = np.maximum(np.where(touching, p - step * t, 0), 0), norm
        again = (p == 0) & (gap < 0)
        fresh = again.any()
        p = np.where(again, -step * gap, p)
        p *= mean / p.mean()


problem = asp.challenge.problem("self-affine")
heights, (spacing, _) = problem.surface().in_meters()
modulus, loads = problem.run["solid"]["modulus"], problem.answer.abscissa[2:5]

# %%
# The answer is a table with the headings of the problem's form; `asp.challenge.score` takes a file or
# columns. On the command line: ``asperity challenge write``, then ``asperity challenge score answer.csv``.

scores = {}
for every in (4, 2, 1):
    found = [press(heights[::every, ::every], every * spacing, modulus, load) for load in loads]
    area, gap = np.transpose(found)
    answer = {"load_N": loads, "contact_area_m2": area, "mean_gap_m": gap}
    scores[every] = asp.challenge.score(answer, "self-affine")
    for one in scores[every].quantities:
        worst = 100 * np.abs(one.relative).max()
        print(f"{len(heights) // every}^2 sites, {one.column.name}: {one.verdict}, {worst:.2g} % at most")

fig, axes = plt.subplots(2, 1, figsize=(5.4, 7.0), layout="constrained")
for ax, quantity in zip(axes, ("contact area", "mean gap"), strict=True):
    for (every, score), style in zip(scores.items(), ("s:", "o--", "^-"), strict=True):
        one = score.quantities[axes.tolist().index(ax)]
        label = f"{len(heights) // every}² sites"
        ax.semilogx(loads, 100 * one.relative, style, markerfacecolor="white", label=label)
    tolerance = 100 * one.column.tolerance
    ax.axhspan(-tolerance, tolerance, color="0.9", label="tolerance")
    bar = 100 * one.bar / one.certified
    ax.errorbar(loads, 0 * loads, bar, fmt="none", ecolor="tab:red", capsize=3, label="error bar")
    ax.set(xlabel="load [N]", ylabel=f"deviation of the {quantity} [%]")
    ax.set_xticks(loads, [f"{load:g}" for load in loads])
    ax.minorticks_off()
axes[0].legend(fontsize=8)

# %%
# From 128² sites on the gap is right to 0.1 %. The area is not: counting squares adds the border of every
# contact, which halves with the spacing. The problem asks for the area of the continuum: take off the border.

gaps = [np.abs(score.quantities[1].relative).max() for score in scores.values()]
areas = [score.quantities[0].relative for score in scores.values()]

# Origin: the certified answer, of lattices of up to 1024^2 sites and two solvers, known to 0.5 %.
assert scores[1].quantities[1].verdict != "off"
assert gaps[0] > gaps[1] > gaps[2]
assert (areas[0] > areas[1]).all()
assert (areas[1] > areas[2]).all()
assert (areas[2] > 0).all()
