r"""Links of patches from one map to a later one of the same lattice.

A patch before and a patch after are linked where they share a site. Let p be the number of patches before to
which a patch after is linked, and c the number of patches after to which a patch before is linked. With n
patches before and m after,

    births = number with p = 0,    merges = sum of p - 1 over those with p > 0,
    deaths = number with c = 0,    splits = sum of c - 1 over those with c > 0.

Every link is counted once among the p and once among the c: m - births + merges = n - deaths + splits. So
births - deaths + splits - merges is m - n, however many patches are linked to how many.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.base import views
from asperity.lattice import Edges
from asperity.patches.labels import Labels, Patches, masks, patches

Counts = NDArray[np.int64]


@dataclass(frozen=True, eq=False, repr=False)
class Links(views.Brief):
    """Links between the patches of two maps of one lattice.

    Attributes
    ----------
    before, after
        Sites of each patch in each map: ``sizes`` of `Patches`.
    pairs
        The patches that share sites: number before, number after, from 1 on; sorted; shape ``(links, 2)``.
    shared
        Sites that each pair shares, shape ``(links,)``.
    """

    before: Counts
    after: Counts
    pairs: Labels
    shared: Counts

    @cached_property
    def predecessors(self) -> Counts:
        """To how many patches before each patch after is linked, shape ``(patches after,)``."""
        return self._over_links(1)

    @cached_property
    def successors(self) -> Counts:
        """To how many patches after each patch before is linked, shape ``(patches before,)``."""
        return self._over_links(0)

    @property
    def births(self) -> int:
        """Patches after that share no site with any patch before."""
        return int(np.count_nonzero(self.predecessors == 0))

    @property
    def deaths(self) -> int:
        """Patches before that share no site with any patch after."""
        return int(np.count_nonzero(self.successors == 0))

    @property
    def merges(self) -> int:
        """Predecessors of all patches after, but for the first of each."""
        return len(self.pairs) - self.after.size + self.births

    @property
    def splits(self) -> int:
        """Successors of all patches before, but for the first of each."""
        return len(self.pairs) - self.before.size + self.deaths

    @property
    def gained_by_expansion(self) -> int:
        """Sites gained by patches with one predecessor."""
        return int(self._gained[self.predecessors == 1].sum())

    @property
    def gained_by_coalescence(self) -> int:
        """Sites gained by patches with several predecessors."""
        return int(self._gained[self.predecessors > 1].sum())

    @property
    def gained_by_births(self) -> int:
        """Sites of patches without predecessor."""
        return int(self._gained[self.predecessors == 0].sum())

    @property
    def lost_by_shrinkage(self) -> int:
        """Sites lost by patches with successors."""
        return int(self._lost[self.successors > 0].sum())

    @property
    def lost_by_deaths(self) -> int:
        """Sites of patches without successor."""
        return int(self._lost[self.successors == 0].sum())

    @cached_property
    def continued(self) -> Labels:
        """The patch before that each patch after continues; 0 for none; shape ``(patches after,)``.

        Each of the two shares most sites with the other; among equals the largest counts.
        """
        earlier, later = self.pairs.T
        mutual = (self.main_successor[earlier - 1] == later) & (self.main_predecessor[later - 1] == earlier)
        ancestor = np.zeros(self.after.size, dtype=np.int64)
        ancestor[later[mutual] - 1] = earlier[mutual]
        return ancestor

    @cached_property
    def main_predecessor(self) -> Labels:
        """The patch before with which each patch after shares most sites; 0 for none."""
        return self._main(1)

    @cached_property
    def main_successor(self) -> Labels:
        """The patch after with which each patch before shares most sites; 0 for none."""
        return self._main(0)

    def _main(self, side: int) -> Labels:
        """The patch with which each patch before (0) or after (1) shares most sites; 0 for none."""
        patch, partner = self.pairs[:, side], self.pairs[:, 1 - side]
        order = np.lexsort((partner, -self.shared, patch))
        numbers, places = np.unique(patch[order], return_index=True)
        main = np.zeros((self.before, self.after)[side].size, dtype=np.int64)
        main[numbers - 1] = partner[order[places]]
        return main

    def _over_links(self, side: int, weights: Counts | None = None) -> Counts:
        """Number of links, or sum of their weights, of each patch before (0) or after (1)."""
        size = (self.before, self.after)[side].size
        return np.bincount(self.pairs[:, side] - 1, weights, minlength=size).astype(np.int64)

    @property
    def _gained(self) -> Counts:
        return self.after - self._over_links(1, self.shared)

    @property
    def _lost(self) -> Counts:
        return self.before - self._over_links(0, self.shared)


def link_patches(
    before: ArrayLike, after: ArrayLike, connectivity: int = 1, *, edges: Edges = "periodic"
) -> Links:
    """Link the patches of two contacts of one lattice: those that share a site.

    Parameters
    ----------
    before, after
        Whether each site is in contact at two times, shape ``(n,)`` or ``(n, m)``.
    connectivity, edges
        As `patches` takes them.

    Returns
    -------
    Links
        Patches are numbered as by `patches`, largest first.

    Raises
    ------
    InputError
        No boolean masks of one or two axes, or empty ones; masks that differ in shape; a connectivity other
        than 1 or 2; other edges.
    """
    first, last = masks(before, after)
    return linked(patches(first, connectivity, edges=edges), patches(last, connectivity, edges=edges))


def linked(before: Patches, after: Patches) -> Links:
    """Link the patches of two maps of one lattice."""
    both = (before.labels > 0) & (after.labels > 0)
    codes = (before.labels[both] - 1) * after.count + after.labels[both] - 1
    overlapping, shared = np.unique(codes, return_counts=True)
    pairs = np.column_stack(np.divmod(overlapping, max(after.count, 1))) + 1
    return Links(before.sizes, after.sizes, pairs, shared.astype(np.int64))


@dataclass(frozen=True)
class Turnover:
    """Sites kept, gained and lost between two contacts.

    Attributes
    ----------
    kept
        Sites in contact before and after.
    gained
        Sites in contact only after.
    lost
        Sites in contact only before.
    gained_attached
        Sites gained that extend patches: joined to a site in contact before, through neighbors in contact
        before or after.
    gained_detached
        The other sites gained, which form new patches.
    """

    kept: int
    gained: int
    lost: int
    gained_attached: int
    gained_detached: int


def turnover(before: ArrayLike, after: ArrayLike) -> Turnover:
    """Compare two contacts of one lattice, and distinguish growing patches from new ones.

    Parameters
    ----------
    before, after
        Whether each site is in contact at two times, shape ``(n,)`` or ``(n, m)``.

    Returns
    -------
    Turnover
        Numbers of sites.

    Raises
    ------
    InputError
        No boolean masks of one or two axes, or empty ones; masks that differ in shape.
    """
    first, last = masks(before, after)
    gained = last & ~first
    labels = patches(first | last).labels
    attached = int(np.isin(labels[gained], labels[first]).sum())
    total = int(gained.sum())
    return Turnover(
        kept=int((first & last).sum()),
        gained=total,
        lost=int((first & ~last).sum()),
        gained_attached=attached,
        gained_detached=total - attached,
    )
