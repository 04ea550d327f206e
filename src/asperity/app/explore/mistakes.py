"""Mistakes, in one line each with the key of the form."""

from __future__ import annotations

import re
from typing import Any

from asperity.app.config.keys import sections
from asperity.base.words import reason_of
from asperity.errors import AsperityError, ConfigError, InputError, SurfaceFileError, brief

_FLAGS = re.compile(r" \(--[^()]*\)|(?<![\w-])--\w[^,;:]*, or ")
"""Advice for the command line beside keys of a configuration."""

Mistake = dict[str, str]
Shown = dict[str, tuple[str, str]]
"""By absolute path of a file, its names in the form of the page and in texts for the user."""


def without_flags(text: str) -> str:
    """A sentence for the page, where there is no command line."""
    return _FLAGS.sub("", text)


def mistake(text: str, where: str = "") -> list[Mistake]:
    """A mistake with its key."""
    return [{"where": where, "text": without_flags(text)}]


def failed(mistakes: list[Mistake]) -> dict[str, Any]:
    """Header of the message that ends a run without a result."""
    return {"kind": "failed", "mistakes": mistakes}


def mistakes_of(error: BaseException, shown: Shown | None = None) -> list[Mistake]:
    """List the mistakes of an error in one line each, with their keys, such as ``contact.load``, or none."""
    for path, (_, name) in (shown or {}).items():
        if isinstance(error, SurfaceFileError) or (isinstance(error, AsperityError) and path in str(error)):
            where = "solid.relaxation" if "relaxation" in str(error) else "surface.path"
            return mistake(brief(str(error).replace(path, name)), where)
    match error:
        case ConfigError():
            places = [*map(_place, error.mistakes), *[""] * len(error.shown)]
            return [{"where": where, "text": one} for where, one in zip(places, error.shown, strict=False)]
        case InputError():
            name = error.name.removeprefix("--").replace("-", "_")
            homes = {one: kinds.values() for one, kinds in sections().items() if one != "protocol"}
            home = next((one for one, keys in homes.items() if any(name in kind for kind in keys)), "")
            return mistake(brief(str(error)), home and f"{home}.{name}")
        case AsperityError():
            return mistake(brief(str(error)))
        case MemoryError():
            return mistake(f"not enough memory: {str(error) or 'try a smaller surface'}")
        case OSError() if error.strerror:
            return mistake(f"{error.filename or ''}: {error.strerror}".removeprefix(": "))
    return mistake(f"unexpected: {type(error).__name__}: {reason_of(error)}")


def _place(mistake: InputError) -> str:
    """The field of a mistake: ``contact.load``, ``protocol[0].load``."""
    parts = (f"[{part}]" if isinstance(part, int) else f".{part}" for part in mistake.path)
    return "".join(parts).removeprefix(".")
