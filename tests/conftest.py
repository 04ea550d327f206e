"""Property tests draw the same examples every time: more in the slow suite, others where it is asked for."""

import os
from copy import copy

import pytest
from cyclopts import App
from cyclopts.argument import ArgumentCollection
from hypothesis import settings

settings.register_profile("same", derandomize=True)
settings.register_profile("more", derandomize=True, max_examples=500)
settings.register_profile("other", derandomize=False, max_examples=500)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "same"))


@pytest.fixture(scope="session", autouse=True)
def _no_wait_for_the_disk():
    """What is written is flushed, but not waited for: here the machine does not fail meanwhile."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(os, "fsync", lambda _: None)
        yield


@pytest.fixture(scope="session", autouse=True)
def _parameters_read_once():
    """Read the parameters of each command once, not twice a call: it takes longer than the rest."""
    read, known = App.assemble_argument_collection, {}

    def remembered(of, **how):
        key = (of.default_command, *sorted(how.items()))
        if key not in known:
            known[key] = read(of, **how)
        mine = {id(argument): copy(argument) for argument in known[key]}
        for argument in mine.values():
            argument.tokens = []
            argument.children = ArgumentCollection(mine[id(child)] for child in argument.children)
        return ArgumentCollection(mine.values())

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(App, "assemble_argument_collection", remembered)
        yield


@pytest.fixture
def here(tmp_path, monkeypatch):
    """Work in an empty folder: refusals have paths in them, which are short here."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def coarse_pictures(monkeypatch):
    """Pictures of few pixels that are not laid out take a third of the time: others judge how they look."""
    monkeypatch.setattr("asperity.figures.style.RESOLUTION", 30)
    monkeypatch.setattr("matplotlib.figure.Figure.get_layout_engine", lambda _: None)


@pytest.fixture
def no_display():
    """No window opens, and no figure is open before or after: other tests of the process may leave some."""
    from matplotlib import pyplot as plt

    plt.switch_backend("agg")
    plt.close("all")
    yield
    plt.close("all")
