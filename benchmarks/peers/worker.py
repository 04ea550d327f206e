"""Serve one solver from the interpreter that has it: a line of JSON in, a line of JSON out.

    PYTHON worker.py MODULE

The first line out names the version, or the reason why the solver is absent. Arrays travel as .npz files.
Whatever a solver prints goes to standard error.
"""

import importlib
import json
import os
import sys
import traceback
from functools import lru_cache

import numpy as np


def main():
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    try:
        solver = importlib.import_module(sys.argv[1])
    except ImportError as error:
        print(json.dumps({"absent": str(error)}), file=answers)
        return
    print(json.dumps({"version": solver.VERSION, "kinds": getattr(solver, "KINDS", None)}), file=answers)
    for line in sys.stdin:
        request = json.loads(line)
        try:
            reply = _serve(solver, request)
        except Exception as error:  # whatever a peer raises is its answer
            traceback.print_exc()
            reply = {"error": f"{type(error).__name__}: {error}"}
        print(json.dumps(reply), file=answers)


@lru_cache(maxsize=1)
def _problem(path):
    from problem import Law, Problem

    with np.load(path) as data:
        return Problem(
            data["heights"],
            Law(**json.loads(str(data["law"]))),
            float(data["load"]),
            data.get("start"),
            float(data["separation"]) if "separation" in data else None,
            tuple(data["spacing"].tolist()),
        )


def _serve(solver, request):
    problem = _problem(request["problem"])
    if request["do"] == "age":
        fields, numbers = solver.age(problem, request["times"], **request.get("options", {}))
    else:
        answer = solver.solve(problem, request["tolerance"])
        fields = {"u": answer.u, "in_contact": answer.in_contact}
        if answer.force is not None:
            fields["force"] = answer.force
        numbers = {
            "iterations": int(answer.iterations),
            "seconds": answer.watch.seconds,
            "cpu_seconds": answer.watch.cpu_seconds,
            "note": answer.note,
        }
    if request.get("out"):
        np.savez(request["out"], **fields)
    return numbers


if __name__ == "__main__":
    main()
