"""Tilt, bow and spikes: what is removed, what is told, and what is left."""

from typing import Any

import numpy as np
import pytest

from asperity.surfaces import Surface, levelling, read, spectral
from tests.refusals import refuses

EDGES = "the contact would be at the edges"
U, V = np.meshgrid(np.linspace(-1, 1, 96), np.linspace(-1, 1, 80), indexing="ij")


@pytest.fixture(autouse=True)
def _folder(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def as_read(heights: Any, **options: Any) -> Surface:
    np.save("scan.npy", heights)
    return read("scan.npy", **{"periodic": "reflect", **options})


def rough(seed: int, **options: Any) -> Any:
    """A part of a larger surface, of rms height 1."""
    heights = spectral((256, 256), cutoff=4, seed=seed, **options)[:96, :80]
    return heights / heights.std()


@pytest.mark.parametrize(("rule", "order"), [("plane", 1), ("quadratic", 2)])
@pytest.mark.parametrize("shape", [(12, 9), (30,), (1, 8), (8, 1), (2, 7), (2, 2), (1, 1), (1,)])
def test_a_polynomial_is_removed_and_told(shape: Any, rule: Any, order: int) -> None:
    grids = np.meshgrid(*(np.arange(float(n)) for n in shape), indexing="ij")
    terms = [np.ones(shape), *grids]
    terms += [grids[a] * grids[b] for a in range(len(shape)) for b in range(a, len(shape))][
        : 99 * (order - 1)
    ]
    numbers = [5.1, *([0.25, -2.0][: len(shape)]), *([0.5, -0.125, 0.0625][: len(terms) - 1 - len(shape)])]
    heights = sum(number * term for number, term in zip(numbers, terms, strict=True))
    defined = np.ones(shape, dtype=bool)
    if heights.size > 20:
        defined.flat[[3, 11, 12]] = False
    left, found = levelling.remove_tilt(np.where(defined, heights, 1e3), defined, rule)
    np.testing.assert_allclose(left[defined], 0, atol=1e-11)
    np.testing.assert_allclose(left[~defined], (1e3 - heights)[~defined])
    if heights.size > 20:
        assert found == pytest.approx(numbers)
    told = sum(number * term for number, term in zip(found, terms, strict=True))
    np.testing.assert_allclose(told[defined], heights[defined])
    # Of anything else, what is left has nothing along any term.
    noise = np.random.default_rng(1).normal(size=shape) + 1e4
    left, _ = levelling.remove_tilt(noise, np.ones(shape, dtype=bool), rule)
    for term in terms:
        assert np.sum(left * term) == pytest.approx(0, abs=1e-8 * max(np.sum(np.abs(term)), 1))


def test_the_bow_of_a_scan_is_removed_as_it_was_added() -> None:
    heights = rough(1, roll_off=20)
    bowed = heights + 7 * U**2 + 11 * V**2 + 3 * U * V - 4 * U
    bowed[20:24, 30:33] = np.nan
    plain, found = (as_read(one, tilt="quadratic") for one in (heights, bowed))
    known = ~np.isnan(bowed)
    # Less of the heights' own long waves is seen where pixels are undefined.
    np.testing.assert_allclose(found.heights[known], plain.heights[known], atol=0.01)
    assert found.provenance["tilt_rule"] == "quadratic"
    array = Surface(heights + 7 * U**2 + 11 * V**2, "um", edges="reflecting").level("quadratic")
    np.testing.assert_allclose(array.heights, plain.heights, atol=1e-12)
    assert (array.unit, array.edges, array.provenance["tilt_rule"]) == ("um", "reflecting", "quadratic")


def test_spikes_are_filled_and_no_other_pixel() -> None:
    heights = rough(2, roll_off=20) + 30 * V  # a tilt that hides spikes and is bent by them
    dusty = heights.copy()
    places = (np.array([3, 40, 41, 90]), np.array([70, 10, 10, 50]))
    dusty[places] += [40, 400, 400, 12]
    found = as_read(dusty, despike=True)
    assert len(as_read(dusty).remarks) == 1
    assert found.remarks == ()
    assert (found.provenance["despiked_pixels"], found.provenance["outlying_pixels"]) == (4, 0)
    holed = dusty.copy()
    holed[places] = np.nan
    same = as_read(holed)
    np.testing.assert_array_equal(found.heights, same.heights)
    array = Surface(dusty, edges="reflecting").level(despike=True)
    np.testing.assert_array_equal(array.heights, same.heights)
    assert "despiked_pixels" not in same.provenance


def test_what_is_no_spike_stays() -> None:
    heights = rough(3)
    before, after = (as_read(heights, despike=wanted) for wanted in (False, True))
    np.testing.assert_array_equal(before.heights, after.heights)
    assert after.provenance["despiked_pixels"] == 0
    # Pillars on a fifth of a plate: heights, whatever the median says.
    plate = 0.01 * rough(4) + 5.0 * (np.arange(80) % 5 == 0)
    for attempt in (lambda: as_read(plate, despike=True), lambda: Surface(plate).level(despike=True)):
        with refuses("despike"):
            attempt()
    with refuses("tilt"):
        Surface(plate).level("parabola")  # type: ignore[arg-type]


@pytest.mark.parametrize("form", [U**2 + V**2, V**2, 0.4 * U**2 + V**2 + 0.5 * U * V])
def test_a_bow_that_puts_the_contact_at_the_edges_is_remarked(form: Any) -> None:
    for seed in range(3):
        bowed = rough(seed, roll_off=20) + 12 * form + 3 * U
        bowed[seed, 5] += 500.0  # which is most of the variance
        remarks = as_read(bowed).remarks
        assert [remark.startswith(EDGES) for remark in remarks] == [False, True]
        assert as_read(bowed, tilt="quadratic", despike=True).remarks == ()
        assert not [r for r in as_read(bowed, longest=20.0).remarks if r.startswith(EDGES)]
        assert Surface(bowed).level(despike=True).remarks[0].startswith(EDGES)
    # The same upside down touches in the middle.
    assert as_read(rough(0, roll_off=20) - 12 * form).remarks == ()


@pytest.mark.parametrize("options", [{"hurst": 0.5}, {"hurst": 0.8}, {"hurst": 0.8, "roll_off": 40.0}])
def test_self_affine_surfaces_have_no_bow(options: Any) -> None:
    fired = 0
    for seed in range(50):
        for heights in (rough(seed, **options), spectral((96, 96), cutoff=4, seed=seed, **options)):
            remarks = Surface(heights, edges="reflecting").level().remarks
            fired += any(remark.startswith(EDGES) for remark in remarks)
    assert fired <= (0 if "roll_off" in options else 1)


def test_small_and_flat_surfaces_tell_no_bow() -> None:
    for heights in (np.zeros((20, 20)), U[:3, :3] ** 2, np.arange(9.0), np.ones((1, 1))):
        assert levelling.bow(heights) == {"bow_variance": 0.0, "highest_at_edges": 0.0}
