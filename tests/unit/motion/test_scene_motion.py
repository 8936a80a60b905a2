# SPDX-License-Identifier: Apache-2.0
"""Image after image, from pixels to what moves."""

from dataclasses import replace

import numpy as np
import pytest

from schemas.records import Image, Instances
from services.motion.scene_motion import SceneMotion
from services.motion.state_arrays import arrays_of_state, state_of_arrays
from services.runtime.errors import InputError
from tests.unit.motion.moving_pictures import FRAME_NS, SPEED_M, Picture, picture


def update(scene: SceneMotion, taken: Picture):
    return scene.update(taken.image, taken.calibration, taken.instances)


def skipped(taken: Picture) -> Picture:
    return replace(
        taken,
        instances=Instances(taken.image.timestamp_ns, np.zeros((0, 0), np.uint32), (), skipped=True),
    )


def test_the_first_image_says_nothing_and_says_why() -> None:
    result = update(SceneMotion(), picture(0, SPEED_M))
    assert not result.ego_motion.valid
    assert result.ego_motion.reason == "first image"
    assert result.instance_motions.instances[0].moving_probability == 0.5
    assert not result.moving_mask.mask.any()


def test_the_camera_drives_ahead() -> None:
    scene = SceneMotion()
    update(scene, picture(0))
    ego = update(scene, picture(1)).ego_motion
    assert ego.valid
    assert (ego.timestamp_ns, ego.previous_timestamp_ns) == (FRAME_NS, 0)
    np.testing.assert_allclose(ego.rotation, np.eye(3), atol=3e-3)
    np.testing.assert_allclose(ego.translation_direction, (0.0, 0.0, -1.0), atol=0.05)


def test_a_standing_camera_has_no_direction() -> None:
    scene = SceneMotion()
    update(scene, picture(3))
    again = picture(3)
    ego = update(scene, replace(again, image=Image(4 * FRAME_NS, again.image.pixels))).ego_motion
    assert ego.valid
    assert ego.reason == "no baseline"
    np.testing.assert_array_equal(ego.translation_direction, 0.0)


@pytest.mark.parametrize(("step_m", "moves"), [(0.0, False), (SPEED_M, True), (2.0 * SPEED_M, True)])
def test_a_car_ahead(step_m: float, moves: bool) -> None:
    scene = SceneMotion()
    for index in range(3):
        taken = picture(index, step_m)
        result = update(scene, taken)
    instance = result.instance_motions.instances[0]
    assert instance.samples > 100
    assert instance.age_frames == 0
    assert (instance.moving_probability > 0.7) if moves else (instance.moving_probability < 0.45)
    np.testing.assert_array_equal(result.moving_mask.mask, np.where(moves & (taken.instances.labels > 0), 255, 0))


def test_masks_of_a_skipped_frame_are_carried() -> None:
    scene = SceneMotion()
    for index in range(2):
        update(scene, picture(index, SPEED_M))
    for age in (1, 2):
        truth = picture(1 + age, SPEED_M)
        motions = update(scene, skipped(truth)).instance_motions
        carried, true = motions.labels > 0, truth.instances.labels > 0
        assert [instance.age_frames for instance in motions.instances] == [age]
        assert (carried & true).sum() > 0.8 * (carried | true).sum()
    assert update(scene, picture(4, SPEED_M)).instance_motions.instances[0].age_frames == 0


def test_labels_of_another_size_are_refused() -> None:
    taken = picture(0)
    labels = Instances(0, np.zeros((10, 20), np.uint32), ())
    with pytest.raises(InputError, match=r"\(10, 20\).*\(160, 320\)"):
        SceneMotion().update(taken.image, taken.calibration, labels)


def test_an_image_of_another_size_starts_anew() -> None:
    scene = SceneMotion()
    update(scene, picture(0))
    small = Image(FRAME_NS, np.zeros((80, 160), np.uint8))
    result = scene.update(small, picture(0).calibration, Instances(FRAME_NS, np.zeros((80, 160), np.uint32), ()))
    assert not result.ego_motion.valid
    assert "another size" in result.ego_motion.reason


def test_colour_images_are_taken_too() -> None:
    scene = SceneMotion()
    for index in range(2):
        taken = picture(index)
        colour = np.repeat(taken.image.pixels[..., None], 3, axis=2)
        result = update(scene, replace(taken, image=Image(taken.image.timestamp_ns, colour)))
    assert result.ego_motion.valid


@pytest.mark.parametrize("killed_after", [1, 2, 3])
def test_a_restored_scene_goes_on_with_the_same_numbers(killed_after: int) -> None:
    whole, first, second = SceneMotion(), SceneMotion(), SceneMotion()
    frames = [picture(0, 0.2), picture(1, 0.2), skipped(picture(2, 0.2)), skipped(picture(3, 0.2)), picture(4, 0.2)]
    expected = [update(whole, taken) for taken in frames]
    for taken in frames[:killed_after]:
        update(first, taken)
    assert first.state is not None
    second.state = state_of_arrays(arrays_of_state(first.state))
    for taken, wanted in zip(frames[killed_after:], expected[killed_after:], strict=True):
        got = update(second, taken)
        assert got.instance_motions.instances == wanted.instance_motions.instances
        assert got.instance_motions.labels.tobytes() == wanted.instance_motions.labels.tobytes()
        assert got.ego_motion.rotation.tobytes() == wanted.ego_motion.rotation.tobytes()
        assert got.moving_mask.mask.tobytes() == wanted.moving_mask.mask.tobytes()
