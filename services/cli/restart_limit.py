# SPDX-License-Identifier: Apache-2.0
"""Becomes a service that has not died too often: `python -m services.cli.restart_limit NAME MODULE --config FILE`.

supervisord restarts what dies for ever, once a second. This stands between the two: it notes the start beside the
run's logs, and after too many in a short time it ends with exit code 2 instead, which is not restarted.
"""

import os
import sys
import time
from pathlib import Path

DEATHS = 5
SPAN_S = 60.0
_GIVEN_UP = 2


def exceeded(starts: Path, now_s: float) -> bool:
    """Note a start at `now_s` (seconds since 1970) in the file `starts`; whether those before it were too many."""
    noted = [float(word) for word in starts.read_text(encoding="utf-8").split()] if starts.exists() else []
    recent = [start_s for start_s in noted if 0 <= now_s - start_s < SPAN_S]
    starts.write_text("".join(f"{start_s:.3f}\n" for start_s in [*recent, now_s]), encoding="utf-8")
    return len(recent) >= DEATHS


def main() -> None:
    """Run the service in this process, or say why not."""
    name, module, *arguments = sys.argv[1:]
    folder = Path(arguments[-1]).parent
    if exceeded(folder / "logs" / f"{name}.starts", time.time()):
        log = folder / "logs" / f"{name}.log"
        lines = log.read_text(encoding="utf-8", errors="replace").strip().splitlines() if log.exists() else []
        why = f"died {DEATHS} times in {SPAN_S:.0f} s, at last with: {lines[-1] if lines else 'nothing said'}"
        (folder / f"{name}.error").write_text(f"{why}\n", encoding="utf-8")
        print(f"kinemap {name}: error: {why}", file=sys.stderr)
        sys.exit(_GIVEN_UP)
    os.execv(sys.executable, [sys.executable, "-m", module, *arguments])


if __name__ == "__main__":
    main()
