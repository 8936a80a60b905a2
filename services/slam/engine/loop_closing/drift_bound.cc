// SPDX-License-Identifier: Apache-2.0
#include "loop_closing/drift_bound.h"

#include <algorithm>

namespace kinemap {
namespace {

/// Along the keyframes between the two, in map units.
double WayBetween(const SlamMap& map, KeyframeId one, KeyframeId other) {
  const auto [first, last] = std::minmax(one, other);
  double way = 0;
  Eigen::Vector3d before = map.keyframe(first).map_from_keyframe.translation;
  for (const KeyframeId id : map.LiveKeyframes()) {
    if (id <= first || id > last) continue;
    const Eigen::Vector3d& here = map.keyframe(id).map_from_keyframe.translation;
    way += (here - before).norm();
    before = here;
  }
  return way;
}

}  // namespace

bool IsWithinDrift(const DriftBoundOptions& options, const SlamMap& map, KeyframeId keyframe_id,
                   KeyframeId candidate_id, const SimilarityTransform& candidate_from_keyframe, bool fixed_scale) {
  const Eigen::Vector3d recognised =
      SimilarityTransform(map.keyframe(candidate_id).map_from_keyframe) * candidate_from_keyframe.translation;
  const double off = (recognised - map.keyframe(keyframe_id).map_from_keyframe.translation).norm();
  const double part = fixed_scale ? options.measured_depth : options.one_camera;
  return off <= part * WayBetween(map, keyframe_id, candidate_id);
}

}  // namespace kinemap
