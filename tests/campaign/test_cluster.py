"""Campaigns on a Dask scheduler that others started, and on one that is none."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from distributed import Client

import asperity.app.campaign as campaign
from asperity.app.campaign.cluster import connect
from tests.campaign.conftest import SMALL, finish, numbers, start, wait_for_a_run, written
from tests.refusals import refuses

pytestmark = [
    pytest.mark.skipif(os.name != "posix", reason="needs POSIX signals"),
    pytest.mark.xdist_group("sweep"),
]

SHORT = "import asperity.app.campaign.cluster as c; c._TELL, c._PATIENCE, c._COUNT = 0.1, 1.0, 0.1"
"""Limits of a scheduler that has no workers."""


@contextmanager
def dask(what: str, *words: str | Path) -> Iterator[subprocess.Popen[bytes]]:
    """A scheduler, or a worker of one thread, in a process of its own."""
    command = [sys.executable, "-m", f"distributed.cli.dask_{what}", "--no-dashboard", *map(str, words)]
    command += (
        ["--no-nanny", "--nthreads", "1"] if what == "worker" else ["--host", "127.0.0.1", "--port", "0"]
    )
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL, env=os.environ | {"OMP_NUM_THREADS": "1"})
    try:
        yield process
    finally:
        process.kill()
        process.wait(timeout=30)


@contextmanager
def scheduler(folder: Path) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """A scheduler without workers: its address, and its process."""
    place = folder / "scheduler.json"
    with dask("scheduler", "--scheduler-file", place) as process:
        deadline = time.monotonic() + 60
        while not (place.exists() and place.stat().st_size) and time.monotonic() < deadline:
            time.sleep(0.05)
        yield json.loads(place.read_text())["address"], process


@pytest.mark.slow
def test_a_scheduler_without_workers_ends_in_words(tmp_path):
    with scheduler(tmp_path) as (address, _):
        flags = ("--out", tmp_path / "out", "--scheduler", address)
        status, _, error = finish("sweep", written(tmp_path), *flags, before=SHORT)
    assert status == 1
    assert "waiting for workers: 0 connected" in error
    assert "expected workers, got none for 1 seconds" in error.splitlines()[-1]


@pytest.mark.slow
@pytest.mark.parametrize("what", ["workers", "scheduler"])
def test_what_dies_in_the_middle_ends_in_words_and_loses_nothing(done, tmp_path, what):
    path, out = written(tmp_path, SMALL.replace("seeds = 3", "seeds = 200")), tmp_path / "out"
    with scheduler(tmp_path) as (address, process):
        with dask("worker", address):
            with Client(address) as client:
                client.wait_for_workers(1, timeout=60)
            limits = SHORT if what == "workers" else ""  # else a late death would be a lack of workers first
            running = start("sweep", path, "--out", out, "--quiet", "--scheduler", address, before=limits)
            wait_for_a_run(running, out)
            if what == "scheduler":
                process.send_signal(signal.SIGKILL)
                _, error = running.communicate(timeout=120)
        if what == "workers":
            _, error = running.communicate(timeout=60)
            assert [line for line in error.splitlines() if "waiting for workers: 0 connected" in line]
    assert running.returncode == 1
    last = error.splitlines()[-1]
    if what == "scheduler":
        assert "lost the scheduler" in last
        assert "and the same command does the rest" in last
        assert error.count("\n") == 1
    assert "finished runs are kept" in last
    counted = campaign.tally(campaign.read_plan(path), out)
    assert counted.failed == 0
    assert 0 < counted.done < counted.total
    whole = numbers(done / "out")
    assert {name: whole[name] for name in numbers(out).keys() & whole.keys()}.items() <= numbers(out).items()


def test_what_takes_connections_and_is_no_scheduler_ends_in_words(monkeypatch):
    monkeypatch.setattr("asperity.app.campaign.cluster._ANSWER", 0.5)
    with socket.create_server(("127.0.0.1", 0)) as silent:  # the system connects; nobody answers
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        with (
            refuses("scheduler", address),
            connect(None, address, 1),
        ):
            pass


def test_workers_keep_their_memory():
    # With it, memory goes back to the system after every array, and runs take twice the time.
    with connect(1, None, 1) as client:
        (found,) = client.run(os.environ.get, "MALLOC_TRIM_THRESHOLD_").values()
        (threads,) = client.run(os.environ.get, "OMP_NUM_THREADS").values()
    assert found is None
    assert threads == "1"
