# SPDX-License-Identifier: Apache-2.0
"""Objects over time."""

import numpy as np
import pytest

from schemas.records import MotionState, Objects
from services.tracker.state_arrays import arrays_of_objects, objects_of_arrays
from services.tracker.track_lifecycle import ObjectTracker, TrackerOptions
from tests.unit.tracker.instance_frames import Box, frame


def ids(objects: Objects) -> list[int]:
    return [row.object_id for row in objects.objects]


def test_ids_count_from_one_and_last() -> None:
    tracker = ObjectTracker()
    for index in range(10):
        boxes = (Box(20 + 4 * index, 40, 30, 20), Box(200 - 3 * index, 50, 40, 25))
        # the segmenter's ids mean nothing from one frame to the next
        objects = tracker.update(frame(index, *(boxes if index % 2 else boxes[::-1]), first_id=1 + 5 * index))
        left, right = objects.track_image[50, 30 + 4 * index], objects.track_image[60, 220 - 3 * index]
        if index == 0:
            first = (left, right)
        assert (left, right) == first
    assert ids(objects) == [1, 2]
    assert [row.observed_frames for row in objects.objects] == [10, 10]


def test_every_labelled_pixel_belongs_to_an_object() -> None:
    motions = frame(0, Box(20, 40, 30, 20), Box(40, 45, 30, 20, "person"))
    objects = ObjectTracker().update(motions)
    np.testing.assert_array_equal(objects.track_image > 0, motions.labels > 0)
    assert {row.category for row in objects.objects} == {"car", "person"}


@pytest.mark.parametrize(("hidden_frames", "same"), [(1, True), (15, True), (30, True), (31, False)])
def test_lost_objects_keep_their_id_for_thirty_frames(hidden_frames: int, same: bool) -> None:
    tracker = ObjectTracker()
    for index in range(5):
        tracker.update(frame(index, Box(100, 40, 30, 20)))
    for index in range(5, 5 + hidden_frames):
        assert ids(tracker.update(frame(index))) == []
    found = tracker.update(frame(5 + hidden_frames, Box(100, 40, 30, 20)))
    assert ids(found) == ([1] if same else [2])


def test_an_object_that_was_hidden_while_it_moved_is_met_where_it_should_be() -> None:
    tracker = ObjectTracker()
    for index in range(6):
        tracker.update(frame(index, Box(20 + 8 * index, 40, 30, 20)))
    tracker.update(frame(6))
    tracker.update(frame(7))
    assert ids(tracker.update(frame(8, Box(20 + 8 * 8, 40, 30, 20)))) == [1]


def test_ids_are_never_given_twice() -> None:
    tracker = ObjectTracker(TrackerOptions(lost_frames=0))
    seen: list[int] = []
    for index in range(6):
        seen += ids(tracker.update(frame(index, Box(20 if index % 2 else 200, 40, 30, 20))))
    assert seen == [1, 2, 3, 4, 5, 6]


def test_two_that_pass_each_other_keep_their_ids() -> None:
    tracker = ObjectTracker()
    for index in range(25):
        right, left = Box(20 + 8 * index, 40, 30, 20), Box(220 - 8 * index, 46, 30, 26)
        objects = tracker.update(frame(index, left, right))
    assert objects.track_image[41, 20 + 8 * 24 + 5] == 2
    assert objects.track_image[70, 220 - 8 * 24 + 5] == 1


def test_the_category_is_what_it_was_taken_for_most() -> None:
    tracker = ObjectTracker()
    for index, (category, score) in enumerate([("truck", 0.4), ("car", 0.9), ("car", 0.9), ("truck", 0.5)]):
        objects = tracker.update(frame(index, Box(100, 40, 30, 20, category, score=score)))
    assert objects.objects[0].category == "car"
    assert objects.objects[0].score == 0.5


def test_the_motion_state_is_filtered() -> None:
    tracker = ObjectTracker()
    states = []
    for index in range(40):
        probability = 0.1 if index < 20 else 0.97
        states.append(tracker.update(frame(index, Box(100, 40, 30, 20, probability=probability))).objects[0])
    assert states[19].motion_state is MotionState.NON_MOVING
    assert states[20].motion_state is MotionState.NON_MOVING
    assert all(row.motion_state is MotionState.MOVING for row in states[23:])
    assert states[39].moving_probability > 0.9


def test_the_age_of_carried_masks_is_passed_on() -> None:
    tracker = ObjectTracker()
    assert tracker.update(frame(0, Box(100, 40, 30, 20))).masks_age_frames == 0
    assert tracker.update(frame(1, Box(100, 40, 30, 20, age_frames=3))).masks_age_frames == 3


@pytest.mark.parametrize("killed_after", [0, 1, 4, 9])
def test_a_restored_tracker_goes_on_with_the_same_objects(killed_after: int) -> None:
    def motions(index: int):
        boxes = [Box(20 + 5 * index, 40, 30, 20, probability=0.2 + 0.05 * index)]
        if index % 3:
            boxes.append(Box(150, 30 + index, 12, 40, "person" if index % 2 else "bicycle"))
        return frame(index, *boxes)

    whole, first, second = ObjectTracker(), ObjectTracker(), ObjectTracker()
    expected = [whole.update(motions(index)) for index in range(12)]
    for index in range(killed_after):
        first.update(motions(index))
    arrays = arrays_of_objects(first.objects, first.next_id)
    assert all(array.dtype != np.dtype(object) for array in arrays.values())
    second.objects, second.next_id = objects_of_arrays(arrays)
    for index in range(killed_after, 12):
        got = second.update(motions(index))
        assert got.objects == expected[index].objects
        assert got.track_image.tobytes() == expected[index].track_image.tobytes()
