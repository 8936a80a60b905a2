# SPDX-License-Identifier: Apache-2.0
"""Passes of the engine described by values, run in processes of their own, and the figures of each."""

import hashlib
import resource
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from multiprocessing import get_context

import cv2
import numpy as np
import numpy.typing as npt

from services.evaluation.trajectory.alignment import MINIMUM_POSES, Alignment, align
from services.slam import _engine
from services.slam.vocabulary import SHIPPED_VOCABULARY
from tests.benchmark.slam.engine_run import EngineRun, run_parts
from tests.benchmark.slam.sequence_part import SequencePart

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class EnginePass:
    """One input and the options it is run with; `options` by their names in EngineOptions."""

    parts: tuple[SequencePart, ...]
    stage: str = "moving"
    options: dict[str, float | str] = field(default_factory=dict)
    name: str = ""

    def engine_options(self) -> _engine.EngineOptions:
        """AttributeError for a name that EngineOptions does not have."""
        options = _engine.EngineOptions()
        options.stage = getattr(_engine.Stage, self.stage)
        options.vocabulary_path = str(SHIPPED_VOCABULARY)
        for name, value in self.options.items():
            setattr(options, name, type(getattr(options, name))(value))
        return options


@dataclass(frozen=True)
class PassReport:
    """What came of a pass. Errors are root mean squares over the frames of the map that holds most of them.

    `scale` is true metres in a map unit by the least squares of all centres (Umeyama 1991). `coverage` counts frames
    of that map over all frames; `online_ate_m` is of the poses as they were told, Sim(3) aligned. NaN without a map.
    """

    name: str
    frames: int
    initialized_at: int
    coverage: float
    tracked_share: float
    ate_m: float
    ate_se3_m: float
    online_ate_m: float
    scale: float
    maps: int
    keyframes: int
    culled: int
    landmarks: dict[int, int]
    wall_ms: Array
    cpu_ms: Array
    read_ms: Array
    rss_mb: Array
    sizes: npt.NDArray[np.int64]
    """(frames, 2): live keyframes, landmarks after each frame"""
    stage_ms: dict[str, float]
    states: npt.NDArray[np.int64]
    reasons: list[str]
    digest: str
    peak_rss_mb: float
    part_starts: list[int]
    """index of each part's first frame"""
    indices: list[int]
    centers: Array
    """(N, 3), aligned with the truth"""
    true_centers: Array
    """(frames, 3), m"""
    metric: bool = False
    """whether the engine held its lengths for metres at the last frame"""
    loops_closed: int = 0
    """frames at which a loop's correction was merged; one that only the end of the pass merges is not among them"""
    maps_joined: int = 0
    """frames at which another map was joined with the current one"""

    def ms(self, percent: float) -> float:
        """Percentile of the wall-clock time of a frame."""
        return float(np.percentile(self.wall_ms, percent))


def errors_m(centers: Array, truth: Array, alignment: Alignment) -> tuple[float, float, Array]:
    """Root mean square error after the best alignment, its scale, and the aligned centres; NaN for too few."""
    if len(centers) < MINIMUM_POSES:
        return np.nan, np.nan, centers
    similarity = align(centers, truth, alignment)
    aligned = similarity.points(centers)
    return float(np.sqrt(((aligned - truth) ** 2).sum(axis=1).mean())), similarity.scale, aligned


def report(run: EngineRun, parts: Sequence[SequencePart], name: str = "") -> PassReport:
    """The figures of a run over these parts."""
    part_poses = [part.true_poses() for part in parts]
    truth = np.concatenate(part_poses)[:, :3, 3]
    indices, centers = run.centers()
    told, told_centers = run.online_centers()
    ate_m, scale, aligned = errors_m(centers, truth[indices], Alignment.SIM3)
    stages = [result.stage_ms for result in run.results]
    return PassReport(
        name=name,
        frames=len(run.results),
        initialized_at=run.initialized_at(),
        coverage=len(indices) / len(run.results),
        tracked_share=run.tracked_share(),
        ate_m=ate_m,
        ate_se3_m=errors_m(centers, truth[indices], Alignment.SE3)[0],
        online_ate_m=errors_m(told_centers, truth[told], Alignment.SIM3)[0],
        scale=scale,
        metric=run.results[-1].metric_scale,
        loops_closed=sum(result.loop_closed for result in run.results),
        maps_joined=sum(result.maps_merged for result in run.results),
        maps=len(set(run.map_of_keyframe.values())),
        keyframes=len(run.keyframes),
        culled=len(run.culled),
        landmarks=dict(sorted(Counter(run.landmarks.values()).items())),
        wall_ms=np.array(run.wall_ms),
        cpu_ms=np.array(run.cpu_ms),
        read_ms=np.array(run.read_ms),
        rss_mb=np.array(run.rss_mb),
        sizes=np.array(run.sizes),
        stage_ms={stage: round(float(np.mean([row[stage] for row in stages])), 1) for stage in stages[0]},
        states=np.array([result.state for result in run.results]),
        reasons=[result.reason for result in run.results],
        digest=hashlib.sha256(run.digest.digest()).hexdigest()[:16],
        peak_rss_mb=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        part_starts=np.cumsum([0, *(len(poses) for poses in part_poses)])[:-1].tolist(),
        indices=indices,
        centers=aligned,
        true_centers=truth,
    )


def run_pass(given: EnginePass) -> PassReport:
    """Run it in this process."""
    cv2.setNumThreads(1)
    return report(run_parts(given.parts, given.engine_options()), given.parts, given.name)


def run_passes(given: Sequence[EnginePass], jobs: int = 1) -> Iterator[PassReport]:
    """Run each in a process of its own, so that its peak of memory is its own; `jobs` at a time, in order."""
    with ProcessPoolExecutor(jobs, get_context("spawn"), max_tasks_per_child=1) as pool:
        yield from pool.map(run_pass, given)
