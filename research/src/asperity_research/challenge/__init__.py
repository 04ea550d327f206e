"""Reference problems with certified answers, for any code that computes contact and its aging."""

from asperity_research.challenge.picture import score_figure
from asperity_research.challenge.posing import NAMES, Answer, Column, Problem, problem, problems
from asperity_research.challenge.scoring import QuantityScore, Score, score
from asperity_research.challenge.solving import solve
from asperity_research.challenge.writing import write

__all__ = [
    "NAMES",
    "Answer",
    "Column",
    "Problem",
    "QuantityScore",
    "Score",
    "problem",
    "problems",
    "score",
    "score_figure",
    "solve",
    "write",
]
__dir__ = __all__.copy  # dir() lists the public names alone
