"""Patches of contact, against flood fill, counting by hand, and chance."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, cast

import numpy as np
import pytest

from asperity.analysis import clustering, link_patches, patches, turnover
from asperity.lattice import Mask
from tests.refusals import refuses


def flooded(touching: Mask, connectivity: int = 1) -> list[set[tuple[int, ...]]]:
    """The patches by flood fill, site by site, on the periodic lattice."""
    around = np.ndindex(*(3,) * touching.ndim)
    steps = [step for step in around if 0 < sum(abs(s - 1) for s in step) <= connectivity]
    dry = {tuple(map(int, site)) for site in np.argwhere(touching)}
    found = []
    while dry:
        front = [dry.pop()]
        patch = set(front)
        while front:
            here = front.pop()
            for step in steps:
                there = tuple((x + s - 1) % n for x, s, n in zip(here, step, touching.shape, strict=True))
                if there in dry:
                    dry.remove(there)
                    patch.add(there)
                    front.append(there)
        found.append(patch)
    return found


def scattered(shape: tuple[int, ...], fraction: float, seed: int) -> Mask:
    return np.random.default_rng(seed).random(shape) < fraction


@pytest.mark.parametrize("connectivity", [1, 2])
@pytest.mark.parametrize("shape", [(40,), (2,), (1,), (17, 23), (24, 2), (1, 9), (3, 1)])
def test_patches_are_those_of_flood_fill(shape: tuple[int, ...], connectivity: int) -> None:
    for seed, fraction in enumerate((0.05, 0.4, 0.6, 0.9) * 2):
        touching = scattered(shape, fraction, seed)
        found = patches(touching, connectivity)
        expected = flooded(touching, connectivity)
        assert found.sizes.tolist() == sorted(map(len, expected), reverse=True)
        assert found.count == len(expected)
        # The labels are the same sets, numbered by size.
        labeled = [set(map(tuple, np.argwhere(found.labels == k + 1))) for k in range(found.count)]
        assert [len(patch) for patch in labeled] == found.sizes.tolist()
        assert set(map(frozenset, labeled)) == set(map(frozenset, expected))
        np.testing.assert_array_equal(found.labels == 0, ~touching)


def test_a_patch_around_the_corner_is_one() -> None:
    touching = np.zeros((8, 10), dtype=bool)
    touching[0, 0] = touching[0, -1] = touching[-1, 0] = touching[-1, -1] = True
    touching[3, :] = True  # around one axis
    touching[5, 5] = True
    found = patches(touching)
    assert found.sizes.tolist() == [10, 4, 1]
    assert (found.count, found.largest, found.mean_size) == (3, 10, 5.0)


def test_no_contact_has_no_patches() -> None:
    found = patches(np.zeros((4, 4), dtype=bool))
    assert (found.count, found.largest) == (0, 0)
    assert math.isnan(found.mean_size)
    assert patches(np.ones((4, 4), dtype=bool)).sizes.tolist() == [16]
    for full in (False, True):
        assert math.isnan(clustering(np.full((8, 8), full)))


@pytest.mark.parametrize(("shape", "box"), [((30, 30), 4), ((31, 26), 5), ((200,), 7), ((12, 12), None)])
def test_contacts_at_random_have_index_one(shape: tuple[int, ...], box: int | None) -> None:
    rng = np.random.default_rng(1)
    sites = math.prod(shape)
    for contacts in (max(2, sites // 20), sites // 2):
        values = []
        for _ in range(400):
            touching = np.zeros(sites, dtype=bool)
            touching[rng.choice(sites, contacts, replace=False)] = True
            values.append(clustering(touching.reshape(shape), box))
        # The index is 1 on average exactly: the mean is within 4 standard errors of it.
        assert abs(np.mean(values) - 1) < 4 * np.std(values) / math.sqrt(len(values))


def test_the_index_is_the_variance_over_boxes() -> None:
    touching = scattered((9, 12), 0.3, seed=3)
    fraction = touching.mean()
    counts = [np.roll(touching, (-i, -j), axis=(0, 1))[:4, :4].sum() for i in range(9) for j in range(12)]
    by_hand = np.var(counts) / (16 * fraction * (1 - fraction) * (108 - 16) / 107)
    assert clustering(touching, box=4) == pytest.approx(by_hand, rel=1e-12)


def test_the_default_box_holds_about_four_contacts() -> None:
    touching = scattered((128, 128), 0.04, seed=0)
    assert clustering(touching) == clustering(touching, box=round(math.sqrt(4 / touching.mean())))
    few = scattered((128, 128), 0.002, seed=0)
    assert clustering(few) == clustering(few, box=16)
    many = scattered((128, 128), 0.95, seed=0)
    assert clustering(many) == clustering(many, box=2)


@pytest.mark.parametrize("shape", [(50,), (20, 24)])
def test_turnover_counts_what_flood_fill_counts(shape: tuple[int, ...]) -> None:
    for seed in range(6):
        before, after = scattered(shape, 0.15, seed), scattered(shape, 0.3, seed + 100)
        found = turnover(before, after)
        attached = sum(
            bool(after[site]) and not before[site]
            for patch in flooded(before | after)
            if any(before[site] for site in patch)
            for site in patch
        )
        assert found.gained_attached == attached
        assert found.gained_attached + found.gained_detached == found.gained
        assert found.kept + found.lost == before.sum()
        assert found.kept + found.gained == after.sum()


MASK = np.zeros((8, 8), dtype=bool)


@pytest.mark.parametrize(
    ("name", "call"),
    [
        ("in_contact", lambda: patches(MASK.astype(np.int64))),
        ("in_contact", lambda: patches(np.zeros((2, 2, 2), dtype=bool))),
        ("in_contact", lambda: clustering(np.zeros(0, dtype=bool))),
        ("connectivity", lambda: patches(MASK, connectivity=3)),
        ("box", lambda: clustering(MASK, 1)),
        ("box", lambda: clustering(MASK, 5)),
        ("box", lambda: clustering(MASK, cast(Any, 2.5))),
        ("after", lambda: turnover(MASK, MASK[0])),
        ("before", lambda: turnover(MASK.astype(float), MASK)),
        ("after", lambda: link_patches(MASK, MASK[0])),
        ("edges", lambda: link_patches(MASK, MASK, edges=cast(Any, "open"))),
    ],
)
def test_bad_input_is_named(name: str, call: Callable[[], object]) -> None:
    with refuses(name):
        call()
