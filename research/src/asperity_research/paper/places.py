"""Where things stand in the paper: its sections, and its equations by the labels in their source."""

import re

SECTIONS = {
    "Section 1": "Introduction",
    "Section 2": "The model",
    "Section 3": "Uncorrelated roughness",
    "Section 4": "Self-affine surfaces",
    "Section 5": "Analytical results",
    "Section 6": "Summary and discussion",
}
"""The sections in order, and what they are about."""

EQUATIONS = {
    "e": 1, "us": 2, "u0s": 3, "a": 4, "log": 5, "uq": 6, "u": 8, "v0": 9,
    "du0": 10, "vt": 11, "ndet": 16, "ndet2": 17, "dosrs": 20,
}  # fmt: skip
"""Labels of equations in the paper's source, and their numbers in print."""

_FIGURES = [f"Section {number}" for number in "233444456"]
_EQUATION = re.compile(r"\bEqs?\. \(\w+\)(?:(?:, | and |, and )\(\w+\))*")


def section_of(place: str) -> str:
    """Return the section, a key of `SECTIONS`, that "Sections 3 to 5" or "Fig. 8" begins in."""
    if sections := re.findall(r"\bSections? ([1-6])\b", place):
        return f"Section {sections[0]}"
    figure, *_ = re.findall(r"\bFig\. (\d)", place)
    return _FIGURES[int(figure) - 1]


def numbered(text: str) -> str:
    """Return a text in which equations go by their numbers in print: "Eqs. (uq), (u)" as "Eqs. (6), (8)"."""
    return _EQUATION.sub(
        lambda found: re.sub(r"\w+(?=\))", lambda label: str(EQUATIONS.get(label[0], label[0])), found[0]),
        text,
    )
