"""What a figure of the reproduction is: a drawing, the numbers behind it, and the words under it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import pandas as pd
from matplotlib.figure import Figure

COLUMN = 3.4
"""Width of a journal column, inches."""

PAGE = 7.0
"""Width of a journal page, inches."""


@dataclass(frozen=True, eq=False)
class PaperFigure:
    """One figure of the paper, reproduced.

    Attributes
    ----------
    number
        Its number in the paper.
    title
        What it shows, in a few words.
    caption
        What one sees and under which conditions; plain text with the tags i, sub and sup of HTML.
    figure
        The drawing.
    tables
        The numbers behind every curve, by name; one row a point.
    """

    number: int
    title: str
    caption: str
    figure: Figure
    tables: Mapping[str, pd.DataFrame]
