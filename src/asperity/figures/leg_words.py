"""What the legs of a history do, in words with units."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from asperity.analysis.legs import LegRow
from asperity.protocols import Hold, Leg, Ramp, Repeat, Slide, Step

Say = Callable[[str, float], str]
"""Writes a value of a series."""


def listed(protocol: Iterable[Leg], say: Say) -> str:
    """Say what the legs of a protocol do."""
    return ", ".join(said(leg, say) for leg in protocol)


def said(leg: Leg, say: Say) -> str:
    """Say what a leg does."""
    if isinstance(leg, Repeat):
        return f"{leg.count} × ({listed(leg.legs, say)})"
    if isinstance(leg, Step):
        return f"step to {_target(leg, say)}"
    if isinstance(leg, Slide):
        far = say("displacement", leg.distance)
        return f"slide {far} at " + (say("velocity", leg.velocity) if leg.duration else "once")
    assert isinstance(leg, Hold | Ramp)
    what = f"ramp to {_target(leg, say)} in" if isinstance(leg, Ramp) else "hold for"
    if isinstance(leg, Hold) and leg.hold:
        what = f"hold {leg.hold} for"
    faster = f", mobility\u00a0×\u00a0{leg.mobility:.5g}" if leg.mobility != 1 else ""
    return f"{what} {say('time', leg.duration)}{faster}"


def _target(leg: Ramp | Step, say: Say) -> str:
    quantity = "mean_contact_pressure" if leg.target == "pressure" else leg.target
    return f"{leg.target} {_signed(getattr(leg, leg.target), quantity, say)}"


def jump(row: LegRow, say: Say) -> str:
    """Say what changes at once, from what to what."""
    if isinstance(row.leg, Slide):
        return said(row.leg, say)
    by_load = isinstance(row.leg, Step) and row.leg.target in ("load", "pressure")
    name, (before, after) = ("load", row.load) if by_load else ("separation", row.separation)
    return f"{name} {_signed(before, name, say)}\u00a0→\u00a0{_signed(after, name, say)}"


def _signed(value: float, name: str, say: Say) -> str:
    return say(name, value).replace("-", "\u2212")
