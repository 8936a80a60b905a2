// SPDX-License-Identifier: Apache-2.0
#include "optimization/velocity_changes.h"

#include <algorithm>
#include <cmath>

namespace kinemap {
namespace {

constexpr double kLongestGap = 2;    // s; over a longer one nothing tells of the next velocity
constexpr double kForgetAfter = 30;  // s; a queue stands as long
constexpr double kStanding = 0.05;   // of the top speed; from less, a velocity may change by any part of it
constexpr double kLeap = 1.5;        // times the top speed: a camera that was lost was carried, or the recording cut
constexpr double kSecondsInNs = 1e-9;

struct Passage {
  KeyframeId id;
  double top_speed = 0;  // about then
  int drive = 0;         // counts up where one velocity does not lead to the next
};

double SecondsBetween(const Keyframe& earlier, const Keyframe& later) {
  return static_cast<double>(later.timestamp_ns - earlier.timestamp_ns) * kSecondsInNs;
}

/// Live keyframes in the order of their ids, that of insertion: times would mix drives of several days. The top speed
/// is the highest before and after, forgotten slowly.
std::vector<Passage> Passages(const SlamMap& map) {
  const std::vector<KeyframeId> ids = map.LiveKeyframes();
  std::vector<Passage> passages(ids.size());
  std::vector<double> speeds(ids.size()), kept(ids.size());  // from the one before; kept: of its top speed
  std::vector<bool> was_lost(ids.size());
  for (size_t i = 0; i < ids.size(); ++i) {
    passages[i].id = ids[i];
    if (i == 0) continue;
    const Keyframe &earlier = map.keyframe(ids[i - 1]), &later = map.keyframe(ids[i]);
    const double gap_s = SecondsBetween(earlier, later);
    if (earlier.id >> 32 != later.id >> 32 || gap_s <= 0) continue;
    kept[i] = std::exp(-gap_s / kForgetAfter);
    was_lost[i] = later.tracked_since_ns > earlier.timestamp_ns;
    const double way = (later.map_from_keyframe.translation - earlier.map_from_keyframe.translation).norm();
    if (gap_s <= kLongestGap) speeds[i] = way / gap_s;
    if (!was_lost[i]) passages[i].top_speed = speeds[i];
  }
  for (size_t i = 1; i < ids.size(); ++i) {
    passages[i].top_speed = std::max(passages[i].top_speed, passages[i - 1].top_speed * kept[i]);
  }
  for (size_t i = ids.size(); i-- > 1;) {
    passages[i - 1].top_speed = std::max(passages[i - 1].top_speed, passages[i].top_speed * kept[i]);
  }
  for (size_t i = 1; i < ids.size(); ++i) {
    const double top_speed = std::max(passages[i - 1].top_speed, passages[i].top_speed);
    const bool leapt = was_lost[i] && speeds[i] > kLeap * top_speed;
    passages[i].drive = passages[i - 1].drive + (kept[i] == 0 || leapt ? 1 : 0);
  }
  return passages;
}

}  // namespace

std::vector<VelocityChange> VelocityChanges(const SlamMap& map, const BundleProblem& problem) {
  const bool measures_depth =
      std::any_of(problem.observations.begin(), problem.observations.end(),
                  [](const BundleObservation& observation) { return !std::isnan(observation.right_x_px); });
  if (measures_depth) return {};
  const std::vector<Passage> passages = Passages(map);
  const auto id_of = [&](int camera) { return problem.cameras[camera].keyframe_id; };
  const auto keyframe_of = [&](int camera) -> const Keyframe& { return map.keyframe(id_of(camera)); };
  const auto center = [&](int camera) { return problem.cameras[camera].camera_from_map.Inverse().translation; };
  const auto passage_of = [&](int camera) -> const Passage& {
    return *std::lower_bound(passages.begin(), passages.end(), id_of(camera),
                             [](const Passage& each, KeyframeId id) { return each.id < id; });
  };
  std::vector<int> order(problem.cameras.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return id_of(a) < id_of(b); });
  std::vector<VelocityChange> changes;
  for (size_t i = 2; i < order.size(); ++i) {
    const Passage& passage = passage_of(order[i]);
    if (passage_of(order[i - 2]).drive != passage.drive) continue;
    const double earlier_s = SecondsBetween(keyframe_of(order[i - 2]), keyframe_of(order[i - 1]));
    const double later_s = SecondsBetween(keyframe_of(order[i - 1]), keyframe_of(order[i]));
    if (std::max(earlier_s, later_s) > kLongestGap) continue;
    const double earlier = (center(order[i - 1]) - center(order[i - 2])).norm() / earlier_s;
    const double later = (center(order[i]) - center(order[i - 1])).norm() / later_s;
    if (std::min(earlier, later) <= kStanding * passage.top_speed) continue;
    // Variance of the difference of two means of a random walk over intervals that meet.
    const double sigma = std::sqrt((earlier_s + later_s) / 3) * passage.top_speed / std::sqrt(earlier * later);
    changes.push_back({order[i - 2], order[i - 1], order[i], earlier_s, later_s, sigma});
  }
  return changes;
}

}  // namespace kinemap
