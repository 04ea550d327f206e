"""Mistakes of a configuration as lines: in flags where the key came as one, else with section and key."""

from __future__ import annotations

import json
import shlex
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from asperity.ask.run import RunConfig
from asperity.ask.section import KINDS, home_of
from asperity.errors import ConfigError, InputError, Value, brief

Sections = dict[str, dict[str, object]]
Names = Mapping[tuple[str, str], str]

_FLAGS = {
    ("surface", "kind"): "surface",
    ("surface", "path"): "file",
    ("surface", "places"): "place",
    ("solid", "kind"): "solid",
    ("solid", "branches"): "branch",
    ("solid", "base_branches"): "base-branch",
    ("solid", "per_decade"): "branches-per-decade",
    ("solid", "table_kind"): "kind",
    ("solid", "free_branches"): "branches",
    ("protocol", "file"): "history",
    **{("protocol", key): f"history-{key}" for key in ("columns", "units", "compression", "within")},
}


def flag_of(section: str, key: str) -> str:
    """Name of the flag that sets a key."""
    return "--" + _FLAGS.get((section, key), key).replace("_", "-")


@dataclass(frozen=True)
class Door:
    """Where a configuration comes from, and how names are written there.

    Attributes
    ----------
    flags
        Keys that came as flags, by section.
    file
        The file of the other keys; None without one.
    names
        Other names of keys, by section and key.
    lacks
        Keys that cannot be given here, and are no cure.
    """

    flags: Sections
    file: Path | None = None
    names: Names = field(default_factory=dict)
    lacks: Collection[str] = ()

    def refused(self, mistakes: Iterable[InputError]) -> ConfigError:
        """The error of these mistakes, unknown names first."""
        ordered = tuple(sorted(mistakes, key=lambda one: not one.said))
        return ConfigError([self.line(one) for one in ordered], ordered)

    def line(self, mistake: InputError) -> str:
        """A mistake in one line."""
        home, *rest = mistake.path or ("", mistake.name)
        section = str(home)
        typed = self._typed(section, *rest)

        def spell(key: str) -> str:
            if section and (typed or self._typed(section, key)):
                return flag_in(section, key)
            return self.names.get((section, key), key)

        def assign(key: str, value: Value) -> str:
            name = spell(key)
            if not section and name == key:  # an argument of the library, which a key may set
                name = flag_in("", key) or key
            written = assigned(name, value) if name.startswith("--") else f"{key} = {json.dumps(value)}"
            return "" if key in self.lacks else written

        named = mistake.name in (section, *rest[-1:]) or (rest and mistake.name == "kind")
        about = "" if named else f"{mistake.name}: "
        return f"{self._place(section, rest)}: {about}{mistake.told('', spell, assign)}"

    @contextmanager
    def answering(self, config: RunConfig | None = None) -> Iterator[None]:
        """Let the errors of a verb name arguments as this configuration has them, or as the door does."""
        try:
            yield
        except ConfigError:
            raise
        except InputError as error:
            path = ("", error.name) if config is None else error.path or self._path_of(error.name, config)
            if not path:
                raise
            place, told = self._place(str(path[0]), [*path[1:]]), self.line(error.about(error.name, *path))
            raise error.retold(place, told) from error

    def _path_of(self, name: str, config: RunConfig) -> tuple[str, ...]:
        """Section and key with the name of an argument, best one that came as a flag; empty for none."""
        if name in config.parts:
            return (name,)
        first = (config.asked, *config.question.sections)
        homes = [home for home, part in config.parts.items() if name in part.keys]
        homes.sort(key=lambda home: (name not in self.flags.get(home, {}), home not in first))
        return (homes[0], name) if homes else ()

    def _typed(self, section: str, *keys: str | int) -> bool:
        """Whether one of these keys came as a flag, or could only come as one."""
        of_section = self.flags.get(section, {})
        alone = "file" in of_section if section == "protocol" else bool(self.flags) and self.file is None
        return alone or any(key in of_section for key in keys)

    def _place(self, section: str, rest: list[Any]) -> str:
        if section == "protocol" and not (rest and isinstance(rest[0], str)):
            if self._typed(section):
                return flag_of(section, "file")
            legs = "".join(f"[{part}]" if isinstance(part, int) else f" {part}" for part in rest)
            return f"--leg {legs}" if section in self.flags else self._in_file(f"protocol{legs}")
        if not rest and "kind" in self.flags.get(section, {}):
            return flag_of(section, "kind")
        if not rest:
            return self._in_file(f"[{section}]" if section else "")
        key = str(rest[0])
        if not section or (section, key) in self.names:
            return self._in_file(self.names.get((section, key), brief(key)))
        if self._typed(section, key) or (key == "kind" and self.flags.get(section)):
            return flag_of(section, key)
        return self._in_file(f"[{section}] {key}")

    def _in_file(self, place: str) -> str:
        return place if self.file is None else f"{self.file}: {place}"


def assigned(flag: str, value: Value) -> str:
    """A flag with its value, as one types it: a switch has none, a list several."""
    if value is True:
        return flag
    words = [str(part) for part in value] if isinstance(value, list) else [str(value)]
    return shlex.join([flag, *words])


def flag_in(section: str, key: str) -> str:
    """The flag of a key of this section, or of another that has it; empty where there is neither."""
    is_own = section == "protocol" or any(key in kind.keys for kind in KINDS.get(section, {}).values())
    home = section if is_own else home_of(key) or section
    return flag_of(home, key) if home else ""
