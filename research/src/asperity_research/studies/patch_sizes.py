r"""Study: the sizes of patches of contact under several loads, and which of them grow at constant area.

J. H. Dieterich and B. D. Kilgore, Tectonophysics 256, 219 (1996), DOI 10.1016/0040-1951(95)00165-4, see areas
of contacts that follow a power law from the smallest that they resolve up to a limiting size, whatever the
load, and find the same where fractal surfaces overlap. T. Pilvelait, S. Dillavou and S. M. Rubinstein, Phys.
Rev. Research 2, 012056 (2020), DOI 10.1103/PhysRevResearch.2.012056, hold the area constant: small contacts
shrink, and large ones coarsen.

Laws for the sizes s = s_min, s_min + 1 and so on are

    power        p(s) ~ s^-tau
    cut          p(s) ~ s^-tau exp(-s/s_c)
    lognormal    p(s) ~ s^-a exp(-b ln(s)^2)

each with its norm as a sum over all s (A. Clauset, C. R. Shalizi, M. E. J. Newman, SIAM Review 51, 661
(2009), DOI 10.1137/070710111). They are exponential families: the likelihood is concave, and of the
data it holds the means of ln s, s and ln(s)^2 alone.

At constant area a patch at first has grown by what its sites have become: it loses the sites that are off
contact at the end, and shares the new sites of a later patch with the other patches that are part of it, by
the sites that each has in it.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial
from itertools import product
from typing import Any, NamedTuple, Self

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import logsumexp

import asperity_research.studies.unloading as unloading
from asperity.analysis import link_patches, patches
from asperity.fits import Estimate, jackknife
from asperity_research import style
from asperity_research.arrays import Field, Mask
from asperity_research.studies.campaigns import Campaign, Solid, hold, waves
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Finding, Measurement
from asperity_research.studies.numbers import all_columns, columns
from asperity_research.studies.study import Outcome, Study, Words

WORDS = Words.beside(__file__)
Sizes = NDArray[np.int64]

SMALLEST = 16
"""Smallest size of the fits: the square of the shortest wavelength, below which surfaces are smooth."""

PRESSURES = (0.01, 0.02, 0.04, 0.08)  # Load a site, over E*, of surfaces with an rms slope of 1
HURST = (0.4, 0.8)
CLASSES = (1, 4, 16, 64, 256)  # Least sizes of the classes
SMALL, LARGE = 16, 64  # Small patches have fewer sites, large ones as many or more
SAME_EXPONENT, SAME_SIZE = (-0.05, 0.05), (-0.1, 0.1)
"""Changes, over that of ln load, of the exponent, and of ln size, that bear out that load leaves it alone."""

_CHANGES = 0.01  # Part of its sites by which a class has to grow, or shrink, to count as one that does

SOLIDS = {
    name: replace(unloading.SOLIDS[name], load=load)
    for name, load in (("half_space", 0.04), ("conserved", 0.08), ("viscous", 0.08))
}
"""By name, under a load at which the area is that to be held."""


def _campaigns(seeds: int, side: int = 256, held_side: int = 128) -> Iterator[Campaign]:
    # The run ends long before the only relaxation time.
    half_space = {"kind": "half_space", "modulus": 1.0, "branches": [[0.5, 1e3]]}
    yield Solid("just after the half-space was pressed", half_space, PRESSURES[0]).campaign(
        "pressed",
        "Patches under several loads",
        waves(side, side / 4, rms_slope=1.0),
        aging={"first": 1e-3, "per_decade": 1},
        protocol=[hold(1e-3)],
        output={"maps_at": [0.0]},
        sweep={"hurst": list(HURST), "load": [p * side**2 for p in PRESSURES], "seeds": seeds},
    )
    for name, solid in SOLIDS.items():
        yield solid.campaign(
            name,
            "Patches while the area is held constant",
            waves(held_side, held_side / 8) | solid.rough,
            aging={"first": 0.1, "per_decade": 1},
            protocol=[hold(100.0, hold="area")],
            output={"maps_at": [0.0, 100.0]},
            sweep={"seeds": seeds},
        )


class Law(NamedTuple):
    """A law of sizes that was fitted: tau, or a of the lognormal law, and 1/s_c or b.

    The second is 0 where the likelihood, the mean over the patches of the logarithm of p(s), is greatest
    without that factor.
    """

    exponent: float
    second: float
    likelihood: float


def fit(means: Field, support: Field) -> Law:
    r"""Fit p ~ exp(-sum theta_i T_i) by maximum likelihood; of two theta, the second is not below 0.

    ``means`` are those of T over the data, shape (n,), and ``support`` is T of all sizes that can be, shape
    (n, sizes). The logarithm of the likelihood is concave: a search downhill from 0 finds its maximum.
    """
    unit = support[:, -1]  # of order 1
    scaled, wanted = support / unit[:, None], means / unit

    def lack(theta: Field) -> tuple[float, Field]:
        exponent = -theta @ scaled
        norm = float(logsumexp(exponent))
        return float(theta @ wanted) + norm, wanted - scaled @ np.exp(exponent - norm)

    how: dict[str, Any] = {"method": "L-BFGS-B", "options": {"ftol": 1e-15, "gtol": 1e-11}}
    bounds = [(None, None), (0.0, None)][: len(means)]
    minimum = minimize(lack, np.zeros(len(means)), jac=True, bounds=bounds, **how)
    exponent, second = [*(minimum.x / unit), 0.0][:2]
    return Law(float(exponent), float(second), -float(minimum.fun))


class Laws(NamedTuple):
    """The three laws, fitted to sums over the patches of several surfaces."""

    power: Law
    cut: Law
    lognormal: Law

    @classmethod
    def of(cls, sums: Field, largest: int) -> Self:
        """Fit them to rows of `sums_of`, for sizes from SMALLEST to a largest that can be."""
        count, *moments = sums.sum(axis=0)[:4]
        means, support = np.array(moments) / count, _moments(np.arange(SMALLEST, largest + 1.0))
        return cls(*(fit(means[use], support[use]) for use in ([0], [0, 1], [0, 2])))


def _moments(sizes: Field) -> Field:
    logs = np.log(sizes)
    return np.stack([logs, sizes, logs**2])


def sums_of(sizes: Sizes) -> Field:
    """Sums over the patches of one surface, shape (6,).

    The number of those of SMALLEST sites and more, sums of ln s, s and ln(s)^2 over these; sums of s and s^2
    over all.
    """
    fitted = sizes[sizes >= SMALLEST].astype(np.float64)
    return np.array([fitted.size, *_moments(fitted).sum(axis=1), sizes.sum(), (sizes**2).sum()], dtype=float)


def overlap(heights: Field, sites: int) -> Mask:
    """Where the heights reach through a plane that leaves so many sites above it."""
    return np.asarray(heights >= np.partition(heights, -sites, axis=None)[-sites])


def growth(before: Mask, after: Mask) -> tuple[Sizes, Field, int]:
    """Sizes of patches before, and by how many sites each has grown from map to map, shape (patches,).

    And the sites of patches that share none with a patch before: with these the growths add up to the change
    of the area.
    """
    links = link_patches(before, after)
    first, other = (links.pairs - 1).T
    whole = np.bincount(other, links.shared, links.after.size)
    part = links.after[other] * links.shared / whole[other]
    born = int(links.after[whole == 0].sum())
    grown: Field = np.bincount(first, part, links.before.size) - links.before.astype(float)
    return links.before, grown, born


def analyse(evidence: Evidence) -> Outcome:
    """Fit the laws of sizes under each load, and find what grows at constant area."""
    exponents, sizes, of_load = _pressed(evidence)
    grown, of_area = _grown(evidence)
    return Outcome((*of_load, *of_area), {"exponents": exponents, "sizes": sizes, "growth": grown})


def _pressed(evidence: Evidence) -> tuple[pd.DataFrame, pd.DataFrame, tuple[Finding, ...]]:
    """Exponents by Hurst exponent and load, shares of patches by size, and the findings."""
    opened = evidence["pressed"]
    loads, seeds = opened["load"].values, opened["seed"].values.tolist()
    sites = int(evidence.sites("pressed"))
    rows, shares, load_free = list[dict[str, object]](), list[pd.DataFrame](), list[Measurement]()
    laws: dict[str, Estimate] = {}
    for hurst, kind in product(opened["hurst"].values.tolist(), ("contact", "overlap")):
        heads = [{"of": kind, "hurst": hurst, "pressure": load / sites} for load in loads]
        presses = [
            [_sizes(evidence, kind, hurst=hurst, load=load, seed=seed) for seed in seeds] for load in loads
        ]
        shares += [_survival(np.concatenate(some), head) for some, head in zip(presses, heads, strict=True)]
        # seeds, loads, sums
        samples = np.array([[sums_of(sizes) for sizes in some] for some in presses]).transpose(1, 0, 2)
        numbers = jackknife(partial(_numbers, loads=loads, largest=sites // 4), samples)
        for at, head in enumerate(heads):
            counted = {"area": samples[:, at, 4].mean() / sites, "patches": int(samples[:, at, 0].sum())}
            ends = all_columns(**{name: numbers.part(at).part(n) for n, name in enumerate(_COLUMNS)})
            ends |= {name: math.exp(ends[name]) for name in ends if name.startswith("mean_size")}
            rows.append(head | counted | ends | {"runs": len(seeds)})
        if kind == "overlap":
            continue
        about = f"half-space, Hurst exponent {hurst:g}"
        words = f"ln likelihood a patch, power law with a limit less lognormal: {about}, load a site"
        laws |= {f"{words} {load / sites:g}": numbers.part(at).part(2) for at, load in enumerate(loads)}
        slopes = numbers.part(len(loads))
        load_free += [
            Measurement(f"d tau / d ln load: {about}", slopes.part(0), *SAME_EXPONENT),
            Measurement(f"d ln (mean size by area) / d ln load: {about}", slopes.part(1), *SAME_SIZE),
        ]
    in_order = pd.concat(shares).sort_values(["hurst", "pressure"], kind="stable", ignore_index=True)
    return pd.DataFrame(rows), in_order, (WORDS.judge("law", laws), WORDS.judge("load", load_free))


def _sizes(evidence: Evidence, kind: str, **where: float) -> Sizes:
    """Sizes of the patches of one run, in contact, or of a plane through the heights with the same area."""
    fields = evidence.fields("pressed", **where)
    touching = fields["in_contact"].values[0]
    mask = touching if kind == "contact" else overlap(fields["heights"].values, int(touching.sum()))
    return patches(mask).sizes


_COLUMNS = ("exponent", "mean_size", "over_lognormal", "over_power", "inverse_limit")


def _numbers(samples: Field, loads: Field, largest: int) -> Field:
    """Numbers of `_COLUMNS` under each load, the size as a logarithm; then their slopes against ln load."""
    rows = []
    for at in range(len(loads)):
        laws = Laws.of(samples[:, at], largest)
        area, squares = samples[:, at].sum(axis=0)[4:]
        better = (laws.cut.likelihood - other.likelihood for other in (laws.lognormal, laws.power))
        rows.append((laws.cut.exponent, math.log(squares / area), *better, laws.cut.second))
    return np.vstack([rows, np.polyfit(np.log(loads), np.array(rows), 1)[0]])


def _survival(sizes: Sizes, head: Mapping[str, object]) -> pd.DataFrame:
    """Share of the patches that have so many sites or more, at sizes that grow by a fifth."""
    steps = round(math.log(sizes.max()) / math.log(1.2))
    at = np.unique(np.geomspace(1, sizes.max(), 1 + steps).round())
    share = 1 - np.searchsorted(np.sort(sizes), at) / sizes.size
    return pd.DataFrame({**head, "size": at.astype(int), "share": share})


def _grown(evidence: Evidence) -> tuple[pd.DataFrame, tuple[Finding, ...]]:
    """Growth by class of sizes at constant area, and the findings."""
    tables, findings = [], []
    for name, solid in SOLIDS.items():
        every = []  # net growth and sites, by class, of new patches or all, of the small, and of the large
        counts = np.zeros(len(CLASSES) + 1, dtype=int)
        for seed in evidence[name]["seed"].values:
            maps = evidence.fields(name, seed=int(seed))["in_contact"].values
            before, net, born = growth(maps[0], maps[-1])
            of = np.searchsorted(CLASSES, before, side="right") - 1
            parts = before < SMALL, before >= LARGE
            both = [
                [*np.bincount(of, some, len(CLASSES)), new, *(some[part].sum() for part in parts)]
                for some, new in ((net, born), (before, before.sum()))
            ]
            every.append(both)
            counts[:-1] += np.bincount(of, minlength=len(CLASSES))
        samples = np.array(every, dtype=float)
        ratio, ends = jackknife(_ratio, samples[..., :-2]), jackknife(_ratio, samples[..., -2:])
        classes = {
            "solid": name,
            "from": (*CLASSES, 0),
            "below": [*CLASSES[1:], math.inf, math.nan],
            "patches": counts,
        }
        by_class = columns("growth", ratio, shared=True) | {"runs": ratio.runs}
        tables.append(pd.DataFrame(classes | by_class))
        sentence = "growth of patches of {} sites{}, over their sites: {}".format
        measured = (
            Measurement(sentence(f"fewer than {SMALL}", "", solid.what), ends.part(0), high=-_CHANGES),
            Measurement(sentence(LARGE, " and more", solid.what), ends.part(1), low=_CHANGES),
        )
        findings.append(WORDS.judge("growth", measured, key=name))
    return pd.concat(tables, ignore_index=True), tuple(findings)


def _ratio(sample: Field) -> Field:
    """Sum over surfaces of the first row over that of the second; NaN where that is 0."""
    gained, sites = sample.sum(axis=0)
    return np.asarray(np.divide(gained, sites, out=np.full_like(gained, np.nan), where=sites > 0))


_KINDS = {"contact": "o-", "overlap": "s:"}
_LOOKS = {
    "half_space": ("D-", style.SKY, "half-space"),
    "conserved": ("^-", style.VERMILION, "conserved"),
    "viscous": ("o-", style.INK, "viscous"),
}


def draw(tables: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw the sizes, their exponent, and the growth at constant area."""
    figure, (sizes, exponent, held) = style.panels(5.4, 8.6, rows=3)
    shares = tables["sizes"]
    shown = shares[(shares["of"] == "contact") & (shares["hurst"] == HURST[-1])]
    for (pressure, rows), look in zip(shown.groupby("pressure"), "o^sD", strict=False):
        sizes.plot(
            rows["size"], rows["share"], f"{look}-", markersize=2.5, linewidth=0.7, label=f"{pressure:g}"
        )
    sizes.axvline(SMALLEST, color="0.7", linewidth=0.8)
    for (kind, hurst), rows in tables["exponents"].groupby(["of", "hurst"], sort=False):
        color = style.INK if hurst == HURST[-1] else style.VERMILION
        style.points(
            exponent, rows, "pressure", "exponent", _KINDS[str(kind)], color, label=f"{kind}, {hurst:g}"
        )
    grown = tables["growth"][tables["growth"]["from"] > 0]
    style.families(held, grown, "solid", "from", "growth", _LOOKS)
    held.axhline(0.0, color="0.7", linewidth=0.8)
    WORDS.dress(sizes, exponent, held)
    return figure


PATCH_SIZES = Study(
    **WORDS.study, quick=tuple(_campaigns(3)), full=tuple(_campaigns(8)), analyse=analyse, draw=draw
)
