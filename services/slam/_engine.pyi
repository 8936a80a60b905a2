# SPDX-License-Identifier: Apache-2.0
"""The C++ SLAM engine (services/slam/engine). `engine_adapter` wraps it; nothing else should import it."""

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

class Stage:
    """Which objects' features stay out of tracking (thesis 3.2): none, all potentially dynamic ones, moving ones."""

    base: ClassVar[Stage]
    dynamic: ClassVar[Stage]
    moving: ClassVar[Stage]
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class Lens:
    """What the coefficients of a camera's distortion mean: k1, k2, p1, p2, k3 or a fisheye's k1, k2, k3, k4."""

    plumb_bob: ClassVar[Lens]
    kannala_brandt: ClassVar[Lens]

class CameraModel:
    """A pinhole camera behind a lens; pixels; `distortion` holds 0, 4 or 5 numbers. ValueError for what is none.

    With a baseline it is the left one of a rectified pair whose right camera stands `baseline_m` along its x axis.
    """

    def __init__(
        self,
        width: int,
        height: int,
        fx: float,
        fy: float,
        cx: float,
        cy: float,
        distortion: Sequence[float] = ...,
        baseline_m: float = ...,
        lens: Lens = ...,
    ) -> None: ...
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...

class EngineOptions:
    """All options with their defaults; engine_options.h says what each does and its range."""

    stage: Stage  # moving
    features: int  # 2000, wanted a frame
    pyramid_levels: int  # 8
    pyramid_factor: float  # 1.2
    fast_threshold: int  # 20 grey levels
    fast_threshold_low: int  # 7, where nothing is found at fast_threshold
    mask_border_px: int  # 3, around an object's outline: belongs to nobody
    seed: int  # 0
    merge_delay_frames: int  # 2: bundle adjustment of keyframe k is merged at frame k + 2
    local_bundle_keyframes: int  # 15 that move
    radial_sigma: float  # 0.01: radial distortion calibration may have left, found by flush(); 0: calibration is exact
    velocity_change: float  # 0.05: sigma of one camera's in a second, part of its top speed; 0: by anything
    threads: int  # 2, of feature extraction; results are the same with any number
    loop_closing: bool  # True: recognises places seen before; needs a vocabulary
    right_shift_sigma_px: float  # 0.05: the same of the right image's columns, found with it; 0: the pair is exact
    depth_baseline_m: float  # 0.5: of the stereo pair that a depth camera is as good as, at 1 px
    wait_for_loops: bool  # True; False: a loop is merged when it is solved, not at a fixed frame (realtime)
    camera_height_m: float  # 0: unknown; else above the road, metres: one camera's map becomes metric by it
    new_map_after_lost: int  # 50 lost frames, then another map begins; the old one is kept
    localize_only: bool  # False; True only finds the camera in the loaded maps, which stay as they are
    opencv_threads: int  # 1, of the whole process; 0 leaves OpenCV as it is
    semi_dense: bool  # False: inverse depths of every keyframe's gradient pixels, in the background
    map_id: int  # 0; ids start at map_id << 32
    vocabulary_path: str  # "": places are not recognised, but for those nearby
    map_from_first_camera: npt.NDArray[np.float64]  # (4, 4), identity
    def __init__(self) -> None: ...

class TrackingResult:
    """One frame's outcome; poses and covariance are NaN while there is no pose."""

    @property
    def timestamp_ns(self) -> int: ...
    @property
    def state(self) -> int:
        """0 initializing, 1 tracking, 2 lost."""
    @property
    def reason(self) -> str:
        """Why there is no pose; empty when there is one."""
    @property
    def map_id(self) -> int: ...
    @property
    def map_from_camera(self) -> npt.NDArray[np.float64]:
        """(4, 4), map units."""
    @property
    def covariance(self) -> npt.NDArray[np.float64]:
        """(6, 6) of a step (translation, rotation vector) in the camera frame; map units^2, rad^2."""
    @property
    def reference_keyframe_id(self) -> int: ...
    @property
    def camera_from_reference(self) -> npt.NDArray[np.float64]:
        """(4, 4)"""
    @property
    def tracked_landmarks(self) -> int: ...
    @property
    def features(self) -> int: ...
    @property
    def keyframe_inserted(self) -> bool: ...
    @property
    def moving_unplaced(self) -> int:
        """Features on moving objects for which this keyframe had no depth."""
    @property
    def road_normal(self) -> npt.NDArray[np.float64]:
        """(3,) from the camera down to the road, camera frame; 0 where no road is known."""
    @property
    def road_distance(self) -> float:
        """Of the camera above the road, map units."""
    @property
    def object_contacts(self) -> dict[int, npt.NDArray[np.float64]]:
        """Where objects stand on the road: left end, nearest point, right end (3, 3), camera frame, map units."""
    @property
    def metric_scale(self) -> bool:
        """Whether map units are metres."""
    @property
    def loop_closed(self) -> bool:
        """A place of this map was recognised; many keyframes moved."""
    @property
    def maps_merged(self) -> bool:
        """A place of another map was recognised; map_id may have changed."""
    @property
    def stage_ms(self) -> dict[str, float]:
        """Wall-clock ms: extract, merge, match, local_map, mapping, loop."""
    @property
    def background_ms(self) -> float:
        """Processor time, beside tracking, of what was merged of loops."""

class BagOfWords:
    """What an image shows, in words of a vocabulary."""

    @property
    def words(self) -> list[tuple[int, float]]:
        """Word and weight, ascending by word; the weights add up to 1."""
    @property
    def node_of_keypoint(self) -> list[int]:
        """The node of the tree's upper levels that each keypoint falls under; 0 for those left out."""
    def similarity(self, other: BagOfWords) -> float:
        """L1 score in [0, 1]."""

class Vocabulary:
    """A tree of binary descriptors whose leaves are words."""

    @staticmethod
    def load(path: str) -> Vocabulary:
        """ValueError names the file and what is wrong with it."""
    @staticmethod
    def train(
        descriptors: npt.NDArray[np.uint8],
        image_of_descriptor: npt.NDArray[np.int32],
        branching: int,
        depth: int,
        seed: int,
    ) -> Vocabulary:
        """Of (n, 32) descriptors, whose images' numbers (n,) ascend. ValueError for a number out of its range."""
    def save(self, path: str) -> None:
        """RuntimeError when the file cannot be written."""
    @property
    def word_count(self) -> int: ...
    def describe(self, descriptors: npt.NDArray[np.uint8]) -> BagOfWords:
        """The bag of (n, 32) descriptors."""

def descriptors_of(
    image: npt.NDArray[np.uint8], options: EngineOptions
) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.float64]]:
    """The engine's features of a grey image: descriptors (n, 32) and raw pixels (n, 2)."""

class Engine:
    """SLAM frame by frame. The GIL is released while it works; calls from several threads take turns."""

    def __init__(self, camera: CameraModel, options: EngineOptions) -> None:
        """ValueError names an option outside its range."""
    def begin_frame(
        self,
        timestamp_ns: int,
        image: npt.NDArray[np.uint8],
        right: npt.NDArray[np.uint8] | None = ...,
        depth_m: npt.NDArray[np.float32] | None = ...,
    ) -> None:
        """Extract features of a C-contiguous (height, width) image, with depths from the right one or the depth image.

        ValueError for arrays that do not fit, a right image to a camera without baseline, or an earlier time.
        """
    def finish_frame(
        self,
        track_image: npt.NDArray[np.uint32] | None,
        object_ids: npt.NDArray[np.uint32],
        categories: npt.NDArray[np.int32],
        motion_states: npt.NDArray[np.uint8],
        masks_fresh: bool,
    ) -> TrackingResult:
        """Track and map the begun frame. RuntimeError when none was begun, ValueError for arrays that do not fit."""
    def flush(self) -> None:
        """The end of the input: merge the background's work and adjust the whole map once more; takes seconds."""
    def settle(self) -> None:
        """Merge what the background holds; for a snapshot that is exact."""
    def load_maps(self, path: str) -> None:
        """Begin in another session's maps. ValueError that names the file when it cannot be used.

        RuntimeError when this engine has a map or saw a frame.
        """
    def resume_maps(self, path: str, first_free_map_id: int) -> None:
        """The same with this session's maps, after a fall; new ids come from blocks from `first_free_map_id` on."""
    def save_maps(self, path: str, in_background: bool) -> None:
        """Write all maps into one file, atomically. RuntimeError when it, or the one before it, cannot be written."""
    def checkpoint(self, path: str) -> None:
        """Settle, write the whole state, and go on from what was written, as an engine that `restore`s it does."""
    def restore(self, path: str) -> None:
        """Go on where an engine of the same camera and options made a checkpoint, to the last bit."""
    @property
    def active_map_id(self) -> int: ...
    @property
    def next_map_id(self) -> int: ...
    @property
    def metric_scale(self) -> bool:
        """Whether the active map's units are metres."""
    @property
    def remaining_radial(self) -> float:
        """Radial distortion k (pixel = project(point (1 + k r^2))) that calibration left, as young maps or flush() show
        it, or as it was when the maps loaded were made; 0: none, or not found yet."""
    def take_map_update(self) -> dict[str, npt.NDArray[Any]]:
        """What changed since the last call, keyed like schemas.records.slam.MapUpdate's arrays."""
