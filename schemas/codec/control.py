# SPDX-License-Identifier: Apache-2.0
"""Answers and heartbeats."""

from schemas.proto.kinemap import control_pb2
from schemas.records.control import FrameAnswer, Heartbeat


def answer_to_message(record: FrameAnswer) -> control_pb2.FrameAnswer:
    return control_pb2.FrameAnswer(timestamp_ns=record.timestamp_ns, service=record.service)


def answer_to_record(message: control_pb2.FrameAnswer) -> FrameAnswer:
    return FrameAnswer(message.timestamp_ns, message.service)


def heartbeat_to_message(record: Heartbeat) -> control_pb2.Heartbeat:
    return control_pb2.Heartbeat(
        service=record.service,
        pid=record.pid,
        state=record.state,
        sequence=record.sequence,
        peak_memory_bytes=record.peak_memory_bytes,
        metrics=[control_pb2.Metric(name=name, value=value) for name, value in record.metrics.items()],
    )


def heartbeat_to_record(message: control_pb2.Heartbeat) -> Heartbeat:
    return Heartbeat(
        message.service,
        message.pid,
        message.state,
        message.sequence,
        message.peak_memory_bytes,
        {metric.name: metric.value for metric in message.metrics},
    )
