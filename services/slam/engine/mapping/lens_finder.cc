// SPDX-License-Identifier: Apache-2.0
#include "mapping/lens_finder.h"

#include <set>
#include <utility>
#include <vector>

namespace kinemap {

LensFinder::LensFinder(const LensFinderOptions& options, const CameraModel& camera)
    : options_(options), adjuster_(options.adjustment, camera), next_keyframes_(options.first_keyframes) {}

void LensFinder::Look(const SlamMap& map, int64_t frame_index, double known_radial) {
  if (options_.adjustment.bundle.radial_sigma == 0 || !IsFree()) return;
  const int keyframes = map.live_keyframe_count();
  if (keyframes > options_.most_keyframes || keyframes < next_keyframes_) return;
  const std::vector<KeyframeId> live = map.LiveKeyframes();
  BundleProblem problem = CopyBundleProblem(map, std::set<KeyframeId>(live.begin(), live.end()));
  if (FinalAdjuster::MeasuresDepth(problem)) return;
  const auto delay = static_cast<int64_t>(problem.observations.size()) / options_.observations_per_frame;
  slot_.Start(
      std::move(problem),
      [adjuster = adjuster_, known_radial](const std::atomic<bool>& cancelled, BundleProblem* bundle) {
        *bundle = adjuster.Solve(std::move(*bundle), known_radial, &cancelled);
      },
      frame_index + options_.shortest_delay_frames + delay);
}

BundleProblem LensFinder::Take() {
  BundleProblem solved = slot_.Take();
  const double growth = solved.radial == 0 ? options_.growth : options_.growth_believed;
  next_keyframes_ = static_cast<int>(growth * static_cast<double>(solved.cameras.size()));
  return solved;
}

}  // namespace kinemap
