// SPDX-License-Identifier: Apache-2.0
#include "map/depth_scale.h"

#include <algorithm>
#include <vector>

namespace kinemap {
namespace {
constexpr size_t kLeastSamples = 10;
}

double MapUnitsPerMetre(const SlamMap& map, const Frame& frame) {
  std::vector<double> ratios;
  for (int i = 0; i < frame.size(); ++i) {
    const Landmark* landmark = map.FindLandmark(frame.landmark_ids[i]);
    if (landmark == nullptr || !landmark->IsTrackable()) continue;
    const double measured_m = frame.features->keypoints[i].depth_m;
    const double mapped = (frame.camera_from_map * map.PositionInMap(*landmark)).z();
    if (measured_m > 0 && mapped > 0) ratios.push_back(mapped / measured_m);
  }
  if (ratios.size() < kLeastSamples) return 0;
  std::nth_element(ratios.begin(), ratios.begin() + ratios.size() / 2, ratios.end());
  return ratios[ratios.size() / 2];
}

}  // namespace kinemap
