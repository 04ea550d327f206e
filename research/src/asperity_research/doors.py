"""What is given from outside is looked at here."""

from collections.abc import Mapping
from difflib import get_close_matches
from typing import TypeVar

from asperity.errors import InputError

T = TypeVar("T")


def named(what: str, name: object, known: Mapping[str, T], advice: str = "", *, is_flag: bool = False) -> T:
    """Return the one of a name; `InputError`, with the name that was meant or advice, if there is none."""
    if isinstance(name, str) and name in known:
        return known[name]
    meant = get_close_matches(str(name), known, 1)
    cure = {what: meant[0]} if is_flag and meant else {}
    advice = "" if cure else (meant or [advice])[0]
    raise InputError(what, expected=f"one of {', '.join(known)}", got=repr(name), advice=advice, cure=cure)
