# SPDX-License-Identifier: Apache-2.0
"""What deploy/ says is what the table of processes says, and what it offers works."""

import importlib.util
import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from schemas import topics
from schemas.topics import ANSWERING_SERVICES, TOPICS
from services.cli.ports import any_free_port
from services.cli.supervisord_config import supervisord_config
from services.runtime.config import load_config
from services.runtime.envelope import Envelope
from services.runtime.errors import ResourceError
from services.runtime.process_table import PROCESSES, environment_of
from services.runtime.zenoh_bus import ZenohBus

ROOT = Path(__file__).resolve().parents[3]
DEPLOY = ROOT / "deploy"


def test_every_process_is_there_and_everyone_in_the_topic_table_is_a_process() -> None:
    names = [process.name for process in PROCESSES]
    assert len(set(names)) == len(names)
    assert {topic.producer for topic in TOPICS} - {"*"} <= set(names)
    assert set(ANSWERING_SERVICES) <= set(names)
    for process in PROCESSES:
        assert importlib.util.find_spec(process.module) is not None, process.module
    assert sorted(PROCESSES, key=lambda process: process.priority) == list(PROCESSES)


def test_supervisord() -> None:
    assert (DEPLOY / "supervisord.conf").read_text() == supervisord_config()


def test_systemd() -> None:
    target = (DEPLOY / "systemd/kinemap.target").read_text()
    wanted = set(re.findall(r"kinemap@(\w+)\.service", target))
    assert wanted | {"bus"} == {process.name for process in PROCESSES}
    for process in PROCESSES:
        name, module = ("-bus", process.module) if process.name == "bus" else ("@", "services.%i.service")
        assert process.module == module.replace("%i", process.name)
        unit = (DEPLOY / f"systemd/kinemap{name}.service").read_text()
        assert f"-m {module} --config" in unit
        for variable, value in environment_of(process).items():
            assert f"{variable}={value}" in unit
        assert "RestartPreventExitStatus=2" in unit
        assert int(re.findall(r"TimeoutStopSec=(\d+)", unit)[0]) > process.stop_wait_s


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="no systemd on this machine")
def test_systemd_understands_the_units() -> None:
    units = sorted(str(path) for path in (DEPLOY / "systemd").iterdir())
    said = subprocess.run(["systemd-analyze", "verify", *units], capture_output=True, text=True, check=False).stderr
    # What is installed under /opt on a robot is not there on this machine.
    assert [line for line in said.splitlines() if "kinemap" in line and "is not executable" not in line] == []


def test_compose() -> None:
    services = yaml.safe_load((DEPLOY / "compose.yaml").read_text())["services"]
    assert set(services) - {"session"} == {process.name for process in PROCESSES}
    for process in PROCESSES:
        service = services[process.name]
        assert service["command"][1:4] == ["-m", process.module, "--config"]
        assert service["environment"] == environment_of(process)
        assert service.get("network_mode") == (None if process.name == "bus" else "service:bus")
        assert int(service.get("stop_grace_period", "40s").rstrip("s")) > process.stop_wait_s


@pytest.mark.parametrize("file", sorted((DEPLOY / "config").glob("*.toml")), ids=lambda file: file.stem)
def test_the_example_configurations_can_be_loaded(file: Path) -> None:
    assert load_config(file).model_fields_set


def test_a_new_session_has_a_folder_and_a_configuration(tmp_path: Path) -> None:
    command = [DEPLOY / "new_session.sh", tmp_path / "runs", DEPLOY / "config/robot.toml"]
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    made = subprocess.run(command, env={**os.environ, "PATH": path}, capture_output=True, text=True, check=True)
    folder = Path(made.stdout.strip())
    config = load_config(tmp_path / "runs/current/config.toml")
    assert config.run.out == folder
    assert config.run.session == folder.name
    assert config.delivery.mode == "realtime"
    (tmp_path / "bad.toml").write_text("[recorder]\nzstd_level = 99\n")
    refused = subprocess.run(
        [*command[:2], tmp_path / "bad.toml"],
        env={**os.environ, "PATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert refused.returncode == 2
    assert "zstd_level" in refused.stderr
    assert (tmp_path / "runs/current").resolve() == folder.resolve()


def test_the_router_carries_one_bus_to_the_other(tmp_path: Path) -> None:
    port = any_free_port()
    settings = tmp_path / "router.json5"
    example = (DEPLOY / "zenoh/router.json5").read_text()
    assert "tcp/0.0.0.0:7447" in example
    settings.write_text(example.replace("tcp/0.0.0.0:7447", f"tcp/127.0.0.1:{port}"))
    router = subprocess.Popen([sys.executable, DEPLOY / "zenoh/router.py", settings], stderr=subprocess.PIPE)
    try:
        overrides = {"bus": {"router": f"tcp/127.0.0.1:{port}"}}
        config = load_config(DEPLOY / "config/fleet.toml", overrides)
        while True:
            try:
                hearing = ZenohBus(config.bus, lossless=True)
                break
            except ResourceError:
                assert router.poll() is None
        with hearing, ZenohBus(config.bus, lossless=True) as saying:
            heard = hearing.subscribe([topics.IMAGE])
            image = os.urandom(1_400_000)
            message = None
            for sequence in range(100):
                saying.publish(topics.IMAGE, image, Envelope("s", sequence, sequence))
                message = message or heard.receive(0.1)
                if message is not None:
                    break
            assert message is not None
            assert message.payload == image
    finally:
        router.send_signal(signal.SIGTERM)
        assert router.wait(10) == 0
