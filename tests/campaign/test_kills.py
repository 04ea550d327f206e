"""kill -9 of the client, of a worker and of everything, at random moments: nothing is lost or damaged."""

import os
import random
import signal
import subprocess
import time
from contextlib import suppress

import psutil
import pytest

import asperity.app.campaign as campaign
from asperity.app.campaign.store import Store
from tests.campaign.conftest import do_here, finish, numbers, start, written

pytestmark = [
    pytest.mark.skipif(os.name != "posix", reason="needs POSIX signals"),
    pytest.mark.xdist_group("kills"),
]

TEXT = """
[surface]
shape = [24, 24]
seed = {seed}
[aging]
last = 1e4
[sweep]
load = [6.0, 20.0]
k1 = [1.0, 3.0]
seeds = 30
"""


def kill_something(running, rng):
    """Kill the client, one of its workers, or everything; return what."""
    what = rng.choice(["client", "worker", "everything"])
    try:
        if what == "everything":
            os.killpg(running.pid, signal.SIGKILL)
        elif what == "client":
            os.kill(running.pid, signal.SIGKILL)
        else:
            # The workers compute; the resource tracker and the like do not.
            children = psutil.Process(running.pid).children(recursive=True)
            workers = [child for child in children if "spawn_main" in " ".join(child.cmdline())]
            if not workers:
                return None
            rng.choice(workers).kill()
    except (ProcessLookupError, psutil.Error):
        return None
    return what


def wait_for_the_end_of(group):
    """Workers notice that their client is gone, and end; the next client must not find them at work."""
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return
        time.sleep(0.1)
    os.killpg(group, signal.SIGKILL)


def kill_until_done(folder, text, kills, rng):
    """Do a campaign under fire; return the kills that hit."""
    path = written(folder, text)
    plan, out = campaign.read_plan(path), folder / "out"
    hits: list[str] = []
    finished: dict[str, bytes] = {}
    while len(hits) < kills and campaign.tally(plan, out).done < len(plan.runs):
        running = start("sweep", path, "--out", out, "--workers", "2", "--quiet")
        while running.poll() is None and len(hits) < kills:
            # From before the workers have started to the middle of their work.
            try:
                running.wait(timeout=rng.uniform(0.2, 4.0))
            except subprocess.TimeoutExpired:
                what = kill_something(running, rng)
                hits += [what] if what else []
                if what in ("client", "everything"):
                    break
        if running.poll() is None and len(hits) >= kills:
            with suppress(ProcessLookupError):
                os.killpg(running.pid, signal.SIGKILL)
        running.communicate(timeout=60)
        if rng.random() < 0.5:  # otherwise the next client starts beside dying workers
            wait_for_the_end_of(running.pid)
        now = numbers(out)
        assert {name: now.get(name) for name in finished} == finished, "a finished run was lost or changed"
        finished = now
    status, _, error = finish("sweep", path, "--out", out, "--workers", "2", "--quiet")
    assert status == 0, error
    return hits


def check(folder, expected):
    """The end is that of an undisturbed campaign, and nothing is left lying about."""
    assert numbers(folder / "out") == expected
    store = Store(folder / "out")
    store.prepare()
    assert list((store.work / "staging").iterdir()) == []
    assert list((store.work / "checkpoints").iterdir()) == []
    data = campaign.open(folder / "out")
    assert data.attrs["finished"] == data.attrs["runs"] == len(expected)


@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_twenty_kills(tmp_path):
    rng = random.Random(2)
    hits: list[str] = []
    seed = 0
    while len(hits) < 20:
        killed, quiet = tmp_path / f"killed{seed}", tmp_path / f"undisturbed{seed}"
        killed.mkdir()
        quiet.mkdir()
        text = TEXT.format(seed=seed)
        hits += kill_until_done(killed, text, 20 - len(hits), rng)
        do_here(campaign.read_plan(written(quiet, text)), quiet / "out")
        check(killed, numbers(quiet / "out"))
        seed += 1000
    assert {"client", "worker", "everything"} <= set(hits)
