// SPDX-License-Identifier: Apache-2.0
#include "features/rotation_consistency.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kinemap {

void RotationConsistency::Add(int match, float from_angle_deg, float to_angle_deg) {
  float turn = to_angle_deg - from_angle_deg;
  if (turn < 0) turn += 360.0f;
  bins_[static_cast<int>(std::lround(turn * kBins / 360.0f)) % kBins].push_back(match);
}

std::vector<int> RotationConsistency::Inconsistent() const {
  std::array<int, kBins> order;
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return bins_[a].size() > bins_[b].size(); });
  // A bin with less than a tenth of the fullest one's matches is noise, not a second rotation.
  const size_t least = bins_[order[0]].size() / 10;
  std::vector<int> inconsistent;
  for (int rank = 1; rank < kBins; ++rank) {
    const std::vector<int>& bin = bins_[order[rank]];
    if (rank < 3 && bin.size() > least) continue;
    inconsistent.insert(inconsistent.end(), bin.begin(), bin.end());
  }
  return inconsistent;
}

}  // namespace kinemap
