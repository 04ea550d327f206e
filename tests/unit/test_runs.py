"""One run from its configuration: what is kept when a part of it fails."""

import scipy.fft

import asperity.runs.pipeline as module
from asperity.config import config_from
from asperity.errors import ConvergenceError
from asperity.runs import Silent, execute

SMALL = config_from({"surface": {"shape": [12, 12]}, "aging": {"last": 0.1}}, {}, None)


def test_a_limit_that_is_not_found_is_a_remark_and_no_loss(monkeypatch):
    def fail(*_, **__):
        raise ConvergenceError("gave up")

    monkeypatch.setattr(module, "relax", fail)
    outcome = execute(SMALL, Silent())
    assert outcome.remarks[-1] == "no relaxed state: gave up"
    assert outcome.summary is not None
    assert outcome.summary.relaxed_ratio is None
    assert outcome.dataset.sizes["time"] == 10


def test_the_numbers_do_not_depend_on_threads(monkeypatch):
    found: list[int] = []
    transform = scipy.fft.rfftn

    def counted(*args, **options):
        found.append(scipy.fft.get_workers())
        return transform(*args, **options)

    monkeypatch.setattr(scipy.fft, "rfftn", counted)
    monkeypatch.setattr(module, "_LARGE", 1)
    energies = []
    for threads in (1, 3):
        found.clear()
        energies.append(execute(SMALL, Silent(), threads=threads).dataset["energy"])
        assert set(found) == {threads}
    assert energies[0].equals(energies[1])
