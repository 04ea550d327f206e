"""Distributions of gap, contact pressure and patch size, at the first and the last moment that was kept."""

from __future__ import annotations

import json
import math

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.analysis import distributions
from asperity.base.words import power
from asperity.figures import style
from asperity.lattice import Field

_LOOKS = ((style.GRAY, "--"), (style.VERMILION, "-"))


def distribution_figure(dataset: xr.Dataset) -> Figure:
    """Draw which part of the surface has a larger gap, of the contact more pressure, of patches more area.

    Parameters
    ----------
    dataset
        The dataset of a `History` that kept fields; the first and the last of them are drawn.

    Returns
    -------
    Figure
        Without the pressure for solids that are defined on sites.

    Raises
    ------
    InputError
        The history kept no fields.
    """
    every = distributions(dataset)
    moments = [every[0], every[-1]][: len(every)]
    si, plane = bool(dataset.attrs.get("si")), dataset["heights"].ndim == 2
    cell = math.prod(json.loads(dataset.attrs["spacing"])) if si else 1
    gaps = [(one.gap, one.sites) for one in moments]
    sizes = [(cell * one.patch, one.patch.size) for one in moments]
    pressures = [(one.pressure, one.pressure.size) for one in moments if one.pressure is not None]
    panels: list[tuple[str, str, str, list[tuple[Field, int]]]] = [
        ("gap", "m", "surface", gaps),
        ("area of a patch" if si else "sites of a patch", "m^2" if plane else "m", "patches", sizes),
        *([("contact pressure", "Pa", "contact", pressures)] if pressures else []),
    ]
    figure = style.Drawing(figsize=(3.4 * len(panels), 3.4), layout="constrained")
    for axes, (name, unit, of_what, samples) in zip(figure.subplots(1, len(panels)), panels, strict=True):
        largest = max((float(values[-1]) for values, _ in samples if values.size), default=0.0)
        label, factor = style.scaled(name, unit if si else "1", largest)
        for moment, (values, whole), (color, dash) in zip(moments, samples, _LOOKS, strict=False):
            said = f"$t$ = ${power(moment.time)}${' s' if si else ''}"
            _draw(axes, factor * values, whole, color=color, linestyle=dash, label=said)
        axes.set_xlabel(label)
        axes.set_ylabel(f"part of the {of_what}\nwith as much or more")
        if "patch" in name:
            axes.set_xscale("log")
            axes.set_yscale("log")
        style.finish(axes)
    return figure


def _draw(axes: Axes, rising: Field, whole: int, **look: str) -> None:
    """Draw the part of the whole that has each value or more."""
    values, first = np.unique(rising, return_index=True)
    above = (rising.size - first) / max(whole, 1)
    axes.step(values, above, where="pre", linewidth=1.4, **look)  # type: ignore[arg-type]
