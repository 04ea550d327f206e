"""The plan of a campaign: a run configuration with lists in it, spread out into single runs.

The file is that of ``asperity run``, or of another question, with one more section::

    [sweep]
    load = [200.0, 800.0]     # any key of [surface], [solid], [contact], or [aging] hold and rtol
    protocol.1.load = [160.0] # or a number in a leg of [[protocol]], counted from 0
    branches.0.time = [1.0, 10.0]  # or an entry of a list: share or time of a branch, counted from 0
    k1 = [1.0, 3.0, 10.0]
    seeds = 32                # so many from the surface's seed on, or a list
    combine = "grid"          # every load with every k1; "zip" takes them pairwise
"""

from __future__ import annotations

import copy
import hashlib
import itertools
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from asperity.app.config import RunConfig, config_from, read_tables, to_tables
from asperity.app.config.reading import question_of
from asperity.ask.questions import question_named
from asperity.ask.run import FILES, ORDER
from asperity.ask.section import KINDS, kind_in
from asperity.base.calls import remark
from asperity.base.files import expanded
from asperity.base.readable import written
from asperity.base.version import __version__
from asperity.base.words import InUnits, has_unit, reason_of
from asperity.errors import SHOWN_PROBLEMS, ConfigError, InputError
from asperity.results.parameters import IN_A_LEG

Value = float | int | str
Lists = dict[tuple[str, str], list[Any]]
"""Swept values, as they are written, by section and name."""


_STORE_FORMAT = 4

MOST_RUNS = 100_000
"""Runs of one campaign: each is a folder of files, and its plan is held in memory whole."""


@dataclass(frozen=True)
class Axis:
    """A swept parameter: its section, its name, and its values as coordinates."""

    section: str
    name: str
    values: tuple[Value, ...]


@dataclass(frozen=True)
class Run:
    """One run: a hash of its inputs, its place along the axes, its seed, its configuration.

    The content is the checksum (SHA-256) of the files that it reads; empty where there are none.
    """

    identity: str
    point: tuple[int, ...]
    seed: int | None
    config: RunConfig
    content: str = ""


@dataclass(frozen=True)
class Plan:
    """All runs of a campaign.

    Attributes
    ----------
    axes
        The swept parameters, without the seed.
    seeds
        The seeds; empty for surfaces that are not random, which have none.
    zipped
        Whether the axes go pairwise, along one dimension ``point``.
    runs
        In the order of the grid, seeds fastest.
    """

    axes: tuple[Axis, ...]
    seeds: tuple[int, ...]
    zipped: bool
    runs: tuple[Run, ...]

    @property
    def distinct(self) -> dict[str, Run]:
        """Runs by identity, each once, although two points may coincide."""
        return {run.identity: run for run in self.runs}

    @property
    def swept(self) -> dict[str, tuple[Value, ...]]:
        """Values of each swept parameter, and the seeds if there are any."""
        return {axis.name: axis.values for axis in self.axes} | ({"seed": self.seeds} if self.seeds else {})

    @property
    def dimensions(self) -> dict[str, tuple[Value, ...]]:
        """Values along each dimension of the results: swept parameters (or ``point``), and the seed."""
        if not (self.zipped and self.axes):
            return self.swept
        points: dict[str, tuple[Value, ...]] = {"point": tuple(range(len(self.axes[0].values)))}
        return points | ({"seed": self.seeds} if self.seeds else {})

    def place(self, run: Run) -> tuple[int, ...]:
        """Place of a run along the dimensions."""
        swept = run.point[:1] if self.zipped else run.point
        return swept if run.seed is None else (*swept, self.seeds.index(run.seed))

    def labels(self, run: Run) -> dict[str, Value]:
        """Value of each swept parameter, of the dimensions, and the seed of a run."""
        swept = {axis.name: axis.values[at] for axis, at in zip(self.axes, run.point, strict=True)}
        along = zip(self.dimensions.items(), self.place(run), strict=True)
        return swept | {name: values[at] for (name, values), at in along}


def read_plan(path: str | Path) -> Plan:
    """Read and check a campaign.

    Parameters
    ----------
    path
        The TOML file.

    Raises
    ------
    ConfigError
        With one line for each mistake in any of the runs, or for more than 100,000 runs; nothing has
        been started.
    """
    path = expanded(path)
    tables = read_tables(path)
    swept = tables.pop("sweep", {})
    if not isinstance(swept, dict):
        raise ConfigError([f"{path}: sweep: expected a section [sweep], got {swept!r}"])
    problems: list[str] = []
    surface, solid = (
        table if isinstance(table := tables.get(name), dict) else {} for name in ("surface", "solid")
    )
    kind = str(surface.get("kind", "file" if "path" in surface or "path" in swept else "gaussian"))
    combine = swept.pop("combine", "grid")
    if combine not in ("grid", "zip"):
        problems.append(f"[sweep] combine: expected 'grid' or 'zip', got {combine!r}")
    seeds = _seeds(swept.pop("seeds", None), surface.get("seed", 0), kind, problems)
    kinds = {"surface": kind, "solid": str(kind_in("solid", solid))}
    question = question_of(tables)
    unused = question_named(question).unused
    lists: Lists = dict(_lists(swept, kinds, question, problems))
    lengths = {name: len(values) for (_, name), values in lists.items()}
    if combine == "zip" and len(set(lengths.values())) > 1:
        got = ", ".join(f"{name} {length}" for name, length in lengths.items())
        problems.append(f"[sweep]: expected lists of one length for combine = 'zip', got {got}")
    elif combine == "grid" and (total := math.prod(lengths.values()) * max(1, len(seeds))) > MOST_RUNS:
        got = " x ".join(f"{name} {length}" for name, length in (lengths | {"seeds": len(seeds)}).items())
        problems.append(
            f"[sweep]: expected at most {MOST_RUNS:,} runs, got {total:,} ({got}); try several campaigns"
        )
    output = tables.setdefault("output", {})
    if isinstance(output, dict):
        if "output" not in unused:
            output.setdefault("maps_at", [])
        if "measured" in output:
            problems.append("[output] measured: expected none in a campaign, whose runs are many curves")
    if problems:
        problems = [f"{path}: {problem}" for problem in problems]
        try:  # the rest of the file may hold mistakes too
            config_from(tables, {}, path)
        except ConfigError as error:
            problems += error.problems
        raise ConfigError(problems)
    runs = _runs(tables, lists, seeds, path, zipped=combine == "zip")
    spans = {tuple(run.config.aging.times or run.config.span) for run in runs}
    if len(spans) > 1 and "aging" not in unused:
        advice = "first and last in [aging]"
        raise ConfigError([f"{path}: [aging]: expected the same times for all runs; try {advice}"])
    axes = tuple(
        _axis(section, name, values, {run.point[number]: run.config for run in runs})
        for number, ((section, name), values) in enumerate(lists.items())
    )
    for axis in axes:
        if len(set(axis.values)) < len(axis.values):
            raise ConfigError([f"{path}: [sweep] {axis.name}: expected different values, got {axis.values}"])
    return Plan(axes, seeds, combine == "zip", runs)


def plan_to_json(plan: Plan) -> str:
    """Write a plan as `load_plan` reads it."""
    axes = [[axis.section, axis.name, axis.values] for axis in plan.axes]
    runs = [[run.identity, run.point, run.seed, with_units(run.config), run.content] for run in plan.runs]
    return json.dumps({"axes": axes, "seeds": plan.seeds, "zipped": plan.zipped, "runs": runs})


def with_units(config: RunConfig) -> Any:
    """Tables of a configuration for JSON, whose numbers with a unit keep it: a run may have none."""

    def written_out(value: Any) -> Any:
        if isinstance(value, InUnits):
            return f"{value!r} {value.unit}"
        if isinstance(value, dict):
            return {name: written_out(one) for name, one in value.items()}
        return [written_out(one) for one in value] if isinstance(value, list | tuple) else value

    return written_out(to_tables(config))


def load_plan(directory: str | Path) -> Plan:
    """Read the plan that a campaign was last given.

    Raises
    ------
    InputError
        The folder holds no campaign.
    """
    path = expanded(directory) / "plan.json"
    try:
        facts = json.loads(path.read_text(encoding="utf-8"))
        axes = tuple(Axis(section, name, tuple(values)) for section, name, values in facts["axes"])
        configs: dict[tuple[int, ...], RunConfig] = {}
        runs = []
        for identity, place, seed, tables, content in facts["runs"]:
            # The runs of one point differ by their seed only, and checking is what takes the time.
            point = tuple(place)
            if point not in configs:
                configs[point] = RunConfig.read(tables)
            config = configs[point] if seed is None else seeded(configs[point], seed)
            runs.append(Run(identity, point, seed, config, content))
        plan = Plan(axes, tuple(facts["seeds"]), facts["zipped"], tuple(runs))
        for run in plan.runs:
            plan.labels(run)  # as long as every run has its place along the axes and among the seeds
        return plan
    except Exception as error:  # a damaged byte leads anywhere
        reason = "no such campaign" if isinstance(error, FileNotFoundError) else reason_of(error)
        raise InputError(
            "campaign", expected="a folder that asperity sweep wrote", got=f"{directory}: {reason}"
        ) from error


def name_of(plan: Plan, *runs: Run, units: Mapping[str, str] | None = None) -> str:
    """Name runs by the swept values that they share: ``load = 4, seed = 2``."""
    several = {name for name, values in plan.swept.items() if len(values) > 1}
    first, *others = (plan.labels(run) for run in runs)
    shared = [
        f"{name} = {value if isinstance(value, str) else written(value, (units or {}).get(name) or '1')}"
        for name, value in first.items()
        if name in several and all(labels[name] == value for labels in others)
    ]
    return ", ".join(shared) or ("the run" if len(plan.runs) == 1 else "several")


def _lists(
    swept: dict[str, Any], kinds: Mapping[str, object], question: str, problems: list[str]
) -> Iterator[tuple[tuple[str, str], list[Any]]]:
    """Find the section of each swept key; ``solid.k1 = [...]`` may name it."""
    sections = (*ORDER, *filter(None, [question]))
    homes = {name: one for one in sections for each in KINDS[one].values() for name in each.keys}
    able = _swept_keys({}, question)
    lists: dict[str, None] = {}
    for path, values in _paths(swept):
        head, _, rest = path.partition(".")
        section, name = (head, rest) if head in sections and rest else (None, path)
        key = name.split(".")[0]
        where = f"[sweep] {name}"
        if name in lists:
            problems.append(f"{where}: given twice")
        lists[name] = None
        if head == "protocol":
            section, sweepable = head, name.split(".")[-1] in IN_A_LEG
            advice = f"{', '.join(IN_A_LEG)} of a leg can: protocol.1.load = [...]"
        else:
            sweepable = key in able
            others = f"these can: {', '.join(_swept_keys(kinds, question))}"
            advice = "try seeds" if name == "seed" else others
            if key not in homes or section not in (None, homes[key]):
                shown = len(problems) < SHOWN_PROBLEMS
                close = get_close_matches(name, [*homes, "seeds", "combine"], n=1) if shown else []
                hint = f"; did you mean {close[0]!r}?" if close else ""
                problems.append(f"{where}: no such key{hint}")
                continue
        if not sweepable:
            problems.append(f"{where}: cannot be swept; {advice}")
        elif not isinstance(values, list) or not values:
            problems.append(f"{where}: expected a list of values, got {values!r}")
        elif len({_label(value) for value in values}) < len(values):
            problems.append(f"{where}: expected different values, got {values!r}")
        else:
            yield (section or homes[key], name), values


def _paths(tree: object, path: str = "") -> Iterator[tuple[str, Any]]:
    """Values within tables of tables, each with the keys that lead to it."""
    if not isinstance(tree, dict):
        yield path, tree
        return
    for key, value in tree.items():
        yield from _paths(value, f"{path}.{key}".lstrip("."))


def put(table: Any, name: str, value: object) -> None:
    """Put a value where a name leads: ``k1``, ``branches.0.time``, ``1.load``, ``0.legs.1.load``."""
    *way, last = name.split(".")
    for key in way:
        table = table[_place_in(table, key)]
    place = _place_in(table, last)
    if isinstance(table, list):
        table[place]  # raises where there is none to replace
    table[place] = value


def _place_in(table: object, key: str) -> Any:
    """Key of a table, or number in a list; share and time of a branch are its first and second number."""
    if not isinstance(table, list | tuple):
        return key
    return {"share": 0, "time": 1}[key] if key in ("share", "time") and len(table) == 2 else int(key)


def _swept_keys(kinds: Mapping[str, object], question: str) -> list[str]:
    """Keys that a question uses and that may be swept, on a surface and a solid of these kinds."""
    asked = question_named(question)
    names = [
        name
        for section in (*ORDER, *filter(None, [question]))
        for kind, each in KINDS[section].items()
        if kinds.get(section, kind) == kind or kinds[section] not in KINDS[section]
        for name, parameter in each.keys.items()
        if parameter.quantity.swept and asked.uses(section, name)
    ]
    return list(dict.fromkeys(names))


def _seeds(seeds: object, first: Any, kind: str, problems: list[str]) -> tuple[int, ...]:
    """Seeds from a number, which begin with the first, or a list; a surface that is not random has none."""
    chosen = KINDS["surface"].get(kind, KINDS["surface"]["gaussian"])  # another kind is refused later
    if "seed" not in chosen.keys:
        if seeds is not None:
            problems.append(f"[sweep] seeds: a surface of kind {kind!r} has no seed")
        return ()
    if seeds is None:
        return (first,)
    if isinstance(seeds, int) and not isinstance(seeds, bool) and seeds >= 1 and isinstance(first, int):
        if seeds > MOST_RUNS:
            problems.append(
                f"[sweep] seeds: expected how many surfaces, at most {MOST_RUNS:,}, got {seeds:,}; "
                "for one surface of your choice, try seed in [surface]"
            )
            return ()
        return tuple(range(first, first + seeds))
    if not isinstance(seeds, list) or not seeds or len(set(map(str, seeds))) < len(seeds):
        expected = "a number of seeds or a list of different ones"
        problems.append(f"[sweep] seeds: expected {expected}, got {seeds!r}")
        return ()
    for seed in seeds:
        try:
            chosen.keys["seed"].read("[sweep] seeds", seed)
        except InputError as error:
            problems.append(str(error))
    return tuple(seeds)


def _runs(
    tables: dict[str, Any], lists: Lists, seeds: tuple[int, ...], path: Path, *, zipped: bool
) -> tuple[Run, ...]:
    """Make the runs; check every seed and every point, and name every mistake once."""
    lengths = [range(len(values)) for values in lists.values()]
    points = list(zip(*lengths, strict=True)) if zipped and lists else list(itertools.product(*lengths))
    problems: dict[str, None] = {}
    remarks: dict[str, None] = {}
    contents: dict[str, str] = {}
    runs: list[Run] = []
    names = {key: f"[sweep] {key[1]}" for key in lists}
    for point in points:
        values = {key: some[index] for (key, some), index in zip(lists.items(), point, strict=True)}
        if isinstance(file := values.get(("surface", "path")), str):
            values["surface", "path"] = str(path.parent / expanded(file))
        if seeds:
            values["surface", "seed"] = seeds[0]
        try:
            config = config_from(_laid_over(tables, values), {}, path, names)
            remarks |= dict.fromkeys(config.remarks)
            config = config.used  # which a worker in any folder can read
            runs += _with_seeds(config, point, seeds, content_of(config, contents))
        except ConfigError as error:
            problems |= dict.fromkeys(error.problems)
    if problems:
        raise ConfigError(list(problems))
    for text in remarks:
        remark(text)
    return tuple(runs)


def _laid_over(tables: dict[str, Any], values: Mapping[tuple[str, str], object]) -> dict[str, Any]:
    """The tables of the file with the values of one run in them, by section and name."""
    merged = copy.deepcopy(tables)
    for (section, name), value in values.items():
        table = merged.setdefault(section, {})
        if section != "protocol" and not isinstance(table, dict):  # a mistake, which is reported
            continue
        try:
            put(table, name.removeprefix("protocol."), value)
        except (KeyError, IndexError, ValueError, TypeError):
            counted = "leg; legs count from 0" if section == "protocol" else "entry; entries count from 0"
            raise ConfigError([f"[sweep] {name}: no such {counted}"]) from None
    return merged


def _with_seeds(
    config: RunConfig, point: tuple[int, ...], seeds: Sequence[int], content: str
) -> Iterator[Run]:
    facts = _facts(config, content)
    some: Sequence[int | None] = seeds or [None]
    for seed in some:
        if seed is not None:
            facts["surface"]["seed"], config = seed, seeded(config, seed)
        identity = hashlib.sha256(json.dumps(facts, sort_keys=True).encode()).hexdigest()[:24]
        yield Run(identity, point, seed, config, content)


def seeded(config: RunConfig, seed: int) -> RunConfig:
    """A configuration with another seed, which is a whole number >= 0."""
    surface = config.surface.but(seed=seed)
    return config.but(surface=surface)


def content_of(config: RunConfig, checksums: dict[str, str]) -> str:
    """Checksums of the files that it reads: the surface, and a table of the solid; found ones are kept."""
    contents = []
    for section, name in config.files.items():
        if name not in checksums:
            try:
                checksums[name] = hashlib.sha256(Path(name).read_bytes()).hexdigest()
            except OSError as error:
                raise ConfigError([f"[{section}] {FILES[section]}: {name}: {error.strerror}"]) from None
        contents.append(checksums[name])
    return " ".join(contents)


def _facts(config: RunConfig, content: str) -> dict[str, Any]:
    facts = to_tables(config)
    facts["output"].pop("figures", None)
    for section, name in config.files.items():
        # The suffix decides how the content is read.
        facts[section][FILES[section]] = [Path(name).suffix.lower(), content]
    facts["version"] = [__version__, _STORE_FORMAT]
    return facts


def _axis(section: str, name: str, values: Sequence[object], configs: Mapping[int, RunConfig]) -> Axis:
    """An axis, with its values as they were written; those with units in SI."""
    labels = []
    for number, value in enumerate(values):
        if _has_units(value):
            taken = value_at(configs[number], section, name)
            # None where it went into what a table gave.
            value = configs[number].parts[section].keys[name].read(name, value) if taken is None else taken
        label = _label(value)
        labels.append(float(label) if isinstance(label, float) else label)
    return Axis(section, name, tuple(labels))


def _has_units(value: object) -> bool:
    return any(map(_has_units, value)) if isinstance(value, list | tuple) else has_unit(value)


def value_at(config: RunConfig, section: str, name: str) -> Any:
    """Value of a swept key in a configuration."""
    place: Any = config.protocol if section == "protocol" else config.parts[section]
    for key in name.split(".")[section == "protocol" :]:
        key = _place_in(place, key) if isinstance(place, list | tuple) else key
        place = place[key] if isinstance(key, int) else getattr(place, key)
    return place


def _label(value: object) -> Value:
    if isinstance(value, list) and value and all(isinstance(pair, list | tuple) for pair in value):
        words = (f"{one:g}" if isinstance(one, float | int) else str(one) for pair in value for one in pair)
        return " ".join(words)
    if isinstance(value, list | tuple):
        return _label(value[0]) if len(value) == 1 else "x".join(map(str, value))
    return value if isinstance(value, float | int | str) else repr(value)
