"""Keys of local laws of creep, which solids have that take one."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator

from asperity.app.config.sections import any_of, field_of, usual
from asperity.base.parameters import parameters_of
from asperity.creep import LAWS, Eyring


def marked(keys: set[str]) -> str:
    """Keys for a message, marked, so that where they came as flags it can name these."""
    return ", ".join(f"`{key}`" for key in sorted(keys))


FORMULAS = any_of(f"{name}, {law.formula}" for name, law in LAWS.items())
"""Laws of creep in words."""

KEYS_OF_LAWS: dict[str, list[set[str]]] = {
    name: [{f"creep_{of}" for of in parameters_of(law)}] for name, law in LAWS.items()
}
ACTIVATED = {
    **{f"creep_{name}": one.optional for name, one in parameters_of(Eyring.activated).items()},
    "temperature": parameters_of(Eyring.activated)["temperature"].optional,
}
del ACTIVATED["creep_temperature"]
KEYS_OF_LAWS["eyring"].append(set(ACTIVATED))
"""Keys that state each law of creep, in one way or another."""

ACTIVATION = KEYS_OF_LAWS["eyring"][-1]
OF_LAWS = {key for ways in KEYS_OF_LAWS.values() for way in ways for key in way}
"""Keys of local laws of creep."""

CREEP: dict[str, Any] = {
    "creep": (
        Annotated[
            Literal[(*LAWS, "none")] | None, AfterValidator(lambda word: None if word == "none" else word)
        ],
        usual(
            None,
            f"Local law of creep: {FORMULAS}; s is the pressure, "
            "or on the lattice of springs the force of a spring to the bulk.",
        ),
    ),
    **{
        f"creep_{name}": field_of(parameter.optional)
        for law in LAWS.values()
        for name, parameter in parameters_of(law).items()
    },
}
