"""Stored answers to small questions: runs, predictions and laws whose numbers a change of structure keeps.

``ASPERITY_MESSAGES=write pytest -n 0 -m "" tests/judges`` writes them anew.
"""

import hashlib
import json
import os
import tomllib
from importlib.metadata import version
from pathlib import Path
from typing import Any

import llvmlite.binding  # type: ignore[import-untyped]
import numpy as np
import pytest

from asperity.app.config import config_from
from asperity.app.runs import answer
from asperity.progress import Progress

HERE = Path(__file__).parent
QUESTIONS = tomllib.loads((HERE / "questions.toml").read_text("utf-8"))
ANSWERS = HERE / "answers.json"
SECTIONS = {"predict": "prediction", "law": "law"}
ELSEWHERE = 1e-5
"""Relative difference between processors: last bits pass through time steps and solvers of a tolerance.
With the instructions of x86-64 alone in place of AVX-512 it is at most 2.4e-6, mostly below 1e-6."""
ELSEWHERE_OF = {"run springs_slide": 3e-5}
"""Where steps take other lengths (rtol is 2e-3): 1.2e-5 of two processors with AVX-512."""


def machine():
    """All on which the last bits depend: instructions of the processor, and libraries and their kernels."""
    found = llvmlite.binding.get_host_cpu_features().flatten(), llvmlite.binding.get_host_cpu_name()
    facts = [*found, *map(version, ("numpy", "scipy", "numba", "llvmlite"))]
    facts += sorted(f"{name}={value}" for name, value in os.environ.items() if name.startswith("OPENBLAS"))
    return hashlib.sha256(" ".join(facts).encode()).hexdigest()[:16]


def answered(kind, name):
    """Hash of each array, and the first and last finite number of each that is real, to nine digits."""
    tables = {key: one for key, one in QUESTIONS[kind][name].items() if key not in ("quick", "asked")}
    asked = {SECTIONS[kind]: QUESTIONS[kind][name].get("asked", {})} if kind in SECTIONS else {}
    result: Any = answer(config_from(tables | asked, {}, None), Progress())
    arrays = {key: np.ascontiguousarray(one.values) for key, one in sorted(result.dataset.variables.items())}
    result = getattr(result, "prediction", result)
    if getattr(result, "bands", ()):
        arrays["bands"] = np.array([list(vars(band).values()) for band in result.bands])
    if getattr(result, "observed", ()):
        arrays["observed"] = np.array([one.area for one in result.observed])
    numbers = {key: one[np.isfinite(one)] for key, one in arrays.items() if one.dtype.kind == "f"}
    numbers.pop("residual", None)  # it is rounding
    return {
        "arrays": {
            key: hashlib.sha256(f"{one.dtype} {one.shape}".encode() + one.tobytes()).hexdigest()[:16]
            for key, one in arrays.items()
        },
        "numbers": {
            key: [float(f"{end:.9g}") for end in one[[0, -1]]] for key, one in numbers.items() if one.size
        },
    }


@pytest.mark.parametrize(
    ("kind", "name"),
    [
        pytest.param(kind, name, marks=[] if question.get("quick") else pytest.mark.slow)
        for kind, questions in QUESTIONS.items()
        for name, question in questions.items()
    ],
)
def test_numbers_stay(kind, name, monkeypatch):
    monkeypatch.chdir(HERE)
    stored, found = json.loads(ANSWERS.read_text("utf-8")), answered(kind, name)
    if os.environ.get("ASPERITY_MESSAGES") == "write":
        stored = {"machine": machine(), "answers": stored["answers"] | {f"{kind} {name}": found}}
        ANSWERS.write_text(json.dumps(stored, indent=1, sort_keys=True) + "\n", "utf-8")
        return
    known = stored["answers"][f"{kind} {name}"]
    assert not known["arrays"].keys() - found["arrays"].keys()
    elsewhere = ELSEWHERE_OF.get(f"{kind} {name}", ELSEWHERE)
    for key, ends in known["numbers"].items():
        assert found["numbers"][key] == pytest.approx(ends, rel=elsewhere, abs=0), key
    if (
        stored["machine"] == machine()
    ):  # elsewhere the last bits differ: FFTs and sums take other instructions
        assert {key: found["arrays"][key] for key in known["arrays"]} == known["arrays"]
