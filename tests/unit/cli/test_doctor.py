# SPDX-License-Identifier: Apache-2.0
import importlib.metadata
import shutil
import socket
import sys
from pathlib import Path

import pytest

from services.cli import doctor_checks, doctor_packages
from services.cli.doctor_checks import (
    check_disk,
    check_gpu,
    check_import,
    check_memory,
    check_port,
    check_python,
    check_segmenter,
    check_segmenter_ways,
)
from services.cli.doctor_packages import check_debian_packages, check_python_packages
from services.runtime.config import Config
from services.segmenter.measured_ways import ChosenWay, MeasuredWay, model_key, remember
from services.segmenter.weights import choice


def test_this_machine_can_run_python_and_has_what_is_installed() -> None:
    assert check_python().ok
    assert check_memory().found.startswith(f"{doctor_checks.psutil.cpu_count()} cores")
    assert check_gpu().ok is None


def test_a_module_that_does_not_import_is_named_with_its_reason() -> None:
    assert check_import("x", "json", "").ok
    check = check_import("engine", "no_such_module_here", "make setup")
    assert check.ok is False
    assert "No module named 'no_such_module_here'" in check.found
    assert check.remedy == "make setup"


def test_a_port_in_use_is_missing() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        assert check_port("HTTP port", "127.0.0.1", taken.getsockname()[1], "x").ok is False


def test_a_full_disk_is_missing_room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert check_disk(tmp_path / "not" / "made" / "yet").found.endswith(f"free in {tmp_path}")
    monkeypatch.setattr(shutil, "disk_usage", lambda _: shutil._ntuple_diskusage(10**12, 10**12, 10**9))
    assert check_disk(tmp_path).ok is False


@pytest.mark.skipif(shutil.which("dpkg-query") is None, reason="this machine has no dpkg")
def test_debian_packages_are_those_of_the_set_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    listed = tmp_path / "packages.txt"
    listed.write_text("# what it takes\ndpkg   # always there\nno-such-package-at-all\n")
    monkeypatch.setattr(doctor_packages, "_DEBIAN_PACKAGES", listed)
    checks = {check.name: check for check in check_debian_packages()}
    assert checks["Debian dpkg"].ok
    assert checks["Debian no-such-package-at-all"].ok is False
    assert checks["Debian no-such-package-at-all"].remedy == "sudo apt-get install no-such-package-at-all"


def test_the_set_up_has_its_list_where_the_doctor_looks() -> None:
    assert doctor_packages._DEBIAN_PACKAGES.is_file()


def test_python_packages_that_are_missing_or_too_old_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    declared = [
        'numpy>=1 ; extra == "slam"',
        "no-such-package>=3",
        "pytest>=9999",
        'not-wanted ; extra == "dev"',
        'no-need ; extra == "cpu"',
    ]
    monkeypatch.setattr(importlib.metadata, "requires", lambda _: declared)
    checks = {check.name: check for check in check_python_packages()}
    assert checks["Python no-such-package"].remedy == "pip install 'no-such-package>=3'"
    assert "expected >=9999" in checks["Python pytest"].found
    assert "Python not-wanted" not in checks
    assert "Python no-need" not in checks
    assert "Python numpy" not in checks


def test_a_kinemap_that_is_not_installed_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(name: str) -> list[str]:
        raise importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(importlib.metadata, "requires", refuse)
    assert [check.ok for check in check_python_packages()] == [False]


def test_an_old_python_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "version_info", (3, 10, 4, "final", 0))
    assert check_python().ok is False


def test_the_network_that_runs_is_named_with_its_reason(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(choice, "SHIPPED_WEIGHTS", tmp_path / "none")
    config = Config()
    assert check_segmenter(config).ok is None
    assert "kinemap weights pull solov2-light_r18" in check_segmenter(config).found
    config.segmenter.backend = "solov2"
    assert check_segmenter(config).ok is False
    model = tmp_path / "kinemap" / "weights" / "solov2-light_r18_fpn_ms-3x_coco.safetensors"
    model.parent.mkdir(parents=True)
    model.touch()
    assert check_segmenter(config).found == f"{model} (a public model in the cache)"
    config.segmenter.weights = "solov2_r50"
    missing = check_segmenter(config)
    assert missing.ok is False
    assert "`kinemap weights pull solov2_r50_fpn_ms-3x_coco` gets them" in missing.found
    config.segmenter.backend, config.segmenter.weights = "masks", None
    assert "not used: segmenter.backend is masks" in check_segmenter(config).found


def test_in_what_the_network_runs_is_told_with_what_was_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    config = Config()
    model = tmp_path / "mine.safetensors"
    config.segmenter.weights = str(model)
    assert check_segmenter_ways(config).found.startswith("no network to run")
    model.write_bytes(b"weights")
    assert check_segmenter_ways(config).found.startswith("not measured yet")
    measured = {
        "torch fp32": MeasuredWay(400.0, 1.0),
        "torch bf16": MeasuredWay(300.0, 0.97),
        "openvino fp32": MeasuredWay(200.0, 0.9999),
    }
    remember(f"{model_key(model)}R18 852x448", ChosenWay("openvino fp32", measured))
    remember("0123456789ab R18 852x448", ChosenWay("torch fp32", {}))
    assert check_segmenter_ways(config).found.startswith(
        "openvino fp32, of torch fp32 400 ms, torch bf16 300 ms (left out: finds other masks, IoU 0.970), "
        "openvino fp32 200 ms (R18 852x448)"
    )
