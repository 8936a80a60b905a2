// SPDX-License-Identifier: Apache-2.0
#include "ground/road_odometer.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kinemap {
namespace {

constexpr size_t kViews = 12;
constexpr size_t kViewsBackAtFirst = 3;
// Ways, in camera heights: too short a one tells little, on too long a one the road looks another.
constexpr double kShortestWay = 0.3, kBestWay = 1.0, kLongestWay = 2.5, kLeastSpacing = 0.15;
constexpr double kSearchedAround = 1.25;
constexpr double kFewestHeightsAtFirst = 0.08, kMostHeightsAtFirst = 2.5;
// The mounting is learnt over the first samples; later the mean follows a change slowly.
constexpr int kNormalsToLearn = 20;
constexpr double kWideTiltSigma = 0.04;
constexpr double kNormalGain = 0.02, kRecentNormalGain = 0.08;

}  // namespace

double LengthInMap(const SlamMap& map, const RoadSample& sample) {
  const RigidTransform older = map.CameraFromMap(sample.older_from_reference, sample.older_reference_id);
  const RigidTransform newer = map.CameraFromMap(sample.newer_from_reference, sample.newer_reference_id);
  return (older.Inverse().translation - newer.Inverse().translation).norm();
}

RoadOdometer::RoadOdometer(const CameraModel& camera, const Eigen::Vector3d& expected_normal)
    : viewer_(camera), state_{expected_normal, expected_normal, 0, {}, std::nullopt} {}

const PastRoadView* RoadOdometer::PartnerOf(const SlamMap& map, const RigidTransform& map_from_camera,
                                            double expected_height, RigidTransform* older_from_newer) const {
  const PastRoadView* best = nullptr;
  double nearest = std::log(kLongestWay / kBestWay);
  for (size_t back = 1; back <= state_.views.size(); ++back) {
    const PastRoadView& past = state_.views[state_.views.size() - back];
    const RigidTransform candidate = map.CameraFromMap(past.from_reference, past.reference_id) * map_from_camera;
    const double way = candidate.translation.norm();
    if (expected_height > 0) {
      const double way_off = std::abs(std::log(way / (kBestWay * expected_height)));
      if (way < kShortestWay * expected_height || way_off > nearest) continue;
      nearest = way_off;
    } else if (back > kViewsBackAtFirst || !(way > 0)) {
      continue;
    }
    best = &past;
    *older_from_newer = candidate;
  }
  return best;
}

std::optional<RoadSample> RoadOdometer::Observe(const SlamMap& map, const Frame& frame, RoadView view,
                                                double expected_height) {
  state_.height.reset();
  const RigidTransform map_from_camera = frame.camera_from_map.Inverse();
  PastRoadView now{std::move(view), frame.reference_keyframe_id,
                   map.CameraFromReference(frame.camera_from_map, frame.reference_keyframe_id)};
  std::optional<RoadSample> sample;
  RigidTransform older_from_newer;
  if (const PastRoadView* past = PartnerOf(map, map_from_camera, expected_height, &older_from_newer)) {
    RoadAlignmentOptions options;
    if (state_.normals < kNormalsToLearn) options.tilt_sigma_rad = kWideTiltSigma;
    const double way = older_from_newer.translation.norm();
    const double low = expected_height > 0 ? expected_height / kSearchedAround : way / kMostHeightsAtFirst;
    const double high = expected_height > 0 ? expected_height * kSearchedAround : way / kFewestHeightsAtFirst;
    const std::optional<RoadMeasurement> road =
        RoadAlignment(options, viewer_)
            .Align(now.view, past->view, older_from_newer, state_.expected_normal, low, high);
    if (road) {
      state_.height = road->plane.height;
      LearnNormal(road->plane.normal);
      sample = RoadSample{frame.timestamp_ns, past->reference_id,       now.reference_id, past->from_reference,
                          now.from_reference, way / road->plane.height, road->sigma};
    }
  }
  if (!state_.views.empty()) {
    const PastRoadView& last = state_.views.back();
    const double moved =
        (map.CameraFromMap(last.from_reference, last.reference_id) * map_from_camera).translation.norm();
    if (moved < kLeastSpacing * expected_height) return sample;
  }
  state_.views.push_back(std::move(now));
  if (state_.views.size() > kViews) state_.views.pop_front();
  return sample;
}

void RoadOdometer::LearnNormal(const Eigen::Vector3d& normal) {
  ++state_.normals;
  const double mean_gain = 1.0 / (state_.normals + 3);
  const auto follow = [&](double gain, Eigen::Vector3d* mean) {
    *mean = (*mean + std::max(gain, mean_gain) * (normal - *mean)).normalized();
  };
  follow(kNormalGain, &state_.expected_normal);
  follow(kRecentNormalGain, &state_.recent_normal);
}

}  // namespace kinemap
