"""A configuration as a short Python program that gives the same numbers."""

from __future__ import annotations

import math
import textwrap
from typing import Any

from asperity.ask.carried import Carried
from asperity.ask.run import RunConfig
from asperity.ask.strength import ShearStrength
from asperity.ask.surface import MeasuredSurface
from asperity.base.parameters import Law, parameters_of
from asperity.base.version import __version__
from asperity.errors import InputError
from asperity.protocols import Leg

_LONG = 96
"""Characters of a line."""

_ROOMS = {Law: "asp.solids", ShearStrength: "asp.friction", Carried: "asp", Leg: "asp.protocols"}
"""Where Python has the classes of arguments."""


def to_python(config: RunConfig, times: list[float]) -> str:
    """Write a configuration in Python, as `asperity.press`, `asperity.age` and `asperity.relax`.

    Its ``contact``, ``history`` and, without a protocol, ``limit`` are those of the run to the last digit.
    `times` are written where the configuration does not give first, last and how many. `InputError` if what
    presses is left open.
    """
    pressed = config.contact.table
    if not pressed:
        raise InputError("contact", expected="a load, a pressure or a separation", got="none")
    contact = _call("asp.press", "rough", "solid", **pressed)
    solid = _call(f"asp.solids.{config.solid.make.__name__}", **config.solid.given)
    arguments: dict[str, Any] = {"protocol": list(config.protocol)}
    arguments |= {"hold": config.aging.hold, "rtol": config.aging.rtol, "fields_at": config.output.maps_at}
    arguments["carried"] = config.recorded
    arguments = {name: value for name, value in arguments.items() if value not in (None, [])}
    spread = config.aging.times is None and not config.protocol
    lines = [
        f"# Asperity {__version__}",
        *(["import numpy as np", ""] if spread else []),
        "import asperity as asp",
        "",
        f"rough = {_surface(config)}",
        f"solid = {solid}",
        f"contact = {contact}",
        f"times = np.geomspace({config.span[0]!r}, {config.span[1]!r}, {len(times)})"
        if spread
        else f"times = {_written(times)}",
        f"history = {_call('asp.age', 'contact', 'times', **arguments)}",
    ]
    if not config.protocol:
        hold = {} if config.aging.hold is None else {"hold": config.aging.hold}
        lines.append(f"limit = {_call('asp.relax', 'contact', **hold)}")
    if (law := config.friction.strength) is not None and not law.ages:
        lines.append(f"friction = {_call('asp.friction.add_friction', 'history.dataset', _written(law))}")
    return "\n".join([*lines, "print(history)", ""])


def _surface(config: RunConfig) -> str:
    chosen = config.surface
    first, facts = chosen.arguments
    if isinstance(chosen, MeasuredSurface):
        usual = {name: parameter.default for name, parameter in parameters_of(chosen.make).items()}
        facts = {name: value for name, value in facts.items() if value != usual[name]}
    call = _call(f"asp.surfaces.{chosen.make.__name__}", repr(first), **facts)
    return _call("asp.surfaces.Surface", call, **chosen.around) if chosen.around else call


def _call(name: str, *positional: str, **named: object) -> str:
    """Write a call, one argument a line where it is long."""
    arguments = [*positional, *(f"{key}={_written(value)}" for key, value in named.items())]
    line = f"{name}({', '.join(arguments)})"
    if len(line) <= _LONG:
        return line
    return "".join([f"{name}(\n", *(f"    {argument},\n" for argument in arguments), ")"])


def _written(value: object) -> str:
    """Write a value so that Python reads the very same one."""
    if isinstance(value, float):
        return 'float("inf")' if value == math.inf else repr(float(value))
    if isinstance(value, tuple):
        return f"({', '.join(map(_written, value))}{',' * (len(value) == 1)})"
    if isinstance(value, list):
        line = f"[{', '.join(map(_written, value))}]"
        return line if len(line) <= _LONG else textwrap.fill(line, _LONG, subsequent_indent="        ")
    room = next((room for kind, room in _ROOMS.items() if isinstance(value, kind)), "")
    if not room:
        return repr(value)
    usual = {name: getattr(type(value), name, None) for name in vars(value)}
    facts = {name: one for name, one in vars(value).items() if one != usual[name]}
    return _call(f"{room}.{type(value).__name__}", **getattr(value, "arguments", facts))
