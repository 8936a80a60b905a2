# SPDX-License-Identifier: Apache-2.0
"""`kinemap run` as a user runs it: real processes on a real bus, HTTP while it runs, and a kill -9 for each of them."""

import hashlib
import json
import os
import re
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Callable
from pathlib import Path

import psutil
import pytest
import tomli_w

from services.cli.ports import any_free_port
from services.runtime.config import dump_config
from tests.pipeline_rig import SHORT_FRAMES, short_drive

pytestmark = pytest.mark.real_processes

LIMIT_S = 240.0
KINEMAP = [sys.executable, "-m", "services.cli.app"]
KILLED = ("camera", "segmenter", "motion", "tracker", "slam", "mapstore", "recorder", "bus")
RESULTS = ("trajectory.tum", "keyframes.tum", "map.pcd")


class Run:
    """One `kinemap run` of the short drive."""

    def __init__(self, folder: Path) -> None:
        self.out = folder / "run"
        self.port = any_free_port()
        config = dump_config(short_drive(self.out, delivery={"resend_after_s": 0.5}))
        del config["run"], config["bus"]
        config["mapstore"] |= {"serve_http": True, "http_port": self.port}
        file = folder / "run.toml"
        file.write_text(tomli_w.dumps(config), encoding="utf-8")
        self.log = (folder / "output.txt").open("w+", encoding="utf-8")
        command = [*KINEMAP, "run", "--config", str(file), "--out", str(self.out)]
        self.process = subprocess.Popen(command, stdout=self.log, stderr=subprocess.STDOUT, cwd=folder)
        self.began_s = time.monotonic()

    def get(self, path: str) -> tuple[int, str]:
        """Status and body of one request to the gateway; status 0 while nobody listens."""
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{self.port}{path}", timeout=5) as answer:
                return answer.status, answer.read().decode()
        except urllib.error.HTTPError as error:
            return error.code, error.read().decode()
        except OSError:
            return 0, ""

    def frames_done(self) -> int:
        """How many frames the map store has done, by the gateway's metrics."""
        found = re.search(r"^kinemap_frame_sequence (\S+)", self.get("/metrics")[1], re.MULTILINE)
        return int(float(found.group(1))) + 1 if found else 0

    def pid(self, service: str) -> int | None:
        """The process of a service of this run."""
        for process in psutil.process_iter(["cmdline"]):
            line = " ".join(process.info["cmdline"] or [])
            module = "services.runtime.entry_point" if service == "bus" else f"services.{service}.service"
            if f"-m {module}" in line and str(self.out) in line:
                return int(process.pid)
        return None

    def wait_for(self, condition: Callable[[], bool], what: str) -> None:
        """Look every few milliseconds until it holds."""
        while not condition():
            assert self.process.poll() is None, f"the run ended before {what}:\n{self.output()}"
            assert time.monotonic() - self.began_s < LIMIT_S, f"no {what} within {LIMIT_S} s:\n{self.output()}"
            time.sleep(0.02)

    def finish(self) -> int:
        """The exit code."""
        return self.process.wait(timeout=LIMIT_S)

    def output(self) -> str:
        """What it printed."""
        self.log.flush()
        return Path(self.log.name).read_text(encoding="utf-8")

    def digests(self) -> dict[str, str]:
        """What must not depend on how the run went."""
        return {name: hashlib.sha256((self.out / name).read_bytes()).hexdigest() for name in RESULTS}


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Run:
    run = Run(tmp_path_factory.mktemp("undisturbed"))
    run.wait_for(lambda: run.get("/density?pose=current")[0] == 200, "answer to /density?pose=current")
    assert run.finish() == 0, run.output()
    return run


def test_a_run_leaves_what_it_promises(undisturbed: Run) -> None:
    for name in (*RESULTS, "map.sqlite", "session.mcap", "report.json", "plots/trajectory.png", "plots/map.png"):
        assert (undisturbed.out / name).stat().st_size > 0, name
    report = json.loads((undisturbed.out / "report.json").read_text())
    assert report["complete"] is True
    assert report["frames"]["in"] == SHORT_FRAMES == report["frames"]["answered"]
    assert set(report["services"]) >= {"camera", "segmenter", "motion", "tracker", "slam", "mapstore", "recorder"}
    assert all(row["peak_memory_bytes"] > 1_000_000 for row in report["services"].values())


def test_nobody_is_left_behind(undisturbed: Run) -> None:
    lines = [" ".join(process.info["cmdline"] or []) for process in psutil.process_iter(["cmdline"])]
    assert not [line for line in lines if str(undisturbed.out) in line]


def test_every_kill_is_survived_and_changes_no_byte(undisturbed: Run, tmp_path: Path) -> None:
    run = Run(tmp_path)
    for number, service in enumerate(KILLED):
        at_frame = 4 + 3 * number
        run.wait_for(lambda at_frame=at_frame: run.frames_done() >= at_frame, f"frame {at_frame}")
        before = run.pid(service)
        assert before is not None, service
        os.kill(before, signal.SIGKILL)
        killed_s = time.monotonic()
        run.wait_for(lambda before=before, service=service: run.pid(service) not in (None, before), f"new {service}")
        assert time.monotonic() - killed_s < 30.0, f"{service} came back too late even for a busy machine"
    assert run.finish() == 0, run.output()
    report = json.loads((run.out / "report.json").read_text())
    assert report["frames"]["answered"] == SHORT_FRAMES
    assert run.digests() == undisturbed.digests()
