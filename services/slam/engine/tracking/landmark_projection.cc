// SPDX-License-Identifier: Apache-2.0
#include "tracking/landmark_projection.h"

#include "map/landmark_search.h"

namespace kinemap {
namespace {

constexpr double kRatio = 0.9;

}  // namespace

int ProjectLandmarks(const SlamMap& map, const CameraModel& camera, const std::vector<LandmarkId>& landmarks,
                     double radius_px, int max_distance, Frame* frame) {
  const IdSet already = frame->MatchedLandmarks();
  const Eigen::Vector3d center = frame->camera_from_map.Inverse().translation;
  KeypointSearch search;
  int added = 0;
  for (const LandmarkId id : landmarks) {
    if (already.Contains(id)) continue;
    const Landmark* landmark = map.FindLandmark(id);
    const auto view =
        PredictView(*landmark, map.PositionInMap(*landmark), frame->camera_from_map, center, camera, map.scales());
    if (!view) continue;
    const SearchWindow window{view->pixel_px, radius_px * map.scales().scale(view->octave), view->octave - 1,
                              view->octave + 1};
    const int best = search.FindBest(*frame->features, landmark->descriptor, window, max_distance, kRatio,
                                     [&](int keypoint) { return frame->IsFree(keypoint); });
    if (best < 0) continue;
    frame->landmark_ids[best] = id;
    ++added;
  }
  return added;
}

}  // namespace kinemap
