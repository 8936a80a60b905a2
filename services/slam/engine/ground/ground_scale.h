// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "ground/road_odometer.h"
#include "ground/scale_smoother.h"
#include "map/slam_map.h"

namespace kinemap {

/// What is carried from one frame to the next.
struct GroundScaleState {
  RoadOdometerState odometer;
  std::vector<RoadSample> samples;
  int64_t map_id = -1;
  double log_scale = 0;
  KeyframeId corrected_at = kNoId;
  std::optional<GroundPlane> plane;
};

/// Metres for a monocular map from the height of its camera above the road: measured frame by frame, filtered over the
/// way, brought into the map as a whole at first and, against drift, little by little in its newest keyframes.
class GroundScale {
 public:
  /// `expected_normal`: the road's direction below the camera (camera frame), as the mounting has it.
  GroundScale(const CameraModel& camera, double camera_height_m, const Eigen::Vector3d& expected_normal);

  const RoadViewer& viewer() const { return odometer_.viewer(); }
  /// Undistorts images by another model of the lens from now on.
  void ChangeLens(const CameraModel& camera) { odometer_.ChangeLens(camera); }

  /// A tracked frame and its view of the road.
  void Observe(const SlamMap& map, const Frame& frame, RoadView view);

  /// Corrects the map's scale by what was observed since. To be called while nothing else holds a copy of the map.
  /// The map becomes metric with the first correction.
  void Correct(SlamMap* map);

  /// The end of the input: all samples together, measured in the map as it is now, correct all of its keyframes.
  void Finish(SlamMap* map);

  /// The road under the frame observed last, in map units; of the last frames where this one did not show it.
  const std::optional<GroundPlane>& plane() const { return plane_; }

  GroundScaleState state() const { return {odometer_.state(), samples_, map_id_, log_scale_, corrected_at_, plane_}; }
  void Restore(GroundScaleState state);

 private:
  double RecentLogScale(const SlamMap& map) const;
  double LogScale(const SlamMap& map, const RoadSample& sample) const;
  void Begin(SlamMap* map);
  void Restart(const SlamMap& map);
  static void Rescale(double log_factor, SlamMap* map);
  static void RescaleNewest(double log_factor, SlamMap* map);

  double camera_height_m_;
  RoadOdometer odometer_;
  std::vector<RoadSample> samples_;
  int64_t map_id_ = -1;
  double log_scale_ = 0;  // of the newest keyframes, as measured at the last correction
  KeyframeId corrected_at_ = kNoId;
  std::optional<GroundPlane> plane_;
};

}  // namespace kinemap
