"""The machine: its threads, which change no digit, and its memory, and what is refused for want of it."""

import os
import resource
import subprocess
import sys

import numpy as np
import pytest
import scipy.fft

import asperity as asp
from asperity import lattice
from asperity.base import machine
from asperity.base.machine import available, cores, require, usual_threads
from asperity.errors import AsperityError


def test_threads_follow_the_environment(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    assert usual_threads() == 3
    monkeypatch.delenv("OMP_NUM_THREADS")
    assert usual_threads() == cores() >= 1


def test_results_do_not_depend_on_the_number_of_threads(monkeypatch):
    solid = asp.solids.half_space(modulus=1.0, branches=[(0.5, 1.0)])
    monkeypatch.setattr(lattice, "_WORTH_SHARING", 2**10)
    workers, transform = set(), scipy.fft.rfftn

    def counted(*args, **options):
        workers.add(options["workers"])
        return transform(*args, **options)

    monkeypatch.setattr(scipy.fft, "rfftn", counted)
    heights = np.random.default_rng(0).normal(size=(65, 63))
    found = []
    for n in ("1", "3"):
        monkeypatch.setenv("OMP_NUM_THREADS", n)
        contact = asp.press(heights, solid, load=0.02 * heights.size)
        found.append(np.array([contact.u, asp.age(contact, [1.0]).final.u0]))
    np.testing.assert_array_equal(found[0], found[1])
    assert workers == {1, 3}


HISTORIES = """
import hashlib, numpy as np, asperity as asp
heights = np.random.default_rng(0).normal(size=(110, 100))
law = asp.solids.Eyring(rate=1.0, stress=1.0)
for k0, creep in ((1.0, law), (0.0, None)):
    solid = asp.solids.spring_lattice(k0=k0, k1=3.0, creep=creep)
    final = asp.age(asp.press(heights, solid, load=200.0), [0.01]).final
    print(hashlib.sha256(final.u.tobytes() + final.u0.tobytes()).hexdigest())
"""


@pytest.mark.slow
@pytest.mark.skipif(cores() < 2, reason="needs two cores")
def test_libraries_with_threads_of_their_own_change_no_digit():
    # They take what the environment says as they are loaded, and share sums over more than 10,000 numbers.
    found = [
        subprocess.check_output(
            [sys.executable, "-c", HISTORIES], env=os.environ | {"OMP_NUM_THREADS": n}, text=True, timeout=120
        )
        for n in ("1", "2")
    ]
    assert found[0] == found[1]


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
    monkeypatch.setattr(machine, "available", lambda: 10_000)
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
    assert list(machine._control_groups(tmp_path, own)) == [5000 - 1000 + 200]


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_a_limit_on_address_space_counts(monkeypatch):
    monkeypatch.setattr(resource, "getrlimit", lambda _: (2**50, 2**50))
    (left,) = machine._address_space()
    assert 0 < 2**50 - left < 2**40


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
def test_no_process_that_begins_unhurried_hears_ctrl_c():
    tell = "import signal; print(signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, ()))"
    code = f"""import multiprocessing
from asperity.base.machine import unhurried
process = multiprocessing.get_context("spawn").Process(target=exec, args=({tell!r},))
with unhurried():
    process.start()
process.join()
{tell}"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.stdout.split() == ["True", "False"], done.stderr


@pytest.mark.parametrize("result", ["time.sleep(300)", "bytes(10**7)"])  # one that computes, one that writes
def test_workers_end_with_the_process_that_began_them(tmp_path, result):
    script = tmp_path / "script.py"
    script.write_text(f"""
import os, signal, sys, time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from asperity.base.machine import end_with_parent

def work(_):
    os.write(1, b"working")
    return {result}

if __name__ == "__main__":
    with ProcessPoolExecutor(2, get_context("spawn"), end_with_parent) as pool:
        pool.map(work, range(8))
        os.read(0, 1)
""")
    with subprocess.Popen([sys.executable, script], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as asking:
        assert asking.stdout is not None
        assert asking.stdout.read(7) == b"working"
        asking.kill()
        asking.communicate(timeout=20)  # ends when nobody has the output any more
