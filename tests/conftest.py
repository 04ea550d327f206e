"""Property tests draw the same examples every time: more in the slow suite, others where it is asked for."""

import os

import pytest
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
