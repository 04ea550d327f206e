"""One value through every door: a call in Python, a TOML file, flags, and the form of the page.

Each kind has all its parameters here: as numbers, and as texts with a unit where a number is a quantity.
"""

import dataclasses
import json
import tomllib
from collections.abc import Mapping
from inspect import signature
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity import protocols, solids, surfaces
from asperity.app.cli.flags import flags_for, given, keys_for
from asperity.app.config import RunConfig, config_from
from asperity.app.config.keys import sections
from asperity.app.config.mistakes import Door
from asperity.app.config.reading import config_at, to_toml
from asperity.app.explore.server import Places, read_request
from asperity.ask.questions import QUESTIONS
from asperity.ask.section import keys_of_maker
from asperity.ask.solid import OF_DATA
from asperity.base.parameters import parameters_of
from asperity.base.words import tables_to_toml
from asperity.errors import ConfigError, InputError
from asperity.protocols import Leg
from asperity.protocols.legs import TARGETS
from asperity.solids import Solid
from asperity.surfaces import Surface, read
from tests.refusals import refuses

DATA = Path(__file__).parents[1] / "judges"
METERS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "nm": 1e-9, "µm": 1e-6}
BALL = {"shape": [8, 8], "pixel_size": [1e-5, 2e-5], "edges": "free"}
ELASTIC = {"young": [3e9], "poisson": [0.3], "branches": [[0.25, 10.0], [0.5, 100.0]], "hardness": 1e8}
LAYER = {**ELASTIC, "young": 3e9, "poisson": 0.3, "thickness": 1e-5}
STICKY = {"adhesion": "dugdale", "adhesion_work": 0.05, "adhesion_range": 1e-6}
RATE = {"creep_rate": 1e-9, "creep_stress": 1e7}
ALL: dict[str, list[dict[str, Any]]] = {
    "surface": [
        {"kind": "gaussian", "shape": [4, 6], "rms": 0.5, "seed": 3, "edges": "periodic"},
        {"kind": "exponential", "shape": [4, 6], "rms": 0.5, "seed": 3, "edges": "reflecting"},
        {"kind": "self_affine", "size": 8, "hurst": 0.5, "delta": 0.1, "seed": 3, "edges": "periodic"},
        *(
            {"kind": "spectral", "shape": [16, 16], "hurst": 0.7, "roll_off": 8.0, "cutoff": 4.0, "seed": 3}
            | {"spacing": [1.0, 0.5], "unit": "um", "edges": "reflecting", measure: 0.25}
            for measure in ("rms_height", "rms_slope", "rms_curvature")
        ),
        {"kind": "spectrum", "shape": [16, 16], "path": str(DATA / "spectrum.csv"), "unit": "um", "seed": 3}
        | {"spacing": [1.0], "edges": "periodic"},
        {"kind": "sphere", "radius": 1e-3, **BALL},
        {"kind": "paraboloid", "radius": [1e-3, 2e-3], **BALL},
        {"kind": "punch", "radius": 2e-5, **BALL},
        {"kind": "array", "places": [[2e-5, 4e-5], [4e-5, 8e-5]], "radii": [1e-3], "heights": [0.0, 1e-6]}
        | BALL,
    ],
    "solid": [
        {"kind": "spring_lattice", "k0": 2.0, "k1": 1.0, "R": 0.5, "R_viscous": 0.25, "hardness": 4.0},
        {"kind": "spring_lattice", "k0": 2.0, "k1": 1.0, "R": 0.0, "creep": "norton", "creep_rate": 0.5}
        | {"creep_stress": 2.0, "creep_exponent": 3.0},
        {"kind": "half_space", **ELASTIC, "apparatus": 1e6},
        {"kind": "half_space", **ELASTIC, **STICKY} | {"hardness": None},
        {"kind": "half_space", "modulus": 3e9, "flow": [1e-12, -1.0]},
        {"kind": "half_space", "modulus": 3e9, "creep": "eyring", **RATE, "permanent": 0.1},
        *(
            {"kind": "half_space", "modulus": 3e9, "creep": law, **RATE, "creep_exponent": 2.0}
            for law in ("norton", "garofalo")
        ),
        {
            "kind": "half_space",
            "modulus": 3e9,
            "creep": "eyring",
            "creep_energy": 1.6e-19,
            "temperature": 300.0,
        }
        | {"creep_volume": 1e-27, "creep_prefactor": 1.0},
        {"kind": "layer", **LAYER, "frictionless": True},
        {"kind": "layer", **LAYER, **STICKY, "hardness": None},
        {"kind": "layer", "modulus": 3e9, "poisson": 0.3, "thickness": 1e-5},
        {"kind": "coated_half_space", **LAYER, "base_modulus": 1e9, "base_poisson": 0.4, "apparatus": 1e6}
        | {"base_branches": [[0.5, 10.0]]},
        {"kind": "coated_half_space", "modulus": 3e9, "poisson": 0.3, "thickness": 1e-5, **STICKY}
        | {"base_modulus": 1e9, "base_poisson": 0.4},
    ],
    "protocol": [
        {"kind": "hold", "duration": 10.0, "hold": "load", "mobility": 2.0},
        *({"kind": "ramp", "duration": 10.0, "mobility": 2.0, end: 0.5} for end in TARGETS),
        *({"kind": "step", end: 0.5} for end in TARGETS),
        {"kind": "slide", "distance": 1e-6, "velocity": 1e-6, "direction": "-y", "substeps": 2, "every": 3}
        | {"mobility": 2.0},
    ],
    "contact": [{name: 0.5} for name in ("load", "pressure", "separation")],
    "aging": [
        {"first": 0.5, "last": 50.0, "per_decade": 3, "hold": "load", "rtol": 1e-3},
        {"times": [0.0, 0.5, 50.0]},
    ],
    "friction": [
        {"shear_strength": 1e7, "rate_coefficient": 0.01, "reference_velocity": 1e-6}
        | {"growth": 0.02, "after": 0.1, "renewal": 2e-6}
    ],
    "carried": [
        {"stiffness": True, "resistivity": [1e-8, 2e-8], "conductivity": [0.5], "work_of_adhesion": 0.05}
        | {"shear": 0.5, "friction_coefficient": 0.25, "shear_direction": "y"}
    ],
    "output": [{"maps_at": [0.0, 0.5], "figures": ["pdf"], "pixel": 1e-6, "blur": 2e-6, "threshold": 0.5}],
}
OF_TABLES = {*OF_DATA, "measured"}
"""Keys about files, which other tests have."""


def in_text(value: Any, unit: str) -> Any:
    """A number as a text in a thousandth of its unit, such as "500.0 mN"."""
    if isinstance(value, list):
        return [in_text(one, unit) for one in value]
    return f"{value!r} {unit}" if unit[:1] in "JKoW" or "^3" in unit else f"{value * 1000!r} m{unit}"


def with_units(section: str, keys: dict[str, Any]) -> dict[str, Any]:
    known, texts = sections()[section][keys.get("kind", "")], dict(keys)
    for name in keys.keys() & known.keys():
        units, value = known[name].units, keys[name]
        if known[name].unit and value is not None:
            texts[name] = in_text(value, known[name].unit)
        elif any(units) and all(units):
            texts[name] = [[in_text(*one) for one in zip(pair, units, strict=True)] for pair in value]
        elif any(units):
            texts[name] = [[pair[0], in_text(pair[1], units[1])] for pair in value]
        elif name in ("spacing", "roll_off", "cutoff", "rms_height"):
            several = [f"{one * 1000!r} nm" for one in np.atleast_1d(value).tolist()]
            texts[name] = several if isinstance(value, list) else several[0]
    return texts


def through_doors(section: str, keys: dict[str, Any], folder: Path) -> list[RunConfig]:
    """The configuration from a file, from flags and from the form."""
    tables = {section: [keys] if section == "protocol" else keys}
    if section == "protocol":
        legs = " ".join(
            f"{name}={str(value).replace(' ', '')}" for name, value in keys.items() if name != "kind"
        )
        laid = given(None, leg=[f"{keys['kind']} {legs}"])
    else:
        kind = flags_for(section, *(["preparation"] if section == "surface" else []))
        words: dict[str, Any] = {}
        for name, (_, key) in kind.keys.items():
            if (value := keys.get(key.name)) is None:
                continue
            if key.what in ("pair", "pairs"):
                pairs = value if key.what == "pairs" else [value]
                words[name] = [" ".join(str(one).replace(" ", "") for one in pair) for pair in pairs]
            elif isinstance(value, bool):
                words[name] = value
            else:
                several = [str(one) for one in (value if isinstance(value, list) else [value])]
                words[name] = several if key.several else several[0]
        laid = given(kind(**words))
    form, _ = read_request(json.loads(json.dumps(tables)), Places(DATA, folder))
    return [config_from(tomllib.loads(tables_to_toml(tables)), {}, None), config_from({}, laid, None), form]


def in_python(section: str, keys: dict[str, Any]) -> Any:
    """What the function or the class of the library makes of the same arguments."""
    kind = keys["kind"]
    if section == "protocol":
        return protocols.KINDS[kind](**{name: one for name, one in keys.items() if name != "kind"})
    make = (surfaces.KINDS if section == "surface" else solids.KINDS)[kind]
    arguments: dict[str, Any] = {}
    for name, parameter in parameters_of(make).items():
        value = keys.get(parameter.quantity.key or name)
        if value is not None:
            value = value[0] if isinstance(value, list) and len(value) == 1 and name not in _LISTS else value
            several = isinstance(value, list) and name not in _LISTS
            arguments[name] = not value if value is True else tuple(value) if several else value
    for law in ("creep", "adhesion"):
        if law in keys:
            of = solids.LAWS[law][keys[law]]
            facts = {name: keys[f"{law}_{name}"] for name in parameters_of(of) if f"{law}_{name}" in keys}
            names = ("energy", "volume", "prefactor")
            arguments[law] = (
                of(**facts)
                if facts
                else solids.Eyring.activated(
                    **{name: keys[f"creep_{name}"] for name in names}, temperature=keys["temperature"]
                )
            )
    made = make(**arguments)
    of_surface = isinstance(made, Surface) and "edges" in keys
    return dataclasses.replace(made, edges=keys["edges"]) if of_surface else made


_LISTS = ("branches", "base_branches", "places")


def facts(thing: Any) -> list[Any]:
    """Numbers and words of a section, a surface, a solid or a leg, in a list; heights come first."""
    if isinstance(thing, Surface):
        return [*facts(thing.heights), *facts(thing.pixel_size), thing.unit, thing.length_unit, thing.edges]
    if isinstance(thing, np.ndarray):
        return list(thing.ravel().tolist())
    if isinstance(thing, list | tuple):
        return [fact for one in thing for fact in facts(one)]
    if isinstance(thing, Mapping):
        return [fact for name in sorted(thing) for fact in (name, *facts(thing[name]))]
    if isinstance(thing, Solid):
        return facts(thing.parameters)
    return facts(vars(thing)) if isinstance(thing, Leg) else [thing]


def check_equal(one: list[Any], other: list[Any]) -> None:
    for a, b in zip(one, other, strict=True):
        # Texts are rounded once more; heights of 0 are sums of waves.
        assert a == (pytest.approx(b, rel=1e-12, abs=1e-16) if isinstance(b, float) else b)


@pytest.mark.parametrize(
    ("section", "keys"), [(section, keys) for section, several in ALL.items() for keys in several]
)
def test_a_value_is_the_same_through_all_doors(section: str, keys: dict[str, Any], tmp_path: Path) -> None:
    keys = {name: value for name, value in keys.items() if value is not None}
    texts = with_units(section, keys)
    assert (texts == keys) == (keys.get("kind") in ("gaussian", "exponential", "self_affine"))
    check_doors(section, keys, texts, tmp_path)


def check_doors(section: str, keys: dict[str, Any], texts: dict[str, Any], folder: Path) -> None:
    """Numbers, and texts with units, are the same in a file, flags, the form and Python."""
    opened = [one for asked in (keys, texts) for one in through_doors(section, asked, folder)]
    parts = [one.protocol[0] if one.protocol else getattr(one, section) for one in opened]
    assert config_from(tomllib.loads(to_toml(opened[0])), {}, None) == opened[0]
    first, *others = [facts(one if section == "protocol" else vars(one)) for one in parts]
    for one in others:
        check_equal(one, first)
    if section in ("surface", "solid", "protocol"):
        made = facts(parts[0] if section == "protocol" else parts[0].build())
        for asked in (keys, texts):
            thing = in_python(section, asked)
            check_equal(facts(thing), made[: thing.size] if isinstance(thing, np.ndarray) else made)


def test_all_parameters_are_tried() -> None:
    for section, kinds in sections(short=True).items():
        for kind, known in kinds.items():
            tried = {name for keys in ALL[section] if keys.get("kind", "") == kind for name in keys}
            lacking = known.keys() - tried - OF_TABLES
            assert not lacking or kind in ("file", "repeat"), (section, kind, lacking)


COMMANDS = {"prediction": "predict"}


@pytest.mark.parametrize(
    ("name", "verb"), [("prediction", asp.predict), ("law", asp.law), ("sliding", asp.steady_sliding)]
)
def test_what_a_question_is_asked_is_an_argument_and_a_flag(name, verb) -> None:
    question, arguments = QUESTIONS[name], signature(verb).parameters
    assert list(arguments) == list(signature(question).parameters)
    assert keys_of_maker(question).keys() <= question.checked().keys() <= arguments.keys()
    assert keys_of_maker(question).keys() <= {key.name for _, key in keys_for(name)}
    assert verb.__doc__ == question.__doc__


@pytest.mark.parametrize(
    ("name", "texts", "numbers", "refused"),
    [
        ("prediction", {"ramp": "2.4 s", "resolution_study": True}, {"ramp": 2.4}, {"ramp": "-1 s"}),
        ("law", {"pressures": ["1 MPa", "20 MPa"], "per_decade": 4}, {}, {"per_decade": 0}),
        ("prediction", {}, {}, {"rmap": "1 s"}),
        ("law", {"pressures": ["1 MPa"]}, {"pressures": [1e6]}, {"times": ["1 h"]}),  # ages are in [aging]
        ("sliding", {"speeds": ["1 mm/s"], "direction": "-y"}, {"speeds": [1e-3]}, {"speeds": ["0 m/s"]}),
    ],
)
def test_keys_of_a_question_stand_in_a_file_or_are_flags(name, texts, numbers, refused, tmp_path) -> None:
    file, empty = tmp_path / "asked.toml", tmp_path / "empty.toml"
    beside = {"contact": {"pressure": "1 MPa"}} if name == "sliding" else {}  # it requires a load
    file.write_text(tables_to_toml({name: texts} | beside))
    empty.write_text(tables_to_toml(beside))
    config = config_at(Door({}, file), question=name)
    assert config == config_at(Door({name: texts}, empty), question=name)
    assert vars(config.own) == vars(config.own) | numbers
    assert config_at(Door({name: texts}, file), question=name).own == config.own  # flags override the file
    (key,) = refused
    for door in (Door({name: texts | refused}, empty), Door({name: refused}, file)):
        with pytest.raises(ConfigError) as raised:
            config_at(door, question=name)
        assert [one.path for one in raised.value.mistakes] == [(name, key)]
    with pytest.raises(ConfigError, match=f"file of a .*, not of a run.*asperity {COMMANDS.get(name, name)}"):
        config_at(Door({}, file))


@pytest.mark.parametrize("unit", [*METERS, "micron"])
@pytest.mark.parametrize("text", ["0.25um", "0.25 um", "250 nm", "0.25 µm", 0.25])
def test_lengths_of_made_surfaces_are_in_their_unit(unit: str, text: Any, tmp_path: Path) -> None:
    # A text is a length whatever the unit, 0.25e-6 m over the meters of the unit; a number is in the unit.
    right = text if isinstance(text, float) else 0.25e-6 / METERS.get(unit, 1e-6)
    fine = {"spacing": right / 2, "cutoff": right, "roll_off": 4 * right, "rms_height": right}
    for name in fine:
        keys = {"kind": "spectral", "shape": [8, 8], "unit": unit, **fine}
        keys |= {"cutoff": 4 * right, name: text} if name == "spacing" else {name: text}
        keys |= {"cutoff": right} if name == "roll_off" else {}
        for config in through_doors("surface", keys, tmp_path):
            assert facts(getattr(config.surface, name)) == [pytest.approx(right, rel=1e-12)]
            built = config.surface.build()
            assert built.unit == built.length_unit == {"µm": "um", "micron": "um"}.get(unit, unit)
            assert built.heights.std() == pytest.approx(right)
            check_equal(facts(built), facts(in_python("surface", keys)))


SPELLINGS = {"µm": "um", "μm": "um", "micron": "um", "Å": "angstrom", "nanometer": "nm", "NM": "nm"}


def test_units_have_one_spelling() -> None:
    for spelling, unit in SPELLINGS.items():
        surface = Surface(np.eye(4), unit=spelling, pixel_size=2.0, length_unit=spelling)  # type: ignore[arg-type]
        across = {"um": 1e-6, "angstrom": 1e-10, "nm": 1e-9}[unit]
        assert (surface.unit, surface.length_unit) == (unit, unit)
        assert surface.in_meters()[1] == pytest.approx((2 * across, 2 * across))
        assert surface.crop([0, 4, 0, 4], spelling).shape == (2, 2)
        assert surfaces.gaussian((4, 4), unit=spelling).unit == unit
        if unit != "angstrom":  # which no argument of a file may be
            named: Any = {"file_unit": spelling, "length_unit": spelling}
            scan = read(DATA / "scan.txt", pixel_size=1.0, **named)
            assert (scan.unit, scan.length_unit) == (unit, unit)


def test_what_is_no_length_is_refused_at_every_door_with_what_would_be_one(tmp_path: Path) -> None:
    lengths: dict[str, Any] = {"kind": "spectral", "shape": [8, 8]}
    gaussian: Any = surfaces.gaussian
    hold: Any = protocols.Hold
    for name, keys in {
        "spacing": {"spacing": "0.2 s", "unit": "um"},
        "rms_height": {"rms_height": "1 Pa", "unit": "nm"},
        "unit": {"cutoff": "2 um"},
    }.items():
        with refuses(name.replace("spacing", "pixel_size")):
            in_python("surface", lengths | keys)
        with pytest.raises(ConfigError, match=rf"^\[surface\] {name}: expected"):
            through_doors("surface", lengths | keys, tmp_path)
    for call, said in (
        (lambda: surfaces.spectral((8, 8), rms_height="0.2", unit="um"), "1 um"),
        (lambda: gaussian((8, 8), rms="0.2"), "2 um"),
        (lambda: solids.Dugdale(work="20", range="1 nm"), "50 mJ/m^2"),
        (lambda: hold("20"), "10 s"),
        (lambda: solids.half_space(young="3"), "1 MPa"),
    ):
        with pytest.raises(InputError) as refused:
            call()
        assert refused.value.expected.endswith(f"such as {said}")
