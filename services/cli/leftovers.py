# SPDX-License-Identifier: Apache-2.0
"""Processes of a run that outlived who started them."""

from collections.abc import Collection
from pathlib import Path

import psutil


def processes_of(modules: Collection[str], config: Path, supervisord_config: Path) -> list[psutil.Process]:
    """The services (`modules`) that run with `config`, and the supervisord that runs with `supervisord_config`.

    Told by their whole command line: a pid that was noted down may belong to somebody else by now.
    """
    found = []
    for process in psutil.process_iter():
        try:
            words = process.cmdline()
        except (psutil.NoSuchProcess, psutil.AccessDenied, psutil.ZombieProcess):
            continue
        is_service = words[1:2] == ["-m"] and bool(words[2:3]) and words[2] in modules and str(config) in words[3:]
        is_supervisord = "services.cli.supervisord_process" in words[1:3] and str(supervisord_config) in words
        if is_service or is_supervisord:
            found.append(process)
    return found


def end(processes: list[psutil.Process], patience_s: float) -> None:
    """Ask them to end, and kill who has not ended after `patience_s`. Returns when none is left."""
    for process in processes:
        _signal(process, kill=False)
    _, alive = psutil.wait_procs(processes, timeout=patience_s)
    for process in alive:
        _signal(process, kill=True)
    psutil.wait_procs(alive, timeout=patience_s)


def _signal(process: psutil.Process, *, kill: bool) -> None:
    try:
        process.kill() if kill else process.terminate()
    except psutil.NoSuchProcess:
        return
