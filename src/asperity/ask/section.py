"""Sections: tables whose keys are checked when they are made, by the annotations of what they describe.

A key has type, bounds, unit, meaning and default from a `asperity.base.parameters.Parameter`: that of an
argument of the library, or of an annotated field of the section's class.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, ClassVar, Self

from asperity.base.parameters import Needs, Parameter, check_needs, parameters_of
from asperity.base.words import MEANT, closest
from asperity.errors import SHOWN_PROBLEMS, InputError, Name, Words, named

Keys = dict[str, Parameter]


class SectionError(InputError):
    """A section is wrong: all its mistakes, each with its path."""

    def __init__(self, mistakes: Iterable[InputError]) -> None:
        self.mistakes = tuple(mistakes)
        super().__init__("section", said="; ".join(map(str, self.mistakes)))


class Section:
    """A table of a question: no unknown keys, no silent conversions, no infinities; it does not change.

    Attributes
    ----------
    section
        Its name in a file.
    kind
        Kind of a surface or a solid; empty for a section of one kind.
    keys
        Its keys, in their order.
    stated
        Keys that were given.
    make
        The function that makes such a surface or solid.
    makes
        What is made of its keys, which are its annotated fields.
    ways
        Alternative keys: a flag of one replaces the others.
    needs
        Keys of which each needs another beside it.
    """

    __slots__ = ("__dict__", "stated")

    section: ClassVar[str]
    kind: ClassVar[str] = ""
    make: ClassVar[Callable[..., Any]]
    keys: ClassVar[Keys] = {}
    makes: ClassVar[type | None] = None
    ways: ClassVar[tuple[tuple[set[str], ...], ...]] = ()
    needs: ClassVar[Needs] = ()
    stated: frozenset[str]

    def __init_subclass__(cls) -> None:
        if cls.makes:
            cls.keys = keys_of_maker(cls.makes)
            names = {name: one.quantity.key or name for name, one in parameters_of(cls.makes).items()}
            made: Needs = getattr(cls.makes, "needs", ())
            cls.needs += tuple((names[one], tuple(names[each] for each in others)) for one, others in made)
        own = {name: one for name, one in parameters_of(cls).items() if name not in cls.keys}
        cls.keys = {**vars(cls).get("keys", cls.keys), **{name: one.as_key for name, one in own.items()}}

    def __init__(self, **table: Any) -> None:
        self._set(read_keys(self.keys, table, (self.section,), self._unknown), table)
        self.check()

    @classmethod
    def of_kind(cls, kind: str, make: Callable[..., Any], keys: Keys | None = None) -> type[Self]:
        """The section of a kind, with the arguments of what makes it as keys, or others."""
        name = f"{kind.title().replace('_', '')}{cls.__name__}"
        facts = {"kind": kind, "make": staticmethod(make), "keys": cls.keys | (keys or keys_of_maker(make))}
        return type(name, (cls,), facts | {"__module__": cls.__module__})

    def check(self) -> None:
        """Refuse keys that contradict each other, or lack others."""
        given = self.stated & self.table.keys()
        for ways in self.ways:
            names = [min(way & given) for way in ways if way & given]
            if len(names) > 1:
                got = "both" if len(names) == 2 else "all"
                raise self.wrong(expected=named(names, " or "), got=got)
        with self.located():
            check_needs(self, self.needs)
            self.made()

    def made(self) -> Any:
        """What is made of its keys; None without any."""
        return self.makes(**arguments_of(self.makes, self)) if self.makes and self.table else None

    @contextmanager
    def located(self) -> Iterator[None]:
        """Let mistakes be those of this section, and of its keys that have their names."""
        try:
            yield
        except InputError as error:
            raise error.about(error.name, self.section, *[error.name] * (error.name in self.keys)) from None

    def but(self, **changes: object) -> Self:
        """The same with other values, which are not checked."""
        copy = object.__new__(type(self))
        copy._set(vars(self) | changes, {*self.stated, *changes})
        return copy

    @property
    def table(self) -> dict[str, Any]:
        """Its kind, if it has one, and the values that are not None."""
        kind = {"kind": self.kind} if self.kind else {}
        return kind | {name: value for name, value in vars(self).items() if value is not None}

    def wrong(self, key: str = "", **facts: Any) -> InputError:
        """A mistake of the whole section, or about one of its keys."""
        return InputError(key or self.section, **facts, path=(self.section, key) if key else (self.section,))

    @classmethod
    def _unknown(cls, key: str) -> InputError:
        """The mistake of a key that it does not have."""
        owners = [kind for kind, other in KINDS[cls.section].items() if key in other.keys]
        meant = MEANT.get(key)
        if not owners or meant in cls.keys:
            elsewhere = [meant for other in KINDS[cls.section].values() if meant and meant in other.keys]
            return unknown_key(key, [*cls.keys, *elsewhere], (cls.section, key))
        kinds = " and ".join(map(repr, owners))
        said = f"not a key of a {cls.section} of kind {cls.kind!r}, but of {kinds}"
        return InputError(key, said=said, cure={"kind": owners[0]}, path=(cls.section, key))

    def _set(self, values: Mapping[str, Any], stated: Iterable[str]) -> None:
        vars(self).update(values)
        object.__setattr__(self, "stated", frozenset(stated))

    def __setattr__(self, name: str, value: object) -> None:
        raise dataclasses.FrozenInstanceError(f"cannot assign to {name}")

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and vars(other) == vars(self)

    def __hash__(self) -> int:
        return hash(repr(self))

    def __repr__(self) -> str:
        usual = {name: one.default for name, one in self.keys.items()}
        told = ", ".join(f"{name}={value!r}" for name, value in vars(self).items() if value != usual[name])
        return f"{type(self).__name__}({told})"

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (self.section, self.kind, vars(self), self.stated)

    def __getattr__(self, name: str) -> Any:  # for type checkers: the keys of a kind are not written down
        raise AttributeError(f"{type(self).__name__} has no key {name}")


KINDS: dict[str, dict[str, type[Section]]] = {}
"""Sections of all kinds, by section and kind ("" where there is one); the first kind is the usual one."""


def home_of(key: str) -> str:
    """The first section that has a key of this name; empty for none."""
    homes = (name for name, kinds in KINDS.items() if any(key in kind.keys for kind in kinds.values()))
    return next(homes, "")


def kind_in(section: str, table: Mapping[str, Any]) -> Any:
    """The kind that a table of a section states; of a surface with a path a file, else the usual one."""
    usual = "file" if section == "surface" and "path" in table else next(iter(KINDS[section]))
    return table.get("kind", usual)


def _again(section: str, kind: str, values: dict[str, Any], stated: frozenset[str]) -> Section:
    copy = object.__new__(KINDS[section][kind])
    copy._set(values, stated)
    return copy


def read_keys(
    keys: Keys,
    table: Mapping[str, object],
    path: tuple[str | int, ...],
    unknown: Callable[[str], InputError] | None = None,
) -> dict[str, Any]:
    """Values of all keys from a table; `SectionError` with every mistake."""
    foreign = [key for key in table if key not in keys]
    unknown = unknown or (lambda key: unknown_key(key, keys, (*path, key)))
    mistakes = [unknown(key) for key in foreign[:SHOWN_PROBLEMS]]  # advice for each takes milliseconds
    mistakes += [unknown_key(key, (), (*path, key)) for key in foreign[SHOWN_PROBLEMS:]]
    values: dict[str, Any] = {}
    for key, parameter in keys.items():
        try:
            if key in table:
                values[key] = parameter.read(key, table[key])
            elif parameter.default is dataclasses.MISSING:
                raise InputError(key, expected="a value", got="none")
            else:
                values[key] = parameter.default
        except InputError as error:
            mistakes.append(error.about(key, *path, key))
    if mistakes:
        raise SectionError(mistakes)
    return values


def unknown_key(
    key: str, keys: Iterable[str], path: tuple[str | int, ...], said: str = "no such key"
) -> InputError:
    """The mistake of an unknown key, with the one that was meant, or all that there are."""
    names = list(keys)
    meant = MEANT.get(key)
    if meant not in names:
        meant = closest(key, names) if names else None
    advice: Words = (Name(meant),) if meant else ", ".join(names)
    return InputError(key, said=said, advice=advice, path=path)


def keys_of_maker(make: Callable[..., Any]) -> Keys:
    """Keys of a section: the annotated arguments of the function that makes a surface or a solid."""
    return {one.quantity.key or name: one.as_key for name, one in parameters_of(make).items()}


def arguments_of(make: Callable[..., Any], section: Section) -> dict[str, Any]:
    """Arguments of such a function, from the keys that are given."""
    arguments = {}
    for name, parameter in parameters_of(make).items():
        value, kinds = getattr(section, parameter.quantity.key or name), {*parameter.kinds}
        if value is None or value == [] or (isinstance(value, bool) and parameter.quantity.key and not value):
            continue
        if isinstance(value, list) and {float, int} & kinds:
            value = value[0] if len(value) == 1 else tuple(value)
        arguments[name] = not value if isinstance(value, bool) and parameter.quantity.key else value
    return arguments
