"""A prediction as one page of words and pictures that needs no network: what a referee would ask for."""

from __future__ import annotations

import base64
import datetime
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from io import BytesIO
from pathlib import Path
from typing import Any

import jinja2
from matplotlib.figure import Figure

from asperity.analysis.bands import rows_of_maps
from asperity.analysis.prediction import Prediction
from asperity.analysis.scan import understood, written
from asperity.base import checks
from asperity.base.version import __version__
from asperity.figures import prediction as drawn
from asperity.figures.carried import carried_figure
from asperity.figures.history import history_figure
from asperity.figures.relaxation import relaxation_figure
from asperity.fits import Measurements
from asperity.surfaces import statistics

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True, eq=False)
class Picture:
    """A figure, and what it shows."""

    caption: str
    figure: Figure

    @cached_property
    def png(self) -> bytes:
        """Its pixels."""
        return pixels(self.figure)

    @property
    def width(self) -> str:
        """Its width on a page whose letters are larger than those of a journal."""
        return f"{1.4 * self.figure.get_figwidth():.2f}in"

    @property
    def data(self) -> str:
        """The pixels as text."""
        return base64.b64encode(self.png).decode("ascii")


def prediction_pictures(
    prediction: Prediction, *, measured: Measurements | Path | str | None = None
) -> dict[str, Picture]:
    """Draw a prediction.

    Parameters
    ----------
    prediction
        From `asperity.predict`.
    measured
        A measured area against time, a table with units, to be drawn too.

    Returns
    -------
    dict
        Pictures by the names of their files, without suffix, in the order of the page.

    Raises
    ------
    InputError
        What was measured is no area.
    """
    checks.instance("prediction", prediction, Prediction, "asperity.predict(...)")
    friction = "" if prediction.friction is None else " Bottom: the coefficient of static friction."
    beside, ratio = "", ""
    if measured is not None:
        ratio = " Diamonds: measured, and below them the ratio to what is computed."
    if prediction.effective_load is not None:
        name, symbol = prediction.beside
        beside = (
            f". Dotted: the first area times the {name} {symbol}(t)/{symbol}(first), as the area of light "
            "contacts goes. "
            "Dashed: Persson's theory for a random surface of the same rms slope [7], about a fifth below "
            "simulations of light contacts [8]: compare how it grows"
        )
    elif prediction.theory is not None:
        beside = ", beside that of contacts that flow and bear all of the load, d ln A/d ln t = s0/s"
    captions: dict[str, tuple[Figure, str]] = {}
    if prediction.growth is None:
        text = f"Load and real contact area, leg by leg, with the 95 % band of the area.{ratio}"
        captions["history"] = history_figure(prediction.dataset, measured), text
    else:
        text = f"Real contact area against time, with its 95 % band{beside}.{ratio} Below: its growth in "
        text += f"each decade, and the 95 % band of the mean over all.{friction}"
        captions["growth"] = drawn.growth_figure(prediction, measured), text
    captions |= {
        "contacts": (
            drawn.contact_maps_figure(prediction),
            "Where the scan touches, on the scan as measured, and the contact pressure there, at the first "
            "and the last time.",
        ),
        "pressure": (
            drawn.pressure_figure(prediction),
            "Distribution of the contact pressure over the contact area; dotted: means. The highest 2 % is "
            "beyond the axis.",
        ),
    }
    if "normal_stiffness" in prediction.dataset:
        captions["carried"] = (
            carried_figure(prediction.dataset),
            "Stiffness and resistance of the constrictions, from the contacts at "
            "each time (docs/carried.md).",
        )
    if prediction.fit is not None:
        captions["relaxation"] = (
            relaxation_figure(prediction.fit),
            "The relaxation table, the sum of exponentials that stands for it, what that misses, and its "
            "branches.",
        )
    if prediction.observed:
        captions["observed"] = (
            drawn.observed_figure(prediction),
            "The contact at the last time, its image in the instrument, and what of it counts as contact.",
        )
    return {name: Picture(caption, figure) for name, (figure, caption) in captions.items()}


def prediction_page(prediction: Prediction, pictures: Mapping[str, Picture], *, command: str = "") -> str:
    """Write a prediction as a page of HTML.

    Parameters
    ----------
    prediction
        From `asperity.predict`.
    pictures
        From `prediction_pictures`.
    command
        The command line that made it; may be empty.

    Returns
    -------
    str
    """
    checks.instance("prediction", prediction, Prediction, "asperity.predict(...)")
    dataset, scan, fit, relaxing = prediction.dataset, prediction.origin, prediction.fit, prediction.relaxing
    shown = (
        *("file", "sha256", "reader", "undefined_pixels"),
        *("despiked_pixels", "tilt_rule", "periodic_rule", "lines_rule"),
    )
    shape, rows = dataset["heights"].shape, _rows(prediction)
    return written_page(
        "prediction.html",
        p=prediction,
        command=command,
        scan={name: scan.get(name) for name in shown} | {"file": scan.get("file") or "the surface"},
        understood=understood(scan),
        measures=statistics(dataset["heights"].values, prediction.spacing),
        shape=shape,
        sides=[n * side for n, side in zip(shape, prediction.spacing, strict=True)],
        edges=dataset.attrs["edges"],
        exact=dataset.attrs.get("exact_contact", ""),
        residual_power=-math.ceil(math.log10(max(float(dataset["residual"].max()), 1e-16))),
        intervals=None if fit is None else fit.intervals,
        late_modulus=None if relaxing is None else float(relaxing.modulus_at(rows[-1]["time"])),
        series=None if fit is None else fit.series,
        rows=rows,
        pictures=list(pictures.values()),
    )


def written_page(name: str, **values: Any) -> str:
    """Fill in a template, which knows the version and the date, too."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("asperity.figures", "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["measured"] = quantity
    date = datetime.datetime.now(datetime.UTC).date().isoformat()
    return environment.get_template(name).render(version=__version__, date=date, **values)


def quantity(value: float, unit: str, digits: int = 3) -> str:
    """Write an SI quantity with a prefix as it is printed: 5 MPa, 1610 nm², 10⁶ s."""
    number, name = written(value, unit, digits).split(" ")
    if "e" in number:
        mantissa, ten = number.split("e")
        raised = str(int(ten)).translate(_RAISED)
        number = f"{mantissa} × 10{raised}"
    return f"{number.removeprefix('1 × ')} {name.replace('^2', '²').replace('u', 'µ')}"


def _rows(prediction: Prediction) -> list[dict[str, Any]]:
    """What is known at the times of the maps; SI units."""
    dataset, effective = prediction.dataset, prediction.effective_load
    force, friction = prediction.friction_force, prediction.friction
    first = prediction.series("contact_area_corrected")[0]
    rows = []
    low, high = prediction.band("contact_area_corrected")
    for row, resolved in zip(rows_of_maps(dataset), prediction.resolved, strict=True):
        place, state = row - 1, dataset.isel(time=row)
        corrected = float(state["contact_area_corrected"])
        rows.append(
            {
                "time": float(state["time"]),
                "counted": float(state["contact_area"]),
                "corrected": corrected,
                "band": (float(low[place]), float(high[place])),
                "load": float(state["load"]),
                "fraction": corrected / prediction.nominal_area,
                "grown": corrected / first,
                "effective": None if effective is None else float(effective[place] / effective[0]),
                "contact_pressure": float(state["mean_contact_pressure"]),
                "largest_pressure": float(state["largest_pressure"]),
                "gap": float(state["mean_gap"]),
                "friction": None if friction is None else float(friction[place]),
                "friction_force": None if force is None else float(force[place]),
                "resolved": resolved,
            }
        )
    return rows


def pixels(figure: Figure, **options: Any) -> bytes:
    """Draw a figure as PNG, with options of its ``savefig``."""
    stream = BytesIO()
    figure.savefig(stream, format="png", **options)
    return stream.getvalue()
