"""Equal steps in place of those that errors choose, and the order at which they converge."""

import numpy as np

from asperity.aging.spring_steps import SpringSteps
from asperity.aging.tr_bdf2 import Aim
from asperity.contact import ActiveSet, Multigrid
from asperity.contact.problem import TOLERANCE

PRECISE = Aim((TOLERANCE, TOLERANCE), (1e-9, 1e-9))


def anchors_after(count, kind, contact, system, end=1.0, aim=PRECISE):
    """Anchors of all branches at the end of a number of equal steps."""
    now = kind.begin(system, Multigrid() if kind is SpringSteps else ActiveSet(), contact)
    for number in range(1, count + 1):
        assert now.attempt(end / count, aim).failure is None
        now.accept(end * number / count)
    # What springs publish is balanced from a surface whose changes are in single precision.
    quick = kind is SpringSteps
    anchors = now.u[np.newaxis] - now.stretch() if quick else now.state().anchors.on(contact.lattice)
    return (anchors + system.datum).reshape(len(anchors), -1)


def shape_after(*how, **others):
    """The same without their means, which a load decides."""
    anchors = anchors_after(*how, **others)
    return anchors - anchors.mean(axis=1, keepdims=True)


def orders(errors):
    """Exponents at which errors fall from one number of steps to the next, twice as large."""
    return np.log2(np.divide(errors[:-1], errors[1:]))
