"""Where things stand in the paper: its sections, its equations by the labels in their source, its figures."""

from __future__ import annotations

import re

SECTIONS = {
    "Abstract": "Abstract",
    "Section 1": "Introduction",
    "Section 2": "The model",
    "Section 3": "Uncorrelated roughness",
    "Section 4": "Self-affine surfaces",
    "Section 5": "Analytical results",
    "Section 6": "Summary and discussion",
    "Elsewhere": "Elsewhere",
}
"""The sections in order, and what they are about."""

EQUATIONS = {
    "e": 1, "us": 2, "u0s": 3, "a": 4, "log": 5, "uq": 6, "u": 8, "v0": 9,
    "du0": 10, "vt": 11, "ndet": 16, "ndet2": 17, "dosrs": 20,
}  # fmt: skip
"""Labels of equations in the paper's source, and their numbers in print."""

_EQUATION = re.compile(r"\bEqs?\. \(\w+\)(?:(?:, | and |, and )\(\w+\))*")
_LAST_EQUATION = {"Section 2": 3, "Section 3": 5, "Section 5": 17, "Section 6": 20}
_LAST_FIGURE = {"Section 2": 1, "Section 3": 3, "Section 4": 7, "Section 5": 8, "Section 6": 9}


def section_of(place: str) -> str:
    """Return the section, a key of `SECTIONS`, that a place such as "Fig. 3" or "Eq. (a)" belongs to."""
    if found := re.search(r"\bSections? ([1-6])\b", place):
        return f"Section {found[1]}"
    if place.lower().startswith("abstract"):
        return "Abstract"
    if found := re.search(r"\bFigs?\. (\d+)", place):
        return _holding(int(found[1]), _LAST_FIGURE)
    if found := re.search(r"\bEqs?\. \((\w+)\)", place):
        return _holding(EQUATIONS.get(found[1], 0), _LAST_EQUATION)
    return "Elsewhere"


def numbered(text: str) -> str:
    """Return a text in which equations go by their numbers in print: "Eqs. (uq), (u)" as "Eqs. (6), (8)"."""
    return _EQUATION.sub(
        lambda found: re.sub(r"\w+(?=\))", lambda label: str(EQUATIONS.get(label[0], label[0])), found[0]),
        text,
    )


def _holding(number: int, last: dict[str, int]) -> str:
    """Return the section that a numbered thing is in, by the last number of each section."""
    if number < 1:
        return "Elsewhere"
    return next((section for section, end in last.items() if number <= end), "Elsewhere")
