"""The memory there is, and what is refused for want of it."""

import resource
import sys

import pytest

import asperity.base.machine as memory
from asperity.base.machine import available, require
from asperity.errors import AsperityError


def test_there_is_some():
    assert 1e6 < available() < 1e15


def test_what_fits_passes_and_the_advice_fits():
    there = available()
    require(100, (8, 8))
    with pytest.raises(MemoryError, match=r"4000000 x 4000000 sites: expected .*; try at most") as caught:
        require(204, (4_000_000, 4_000_000))
    assert isinstance(caught.value, AsperityError)
    side = int(str(caught.value).split()[-2])
    assert side**2 * 204 == pytest.approx(there, rel=0.5)


@pytest.mark.parametrize(
    ("shape", "power", "advice"),
    [((200, 100), False, "31 x 31"), ((64, 64), True, "16 x 16"), ((2000,), False, "1000")],
)
def test_the_largest_lattice_that_would_fit(shape, power, advice, monkeypatch):
    monkeypatch.setattr(memory, "available", lambda: 10_000)
    with pytest.raises(MemoryError, match=f"at most {advice} sites$"):
        require(10, shape, power_of_two=power)


@pytest.mark.parametrize("version", [1, 2])
def test_control_groups_leave_what_their_limits_say(version, tmp_path):
    own = tmp_path / "own"
    if version == 2:
        own.write_text("0::/job/step\n")
        group, names = tmp_path / "job", ("memory.max", "memory.current", "inactive_file")
    else:
        own.write_text("4:cpu:/\n3:memory,other:/job/step\n0::/\n")
        group = tmp_path / "memory" / "job"
        names = ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file")
    (group / "step").mkdir(parents=True)
    for folder, limit, used in ((group, 5000, 1000), (group / "step", "max" if version == 2 else 2**63, 0)):
        (folder / names[0]).write_text(f"{limit}\n")
        (folder / names[1]).write_text(f"{used}\n")
        (folder / "memory.stat").write_text(f"anon 3\n{names[2]} 200\n")
    assert list(memory._control_groups(tmp_path, own)) == [5000 - 1000 + 200]


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_a_limit_on_address_space_counts(monkeypatch):
    monkeypatch.setattr(resource, "getrlimit", lambda _: (2**50, 2**50))
    (left,) = memory._address_space()
    assert 0 < 2**50 - left < 2**40
