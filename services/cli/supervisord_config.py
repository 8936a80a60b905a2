# SPDX-License-Identifier: Apache-2.0
"""supervisord's configuration, made from the table of processes: `python -m services.cli.supervisord_config`.

The text depends on nothing but the table; where a run lives comes to it through the environment (`run_environment`).
deploy/supervisord.conf is this text, for who starts supervisord by hand.
"""

import shlex
import sys
from collections.abc import Iterable
from pathlib import Path

from services.runtime.process_table import PROCESSES, ServiceProcess, environment_of

_HEAD = """\
; Made by `python -m services.cli.supervisord_config` from services/runtime/process_table.py.
; `kinemap up` uses the same text. By hand, with absolute paths (export all five):
;   KINEMAP_PYTHON=/opt/kinemap/.venv/bin/python KINEMAP_RUN_CONFIG=/etc/kinemap/kinemap.toml
;   KINEMAP_RUN_FOLDER=/run/kinemap KINEMAP_LOG_FOLDER=/run/kinemap/logs KINEMAP_SOCKET=/run/kinemap/supervisor.sock
;   /opt/kinemap/.venv/bin/supervisord -c deploy/supervisord.conf

[supervisord]
nodaemon=true
silent=true
logfile=%(ENV_KINEMAP_RUN_FOLDER)s/logs/supervisord.log
logfile_maxbytes=10MB
logfile_backups=1
pidfile=%(ENV_KINEMAP_RUN_FOLDER)s/supervisord.pid
strip_ansi=true

[unix_http_server]
file=%(ENV_KINEMAP_SOCKET)s
chmod=0700

[rpcinterface:supervisor]
supervisor.rpcinterface_factory=supervisor.rpcinterface:make_main_rpcinterface

[supervisorctl]
serverurl=unix://%(ENV_KINEMAP_SOCKET)s
"""

# startsecs=0: an exit is judged by its code alone, however early it comes. 2 is bad input, which no restart mends.
_PROGRAM = """\

[program:{name}]
command=%(ENV_KINEMAP_PYTHON)s -m services.cli.restart_limit {name} {module} --config %(ENV_KINEMAP_RUN_CONFIG)s
priority={priority}
environment={environment}
autostart=true
autorestart=unexpected
exitcodes=0,2
startsecs=0
stopsignal=TERM
stopwaitsecs={stop_wait_s}
stopasgroup=false
killasgroup=true
redirect_stderr=true
stdout_logfile=%(ENV_KINEMAP_LOG_FOLDER)s/{name}.log
stdout_logfile_maxbytes=10MB
stdout_logfile_backups=2
"""


def supervisord_config(processes: Iterable[ServiceProcess] = PROCESSES) -> str:
    """The whole file, the same every time."""
    return _HEAD + "".join(_program(process) for process in processes)


def run_environment(config: Path, folder: Path, socket: Path) -> dict[str, str]:
    """The variables that the file asks for."""
    return {
        "KINEMAP_PYTHON": shlex.quote(sys.executable),
        "KINEMAP_RUN_CONFIG": shlex.quote(str(config)),
        "KINEMAP_RUN_FOLDER": str(folder),
        # supervisord expands a log file's name twice.
        "KINEMAP_LOG_FOLDER": str(folder / "logs").replace("%", "%%"),
        "KINEMAP_SOCKET": str(socket),
    }


def _program(process: ServiceProcess) -> str:
    environment = ",".join(f'{name}="{value}"' for name, value in environment_of(process).items())
    return _PROGRAM.format(
        name=process.name,
        module=process.module,
        priority=process.priority,
        environment=environment,
        stop_wait_s=process.stop_wait_s,
    )


if __name__ == "__main__":
    sys.stdout.write(supervisord_config())
