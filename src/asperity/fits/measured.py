"""The growth of a measured quantity with hold time: laws, rates, and which law the data prefer.

The quantity is contact area or static friction, in a table. For the history of a simulation, take
`asperity.analysis.aging`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from asperity.base import checks, views
from asperity.base.rows import Row
from asperity.base.words import counted
from asperity.errors import ConvergenceError, InputError
from asperity.fits import rows
from asperity.fits.comparison import Comparison, compared
from asperity.fits.curve import Curve, Series, refuse_decline
from asperity.fits.laws import LogarithmFit, SaturationFit, logarithm, saturation
from asperity.fits.rate import GrowthRate, growth_rate

Law = Literal["saturation", "logarithm"]
_FEW_ENOUGH = 1000  # points above which means over bins are shown
_WORTH = 0.5  # share of independent values below which standard errors get a remark
_SHOWN_BINS = 100


@dataclass(frozen=True, eq=False, repr=False)
class MeasuredGrowth(views.Brief, views.Pictured):
    """Fits to a table of values against hold time.

    Attributes
    ----------
    points, initial_points
        Number of values, and of values at time 0.
    fits, comparison
        The laws that could be fitted, by name; which of two the data prefer, or None.
    rate
        Slopes over the window; None if it has too few points.
    initial_from
        Origin of A(0) of the rate: ``"time 0"``, or the name of a law; "" if the times do not determine the
        t0 of this law, so that `rate.B` has no meaning.
    notes
        Failures and remarks.
    shown, shown_are_means
        Values after time 0 for figures, with their standard errors if these are known; whether they are means
        over bins of equal width in ln t.
    """

    points: int
    initial_points: int
    fits: Mapping[Law, SaturationFit | LogarithmFit]
    comparison: Comparison | None
    rate: GrowthRate | None
    initial_from: str
    notes: tuple[str, ...]
    shown: Series
    shown_are_means: bool

    def rows(self, /, unit: str = "") -> list[Row]:
        """Rows of a summary: data, laws with their 95 % intervals, comparison; times have this unit."""
        zeros = f", {self.initial_points} of them at time 0" if self.initial_points else ""
        span = f"{self.shown.x[0]:g} to {self.shown.x[-1]:g} {unit}".rstrip()
        data = Row("data", f"{counted(self.points, 'value')}{zeros}; times {span}")
        laws = [row for law, fit in self.fits.items() for row in rows.of_law(law, fit, unit)]
        line = [] if self.rate is None else [*rows.of_line(self.rate, self.initial_from, unit)]
        # Where the laws are not determined, the straight line is all that the data say.
        fitted = laws + line if self.initial_from else line + laws
        preferred = [] if self.comparison is None else rows.of_comparison(self.comparison)
        return [data, *fitted, *preferred, *(Row("note", note) for note in self.notes)]


def measured_growth(
    time: ArrayLike,
    value: ArrayLike,
    *,
    stderr: ArrayLike | None = None,
    laws: Sequence[Law] = ("saturation", "logarithm"),
    first: float | None = None,
    last: float | None = None,
    name: str = "value",
) -> MeasuredGrowth:
    """Fit laws of growth to measured values, and compare them.

    Parameters
    ----------
    time, value, stderr
        Hold times, values above 0 and, if known, their standard errors, as for `asperity.fits.saturation`.
    laws
        The laws to fit.
    first, last
        Window for the straight line in ln t; the laws are fitted to all values.
    name
        Name of the values in messages.

    Raises
    ------
    InputError, ConvergenceError
        No law could be fitted.
    """
    series = Series.checked(time, value, stderr, ("time", name, "stderr"))
    first, last = (None if t is None else checks.number(n, t) for n, t in (("first", first), ("last", last)))
    if series.x.size > 2:  # messages of the fits would call the values areas
        refuse_decline(series, name)
    if not laws or not set(laws) <= set(get_args(Law)):
        raise InputError("laws", expected=f"some of {', '.join(get_args(Law))}", got=checks.shown(laws))
    fits, comparison, notes = _fits(series, laws)
    zeros = int(np.searchsorted(series.x, 0.0, side="right"))
    later = series.where(series.x > 0)
    rate, initial_from, remark = _rate(series, fits, initial_measured=zeros > 0, first=first, last=last)
    notes += [remark] if remark else []
    if comparison is not None and (worth := comparison.effective_points / series.x.size) < _WORTH:
        notes.append(
            "the misfit of the laws is systematic, but the standard errors assume random scatter: "
            f"they are too small by a factor of about {worth**-0.5:.2g}"
        )
    means = later.x.size > _FEW_ENOUGH
    shown = later.binned(_SHOWN_BINS) if means else later
    if stderr is None:
        shown = replace(shown, stderr=None)
    return MeasuredGrowth(
        points=series.x.size,
        initial_points=zeros,
        fits=fits,
        comparison=comparison,
        rate=rate,
        initial_from=initial_from,
        notes=tuple(notes),
        shown=shown,
        shown_are_means=means,
    )


def _fits(
    series: Series, laws: Sequence[Law]
) -> tuple[dict[Law, SaturationFit | LogarithmFit], Comparison | None, list[str]]:
    """Fit the laws, with a note on each that fails unless all do."""
    data = (series.x, series.y, series.stderr)
    fits: dict[Law, SaturationFit | LogarithmFit] = {}
    comparison, notes = None, []
    for law in laws:
        try:
            fits[law] = saturation(*data) if law == "saturation" else logarithm(*data)
        except (InputError, ConvergenceError) as error:
            if not fits and law == laws[-1]:
                raise
            notes.append(f"{law}: no fit: {error}")
    log, power = fits.get("logarithm"), fits.get("saturation")
    if isinstance(log, LogarithmFit) and isinstance(power, SaturationFit):
        try:
            comparison = compared(Curve.checked(*data, parameters=3), log, power)
        except InputError as error:
            notes.append(f"no comparison: {error}")
    return fits, comparison, notes


def _rate(
    series: Series,
    fits: Mapping[Law, SaturationFit | LogarithmFit],
    *,
    initial_measured: bool,
    first: float | None,
    last: float | None,
) -> tuple[GrowthRate | None, str, str]:
    """Slopes over the window, the origin of their A(0), and a remark or ""."""
    law: Law = "logarithm" if "logarithm" in fits else "saturation"
    fit = fits[law]
    initial, error_of_it = (None, 0.0) if initial_measured else (fit.initial_area, fit.initial_area_stderr)
    how: dict[str, Any] = {"stderr": series.stderr, "initial": initial, "initial_stderr": error_of_it}
    try:
        rate = growth_rate(series.x, series.y, first, last, **how)
    except InputError as error:
        return None, "", f"no straight line: {error}"
    low, _ = rate.interval("slope")
    remark = "" if low > 0 else "the growth is not significant: the 95 % interval of the slope contains 0"
    # If t0 is undetermined, so is A(0): in the valley of t0 its standard error is too small.
    source = law if fit.t0_stderr < fit.t0 else ""
    return rate, "time 0" if initial_measured else source, remark
