// SPDX-License-Identifier: Apache-2.0
#include "mapping/final_adjuster.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

namespace kinemap {
namespace {

bool MeasuresDepth(const BundleProblem& problem) {
  return std::any_of(problem.observations.begin(), problem.observations.end(),
                     [](const BundleObservation& observation) { return !std::isnan(observation.right_x_px); });
}

}  // namespace

double FinalAdjuster::Adjust(SlamMap* map) const {
  const std::vector<KeyframeId> live = map->LiveKeyframes();
  if (live.size() <= 2) return 0;  // adjusted when it was made
  const size_t left_out = live.size() - std::min(live.size(), static_cast<size_t>(options_.keyframes));
  BundleProblem calibrated = CopyBundleProblem(*map, std::set<KeyframeId>(live.begin() + left_out, live.end()));
  BundleProblem solved = calibrated;
  SolveBundle(camera_, options_.bundle, &solved);
  if (options_.bundle.radial_sigma > 0 && !MeasuresDepth(calibrated)) {
    BundleOptions options = options_.bundle;
    options.radial_sigma = 0;
    SolveBundle(camera_, options, &calibrated);
    const bool explains = solved.robust_cost <= (1 - options_.least_explained) * calibrated.robust_cost;
    if (!explains) solved = std::move(calibrated);
  }
  WriteBackBundle(solved, map);
  return solved.radial;
}

}  // namespace kinemap
