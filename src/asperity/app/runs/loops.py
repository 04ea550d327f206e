"""Compile every loop that a run may need, before its first number."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress

import numpy as np

from asperity.base.calls import remark
from asperity.contact import stencils
from asperity.contact.active_set import ActiveSet
from asperity.contact.compiled import COMPILING, stamp_of, tell_of_place, watch
from asperity.contact.multigrid.loops import one_field, rows, states, two_fields
from asperity.simulate import age, press, relax
from asperity.solids import Eyring, half_space, spring_lattice
from asperity.surfaces import self_affine


def compile_loops(tell: Callable[[str], None] = remark, remark: Callable[[str], None] = remark) -> None:
    """Compile all loops and keep their machine code on disk, unless that has been done.

    `tell` gets a text before anything is compiled, `remark` one on an unusual folder of the machine code.
    Both are a `Remark` by default.
    """
    stamp = stamp_of(one_field.sweeps_1, rows.total, states.settle, two_fields.cycle_2, stencils.forces)
    tell_of_place(remark)
    if stamp is not None and stamp.exists():
        return
    watch.reported = True
    tell(COMPILING)
    # Even, and large enough for the Fourier solver to start from a coarser lattice.
    heights = np.random.default_rng(0).normal(size=(66, 66))
    viscous = spring_lattice(k0=1.0, k1=3.0, R_viscous=0.1)
    for solid in (viscous, half_space(modulus=1.0, branches=[(0.5, 1.0)])):
        contact = press(heights, solid, load=80.0)
        relax(press(age(contact, [1.0, 100.0], exact=False).final, load=40.0))
    age(press(heights[0], spring_lattice(k0=1.0, k1=3.0), load=1.2), [1.0])
    for solver in (None, ActiveSet()):
        age(press(heights, spring_lattice(k0=0.0, k1=3.0), load=80.0), [1.0], solver=solver)
    age(press(heights, spring_lattice(k0=1.0, k1=3.0, creep=Eyring(rate=1.0, stress=1.0)), load=80.0), [1.0])
    # Contacts in patches, where cycles are slow and contacts close one by one.
    patches = self_affine(64, hurst=0.8, delta=0.05, seed=0)
    rough = patches / patches.std()
    age(press(rough, spring_lattice(k0=1.0, k1=100.0, R_viscous=0.1), load=5e3), [1.0, 100.0])
    if stamp is not None:
        with suppress(OSError):  # then the next process looks again
            stamp.touch()
