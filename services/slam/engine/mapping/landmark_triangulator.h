// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "geometry/camera_model.h"
#include "map/slam_map.h"

namespace kinemap {

struct TriangulatorOptions {
  int neighbors = 10;                   ///< covisible keyframes it triangulates with
  double min_baseline_ratio = 0.01;     ///< baseline over median depth
  double max_parallax_cosine = 0.9998;  ///< 1.1 degrees
  double nearest_depth_ratio = 0.15;    ///< of the median depth: nearer points are not looked for
};

/// Makes landmarks from keypoints of a new keyframe that observe none yet: looks along their epipolar lines in the
/// covisible keyframes and keeps what agrees in descriptor, parallax, error and scale. Features of objects that stay
/// out of tracking are matched with their own object only.
class LandmarkTriangulator {
 public:
  LandmarkTriangulator(const TriangulatorOptions& options, const CameraModel& camera)
      : options_(options), camera_(camera) {}

  /// Ids of the landmarks made.
  std::vector<LandmarkId> Triangulate(SlamMap* map, KeyframeId keyframe_id) const;

 private:
  struct Pair;
  std::vector<LandmarkId> TriangulatePair(SlamMap* map, const Pair& pair) const;
  int FindMatch(const Pair& pair, int keypoint, const std::vector<bool>& taken) const;
  bool PointOfMatch(const SlamMap& map, const Pair& pair, int keypoint, int match, Eigen::Vector3d* in_first) const;

  TriangulatorOptions options_;
  CameraModel camera_;
};

}  // namespace kinemap
