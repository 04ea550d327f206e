"""The nine figures of the paper, drawn anew, with the numbers behind them."""

from asperity_research.paper.figures.area import figure_2, figure_5
from asperity_research.paper.figures.growth import figure_3, figure_6
from asperity_research.paper.figures.indentation import figure_8, figure_9
from asperity_research.paper.figures.maps import figure_4, figure_7
from asperity_research.paper.figures.paper_figure import PaperFigure
from asperity_research.paper.figures.sketch import figure_1
from asperity_research.studies.evidence import Evidence


def draw(evidence: Evidence) -> tuple[PaperFigure, ...]:
    """Draw all figures from the finished studies."""
    drawings = (figure_1, figure_2, figure_3, figure_4, figure_5, figure_6, figure_7, figure_8, figure_9)
    return tuple(drawing(evidence) for drawing in drawings)
