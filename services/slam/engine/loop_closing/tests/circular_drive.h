// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "map/place_index.h"
#include "map/slam_map.h"
#include "synthetic/scene.h"

namespace kinemap::synthetic {

/// A camera drives round after round between two walls; what it sees further away than a few metres is hidden.
class CircularDrive {
 public:
  static constexpr int kStepsARound = 60;

  CircularDrive();

  /// Truth, world from camera; `step` may go on over the first round.
  RigidTransform WorldFromCamera(int step) const;

  /// A map of keyframes at the steps [begin, end). Each step turns and grows by `drift` too much, from `start` on.
  /// Landmarks out of sight are mapped anew when they come back.
  std::unique_ptr<SlamMap> Map(int64_t map_id, int begin, int end, const SimilarityTransform& start = {},
                               const SimilarityTransform& drift = {}) const;

  /// The same walls with every mark moved to another place: what looks alike and is not.
  CircularDrive Shuffled() const;

  /// An index with a small vocabulary of random words.
  PlaceIndex EmptyIndex() const;

  /// Root mean square distance of the keyframes from the truth, after the best similarity; metres.
  double Error(const SlamMap& map, int begin) const;

 private:
  Frame Observe(int step, std::vector<int>* points) const;

  Scene scene_;
};

}  // namespace kinemap::synthetic
