// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/camera_model.h"
#include "geometry/random_engine.h"
#include "geometry/two_view_motion.h"
#include "map/frame.h"
#include "tracking/initial_matcher.h"

namespace kinemap {

struct InitializerOptions {
  int min_features = 100;            ///< trackable features a reference frame must have
  int min_matches = 100;             ///< fewer, and the reference is replaced by the current frame
  double min_displacement_px = 1.0;  ///< of matches in the median; with less the camera stands still
  int min_points = 50;               ///< points the motion must triangulate
  int ransac_iterations = 200;
  double sigma_px = 1.0;           ///< standard deviation of a keypoint
  double homography_ratio = 0.45;  ///< above it R_H = S_H / (S_H + S_F) chooses the homography
  double min_parallax_deg = 1.0;   ///< that all but 50 points may stay below
};

/// The first two keyframes and their points; the translation has unit length.
struct InitialMap {
  Frame reference;
  TwoViewMotion motion;               ///< second = current, first = reference
  std::vector<FeatureMatch> matches;  ///< one a point of the motion
  bool from_homography = false;
};

/// What the initialiser carries from one frame to the next.
struct InitializerState {
  std::optional<Frame> reference;
  std::vector<Eigen::Vector2d> last_seen_px;  ///< one a keypoint of the reference
  std::string reason;
};

/// Finds a pair of frames with enough parallax to start a map from (Mur-Artal, Montiel and Tardos 2015, section IV).
class MapInitializer {
 public:
  MapInitializer(const InitializerOptions& options, const CameraModel& camera) : options_(options), camera_(camera) {}

  /// Nothing while it waits; reason() then says what for.
  std::optional<InitialMap> Try(const Frame& current, RandomEngine& random);

  /// The next frame becomes the first view.
  void StartAgain();

  /// Whether the frame of this time is the first view, and a map may begin with it.
  bool IsFirstView(int64_t timestamp_ns) const { return reference_ && reference_->timestamp_ns == timestamp_ns; }

  const std::string& reason() const { return reason_; }

  InitializerState state() const;
  void Restore(InitializerState state);

 private:
  void StartFrom(const Frame& frame);
  std::optional<TwoViewMotion> FindMotion(const std::vector<PixelPair>& pairs, RandomEngine& random,
                                          bool* from_homography);

  InitializerOptions options_;
  CameraModel camera_;
  std::optional<Frame> reference_;
  std::optional<InitialMatcher> matcher_;
  std::string reason_ = "no frame yet";
};

}  // namespace kinemap
