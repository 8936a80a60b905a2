// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/similarity_transform.h"
#include "map/slam_map.h"

namespace kinemap {

/// What odometry may have lost on its way, as a part of that way. A street of equal houses shows one picture at many
/// places; that the camera cannot be at another one of them, only its way tells.
struct DriftBoundOptions {
  double one_camera = 0.3;      ///< its scale drifts too
  double measured_depth = 0.1;  ///< stereo, depth
};

/// Whether the camera can have come to where a recognised place puts it.
///
/// @param candidate_from_keyframe between the two cameras of `map`, in its units.
/// @param fixed_scale both were mapped with measured depth.
bool IsWithinDrift(const DriftBoundOptions& options, const SlamMap& map, KeyframeId keyframe_id,
                   KeyframeId candidate_id, const SimilarityTransform& candidate_from_keyframe, bool fixed_scale);

}  // namespace kinemap
