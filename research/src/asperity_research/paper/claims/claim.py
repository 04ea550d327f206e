"""A claim: a name, a statistic of the evidence, and the range in which its numbers bear the claim out.

What a claim says in sentences stands under its name in a text file beside the module of its statistic: the
place in the paper, the claim, what each number is (as the claim stands, or once corrected), the correction
and a note. The sentences may use the symbols and phrases of `wording`, the constants of
`measures` and of the statistic's module, and the facts of the numbers: each sentence on a number its own, the
others all, as ``numbers``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, cast

from asperity.fits import Estimate
from asperity_research.paper.claims import measures
from asperity_research.paper.wording import sentences, spelled
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Finding, Measurement


@dataclass(frozen=True)
class Number:
    """A number that decides a claim, by name: several may share a range and a sentence, which may need facts.

    The ends of the range are multiples of ``of``.
    """

    name: str
    estimate: Estimate
    facts: Mapping[str, object] = field(default_factory=dict)
    of: float = 1.0


Numbers = Iterator[Number]


@dataclass(frozen=True)
class Claim:
    """A claim of the paper: a statistic that gives its numbers, and the range of each name of a number.

    With a swept parameter ``each``, as ``"aging.k1"``, the statistic is called for each of its values, its
    second argument, which is a fact of its numbers.
    """

    name: str
    statistic: Callable[..., Numbers]
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
        words = self.sentences
        known = vars(measures) | self.statistic.__globals__
        shared = {name: known[name] for name in known if name.isupper()}
        shared["numbers"] = [one.facts for one, *_ in numbers]

        def spell(sentence: str, facts: Mapping[str, object]) -> str:
            return spelled(sentence, {**shared, **facts})

        def measured(part: str) -> tuple[Measurement, ...]:
            say = words.get(part, {})
            return tuple(
                Measurement(spell(say[one.name], one.facts), one.estimate, one.of * low, one.of * high)
                for one, low, high in numbers
                if one.name in say
            )

        return Finding(
            key=self.name,
            measured=measured("measured"),
            corrected=measured("corrected"),
            **{part: spell(words.get(part, ""), {}) for part in ("place", "claim", "correction", "note")},
        )

    def _numbers(self, evidence: Evidence) -> Numbers:
        if not self.each:
            yield from self.statistic(evidence)
            return
        study, parameter = self.each.split(".")
        for value in evidence.values(study, parameter):
            for one in self.statistic(evidence, value):
                yield replace(one, facts={parameter: value, **one.facts})
