# SPDX-License-Identifier: Apache-2.0
"""The folder of a run: chosen, made, found again."""

from datetime import datetime
from pathlib import Path

import tomli_w

from services.runtime.config import Config, dump_config
from services.runtime.errors import InputError, ResourceError

RUNS = Path("runs")
CONFIG_NAME = "config.toml"


def new_run_folder(out: Path | None, now: datetime | None = None) -> Path:
    """Where the next run writes: `out`, else runs/<YYYYmmdd-HHMMSS>. Nothing is made yet.

    Raises InputError for a folder that holds anything: no run is ever overwritten.
    """
    if out is None:
        stamp = (now or datetime.now()).strftime("%Y%m%d-%H%M%S")
        names = [RUNS / stamp, *(RUNS / f"{stamp}-{number}" for number in range(2, 100))]
        out = next(name for name in names if not name.exists())
    if out.exists() and not out.is_dir():
        raise InputError(f"--out {out}: is a file, expected a folder that does not exist or is empty")
    if out.is_dir() and any(out.iterdir()):
        raise InputError(f"--out {out}: the folder is not empty, expected one that does not exist or is empty")
    return out.resolve()


def write_config(config: Config) -> Path:
    """Make the run's folder and write the resolved configuration into it; the services read that file."""
    folder = config.run.out
    try:
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / CONFIG_NAME
        path.write_text(tomli_w.dumps(dump_config(config)), encoding="utf-8")
    except OSError as error:
        raise ResourceError(f"run folder {folder} cannot be written: {error.strerror}") from error
    return path


def newest_run_folder(given: Path | None) -> Path:
    """`given`, else the newest folder in runs/ that a run has written its configuration to.

    Raises InputError where there is none.
    """
    if given is not None:
        if not (given / CONFIG_NAME).is_file():
            raise InputError(f"{given}: no run here, expected a folder with {CONFIG_NAME}, as `kinemap run` makes it")
        return given.resolve()
    found = [path.parent for path in RUNS.glob(f"*/{CONFIG_NAME}")]
    if not found:
        raise InputError(f"no run in {Path.cwd() / RUNS}, expected the folder of one as argument")
    return max(found, key=lambda folder: ((folder / CONFIG_NAME).stat().st_mtime_ns, folder.name)).resolve()
