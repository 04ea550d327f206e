"""Keys of local laws of creep and of laws of adhesion, which solids have that take one."""

from __future__ import annotations

from typing import Literal

from asperity.ask.section import Keys
from asperity.base.checks import any_of
from asperity.base.parameters import Parameter, Quantity, parameters_of
from asperity.creep import Eyring
from asperity.solids import LAWS

ACTIVATED = {f"creep_{name}": one.optional for name, one in parameters_of(Eyring.activated).items()}
ACTIVATED["temperature"] = ACTIVATED.pop("creep_temperature")
"""Keys from which a law of Eyring follows."""

KEYS_OF_LAWS: dict[str, dict[str, list[set[str]]]] = {
    kind: {name: [{f"{kind}_{of}" for of in parameters_of(law)}] for name, law in laws.items()}
    for kind, laws in LAWS.items()
}
KEYS_OF_LAWS["creep"]["eyring"].append({*ACTIVATED})
"""Alternative sets of keys of each law."""

OF_LAWS = {
    kind: set[str]().union(*(way for ways in laws.values() for way in ways))
    for kind, laws in KEYS_OF_LAWS.items()
}
"""Keys of the laws of each kind."""

_SAID = {
    "creep": "Local law of creep: {}; s is the pressure, "
    "or on the lattice of springs the force of a spring to the bulk",
    "adhesion": "Law of adhesion: {}",
}


def _keys(kind: str) -> Keys:
    """Keys of the laws of a kind."""
    said = _SAID[kind].format(any_of(f"{name}, {law.formula}" for name, law in LAWS[kind].items()))
    words = Parameter(Literal[(*LAWS[kind], "none")] | None, (Quantity(said),), None)
    return {kind: words} | {
        f"{kind}_{name}": parameter.optional
        for law in LAWS[kind].values()
        for name, parameter in parameters_of(law).items()
    }


KEYS: dict[str, Keys] = {kind: _keys(kind) for kind in LAWS}
"""Keys of laws, by the argument of a solid that takes one."""
