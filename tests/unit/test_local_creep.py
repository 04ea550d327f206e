"""Local laws of creep: their numbers, what is refused, checkpoints, legs, and configurations."""

import tomllib
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import asperity as asp
import asperity.app.runs.pipeline as pipeline
from asperity.app.cli.flags import flags_for, given
from asperity.app.config import config_from, to_toml
from asperity.app.config.models import RunConfig
from asperity.app.config.python import to_python
from asperity.base.parameters import parameters_of
from asperity.contact import local_creep
from asperity.creep import LAWS
from asperity.errors import ConvergenceError
from asperity.results.parameters import PARAMETERS
from asperity.solids import CreepLaw, Eyring, Garofalo, Norton, half_space, spring_lattice
from tests.refusals import refuses

ROUGH = np.random.default_rng(0).normal(size=(12, 12))
LAW = Eyring(rate=0.1, stress=0.2)
LATTICE = spring_lattice(k0=1.0, k1=3.0, R=0.1, creep=LAW)


def test_eyring_is_the_hyperbolic_sine_at_every_stress():
    stress = np.array([-50.0, -1e-12, 0.0, 1e-9, 0.3, 100.0])
    rate, slope = Eyring(2.0, 0.5).velocity(stress)
    np.testing.assert_allclose(rate, 2.0 * np.sinh(stress / 0.5), rtol=1e-14)
    np.testing.assert_allclose(slope, 4.0 * np.cosh(stress / 0.5), rtol=1e-14)
    assert np.isfinite(Eyring(2.0, 0.5).velocity(np.array([1e6, -1e6]))).all()


def test_norton_is_odd_and_has_its_derivative():
    stress = np.array([-2.0, 0.0, 1.0, 3.0])
    rate, slope = Norton(0.5, 2.0, 3.0).velocity(stress)
    np.testing.assert_allclose(rate, 0.5 * (stress / 2.0) ** 3)
    np.testing.assert_allclose(slope, 0.75 * (stress / 2.0) ** 2)


def test_garofalo_is_eyring_at_one_and_norton_at_small_stresses():
    stress = np.array([-30.0, -0.7, -1e-3, 0.0, 1e-3, 0.7, 30.0])
    law = Garofalo(2.0, 0.5, 3.5)
    rate, slope = law.velocity(stress)
    np.testing.assert_allclose(rate, 2.0 * np.sign(stress) * np.sinh(np.abs(stress) / 0.5) ** 3.5, rtol=1e-13)
    h = 1e-6 * np.abs(stress) + 1e-9
    ahead, behind = law.velocity(stress + h)[0], law.velocity(stress - h)[0]
    np.testing.assert_allclose(slope, (ahead - behind) / (2 * h), rtol=1e-6, atol=1e-12)
    for here, there in zip(
        Garofalo(2.0, 0.5, 1.0).velocity(stress), Eyring(2.0, 0.5).velocity(stress), strict=True
    ):
        np.testing.assert_allclose(here, there, rtol=1e-14)
    small = 1e-4 * stress[1:-1]
    for here, there in zip(law.velocity(small), Norton(2.0, 0.5, 3.5).velocity(small), strict=True):
        np.testing.assert_allclose(here, there, rtol=1e-7)
    greatest = law.greatest_stress
    assert np.isfinite(law.velocity(np.array([greatest, 100 * greatest, -np.inf]))).all()


SITES = 0.1 * np.random.default_rng(1).normal(size=(4, 4))


@pytest.mark.parametrize("law", [Eyring(0.1, 0.3), Norton(0.5, 1.0, 3.0), Garofalo(0.2, 0.5, 2.5)])
@pytest.mark.parametrize("kind", ["springs", "half-space"])
def test_sites_that_all_touch_relax_as_explicit_integration_has_it(law, kind):
    """Their shape is that of the rough surface, so that s follows ds/dt = -C v(s), but for its mean."""
    if kind == "springs":
        solid, C = spring_lattice(k0=1.0, k1=3.0, R=0.0, creep=law), np.full((4, 3), 3.0)
    else:
        q = 2 * np.pi * np.hypot(np.fft.fftfreq(4)[:, np.newaxis], np.fft.rfftfreq(4))
        solid, C = half_space(modulus=6.0, creep=law), 3.0 * q
    C[0, 0] = 0.0
    formula = {
        "Eyring": lambda s: 0.1 * np.sinh(s / 0.3),
        "Norton": lambda s: 0.5 * s**3,
        "Garofalo": lambda s: 0.2 * np.sign(s) * np.abs(np.sinh(s / 0.5)) ** 2.5,
    }[type(law).__name__]

    def fall(_, s):
        return -np.fft.irfft2(C * np.fft.rfft2(formula(s.reshape(4, 4))), (4, 4)).ravel()

    start = asp.press(SITES, solid, load=32.0)
    assert start.area == 16
    times = np.array([0.003, 0.1, 3.0])
    data = asp.age(start, times, rtol=1e-5, fields_at=times).dataset
    stretch = np.fft.rfft2(start.u - start.u0)
    s0 = np.fft.irfft2(np.where(C > 0, C, 0) * stretch, (4, 4)) + 2.0
    found = solve_ivp(fall, (0.0, 3.0), s0.ravel(), t_eval=times, method="LSODA", rtol=1e-10, atol=1e-12)
    for number, exact in enumerate(found.y.T.reshape(3, 4, 4)):
        stretch = np.fft.rfft2((data["u"] - data["u0"])[number].values)
        stress = np.fft.irfft2(C * stretch, (4, 4)) + 2.0
        assert np.abs(stress - exact).max() < 2e-4 * np.ptp(s0)


def test_activation_gives_rate_and_stress():
    law = Eyring.activated(energy="96.485 kJ/mol", volume="0.1 nm^3", temperature="300 K", prefactor=1.0)
    same = Eyring.activated(energy="1 eV", volume=1e-28, temperature=300.0, prefactor="1 m/s")
    assert law.rate == pytest.approx(same.rate, rel=1e-3)
    assert law.rate == pytest.approx(np.exp(-1.602177e-19 / (1.380649e-23 * 300)), rel=1e-3)
    assert law.stress == pytest.approx(1.380649e-23 * 300 / 1e-28)


def test_what_is_no_law_is_refused():
    with refuses("energy"):
        Eyring.activated(energy="20 eV", volume=1e-28, temperature=100.0, prefactor=1.0)
    with refuses("rate"):
        CreepLaw(lambda s: s + 1.0, np.ones_like)
    with refuses("creep"):
        spring_lattice(k0=1.0, k1=3.0, creep=1.0)  # type: ignore[arg-type]
    with refuses("creep"):
        half_space(modulus=1.0, branches=[(0.5, 1.0)], creep=LAW)


def test_a_stress_beyond_belief_is_refused():
    solid = spring_lattice(k0=1.0, k1=3.0, creep=Eyring(1.0, 1e-3))
    with refuses("creep"):
        asp.age(asp.press(ROUGH, solid, load=40.0), [1.0])


def test_a_law_with_a_threshold_has_no_limit_of_its_own():
    law = CreepLaw(lambda s: np.maximum(s - 0.1, 0.0), lambda s: (s > 0.1).astype(float))
    with refuses("creep"):
        asp.relax(asp.press(ROUGH, spring_lattice(k0=1.0, k1=3.0, creep=law), load=40.0))


def test_a_step_that_is_not_solved_raises(monkeypatch):
    monkeypatch.setattr("asperity.contact.local_creep.TUNING", local_creep.Tuning(most_revisions=0))
    with pytest.raises(ConvergenceError, match=r"creep: a step of .* lacks .*; try a larger rtol"):
        asp.age(asp.press(ROUGH, LATTICE, load=8.0), [1.0])


def configured(**solid):
    solid = {"kind": "spring_lattice", **solid}
    return RunConfig.model_validate(
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


def test_configurations_make_the_same_law_and_python():
    config = configured(creep="eyring", creep_rate=0.1, creep_stress=0.2)
    assert config.solid.build().creep == LAW
    assert "creep=asp.solids.Eyring(rate=0.1, stress=0.2)" in to_python(config, [1.0]).replace("\n", "")
    activated = {"creep_energy": "1 eV", "creep_volume": "0.1 nm^3", "temperature": "300 K"}
    warm = configured(kind="half_space", modulus="1 GPa", creep="eyring", creep_prefactor=1.0, **activated)
    law = Eyring.activated(energy="1 eV", volume="0.1 nm^3", temperature="300 K", prefactor=1.0)
    assert warm.solid.build().creep == law
    kept = configured(
        kind="half_space", modulus=2.0, creep="eyring", creep_rate=0.1, creep_stress=0.2, permanent=0.3
    )
    assert kept.solid.build() == half_space(modulus=2.0, creep=LAW, permanent=0.3)
    assert "permanent=0.3" in to_python(kept, [1.0])


def test_a_run_asks_for_the_memory_that_was_measured(monkeypatch):
    asked: list[float] = []
    monkeypatch.setattr(pipeline, "require", lambda needed, *_, **__: asked.append(needed))
    for permanent in (0.0, 0.3):
        config = configured(
            kind="half_space",
            modulus=1.0,
            permanent=permanent,
            creep="eyring",
            creep_rate=1.0,
            creep_stress=1.0,
        )
        config = config.model_copy(update={"output": config.output.model_copy(update={"maps_at": [1.0]})})
        pipeline._require_memory((512, 512), config.solid.build(), config)
    assert asked[0] > 431  # bytes a site of 512 x 512, measured with one map
    assert asked[1] > 704
