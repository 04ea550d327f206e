"""An operator that none of the solvers uses: neighbor differences, no transforms, plain sums."""

from dataclasses import dataclass

import numpy as np


def laplacian(field):
    """Sum over neighbors of (neighbor - site), periodic."""
    return sum(np.roll(field, 1, axis) + np.roll(field, -1, axis) - 2 * field for axis in range(field.ndim))


@dataclass(frozen=True)
class Proof:
    """What the fields of a contact themselves say; forces relative to the mean contact force."""

    penetration: float
    largest_pull: float
    largest_force_off_contact: float
    sum_of_pulls: float
    sum_of_forces_off_contact: float
    load: float
    area: int


def prove(heights, u, u0, *, k0, k1, smallest_force=0.0):
    """Judge u and u0 against the heights by the equations of the spring lattice alone."""
    # Both are measured from one level, which subtracts exactly, to lose no digits to a large offset.
    datum = heights.max()
    force = -k0 * laplacian(u - datum) + k1 * (u - u0)
    touching = u == heights
    area = int(touching.sum())
    load = float(np.sum(k1 * (u - u0)))
    scale = max(load / area if area and load > 0 else 1.0, smallest_force)
    return Proof(
        penetration=float(np.max(heights - u)),
        largest_pull=float(max(0.0, -force[touching].min(initial=0.0))) / scale,
        largest_force_off_contact=float(np.abs(force[~touching]).max(initial=0.0)) / scale,
        sum_of_pulls=float(-force[touching & (force < 0)].sum()),
        sum_of_forces_off_contact=float(np.abs(force[~touching]).sum()),
        load=load,
        area=area,
    )


def heights_rounding(heights, u):
    """One rounding error of a height measured from the highest point."""
    return 2**-52 * np.abs(u - heights.max()).max()


def assert_equilibrium(contact, *, k0, k1, load=None, load_may_vanish=False):
    """The acceptance of every published state.

    A load that dies out is measured by the smallest force that the heights resolve to eight digits. It is
    whatever the contact makes of it, so its two sums may differ by what each site may err.
    """
    smallest = 0.0
    if load_may_vanish:
        largest = max(
            np.abs(field).max() for field in (contact.heights, contact.u, contact.u - contact.heights.max())
        )
        smallest = 4 * np.spacing(largest) * (4 * contact.u.ndim * k0 + k1) / 1e-8
    # The fields as they are kept: adding the datum to them rounds each site by its last digit.
    u, (u0,), *_ = contact.relative
    proof = prove(contact.heights - contact.datum, u, u0, k0=k0, k1=k1, smallest_force=smallest)
    assert proof.penetration <= 0
    assert proof.largest_pull <= 1e-8
    assert proof.largest_force_off_contact <= 1e-8
    assert proof.area == contact.area == int(contact.in_contact.sum())
    np.testing.assert_array_equal(contact.in_contact, contact.u == contact.heights)
    assert contact.residual <= 1e-8
    # The two sums, of contact forces and of spring forces, differ by the forces off contact, by pulls, which
    # count as no force, and by the rounding of N terms. Transforms leave some four roundings of the stiffest
    # mode at each site, which is what `ActiveSet` allows.
    stiffest = 4 * contact.u.ndim * k0 + k1
    rounding = 4 * heights_rounding(contact.heights, contact.u) * stiffest * contact.u.size
    rounding += 2**-52 * contact.u.size * abs(proof.load)
    if load_may_vanish and load is None:
        rounding += 1e-8 * max(proof.load / max(proof.area, 1), smallest) * contact.u.size
    assert abs(contact.load - proof.load) <= proof.sum_of_pulls + proof.sum_of_forces_off_contact + rounding
    if load is not None:
        assert abs(proof.load / load - 1) <= 1e-10
    return proof
