"""What is asked of a prediction: its times, its loading, its table; checked before anything is computed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

from asperity.app.config import RunConfig
from asperity.app.config.models import Contact as ContactSection
from asperity.app.runs.defaults import hold_times
from asperity.base import checks, units
from asperity.errors import InputError
from asperity.lattice import Field
from asperity.protocols import Hold, Ramp
from asperity.relaxation import Fit, PronySeries, check_branches
from asperity.solids import Solid

LEAST_TIMES = 5
RUN = "asperity run, which takes the same file"


def quantity(name: str, given: object, unit: str) -> float:
    """Read a number above 0, in SI or with a unit."""
    return checks.number(name, units.quantity(given, unit, name), above=0, expected=f"more than 0 {unit}")


def series_with(
    draws: Sequence[Iterable[Sequence[float | str]]] | None, solid: Solid
) -> tuple[PronySeries, ...]:
    """The series of a solid, and then those with other branches that it may have; empty without draws."""
    if draws is None:
        return ()
    if not (solid.modulus and solid.relaxing):
        raise InputError("draws", expected="branches of the solid, in whose place they may be", got="none")
    if not hasattr(draws, "__len__") or len(draws) < 2:
        raise InputError("draws", expected="2 lists of branches or more", got=checks.shown(draws))
    modulus = solid.modulus
    found = [PronySeries(modulus, tuple(solid.relaxing))]
    for number, branches in enumerate(draws):
        try:
            found.append(PronySeries(modulus, check_branches(branches)))
        except InputError as error:
            name = f"draws[{number}]: {error.name}"
            raise InputError(name, expected=error.expected, got=error.got, advice=error.advice) from None
    return tuple(found)


def times_within(
    found: Fit | None,
    first: float | str | None,
    last: float | str | None,
    per_decade: int,
    ramp: float,
) -> Field:
    """Times to record: of the table, and no others but on a plateau after it."""
    if found is None and (first is None or last is None):
        name, expected = "first" if first is None else "last", "a time, for no table spans any"
        raise InputError(name, expected=expected, got="none", advice='first="1 ms", last="10 days"')
    begin, end = (0.0, math.inf) if found is None else found.series.span
    stop = found.data.span[1] if found is not None and last is None else quantity("last", last, "s")
    check_ramp(ramp, stop)
    start = max(begin, ramp) if first is None else quantity("first", first, "s")
    if not start < stop:
        raise InputError("last", expected=f"a time after the first, {start:.4g} s", got=f"{stop:.4g} s")
    for name, time in (("first", start), ("last", stop)):
        if not begin * (1 - 1e-9) <= time <= end * (1 + 1e-9):
            expected = f"a time that the table spans, {begin:.3g} s to {end:.3g} s"
            advice = "extrapolate=plateau" if time > end else "a table of more decades"
            raise InputError(name, expected=expected, got=f"{time:.4g} s", advice=advice)
    check_span("last", start, stop)
    least = math.ceil(LEAST_TIMES / math.log10(stop / start))
    return hold_times(first=start, last=stop, per_decade=max(per_decade, least))


def check_ramp(ramp: float, last: float) -> None:
    """Refuse a loading that is not over by the last time."""
    if ramp >= last:
        expected = f"less than the last time, {last:.4g} s"
        raise InputError("ramp", expected=expected, got=f"{ramp:.4g} s", advice=f'last="{10 * ramp:g} s"')


def check_span(name: str, first: float, last: float) -> None:
    """Refuse times in less than a decade, of which no growth per decade can be told."""
    if last < 10 * first * (1 - 1e-9):
        expected = "times that span a decade or more"
        advice = f'last="{10 * first:g} s"' if name.endswith("last") else "later times"
        raise InputError(name, expected=expected, got=f"{first:.4g} s to {last:.4g} s", advice=advice)


def instrument_of(
    pixel: float | str | None = None, blur: float | str | None = None, threshold: float = 0.5
) -> dict[str, Any]:
    """What looks at the contact, for `asperity.observe`; empty for none."""
    if pixel is None and blur is None:
        return {}
    return {"pixel": pixel, "blur": 0.0 if blur is None else blur, "threshold": threshold}


def loading_of(config: RunConfig, ramp: float) -> tuple[RunConfig, float]:
    """A load with the ramp that puts it on, where a protocol says them; any other protocol is refused."""
    match config.legs:
        case ():
            return config, ramp
        case (Ramp(separation=None, approach=None) as up, Hold(hold=None | "load") as held) if (
            config.contact.load == 0 and not ramp and up.mobility == held.mobility == 1
        ):
            asked = {
                "contact": ContactSection(load=up.load, pressure=up.pressure),
                "aging": config.aging.model_copy(update={"last": up.duration + held.duration}),
                "protocol": [],
            }
            return config.model_copy(update=asked), up.duration
    raise no_protocol("[[protocol]]", RUN, ", or a ramp from load 0 and a hold")


def no_protocol(name: str, advice: str, otherwise: str = "") -> InputError:
    """What is said of slides and of loads that change."""
    expected = f"none{otherwise}, for a prediction is of a load that stays"
    return InputError(name, expected=expected, got="legs", advice=advice)


def no_half_space(name: str, kind: str) -> InputError:
    """What is said of other solids."""
    advice = "asperity run, or asperity.press and asperity.age, which follow it without a band"
    return InputError(name, expected="a relaxation table or a half_space", got=kind, advice=advice)
