# SPDX-License-Identifier: Apache-2.0
"""The schema of a message as MCAP wants it: everything a reader needs to decode it without our sources."""

from typing import Any

from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.message import Message


def descriptor_set(message: type[Message]) -> bytes:
    """A FileDescriptorSet with the message's file and all it imports, each once and before whoever imports it.

    Source: https://mcap.dev/spec/registry#protobuf-1
    """
    files = FileDescriptorSet()
    seen: set[str] = set()

    def add(file: Any) -> None:
        if file.name in seen:
            return
        seen.add(file.name)
        for imported in file.dependencies:
            add(imported)
        file.CopyToProto(files.file.add())

    add(message.DESCRIPTOR.file)
    return files.SerializeToString(deterministic=True)
