// SPDX-License-Identifier: Apache-2.0
#include "loop_closing/drift_bound.h"

#include <algorithm>
#include <functional>
#include <map>
#include <queue>
#include <utility>
#include <vector>

namespace kinemap {
namespace {

constexpr int kMostNeighbors = 1000;
constexpr int kLeastShared = 15;  // below it two keyframes hardly see the same

/// Least drift from keyframe to keyframe, map units (Dijkstra 1959).
class DriftSearch {
 public:
  DriftSearch(const SlamMap& map, double open_part, double closed_part)
      : map_(map), open_part_(open_part), closed_part_(closed_part), keyframes_(map.LiveKeyframes()) {
    for (size_t i = 0; i < keyframes_.size(); ++i) index_of_[keyframes_[i]] = i;
    MarkClosed();
  }

  double Least(KeyframeId from, KeyframeId to) const {
    using Reached = std::pair<double, size_t>;
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> next;
    std::vector<bool> done(keyframes_.size(), false);
    next.push({0, index_of_.at(from)});
    while (!next.empty()) {
      const auto [drift, index] = next.top();
      next.pop();
      if (keyframes_[index] == to) return drift;
      if (done[index]) continue;
      done[index] = true;
      const auto reach = [&, drift = drift, index = index](size_t other) {
        if (!done[other]) next.push({drift + Step(index, other), other});
      };
      if (index > 0) reach(index - 1);
      if (index + 1 < keyframes_.size()) reach(index + 1);
      for (const KeyframeId id : map_.covisibility().Neighbors(keyframes_[index], kMostNeighbors, kLeastShared)) {
        reach(index_of_.at(id));
      }
      for (const KeyframeId id : map_.keyframe(keyframes_[index]).loop_edges) {
        if (const auto other = index_of_.find(id); other != index_of_.end()) reach(other->second);
      }
    }
    return 0;
  }

 private:
  /// A loop holds all keyframes between its ends.
  void MarkClosed() {
    closed_.assign(keyframes_.size(), false);
    for (size_t i = 0; i < keyframes_.size(); ++i) {
      for (const KeyframeId id : map_.keyframe(keyframes_[i]).loop_edges) {
        const auto other = index_of_.find(id);
        if (other == index_of_.end()) continue;
        const auto [first, last] = std::minmax(i, other->second);
        std::fill(closed_.begin() + first, closed_.begin() + last + 1, true);
      }
    }
  }

  double Step(size_t a, size_t b) const {
    const double way = (map_.keyframe(keyframes_[a]).map_from_keyframe.translation -
                        map_.keyframe(keyframes_[b]).map_from_keyframe.translation)
                           .norm();
    return (closed_[a] && closed_[b] ? closed_part_ : open_part_) * way;
  }

  const SlamMap& map_;
  double open_part_, closed_part_;
  std::vector<KeyframeId> keyframes_;
  std::map<KeyframeId, size_t> index_of_;
  std::vector<bool> closed_;
};

}  // namespace

bool IsWithinDrift(const DriftBoundOptions& options, const SlamMap& map, KeyframeId keyframe_id,
                   KeyframeId candidate_id, const SimilarityTransform& candidate_from_keyframe, bool fixed_scale) {
  const Eigen::Vector3d recognised =
      SimilarityTransform(map.keyframe(candidate_id).map_from_keyframe) * candidate_from_keyframe.translation;
  const double off = (recognised - map.keyframe(keyframe_id).map_from_keyframe.translation).norm();
  const double part = fixed_scale ? options.measured_depth : options.one_camera;
  return off <= DriftSearch(map, part, options.closed).Least(keyframe_id, candidate_id);
}

}  // namespace kinemap
