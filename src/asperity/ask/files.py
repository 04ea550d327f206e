"""Questions in TOML files."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from asperity.ask.run import FILES
from asperity.ask.section import SectionError
from asperity.ask.solid import OF_TABLES, HalfSpace
from asperity.base.checks import shown
from asperity.base.files import content_of, expanded
from asperity.base.views import defines
from asperity.errors import ConfigError, InputError
from asperity.relaxation.materials import Material, material_of_file


def read_tables(path: str | Path) -> dict[str, Any]:
    """Read the tables of a TOML file; a relative path of a surface becomes relative to the file.

    `ConfigError` if it cannot be read, or is no TOML.
    """
    path, text = expanded(path), ""
    try:
        text = content_of(path).decode("utf-8-sig")  # editors on Windows write a mark before the first letter
        tables = tomllib.loads(text)
    except InputError:
        raise
    except UnicodeDecodeError:
        hint = "; for a surface, try --file"
        raise ConfigError([f"{path}: not a TOML file: not text in UTF-8{hint}"]) from None
    except (ValueError, RecursionError) as error:  # TOML's own, or a name with NUL
        clear = isinstance(error, tomllib.TOMLDecodeError) or "null" in str(error)
        reason = str(error) if clear else "too many digits, or brackets within each other"
        hint = r"; a path with \ needs single quotes: 'C:\scan.npy'" if re.search(r'"[^"\n]*\\', text) else ""
        raise ConfigError([f"{path}: not a TOML file: {reason}{hint}"]) from None
    except OSError as error:
        raise ConfigError([f"{path}: {error.strerror}"]) from None
    for section, key in (*FILES.items(), ("protocol", "file")):
        table = tables.get(section)
        if isinstance(table, dict) and isinstance(table.get(key), str):
            table[key] = str(path.parent / expanded(table[key]))
    return tables


@defines(material_of_file)
def _material_of_file(path: Path, /, **arguments: Any) -> Material:
    keys = {OF_TABLES.get(name, name): value for name, value in arguments.items()}
    table = read_tables(path).get("solid")
    if not isinstance(table, dict):
        raise InputError(path.name, expected="the half_space of [solid]", got=shown(table))
    if (kind := table.pop("kind", None)) != HalfSpace.kind:
        raise InputError(f"{path.name}: [solid] kind", expected="a half_space", got=shown(kind))
    try:
        found: Material = HalfSpace(**table | keys).material
        return found
    except SectionError as error:
        first = error.mistakes[0]
        raise first.about(f"{path.name}: [solid] {first.name}") from None
