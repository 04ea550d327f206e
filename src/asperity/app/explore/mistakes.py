"""Mistakes, in one line each with the key of the form."""

from __future__ import annotations

from typing import Any

from asperity.ask.section import home_of
from asperity.base.words import reason_of
from asperity.errors import SHOWN_PROBLEMS, AsperityError, ConfigError, InputError, SurfaceFileError, brief

Mistake = dict[str, str]
Shown = dict[str, tuple[str, str, str]]
"""By absolute path of a file, its names in the form of the page and in texts for the user, and its field."""


def mistake(text: str, where: str = "") -> list[Mistake]:
    """A mistake with its key."""
    return [{"where": where, "text": text}]


def failed(mistakes: list[Mistake]) -> dict[str, Any]:
    """Header of the message that ends a run without a result."""
    return {"kind": "failed", "mistakes": mistakes}


def mistakes_of(error: BaseException, shown: Shown | None = None) -> list[Mistake]:
    """List the mistakes of an error in one line each, with their keys, such as ``contact.load``, or none."""
    for path, (_, name, where) in (shown or {}).items():
        if isinstance(error, AsperityError) and path in str(error):
            return mistake(brief(str(error).replace(path, name)), where)
    match error:
        case SurfaceFileError():
            return mistake(brief(str(error)), "surface.path")
        case ConfigError():
            first = error.mistakes[:SHOWN_PROBLEMS]
            said = [{"where": _place(one), "text": _told(one, shown)} for one in first]
            return said + [{"where": "", "text": line} for line in error.shown[len(said) :]]
        case InputError():
            name = error.name.removeprefix("--").replace("-", "_")
            home = home_of(name)
            at_home = error.about(name, home, name) if home else error
            return mistake(_told(at_home, shown), home and f"{home}.{name}")
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


def _told(mistake: InputError, shown: Shown | None) -> str:
    """A mistake in the words of the form, whose fields say what it is about; legs have none."""
    about = mistake.name
    for path, (_, name, _) in (shown or {}).items():
        about = about.replace(path, name)
    section, *rest = mistake.path or ("",)
    key = str(rest[-1]) if rest else section
    at_field = mistake.name == key and section != "protocol"

    def spell(name: str) -> str:
        return name.replace("_", " ") if name.isidentifier() else name

    return brief(
        mistake.told("" if at_field else spell(about), spell, lambda name, value: f"{spell(name)} {value}")
    )
