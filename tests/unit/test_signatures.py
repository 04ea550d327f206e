"""Public signatures: every argument and every result has a type, and none is ``Any``."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from types import FunctionType, ModuleType

import asperity

UNKNOWN = re.compile(r"\b(Any|object)\b")

WHATEVER = {
    ("Contact.__init__", "_"): "refuses whatever it is given",
    ("Contact.__init__", "__"): "refuses whatever it is given",
    ("errors.InputError.__init__", "got"): "whatever came instead",
    ("figures.Drawing.savefig", "kwargs"): "what matplotlib takes",
    ("figures.html_of", "thing"): "any result, and refuses others",
}
"""Arguments that may be anything, and why."""


def public() -> Iterator[tuple[str, object]]:
    for name in asperity.__all__:
        member = getattr(asperity, name)
        if isinstance(member, ModuleType):
            yield from ((f"{name}.{inner}", getattr(member, inner)) for inner in member.__all__)
        else:
            yield name, member


def functions() -> Iterator[tuple[str, FunctionType]]:
    """Public functions, and the public methods, properties and makers of public classes."""
    for name, thing in public():
        if isinstance(thing, FunctionType):
            yield name, thing
        elif inspect.isclass(thing):
            for inner, member in vars(thing).items():
                found = member.fget if isinstance(member, property) else member
                found = getattr(found, "__func__", getattr(found, "func", found))
                if isinstance(found, FunctionType) and (not inner.startswith("_") or inner == "__init__"):
                    yield f"{name}.{inner}", found


def written_here(function: FunctionType) -> bool:
    """Whether it is no method that dataclasses made, or that a library inherits."""
    return function.__code__.co_filename.startswith(next(iter(asperity.__path__)))


def test_every_argument_and_result_has_a_type_and_none_is_any() -> None:
    seen = 0
    wrong = []
    for name, function in functions():
        if not written_here(function):
            continue
        signature = inspect.signature(function)
        types = {key: value.annotation for key, value in signature.parameters.items() if key != "self"}
        types["return"] = signature.return_annotation
        for argument, kind in types.items():
            seen += 1
            if kind is inspect.Signature.empty and argument != "cls":
                wrong.append(f"{name}: {argument} has no type")
            elif (
                UNKNOWN.search(str(kind)) and argument != "return" and (name, argument) not in WHATEVER
            ) or re.search(r"\bAny\b", str(kind)):
                wrong.append(f"{name}: {argument} is {kind}")
    assert not wrong
    assert seen > 500


def test_no_public_attribute_is_any() -> None:
    kinds = {
        f"{name}.{attribute}": str(kind)
        for name, thing in public()
        if inspect.isclass(thing)
        for attribute, kind in inspect.get_annotations(thing).items()
        if not attribute.startswith("_")
    }
    assert len(kinds) > 200
    assert not [name for name, kind in kinds.items() if re.search(r"\bAny\b", kind)]
