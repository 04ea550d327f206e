"""A browser that looks at the page: from a server, and from an exported file."""

import base64
import json
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from asperity.app.config import config_from
from asperity.app.explore.export import exported_page
from asperity.app.explore.scene import ending, recorded
from asperity.app.runs import Progress, execute
from asperity.base.rows import words_of
from asperity.results import save

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FOLDER = Path(__file__).parent


def pytest_collection_modifyitems(items):
    """Run all in one process, where they share a browser and a server, and most in `make test-all` alone."""
    for item in items:
        if FOLDER in item.path.parents:
            item.add_marker(pytest.mark.xdist_group("browser"))
            if item.path.name != "test_first_press.py":
                item.add_marker(pytest.mark.slow)


@pytest.fixture(scope="session")
def browser():
    sync_api = pytest.importorskip("playwright.sync_api", reason="needs playwright: pip install playwright")
    with sync_api.sync_playwright() as playwright:
        try:
            made = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        except sync_api.Error:
            if CHROMIUM is not None:
                raise
            pytest.skip("needs chromium: apt-get install chromium")
        yield made
        made.close()


@pytest.fixture
def tab(browser):
    """Open addresses in tabs of their own; no page may fail, or load anything from elsewhere."""
    faults, contexts = [], []

    def open_tab(address, **options):
        settings = {"viewport": {"width": 1280, "height": 900}, "reduced_motion": "reduce", **options}
        context = browser.new_context(**settings)
        contexts.append(context)
        context.set_default_timeout(60_000)
        page = context.new_page()
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.on("console", lambda said: faults.append(said.text) if said.type == "error" else None)
        own = ("blob:", "data:", address.split("#")[0] if address.startswith("file:") else address[:21])
        page.on("request", lambda sent: None if sent.url.startswith(own) else faults.append(sent.url))
        page.goto(address)
        if address.startswith("file:"):
            until(page, "asperity.state.finished && asperity.state.drawn")
        return page

    yield open_tab
    for context in contexts:
        context.close()
    assert faults == []


def until(page, question, seconds=120):
    """Wait until an expression is true; the page's policy forbids Playwright's own way, which runs text."""
    end = time.monotonic() + seconds
    while not (answer := page.evaluate(question)):
        assert time.monotonic() < end, f"never true: {question}; {state(page)}"
        page.wait_for_timeout(30)
    return answer


def state(page):
    return page.evaluate("asperity.state")


def finished(page, after=None):
    """Wait for a run to end, another one than `after`."""
    until(
        page, f"asperity.state.finished && !asperity.state.busy && asperity.state.job !== {json.dumps(after)}"
    )
    return state(page)


def rows(page):
    """The time series of the page, by name."""
    listed = page.evaluate("Array.from({length: asperity.state.rows}, (_, at) => asperity.row(at))")
    return {name: [row[name] for row in listed] for name in listed[0]}


SMALL = {"surface": {"shape": [48, 48]}, "aging": {"per_decade": 2}}


@pytest.fixture
def live(tab, served):
    """A tab with a small run that has ended."""

    def open_live(config=SMALL, **options):
        page = tab(f"{served}#config={link(config)}", **options)
        finished(page)
        return page

    return open_live


def move_the_change_to_10(page):
    """Move the time of a change of load there by keys; gives it."""
    page.focus("#when")
    page.keyboard.press("Home")
    for _ in range(8):
        page.keyboard.press("ArrowRight")
    moment = state(page)["change"]
    assert moment == pytest.approx(10.0)
    return moment


def link(config):
    """The configuration of a link."""
    return base64.urlsafe_b64encode(json.dumps(config).encode()).decode().rstrip("=")


def again(page, act):
    """Do something that starts another run, and wait for its end."""
    before = state(page)["job"]
    act()
    return finished(page, after=before)


@pytest.fixture(scope="session")
def outcome():
    """A run with an unloading, as the library makes it: maps at all recorded times."""
    first, last = ({"kind": "hold", "duration": duration} for duration in (100.0, 10.0))
    tables = {"surface": {"shape": [64, 64], "seed": 3}, "contact": {"load": 150.0}}
    tables["aging"] = {"per_decade": 2, "first": 0.01}
    tables["protocol"] = [first, {"kind": "step", "load": 50.0}, last]
    config = config_from(tables, {}, None)
    times = np.unique(execute(config, Progress()).dataset["time"].values).tolist()
    maps = config.output.but(maps_at=times)
    return execute(config.but(output=maps), Progress())


@pytest.fixture(scope="session")
def exported(outcome, tmp_path_factory):
    """The page of that run, in a file."""
    recording = recorded(outcome.dataset, outcome.config, job="unloading", title='Unloading <&> "quoted"')
    recording.end = ending(outcome.dataset, words_of(outcome.rows()))
    path = tmp_path_factory.mktemp("exported") / "page.html"
    path.write_text(exported_page(recording.messages(), title="Unloading"), encoding="utf-8")
    return path.as_uri()


@pytest.fixture(scope="session")
def served(outcome, tmp_path_factory):
    """Address of a server of its own process, for a folder with two results."""
    pytest.importorskip("uvicorn", reason="needs the extra explore")
    command = [sys.executable, "-W", "ignore", "-m", "asperity", "explore", "--no-browser"]
    folder = tmp_path_factory.mktemp("folder")
    for name in ("first", "second"):
        save(outcome.dataset, folder / f"{name}.zarr")
    command.append(str(folder))
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    yield process.stdout.readline().split()[0]
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
