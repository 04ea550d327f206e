"""Questions that take the file of a run, and have keys beside those of its sections."""

from __future__ import annotations

from asperity.ask.contact_law import Law
from asperity.ask.prediction import Predict
from asperity.ask.question import Question
from asperity.ask.section import KINDS
from asperity.ask.sliding import SteadySliding

QUESTIONS: dict[str, type[Question]] = {"prediction": Predict, "law": Law, "sliding": SteadySliding}
"""Questions by the section of a file that has their own keys, and makes it theirs."""


def question_named(name: str) -> type[Question]:
    """The question of a section; that of a run for an empty name."""
    return QUESTIONS.get(name, Question)


KINDS.update({name: {"": question.section(name)} for name, question in QUESTIONS.items()})
