// SPDX-License-Identifier: Apache-2.0
#include "optimization/velocity_changes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace kinemap {
namespace {

constexpr double kLongestGap = 2;    // s; over a longer one a camera may have been lost
constexpr double kForgetAfter = 30;  // s; a queue stands as long
constexpr double kStanding = 0.05;   // of the top speed; from less, a velocity may change by any part of it
constexpr double kSecondsInNs = 1e-9;

struct Passage {
  int64_t timestamp_ns;
  Eigen::Vector3d center;
  double top_speed = 0;  // about then
};

double SecondsBetween(int64_t earlier_ns, int64_t later_ns) {
  return static_cast<double>(later_ns - earlier_ns) * kSecondsInNs;
}

/// Live keyframes in the order of time, with the highest speed before and after, forgotten slowly.
std::vector<Passage> Passages(const SlamMap& map) {
  std::vector<Passage> passages;
  for (const KeyframeId id : map.LiveKeyframes()) {
    const Keyframe& keyframe = map.keyframe(id);
    passages.push_back({keyframe.timestamp_ns, keyframe.map_from_keyframe.translation});
  }
  std::sort(passages.begin(), passages.end(),
            [](const Passage& a, const Passage& b) { return a.timestamp_ns < b.timestamp_ns; });
  const auto gap_before = [&](size_t i) {
    return SecondsBetween(passages[i - 1].timestamp_ns, passages[i].timestamp_ns);
  };
  for (size_t i = 1; i < passages.size(); ++i) {
    const double gap_s = gap_before(i), way = (passages[i].center - passages[i - 1].center).norm();
    const double speed = gap_s <= kLongestGap ? way / gap_s : 0;
    passages[i].top_speed = std::max(speed, passages[i - 1].top_speed * std::exp(-gap_s / kForgetAfter));
  }
  for (size_t i = passages.size(); i-- > 1;) {
    double& speed = passages[i - 1].top_speed;
    speed = std::max(speed, passages[i].top_speed * std::exp(-gap_before(i) / kForgetAfter));
  }
  return passages;
}

}  // namespace

std::vector<VelocityChange> VelocityChanges(const SlamMap& map, const BundleProblem& problem) {
  const bool measures_depth =
      std::any_of(problem.observations.begin(), problem.observations.end(),
                  [](const BundleObservation& observation) { return !std::isnan(observation.right_x_px); });
  if (measures_depth) return {};
  const auto time_of = [&](int camera) { return map.keyframe(problem.cameras[camera].keyframe_id).timestamp_ns; };
  std::vector<int> order(problem.cameras.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return time_of(a) < time_of(b); });
  const std::vector<Passage> passages = Passages(map);
  std::vector<VelocityChange> changes;
  for (size_t i = 2; i < order.size(); ++i) {
    const int64_t newest_ns = time_of(order[i]);
    const double earlier_s = SecondsBetween(time_of(order[i - 2]), time_of(order[i - 1]));
    const double later_s = SecondsBetween(time_of(order[i - 1]), newest_ns);
    if (std::max(earlier_s, later_s) > kLongestGap) continue;
    const auto passage =
        std::lower_bound(passages.begin(), passages.end(), newest_ns,
                         [](const Passage& each, int64_t timestamp_ns) { return each.timestamp_ns < timestamp_ns; });
    const auto center = [&](int camera) { return problem.cameras[camera].camera_from_map.Inverse().translation; };
    const double earlier = (center(order[i - 1]) - center(order[i - 2])).norm() / earlier_s;
    const double later = (center(order[i]) - center(order[i - 1])).norm() / later_s;
    if (std::min(earlier, later) <= kStanding * passage->top_speed) continue;
    // Variance of the difference of two means of a random walk over intervals that meet.
    const double sigma = std::sqrt((earlier_s + later_s) / 3) * passage->top_speed / std::sqrt(earlier * later);
    changes.push_back({order[i - 2], order[i - 1], order[i], earlier_s, later_s, sigma});
  }
  return changes;
}

}  // namespace kinemap
