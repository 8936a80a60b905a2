# SPDX-License-Identifier: Apache-2.0
"""The whole pipeline in one process on the fake bus, for tests that need no processes."""

import threading
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import Any

from schemas import topics
from schemas.codec import decode
from schemas.topics import Topic
from services.camera.configured_source import open_configured_source
from services.camera.service import CameraService
from services.mapstore.service import MapstoreService
from services.motion.service import MotionService
from services.recorder.service import open_recorder
from services.runtime.config import Config, load_config
from services.runtime.fake_bus import FakeBus, FakeNetwork
from services.runtime.outbox import Outbox
from services.runtime.service import FrameService
from services.runtime.service_loop import FrameLoop
from services.segmenter.service import SegmenterService
from services.slam.service import SlamService
from services.tracker.service import TrackerService

SERVICES: dict[str, Callable[[Config], FrameService]] = {
    "segmenter": SegmenterService,
    "motion": MotionService,
    "tracker": TrackerService,
    "slam": SlamService,
    "mapstore": MapstoreService,
}
LIMIT_S = 240.0
SHORT_FRAMES = 30
SHORT_STREET: dict[str, Any] = {"seed": 3, "width": 480, "height": 144, "empty_start_m": 0.0, "crossing_people": 4}
"""A drive with moving and parked things from its first frames on."""


def run_config(out: Path, source: str = "simulator", **sections: dict[str, Any]) -> Config:
    """A run of `source` that writes to `out` and serves no HTTP; the simulator's masks are the true ones."""
    segmenter = {"backend": "truth" if source == "simulator" else "auto", **sections.pop("segmenter", {})}
    mapstore = {"serve_http": False, **sections.pop("mapstore", {})}
    camera = {"input": source, **sections.pop("camera", {})}
    run = {"out": str(out), "session": "test"}
    return load_config(None, {"run": run, "camera": camera, "mapstore": mapstore, "segmenter": segmenter, **sections})


def short_drive(out: Path, **sections: dict[str, Any]) -> Config:
    """The first SHORT_FRAMES of SHORT_STREET."""
    return run_config(out, camera={"max_frames": SHORT_FRAMES}, simulator=SHORT_STREET, **sections)


class _Host:
    """The camera's word of how far it is."""

    def __init__(self) -> None:
        self.stopping = threading.Event()
        self.state = "starting"
        self.sequence = -1


class PipelineRig:
    """Every service of a run on one FakeNetwork, each stepped in turn by one thread; the camera has its own."""

    def __init__(self, config: Config) -> None:
        self.config = config
        self._network = FakeNetwork()
        self.tap = FakeBus(self._network).subscribe(topics.TOPICS)
        self.services = {name: make(config) for name, make in SERVICES.items()}
        self.loops = {name: self._loop(name, service) for name, service in self.services.items()}
        recorder_bus = FakeBus(self._network)
        self.recorder = open_recorder(config, recorder_bus)
        recorder_bus.declare_alive("recorder")
        self._camera_host = _Host()
        self.payloads: defaultdict[Topic, dict[int, bytes]] = defaultdict(dict)

    def restart(self, name: str) -> None:
        """What a kill -9 and the supervisor do: the same service again, with nothing but what is on disk."""
        self.services[name].close()
        self.services[name] = SERVICES[name](self.config)
        self.loops[name] = self._loop(name, self.services[name])

    def run(self, after_each_round: Callable[["PipelineRig"], None] = lambda rig: None) -> None:
        """Drive the whole input through; `after_each_round` may interfere."""
        source = open_configured_source(self.config)
        camera = CameraService(source, FakeBus(self._network), self.config)
        thread = threading.Thread(target=camera.run, args=(self._camera_host,), daemon=True)
        thread.start()
        deadline = threading.Event()
        timer = threading.Timer(LIMIT_S, deadline.set)
        timer.start()
        try:
            while self._camera_host.state != "done":
                busy = [loop.step(0.001) for loop in self.loops.values()]
                busy.append(self.recorder.step(0.001))
                self._listen()
                after_each_round(self)
                # a camera that got through within this round is no longer alive either
                through = self._camera_host.state == "done"
                assert any(busy) or thread.is_alive() or through, "the camera ended before its input was through"
                assert not deadline.is_set(), f"stuck at frame {self._camera_host.sequence}"
        finally:
            timer.cancel()
            self._camera_host.stopping.set()
            thread.join()
            source.close()
            for service in self.services.values():
                service.close()
            self.recorder.close()
        self._listen()

    def records(self, topic: Topic) -> dict[int, Any]:
        """Everything heard on `topic`, decoded, by sequence number."""
        return {sequence: decode(topic, payload) for sequence, payload in sorted(self.payloads[topic].items())}

    def _loop(self, name: str, service: FrameService) -> FrameLoop:
        folder = self.config.run.out / "state" / name
        delivery = self.config.delivery
        service.keep_state_in(folder)
        outbox = Outbox(2 * delivery.window, folder if service.snapshot() is not None else None)
        bus = FakeBus(self._network)
        loop = FrameLoop(service, bus, delivery, self.config.run.session, outbox)
        bus.declare_alive(name)
        return loop

    def _listen(self) -> None:
        while (message := self.tap.receive(0.0)) is not None:
            self.payloads[message.topic].setdefault(message.envelope.sequence, message.payload)
