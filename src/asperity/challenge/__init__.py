"""Reference problems with certified answers, for any code that computes contact and its aging."""

from asperity.challenge.picture import score_figure
from asperity.challenge.posing import NAMES, Answer, Column, Problem, problem, problems
from asperity.challenge.scoring import QuantityScore, Score, score
from asperity.challenge.solving import solve
from asperity.challenge.writing import write

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
