# SPDX-License-Identifier: Apache-2.0
"""How right the density is that the map gave for every frame of a run."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from schemas.records import DensityLevel
from services.runtime.errors import InputError


@dataclass(frozen=True)
class DensityFrame:
    """One frame: what was said, and what is true. Objects are counted within the same radius and window."""

    timestamp_ns: int
    level: DensityLevel
    estimated_objects: int
    estimated_points: int
    true_objects: int

    @property
    def truly_high(self) -> bool:
        """A truly moving object is within the radius."""
        return self.true_objects > 0


@dataclass(frozen=True)
class DensityError:
    """Errors over `compared` frames, those of which the map knew the place, out of `frames` with truth.

    `mean_absolute_objects` and `bias_objects` (estimate minus truth) are of the number of moving objects. The levels:
    true positive where a high density was called high; the truth is high where at least one truly moving object is
    within the radius, while the map says high from a number of moving points on (thesis, algorithm 5). Frames of
    unknown density are counted apart and in no error.
    """

    frames: int
    compared: int
    mean_absolute_objects: float | None
    bias_objects: float | None
    true_positives: int
    false_positives: int
    false_negatives: int
    true_negatives: int
    unknown_truly_high: int
    unknown_truly_low: int

    @property
    def coverage(self) -> float:
        """The share of the frames that the errors speak of, 0..1."""
        return self.compared / self.frames

    @property
    def precision(self) -> float | None:
        """Of high. None where nothing was ever called high."""
        claimed = self.true_positives + self.false_positives
        return self.true_positives / claimed if claimed else None

    @property
    def recall(self) -> float | None:
        """Of high. None where no compared frame was truly high."""
        high = self.true_positives + self.false_negatives
        return self.true_positives / high if high else None


def density_error(frames: Sequence[DensityFrame]) -> DensityError:
    """Add up the frames. Raises InputError where there are none."""
    if not frames:
        raise InputError("no frame with a density, a true pose and true objects: nothing to compare")
    known = [frame for frame in frames if frame.level is not DensityLevel.UNKNOWN]
    unknown = [frame for frame in frames if frame.level is DensityLevel.UNKNOWN]
    difference = np.array([frame.estimated_objects - frame.true_objects for frame in known], dtype=np.float64)
    said_high = np.array([frame.level is DensityLevel.HIGH for frame in known], dtype=bool)
    is_high = np.array([frame.truly_high for frame in known], dtype=bool)
    return DensityError(
        frames=len(frames),
        compared=len(known),
        mean_absolute_objects=float(np.abs(difference).mean()) if known else None,
        bias_objects=float(difference.mean()) if known else None,
        true_positives=int((said_high & is_high).sum()),
        false_positives=int((said_high & ~is_high).sum()),
        false_negatives=int((~said_high & is_high).sum()),
        true_negatives=int((~said_high & ~is_high).sum()),
        unknown_truly_high=sum(frame.truly_high for frame in unknown),
        unknown_truly_low=sum(not frame.truly_high for frame in unknown),
    )
