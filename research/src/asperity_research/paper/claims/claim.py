"""A claim: a name, a statistic of the evidence, and the range in which its numbers bear the claim out.

What a claim says in sentences stands under its name in a text file beside the module of its statistic: the
place in the paper, the claim, what each number is (as the claim stands, or once corrected), the correction
and a note. The sentences may use the symbols and phrases of `wording`, the constants of
`measures` and of the statistic's module, and the facts of the numbers: each sentence on a number its own, the
others all, as ``numbers``.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, cast

from asperity_research.paper.claims import measures
from asperity_research.paper.claims.measures import Numbers
from asperity_research.paper.wording import sentences, spelled
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Finding, Measurement

Statistic = Callable[..., Numbers]


@dataclass(frozen=True)
class Claim:
    """A claim of the paper: a statistic that gives its numbers, and the range of each name of a number.

    With a swept parameter ``each``, as ``"aging.k1"``, the statistic is called for each of its values, its
    second argument, which is a fact of its numbers.
    """

    name: str
    statistic: Statistic
    ranges: Mapping[str, tuple[float, float]]
    each: str = ""

    @property
    def sentences(self) -> dict[str, Any]:
        """What the text file has on the claim: numbers by name, under `measured` and `corrected`."""
        group = self.statistic.__module__.rpartition(".")[2]
        return cast(dict[str, Any], sentences(f"claims/{group}.toml")[self.name])

    def judge(self, evidence: Evidence) -> Finding:
        """Compute the numbers, and put them into words beside their ranges."""
        numbers = [(one, *self.ranges[one.name]) for one in self._numbers(evidence)]
        names = vars(measures) | self.statistic.__globals__
        shared = {name: names[name] for name in names if name.isupper()}
        shared["numbers"] = [one.facts for one, *_ in numbers]
        words = self.sentences

        def measured(part: str) -> tuple[Measurement, ...]:
            say = words.get(part, {})
            return tuple(
                Measurement(
                    spelled(say[one.name], {**shared, **one.facts}), one.estimate, one.of * low, one.of * high
                )
                for one, low, high in numbers
                if one.name in say
            )

        texts = ("place", "claim", "correction", "note")
        sentences = {text: spelled(words.get(text, ""), shared) for text in texts}
        return Finding(self.name, measured=measured("measured"), corrected=measured("corrected"), **sentences)

    def _numbers(self, evidence: Evidence) -> Numbers:
        if not self.each:
            yield from self.statistic(evidence)
            return
        study, parameter = self.each.split(".")
        for value in evidence.values(study, parameter):
            for one in self.statistic(evidence, value):
                yield replace(one, facts={parameter: value, **one.facts})


CLAIMS: dict[str, Claim] = {}  # All claims by name, in the order of the paper's sections


def claim(name: str, *, each: str = "", **ranges: tuple[float, float]) -> Callable[[Statistic], Statistic]:
    """Make the claim of a name with the statistic below."""

    def add(statistic: Statistic) -> Statistic:
        CLAIMS[name] = Claim(name, statistic, ranges, each)
        return statistic

    return add
