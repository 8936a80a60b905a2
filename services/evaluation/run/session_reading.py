# SPDX-License-Identifier: Apache-2.0
"""From a recorded session to a SessionLog."""

from pathlib import Path

from schemas import topics
from schemas.codec import decode
from schemas.topics import BY_KEY
from services.evaluation.run.session_log import READ_TOPICS, SessionLog
from services.runtime.session_file import SessionFile


def read_session(path: Path, recover: bool = False) -> tuple[str, SessionLog]:
    """The session's id and its log.

    Raises InputError where the file is missing, cut off (unless `recover`), or no recorded session; ProtocolError for
    a message of another version.
    """
    log = SessionLog()
    with SessionFile(path, recover=recover) as session:
        keys = {topic.key for topic in READ_TOPICS}
        if not recover and topics.TRUE_INSTANCES.key not in session.message_counts():
            # Objects are read for the moving flag alone, and there is no truth to hold them against.
            keys.discard(topics.OBJECTS.key)
        for message in session.messages(keys):
            log.add(message.sequence, decode(BY_KEY[message.key], message.payload))
        return session.session, log
