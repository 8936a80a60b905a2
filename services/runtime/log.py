# SPDX-License-Identifier: Apache-2.0
"""Logs: one line an event, the event's name first, then what belongs to it."""

import json
import logging
import sys
import time
from typing import Any

from services.runtime.config.log import LogConfig


class _LineFormatter(logging.Formatter):
    """`2026-11-22T15:00:00.123Z info motion frame_dropped sequence=3 reason=...`"""

    def format(self, record: logging.LogRecord) -> str:
        fields: dict[str, Any] = getattr(record, "fields", {})
        stamp = time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(record.created)) + f".{int(record.msecs):03d}Z"
        text = " ".join(f"{key}={self._quoted(value)}" for key, value in fields.items())
        line = f"{stamp} {record.levelname.lower()} {record.name} {record.getMessage()} {text}".rstrip()
        return f"{line}\n{self.formatException(record.exc_info)}" if record.exc_info else line

    @staticmethod
    def _quoted(value: Any) -> str:
        text = str(value)
        return json.dumps(text, ensure_ascii=False) if not text or any(c in text for c in ' "=\n') else text


class _JsonFormatter(logging.Formatter):
    """The same as one JSON object a line."""

    def format(self, record: logging.LogRecord) -> str:
        entry: dict[str, Any] = {
            "time": record.created,
            "level": record.levelname.lower(),
            "service": record.name,
            "event": record.getMessage(),
            **getattr(record, "fields", {}),
        }
        if record.exc_info:
            entry["exception"] = self.formatException(record.exc_info)
        return json.dumps(entry, default=str, ensure_ascii=False)


class EventLogger:
    """`log.info("frame_dropped", sequence=3, reason="capacity")`"""

    def __init__(self, name: str) -> None:
        self._logger = logging.getLogger(name)
        self._last_said: dict[str, float] = {}

    def debug(self, event: str, **fields: Any) -> None:
        """For who looks for a fault."""
        self._logger.debug(event, extra={"fields": fields})

    def info(self, event: str, **fields: Any) -> None:
        """The ordinary course."""
        self._logger.info(event, extra={"fields": fields})

    def warning(self, event: str, **fields: Any) -> None:
        """Something was lost or late, and it goes on."""
        self._logger.warning(event, extra={"fields": fields})

    def warning_limited(self, event: str, **fields: Any) -> None:
        """Like warning, the same event once a second at most: bad input must not fill the disk."""
        now = time.monotonic()
        if now - self._last_said.get(event, -1.0) >= 1.0:
            self._last_said[event] = now
            self.warning(event, **fields)

    def error(self, event: str, **fields: Any) -> None:
        """Something ends here."""
        self._logger.error(event, extra={"fields": fields})

    def exception(self, event: str, **fields: Any) -> None:
        """An error nobody expected, with its traceback."""
        self._logger.exception(event, extra={"fields": fields})


def set_up_logging(config: LogConfig) -> None:
    """Send every log line to standard error in the configured form."""
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(_JsonFormatter() if config.json_lines else _LineFormatter())
    root = logging.getLogger()
    root.handlers[:] = [handler]
    root.setLevel(config.level.upper())


def get_logger(name: str) -> EventLogger:
    """The logger of a service."""
    return EventLogger(name)
