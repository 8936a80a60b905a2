# SPDX-License-Identifier: Apache-2.0
"""The mapstore as its own process: what cannot be is one line and exit code 2, without a traceback."""

import socket
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def run_mapstore(out: Path, **mapstore: object) -> subprocess.CompletedProcess[str]:
    """The process until it gives up."""
    options = "\n".join(f"{name} = {value!r}" for name, value in mapstore.items())
    (out / "config.toml").write_text(f"[run]\nout = '{out}'\nsession = 'test'\n[mapstore]\n{options}\n")
    command = [sys.executable, "-m", "services.mapstore.service", "--config", str(out / "config.toml")]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60, check=False)


def assert_one_line(ended: subprocess.CompletedProcess[str], expected: str) -> None:
    assert ended.returncode == 2, ended.stderr
    assert "Traceback" not in ended.stderr
    last = ended.stderr.splitlines()[-1]
    assert last.startswith("kinemap mapstore: error: ")
    assert expected in last


@pytest.mark.real_processes
def test_a_port_in_use(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert_one_line(
            run_mapstore(tmp_path, http_port=port), f"port {port} on 127.0.0.1 is in use; expected a free one"
        )


@pytest.mark.real_processes
def test_a_map_of_a_newer_kinemap(tmp_path: Path) -> None:
    with sqlite3.connect(tmp_path / "map.sqlite") as connection:
        connection.execute(f"PRAGMA application_id = {0x4B4D4150}")
        connection.execute("PRAGMA user_version = 9")
    assert_one_line(run_mapstore(tmp_path, http_port=0), "map.sqlite: map version 9, expected at most 2")


@pytest.mark.real_processes
def test_a_map_that_is_something_else(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("no map")
    assert_one_line(
        run_mapstore(tmp_path, http_port=0, database=str(tmp_path / "notes.txt")),
        "notes.txt: no kinemap map, or a damaged one",
    )


@pytest.mark.real_processes
@pytest.mark.parametrize(
    ("option", "value", "expected"),
    [
        ("density_radius", -1, "mapstore.density_radius = -1: input should be greater than 0"),
        ("high_density_points", 0, "mapstore.high_density_points = 0"),
        ("http_port", 99999, "mapstore.http_port = 99999"),
        ("base_from_camera", [0, 0, 0, 0, 0, 0, 2], "quaternion of length 2, expected 1"),
    ],
)
def test_an_option_out_of_range(tmp_path: Path, option: str, value: object, expected: str) -> None:
    assert_one_line(run_mapstore(tmp_path, **{option: value}), expected)
