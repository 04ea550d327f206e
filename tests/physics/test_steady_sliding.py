"""Steady sliding against closed forms, a dense program, the elastic press, and the energy of the branches."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import root
from scipy.special import ive, kve

import asperity as asp
from asperity.relaxation import Material
from asperity.sliding.bands import draws_of_solid
from asperity.sliding.problem import Sliding
from asperity.sliding.profile import Profile
from asperity.sliding.solver import solved
from asperity.surfaces import Surface
from tests.dense_reference import Dense, matrix_of
from tests.refusals import refuses
from tests.surfaces import correlated

BRANCHES = [(0.3, 1e-4), (0.3, 1e-2), (0.3, 1.0)]
SOFT = asp.solids.half_space(modulus=2.0, branches=BRANCHES)
SPACING = (1.5, 0.5)
PIXEL: Any = 0.5
ROUGH = Surface(0.3 * correlated(16)[:12], pixel_size=SPACING)
LATTICE = asp.solids.spring_lattice(k0=1.0, k1=3.0, R=0.5)
AREA = ROUGH.heights.size * math.prod(SPACING)


def states(solid, surface, load, speeds, direction="x"):
    """The states themselves, each started from the one before, and the profile."""
    profile = Profile.of(asp.contact.bodies.bodies_of(surface, solid), direction, load)
    found: list[Any] = []
    for speed in speeds:
        found.append(solved(profile.at(speed), found[-1] if found else None))
    return found, profile


def relaxation(frequency, branches):
    """Complex modulus over the instantaneous one."""
    w = 1j * np.asarray(frequency)
    return 1 - sum(g for g, _ in branches) + sum(g * w * t / (1 + w * t) for g, t in branches)


def waves(shape, spacing):
    """All wave vectors of a periodic lattice, by axis."""
    return np.meshgrid(
        *(2 * np.pi * np.fft.fftfreq(n, d) for n, d in zip(shape, spacing, strict=True)), indexing="ij"
    )


def stiffness_of_half_space(q, w):
    return 2.0 * q / 2 * math.prod(SPACING) * relaxation(w, BRANCHES)


def stiffness_of_layer(q, w, nu=0.4, h=2.0):
    x = q * h
    top = (3 - 4 * nu) * np.sinh(2 * x) - 2 * x
    bottom = (3 - 4 * nu) * np.cosh(2 * x) + 2 * x**2 + 5 - 12 * nu + 8 * nu**2
    return stiffness_of_half_space(q, w) * bottom / top


def stiffness_of_lattice(q, w, k0=1.0, k1=3.0, mobility=0.5):
    """q is minus the Laplacian: the springs to the bulk creep at the rate k1 R q."""
    return k0 * q + k1 * 1j * w / (1j * w + k1 * mobility * q)


def at_both_frequencies(stiffness, q, along, speed, shape):
    """Shortest waves travel both ways at once: their compliance is the mean of both."""
    values = stiffness(q, -speed * along)
    both = 2 / (1 / values[q > 0] + 1 / stiffness(q, speed * along)[q > 0])
    nyquist = np.isclose(np.abs(along), np.abs(along).max()) & (shape % 2 == 0)
    values[q > 0] = np.where(nyquist[q > 0], both, values[q > 0])
    return values


WAVE: dict[str, Any] = {
    "solid": asp.solids.half_space(young=1e6, poisson=0.3, branches=[(0.5, 1.0)]),
    "speeds": 1e-5,
}


def wave(sites, line=True):
    heights = 0.5e-6 * np.cos(2 * np.pi * np.arange(sites) / sites)
    return Surface(heights, unit="m", pixel_size=(32e-6 / sites,), length_unit="m")


def test_a_wave_in_full_contact_has_the_loss_modulus_at_its_frequency():
    for sites in (8, 9, 32, 256):
        answer = asp.steady_sliding(surface=wave(sites), pressure="1 MPa", **WAVE)
        friction = 1e6 * answer["hysteresis_friction_coefficient"].item()
        q, modulus = 2 * math.pi / 32e-6, 1e6 / (1 - 0.3**2)
        loss = modulus * relaxation(q * 1e-5, [(0.5, 1.0)]).imag
        assert friction == pytest.approx((q * 0.5e-6) ** 2 * loss / 4, rel=1e-12)
        assert friction == pytest.approx(535.4032, abs=5e-5)
        assert answer["slope_friction_coefficient"].item() == pytest.approx(friction / 1e6, rel=1e-9)
        assert answer["contact_fraction"].item() == 1


@pytest.mark.parametrize(
    ("sites", "contacts", "slopes", "energy"),
    # Slopes and contacts are those of another dense program.
    [
        (32, 10, 94.00, 94.28),
        (64, 19, 94.51, 94.51),
        (128, 37, 94.74, 94.63),
        (256, 74, 94.61, 94.64),
        (512, 148, 94.65, 94.64),
    ],
)
def test_a_wave_in_partial_contact(sites, contacts, slopes, energy):
    answer = asp.steady_sliding(surface=wave(sites), pressure="10 kPa", **WAVE)
    assert answer["contact_fraction"].item() == contacts / sites
    assert 1e4 * answer["slope_friction_coefficient"].item() == pytest.approx(slopes, abs=0.006)
    assert 1e4 * answer["hysteresis_friction_coefficient"].item() == pytest.approx(energy, abs=0.006)
    assert answer["residual"].item() < 1e-9


@pytest.mark.parametrize("direction", ["x", "-y", (1, 2)])
def test_full_contact_is_a_sum_over_waves(direction):
    rough = Surface(ROUGH.heights[:11, :15], pixel_size=SPACING)  # no shortest wave, which has no slope
    load = 30.0 * rough.heights.size * math.prod(SPACING)
    (state,), _ = states(SOFT, rough, load, [3.0], direction)
    assert state.in_contact.all()
    unit = np.array({"x": (0, 1), "-y": (-1, 0)}.get(direction, (1 * 1.5, 2 * 0.5)), dtype=float)
    qy, qx = waves(rough.heights.shape, SPACING)
    along = (unit[0] * qy + unit[1] * qx) / np.linalg.norm(unit)
    heights = np.abs(np.fft.fft2(rough.heights) / rough.heights.size) ** 2
    loss = 2.0 * relaxation(3.0 * along, BRANCHES).imag
    expected = float((np.hypot(qy, qx) / 2 * along * loss * heights).sum())
    area = rough.heights.size * math.prod(SPACING)
    assert state.friction / area == pytest.approx(expected, rel=1e-10)
    assert state.friction_of_slopes / area == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize(
    ("solid", "stiffness", "sites"),
    [
        (SOFT, stiffness_of_half_space, False),
        (
            asp.solids.layer(modulus=2.0, poisson=0.4, thickness=2.0, branches=BRANCHES),
            stiffness_of_layer,
            False,
        ),
        (LATTICE, stiffness_of_lattice, True),
    ],
    ids=["half-space", "layer", "lattice"],
)
@pytest.mark.parametrize("direction", ["x", "-y"])
def test_a_rough_surface_over_nine_decades_is_that_of_a_dense_program(solid, stiffness, sites, direction):
    heights, load = ROUGH.heights, 0.05 * AREA if not sites else 40.0
    spacing = (1.0, 1.0) if sites else SPACING
    qy, qx = waves(heights.shape, spacing)
    q = 4 * np.sin(qy / 2) ** 2 + 4 * np.sin(qx / 2) ** 2 if sites else np.hypot(qy, qx)
    along = {"x": qx, "-y": -qy}[direction]
    speeds, areas = np.geomspace(1e-5, 1e4, 10), []
    found, _ = states(solid, heights if sites else ROUGH, load, speeds, direction)
    count = np.array(12 if direction == "-y" else 16)
    with np.errstate(all="ignore"):
        for speed, state in zip(speeds, found, strict=True):
            spectrum = at_both_frequencies(stiffness, q, along, speed, count)
            spectrum.flat[0] = 0.0
            dense = Dense(heights - heights.max(), matrix_of(spectrum), hangs=False)
            dense.touching[:] = True
            y, level, force = dense.contact([], load=load)
            np.testing.assert_array_equal(state.in_contact.ravel(), dense.touching)
            np.testing.assert_allclose(state.force.ravel(), force * dense.touching, atol=1e-7 * force.max())
            np.testing.assert_allclose(state.u.ravel(), np.maximum(y + level, dense.heights), atol=1e-7)
            areas.append(state.in_contact.sum())
    assert areas[0] > areas[-1]
    assert len({*areas}) > 3


def test_a_film_follows_its_fit_and_nearly_the_correspondence_principle():
    film = asp.solids.coated_half_space(
        modulus=2.0,
        poisson=0.4,
        thickness=1.0,
        base_modulus=1.0,
        base_poisson=0.3,
        branches=[(0.8, 0.1)],
        base_branches=[(0.3, 10.0)],
    )
    speeds = np.geomspace(1e-3, 1e3, 7)
    found, profile = states(film, ROUGH, 0.1 * AREA, speeds)
    for speed, state in zip(speeds, found, strict=True):
        lattice = profile.lattice
        qy, qx = lattice.angles[0] / SPACING[0], lattice.angles[1] / SPACING[1]
        exact = exact_film(np.hypot(qy, qx), -speed * np.broadcast_to(qx, lattice.spectral_shape))
        compliance = np.zeros(exact.shape, dtype=complex)
        compliance.flat[1:] = 1 / exact.flat[1:]
        compliance[:, -1] = compliance[:, -1].real
        other = solved(Sliding(lattice, state.problem.heights, compliance, state.problem.slope, 0.1 * AREA))
        # The error of the fitted stiffness is `largest_error` of the instantaneous one.
        assert other.friction == pytest.approx(state.friction, rel=0.05, abs=2e-4 * 0.1 * AREA)
        assert np.mean(other.in_contact != state.in_contact) < 0.03


def exact_film(q, w, nu1=0.4, nu0=0.3, h=1.0):
    """O'Sullivan and King's stiffness with complex shear moduli."""
    film = 2.0 * (1 - nu1) / 2 * relaxation(w, [(0.8, 0.1)])
    base = 1.0 * (1 - nu0) / 2 * relaxation(w, [(0.3, 10.0)])
    x, g = q * h, film / base
    m = (g - 1) / (g + 3 - 4 * nu1)
    n = 1 - 4 * (1 - nu1) / (1 + g * (3 - 4 * nu0))
    near = np.exp(-2 * x)
    s = 1 + 4 * m * x * near - m * n * near**2
    s = s / (1 - (m + n + 4 * m * x**2) * near + m * n * near**2)
    return film * q / ((1 - nu1) * s) * math.prod(SPACING)


def relaxed_across(lattice):
    """Instantaneous stiffness of waves along the motion, relaxed of those across it, which stand still."""
    qy, qx = lattice.angles[0] / SPACING[0], lattice.angles[1] / SPACING[1]
    return np.hypot(qy, qx) * math.prod(SPACING) * np.where(qx == 0, 0.1, 1.0)


def springs_across(lattice):
    """The same of the lattice, whose mean does not relax."""
    along = np.broadcast_to(lattice.angles[1] != 0, lattice.spectral_shape).copy()
    along.flat[0] = True
    return lattice.lam + 3.0 * along


LINE = Surface(ROUGH.heights[0], pixel_size=PIXEL)
FAST: dict[str, Any] = {
    "line": (SOFT, LINE, 0.4, asp.solids.half_space(modulus=2.0)),
    "half-space": (
        SOFT,
        ROUGH,
        0.05 * AREA,
        asp.solids.Solid(permanent=relaxed_across, loaded_from_afar=True, in_lengths=True),
    ),
    "lattice": (LATTICE, ROUGH.heights, 40.0, asp.solids.Solid(permanent=springs_across)),
}


@pytest.mark.parametrize("case", FAST)
@pytest.mark.parametrize("speed", [1e-30, 1e30], ids=["slow", "fast"])
def test_very_slow_and_very_fast_it_is_a_press_without_friction(case, speed):
    solid, rough, load, fast = FAST[case]
    (state,), _ = states(solid, rough, load, [speed])
    pressed = (
        asp.press(rough, fast, load=load) if speed > 1 else asp.relax(asp.press(rough, solid, load=load))
    )
    assert (state.in_contact == pressed.in_contact).all()
    np.testing.assert_allclose(state.force, pressed.force, atol=1e-7 * pressed.force.max())
    assert abs(state.friction) < 1e-12 * load


def test_where_contacts_go_round_in_circles_the_loss_grows_by_steps(monkeypatch):
    # Almost a fluid, whose loss is many times its storage, on uncorrelated heights.
    times = (6.369303222655531, 0.03960053436782671, 5.568884971323022, 0.16774095147644733)
    solid = asp.solids.layer(
        modulus=1.0, poisson=0.45, thickness=3.0, branches=[(0.24975, time) for time in times]
    )
    heights = np.asarray(asp.surfaces.gaussian((16, 16), rms=1.0, seed=8))
    steps, grown = [], Sliding.with_loss

    def counted(problem, loss):
        steps.append(loss)
        return grown(problem, loss)

    monkeypatch.setattr(Sliding, "with_loss", counted)
    speed, load = 0.004796752362439784, 0.1675965251916564 * 256
    (state,), _ = states(solid, Surface(heights, pixel_size=(1.0, 1.0)), load, [speed])
    assert steps == [0.0, 0.25, 0.5, 0.75, 1.0]
    # Complementarity by other transforms.
    whole = np.fft.irfft2(state.problem.compliance * np.fft.rfft2(state.force), s=(16, 16))
    gap = whole - heights
    gap -= gap[state.in_contact].mean()
    assert state.force.min() >= 0
    assert gap.min() > -1e-6
    assert np.abs(gap[state.in_contact]).max() < 1e-6
    assert state.force[~state.in_contact].max() == 0
    assert state.force.sum() == pytest.approx(load)


@pytest.mark.parametrize("direction", ["x", "y"])
def test_friction_times_speed_is_what_the_branches_dissipate(direction):
    speeds = np.geomspace(1e-4, 1e4, 5)
    for speed, state in zip(speeds, states(SOFT, ROUGH, 0.05 * AREA, speeds, direction)[0], strict=True):
        qy, qx = waves(ROUGH.heights.shape, SPACING)
        along = {"x": qx, "y": qy}[direction]
        w, u = -speed * along, np.fft.fft2(state.problem.displacement(state.force))
        power = 0.0
        for share, time in BRANCHES:
            stiffness = share * 2.0 * np.hypot(qy, qx) / 2 * math.prod(SPACING)
            stretch = np.abs(1j * w / (1j * w + 1 / time) * u) ** 2
            stretch[np.isclose(np.abs(along), np.abs(along).max())] = 0  # the shortest waves have no slope
            power += float((stiffness * stretch / time).sum()) / u.size
        assert state.friction * speed == pytest.approx(power, rel=1e-9)
        assert state.friction > 0


def cylinder(speed, modulus=2.0, share=0.9, time=1.0, radius=100.0, load=1.0):
    """Half width and friction of a rigid cylinder on a half-space of one branch, as Hunter's (1961).

    With T = tau and T' = tau / (1 - share), u - V T' u' is the relaxed elastic surface under p - V T p',
    where the cylinder goes along x. The latter is of the second order in x over the square root of
    (a^2 - x^2). Three numbers follow from the load, from p = 0 at the trailing edge, and from the slope of
    the surface at the leading edge, where it comes from rest.
    """
    relaxed, late = (1 - share) * modulus, time / (1 - share)

    def terms(unknown):
        a, ahead = math.exp(unknown[0]), unknown[1]
        first = -relaxed * a / (2 * radius) * (ahead - speed * late)
        return a, ahead, (load / math.pi, first, -relaxed * a**2 / (4 * radius))

    def lacking(unknown):
        a, ahead, series = terms(unknown)
        k, q = a / (speed * time), a / (speed * late)
        trailing = np.dot(series, [ive(0, k), -ive(1, k), ive(2, k)])
        leading = np.dot(series, [kve(0, q), kve(1, q) - 1 / q, kve(2, q) - 2 / q - 2 / q**2])
        return trailing, -2 * q / (relaxed * a) * leading * radius / a + (ahead + a) / a

    width = math.sqrt(4 * load * radius / (math.pi * math.sqrt(relaxed * modulus)))
    found = root(lacking, [math.log(width), 0.3 * width], tol=1e-13)
    assert found.success
    a, ahead, series = terms(found.x)
    return a, (ahead * load + math.pi * series[1] * a / 2 - speed * time * load) / radius


@pytest.mark.parametrize("speed", [0.3, 1.0, 3.0])
def test_a_cylinder_is_that_of_hunter(speed):
    half, friction = cylinder(speed)
    x = (np.arange(4096) - 2048) / 64 * half  # images are 64 half widths apart
    surface = Surface(-(x**2) / 200, pixel_size=(half / 64,))
    solid = asp.solids.half_space(modulus=2.0, branches=[(0.9, 1.0)])
    answer = asp.steady_sliding(solid, surface, load=1.0, speeds=speed)
    assert answer["contact_area"].item() == pytest.approx(2 * half, rel=0.01)
    assert answer["hysteresis_friction_coefficient"].item() == pytest.approx(friction, rel=0.004)


@pytest.mark.slow
def test_a_slide_that_is_marched_in_time_comes_to_the_same_friction():
    sites, length = 32, 32e-6
    right = asp.steady_sliding(surface=wave(sites), pressure="10 kPa", **WAVE)
    right = right["hysteresis_friction_coefficient"].item()
    off, work = [], []
    for substeps in (1, 4):
        leg = asp.protocols.Slide(3 * length, 1e-5, substeps=substeps)
        start = asp.press(wave(sites), WAVE["solid"], pressure="10 kPa")
        data = asp.age(start, [0.0], protocol=leg).dataset
        spent = shifted_by(data)[0][-sites * substeps :].sum()
        work.append(spent / length / data["load"].values[0] / right - 1)
        data = data.isel(time=data["displacement"].values > 2 * length)
        friction, time = data["hysteresis_friction_coefficient"].values, data["time"].values
        off.append(np.trapezoid(friction, time) / np.ptp(time) / right - 1)
    assert abs(off[0]) < 0.012
    assert abs(off[1]) < 0.001
    assert np.abs(work).max() < 0.003


def shifted_by(data):
    """Work of each shift, beside that of the load; and mean friction times length."""
    way, friction, energy, load, approach = (
        data[name].values for name in ("displacement", "hysteresis_friction", "energy", "load", "approach")
    )
    after = np.flatnonzero(np.diff(way, prepend=way[0]) > 0)
    before = after - 1
    work = energy[after] - energy[before] - load[after] * (approach[after] - approach[before])
    return work, (friction[after] + friction[before]) / 2 * (way[after] - way[before])


@pytest.mark.parametrize("direction", ["x", "-y"])
@pytest.mark.parametrize(
    ("solid", "load", "error"), [(SOFT, 300.0, (np.pi / 32) ** 2 / 12), (LATTICE, 40.0, 0.01)]
)
def test_the_energy_that_a_shift_adds_is_friction_times_its_length(solid, load, error, direction):
    heights = asp.surfaces.spectral((24, 24), roll_off=24.0, cutoff=8.0, rms_slope=0.2, seed=1)
    surface = Surface(heights, pixel_size=SPACING) if solid is SOFT else heights
    leg = asp.protocols.Slide(4.0, 0.1, direction, substeps=8)
    data = asp.age(asp.press(surface, solid, load=load), [0.0], protocol=leg).dataset
    work, friction = shifted_by(data)
    assert work.sum() > 0
    np.testing.assert_allclose(work[8:], friction[8:], rtol=error)
    assert (data["contact_fraction"].values == 1).all() == (solid is SOFT)


def test_reflecting_edges_are_mirror_images_and_a_line_is_a_surface_of_ridges():
    how: dict[str, Any] = {"speeds": [0.1, 1.0, 10.0], "fields_at": [1.0], "shear_strength": 0.02}
    images = np.pad(ROUGH.heights, [(0, 12), (0, 16)], mode="symmetric")
    whole = asp.steady_sliding(SOFT, Surface(images, pixel_size=SPACING), load=4 * 0.05 * AREA, **how)
    edges = Surface(ROUGH.heights, pixel_size=SPACING, edges="reflecting")
    part = asp.steady_sliding(SOFT, edges, load=0.05 * AREA, **how)
    for name in part.data_vars:
        if str(name).endswith(("_low", "_high")):  # of the tiles of the scan
            continue
        copies = 4 if "area" in str(name) else 1
        expected = whole[name][..., :12, :16] if name == "pressure" else whole[name] / copies
        np.testing.assert_allclose(part[name], expected, rtol=1e-7, atol=1e-9)
    ridges = Surface(np.tile(ROUGH.heights[0], (6, 1)), pixel_size=(1.0, 0.5))
    alone, many = (asp.steady_sliding(SOFT, one, pressure=0.05, **how) for one in (LINE, ridges))
    for name in ("hysteresis_friction_coefficient", "contact_fraction", "mean_gap"):
        np.testing.assert_allclose(alone[name], many[name], rtol=1e-8)


def test_shear_strength_adds_its_friction_and_maps_have_the_pressure():
    how: dict[str, Any] = {"speeds": [0.1, 1.0, 10.0], "pressure": 0.05, "fields_at": [1.0]}
    law = asp.friction.ShearStrength(0.02, rate_coefficient=0.1, reference_velocity=1.0)
    answer = asp.steady_sliding(SOFT, ROUGH, shear_strength=law, **how)
    added = answer["friction_coefficient"] - answer["hysteresis_friction_coefficient"]
    strength = 0.02 * (1 + 0.1 * np.log([0.1, 1.0, 10.0]))
    np.testing.assert_allclose(added, strength * answer["contact_area_corrected"] / (0.05 * AREA))
    field = answer["pressure"].sel(field_speed=1.0)
    assert float(field.mean()) == pytest.approx(0.05)
    assert float(field.max()) == answer["largest_pressure"].values[1]
    assert np.count_nonzero(field) * math.prod(SPACING) == answer["contact_area"].values[1]
    assert answer["contact_area"].values[1] == answer["contact_fraction"].values[1] * AREA


def test_the_last_octave_is_remarked():
    rough = Surface(np.random.default_rng(0).normal(size=(16, 16)), pixel_size=(1.0, 1.0))
    with pytest.warns(asp.errors.Remark, match="last octave"):
        asp.steady_sliding(SOFT, rough, speeds=1.0, pressure=1.0)
    smooth = Surface(np.add.outer(*2 * [np.cos(np.arange(32) * np.pi / 16)]), pixel_size=(1.0, 1.0))
    share = asp.steady_sliding(SOFT, smooth, speeds=1.0, pressure=0.1)["last_octave"]
    assert 0 <= share.item() < 0.05


def test_in_full_contact_the_last_octave_is_the_share_of_its_waves():
    speeds = [0.01, 0.1, 1.0]
    answer = asp.steady_sliding(SOFT, ROUGH, speeds=speeds, pressure=30.0)
    assert (answer["contact_fraction"] == 1).all()
    qy, qx = waves(ROUGH.heights.shape, SPACING)
    nyquist = np.isclose(np.abs(qx), np.abs(qx).max())
    q, power = np.hypot(qy, qx), np.abs(np.fft.fft2(ROUGH.heights)) ** 2
    short = 2 * np.pi / np.where(q > 0, q, 1.0) < 4 * max(SPACING) * (1 - 1e-9)
    for speed, share in zip(speeds, answer["last_octave"].values, strict=True):
        parts = np.where(nyquist, 0.0, q * qx * relaxation(speed * qx, BRANCHES).imag * power)
        assert share == pytest.approx(parts[short].sum() / parts.sum(), rel=1e-9)


def test_an_elastic_solid_has_no_friction():
    answer = asp.steady_sliding(asp.solids.half_space(modulus=2.0), ROUGH, speeds=1.0, pressure=0.05)
    assert answer["hysteresis_friction_coefficient"].item() == 0


TABLE = Material(SOFT, span=(1e-3, 1e3))
FLUID = asp.solids.half_space(modulus=2.0, branches=[(0.5, 1.0), (0.5, 2.0)])


@pytest.mark.parametrize(
    ("change", "name", "got"),
    [
        ({"speeds": 0.0}, "speeds", "0"),
        ({"speeds": [-1.0, 1.0]}, "speeds", "-1"),
        ({"speeds": [2.0, 1.0]}, "speeds", "[2.0, 1.0]"),
        ({"speeds": []}, "speeds", "[]"),
        ({"pressure": None}, "load and pressure", "none"),
        ({"pressure": 0.0}, "pressure", "0.0"),
        ({"pressure": "1 Pa"}, "units", "'1 Pa'"),
        ({"speeds": "1 m/s"}, "units", "'1 m/s'"),
        ({"direction": "z"}, "direction", "'z'"),
        ({"direction": (1, 1, 1)}, "direction", "(1, 1, 1)"),
        ({"fields_at": [2.0]}, "fields_at", "2.0"),
        ({"shear_strength": -1.0}, "shear_strength", "-1.0"),
        ({"solid": FLUID}, "solid", "one that flows without end: the load sinks in at every speed"),
        ({"solid": FLUID, "direction": (1, 1)}, "solid", "one that flows without end"),
        ({"solid": SOFT.with_hardness(1.0)}, "hardness", "1"),
        (
            {"solid": asp.solids.half_space(modulus=2.0, adhesion=asp.solids.Dugdale(1.0, 0.1))},
            "adhesion",
            "Dugdale",
        ),
        (
            {"solid": asp.solids.half_space(modulus=2.0, creep=asp.solids.Eyring(1.0, 1.0))},
            "creep",
            "Eyring",
        ),
        ({"surface": Surface(ROUGH.heights, pixel_size=PIXEL, edges="free")}, "edges", "'free'"),
        ({"solid": TABLE, "speeds": 1e-5}, "speeds", "10 um/s"),
        ({"solid": TABLE, "speeds": 1e3}, "speeds", "1000 m/s"),
    ],
)
def test_bad_input_is_refused(change, name, got):
    how: dict[str, Any] = {"solid": SOFT, "surface": ROUGH, "speeds": 1.0, "pressure": 0.05} | change
    with refuses(name, got):
        asp.steady_sliding(**how)
    if how["solid"] is TABLE:
        asp.steady_sliding(**how, beyond_table=True)


def test_a_line_of_a_fluid_keeps_its_shape():
    answer = asp.steady_sliding(FLUID, LINE, speeds=[0.01, 0.1, 1.0], pressure=0.05)
    assert (np.diff(answer["contact_fraction"]) < 0).all()


@pytest.mark.parametrize("edges", ["periodic", "reflecting"])
def test_friction_of_tiles_adds_up(edges):
    surface = Surface(ROUGH.heights, pixel_size=SPACING, edges=edges)
    found, profile = states(SOFT, surface, 0.05 * AREA, [0.01, 1.0])
    for state in found:
        sums = {name: part.sum() for name, part in profile.tiles(state).items()}
        assert sums["friction"] == pytest.approx(state.friction, rel=1e-9)
        assert sums["load"] == pytest.approx(state.problem.load)
        assert sums["area"] == np.count_nonzero(state.in_contact)
        assert sums["sites"] == state.in_contact.size


def test_few_draws_of_the_solid_tell_what_all_give():
    random = np.random.default_rng(0)
    draws = [
        [(g * (1 + 0.01 * random.normal()), t * math.exp(0.1 * random.normal())) for g, t in BRANCHES]
        for _ in range(20)
    ]
    solid = asp.solids.half_space(modulus="2 Pa", branches=BRANCHES)
    meters, speeds = Surface(ROUGH.heights, "m", SPACING, "m"), np.geomspace(1e-3, 1e2, 6)
    computed, friction = [], "hysteresis_friction_coefficient"

    def curves(solid, stage=""):
        computed.append(stage)
        found = asp.steady_sliding(solid, meters, speeds=speeds, pressure=0.05)
        return {name: found[name].values for name in (friction, "contact_area")}

    middle, material = curves(solid), asp.relaxation.material(solid, draws=draws)
    waves = 2 * np.pi / 8, 2 * np.pi
    frequencies = waves[0] * speeds[0], waves[1] * speeds[-1]
    factors = draws_of_solid(material, middle, frequencies, curves)
    assert 2 <= len(computed) <= 7
    of_all = [curves(asp.solids.half_space(modulus="2 Pa", branches=each))[friction] for each in draws]
    right, found = np.log(of_all) - np.log(middle[friction]), np.log(factors[friction])
    # Contacts change by whole sites, of which the least has 42.
    missed = np.sqrt(np.mean((found - right) ** 2, axis=0))
    assert (missed < 0.25 * right.std(axis=0) + 0.25 / 42).all()
    np.testing.assert_allclose(found.std(axis=0), right.std(axis=0), rtol=0.15)
