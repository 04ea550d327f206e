"""What is given in place of a result, a problem or a study is refused in words, whatever it is."""

import inspect
import itertools
from collections.abc import Callable
from typing import Any

import pytest
from tests.refusals import refuses
from tests.unit.test_public_calls import WRONG

import asperity_research.challenge as challenge
import asperity_research.experiments as experiments
import asperity_research.studies as studies
from asperity.errors import InputError

FUNCTIONS = (
    *(challenge.score, challenge.score_figure, challenge.problem, challenge.solve),
    *(studies.conclude, studies.named, studies.run),
    *(experiments.load, experiments.run),
)


@pytest.mark.parametrize("function", FUNCTIONS)
def test_a_wrong_thing_is_refused(function: Callable[..., Any]) -> None:
    needed = [one for one in inspect.signature(function).parameters.values() if one.default is one.empty]
    for wrong in WRONG:
        with pytest.raises(InputError) as raised:
            function(**{one.name: wrong for one in needed})
        assert "\n" not in str(raised.value)


def test_the_problem_is_looked_up_before_the_answer() -> None:
    for result, name in itertools.product(({}, {"time": [1.0]}), ("nope", "dens")):
        with refuses("problem"):
            challenge.score(result, name)
    with refuses("result", "none"):
        challenge.score({}, "dense")


def test_a_study_goes_by_its_name() -> None:
    with pytest.raises(InputError, match="got 'unlaoding'; try unloading"):
        studies.run("unlaoding", "nowhere")
