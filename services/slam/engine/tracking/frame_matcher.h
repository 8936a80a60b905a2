// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/camera_model.h"
#include "map/frame.h"
#include "map/slam_map.h"

namespace kinemap {

/// Gives the current frame the landmarks of the last one, each near where the frame's predicted pose puts it. Returns
/// the number of matches; earlier matches of the frame are forgotten. `radius_px` is that of the finest octave.
int MatchLastFrame(const SlamMap& map, const CameraModel& camera, const Frame& last, double radius_px, Frame* current);

/// Gives the frame landmarks of a keyframe by descriptor alone. Returns the number of matches; earlier ones are
/// forgotten.
int MatchKeyframe(const SlamMap& map, KeyframeId keyframe_id, double ratio, Frame* frame);

/// Adds matches with landmarks of a keyframe that the frame does not have yet, near where its pose puts them. Returns
/// the number added.
int ProjectKeyframe(const SlamMap& map, const CameraModel& camera, KeyframeId keyframe_id, double radius_px,
                    int max_distance, Frame* frame);

}  // namespace kinemap
