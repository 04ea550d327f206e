"""Mistakes of a configuration as lines: in flags where the key came as one, else with section and key."""

from __future__ import annotations

import json
import shlex
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from asperity.ask.section import KINDS
from asperity.errors import ConfigError, InputError, Value

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

    flags: Mapping[str, Mapping[str, object]]
    file: Path | None = None
    names: Names = field(default_factory=dict)
    lacks: Collection[str] = ()

    def refused(self, mistakes: Iterable[InputError]) -> ConfigError:
        """The error of these mistakes, unknown names first."""
        ordered = tuple(sorted(mistakes, key=lambda one: not one.said))
        return ConfigError([self.line(one) for one in ordered], ordered)

    def line(self, mistake: InputError) -> str:
        """A mistake in one line."""
        if mistake.cure.keys() & {*self.lacks}:
            mistake = mistake.about(mistake.name)
            mistake.cure = {key: one for key, one in mistake.cure.items() if key not in self.lacks}
        home, *rest = mistake.path or ("",)
        section = str(home)
        given = self.flags.get(section, {})
        alone = section != "protocol" and bool(self.flags) and self.file is None
        typed = alone or any(part in given for part in rest)

        def spell(key: str) -> str:
            return flag_in(section, key) if typed or key in given else key

        def assign(key: str, value: Value) -> str:
            if typed or key in given:
                return assigned(flag_in(section, key), value)
            return f"{key} = {json.dumps(value)}"

        place = self._place(section, rest)
        named = mistake.name in (section, *rest[-1:]) or (rest and mistake.name == "kind")
        about = "" if named else f"{mistake.name}: "
        return f"{place}{': ' * bool(section)}{about}{mistake.told('', spell, assign)}"

    def _place(self, section: str, rest: list[Any]) -> str:
        if section == "protocol":
            legs = "".join(f"[{part}]" if isinstance(part, int) else f" {part}" for part in rest)
            return f"--leg {legs}" if section in self.flags else self._in_file(f"protocol{legs}")
        if not rest:
            return self._in_file(f"[{section}]" if section else "")
        key = str(rest[0])
        if (section, key) in self.names:
            return self._in_file(self.names[section, key])
        if key in self.flags.get(section, {}) or (key == "kind" and self.flags.get(section)):
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
    homes = [section, *KINDS]
    owners = (one for one in homes if any(key in kind.keys for kind in KINDS.get(one, {}).values()))
    home = next(owners, section)
    return flag_of(home, key) if home else ""
