"""What a figure of the reproduction is: a drawing, the numbers behind it, and the words under it."""

from collections.abc import Mapping
from dataclasses import dataclass

import pandas as pd
from matplotlib.figure import Figure

from asperity_research.paper.studies import DELTA, HURST, SELF_AFFINE_RATIO
from asperity_research.paper.wording import sentences, spelled

COLUMN = 3.4  # Width of a journal column, inches
PAGE = 7.0  # Width of a journal page, inches


@dataclass(frozen=True, eq=False)
class PaperFigure:
    """One figure of the paper, reproduced: its number there, the drawing, and the words under it.

    The caption is plain text with the tags i, sub and sup of HTML. Tables hold the numbers behind every
    curve, one row a point.
    """

    number: int
    title: str
    caption: str
    figure: Figure
    tables: Mapping[str, pd.DataFrame]


def captioned(
    number: int, figure: Figure, tables: Mapping[str, pd.DataFrame], facts: Mapping[str, object]
) -> PaperFigure:
    """Give a drawing its title and caption, from ``captions.toml``, with the tables and other facts in it."""
    words = sentences("figures/captions.toml")[f"figure-{number}"]
    studied = {"HURST": HURST, "DELTA": DELTA, "SELF_AFFINE_RATIO": SELF_AFFINE_RATIO}
    caption = spelled(words["caption"], {**studied, **tables, **facts})
    return PaperFigure(number, words["title"], caption, figure, tables)
