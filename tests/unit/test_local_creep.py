"""Local laws of creep: their numbers, what is refused, checkpoints, legs, and configurations."""

import tomllib
from typing import Any

import numpy as np
import pytest

import asperity as asp
import asperity.app.runs.pipeline as pipeline
from asperity.app.cli.flags import flags_for, given
from asperity.app.config import config_from, to_toml
from asperity.app.config.python import to_python
from asperity.app.runs.words import _solid
from asperity.ask.run import RunConfig
from asperity.base.parameters import parameters_of
from asperity.contact import local_creep
from asperity.contact.lattice_creep import LatticeCreep
from asperity.contact.local_creep import LocalState, Stage
from asperity.contact.mechanics import SpringMechanics
from asperity.creep import LAWS
from asperity.errors import ConvergenceError
from asperity.results.parameters import PARAMETERS
from asperity.solids import CreepLaw, Eyring, Garofalo, LocalCreep, Norton, half_space, spring_lattice
from tests.refusals import each_refuses

ROUGH = np.random.default_rng(0).normal(size=(12, 12))
LAW = Eyring(rate=0.1, stress=0.2)
LATTICE = spring_lattice(k0=1.0, k1=3.0, R=0.1, creep=LAW)


@pytest.mark.parametrize(
    ("law", "formula"),
    [
        (Eyring(2.0, 0.5), lambda s: 2.0 * np.sinh(s / 0.5)),
        (Norton(0.5, 2.0, 3.0), lambda s: 0.5 * (s / 2.0) ** 3),
        (Garofalo(2.0, 0.5, 3.5), lambda s: 2.0 * np.sign(s) * np.sinh(np.abs(s) / 0.5) ** 3.5),
    ],
)
def test_laws_have_their_rate_and_its_slope_and_overflow_nowhere(law, formula):
    stress = np.array([-50.0, -30.0, -0.7, -1e-3, 0.0, 1e-9, 1e-3, 0.7, 30.0])
    rate, slope = law.velocity(stress)
    np.testing.assert_allclose(rate, formula(stress), rtol=1e-13)
    h = 1e-6 * np.abs(stress) + 1e-9
    ahead, behind = law.velocity(stress + h)[0], law.velocity(stress - h)[0]
    np.testing.assert_allclose(slope, (ahead - behind) / (2 * h), rtol=1e-6, atol=1e-12)
    assert np.isfinite(law.velocity(np.array([1e6, -1e6, 100 * min(law.greatest_stress, 1e6)]))).all()


def test_activation_gives_rate_and_stress():
    law = Eyring.activated(energy="96.485 kJ/mol", volume="0.1 nm^3", temperature="300 K", prefactor=1.0)
    same = Eyring.activated(energy="1 eV", volume=1e-28, temperature=300.0, prefactor="1 m/s")
    assert law.rate == pytest.approx(same.rate, rel=1e-3)
    assert law.rate == pytest.approx(np.exp(-1.602177e-19 / (1.380649e-23 * 300)), rel=1e-3)
    assert law.stress == pytest.approx(1.380649e-23 * 300 / 1e-28)


class Nameless(LocalCreep):
    """A law that does not say its velocity."""

    def rate(self, stress):
        return stress


def test_what_is_no_law_or_beyond_belief_is_refused():
    def pressed(law):
        return asp.press(ROUGH, spring_lattice(k0=1.0, k1=3.0, creep=law), load=40.0)

    threshold = CreepLaw(lambda s: np.maximum(s - 0.1, 0.0), lambda s: (s > 0.1).astype(float))
    assert (CreepLaw(np.tanh, lambda s: 1 - np.square(np.tanh(s))).velocity(np.ones(2))[0] < 1).all()
    # It begins beyond the stresses that are tried at first, and then its derivative is wrong.
    late = CreepLaw(lambda s: np.maximum(s - 1.1, 0.0), lambda s: 2 * (s > 1.1).astype(float))
    cold: dict[str, Any] = {"energy": "20 eV", "volume": 1e-28, "temperature": 100.0, "prefactor": 1.0}
    each_refuses(
        ("energy", "2321 kT", lambda: Eyring.activated(**cold)),
        ("rate", "another one", lambda: CreepLaw(lambda s: s + 1.0, np.ones_like)),
        ("derivative", "0", lambda: CreepLaw(lambda s: np.sinh(s / 1e6), lambda s: 0 * s)),
        ("derivative", "1", lambda: CreepLaw(lambda s: s**3, lambda s: s**2)),
        ("derivative", "2", lambda: asp.age(pressed(late), [1.0])),
        ("creep", "float", lambda: pressed(1.0)),
        ("creep", "Nameless without it", lambda: pressed(Nameless())),
        ("creep", "both", lambda: half_space(modulus=1.0, branches=[(0.5, 1.0)], creep=LAW)),
        ("creep", "2.51", lambda: asp.age(pressed(Eyring(1.0, 1e-3)), [1.0])),
        ("creep", lambda: asp.relax(pressed(threshold))),
    )


def test_a_step_that_is_not_solved_raises(monkeypatch):
    monkeypatch.setattr("asperity.contact.local_creep.TUNING", local_creep.Tuning(most_revisions=0))
    with pytest.raises(ConvergenceError, match=r"creep: a step of .* lacks .*; try a larger rtol"):
        asp.age(asp.press(ROUGH, LATTICE, load=8.0), [1.0])


@pytest.mark.parametrize("R", [0.0, 0.5])
@pytest.mark.parametrize("load", [15.0, None])
def test_a_step_on_springs_lacks_no_more_than_is_allowed(R, load):
    """What sites would have to change alone, by the equation of the step."""
    law, tau = Eyring(rate=0.1, stress=1.0), 0.2
    contact = asp.press(ROUGH, spring_lattice(k0=1.0, k1=3.0, R=R, creep=law), load=15.0)
    system = contact.system()
    assert isinstance(system.mechanics, SpringMechanics)
    solver = LatticeCreep(system.mechanics.springs, law, contact.lattice, ROUGH)
    u, before = contact.u - system.datum, contact.anchors[0] - system.datum
    for allowed in (1e-3, 1e-5, 1e-7):
        end = solver.solve(
            Stage(tau, before, load, 0.0), LocalState(u, 3.0 * (u - before), 0.0), allowed
        ).state()
        lacking = end.u - end.position - before - end.force / 3 - tau * solver.velocity(end.force)
        own = 1 + 3 * tau * (law.velocity(end.force)[1] + 4 * R)
        assert np.sqrt(np.mean((lacking / own) ** 2)) <= allowed
        if load is not None:
            assert end.force.sum() == pytest.approx(load, rel=2e-3)


def configured(**solid):
    solid = {"kind": "spring_lattice", **solid}
    return RunConfig.read(
        {"surface": {"kind": "gaussian", "shape": [8, 8]}, "solid": solid, "contact": {"load": 5.0}}
    )


@pytest.mark.parametrize("name", LAWS)
def test_every_law_has_its_keys_flags_words_and_records(name):
    law = LAWS[name](*np.linspace(1.5, 2.5, len(parameters_of(LAWS[name]))).tolist())
    config = configured(creep=name, **law.parameters)
    assert config.solid.build().creep == law
    assert f"asp.solids.{law!r}" in to_python(config, [1.0]).replace("\n", "").replace("    ", "")
    assert config_from(tomllib.loads(to_toml(config)), {}, None) == config
    flags: Any = flags_for("solid")
    written = {f"solid_{key}": f"{value:g}" for key, value in law.parameters.items()}
    assert config_from({}, given(flags(solid_creep=name, **written)), None).solid.build().creep == law
    assert set(law.parameters) <= set(PARAMETERS)
    attrs = asp.age(asp.press(ROUGH, config.solid.build(), load=5.0), [0.1]).dataset.attrs
    assert {key: attrs[key] for key in law.parameters} == law.parameters


HALF_SPACE = {"kind": "half_space", "modulus": 1e9, "creep": "eyring"}
ACTIVATED = {"creep_energy": "1 eV", "creep_volume": "0.1 nm^3", "temperature": "300 K"}


def test_the_summary_states_the_units_of_activated_creep():
    told = ACTIVATED | {"creep_energy": "100 kJ/mol", "creep_prefactor": "1 m/s", "temperature": "25 degC"}
    surface = asp.surfaces.Surface(1e-7 * ROUGH, unit="m", pixel_size=(1e-6, 1e-6), length_unit="m")
    contact = asp.press(surface, half_space(modulus=1e9), pressure=2e7)
    said = _solid(configured(**HALF_SPACE, **told), asp.age(contact, [1.0]).dataset)
    assert "modulus = 1 GPa" in said
    assert "creep_energy = 1.036 eV, creep_volume = 0.1 nm^3, creep_prefactor = 1 m/s" in said
    assert "temperature = 298.1 K" in said


# Bytes a site of 512 x 512, measured with one map.
@pytest.mark.parametrize(("permanent", "measured"), [(0.0, 431), (0.3, 704)])
def test_a_run_asks_for_the_memory_that_was_measured(permanent, measured, monkeypatch):
    asked: list[float] = []
    monkeypatch.setattr(pipeline, "require", lambda needed, *_, **__: asked.append(needed))
    config = configured(**HALF_SPACE, permanent=permanent, creep_rate=1.0, creep_stress=1.0)
    config = config.but(output=config.output.but(maps_at=[1.0]))
    pipeline._require_memory((512, 512), config.solid.build(), config)
    assert asked[0] > measured
