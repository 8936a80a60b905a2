// SPDX-License-Identifier: Apache-2.0
#include "ground/ground_scale.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ground/scale_field.h"

namespace kinemap {
namespace {

constexpr size_t kSamplesToBegin = 10;
constexpr size_t kSamplesToBeginFrom = 30;  // newest
constexpr double kAgreement = 0.12;         // of the logarithm
constexpr double kAgreeingShare = 0.6;
constexpr double kMemoryM = 20;      // of the way that the newest keyframes' scale is measured over
constexpr double kRoadSigma = 0.03;  // how flat roads are, as an error of the height's logarithm
// A correction is a small step for each new keyframe, so that no pose jumps by more than tracking bears.
constexpr double kTolerated = 0.005, kGain = 0.1, kLargestStep = 0.005;
constexpr int kYoungKeyframes = 30;  // up to which the map is rescaled as a whole
// The newest keyframes change alike, or bundle adjustment would pull them back to the older ones; before them the
// change sets in bit by bit.
constexpr size_t kAdjustedKeyframes = 20, kRampKeyframes = 20;

Eigen::Vector3d CenterOf(const SlamMap& map, const RoadSample& sample) {
  return map.CameraFromMap(sample.newer_from_reference, sample.newer_reference_id).Inverse().translation;
}

double MedianOf(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

// Whether more than the order of time ties keyframes together, so that scaling them one after the other would tear them
// apart again: recognised places, or maps that were merged.
bool IsTiedTogether(const SlamMap& map) {
  for (const KeyframeId id : map.LiveKeyframes()) {
    if (!map.keyframe(id).loop_edges.empty() || id >> 32 != map.map_id()) return true;
  }
  return false;
}

}  // namespace

GroundScale::GroundScale(const CameraModel& camera, double camera_height_m, const Eigen::Vector3d& expected_normal)
    : camera_height_m_(camera_height_m), odometer_(camera, expected_normal) {}

double GroundScale::LogScale(const SlamMap& map, const RoadSample& sample) const {
  return std::log(camera_height_m_ * sample.heights / LengthInMap(map, sample));
}

void GroundScale::Observe(const SlamMap& map, const Frame& frame, RoadView view) {
  if (map.map_id() != map_id_) Restart(map);
  const double expected_height = map.metric_scale() ? camera_height_m_ / std::exp(log_scale_) : 0;
  const std::optional<RoadSample> sample = odometer_.Observe(map, frame, std::move(view), expected_height);
  if (odometer_.height()) {
    plane_ = GroundPlane{odometer_.normal(), expected_height > 0 ? expected_height : *odometer_.height()};
  }
  if (sample) samples_.push_back(*sample);
}

double GroundScale::RecentLogScale(const SlamMap& map) const {
  std::vector<std::pair<double, double>> weighted;  // log scale, weight
  double back_m = 0, sum = 0;
  for (size_t i = samples_.size(); i-- > 0 && back_m < 3 * kMemoryM;) {
    const RoadSample& sample = samples_[i];
    const double variance = sample.sigma * sample.sigma + kRoadSigma * kRoadSigma;
    weighted.emplace_back(LogScale(map, sample), std::exp(-back_m / kMemoryM) / variance);
    sum += weighted.back().second;
    if (i > 0) back_m += (CenterOf(map, sample) - CenterOf(map, samples_[i - 1])).norm();
  }
  std::sort(weighted.begin(), weighted.end());
  double below = 0;
  for (const auto& [log_scale, weight] : weighted) {
    below += weight;
    if (2 * below >= sum) return log_scale;
  }
  return 0;
}

void GroundScale::Correct(SlamMap* map) {
  if (map->map_id() != map_id_ || map->last_keyframe_id() == corrected_at_) return;
  if (!map->metric_scale()) {
    Begin(map);
    return;
  }
  corrected_at_ = map->last_keyframe_id();
  log_scale_ = RecentLogScale(*map);
  if (std::abs(log_scale_) < kTolerated) return;
  const double step = std::clamp(kGain * log_scale_, -kLargestStep, kLargestStep);
  if (map->live_keyframe_count() < kYoungKeyframes) {
    Rescale(step, map);
  } else {
    RescaleNewest(step, map);
  }
  log_scale_ -= step;
}

void GroundScale::Begin(SlamMap* map) {
  if (samples_.size() < kSamplesToBegin) return;
  std::vector<double> log_scales;
  for (size_t i = samples_.size() - std::min(samples_.size(), kSamplesToBeginFrom); i < samples_.size(); ++i) {
    log_scales.push_back(LogScale(*map, samples_[i]));
  }
  const double median = MedianOf(log_scales);
  const auto agreeing = std::count_if(log_scales.begin(), log_scales.end(),
                                      [&](double log_scale) { return std::abs(log_scale - median) < kAgreement; });
  if (static_cast<double>(agreeing) < kAgreeingShare * static_cast<double>(log_scales.size())) return;
  if (static_cast<size_t>(agreeing) < kSamplesToBegin) return;
  Rescale(median, map);
  map->set_metric_scale(true);
  corrected_at_ = map->last_keyframe_id();
  if (plane_) plane_->height *= std::exp(median);
}

void GroundScale::Rescale(double log_factor, SlamMap* map) {
  std::vector<ScaleChange> changes;
  for (const KeyframeId id : map->LiveKeyframes()) changes.push_back({id, log_factor});
  ApplyScaleField(changes, map);
}

void GroundScale::RescaleNewest(double log_factor, SlamMap* map) {
  const std::vector<KeyframeId> live = map->LiveKeyframes();
  const size_t count = std::min(live.size(), kRampKeyframes + kAdjustedKeyframes);
  std::vector<ScaleChange> changes;
  for (size_t i = 0; i < count; ++i) {
    const double part = std::min(1.0, static_cast<double>(i) / kRampKeyframes);
    changes.push_back({live[live.size() - count + i], part * log_factor});
  }
  ApplyScaleField(changes, map);
}

void GroundScale::Finish(SlamMap* map) {
  if (!map->metric_scale() || samples_.empty() || map->map_id() != map_id_) return;
  std::vector<ScaleMeasurement> measurements;
  double way_m = 0;
  std::optional<Eigen::Vector3d> last_center;
  for (const RoadSample& sample : samples_) {
    const Eigen::Vector3d center = CenterOf(*map, sample);
    if (last_center) way_m += (center - *last_center).norm();
    last_center = center;
    measurements.push_back({way_m, LogScale(*map, sample), sample.sigma});
  }
  const std::vector<ScaleEstimate> smoothed = SmoothScale(measurements);
  if (IsTiedTogether(*map)) {
    double sum = 0;
    for (const ScaleEstimate& estimate : smoothed) sum += estimate.log_scale;
    Rescale(sum / static_cast<double>(smoothed.size()), map);
    return;
  }
  std::vector<ScaleChange> changes;
  size_t after = 0;
  for (const KeyframeId id : map->LiveKeyframes()) {
    const int64_t timestamp_ns = map->keyframe(id).timestamp_ns;
    while (after < samples_.size() && samples_[after].timestamp_ns < timestamp_ns) ++after;
    changes.push_back({id, smoothed[std::min(after, smoothed.size() - 1)].log_scale});
  }
  ApplyScaleField(changes, map);
}

void GroundScale::Restore(GroundScaleState state) {
  odometer_.Restore(std::move(state.odometer));
  samples_ = std::move(state.samples);
  map_id_ = state.map_id;
  log_scale_ = state.log_scale;
  corrected_at_ = state.corrected_at;
  plane_ = state.plane;
}

void GroundScale::Restart(const SlamMap& map) {
  map_id_ = map.map_id();
  odometer_.Forget();
  samples_.clear();
  plane_.reset();
  log_scale_ = 0;
  corrected_at_ = kNoId;
}

}  // namespace kinemap
