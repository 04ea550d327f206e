"""What is given in place of a dataset, a result or a name is refused in words, whatever it is."""

import inspect
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import xarray as xr

import asperity as asp
from asperity.errors import InputError

CONTACT = asp.press(
    np.random.default_rng(1).normal(size=(8, 8)), asp.solids.spring_lattice(k0=1.0, k1=3.0), load=8.0
)
HISTORY = asp.age(CONTACT, times=[1.0, 10.0], fields_at=[1.0, 10.0])
WRONG: tuple[Any, ...] = (CONTACT, HISTORY, xr.Dataset(), "nope", None, {}, 3)
ELSEWHERE = {
    "html_of",  # that of an object knows its class
    "observe",  # of a contact too
    "patch_table",
    "plot_contact",
}
ROOMS: tuple[ModuleType, ...] = (asp.figures, asp.analysis)
FUNCTIONS = [
    *(
        (room.__name__, name)
        for room in ROOMS
        for name in room.__all__
        if not inspect.isclass(getattr(room, name)) and name not in ELSEWHERE
    ),
    ("asperity.friction", "compare_state_laws"),
    ("asperity.friction", "hold_peaks"),
]


@pytest.mark.parametrize(("room", "name"), FUNCTIONS)
def test_a_wrong_thing_is_refused(room: str, name: str) -> None:
    function = getattr(getattr(asp, room.removeprefix("asperity.")), name)
    needed = [one for one in inspect.signature(function).parameters.values() if one.default is one.empty]
    for wrong in WRONG:
        words = {one.name: wrong for one in needed}
        with pytest.raises(InputError) as raised:
            function(**words)
        assert "\n" not in str(raised.value)
