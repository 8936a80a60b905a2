# SPDX-License-Identifier: Apache-2.0
"""Real processes under a real supervisord: up, down, death, bad input, nothing left behind."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import psutil
import pytest

from services.cli.leftovers import processes_of
from services.cli.ports import any_free_port
from services.cli.restart_limit import exceeded
from services.cli.run_folder import write_config
from services.cli.supervision import ServiceFailedError, Supervision
from services.cli.supervisord_client import socket_of
from services.runtime.config import Config, load_config
from services.runtime.errors import InputError, KinemapError
from services.runtime.process_table import ServiceProcess

pytestmark = pytest.mark.real_processes
SMALL = "tests.unit.cli.small_service"
TABLE = (
    ServiceProcess("bus", "services.runtime.entry_point", 10, has_liveliness=False),
    ServiceProcess("small", SMALL, 20),
)


@pytest.fixture(autouse=True)
def from_the_root(monkeypatch: pytest.MonkeyPatch) -> None:
    """The small service is found from the root of the repository."""
    monkeypatch.chdir(Path(__file__).resolve().parents[3])


@pytest.fixture
def config(tmp_path: Path) -> Config:
    overrides = {"run": {"out": str(tmp_path)}, "bus": {"entry_point": f"tcp/127.0.0.1:{any_free_port()}"}}
    loaded = load_config(overrides=overrides)
    write_config(loaded)
    return loaded


@pytest.fixture
def supervision(config: Config) -> Iterator[Supervision]:
    made = Supervision(config.run.out, config, processes=TABLE)
    yield made
    made.down()


def left(config: Config) -> list[psutil.Process]:
    folder = config.run.out
    return processes_of([process.module for process in TABLE], folder / "config.toml", folder / "supervisord.conf")


def until(true: Callable[[], bool], within_s: float = 10.0) -> float:
    """Wait for a state of another process; how long it took."""
    started_s = time.monotonic()
    while not true():
        assert time.monotonic() - started_s < within_s
        os.sched_yield()
    return time.monotonic() - started_s


def state(supervision: Supervision) -> str:
    return {status.name: status.state for status in supervision.status()}["small"]


def test_up_status_down(config: Config, supervision: Supervision) -> None:
    supervision.up()
    assert [(status.name, status.state, status.restarts) for status in supervision.status()] == [
        ("bus", "running", 0),
        ("small", "running", 0),
    ]
    assert supervision.failure() is None
    assert len(left(config)) == 3
    with pytest.raises(InputError, match="up already"):
        Supervision(config.run.out, config, processes=TABLE).up()
    # Another process that knows the folder only.
    Supervision(config.run.out, config, processes=TABLE).down()
    assert (config.run.out / "drained").exists()
    assert left(config) == []
    assert {status.state for status in supervision.status()} == {"down"}
    supervision.down()
    assert not socket_of(config.run.out).exists()


def test_a_killed_service_is_back(config: Config, supervision: Supervision) -> None:
    supervision.up()
    before = supervision.status()[1].pid
    assert before is not None
    os.kill(before, signal.SIGKILL)
    until(lambda: supervision.status()[1].pid not in (None, before), within_s=30.0)
    assert supervision.status()[1].restarts == 1
    assert supervision.failure() is None


def test_bad_input_is_one_line_and_not_tried_again(config: Config, supervision: Supervision) -> None:
    (config.run.out / "behaviour").write_text("bad input")
    with pytest.raises(KinemapError) as refused:
        supervision.up()
    assert str(refused.value) == "small: radius -1: expected a positive number"
    assert refused.value.exit_code == 2
    assert supervision.status()[1].restarts == 0
    assert left(config) == []


def test_one_that_always_crashes_ends_the_waiting(config: Config, supervision: Supervision) -> None:
    (config.run.out / "behaviour").write_text("crash")
    with pytest.raises(
        ServiceFailedError, match=r"small: died 5 times in 60 s.* RuntimeError: a fault nobody expected"
    ):
        supervision.up()
    assert left(config) == []
    assert supervision.status()[1].restarts == 5


def test_five_deaths_long_ago_do_not_count(tmp_path: Path) -> None:
    starts = tmp_path / "starts"
    assert [exceeded(starts, now_s) for now_s in (0, 20, 40, 60, 80, 100, 120)] == [False] * 7
    assert [exceeded(starts, now_s) for now_s in (121, 122, 123, 124)] == [False, False, True, True]


def test_one_that_is_never_ready_is_named(config: Config) -> None:
    silent = ServiceProcess("silent", "services.runtime.entry_point", 30)
    supervision = Supervision(config.run.out, config, processes=(TABLE[1], silent))
    with pytest.raises(KinemapError, match=r"not ready within 3 s: silent$"):
        supervision.up(ready_within_s=3)
    assert left(config) == []


def test_kill_9_of_supervisord_leaves_nobody(config: Config, supervision: Supervision) -> None:
    supervision.up()
    os.kill(int((config.run.out / "supervisord.pid").read_text()), signal.SIGKILL)
    until(lambda: not any(process.status() != psutil.STATUS_ZOMBIE for process in left(config)))
    error = supervision.failure()
    assert error is not None
    assert "is gone" in str(error)


def test_kill_9_of_an_attached_starter_leaves_nobody(config: Config) -> None:
    code = (
        "import sys; from pathlib import Path; from services.cli.supervision import Supervision\n"
        "from services.runtime.config import load_config; from tests.unit.cli.test_supervision import TABLE\n"
        "folder = Path(sys.argv[1])\n"
        "Supervision(folder, load_config(folder / 'config.toml'), attached=True, processes=TABLE).up()\n"
        "print('up', flush=True); sys.stdin.read()\n"
    )
    starter = subprocess.Popen(
        [sys.executable, "-c", code, str(config.run.out)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert starter.stdout is not None
    assert starter.stdout.readline() == b"up\n"
    assert len(left(config)) == 3
    starter.kill()
    starter.communicate()
    until(lambda: not left(config))


def test_what_outlived_its_supervisor_is_found_by_down(config: Config, supervision: Supervision) -> None:
    orphan = subprocess.Popen([sys.executable, "-m", SMALL, "--config", str(config.run.out / "config.toml")])
    until(lambda: bool(left(config)))
    supervision.down()
    assert orphan.wait(5) in (0, -signal.SIGTERM)


def test_the_environment_of_whoever_starts_it_does_not_override_the_run(
    config: Config, supervision: Supervision, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("KINEMAP_RUN__SESSION", "")  # would be refused
    supervision.up()
    assert state(supervision) == "running"


def test_a_folder_with_a_long_or_odd_name(tmp_path: Path, config: Config) -> None:
    folder = tmp_path / ("long" * 30) / "odd; name, 100% #1"
    config.run.out = folder
    write_config(config)
    supervision = Supervision(folder, config, processes=TABLE)
    try:
        supervision.up()
        assert state(supervision) == "running"
        assert (folder / "logs" / "small.log").exists()
        assert len(str(socket_of(folder))) < 100
    finally:
        supervision.down()
    assert not socket_of(folder).parent.exists()
