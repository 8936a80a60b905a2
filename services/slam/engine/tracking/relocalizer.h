// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "geometry/camera_model.h"
#include "geometry/random_engine.h"
#include "map/frame.h"
#include "map/place_index.h"
#include "map/slam_map.h"
#include "tracking/frame_pose_solver.h"

namespace kinemap {

struct RelocalizerOptions {
  int candidates = 5;           ///< groups of keyframes that show a similar place
  int nearest = 2;              ///< keyframes nearest to where the camera was last seen
  int max_match_distance = 75;  ///< bits, of matches by vocabulary node
  double match_ratio = 0.85;    ///< of the nearest to the second nearest
  int least_matches = 12;
  double max_error_px = 4;  ///< of RANSAC's right matches, finest octave
  int least_ransac_inliers = 10;
  int least_inliers = 40;  ///< of the final pose, static landmarks
  uint64_t seed = 0;
};

/// Finds a lost camera again: keyframes that show a similar place, and those nearest to where it was last seen, are
/// matched with the frame under equal nodes of the vocabulary; then RANSAC over three points, a guided search in the
/// keyframe's neighbourhood and pose optimisation. Landmarks on things that may drive off do not count. Without a
/// vocabulary it compares all descriptors of the nearest keyframes and, a few more each time, of all others in turn.
class Relocalizer {
 public:
  /// `places` may be null or without a vocabulary; it must outlive this.
  Relocalizer(const RelocalizerOptions& options, const CameraModel& camera, const PlaceIndex* places)
      : options_(options), camera_(camera), places_(places), solver_(camera) {}

  /// True when the frame now has a pose in this map and matches. `lost_frames` counts the attempts since tracking was
  /// lost. The same frame and map give the same pose.
  bool Relocalize(const SlamMap& map, const Eigen::Vector3d& last_center_in_map, int lost_frames, Frame* frame);

 private:
  const BagOfWords& BagOf(const Frame& frame);
  bool HasPlaces() const { return places_ != nullptr && places_->has_vocabulary(); }
  std::vector<KeyframeId> Candidates(const SlamMap& map, const BagOfWords& bag,
                                     const Eigen::Vector3d& last_center_in_map, int lost_frames) const;
  bool TryKeyframe(const SlamMap& map, KeyframeId keyframe_id, const BagOfWords& bag, Frame* frame) const;
  int Match(const SlamMap& map, KeyframeId keyframe_id, const BagOfWords& bag, Frame* frame) const;
  bool SolveByThreePoints(const SlamMap& map, Frame* frame) const;

  RelocalizerOptions options_;
  CameraModel camera_;
  const PlaceIndex* places_;
  FramePoseSolver solver_;
  FrameFeaturesPtr described_;  // a frame is looked for in map after map, and described once
  BagOfWords bag_;
};

}  // namespace kinemap
