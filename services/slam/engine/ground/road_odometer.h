// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <utility>

#include "ground/road_alignment.h"
#include "map/frame.h"
#include "map/slam_map.h"

namespace kinemap {

/// How long the way between two frames is in camera heights, told by the road. It stays true whatever becomes of the
/// map, because both frames are kept relative to keyframes.
struct RoadSample {
  int64_t timestamp_ns;
  KeyframeId older_reference_id, newer_reference_id;
  RigidTransform older_from_reference, newer_from_reference;  ///< in the units of what is anchored there
  double heights;  ///< length of the way / height of the camera above the road
  double sigma;    ///< standard deviation of its logarithm
};

/// Length of a sample's way as the map has it now.
double LengthInMap(const SlamMap& map, const RoadSample& sample);

/// A frame's view of the road, and where it was taken.
struct PastRoadView {
  RoadView view;
  KeyframeId reference_id = kNoId;
  RigidTransform from_reference;
};

/// What the odometer carries from one frame to the next.
struct RoadOdometerState {
  Eigen::Vector3d expected_normal, recent_normal;
  int normals = 0;
  std::deque<PastRoadView> views;
  std::optional<double> height;
};

/// Keeps the last frames' views of the road and aligns each new one with one of them that is about a camera height
/// away. Of a camera that stands or turns on the spot it learns nothing.
class RoadOdometer {
 public:
  /// `expected_normal` (camera frame, down) is where the search starts; the mean of what is found takes over from it.
  RoadOdometer(const CameraModel& camera, const Eigen::Vector3d& expected_normal);

  const RoadViewer& viewer() const { return viewer_; }
  void ChangeLens(const CameraModel& camera) { viewer_ = RoadViewer(camera); }

  /// `frame` has a pose in the map. `expected_height` of the camera in map units; 0: not known yet, then all plausible
  /// heights are tried.
  std::optional<RoadSample> Observe(const SlamMap& map, const Frame& frame, RoadView view, double expected_height);

  /// Height of the camera above the road, map units, if the frame observed last saw the road.
  const std::optional<double>& height() const { return state_.height; }
  /// Mean of the road's last normals in the camera frame: one frame's alone is worth a degree only.
  const Eigen::Vector3d& normal() const { return state_.recent_normal; }

  /// Forgets the views: what comes next is in another map.
  void Forget() { state_.views.clear(); }

  const RoadOdometerState& state() const { return state_; }
  void Restore(RoadOdometerState state) { state_ = std::move(state); }

 private:
  const PastRoadView* PartnerOf(const SlamMap& map, const RigidTransform& map_from_camera, double expected_height,
                                RigidTransform* older_from_newer) const;
  void LearnNormal(const Eigen::Vector3d& normal);

  RoadViewer viewer_;
  RoadOdometerState state_;
};

}  // namespace kinemap
