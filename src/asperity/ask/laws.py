"""Keys of local laws of creep and of laws of adhesion, which solids have that take one."""

from __future__ import annotations

from typing import Literal

from asperity.ask.section import Keys
from asperity.base.checks import any_of
from asperity.base.parameters import Parameter, Quantity, parameters_of
from asperity.creep import Eyring
from asperity.solids import LAWS

FORMULAS = {
    kind: any_of(f"{name}, {law.formula}" for name, law in laws.items()) for kind, laws in LAWS.items()
}
"""Laws in words, by kind."""

KEYS_OF_LAWS: dict[str, dict[str, list[set[str]]]] = {
    kind: {name: [{f"{kind}_{of}" for of in parameters_of(law)}] for name, law in laws.items()}
    for kind, laws in LAWS.items()
}
ACTIVATED = {
    **{f"creep_{name}": one.optional for name, one in parameters_of(Eyring.activated).items()},
    "temperature": parameters_of(Eyring.activated)["temperature"].optional,
}
del ACTIVATED["creep_temperature"]
KEYS_OF_LAWS["creep"]["eyring"].append(set(ACTIVATED))
"""Alternative sets of keys of each law."""

ACTIVATION = KEYS_OF_LAWS["creep"]["eyring"][-1]
OF_LAWS = {
    kind: {key for ways in laws.values() for way in ways for key in way}
    for kind, laws in KEYS_OF_LAWS.items()
}
"""Keys of the laws of each kind."""

_SAID = {
    "creep": f"Local law of creep: {FORMULAS['creep']}; s is the pressure, "
    "or on the lattice of springs the force of a spring to the bulk",
    "adhesion": f"Law of adhesion: {FORMULAS['adhesion']}",
}


def _keys(kind: str) -> Keys:
    """Keys of the laws of a kind."""
    words = Parameter(Literal[(*LAWS[kind], "none")] | None, (Quantity(_SAID[kind]),), None)
    return {kind: words} | {
        f"{kind}_{name}": parameter.optional
        for law in LAWS[kind].values()
        for name, parameter in parameters_of(law).items()
    }


KEYS: dict[str, Keys] = {kind: _keys(kind) for kind in LAWS}
"""Keys of laws, by the argument of a solid that takes one."""
