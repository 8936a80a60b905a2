# SPDX-License-Identifier: Apache-2.0
"""Objects over time: born, seen, lost, found again, forgotten."""

from dataclasses import dataclass, field, replace

import numpy as np

from schemas.records import InstanceMotion, InstanceMotions, Objects, ObjectTrack
from services.tracker.association import AssociationOptions, Candidate, associate
from services.tracker.mask_patch import BoxPx, MaskPatch, cut_out
from services.tracker.motion_filter import MotionBelief, MotionFilterOptions, update_belief
from services.tracker.track_image import draw_track_image


@dataclass(frozen=True)
class TrackerOptions:
    """How long objects are remembered, and the options of each step."""

    lost_frames: int = 30
    """an object not seen for more frames than this is forgotten; its id is never given again"""
    velocity_memory: float = 0.5
    association: AssociationOptions = field(default_factory=AssociationOptions)
    motion: MotionFilterOptions = field(default_factory=MotionFilterOptions)


@dataclass(frozen=True)
class TrackedObject:
    """One object as it was last seen."""

    object_id: int
    category_scores: dict[str, float]
    """summed scores of every category it was given: its category is the one with most"""
    score: float
    patch: MaskPatch
    box_px: BoxPx
    velocity_px: tuple[float, float]
    """of the box's centre, a frame"""
    growth: float
    """of the box's sides, a frame, as a factor"""
    belief: MotionBelief
    observed_frames: int
    unseen_frames: int

    @property
    def category(self) -> str:
        """What it was taken for most."""
        return max(sorted(self.category_scores), key=lambda name: self.category_scores[name])

    def predicted_box(self) -> BoxPx:
        """Where its box should be in the next frame. An object out of sight is thought to slow down."""
        x, y, width, height = self.box_px
        frames = float(np.sum(0.8 ** np.arange(self.unseen_frames + 1)))
        factor = float(np.clip(self.growth**frames, 0.5, 2.0))
        centre_x = x + 0.5 * width + frames * self.velocity_px[0]
        centre_y = y + 0.5 * height + frames * self.velocity_px[1]
        return (
            centre_x - 0.5 * factor * width,
            centre_y - 0.5 * factor * height,
            factor * width,
            factor * height,
        )


class ObjectTracker:
    """Gives instances ids that last. `objects` and `next_id` are all its state."""

    def __init__(self, options: TrackerOptions | None = None) -> None:
        self._options = options or TrackerOptions()
        self.objects: tuple[TrackedObject, ...] = ()
        self.next_id = 1

    def update(self, motions: InstanceMotions) -> Objects:
        """Take the instances of the next image; the answer has one object for each of them."""
        instances = [instance for instance in motions.instances if instance.box_px[2] > 0 and instance.box_px[3] > 0]
        patches = [cut_out(motions.labels, instance.instance_id, instance.box_px) for instance in instances]
        pairs = associate(
            [self._predicted(known) for known in self.objects],
            [
                Candidate(instance.category, patch, instance.box_px)
                for instance, patch in zip(instances, patches, strict=True)
            ],
            self._options.association,
        )
        known_of = {found: self.objects[known] for known, found in pairs}
        seen = [
            self._seen(known_of[index], instance, patch) if index in known_of else self._born(instance, patch)
            for index, (instance, patch) in enumerate(zip(instances, patches, strict=True))
        ]
        matched = {known for known, _ in pairs}
        unseen = [
            replace(known, unseen_frames=known.unseen_frames + 1)
            for index, known in enumerate(self.objects)
            if index not in matched and known.unseen_frames < self._options.lost_frames
        ]
        self.objects = tuple(sorted((*seen, *unseen), key=lambda known: known.object_id))
        object_ids = {instance.instance_id: known.object_id for instance, known in zip(instances, seen, strict=True)}
        return Objects(
            motions.timestamp_ns,
            draw_track_image(motions.labels, object_ids),
            tuple(sorted((_row(known) for known in seen), key=lambda row: row.object_id)),
            max((instance.age_frames for instance in instances), default=0),
        )

    def _predicted(self, known: TrackedObject) -> Candidate:
        box_px = known.predicted_box()
        return Candidate(known.category, known.patch.fitted(box_px), box_px)

    def _born(self, instance: InstanceMotion, patch: MaskPatch) -> TrackedObject:
        born = TrackedObject(
            self.next_id,
            {instance.category: instance.score},
            instance.score,
            patch,
            instance.box_px,
            (0.0, 0.0),
            1.0,
            self._belief(MotionBelief(), instance),
            1,
            0,
        )
        self.next_id += 1
        return born

    def _seen(self, known: TrackedObject, instance: InstanceMotion, patch: MaskPatch) -> TrackedObject:
        frames = known.unseen_frames + 1
        x, y, width, height = known.box_px
        now_x, now_y, now_width, now_height = instance.box_px
        moved = (
            (now_x + 0.5 * now_width - x - 0.5 * width) / frames,
            (now_y + 0.5 * now_height - y - 0.5 * height) / frames,
        )
        grown = float(np.clip(np.sqrt(now_width * now_height / (width * height)), 0.5, 2.0)) ** (1.0 / frames)
        memory = self._options.velocity_memory if known.observed_frames > 1 else 0.0
        scores = dict(known.category_scores)
        scores[instance.category] = scores.get(instance.category, 0.0) + instance.score
        return TrackedObject(
            known.object_id,
            scores,
            instance.score,
            patch,
            instance.box_px,
            (
                memory * known.velocity_px[0] + (1.0 - memory) * moved[0],
                memory * known.velocity_px[1] + (1.0 - memory) * moved[1],
            ),
            float(known.growth**memory * grown ** (1.0 - memory)),
            self._belief(known.belief, instance),
            known.observed_frames + 1,
            0,
        )

    def _belief(self, before: MotionBelief, instance: InstanceMotion) -> MotionBelief:
        return update_belief(
            before, instance.moving_probability, instance.samples, instance.age_frames, self._options.motion
        )


def _row(known: TrackedObject) -> ObjectTrack:
    return ObjectTrack(
        known.object_id,
        known.category,
        known.score,
        known.belief.state,
        known.belief.moving_probability,
        known.box_px,
        known.observed_frames,
    )
