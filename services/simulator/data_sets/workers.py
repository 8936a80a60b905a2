# SPDX-License-Identifier: Apache-2.0
"""Renders a data set's frames in several processes, or in this one."""

from __future__ import annotations

import multiprocessing
import signal
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path

import cv2

from services.runtime.errors import KinemapError, ResourceError
from services.simulator.data_sets.frame_writer import FrameWriter
from services.simulator.data_sets.request import DataSetRequest
from services.simulator.data_sets.schedule import Chunk, Schedule
from services.simulator.drive import Drive

_EXIT_S = 5.0


@dataclass(frozen=True, slots=True)
class FrameDone:
    """A frame that is on disk."""

    sequence: str
    index: int


class ChunkRenderer:
    """Renders chunk after chunk; the world is built anew only where the sequence changes."""

    def __init__(self, root: Path, request: DataSetRequest) -> None:
        self._root, self._request = root, request
        self._sequence = ""
        self._writer: FrameWriter | None = None

    def render(self, chunk: Chunk) -> Iterator[FrameDone]:
        """Each frame, when it is on disk. Raises ResourceError where the disk does not take it."""
        if self._writer is None or self._sequence != chunk.sequence:
            self._writer = None  # one world at a time in memory
            drive = Drive(self._request.drive_of(chunk.sequence))
            self._writer = FrameWriter(self._root, chunk.sequence, drive, self._request.formats)
            self._sequence = chunk.sequence
        for index in chunk.indices:
            self._writer.write(index)
            yield FrameDone(chunk.sequence, index)


def render_frames(
    root: Path, request: DataSetRequest, left: Mapping[str, Sequence[int]], jobs: int
) -> Iterator[FrameDone]:
    """Render the frames `left` of each sequence with `jobs` processes; the bytes do not depend on how many.

    Raises:
        KinemapError: what went wrong in a process, or that one of them was killed.
    """
    schedule = Schedule(left)
    if min(jobs, sum(map(len, left.values()))) <= 1:
        renderer = ChunkRenderer(root, request)
        while (chunk := schedule.next_for(0)) is not None:
            yield from renderer.render(chunk)
        return
    # Forked processes would share Open3D's threads with this one.
    context = multiprocessing.get_context("spawn")
    workers: dict[Connection, BaseProcess] = {}
    process: BaseProcess
    try:
        for _ in range(jobs):
            here, there = context.Pipe()
            process = context.Process(target=_work, args=(there, root, request), daemon=True)
            process.start()
            there.close()
            workers[here] = process
        yield from _hand_out(schedule, workers)
    finally:
        for here, process in workers.items():
            here.close()
            process.terminate()
            process.join(_EXIT_S)


def _hand_out(schedule: Schedule, workers: Mapping[Connection, BaseProcess]) -> Iterator[FrameDone]:
    busy = {here: chunk for number, here in enumerate(workers) if (chunk := schedule.next_for(number)) is not None}
    for here, chunk in busy.items():
        here.send(chunk)
    number_of = {here: number for number, here in enumerate(workers)}
    while busy:
        ready = wait(list(busy))
        for here in [connection for connection in busy if connection in ready]:
            match _received(here, workers[here]):
                case KinemapError() as error:
                    raise error
                case FrameDone() as done:
                    yield done
                case _:
                    del busy[here]
                    following = schedule.next_for(number_of[here])
                    if following is not None:
                        busy[here] = following
                        here.send(following)


def _received(here: Connection, process: BaseProcess) -> object:
    try:
        return here.recv()
    except (EOFError, ConnectionError):
        process.join(_EXIT_S)
        if process.exitcode is not None and process.exitcode >= 0:
            raise ResourceError(f"a rendering process failed (exit code {process.exitcode}), as said above") from None
        raise ResourceError(
            f"a rendering process was killed (signal {-(process.exitcode or 0)}), perhaps for want of memory; "
            "the same command goes on, with fewer --jobs if need be"
        ) from None


def _work(there: Connection, root: Path, request: DataSetRequest) -> None:
    # Ctrl-C reaches every process of the terminal; the parent ends the others.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    cv2.setNumThreads(1)
    renderer = ChunkRenderer(root, request)
    try:
        while True:
            chunk = there.recv()
            try:
                for done in renderer.render(chunk):
                    there.send(done)
            except KinemapError as error:
                there.send(error)
            there.send(None)
    except (EOFError, ConnectionError):
        return  # the parent is gone: nobody wants any more frames
