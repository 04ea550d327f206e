"""No unit is another one's: the same problem has the same contacts whatever length and force count as 1."""

import pytest

import asperity as asp
from tests.continua import pressed
from tests.surfaces import correlated, uncorrelated

P, S = asp.protocols, asp.solids
RELAXING = [(0.4, 0.3), (0.3, 5.0)]


def springs(length, force, *, R_viscous=0.0, creep=None, hardness=None):
    stiffness = force / length
    rates = {"R": 1 / stiffness, "R_viscous": R_viscous / stiffness}
    law = creep and creep(length, force)
    limit = hardness and hardness * force
    return S.spring_lattice(k0=stiffness, k1=3 * stiffness, **rates, creep=law, hardness=limit)


def half_space(length, force, *, branches=(), creep=None, hardness=None, apparatus=None):
    modulus = force / length**2
    law = creep and creep(length, modulus)
    numbers = {
        "hardness": hardness and hardness * modulus,
        "apparatus": apparatus and apparatus * force / length,
    }
    return S.half_space(modulus=modulus, branches=branches, creep=law, **numbers)


def eyring(length, stress):
    return S.Eyring(rate=0.1 * length, stress=0.5 * stress)


def norton(length, stress):
    return S.Norton(rate=0.1 * length, stress=0.5 * stress, exponent=1.0)


def garofalo(length, stress):
    return S.Garofalo(rate=0.1 * length, stress=0.5 * stress, exponent=3.0)


SOLIDS = {
    "springs": (springs, {}),
    "springs and viscous creep": (springs, {"R_viscous": 0.5}),
    "springs and a law": (springs, {"creep": norton}),
    "springs, a law and a hardness": (springs, {"creep": garofalo, "hardness": 3.0}),
    "half-space": (half_space, {"branches": RELAXING}),
    "half-space and a hardness": (half_space, {"branches": RELAXING, "hardness": 0.3}),
    "half-space and a law": (half_space, {"creep": eyring}),
    "half-space on an apparatus": (half_space, {"branches": RELAXING, "apparatus": 3.0}),
}


def areas(make, numbers, change, length, force):
    """Areas at a few times of a ramp from load 0, or from a body just above, and of a hold."""
    on_sites = make is springs
    heights = (uncorrelated(16) if on_sites else correlated(20)) * length
    place = {"spacing": (1.0, 1.0) if on_sites else (length, length)}
    solid, highest = make(length, force, **numbers), float(heights.max())
    if change == "load":
        start = pressed(heights, solid, load=0.0, **place)
        ramp = P.Ramp(1.0, load=(20.0 if on_sites else 6.0) * force)
    else:
        start = pressed(heights, solid, separation=highest + 0.1 * length, **place)
        ramp = P.Ramp(1.0, separation=highest - length)
    history = asp.age(start, [0.3, 1.0, 10.0], protocol=[ramp, P.Hold(9.0)], rtol=0.02)
    return history.dataset["area"].values.tolist()


CASES = [(name, "load") for name in SOLIDS]
CASES += [(name, "separation") for name in SOLIDS if "springs" in name or "apparatus" in name]


@pytest.mark.parametrize(("name", "change"), CASES)
def test_contacts_do_not_depend_on_units(name, change):
    expected = areas(*SOLIDS[name], change, 1.0, 1.0)
    assert len(set(expected)) > 2
    for units in ((1e-9, 1.0), (1.0, 1e9), (1e9, 1e-9)):
        assert areas(*SOLIDS[name], change, *units) == expected
