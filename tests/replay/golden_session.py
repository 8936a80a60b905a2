# SPDX-License-Identifier: Apache-2.0
"""The golden session: what every service once gave for a short drive, kept beside this file.

The camera's images are left out (the simulator makes them again); everything the services gave is in it. Write it anew
only when a change of results is meant, and look at what changed:

    python -m tests.replay.golden_session
"""

import tempfile
from pathlib import Path

from schemas import topics
from services.camera.configured_source import open_configured_source
from services.camera.frame_records import frame_records
from services.recorder.session_writer import SessionWriter
from services.runtime.config import Config
from services.runtime.session_file import SessionFile
from tests.pipeline_rig import SHORT_FRAMES, PipelineRig, short_drive

GOLDEN = Path(__file__).with_name("golden.mcap")
SESSION = "golden"
GIVEN_BY_SERVICES = (
    *(topic for topic in topics.TOPICS if topic.per_frame and topic.producer != "camera"),
    topics.END,
)


def camera_records(config: Config) -> dict[int, list[tuple[topics.Topic, object]]]:
    """What the camera says about each frame, made again."""
    source = open_configured_source(config)
    frames = {}
    for sequence in range(SHORT_FRAMES):
        frame = source.frame(sequence)
        assert frame is not None
        frames[sequence] = list(frame_records(frame, source))
    source.close()
    return frames


def write_golden_session(path: Path) -> None:
    """Drive once and keep what the services gave."""
    with tempfile.TemporaryDirectory() as folder:
        config = short_drive(Path(folder))
        PipelineRig(config).run()
        keys = {topic.key for topic in GIVEN_BY_SERVICES}
        path.unlink(missing_ok=True)
        writer = SessionWriter(path, SESSION)
        with SessionFile(Path(folder) / config.recorder.file) as session:
            writer.append([message for message in session.messages() if message.key in keys])
        writer.finish()
        writer.close()


if __name__ == "__main__":
    write_golden_session(GOLDEN)
