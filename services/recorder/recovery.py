# SPDX-License-Identifier: Apache-2.0
"""A whole session of one that was cut off or damaged: `python -m services.recorder.recovery FILE OUT`."""

import argparse
import json
import sys
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

from services.recorder.session_writer import SessionWriter
from services.runtime.errors import InputError, KinemapError
from services.runtime.session_file import SessionFile


class Recovery(NamedTuple):
    """What came of it."""

    messages: int
    damaged_chunks: int
    """chunks that could not be read and are left out"""
    why: str
    """what was wrong with the file; empty where nothing was"""


def recover_session(path: Path, out: Path) -> Recovery:
    """Write every whole message of the session `path` to the new file `out`, which gets an index.

    Raises:
        InputError: `path` is no session, or `out` exists.
        ResourceError: `out` cannot be written.
    """
    if out.exists():
        raise InputError(f"{out}: exists; expected the name of a new file")
    with SessionFile(path, recover=True) as file:
        writer = SessionWriter(out, file.session, json.dumps(file.config, sort_keys=True))
        try:
            for _, frame in groupby(file.messages(), key=lambda message: message.sequence):
                writer.append(list(frame))
            writer.finish()
        finally:
            writer.close()
        return Recovery(writer.message_count, file.damaged_chunks, file.recovered)


def main() -> None:
    """Recover one file, and say in one line what came of it."""
    parser = argparse.ArgumentParser(description="Make a whole session of one that was cut off or damaged.")
    parser.add_argument("file", type=Path)
    parser.add_argument("out", type=Path)
    arguments = parser.parse_args()
    try:
        done = recover_session(arguments.file, arguments.out)
    except KinemapError as error:
        print(f"recovery: error: {error}", file=sys.stderr)
        sys.exit(error.exit_code)
    why = done.why or "the file was whole"
    print(f"{arguments.out}: {done.messages} messages, {done.damaged_chunks} damaged chunks left out ({why})")


if __name__ == "__main__":
    main()
