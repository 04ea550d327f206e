"""Patches found, measured, linked and followed, against flood fill, shapes by hand, counting, and chance."""

import math
from itertools import pairwise, product
from typing import Any, cast

import numpy as np
import pytest

import asperity as asp
from asperity.analysis import contact_ages, link_patches, patch_table, patch_tracks, patches, turnover
from asperity.lattice import Lattice, Mask
from asperity.patches import QUANTILES, clustering, clustering_box, map_series, quantiles, shapes_of
from asperity.results.quantities import select
from tests.refusals import each_refuses, refuses

SPRINGS = asp.solids.spring_lattice(k0=1.0, k1=3.0)
MASK = np.zeros((8, 8), dtype=bool)
BOTH = (1, 2)
"""Connectivities: by sides alone, and over corners too."""


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


@pytest.mark.parametrize("connectivity", BOTH)
@pytest.mark.parametrize("shape", [(40,), (1,), (17, 23), (24, 2), (1, 9)])
def test_patches_are_those_of_flood_fill(shape: tuple[int, ...], connectivity: int) -> None:
    for seed, fraction in enumerate((0.05, 0.4, 0.6, 0.9)):
        touching = scattered(shape, fraction, seed)
        found = patches(touching, connectivity)
        expected = flooded(touching, connectivity)
        assert found.sizes.tolist() == sorted(map(len, expected), reverse=True)
        assert (found.count, found.largest) == (len(expected), max(map(len, expected), default=0))
        assert found.mean_size == pytest.approx(
            touching.sum() / len(expected) if expected else math.nan, nan_ok=True
        )
        # The labels are the same sets, numbered by size.
        labeled = [set(map(tuple, np.argwhere(found.labels == k + 1))) for k in range(found.count)]
        assert [len(patch) for patch in labeled] == found.sizes.tolist()
        assert set(map(frozenset, labeled)) == set(map(frozenset, expected))
        np.testing.assert_array_equal(found.labels == 0, ~touching)


def test_no_contact_has_no_patches() -> None:
    found = patches(MASK)
    assert (found.count, found.largest) == (0, 0)
    assert math.isnan(found.mean_size)
    assert patches(~MASK).sizes.tolist() == [64]
    assert np.isnan([clustering(MASK), clustering(~MASK)]).all()
    assert clustering_box([MASK]) is None
    assert np.isnan(quantiles(np.empty(0))).all()


@pytest.mark.parametrize(("shape", "box"), [((31, 26), 5), ((200,), 7), ((12, 12), None)])
def test_contacts_at_random_have_index_one(shape: tuple[int, ...], box: int | None) -> None:
    rng = np.random.default_rng(1)
    sites = math.prod(shape)
    for contacts in (sites // 20, sites // 2):
        touching = np.arange(sites) < contacts
        values = [clustering(rng.permutation(touching).reshape(shape), box) for _ in range(400)]
        # The index is 1 on average exactly: the mean is within 4 standard errors of it.
        assert abs(np.mean(values) - 1) < 4 * np.std(values) / math.sqrt(len(values))


def test_the_index_is_the_variance_over_boxes() -> None:
    touching = scattered((9, 12), 0.3, seed=3)
    fraction = touching.mean()
    counts = [np.roll(touching, (-i, -j), axis=(0, 1))[:4, :4].sum() for i in range(9) for j in range(12)]
    by_hand = np.var(counts) / (16 * fraction * (1 - fraction) * (108 - 16) / 107)
    assert clustering(touching, box=4) == pytest.approx(by_hand, rel=1e-12)


def test_the_default_box_holds_about_four_contacts() -> None:
    for fraction, box in ((0.04, 10), (0.002, 16), (0.95, 2)):
        touching = scattered((128, 128), fraction, seed=0)
        assert clustering(touching) == clustering(touching, box)


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


def rolled(touching: Mask, by: tuple[int, ...]) -> Mask:
    return np.roll(touching, by, tuple(range(touching.ndim)))


def filled(shape: tuple[int, ...], *parts: tuple[slice, ...]) -> Mask:
    touching = np.zeros(shape, dtype=bool)
    for part in parts:
        touching[part] = True
    return touching


@pytest.mark.parametrize("shape", [(30,), (12, 15), (9, 2), (1, 8)])
def test_perimeters_are_counted_side_by_side(shape: tuple[int, ...]) -> None:
    spacing = (0.5, 2.0)[: len(shape)]
    for seed, connectivity in product(range(3), BOTH):
        touching = scattered(shape, 0.4, seed)
        found = shapes_of(touching, spacing, connectivity=connectivity)
        for number, perimeter in enumerate(found.perimeter, 1):
            own, total = found.patches.labels == number, 0.0
            for axis, step in product(range(len(shape)), (1, -1)):
                rims = np.count_nonzero(own & ~np.roll(touching, step, axis))
                total += rims * math.prod(spacing) / spacing[axis]
            assert perimeter == pytest.approx(total, rel=1e-14)


@pytest.mark.parametrize("by", [(0, 0), (8, 0), (-5, -9)])
def test_a_patch_has_the_center_and_axes_of_its_moments_wherever_the_seam_cuts_it(by):
    spacing = np.array([1.0, 2.0])
    for seed in range(10):
        blob = np.pad(scattered((8, 8), 0.6, seed), 4)
        found = shapes_of(rolled(blob, by), spacing.tolist(), connectivity=2)
        aspects = []
        for patch in flooded(blob, 2):
            sites = np.array(list(patch)) * spacing
            short, long = np.linalg.eigvalsh(np.cov(sites.T, ddof=0) + np.diag(spacing**2) / 12)
            aspects.append(math.sqrt(long / short))
            center = np.mod(sites.mean(axis=0) + by * spacing, (16.0, 32.0))
            assert np.abs(found.center - center).max(axis=1).min() < 1e-9
        np.testing.assert_allclose(np.sort(found.aspect), np.sort(aspects), rtol=1e-12)


def test_a_patch_around_the_lattice_has_no_ends() -> None:
    ring = filled((8, 10), (slice(3, 4), slice(None)), (slice(0, 1), slice(2, 4)))
    found = shapes_of(ring, (1.0, 1.0))
    assert np.isnan(found.aspect).tolist() == [True, False]
    assert np.isnan(found.center).tolist() == [[True, True], [False, False]]
    assert found.perimeter.tolist() == [20, 6]
    # Around both axes at once, by one diagonal step.
    helix = np.array([[1, 1, 0, 0], [0, 1, 1, 0], [0, 0, 1, 1], [1, 0, 0, 1]], dtype=bool)
    assert np.isnan(shapes_of(helix, (1.0, 1.0)).aspect).tolist() == [True]


def test_reflecting_edges_join_nothing_and_are_no_rim() -> None:
    touching = filled((6, 8), (slice(0, 2), slice(0, 2)), (slice(0, 2), slice(6, 8)))
    found = shapes_of(touching, (1.0, 1.0), "reflecting")
    assert (found.patches.count, found.perimeter.tolist()) == (2, [4, 4])
    assert shapes_of(touching, (1.0, 1.0)).patches.count == 1


@pytest.mark.parametrize("connectivity", BOTH)
@pytest.mark.parametrize("shape", [(40,), (13, 16), (18, 2)])
def test_links_are_those_of_flood_fill(shape: tuple[int, ...], connectivity: int) -> None:
    for seed in range(10):
        fraction = (0.1, 0.3, 0.5, 0.6, 0.8)[seed % 5]
        first, last = scattered(shape, fraction, seed), scattered(shape, 0.4, seed + 1000)
        if seed % 2:
            last |= first  # creep, which mostly adds sites
        links = link_patches(first, last, connectivity)
        old, new = flooded(first, connectivity), flooded(last, connectivity)
        before, after = (patches(one, connectivity) for one in (first, last))
        # Numbers of the patches of flood fill, by any of their sites.
        pairs = {
            (int(before.labels[min(a)]), int(after.labels[min(b)])): len(a & b)
            for a, b in product(old, new)
            if a & b
        }
        assert dict(zip(map(tuple, links.pairs.tolist()), links.shared.tolist(), strict=True)) == pairs
        parents = [sum(bool(a & b) for a in old) for b in new]
        children = [sum(bool(a & b) for b in new) for a in old]
        assert (links.births, links.deaths) == (parents.count(0), children.count(0))
        assert links.merges == sum(max(n - 1, 0) for n in parents)
        assert links.splits == sum(max(n - 1, 0) for n in children)
        gained = np.array([len(b.difference(*old)) for b in new])
        for name, chosen in (("births", 0), ("expansion", 1), ("coalescence", 2)):
            assert getattr(links, f"gained_by_{name}") == gained[np.minimum(parents, 2) == chosen].sum()
        lost = np.array([len(a.difference(*new)) for a in old])
        assert links.lost_by_deaths == lost[np.array(children) == 0].sum()
        # A patch continues the one with which it shares most, if that is mutual.
        for number, taken in enumerate(links.continued.tolist(), 1):
            if taken:
                own = {p: n for p, n in pairs.items() if number == p[1]}
                its = {p: n for p, n in pairs.items() if taken == p[0]}
                assert pairs[taken, number] == max(own.values()) == max(its.values())


def maps_of(shape: tuple[int, ...], seed: int, count: int = 7) -> list[Mask]:
    """Maps that grow here and shrink there."""
    rng = np.random.default_rng(seed)
    maps = [rng.random(shape) < 0.3]
    for _ in range(count - 1):
        maps.append((maps[-1] | (rng.random(shape) < 0.1)) & ~(rng.random(shape) < 0.1))
    return maps


@pytest.mark.parametrize("shape", [(40,), (12, 17)])
def test_ages_are_counted_back_map_by_map(shape: tuple[int, ...]) -> None:
    times = [0.0, 0.5, 2.0, 2.0, 7.0, 30.0, 100.0]
    maps = maps_of(shape, 3)
    series = map_series(maps, times, Lattice(shape))
    for number, touching in enumerate(maps):
        ages = []
        for site in map(tuple, np.argwhere(touching)):
            free = [earlier for earlier in range(number) if not maps[earlier][site]]
            ages.append(times[number] - times[max(free, default=-1) + 1])
        assert series["mean_contact_age"][number] == pytest.approx(np.mean(ages), rel=1e-13)
        expected = np.quantile(ages, QUANTILES, method="inverted_cdf")
        np.testing.assert_allclose(series["contact_age"][number], expected, rtol=1e-13)


@pytest.mark.parametrize("shape", [(40,), (12, 17), (3, 5)])
def test_the_series_is_that_of_its_maps(shape: tuple[int, ...]) -> None:
    maps, lattice = maps_of(shape, 8), Lattice(shape)
    series = map_series(maps, np.arange(7.0).tolist(), lattice)
    assert {*series, "contact_pressure"} == {
        name for name in select("map") if name != "mean_patch_aspect" or len(shape) == 2
    }
    box = clustering_box(maps)
    for number, touching in enumerate(maps):
        sizes = np.array(sorted(map(len, flooded(touching))))
        row = {name: values[number] for name, values in series.items()}
        assert (row["patches"], row["largest_patch_size"]) == (sizes.size, sizes[-1])
        assert row["mean_patch_size"] == pytest.approx(sizes.mean())
        assert row["median_patch_size"] == np.median(sizes)
        assert row["perimeter"] == sum(
            np.count_nonzero(touching != np.roll(touching, 1, axis)) for axis in range(touching.ndim)
        )
        expected = math.nan if box is None else clustering(touching, box)
        np.testing.assert_equal(row["clustering"], expected)
        if len(shape) == 2:
            shapes = shapes_of(touching, (1.0, 1.0))
            each = [float(shapes.aspect[n - 1]) for n in shapes.patches.labels[touching]]
            ended = [one for one in each if not math.isnan(one)]
            mean = float(np.mean(ended)) if ended else math.nan
            assert row["mean_patch_aspect"] == pytest.approx(mean, nan_ok=True)
    change = series["births"] - series["deaths"] + series["splits"] - series["merges"]
    np.testing.assert_array_equal(series["patches"][0] + np.cumsum(change), series["patches"])
    gained = np.sum([series[name] for name in series if name.startswith("gained_by")], axis=0)
    growth = gained - np.sum([series[name] for name in series if name.startswith("lost_by")], axis=0)
    area = np.count_nonzero(maps, axis=tuple(range(1, len(shape) + 1)))
    np.testing.assert_array_equal(area[0] + np.cumsum(growth), area)


def test_maps_without_contact_have_no_sizes_and_no_ages() -> None:
    some = filled((8, 8), (slice(2, 5), slice(1, 7)))
    series = map_series([MASK, some, MASK], [0.0, 1.0, 3.0], Lattice((8, 8)))
    for name, expected in (
        ("patches", [0, 1, 0]),
        ("births", [0, 1, 0]),
        ("deaths", [0, 0, 1]),
        ("gained_by_births", [0, 18, 0]),
        ("lost_by_deaths", [0, 0, 18]),
        ("mean_patch_size", [math.nan, 18, math.nan]),
    ):
        np.testing.assert_array_equal(series[name], expected, err_msg=name)
    assert series["contact_age"][1].tolist() == [0.0] * len(QUANTILES)
    assert np.isnan(series["contact_age"][2]).all()


@pytest.fixture(scope="module")
def history() -> asp.results.History:
    rough = asp.surfaces.gaussian((32, 24), rms=1.0, seed=4)
    contact = asp.press(rough, SPRINGS, load=300.0)
    legs = [asp.protocols.Hold(2.0), asp.protocols.Step(load=150.0), asp.protocols.Hold(8.0)]
    return asp.age(contact, [1.0, 10.0], protocol=legs, fields_at=[0.0, 0.5, 2.0, 5.0, 10.0])


def test_every_dataset_with_fields_has_the_series(history: asp.results.History) -> None:
    dataset, final = history.dataset, history.final
    maps, times = dataset["in_contact"].values, dataset["field_time"].values.tolist()
    assert len(times) == 6  # two at the step
    for name, values in map_series(maps, times, final.lattice).items():
        np.testing.assert_array_equal(dataset[name].values, values)
        assert dataset[name].attrs["long_name"] == select("map")[name].long_name
    assert dataset["deaths"].sum() > 0  # unloading
    assert dataset["births"].sum() > 0
    assert dataset["clustering"].attrs["box"] == clustering_box(maps)
    pressure = quantiles(final.pressure[final.in_contact])
    np.testing.assert_array_equal(dataset["contact_pressure"][-1], pressure)
    assert dataset["contact_pressure"].sel(quantile=1.0)[-1] == final.largest_pressure
    without = asp.age(final, [1.0]).dataset
    assert not set(select("map")) & set(map(str, without.variables))


def test_a_table_of_patches_adds_up(history: asp.results.History) -> None:
    table = patch_table(history.final)
    of_map = patch_table(history.dataset.isel(field_time=-1))
    for name in table.variables:
        np.testing.assert_allclose(of_map[name], table[name], rtol=1e-9, atol=1e-9)
        assert of_map[name].attrs == table[name].attrs
    columns = "patch size perimeter aspect y x load mean_pressure largest_pressure"
    assert " ".join(table.to_dataframe().reset_index().columns) == columns
    heights = np.round(1e-7 * np.random.default_rng(0).normal(size=(24, 16)), 9)
    rough = asp.surfaces.Surface(heights, unit="m", pixel_size=(1e-6, 2e-6), length_unit="m")
    contact = asp.press(rough, asp.solids.half_space(modulus=1e9), pressure=1e6)
    table = patch_table(contact)
    assert table.sizes["patch"] == patches(contact.in_contact).count
    assert int(table["size"].sum()) == contact.area
    assert float(table["contact_area"].sum()) == pytest.approx(contact.contact_area, rel=1e-12)
    assert float(table["load"].sum()) == pytest.approx(contact.load, rel=1e-12)
    assert float(table["largest_pressure"].max()) == contact.largest_pressure
    np.testing.assert_allclose(table["mean_pressure"] * table["contact_area"], table["load"], rtol=1e-12)
    assert {name: table[name].attrs["units"] for name in map(str, table.data_vars)} == {
        **{"size": "sites", "contact_area": "m^2", "perimeter": "m", "aspect": "1", "y": "m", "x": "m"},
        **{"load": "N", "mean_pressure": "Pa", "largest_pressure": "Pa"},
    }
    series = asp.age(contact, [1.0], fields_at=[0.0])
    names = ("perimeter", "contact_pressure", "mean_contact_age")
    assert [series[name].attrs["units"] for name in names] == ["m", "Pa", "s"]
    assert series["perimeter"].item() == pytest.approx(float(table["perimeter"].sum()))


def test_tracks_follow_each_patch(history: asp.results.History) -> None:
    dataset = history.dataset
    found = patch_tracks(dataset)
    entries, tracks, links = found.patches, found.tracks, found.links
    maps = dataset["in_contact"].values
    own = [entries["track"][entries["map"] == number].values for number in range(len(maps))]
    born, died = tracks["birth"].values, tracks["death"].values
    for number, touching in enumerate(maps):
        sizes = entries["size"][entries["map"] == number].values.tolist()
        assert sizes == patches(touching).sizes.tolist()
        # A track has ended, or is there once.
        time = float(dataset["field_time"][number])
        assert set(own[number]) <= set(np.flatnonzero((born <= time) & ~(died < time)))
        assert np.unique(own[number]).size == own[number].size
    for number, (first, last) in enumerate(pairwise(maps), 1):
        link, here = link_patches(first, last), links["map"] == number
        old, new = own[number - 1], own[number]
        np.testing.assert_array_equal(links["shared"][here], link.shared)
        np.testing.assert_array_equal(links["before"][here], old[link.pairs[:, 0] - 1])
        np.testing.assert_array_equal(links["after"][here], new[link.pairs[:, 1] - 1])
        assert np.intersect1d(old, new).size == np.count_nonzero(link.continued)
    for column, name, expected in (
        ("origin", "first map", dataset["patches"][0]),
        ("origin", "new", dataset["births"].sum()),
        ("end", "last map", dataset["patches"][-1]),
        ("end", "gone", dataset["deaths"].sum()),
    ):
        assert (tracks[column] == name).sum() == expected
    np.testing.assert_array_equal(tracks["parent"] >= 0, tracks["origin"] == "split")
    np.testing.assert_array_equal(tracks["heir"] >= 0, tracks["end"] == "merged")
    np.testing.assert_array_equal(np.isnan(died), tracks["end"] == "last map")
    for track in range(tracks.sizes["track"]):
        one = entries["size"][entries["track"] == track]
        assert (one.size, int(one.max())) == (int(tracks["maps"][track]), int(tracks["largest_size"][track]))


def test_a_split_and_a_merge_have_names() -> None:
    """A bar of seven sites loses one near its end; then a bridge joins it with another bar."""
    bar = filled((12, 12), (slice(2, 3), slice(1, 8)), (slice(6, 7), slice(1, 4)))
    split = bar & ~filled((12, 12), (slice(2, 3), slice(3, 4)))
    joined = split | filled((12, 12), (slice(2, 7), slice(6, 7)), (slice(6, 7), slice(1, 8)))
    rough = asp.surfaces.gaussian((12, 12), rms=1.0, seed=1)
    start = asp.age(asp.press(rough, SPRINGS, load=50.0), [3.0], fields_at=[1.0, 2.0, 3.0]).dataset
    dataset = start.assign(in_contact=(start["in_contact"].dims, np.stack([bar, split, joined])))
    columns = ["origin", "parent", "end", "heir", "birth", "largest_size"]
    assert patch_tracks(dataset).tracks.to_dataframe()[columns].values.tolist() == [
        ["first map", -1, "last map", -1, 1.0, 14],
        ["first map", -1, "merged", 0, 1.0, 3],
        ["split", 0, "last map", -1, 2.0, 2],
    ]


def test_ages_of_all_sites_are_those_of_the_series(history: asp.results.History) -> None:
    ages = contact_ages(history.dataset)
    assert ages.dims == ("field_time", "y", "x")
    assert ages.attrs["units"] == history["contact_age"].attrs["units"]
    np.testing.assert_array_equal(np.isnan(ages), ~history["in_contact"].values)
    np.testing.assert_allclose(ages.mean(["y", "x"]), history["mean_contact_age"])
    np.testing.assert_allclose(ages.max(["y", "x"]), history["contact_age"].sel(quantile=1.0))


def test_what_has_no_fields_is_refused(history: asp.results.History) -> None:
    without = asp.age(history.final, [1.0]).dataset
    for function in (patch_tracks, contact_ages):
        each_refuses(("dataset", "none", function, without), ("dataset", "History", function, history))
    each_refuses(
        *(("image", patch_table, image) for image in (history.dataset, without, history.final.in_contact)),
        got="fields of 6 times | Dataset | ndarray",
    )
    with refuses("connectivity", "3"):
        patch_table(history.final, connectivity=3)


def test_while_the_surface_slides_ages_are_those_of_the_body() -> None:
    """Farther than patches are long, patches are others and young; followed on the surface, they are old."""
    rough = asp.surfaces.spectral((48, 48), hurst=0.8, roll_off=12.0, rms_slope=0.5, seed=2)
    legs = [asp.protocols.Hold(1.0), asp.protocols.Slide(24.0, 240.0), asp.protocols.Hold(1.0)]
    contact = asp.press(rough, SPRINGS, load=150.0)
    data = asp.age(contact, [2.1], protocol=legs, fields_at=[0.0, 0.1, 1.0, 1.1, 2.1]).dataset
    times = data["field_time"].values.tolist()
    at = times.index(1.1)
    assert data["mean_contact_age"][at] < 0.05
    assert data["deaths"][at] > 0.8 * data["patches"][at - 1]
    moved = zip(data["in_contact"].values, data["field_shift_x"].values.astype(int), strict=True)
    back = [np.roll(one, -shift, axis=1) for one, shift in moved]
    followed = map_series(back, times, contact.lattice)
    assert followed["mean_contact_age"][at] > 0.9


def test_bad_input_is_named() -> None:
    each_refuses(
        ("in_contact", "8", lambda: patches(MASK.astype(np.int64))),
        ("in_contact", "2", lambda: patches(np.zeros((2, 2, 2), dtype=bool))),
        ("in_contact", "bool of shape (0,)", lambda: clustering(np.zeros(0, dtype=bool))),
        ("connectivity", "3", lambda: patches(MASK, connectivity=3)),
        ("box", "1", lambda: clustering(MASK, 1)),
        ("box", "5", lambda: clustering(MASK, 5)),
        ("box", "2.5", lambda: clustering(MASK, cast(Any, 2.5))),
        ("after", "(8,)", lambda: turnover(MASK, MASK[0])),
        ("before", "8", lambda: turnover(MASK.astype(float), MASK)),
        ("after", "(8,)", lambda: link_patches(MASK, MASK[0])),
        ("edges", "'open'", lambda: link_patches(MASK, MASK, edges=cast(Any, "open"))),
    )


def test_boxes_and_rims_are_those_of_the_body() -> None:
    y, x = np.mgrid[:64, :64] - 31.5
    body, random = np.hypot(y, x) < 31, np.random.default_rng(0)
    places = np.flatnonzero(body)
    values = []
    for _ in range(400):
        touching = np.zeros(body.size, dtype=bool)
        touching[random.choice(places, 180, replace=False)] = True
        values.append(clustering(touching.reshape(body.shape), edges="free", body=body))
    assert abs(np.mean(values) - 1) < 4 * np.std(values) / math.sqrt(len(values))
    solid = asp.solids.half_space(modulus=3e9)
    rough = np.asarray(asp.surfaces.spectral((24, 30), roll_off=16.0, cutoff=4.0, rms_slope=0.1, seed=3))
    found = []
    for heights in (rough, np.pad(rough, ((5, 3), (4, 8)), constant_values=-np.inf)):
        surface = asp.surfaces.Surface(heights, "um", (1.0, 1.0), "um", edges="free")
        data = asp.age(asp.press(surface, solid, load=0.02), [1.0], fields_at=[0.0]).dataset
        found.append([float(data[name][0]) for name in ("clustering", "perimeter", "area")])
    np.testing.assert_allclose(found[0], found[1], rtol=1e-9)
    punch = asp.surfaces.Surface(np.zeros((24, 24)), "um", (1.0, 1.0), "um", edges="free")
    np.testing.assert_allclose(patch_table(asp.press(punch, solid, load=1e-3))["perimeter"], [96e-6])
