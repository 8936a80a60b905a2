// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/similarity_transform.h"
#include "map/slam_map.h"

namespace kinemap {

/// What may be lost on a way from keyframe to keyframe, as a part of that way. A street of equal houses shows one
/// picture at many places; that the camera cannot be at another one of them, only its way tells.
struct DriftBoundOptions {
  double one_camera = 0.3;      ///< its scale drifts too
  double measured_depth = 0.1;  ///< stereo, depth
  double closed = 0.05;         ///< between keyframes that a closed loop holds, whatever the camera
};

/// Whether the camera can have come to where a recognised place puts it. The way is the one on which least is lost,
/// over keyframes that follow each other, see the same landmarks or were joined by a loop: a camera that drives through
/// a mapped street again has not drifted by the whole way of its second round.
///
/// @param candidate_from_keyframe between the two cameras of `map`, in its units.
/// @param fixed_scale both were mapped with measured depth.
bool IsWithinDrift(const DriftBoundOptions& options, const SlamMap& map, KeyframeId keyframe_id,
                   KeyframeId candidate_id, const SimilarityTransform& candidate_from_keyframe, bool fixed_scale);

}  // namespace kinemap
