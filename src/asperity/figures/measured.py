"""Measured values beside computed ones, and the ratio of both."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from asperity.base.calls import remark
from asperity.base.readable import written
from asperity.figures import style
from asperity.fits import Measurements
from asperity.lattice import Field


def draw_measured(
    grid: Sequence[Axes],
    series: Measurements,
    time: Field,
    computed: Field,
    factor: float,
    place: Callable[[Field], Field] = np.asarray,
    *,
    called: str = "computed",
) -> dict[str, object]:
    """Draw measured values with their errors into a panel, and in that below it measured over computed.

    Computed values, or what they are ``called``, are in the unit that is drawn: `factor` times those of the
    unit of the measured ones. Between their times they are interpolated over ln t; beyond these there is no
    ratio, and a `Remark` says so. `place` says where on the axis a time is. Returns columns of what it draws.
    """
    upper, lower = grid
    positive = time > 0
    later, between = np.log(np.maximum(series.time, 1e-300)), np.log(time[positive])
    beside = np.interp(later, between, computed[positive], left=np.nan, right=np.nan)
    if count := int(np.isnan(beside).sum()):
        span = " to ".join(written(float(end), series.time_unit) for end in time[positive][[0, -1]])
        text = f"{count} of {later.size} measured times are outside the computed ones, {span}, and have no "
        remark(f"{text}ratio measured / computed; try other first and last")
    at, value = place(series.time), factor * series.value
    error = None if series.stderr is None else factor * series.stderr
    look: dict[str, Any] = {"fmt": "D", "color": style.INK, "markerfacecolor": style.ORANGE}
    look |= {"markersize": 3.5, "elinewidth": 0.8, "capsize": 1.5, "zorder": 5}
    upper.errorbar(at, value, error, label="measured", **look)
    if called != "computed":  # the curve in the panel is not what they are compared with
        line: dict[str, Any] = {"color": style.GRAY, "linewidth": 1.0, "label": f"{called} for pixel rims"}
        upper.plot(place(time[positive]), computed[positive], "--", **line)
    low, high = upper.get_ylim()
    ends = (value, value) if error is None else (value - error, value + error)
    room = 0.05 * (high - low)
    upper.set_ylim(min(low, float(ends[0].min()) - room), max(high, float(ends[1].max()) + room))
    lower.errorbar(at, value / beside, None if error is None else error / beside, **look)
    lower.axhline(1, color=style.INK, linewidth=0.8)
    lower.set_ylabel(f"measured /\n{called}", multialignment="center")
    columns: dict[str, object] = {style.with_unit("measured: time", series.time_unit): series.time}
    columns |= {f"measured: {upper.get_ylabel()}": value, f"measured / {called}": value / beside}
    return columns if error is None else columns | {f"standard error: {upper.get_ylabel()}": error}
