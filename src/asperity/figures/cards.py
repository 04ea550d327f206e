"""HTML by which notebooks show results: a small picture, numbers with units, and the certificate."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial, singledispatch
from html import escape
from typing import cast

import numpy as np
from matplotlib.axes import Axes

from asperity.base import views
from asperity.base.calls import showing
from asperity.base.readable import written
from asperity.base.rows import Row
from asperity.contact import Contact
from asperity.contact.publish import ACCEPTED_RESIDUAL
from asperity.figures import style
from asperity.figures.page import pixels, quantity
from asperity.figures.plots import plot_contact, plot_history, plot_surface
from asperity.figures.prediction import draw_growth
from asperity.figures.relaxation import draw_moduli
from asperity.fits import FitResult
from asperity.fits.rows import of_parameters
from asperity.prediction.results import Prediction
from asperity.relaxation import Fit, PronySeries
from asperity.results.history import History
from asperity.solids import Solid
from asperity.surfaces import Surface
from asperity.surfaces.provenance import lateral_unit

_SIZE, _DPI = (3.6, 3.3), 100
"""Size of a picture in inches, and its dots per inch."""

_MOST_BRANCHES = 8
"""Branches that a card lists."""

_OWN_UNITS = "Lengths are in the unit of the heights, forces in stiffness × height."


@singledispatch
def html_of(thing: object) -> str:
    """Write a result as HTML for a notebook.

    Parameters
    ----------
    thing
        A contact, history, surface, solid, prediction or fit.

    Raises
    ------
    TypeError
        It is anything else.
    """
    raise TypeError(f"no card for a {type(thing).__name__}")


views.defines(views.InNotebooks._html)(html_of)


@html_of.register
def _(contact: Contact) -> str:
    rows = [*_brief(contact.rows()), ("solid", _line(contact.solid))]
    proof = (
        f"The fields leave a residual of {contact.residual:.1e} of the mean contact force; "
        f"at most {ACCEPTED_RESIDUAL:.0e} is accepted."
    )
    own = "" if contact.si else _OWN_UNITS
    return _card("Contact", rows, partial(plot_contact, contact), proof, own)


@html_of.register
def _(history: History) -> str:
    data, final = history.dataset, history.final
    rows = _brief(history.rows())
    rows += [("maps", str(data.sizes.get("field_time", 0))), ("solid", _line(final.solid))]
    draw = partial(plot_history, data) if data["time"].values[-1] > 0 else None
    proof = f"Tolerance in time {data.attrs['rtol']:g}."
    return _card("History", rows, draw, proof, "" if final.si else _OWN_UNITS)


@html_of.register
def _(surface: Surface) -> str:
    measured, origin = surface.describe(), surface.provenance.get("file") or surface.provenance.get("kind")
    rows = [("from", str(origin))] if origin else []
    rows.append(("sites", " × ".join(map(str, surface.shape))))
    if surface.pixel_size is not None:
        lengths = lateral_unit(surface.length_unit, surface.provenance)
        rows.append(("pixels", " × ".join(_of(side, lengths) for side in surface.pixel_size)))
    ends = ", ".join(_of(height, measured.unit) for height in (measured.minimum, measured.maximum))
    rows += [
        ("rms height", _of(measured.rms_height, measured.unit)),
        ("rms slope", _of(measured.rms_slope, measured.slope_unit)),
        ("lowest, highest", ends),
        ("edges", surface.edges),
    ]
    return _card("Surface", rows, partial(plot_surface, surface), *surface.remarks)


@html_of.register
def _(solid: Solid) -> str:
    rows = [("kind", solid.kind.replace("_", " "))]
    pairs = tuple(solid.relaxing)
    rows += [(name, _number(value)) for name, value in solid.parameters.items() if value != pairs]
    rows += [(f"share {share:.3g}", f"relaxes in {time:.3g}") for share, time in pairs[:_MOST_BRANCHES]]
    if len(pairs) > _MOST_BRANCHES:
        rows.append(("and", f"{len(pairs) - _MOST_BRANCHES} more branches"))
    note = "Moduli in Pa, times in s, lengths in m under a surface with units." if solid.in_lengths else ""
    return _card("Solid", rows, partial(_draw_relaxation, pairs) if pairs else None, note)


def _draw_relaxation(pairs: tuple[tuple[float, float], ...], axes: Axes) -> None:
    t = np.geomspace(0.03 * pairs[0][1], 30 * pairs[-1][1], 200)
    axes.semilogx(t, PronySeries(1.0, pairs).modulus_at(t), color=style.BLUE)
    axes.set(ylim=(0, 1.05), xlabel="time", ylabel="modulus over the instantaneous one")


@html_of.register
def _(fit: FitResult) -> str:
    rows = [(row.name.strip(), row.words()) for row in of_parameters(fit)]
    return _card(type(fit).__name__, [("points", str(fit.points)), *rows], None)


@html_of.register
def _(fit: Fit) -> str:
    series = fit.series
    first, last = (quantity(time, "s") for time in fit.data.span)
    rows = [
        ("branches", str(len(series.branches))),
        ("times", f"{first} to {last}"),
        ("instantaneous modulus", quantity(series.modulus, "Pa")),
        ("deviations", f"{100 * fit.rms:.2g} % rms, {100 * series.error:.2g} % at most"),
    ]
    return _card("Fit of relaxation", rows, lambda axes: draw_moduli(axes, fit))


@html_of.register
def _(prediction: Prediction) -> str:
    def draw(axes: Axes) -> None:
        draw_growth(axes, prediction)
        axes.set_xlabel("time under load [s]")
        style.legend_below(cast(style.Drawing, axes.figure), axes)

    return _card("Prediction", _brief(prediction.rows()), draw, *prediction.remarks)


def _brief(rows: Iterable[Row]) -> list[tuple[str, str]]:
    return [(row.name, row.words(style.spaced)) for row in rows if row.brief]


def _line(solid: Solid) -> str:
    return repr(solid).removeprefix("<Solid: ").removesuffix(">")


def _of(value: float, unit: str) -> str:
    text = style.spaced(written(value, unit))
    return text if unit == "1" or " " in text or "\u00a0" in text else f"{text} {style.spelled(unit)}"


def _number(value: object) -> str:
    if isinstance(value, tuple):
        return ", ".join(map(_number, value))
    return f"{value:.6g}" if isinstance(value, float) else str(value)


_NAME = "text-align:left;font-weight:normal;opacity:.75;padding-right:1em;white-space:nowrap"
_NOTE = "font-size:smaller;opacity:.75"


def _card(
    title: str, rows: Iterable[tuple[str, str]], draw: Callable[[Axes], object] | None, *notes: str
) -> str:
    """Lay out a picture beside a table, with sentences below; colors are those of the notebook."""
    cells = "".join(
        f'<tr><th style="{_NAME}">{escape(name)}</th><td style="text-align:left">{escape(value)}</td></tr>'
        for name, value in rows
    )
    sentences = "".join(f'<div style="{_NOTE};max-width:36em">{escape(note)}</div>' for note in notes if note)
    picture = ""
    if draw is not None:
        figure, (axes,) = style.stacked(_SIZE, 1)
        with showing(f"the picture of the card {title!r}"):
            draw(axes)
            axes.set_title("")
            picture = f'<img alt="{escape(title)}" src="{pixels(figure, dpi=_DPI)}">'
    return (
        '<div style="display:flex;flex-wrap:wrap;gap:1em;align-items:center">'
        f"{picture}<div><b>{escape(title)}</b><table>{cells}</table>{sentences}</div></div>"
    )
