# SPDX-License-Identifier: Apache-2.0
"""The mapstore's process: `python -m services.mapstore.service --config FILE`."""

import numpy as np

from schemas import topics
from schemas.records import Density, MapUpdate, MotionState, TrackedFrame
from services.mapstore.base_pose import BasePose
from services.mapstore.density import DynamicDensity
from services.mapstore.gateway.live_map import LiveMap
from services.mapstore.gateway.server import Gateway
from services.mapstore.map_view import NOT_YET, MapView
from services.mapstore.store import MapStore
from services.runtime.config import Config
from services.runtime.errors import ResourceError
from services.runtime.host import run_service
from services.runtime.log import get_logger
from services.runtime.outbox import State
from services.runtime.service import Bundle, FrameService, Outgoing

NAME = "mapstore"


class MapstoreService(FrameService):
    """Makes each frame's map update durable, then visible, and says how much moves around the current pose."""

    name = NAME
    awaits = (topics.TRACKED_FRAME, topics.MAP_UPDATE, topics.MAPPED_OBJECTS)
    final_awaits = (topics.MAP_UPDATE,)
    answers = True

    def __init__(self, config: Config) -> None:
        """Opens the map and the gateway. Raises InputError or ResourceError when one of them cannot be had."""
        options = config.mapstore
        self._session = config.run.session
        self._radius, self._window_s = options.density_radius, options.density_window_s
        self._log = get_logger(NAME)
        self._base = BasePose(np.array(options.base_from_camera))
        self._density = DynamicDensity(options.high_density_points)
        self._store = MapStore(options.database or config.run.out / "map.sqlite", self._session)
        try:
            self._map = self._store.load()
            self._live = LiveMap(self._map.view(), self._density, self._base)
            self._gateway = Gateway(options, self._live) if options.serve_http else None
        except BaseException:
            self._store.close()
            raise
        self._log.info("map_opened", file=self._store.path, sequence=self._store.last_sequence)
        if self._gateway is not None:
            self._log.info("gateway_listens", url=self._gateway.url)

    def process(self, bundle: Bundle) -> list[Outgoing]:
        """One frame: into the map, into the file, then to whoever asks."""
        sequence = bundle.envelope.sequence
        if sequence <= self._store.last_sequence:
            self._log.warning_limited("frame_is_in_the_map", sequence=sequence, last=self._store.last_sequence)
            answered = self._store.density_of(sequence)
            return [] if answered is None else [Outgoing(topics.DENSITY, answered)]
        frame: TrackedFrame = bundle[topics.TRACKED_FRAME]
        update: MapUpdate = bundle[topics.MAP_UPDATE]
        self._map.add_frame(sequence, frame)
        self._map.see_objects(bundle[topics.MAPPED_OBJECTS])
        self._apply(update)
        view = self._map.view()
        density = self._density_now(view)
        self._store.put(sequence, frame, update, density)
        self._live.show(view)
        return [Outgoing(topics.DENSITY, density)]

    def finish(self, bundle: Bundle) -> list[Outgoing]:
        """The input is over: takes what slam changed last, and leaves the whole map in one file."""
        sequence = bundle.envelope.sequence
        update: MapUpdate = bundle[topics.MAP_UPDATE]
        self._apply(update)
        self._map.finish(sequence)
        self._store.put_last_update(sequence, update)
        self._store.checkpoint()
        self._live.show(self._map.view())
        return []

    def last_sequence(self) -> int:
        """The last frame that was surely answered: a kill may come when the file has a frame and nobody knows yet."""
        return max(NOT_YET, self._store.last_sequence - 1)

    def snapshot(self) -> State:
        """The map itself is in the file; this lets the loop keep what was sent for the last frames beside it."""
        return {"sequence": np.array(self._store.last_sequence, dtype=np.int64)}

    def restore(self, state: State) -> None:
        """Raises ResourceError when the file is behind what was answered from it."""
        answered = int(state["sequence"])
        if answered > self._store.last_sequence:
            raise ResourceError(
                f"{self._store.path}: ends at frame {self._store.last_sequence}, expected frame {answered}, which was "
                "answered; the map was replaced or removed during the run"
            )

    def metrics(self) -> dict[str, float]:
        """The size of the map, by label."""
        view = self._live.view
        counts = {f"landmarks_{state.name.lower()}": float(view.counts_by_state()[state]) for state in MotionState}
        return {
            **counts,
            "dense_points": float(view.dense_points),
            "keyframes": float(np.count_nonzero(view.keyframes.culled == 0)),
        }

    def close(self) -> None:
        """Stop answering HTTP, let go of the file."""
        if self._gateway is not None:
            self._gateway.close()
        self._store.close()

    def _apply(self, update: MapUpdate) -> None:
        unknown = self._map.apply(update)
        if unknown:
            self._log.warning_limited("poses_of_unknown_frames", frames=unknown)

    def _density_now(self, view: MapView) -> Density:
        base = self._base.in_map(view)
        if base is None:
            return self._density.nowhere(view, self._radius, self._window_s)
        return self._density.at(view, base[:3], self._radius, self._window_s)


def main() -> None:
    """Entry point of the process."""
    run_service(MapstoreService, NAME)


if __name__ == "__main__":
    main()
