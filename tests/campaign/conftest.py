"""Small campaigns, run as a user runs them."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time
from contextlib import redirect_stderr, redirect_stdout, suppress
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
import zarr

from asperity.app.campaign.plan import Plan, plan_to_json, read_plan, with_units
from asperity.app.campaign.store import Store
from asperity.app.campaign.worker import run_task
from asperity.app.cli import main
from tests.cli.conftest import process

SMALL = """
[surface]
shape = [16, 16]
[aging]
first = 0.1
last = 10.0
per_decade = 2
[sweep]
load = [4.0, 12.0]
k1 = [1.0, 3.0]
seeds = 3
"""
HALF_SPACES = """
[surface]
kind = "spectral"
shape = [32, 32]
rms_height = 0.1
spacing = 0.5
unit = "um"
[solid]
kind = "half_space"
modulus = 1e9
branches = [[0.3, "10 ms"], [0.4, 1.0]]
[contact]
pressure = "2 MPa"
[aging]
per_decade = 1
[output]
maps_at = [0.0, 1.0]
"""
HISTORY = """
[surface]
shape = [16, 16]
[contact]
load = 12.0
[aging]
first = 0.1
per_decade = 1
[[protocol]]
kind = "hold"
duration = 1.0
[[protocol]]
kind = "step"
load = 4.0
[[protocol]]
kind = "hold"
duration = 2.0
"""


def written(folder: Path, text: str = SMALL) -> Path:
    path = folder / "campaign.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def done(tmp_path_factory):
    """The finished small campaign on two workers, not to be changed."""
    folder = tmp_path_factory.mktemp("campaign")
    with redirect_stdout(StringIO()) as out, redirect_stderr(StringIO()) as error:
        status = main(["sweep", str(written(folder)), "--out", str(folder / "out"), "--workers", "2"])
    assert status == 0, error.getvalue()
    assert out.getvalue().split() == ["runs", "12", "done", "12", "running", "0", "failed", "0", "left", "0"]
    assert error.getvalue().startswith("runs: 0 of 12")
    return folder


def some_of(plan, count):
    """The plan of its first runs alone."""
    return Plan(plan.axes, plan.seeds, plan.zipped, plan.runs[:count])


def do_here(plan, directory):
    """Do a plan without a cluster, in this process."""
    store = Store(directory)
    directory.mkdir(exist_ok=True)
    store.prepare()
    (directory / "plan.json").write_text(plan_to_json(plan))
    return [
        run_task(str(directory), run.identity, json.dumps(with_units(run.config)), run.content)
        for run in plan.runs
    ]


def done_here(folder: Path, text: str = SMALL) -> Plan:
    """Do a campaign of this text in the folder ``out`` beside it; give its plan."""
    plan = read_plan(written(folder, text))
    assert {state for _, state, _ in do_here(plan, folder / "out")} == {"done"}
    return plan


def start(*words: str | Path, before: str = "") -> subprocess.Popen[str]:
    """Start the command in a process group of its own, after some Python code."""
    return process(*words, before=before, start_new_session=True)


def wait_for_a_run(running: subprocess.Popen[str], directory: Path) -> None:
    """Wait until a campaign under way has a finished run."""
    limit = time.monotonic() + 120
    while not numbers(directory):
        if running.poll() is not None or time.monotonic() > limit:
            with suppress(ProcessLookupError):
                os.killpg(running.pid, signal.SIGKILL)
            raise AssertionError(f"no run is done: {running.communicate(timeout=30)[1]}")
        time.sleep(0.1)


def finish(*words: str | Path, before: str = "") -> tuple[int, str, str]:
    """Run the command to its end."""
    running = start(*words, before=before)
    try:
        out, error = running.communicate(timeout=240)
    except subprocess.TimeoutExpired:
        os.killpg(running.pid, signal.SIGKILL)
        raise
    return running.returncode, out, error


def numbers(folder: Path) -> dict[str, bytes]:
    """The series of every run in a store, to the last bit."""
    store = folder / "runs.zarr"
    names = [path.parent.name for path in store.glob("*/zarr.json")]
    return {
        name: np.asarray(zarr.open_group(store / name, mode="r")["over_time"]).tobytes() for name in names
    }
