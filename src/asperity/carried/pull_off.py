r"""Pull-off after aging: elastic and fast, by an adhesion whose range is below the pixel.

The contacts have aged without adhesion, and creep is frozen. K = 1 / S is the instantaneous compliance. While
the bodies move apart by L, forces p hold the surfaces together on the closed sites C:

    K p + L = d on C,        p = x_d - L x_1,        K x_d = d and K x_1 = 1 on C,

where d = K p0 for the aged forces p0, so that nothing moves at L = 0. Beyond the aged contact d continues
linearly from within, for nothing but the closed sites opens: so the forces at a wall depend on the load that
is left, and not on the load that was borne. Closed sites may bear tension. A site opens for good if the front
releases at least the work of adhesion w per area there. The release is the crack closure integral along it,

    G = sqrt(G_less G_more),        G_less, G_more = mean of t delta / (2 cell) along the front,

where t is the tension of a closed site, and delta its gap once open, at the same L. G_less opens the
outermost closed layer as a whole, G_more closes the innermost open layer, so the front is midway. Means
extend over some pixels of the front (`Tuning.smoothing`) and its mirror images, so that a row opens as a
whole. By the criterion of single sites (R. Pohrt and V. L. Popov, Facta Univ. Ser. Mech. Eng. 13, 3 (2015))
the first site of a row needs G = 1.65 w and traps the front. Crack closure: DOI 10.3389/fmech.2021.754782.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import scipy
from numpy.typing import NDArray

from asperity.base import checks, units, views
from asperity.base.calls import remark
from asperity.carried.response import stiffness_of_contact
from asperity.contact import Contact
from asperity.contact.arrays import inner
from asperity.contact.mechanics import mechanics_of
from asperity.errors import ConvergenceError, InputError
from asperity.lattice import Field, Mask
from asperity.patches import patches

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Tuning:
    """Numbers of the method."""

    smoothing: float = 2.5
    """Standard deviation of the means along the front, longer sides of a pixel."""

    toughness: float = 1.03
    """G / w at which a site opens, from flat punches and balls of 10 to 32 pixels: above 1, as the weakest
    places open first."""

    share: float = 0.04
    """Share of the outermost layer that opens in a step. Forces of rough contacts are 18 % below to 5 % above
    those at 0.01, which takes three times as long."""

    coarse: float = 0.2
    """`share` far from the largest tension."""

    solved: float = 3e-3
    """Relative error of the forces of a layer, in the energy norm."""

    apart: float = 1e-3
    """Relative error of an increment of L."""

    fair_ratio: float = 10.0
    """Load over pull-off force below which adhesion also matters while aging."""


TUNING = Tuning()

EXPECTED_ERROR = {2.0: 0.4, 3.0: 0.3, 4.0: 0.17, 6.0: 0.06, 11.0: 0.04, 16.0: 0.03, 32.0: 0.02}
"""Largest error of the force of balls (1.5 pi w R) and flat punches, by pixels of the radius at pull-off."""

ERROR_AT_ONCE = EXPECTED_ERROR | {4.0: 0.21, 6.0: 0.13, 8.0: 0.1, 11.0: 0.06, 16.0: 0.04}
"""The same of balls that let go before their front has receded."""

RECEDED = 1.1
"""Radius over that at the pull-off up to which these hold, at other places of the pixels."""

_CROSS = np.array([[0, 1, 0], [1, 1, 1], [0, 1, 0]], dtype=bool)
Pair = tuple[Field, Field]
"""A field linear in L: its value at 0, and its slope."""


@dataclass(frozen=True, eq=False, repr=False)
class PullOff(views.Brief):
    """An aged contact that is pulled apart instantly, with frozen creep.

    Attributes
    ----------
    work
        Work of adhesion, energy per area, of fast separation.
    force
        Pull-off force: the largest tension, > 0, whether load or separation is prescribed.
    approach, normal_force, area
        Steps from the aged contact until nothing touches, shape ``(steps,)``: approach since the aged
        contact, length, which falls below 0; force, < 0 for tension; number of closed sites.
    opened
        Approach at which each site opened, length; NaN off the aged contact. Shape of the contact.
    """

    work: float
    force: float
    approach: Field
    normal_force: Field
    area: NDArray[np.int64]
    opened: Field
    _contact: Contact

    @property
    def ratio(self) -> float:
        """Aging load over pull-off force; aging without adhesion needs a large ratio.

        Adhesion multiplies the area of a ball by (1 + 2 / n + sqrt(4 / n + 4 / n^2))^(2/3), with n this
        ratio: 51 % more at 10, 14 % at 100, 4 % at 1000.
        """
        return self._contact.load / self.force

    @cached_property
    def path(self) -> xr.Dataset:
        """The steps as an xarray Dataset: approach, force and area.

        ``patch`` is the map of the patches of the aged contact, from 1, largest first; ``let_go`` the
        approach at which the last site of each opened; ``opened`` the attribute.
        """
        return self._path(self._contact)

    @views.later
    def _path(self, /, contact: Contact) -> xr.Dataset:
        raise NotImplementedError


@views.defines(Contact.pull_off)
def pull_off(contact: Contact, work: float | str) -> PullOff:
    """See `Contact.pull_off`."""
    w = _checked(contact, work)
    if contact.area == 0 or _is_full(contact):
        got = "full contact" if contact.area else "no site in contact"
        raise InputError("pull_off", expected="a partial contact", got=got, advice="another load")
    opened = np.full(contact.relative[2].shape, np.nan)
    apart, force, area = np.transpose(_Bond(contact, w).way(opened))
    opened = contact.lattice.embedding.cut(opened)
    result = PullOff(w, -float(force.min()), -apart, force, area.astype(int), opened, contact)
    _remark_on(contact, result)
    return result


def pull_off_force(contact: Contact, work: float | str) -> float:
    """Pull-off force; 0 without contact; NaN, with a remark, in full contact, which has no rim to open."""
    w = _checked(contact, work)
    if _is_full(contact):
        remark("full contact has no pull-off force: it is missing at such times")
        return math.nan
    return pull_off(contact, w).force if contact.area else 0.0


def _is_full(contact: Contact) -> bool:
    """Whether all touches, and nothing ends at the edges."""
    return contact.area == contact.heights.size and contact.lattice.edges != "free"


def _checked(contact: Contact, work: float | str) -> float:
    """Work of adhesion; `InputError` if it, or the solid, is none that can be pulled."""
    solid, lattice = contact.solid, contact.lattice
    if not solid.in_lengths or lattice.dimension == 1:
        got = "a line contact" if solid.in_lengths else f"a {solid.kind.replace('_', ' ')}"
        expected = "a half-space, a layer or a film under a surface of two dimensions"
        advice = "asperity.solids.half_space(modulus=...)"
        raise InputError("pull_off", expected=expected, got=got, advice=advice)
    if solid.adhesion is not None:
        expected, advice = "a solid without adhesion", "asperity.pull(contact)"
        raise InputError("pull_off", expected=expected, got="one with adhesion", advice=advice)
    return checks.number("work", units.converted("work", work, "J/m^2", si=contact.si), above=0)


def _remark_on(contact: Contact, pull: PullOff) -> None:
    held = pull.opened <= pull.approach[pull.normal_force.argmin()]  # at the largest tension
    count = max(1, int(np.count_nonzero(held)))
    sizes = patches(held, edges=contact.lattice.edges).sizes
    radius = math.sqrt(float((sizes**2).sum()) / count / math.pi)
    table = EXPECTED_ERROR if contact.area > RECEDED**2 * count else ERROR_AT_ONCE
    radii, errors = np.transpose(sorted(table.items()))
    error = float(np.interp(radius, radii, errors))
    if error > 0.05:
        remark(
            f"pull_off: patches of {max(round(radius), 1)} pixels in radius at the pull-off, the mean "
            f"over the contact, let the force err by up to {100 * error:.0f} %; smaller pixels are surer, "
            f"{100 * table[11.0]:.0f} % at 11 of them"
        )
    if pull.ratio < TUNING.fair_ratio:
        remark(
            f"pull_off: the load is less than {TUNING.fair_ratio:g} times the pull-off force; adhesion, "
            "left out while the contact ages, would matter there too; see docs/adhesion.md"
        )


class _Bond:
    """Closed sites, and their forces: as they are, with a layer less, and with a layer more."""

    def __init__(self, contact: Contact, work: float) -> None:
        self.lattice = lattice = contact.lattice.embedding
        self.sides = np.array(lattice.spacing) / max(lattice.spacing)
        # Where a body ends, the empty space of the embedding is the layer beyond its rim.
        self.mode: Any = "reflect" if lattice.reflecting else "wrap"
        self.around: Any = lattice.shape * self.sides * (1 + lattice.reflecting)
        self.flips = list(itertools.product({False, lattice.reflecting}, repeat=2))
        # A spring beside the contact shifts all approaches alike, and no force.
        alone = mechanics_of(replace(contact.solid, apparatus=None), lattice)
        stiffness = alone.implicit_step(0.0).stiffness
        self.compliance = np.divide(1.0, stiffness, out=np.zeros_like(stiffness), where=stiffness > 0)
        self.unit = float(self.compliance.max())
        self.soft: Any = (self.compliance / self.unit).astype(np.float32)
        self.stiff: Any = (stiffness * self.unit).astype(np.float32)
        self.closed = contact.relative[2].copy()
        force = lattice.extended(contact.force, beyond=0.0)
        self.target = self._continued(self._moved(force))
        self.energy = TUNING.toughness * work * lattice.cell
        self.stiffness = stiffness_of_contact(contact)
        self.step = TUNING.apart * math.sqrt(self.energy * contact.area / self.stiffness)
        self.forces: list[Pair] = [(force, np.zeros_like(force))] * 3

    def way(self, opened: Field) -> list[tuple[float, float, int]]:
        """L, force and number of closed sites, by step; fills in the approach at which each site opens."""
        apart, most = 0.0, 0.0
        states: list[tuple[float, float, int]] = []
        while area := int(np.count_nonzero(self.closed)):
            layer, released = self._release(apart)
            if not states:
                states = [(0.0, self._load(0.0), area)]
                # Errors grow with the way from where forces are solved, and a loaded punch goes far at once.
                begin = min(self._reach(released, 0.0, 1), self._load(0.0) / self.stiffness)
                layer, released = self._release(begin)
                apart = self._reach(released, begin, 1)
                states.append((apart, self._load(apart), area))
            count = np.count_nonzero(layer)
            for share in (TUNING.coarse, TUNING.share):
                last = self._reach(released, apart, max(1, int(share * count / 2)))
                until = self._reach(released, last, max(1, int(share * count)))
                # Near the largest tension steps are fine.
                if self._load(until) > (-0.5 * most if most else 0.5 * self._load(apart)):
                    break
            self.step, apart = max(self.step / 4, until - apart), last
            states.append((apart, self._load(apart), area))
            most = max(most, -states[-1][1])
            sites = np.flatnonzero(layer)[released(until) >= 1]
            opened.flat[sites], self.closed.flat[sites] = -apart, False
        return [*states, (apart, 0.0, 0)]

    def _load(self, apart: float) -> float:
        at_rest, slope = self.forces[0]
        return float(at_rest.sum()) - apart * float(slope.sum())

    def _reach(self, released: Any, start: float, count: int) -> float:
        """The least L >= start at which so many sites have G >= w."""

        def enough(apart: float) -> bool:
            return bool(np.count_nonzero(released(apart) >= 1) >= count)

        low = high = start
        step = self.step
        while not enough(high):
            low, high, step = high, high + step, 2 * step
            if not math.isfinite(high):
                raise ConvergenceError("pull-off: no pull opens the rest; the forces are not finite numbers")
        while high - low > TUNING.apart * (high - start):
            middle = (low + high) / 2
            low, high = (low, middle) if enough(middle) else (middle, high)
        return high

    def _release(self, apart: float) -> tuple[Mask, Any]:
        """The outermost closed layer, and G / w at its sites as a function of L, most exact at `apart`."""
        closed = self.closed
        how: Any = {"footprint": _CROSS, "mode": self.mode}
        layer = closed & ~scipy.ndimage.minimum_filter(closed, **how)
        beyond = scipy.ndimage.maximum_filter(closed, **how) & ~closed
        part = TUNING.solved**2 * np.count_nonzero(layer)
        allowed = 2 * part * self.energy, part * self.stiffness / np.count_nonzero(closed)
        for number, shape in enumerate((closed, closed & ~layer, closed | beyond)):
            ours, slope = self.forces[number]
            slope = self._bonded(slope, 1.0, shape, allowed[1])
            there = self._bonded(ours - apart * slope, self.target - apart, shape, allowed[0])
            self.forces[number] = there + apart * slope, slope
        whole, less, more = self.forces
        self.stiffness = float(whole[1].sum())
        by_less = self._beside(layer, layer, whole, less)
        by_more = self._beside(layer, beyond, more, whole)

        def released(apart: float) -> Field:
            ratio: Field = np.sqrt(by_less(apart) * by_more(apart))
            return np.where(apart * whole[1][layer] > whole[0][layer], ratio, 0.0)  # pressed ones stay

        return layer, released

    def _beside(self, layer: Mask, sites: Mask, shut: Pair, free: Pair) -> Any:
        """Mean of t delta / (2 w cell) near each site of a layer, as a function of L.

        It extends over `sites`: t follows from the forces while they are shut, delta while they are free.
        """
        tension = -shut[0][sites], shut[1][sites]
        gap = self._moved(free[0])[sites] - self.target[sites], 1.0 - self._moved(free[1])[sites]
        places, others = np.argwhere(layer), np.argwhere(sites)
        last = 2 * np.array(layer.shape) - 1
        images = np.concatenate([np.where(flipped, last - others, others) for flipped in self.flips])
        both = (places * self.sides, images * self.sides)
        one, other = (scipy.spatial.KDTree(points, boxsize=self.around) for points in both)
        near = one.sparse_distance_matrix(other, 3 * TUNING.smoothing, output_type="coo_matrix")
        weight = np.exp(-0.5 * (near.data / TUNING.smoothing) ** 2)
        shape = len(places), len(others)
        mean = scipy.sparse.csr_array((weight, (near.row, near.col % len(others))), shape=shape)
        scale = 2 * self.energy * np.asarray(mean.sum(axis=1), dtype=float)

        def released(apart: float) -> Field:
            t, delta = (np.maximum(at_rest + apart * slope, 0.0) for at_rest, slope in (tension, gap))
            return np.asarray(mean @ (t * delta)) / scale

        return released

    def _moved(self, force: Field) -> Field:
        """Displacement by forces, frozen creep."""
        return self.lattice.apply(self.compliance, force)

    def _continued(self, field: Field) -> Field:
        """A field of the closed sites, continued by lines to the sites that share a side with one."""
        both = np.array([np.where(self.closed, field, 0.0), self.closed])
        total = count = np.zeros_like(field)
        for axis, side in itertools.product((1, 2), (-1, 1)):
            (first, one), (second, two) = (
                scipy.ndimage.correlate1d(both, np.eye(5)[2 + away * side], axis=axis, mode=self.mode)
                for away in (1, 2)
            )
            total = total + one * first + one * two * (first - second)
            count = count + one
        return np.where(self.closed, field, total / np.maximum(count, 1.0))

    def _bonded(self, force: Field, target: Field | float, shape: Mask, allowed: float) -> Field:
        """Forces on a set of sites that displace them to a target, by conjugate gradients from `force`.

        `allowed` bounds twice the energy of the error. The preconditioner is S restricted to the sites.
        """
        force = np.where(shape, force, 0.0)
        error = np.where(shape, target - self._moved(force), 0.0)
        if not (scale := float(np.abs(error).max())):
            return force
        inside, residual = shape.astype(np.float32), cast(Any, (error / scale).astype(np.float32))
        correction, slope = np.zeros_like(residual), 1.0
        direction: Any = None
        goal = allowed * self.unit / scale**2
        for _ in range(np.count_nonzero(shape)):
            estimate = inside * self.lattice.apply(self.stiff, residual)
            before, slope = slope, inner(residual, estimate, np)
            if slope <= goal:
                break
            direction = estimate if direction is None else estimate + np.float32(slope / before) * direction
            response = inside * self.lattice.apply(self.soft, direction)
            length = np.float32(slope / inner(direction, response, np))
            correction += length * direction
            residual -= length * response
        return np.asarray(force + correction * (scale / self.unit))
