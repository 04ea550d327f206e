"""Figures of results. Nothing is computed here, and no display is needed.

Each function returns a `matplotlib.figure.Figure`, as wide as a column or a page of a journal; `write` writes
it, and the drawn values as a table beside it.
"""

from asperity.base.calls import answered as _answered
from asperity.figures.aging import aging_curve
from asperity.figures.campaign import campaign_figure
from asperity.figures.cards import html_of
from asperity.figures.carried import carried_figure
from asperity.figures.contacts import contact_figure
from asperity.figures.fields import distribution_figure, patch_figure
from asperity.figures.film import Film, animate_history
from asperity.figures.fit import fit_figure
from asperity.figures.history import history_figure
from asperity.figures.law import law_figure
from asperity.figures.page import prediction_page, prediction_pictures
from asperity.figures.plots import plot_contact, plot_history, plot_kind, plot_spectrum, plot_surface
from asperity.figures.relaxation import relaxation_figure
from asperity.figures.sliding import sliding_figure
from asperity.figures.steady_sliding import steady_sliding_figure
from asperity.figures.style import Drawing
from asperity.figures.surface import surface_figure
from asperity.figures.writing import write

__all__ = [
    "Drawing",
    "Film",
    "aging_curve",
    "animate_history",
    "campaign_figure",
    "carried_figure",
    "contact_figure",
    "distribution_figure",
    "fit_figure",
    "history_figure",
    "html_of",
    "law_figure",
    "patch_figure",
    "plot_contact",
    "plot_history",
    "plot_kind",
    "plot_spectrum",
    "plot_surface",
    "prediction_page",
    "prediction_pictures",
    "relaxation_figure",
    "sliding_figure",
    "steady_sliding_figure",
    "surface_figure",
    "write",
]
__dir__ = _answered(globals())
