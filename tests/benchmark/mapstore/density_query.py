# SPDX-License-Identifier: Apache-2.0
"""How long density queries take on large maps, against a k-d tree that is built anew: `python -m ... [POINTS ...]`.

The map is a drive of 200 landmarks a keyframe and a keyframe a metre. A local map correction (20 keyframes moved) comes
before every query, as it does in a run: the index by keyframe has nothing to rebuild then, a tree over points does.
"""

import argparse
import math
import time
from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from schemas.records import MapUpdate
from services.mapstore import sim3
from services.mapstore.density import DynamicDensity
from services.mapstore.map_state import MapState
from services.mapstore.map_view import MapView
from tests.unit.mapstore.street_map import landmarks, tracked, with_keyframes

LANDMARKS_A_KEYFRAME = 200
CORRECTED_KEYFRAMES = 20
QUERIES = 50


def street(points: int) -> tuple[MapState, MapView, float]:
    """The map, and milliseconds a frame took to be applied and shown."""
    rng = np.random.default_rng(3)
    state, keyframes = MapState(), points // LANDMARKS_A_KEYFRAME
    started = time.perf_counter()
    for frame in range(keyframes):
        ids = frame * LANDMARKS_A_KEYFRAME + np.arange(LANDMARKS_A_KEYFRAME)
        position = rng.normal((0, 0, 15), (8, 3, 8), (LANDMARKS_A_KEYFRAME, 3))
        kind = rng.choice([0, 1, 2], LANDMARKS_A_KEYFRAME, p=[0.7, 0.15, 0.15])
        number = np.where(kind > 0, frame // 20 + rng.integers(1, 8, LANDMARKS_A_KEYFRAME), 0)
        state.add_frame(frame, tracked(frame, frame))
        state.apply(with_keyframes(landmarks(frame, frame, ids, position, state=kind, object_id=number), frame))
        view = state.view()
    return state, view, (time.perf_counter() - started) * 1e3 / keyframes


def rebuilt_tree_ms(view: MapView, position: np.ndarray) -> tuple[float, float]:
    """Milliseconds to place every point and build a tree, and to ask it."""
    started = time.perf_counter()
    sizes = [len(cluster) for cluster in view.clusters]
    local = np.concatenate([cluster.position for cluster in view.clusters]).astype(np.float64)
    tree = cKDTree(sim3.transform(np.repeat(view.keyframes.pose, sizes, axis=0), local), balanced_tree=False)
    built = time.perf_counter()
    tree.query_ball_point(position, 10.0, return_length=True)
    return (built - started) * 1e3, (time.perf_counter() - built) * 1e3


def measure(points: int) -> None:
    state, view, frame_ms = street(points)
    rng, density, keyframes = np.random.default_rng(4), DynamicDensity(), len(view.clusters)
    for radius, window_s in ((10.0, 30.0), (10.0, math.inf), (50.0, math.inf), (1000.0, math.inf)):
        corrections, queries = [], []
        for _ in range(QUERIES):
            first = int(rng.integers(0, keyframes - CORRECTED_KEYFRAMES))
            moved = with_keyframes(MapUpdate(0), *range(first, first + CORRECTED_KEYFRAMES))
            moved = replace(moved, keyframe_pose=np.add(moved.keyframe_pose, [0, 1e-3, 0, 0, 0, 0, 0, 0]))
            started = time.perf_counter()
            state.apply(moved)
            view = state.view()
            corrections.append(time.perf_counter() - started)
            position = np.array([rng.uniform(0, keyframes), 0.0, 0.0])
            started = time.perf_counter()
            density.at(view, position, radius, window_s)
            queries.append(time.perf_counter() - started)
        print(
            f"{points:>9} points  radius {radius:>6.0f} m  window {window_s:>4.0f} s  "
            f"query {np.median(queries) * 1e3:6.2f} ms p95 {np.percentile(queries, 95) * 1e3:6.2f}  "
            f"correction {np.median(corrections) * 1e3:5.2f} ms"
        )
    build_ms, query_ms = rebuilt_tree_ms(view, np.array([keyframes / 2, 0.0, 0.0]))
    print(f"{points:>9} points  a frame {frame_ms:.2f} ms  cKDTree: rebuild {build_ms:.0f} ms, query {query_ms:.2f} ms")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("points", nargs="*", type=int, default=[100_000, 1_000_000])
    for count in parser.parse_args().points:
        measure(count)
