# SPDX-License-Identifier: Apache-2.0
"""What kinemap needs of a machine, one check each."""

import ctypes.util
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import psutil

from services.cli.doctor_packages import Check, check_debian_packages, check_python_packages
from services.cli.ports import is_free
from services.runtime.config import Config
from services.runtime.errors import InputError

_LEAST_DISK_GB = 5.0
_LEAST_MEMORY_GB = 4.0
_IMPORT_TIMEOUT_S = 60
_GIGABYTE = 1e9


def all_checks(config: Config, folder: Path) -> Iterator[Check]:
    """Every check, the cheap ones first."""
    yield check_python()
    yield from check_debian_packages()
    yield from check_python_packages()
    yield check_import("SLAM engine", "services.slam._engine", "make setup")
    yield check_open3d()
    yield check_port(
        "HTTP port", config.mapstore.http_host, config.mapstore.http_port, "--port N, or stop the program that has it"
    )
    yield check_disk(folder)
    yield check_memory()
    yield check_gpu()
    yield check_segmenter(config)
    yield check_segmenter_ways(config)


def check_python() -> Check:
    """3.11 or later."""
    version = ".".join(map(str, sys.version_info[:3]))
    return Check("Python", sys.version_info >= (3, 11), version, "sudo apt-get install python3 (Debian 12 or later)")


def check_import(name: str, module: str, remedy: str) -> Check:
    """Import `module` in a process of its own, so that what crashes there does not crash here."""
    command = [sys.executable, "-c", f"import {module} as m; print(getattr(m, '__version__', 'imports'))"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=_IMPORT_TIMEOUT_S, check=False)
    except subprocess.TimeoutExpired:
        return Check(name, False, f"import of {module} takes more than {_IMPORT_TIMEOUT_S} s", remedy)
    if done.returncode == 0:
        return Check(name, True, done.stdout.strip())
    last = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
    return Check(name, False, last, remedy)


def check_open3d() -> Check:
    """The simulator's renderer; it needs Debian's libusb."""
    if ctypes.util.find_library("usb-1.0") is None:
        return Check("Open3D", False, "libusb-1.0 is not there", "sudo apt-get install libusb-1.0-0")
    return check_import("Open3D", "open3d", "pip install open3d (the simulator alone needs it)")


def check_port(name: str, host: str, port: int, remedy: str) -> Check:
    """Whether a run could listen there."""
    free = is_free(host, port)
    return Check(name, free, f"{host}:{port} is {'free' if free else 'in use'}", remedy)


def check_disk(folder: Path) -> Check:
    """Room for a few runs: 300 KITTI frames record about a quarter of a gigabyte."""
    existing = next(path for path in (folder.resolve(), *folder.resolve().parents) if path.exists())
    free_gb = shutil.disk_usage(existing).free / _GIGABYTE
    return Check(
        "disk", free_gb >= _LEAST_DISK_GB, f"{free_gb:.1f} GB free in {existing}", f"free {_LEAST_DISK_GB:g} GB"
    )


def check_memory() -> Check:
    """Cores and memory; the default run fits two cores and 4 GB."""
    memory_gb = psutil.virtual_memory().total / _GIGABYTE
    found = f"{psutil.cpu_count()} cores, {memory_gb:.1f} GB memory"
    return Check("machine", memory_gb >= _LEAST_MEMORY_GB, found, f"at least {_LEAST_MEMORY_GB:g} GB of memory")


def check_gpu() -> Check:
    """Said for information: everything runs without one."""
    if shutil.which("nvidia-smi") is None:
        return Check("GPU", None, "none found; everything runs on the CPU")
    command = ["nvidia-smi", "--query-gpu=name,memory.total", "--format=csv,noheader"]
    asked = subprocess.run(command, capture_output=True, text=True, check=False)
    return Check("GPU", None, asked.stdout.strip().replace("\n", "; ") or "nvidia-smi answers nothing")


def check_segmenter(config: Config) -> Check:
    """Which network would find instances, and why it; without one, `auto` takes what the input itself has."""
    from services.segmenter.weights.choice import choose_model

    settings = config.segmenter
    name = "segmenter's network"
    try:
        choice = choose_model(settings.weights)
    except InputError as error:
        needed = settings.backend == "solov2" or settings.weights is not None
        return Check(name, False if needed else None, str(error), "kinemap weights pull NAME")
    if settings.backend in ("auto", "solov2"):
        return Check(name, None, f"{choice.path} ({choice.why})")
    return Check(name, None, f"not used: segmenter.backend is {settings.backend}; there is {choice.path}")


def check_segmenter_ways(config: Config) -> Check:
    """In what the network runs here, by what was measured when it first did."""
    from services.segmenter.measured_ways import model_key, remembered_of
    from services.segmenter.runtimes.way import installed
    from services.segmenter.weights.choice import choose_model

    name = "segmenter's runtime"
    try:
        known = remembered_of(model_key(choose_model(config.segmenter.weights).path))
    except InputError as error:
        return Check(name, None, f"no network to run ({error})")
    found = "; ".join(f"{choice} ({key})" for key, choice in known.items())
    faster = "" if any(installed()) else ". `pip install onnx openvino onnxruntime`: faster than torch on a CPU"
    return Check(name, None, f"{found or 'not measured yet: its first run here does that'}{faster}")
