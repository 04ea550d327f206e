"""Figures of results. Nothing is computed here, and no display is needed.

Each function returns a `matplotlib.figure.Figure`, as wide as a column or a page of a journal; `write` writes
it, and the drawn values as a table beside it.
"""

from asperity.base.calls import answered as _answered
from asperity.figures.aging import aging_curve as aging_curve
from asperity.figures.campaign import campaign_figure as campaign_figure
from asperity.figures.cards import html_of as html_of
from asperity.figures.carried import carried_figure as carried_figure
from asperity.figures.contacts import contact_figure as contact_figure
from asperity.figures.fields import distribution_figure as distribution_figure
from asperity.figures.fields import patch_figure as patch_figure
from asperity.figures.film import Film as Film
from asperity.figures.film import animate_history as animate_history
from asperity.figures.fit import fit_figure as fit_figure
from asperity.figures.history import history_figure as history_figure
from asperity.figures.law import law_figure as law_figure
from asperity.figures.page import prediction_page as prediction_page
from asperity.figures.page import prediction_pictures as prediction_pictures
from asperity.figures.plots import plot_contact as plot_contact
from asperity.figures.plots import plot_history as plot_history
from asperity.figures.plots import plot_kind as plot_kind
from asperity.figures.plots import plot_spectrum as plot_spectrum
from asperity.figures.plots import plot_surface as plot_surface
from asperity.figures.relaxation import relaxation_figure as relaxation_figure
from asperity.figures.sliding import sliding_figure as sliding_figure
from asperity.figures.steady_sliding import steady_sliding_figure as steady_sliding_figure
from asperity.figures.style import Drawing as Drawing
from asperity.figures.surface import surface_figure as surface_figure
from asperity.figures.writing import write as write

__dir__ = _answered(globals())
