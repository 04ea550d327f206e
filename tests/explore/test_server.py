"""The running server: what a page is told, how it stays quick, and what it survives."""

from __future__ import annotations

import asyncio
import io
import math
import os
import shutil
import socket
import time as clock
import tomllib
from collections.abc import Coroutine
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext, suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from urllib.parse import quote

import numpy as np
import psutil
import pytest

from asperity.app.config import config_from
from asperity.app.config.python import to_python
from asperity.app.explore.export import page_files
from asperity.app.runs import Progress, execute, recorded_times
from tests.explore.conftest import LARGE, QUICK, Server, column, heights_of, maps, only

pytest.importorskip("uvicorn", reason="needs the extra explore")

STEPPED = QUICK | {
    "contact": {"load": 20.0},
    "aging": {"first": 0.1},
    "protocol": [
        {"kind": "hold", "duration": 10.0},
        {"kind": "step", "load": 5.0},
        {"kind": "hold", "duration": 10.0},
    ],
}
SI: dict[str, Any] = {
    "surface": {"kind": "spectral", "shape": [24, 24], "rms_slope": 0.1, "spacing": [2e-6], "unit": "m"},
    "solid": {"kind": "half_space", "modulus": "3 GPa", "branches": [[0.3, 1.0]], "apparatus": "inf"},
    "contact": {"pressure": "2 MPa"},
}
CREEP = {"creep": "eyring", "creep_rate": 0.1, "creep_stress": 0.5}
YIELDING = QUICK | {"solid": {"R": 0.5, "hardness": 2.0, **CREEP}}
MANY = {"aging": {"first": 1e-3, "last": 1e6, "per_decade": 100}}
"""Times enough to do something meanwhile."""


def workers(parent: int | None = None) -> list[psutil.Process]:
    """Processes of a server, or of this process, that compute."""
    found = []
    for one in psutil.Process(parent).children():
        with suppress(psutil.Error):  # one that ends meanwhile has no command
            found += [one] * ("explore.work" in " ".join(one.cmdline()))
    return found


def seed(number: int) -> dict[str, Any]:
    return QUICK | {"surface": {"shape": [24, 24], "seed": number}}


def posting(server: Server, name: str, lines: str, length: int) -> socket.socket:
    """A connection on which a file of this length is announced, with lines of the header."""
    raw = socket.create_connection(("127.0.0.1", server.port), timeout=30)
    host = f"POST /files/{name} HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\n"
    raw.sendall(f"{host}{lines}Content-Length: {length}\r\n\r\n".encode())
    return raw


def test_a_page_is_told_what_there_is(server: Server) -> None:
    with server.page() as page:
        header = page.hello
    assert header["kind"] == "hello"
    assert header["form"]["solid"]["half_space"]["modulus"]["unit"] == "Pa"
    assert "draws" not in header["form"]["solid"]["half_space"]
    assert [one["path"] for one in header["folder"]] == ["a run", "deeper/campaign"]


@pytest.mark.parametrize("config", [STEPPED, SI, YIELDING], ids=["protocol", "si", "yielding"])
def test_a_run_has_the_numbers_of_the_command_line(server: Server, config: dict[str, Any]) -> None:
    with server.page() as page:
        messages = page.ran(config)
    scene = only(messages, "scene")[0]
    solid = {name: math.inf if one == "inf" else one for name, one in scene["config"]["solid"].items()}
    asked = config_from({**scene["config"], "solid": solid}, {}, None)
    asked = asked.but(output=asked.output.but(maps_at=[0.0]))
    outcome = execute(asked, Progress())
    dataset = outcome.dataset
    for name in ("time", "area", "load", "separation", "residual"):
        assert np.array_equal(column(messages, name), dataset[name].values)
    # Text to copy says the same: nothing is left open, and it is that of the run.
    written = outcome.config.but(output=config_from({}, {}, None).output)
    assert scene["python"] == to_python(written, recorded_times(written).tolist())
    assert "per_decade = 8" in scene["toml"]
    facts, in_contact, pressure = maps(messages)[0]
    assert np.array_equal(in_contact, dataset["in_contact"].isel(field_time=0).values)
    cell = np.prod(scene["spacing"] or [1.0])
    load = pressure.astype(float).sum() * facts["pressure_scale"] / 65535 * cell
    assert load == pytest.approx(dataset["load"].values[0], rel=1e-4)
    done = only(messages, "done")[0]
    if outcome.summary is not None:
        assert done["limit"]["area"] == dataset.attrs["relaxed_area"]
    if scene["length_unit"]:
        units = {"time": "s", "area": "m^2", "load": "N", "pressure": "Pa", "height": "m", "separation": "m"}
        assert scene["units"] == units
        assert column(messages, "contact_area") == dataset["contact_area"].values.tolist()
    assert len(maps(messages)) > 10
    if config is STEPPED:  # both sides of a step are mapped
        at = [facts for facts, _, _ in maps(messages).values() if facts["time"] == 10.0]
        assert [(one["leg"], one["side"]) for one in at] == [(0, ""), (1, "after")]
        assert at[0]["area"] > at[1]["area"]
        assert scene["switches"] == [10.0]


def test_the_same_run_is_not_computed_again(server: Server) -> None:
    with server.page() as page:
        first = page.ran(seed(11))
        second = page.ran(seed(11))
    with server.page() as other:
        third = other.ran(seed(11))
    for again in (second, third):
        assert column(again, "area") == column(first, "area")
        assert only(again, "done")[0]["rows"] == only(first, "done")[0]["rows"]  # the seconds too
        assert len(again) == 3


@pytest.mark.slow
def test_a_page_that_is_loaded_again_joins_its_run(server: Server) -> None:
    config = MANY | {"surface": {"shape": [64, 64], "seed": 5}}
    with server.page() as page:
        page.send("run", config=config)
        before = page.until("rows")
    with server.page() as page:
        page.send("run", config=config)
        after = page.until("done")
    assert only(after, "scene")[0]["job"] == only(before, "scene")[0]["job"]
    assert len(column(after, "time")) == 2 + 9 * 100
    assert "time steps" in dict(only(after, "done")[0]["rows"])["worst residual"]


def test_a_slow_page_gets_the_latest_in_one(server: Server) -> None:
    config = seed(31) | {"aging": {"first": 1e-3, "last": 1e3, "per_decade": 20}}
    with server.page(slow=True) as slow, server.page() as quick:
        slow.send("run", config=config)
        all_of_it = quick.ran(config)
        with pytest.raises(TimeoutError):  # nothing comes before the first message was acknowledged
            slow.socket.recv(timeout=0.3)
        slow.acknowledge()
        late = slow.until("done")
    assert [header["kind"] for header, _ in late] == ["scene", "rows", "done"]
    assert late[1][0]["time_now"] == column(late, "time")[-1] == 1e3
    assert column(late, "area") == column(all_of_it, "area")
    assert maps(late).keys() == maps(all_of_it).keys()


@pytest.mark.slow
def test_a_large_press_keeps_nobody_waiting_and_can_be_stopped(server: Server) -> None:
    with server.page() as page, server.page() as other:
        page.send("run", config=LARGE)
        while "pressing" not in page.receive()[0].get("text", ""):
            pass
        waits = []
        for _ in range(10):
            begun = clock.perf_counter()
            other.send("run", config={"contact": {"load": -1.0}})
            assert other.receive()[0]["kind"] == "mistakes"
            waits.append(clock.perf_counter() - begun)
        assert np.median(waits) < 0.5  # one may be longer, where the machine was busy
        begun = clock.perf_counter()
        page.send("stop")
        stopped = page.until("scene", "failed")[-1][0]
        assert stopped["mistakes"] == [{"where": "", "text": "stopped"}]
        assert clock.perf_counter() - begun < 2.0
        assert page.ran(seed(41))[-1][0]["kind"] == "done"


@pytest.mark.slow
def test_a_killed_process_is_said_and_replaced(server: Server) -> None:
    with server.page() as page:
        page.send("run", config=LARGE | {"surface": {"shape": [1024, 1024], "seed": 3}})
        while "pressing" not in page.receive()[0].get("text", ""):
            pass
        for worker in workers(server.process.pid):
            worker.kill()
        failed = page.until("failed")[-1][0]
        assert failed["mistakes"] == [
            {"where": "", "text": "the computing process was stopped by the system (signal 9); press again"}
        ]
        assert page.ran(seed(51))[-1][0]["kind"] == "done"


NESTED = {"protocol": [{"kind": "repeat", "count": 2, "legs": [{"kind": "step"}]}]}
TABLE = {"solid": {"kind": "half_space", "modulus": 1.0, "relaxation": "/etc/hosts"}}
MISTAKES: list[tuple[object, str, str]] = [
    ({"contact": {"load": -1}}, "contact.load", "expected more than 0, got -1; try adhesion"),
    (NESTED, "protocol[0].legs[0]", "load, pressure, separation and approach: expected exactly one of them"),
    ({"solid": {"k_0": 1.0}}, "solid.k_0", "no such key; try k0"),
    ({"contact": {"separation": 100.0}}, "contact.separation", "at which the solids touch"),  # found late
    ({"surface": {"shape": [10**6, 10**6]}}, "", "fits into the memory"),
    (3, "", "expected the sections of a configuration"),
    (SI | {"contact": {"pressure": "0,5 MPa"}}, "contact.pressure", "got '0,5 MPa'; try 0.5 MPa"),
    ({"surface": {"kind": "file", "path": "/etc/passwd"}}, "surface.path", "dropped on the page"),
    (TABLE, "solid.relaxation", "dropped on the page"),
]


def test_a_mistake_is_said_in_one_line_where_it_is(server: Server) -> None:
    with server.page() as page:
        for config, where, text in MISTAKES:
            (found,) = page.ran(config)[-1][0]["mistakes"]
            assert found["where"] == where
            assert text in found["text"]
            assert "\n" not in found["text"]


def test_nonsense_ends_a_connection_and_nothing_else(server: Server) -> None:
    for text in ("{", "[" * 5000, '{"kind": "ack"}', "3"):
        with server.page() as page:
            page.socket.send(text)
    with server.page() as page:
        page.send("open", path=["no", "text"])
        assert page.receive()[0]["kind"] == "failed"
        page.send("nothing that is known")
        assert page.ran(seed(1))[-1][0]["kind"] == "done"


def text_of(heights: Any) -> bytes:
    stream = io.BytesIO()
    np.savetxt(stream, heights)
    return stream.getvalue()


def test_a_dropped_file_becomes_a_surface_that_no_other_of_its_name_replaces(server: Server) -> None:
    first, second = (np.random.default_rng(4).normal(size=(n, n)) for n in (12, 6))
    paths = [server.upload("my%20scan.txt", text_of(one))[1]["path"] for one in (first, second)]
    surface = {"kind": "file", "periodic": "wrap", "tilt": "none"}
    configs = [{"surface": surface | {"path": one}, "aging": {"last": 1.0}} for one in paths]
    with server.page() as tab, server.page() as other:
        for page, config, heights in (
            (tab, configs[0], first),
            (other, configs[1], second),
            (tab, configs[0], first),
            (tab, configs[1], second),
        ):
            shown = only(page.ran(config), "scene")
            scene, _ = shown
            assert heights_of(shown) == pytest.approx(heights, abs=1e-4)
            assert scene["config"]["surface"]["path"] == config["surface"]["path"]  # what a change presses
            assert 'path = "my scan.txt"' in scene["toml"]
            assert "asp.surfaces.read('my scan.txt'" in scene["python"]
            assert scene["title"].startswith("my scan.txt on ")
        cut = server.upload("my%20scan.txt", b"1 2\n3\n")[1]["path"]
        (mistake,) = other.ran({"surface": surface | {"path": cut}})[-1][0]["mistakes"]
    assert mistake["where"] == "surface.path"
    assert mistake["text"].startswith("my scan.txt: expected ")


@pytest.mark.parametrize(
    ("section", "key", "head"), [("solid", "relaxation", "time_s,E_MPa"), ("output", "measured", "time,area")]
)
def test_tables_of_the_same_name_are_two(server: Server, section: str, key: str, head: str) -> None:
    scan = {"kind": "spectral", "shape": [16, 16], "rms_slope": 0.1, "spacing": [1e-6], "unit": "m"}
    config: dict[str, Any] = {"aging": {"first": 1.0, "last": 10.0}, "solid": {}, "output": {}}
    if section == "solid":
        config |= {"solid": {"kind": "half_space", "poisson": 0.3}, "surface": scan}
    rows = [(1, 9), (2, 8), (5, 7), (10, 6), (20, 5), (50, 4)]
    tables = [head + "".join(f"\n{time},{scale * value}" for time, value in rows) for scale in (1, 3)]
    paths = [server.upload("t.csv", table.encode())[1]["path"] for table in tables]
    found = []
    with server.page() as page:
        for path in (*paths, paths[0]):
            messages = page.ran(config | {section: config[section] | {key: path}})
            assert messages[-1][0]["kind"] == "done", messages[-1]
            found.append(only(messages, "scene")[0]["config"][section])
    assert found[0] == found[2] != found[1]


def test_a_dropped_file_is_not_that_of_the_folder(results_folder: Path) -> None:
    from asperity.app.explore.server import Places, read_request

    folder, dropped = results_folder / "a run", results_folder / "deeper"
    places = Places(folder, dropped)
    (dropped / "0123").mkdir(exist_ok=True)
    for home, size in ((folder, 12), (dropped / "0123", 6)):
        (home / "both.txt").write_bytes(text_of(np.eye(size)))
    for name, known, size in (("both.txt", "both.txt", 12), ("0123/both.txt", "both.txt", 6)):
        config, shown = read_request({"surface": {"kind": "file", "path": name}}, places)
        assert shown == {str(config.surface.file): (name, known, "surface.path")}
        assert config.surface.build().shape == (size, size)


@pytest.mark.parametrize(
    "name",
    [
        "10:30.txt",
        "10.30\u202fAM\xa0.txt",
        ".hidden",
        "Icon\r",
        "\ufffd.txt",
        "x" * 251 + ".txt",
        "a%23?.txt",
    ],
)
def test_a_dropped_file_may_have_any_name_of_a_disk(server: Server, name: str) -> None:
    heights = np.random.default_rng(len(name)).normal(size=(8, 8))
    status, told = server.upload(quote(name, safe=""), text_of(heights))
    assert (status, told["path"].partition("/")[2]) == (200, name)
    surface = {"kind": "file", "path": told["path"], "periodic": "wrap", "tilt": "none"}
    with server.page() as page:
        shown = only(page.ran({"surface": surface, "aging": {"last": 1.0}}), "scene")
    assert heights_of(shown) == pytest.approx(heights, abs=1e-4)
    assert tomllib.loads(shown[0]["toml"])["surface"]["path"] == name


def test_names_of_dropped_files_lead_nowhere_and_are_as_long_as_the_disk_takes(server: Server) -> None:
    for name in ("..", "a%2Fb", "a%00b", "a%5Cb"):
        assert server.upload(name, b"x")[0] in (400, 404, 405)
    status, told = server.upload("x" * 256, b"1 2\n3 4\n")
    assert status == 400
    assert told["mistakes"][0]["text"].endswith("File name too long")


def test_results_are_opened_and_what_lies_outside_is_not(server: Server) -> None:
    with server.page() as page:
        page.send("open", path="deeper/campaign")
        assert [header["kind"] for header, _ in page.until("done")] == ["campaign", "scene", "rows", "done"]
        for path in ("../outside", "/etc", "link", "nope", "\0", "\ud800"):
            page.send("open", path=path)
            found = page.receive()[0]
            assert found["kind"] == "failed"
            assert "expected" in found["mistakes"][0]["text"]


def test_the_page_may_load_nothing_from_elsewhere_and_other_files_are_not_served(server: Server) -> None:
    for path in ("/", "/shell.html", "/style.css", "/main.js"):
        status, content, headers = server.request("GET", path)
        assert status == 200
        assert content == page_files().get(path[1:] or "index.html", content)
        policy = headers["Content-Security-Policy"]
        assert policy.startswith("default-src 'none'")
        assert "unsafe" not in policy
        assert "*" not in policy
        assert headers["X-Content-Type-Options"] == "nosniff"
    for path in ("/../server.py", "/%2e%2e/server.py", "/..%2fscene.py", "/files/x", "/none.js"):
        assert server.request("GET", path)[0] in (404, 405)


def test_other_hosts_and_pages_of_others_are_refused(server: Server) -> None:
    from websockets.exceptions import InvalidStatus

    port = server.port
    for host in (
        "evil.example",
        f"evil.example:{port}",
        f"localhost.evil.example:{port}",
        f"x@localhost:{port}",
        "",
    ):
        assert server.request("GET", "/", Host=host)[0] in (400, 403)
    for origin in ("http://evil.example", "null", None, "http://127.0.0.1", "http://127.0.0.1:1"):
        with pytest.raises(InvalidStatus) as refused, server.page(origin=origin):
            pass
        assert refused.value.response.status_code == 403
        headers: dict[str, Any] = {} if origin is None else {"Origin": origin}
        assert server.request("POST", "/files/x", b"x", **headers)[0] == 403
        assert origin is None or server.request("GET", "/", **headers)[0] == 403
    own, other = f"Origin: {server.address}\r\n", "Origin: http://evil.example\r\n"
    for lines, status in ((own, b"200"), (other + own, b"403"), (own + own, b"403")):
        with posting(server, "two.npy", lines, 1) as raw:
            raw.sendall(b"a")
            assert raw.recv(100).split()[1] == status


@pytest.mark.parametrize("own", ["localhost:9765", "127.0.0.1:1", "localhost", "[::1]:9765"])
def test_a_page_at_another_port_of_a_tunnel_is_served(server: Server, own: str) -> None:
    from websockets.exceptions import InvalidStatus

    status, _, headers = server.request("GET", "/", Host=own)
    assert (status, f"ws://{own};" in headers["Content-Security-Policy"]) == (200, True)
    for origin, expected in ((f"http://{own}", 200), (server.address, 403), ("http://localhost:2", 403)):
        status, *_ = server.request("POST", "/files/x", b"1 2\n3 4\n", Host=own, Origin=origin)
        assert status == expected
        with (
            suppress(InvalidStatus) if expected == 403 else nullcontext(),
            socket.create_connection(("127.0.0.1", server.port), timeout=30) as through,
            server.page(at=own, origin=origin, sock=through) as page,
        ):
            assert (page.hello["kind"], expected) == ("hello", 200)


@pytest.mark.slow
def test_an_upload_that_is_cut_off_and_a_name_that_is_no_text_are_no_faults(
    results_folder: Path, tmp_path: Path
) -> None:
    shutil.copytree(results_folder / "a run", tmp_path / os.fsdecode(b"bad\xffname"))
    own = Server(tmp_path)
    with posting(own, "cut.npy", f"Origin: {own.address}\r\n", 100_000) as raw:
        raw.sendall(b"abc")
        clock.sleep(0.3)
    assert own.upload("whole.npy", b"a")[0] == 200
    with own.page() as page:
        (found,) = page.hello["folder"]
        assert found["title"].isprintable()
        page.send("open", path=found["path"])
        assert [header["kind"] for header, _ in page.until("done", "failed")] == ["scene", "rows", "done"]
    assert own.end() == (0, "")


def test_it_listens_on_this_machine_alone(server: Server) -> None:
    listening = [
        one for one in psutil.Process(server.process.pid).net_connections() if one.status == "LISTEN"
    ]
    assert {one.laddr.ip for one in listening} == {"127.0.0.1"}


@pytest.mark.slow
def test_it_ends_quietly_with_all_its_processes() -> None:
    own = Server()
    with own.page() as page:
        page.send("run", config=LARGE)
        page.until("stage")
        children = psutil.Process(own.process.pid).children(recursive=True)
        assert children
        assert own.end() == (0, "")
    assert not psutil.wait_procs(children, timeout=120)[1]


@pytest.mark.slow
def test_it_ends_quietly_before_the_end_of_an_upload() -> None:
    own = Server()
    with posting(own, "part.npy", f"Origin: {own.address}\r\n", 100_000) as raw:
        assert own.request("GET", "/style.css")[0] == 200  # after which the upload has begun
        raw.sendall(b"abc")
        assert own.end() == (0, "")


@pytest.mark.slow
def test_its_processes_end_when_it_is_killed() -> None:
    own = Server()
    with own.page() as page:
        page.send("run", config=LARGE)
        page.until("stage")
        children = psutil.Process(own.process.pid).children(recursive=True)
        assert children
    own.process.kill()
    own.process.communicate(timeout=30)
    assert not psutil.wait_procs(children, timeout=120)[1]  # they compile first where nothing is cached


@pytest.mark.slow
def test_pages_share_a_run_until_the_last_leaves_it(server: Server) -> None:
    config = MANY | {"surface": {"shape": [64, 64], "seed": 9}}
    with server.page() as one, server.page() as other:
        one.send("run", config=config)
        one.until("rows")
        other.send("run", config=config)
        other.until("rows")
        one.send("stop")
        one.until("failed")
        assert other.until("done", "failed")[-1][0]["kind"] == "done"


def outcome_of(doing: Coroutine[Any, Any, Any]) -> Any:
    """Run in a thread, as the tests of the page in a browser leave a loop in this one."""
    with ThreadPoolExecutor(1) as aside:
        return aside.submit(asyncio.run, doing).result(timeout=60)


@pytest.mark.slow
def test_a_run_goes_to_another_process_when_the_one_that_waited_has_ended() -> None:
    from asperity.app.explore.jobs import Jobs

    async def ended() -> dict[str, Any]:
        jobs = Jobs()
        await jobs.warm()
        for child in workers():
            child.kill()  # the loop has not seen it yet when the run begins
        job = jobs.ask(config_from(QUICK, {}, None), {}, "")
        assert job.task is not None
        await job.task
        await jobs.close()
        assert job.recording.end is not None
        return job.recording.end

    assert outcome_of(ended())["kind"] == "done"


def test_a_page_that_leaves_late_stops_no_later_run_of_the_same_name(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from asperity.app.explore.jobs import Jobs

    async def follow(*_: object) -> None:
        await asyncio.Event().wait()

    def nothing() -> None: ...

    async def runs() -> bool:
        jobs, config = Jobs(), config_from(QUICK, {}, None)
        first = jobs.ask(config, {}, "")
        jobs.leave(first, nothing, at_once=False)
        jobs.leave(first, nothing, at_once=True)
        assert first.task is not None
        await asyncio.wait([first.task])
        again = jobs.ask(config, {}, "")
        await asyncio.sleep(0.1)  # longer than a page is waited for
        found = again is not first and jobs.ask(config, {}, "") is again
        await jobs.close()
        return found

    monkeypatch.setattr(Jobs, "_follow", follow)
    monkeypatch.setattr("asperity.app.explore.jobs._UNWATCHED", 0.05)
    assert outcome_of(runs())


def test_a_connection_whose_sending_fails_is_closed() -> None:
    from starlette.websockets import WebSocketDisconnect

    from asperity.app.explore.server import Session

    closed = asyncio.Event()
    codes: list[int] = []

    async def nothing(*_: bytes) -> None: ...

    async def receive_text() -> str:
        await closed.wait()
        raise WebSocketDisconnect

    async def close(code: int = 1000) -> None:
        codes.append(code)
        closed.set()

    async def serve() -> list[int]:
        socket: Any = SimpleNamespace(
            accept=nothing, send_bytes=nothing, receive_text=receive_text, close=close
        )
        server: Any = SimpleNamespace(hello=lambda: {"kind": "hello", "odd": object()})
        with pytest.raises(TypeError):  # for the terminal: a fault of ours
            await asyncio.wait_for(Session(socket, server).run(), 50)
        return codes

    assert outcome_of(serve())[0] == 1011
