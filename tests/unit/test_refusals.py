"""Bad input at the doors of press, age and relax: one clear line, and nothing computed.

What is no number of its kind is given to every public function in `test_public_calls`.
"""

from collections.abc import Callable
from datetime import timedelta
from functools import partial
from typing import Any

import numpy as np
import pytest
import xarray as xr

import asperity as asp
from asperity.solids import Solid
from tests.refusals import refuses
from tests.surfaces import uncorrelated

ROUGH = uncorrelated(8)
SOLID = asp.solids.spring_lattice(k0=1.0, k1=3.0)
CONTACT = asp.press(ROUGH, SOLID, load=5.0)


class Quantity(float):
    """As those of pint: a number with a unit, and an array without."""

    magnitude = 3.0

    def __str__(self):
        return f"{self.magnitude} newton"

    def __array__(self, *_, **__):
        raise AssertionError("the unit was dropped")


HIGHEST = ROUGH.max() == ROUGH
SEPARATED, HANGING = (asp.press(ROUGH, SOLID, separation=one) for one in (1.0, ROUGH.max() + 1))
HEIGHTS: list[Any] = [
    *(np.where(HIGHEST, np.nan, ROUGH), np.where(HIGHEST, np.inf, ROUGH), ROUGH + 1j),
    *(np.zeros((0, 4)), np.zeros((2, 2, 2)), 1.0, Quantity(3.0), 1e200 * ROUGH),
]
LOADS: list[Any] = [
    *(-3.0, 1e-300, 1e308),
    xr.DataArray([[1.0, 2.0]], dims=["leg", "time"]),
    xr.Dataset({"load": 1.0}).load,
    *(np.timedelta64(3, "s"), np.float32("nan"), 10**400, 10**5000, [[1.0] * 1000], Quantity(3.0)),
]
SOLIDS: list[Any] = [None, {}, ROUGH, Solid]
TIMES: list[Any] = [[1.0, 0.5], [1.0, 1.0], [-1.0, 1.0], [], [timedelta(hours=1)]]
WRONG: list[tuple[str, Callable[..., Any], list[dict[str, Any]]]] = [
    ("heights", partial(asp.press, solid=SOLID, load=1.0), [{"heights": one} for one in HEIGHTS]),
    ("load", partial(asp.press, ROUGH, SOLID), [{"load": one} for one in LOADS]),
    (
        "load, pressure and separation",
        partial(asp.press, ROUGH, SOLID),
        [{"load": 1.0, "separation": 0.0}, {}],
    ),
    ("solid", partial(asp.press, ROUGH, load=1.0), [{"solid": one} for one in SOLIDS]),
    *(
        ("solver", call, [{"solver": one} for one in ("fast", asp.Multigrid, object())])
        for call in (
            partial(asp.press, ROUGH, SOLID, load=1.0),
            partial(asp.age, CONTACT, [1.0]),
            partial(asp.relax, CONTACT),
        )
    ),
    (
        "creeping stiffness",
        partial(asp.press, ROUGH, asp.solids.spring_lattice(k0=1.0, k1=0.0)),
        [{"load": 1.0}],
    ),
    ("times", partial(asp.age, CONTACT), [{"times": one} for one in TIMES]),
    ("rtol", partial(asp.age, CONTACT, [1.0]), [{"rtol": one} for one in (0.0, -1.0, 1e-12, 1.0)]),
    ("hold", partial(asp.age, CONTACT, [1.0]), [{"hold": "height"}]),
    ("hold", partial(asp.relax, SEPARATED), [{"hold": "Load"}]),
    ("hold", partial(asp.age, HANGING, [1.0]), [{"hold": "load"}]),
    ("contact", partial(asp.age, times=[1.0]), [{"contact": asp.age(CONTACT, [1.0])}]),
    ("fields_at", partial(asp.age, CONTACT, [1.0]), [{"fields_at": [-1.0]}]),
    ("start", partial(asp.press, ROUGH, SOLID, load=1.0), [{"start": ROUGH}]),
    ("start", partial(asp.press, uncorrelated(4), SOLID, load=1.0), [{"start": CONTACT}]),
]


def test_what_is_refused():
    for name, call, several in WRONG:
        for arguments in several:
            with refuses(name) as refused:
                call(**arguments)
            assert name != "load" or len(str(refused.value)) < 150


@pytest.mark.parametrize("load", [1e-20, 1e-30, 1e-99])
def test_no_load_is_too_small_for_heights_that_nothing_has_deformed(load):
    contact = asp.press(ROUGH, SOLID, load=load)
    assert (contact.area, contact.load) == (1, pytest.approx(load, rel=1e-9))
    assert contact.energy == pytest.approx(asp.press(ROUGH, SOLID, load=1e-3).energy * (load / 1e-3) ** 2)


def test_arguments_are_not_changed_and_what_is_published_cannot_be():
    for field in (CONTACT.heights, CONTACT.u, CONTACT.u0, CONTACT.force, CONTACT.in_contact):
        with pytest.raises(ValueError, match="read-only"):
            field[0, 0] = 1
    heights = ROUGH.copy()
    contact = asp.press(heights, SOLID, load=5.0)
    asp.age(contact, [1.0])
    np.testing.assert_array_equal(heights, ROUGH)
    heights[:] = 0
    np.testing.assert_array_equal(contact.heights, ROUGH)
