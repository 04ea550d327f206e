"""Protocols of friction experiments, and the records that a law predicts for them.

protocol = asp.friction.slide_hold_slide(holds=[1.0, 10.0, 100.0], velocity=1.0, distance=20.0)
history = asp.age(contact, times=..., protocol=protocol)
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from asperity.base import checks, units
from asperity.errors import InputError
from asperity.friction.laws import RateAndState
from asperity.friction.loading import STEP
from asperity.friction.records import Record
from asperity.protocols import Hold, Leg, Slide
from asperity.protocols.legs import legs_of


def slide_hold_slide(
    holds: ArrayLike,
    *,
    velocity: float,
    distance: float,
    run_in: float | None = None,
    direction: str | tuple[int, ...] = "x",
) -> list[Leg]:
    """Slide, and rest again and again, for static friction against hold time.

    Parameters
    ----------
    holds
        Times at rest, each above 0, in order. For a contact with units, these and the next arguments may be
        texts: ``["10 s", "3 min"]``, ``"1 um/s"``, ``"20 um"``.
    velocity
        Velocity of the slides (length/time), above 0.
    distance
        Distance of the slide after each hold (length), above 0: take several D_c, to forget the hold.
    run_in
        Distance of the slide before the first hold; by default `distance`.
    direction
        As in `asperity.protocols.Slide`.

    Returns
    -------
    list of Leg
        For `asperity.age`.
    """
    durations = units.numbers("holds", holds, "s")
    times = checks.positive("holds", checks.line("holds", durations)).tolist()
    if not times:
        raise InputError("holds", expected="one time or more", got="none")
    velocity = units.number("velocity", velocity, "m/s", above=0.0)  # finite: nothing ages in no time
    first = Slide(distance if run_in is None else run_in, velocity, direction)
    again = Slide(distance, velocity, direction)
    if isinstance(durations, list):  # these remember their units
        times = durations
    return [first, *(leg for time in times for leg in (Hold(time), again))]


def velocity_steps(
    velocities: ArrayLike, *, distance: float, direction: str | tuple[int, ...] = "x"
) -> list[Leg]:
    """Slide at one velocity after the other.

    Parameters
    ----------
    velocities
        Two or more (length/time), above 0, each different from the one before by 20 % or more.
    distance
        Distance at each velocity (length), above 0: take several D_c, until friction is steady.

    The direction and result are those of `slide_hold_slide`.
    """
    stated = units.numbers("velocities", velocities, "m/s")
    speeds = checks.positive("velocities", checks.line("velocities", stated)).tolist()
    differ = [max(before, after) > STEP * min(before, after) for before, after in pairwise(speeds)]
    if not differ or not all(differ):
        got = ", ".join(f"{speed:g}" for speed in speeds)
        expected = "two velocities or more, each other than the one before by 20 % or more"
        raise InputError("velocities", expected=expected, got=got)
    return [Slide(distance, speed, direction) for speed in speeds]


def synthetic_record(
    protocol: Sequence[Leg] | Leg,
    law: RateAndState,
    *,
    per_leg: int = 50,
    noise: float = 0.0,
    seed: int = 0,
    rng: int | np.random.Generator | None = None,
    strength_at_rest: bool = False,
    si: bool = True,
) -> Record:
    """Predict the record of a protocol by a law, with noise, to test a fit.

    Parameters
    ----------
    protocol
        Slides and holds; the record begins in steady sliding.
    per_leg
        Entries of each leg, at equal distances in time, 2 or more: only these show a constant velocity.
    noise
        Standard deviation of normal noise, independent from entry to entry.
    seed, rng
        Seed of the noise; or a numpy generator, which advances, or its seed.
    strength_at_rest, si
        As in `Record`.
    """
    checks.instance("law", law, RateAndState, "RateAndState(a=0.01, b=0.015, D_c=1e-5, mu_0=0.6, V_0=1e-6)")
    per_leg = checks.integer("per_leg", per_leg, least=2)
    noise = checks.number("noise", noise, least=0.0)
    time, velocity = [np.zeros(1)], []
    for leg in legs_of(protocol):
        if leg.target:
            raise InputError("protocol", expected="slides and holds", got=repr(leg))
        velocity.append(np.full(per_leg, leg.speed))
        time.append(time[-1][-1] + leg.duration * np.arange(1, per_leg + 1) / per_leg)
    times, velocities = np.concatenate(time), np.concatenate([velocity[0][:1], *velocity])
    random = checks.generator(seed, rng)
    friction = law.friction(times, velocities) + noise * random.standard_normal(times.size)
    return Record(
        times, velocities, friction, strength_at_rest=strength_at_rest, si=si, source="synthetic record"
    )
