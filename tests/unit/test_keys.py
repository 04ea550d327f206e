"""The one description of the keys: what it says of each key is what the models accept and refuse."""

from __future__ import annotations

from typing import Any

from pydantic import ValidationError

from asperity.app.config.keys import Key, sections
from asperity.app.config.mistakes import models_of
from asperity.app.config.models import LEGS

MODELS: dict[tuple[str, str], Any] = {("protocol", kind): model for kind, model in LEGS.items()} | {
    (section, str(model.model_fields["kind"].default) if "kind" in model.model_fields else ""): model
    for section in sections()
    if section != "protocol"
    for model in models_of(section)
}


def accepts(model: Any, key: Key, value: object) -> bool:
    """Whether a model takes a value for a key, whatever it says of others."""
    try:
        model.model_validate({key.name: value})
    except ValidationError as error:
        return all(detail["loc"][:1] != (key.name,) for detail in error.errors())
    return True


def listed(key: Key, value: object) -> object:
    return [value] * (2 if key.name == "crop" else 1) if key.several else value


def written(key: Key, value: float) -> object:
    return listed(key, int(value) if key.what in ("whole", "wholes") else float(value))


def test_what_is_said_of_a_key_is_what_its_model_takes() -> None:
    for (section, kind), model in MODELS.items():
        for key in sections()[section][kind].values():
            assert key.description
            check_bounds(model, key)
            check_values(model, key)
            if key.unit:
                assert accepts(model, key, listed(key, f"2 {key.unit}"))
                assert not accepts(model, key, listed(key, "2 Pa" if key.unit == "K" else "2 K"))
    assert [next(iter(kinds)) for kinds in sections().values()][:2] == ["gaussian", "spring_lattice"]


def check_bounds(model: Any, key: Key) -> None:
    for bound, excluded, outside in (
        (key.least, key.above, lambda x: x - max(1, abs(x) / 10)),
        (key.most, key.below, lambda x: x + max(1, abs(x) / 10)),
    ):
        if bound is not None:
            assert accepts(model, key, written(key, bound)) is not excluded
            assert not accepts(model, key, written(key, outside(bound)))


def check_values(model: Any, key: Key) -> None:
    if key.choices:
        assert all(accepts(model, key, listed(key, word)) for word in key.choices)
        assert not accepts(model, key, listed(key, "nonsense"))
    if key.default is not None:
        assert accepts(model, key, key.default)
    examples = {
        "switch": True,
        "text": "word",
        "text or whole": 3,
        "path": "heights.npy",
        "pair": [0.5, 1.0],
        "pairs": [[0.5, 1.0]],
        "lists of pairs": [[[0.5, 1.0]], [[0.4, 2.0], [0.1, 3.0]]],
        "legs": [{"kind": "hold", "duration": 1.0}],
    }
    if key.what in examples:
        assert accepts(model, key, examples[key.what])
    assert not accepts(model, key, {"a": "table"})
    whole = key.what in ("whole", "wholes", "text or whole")
    if whole or key.what in ("number", "numbers"):
        between = 0.5 * (max(key.least or 0.0, -1.0) + min(key.most or 1.0, 1.0))
        assert accepts(model, key, listed(key, between)) is not whole
    assert accepts(model, key, "1 nonsense") is (key.what in ("path", "text", "text or whole"))
