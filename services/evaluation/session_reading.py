# SPDX-License-Identifier: Apache-2.0
"""From a recorded session to a SessionLog."""

from pathlib import Path

from schemas.codec import decode
from schemas.topics import BY_KEY
from services.evaluation.session_log import READ_TOPICS, SessionLog
from services.runtime.session_file import SessionFile


def read_session(path: Path, recover: bool = False) -> tuple[str, SessionLog]:
    """The session's id and its log.

    Raises InputError where the file is missing, cut off (unless `recover`), or no recorded session; ProtocolError for
    a message of another version.
    """
    log = SessionLog()
    with SessionFile(path, recover=recover) as session:
        for message in session.messages({topic.key for topic in READ_TOPICS}):
            log.add(message.sequence, decode(BY_KEY[message.key], message.payload))
        return session.session, log
