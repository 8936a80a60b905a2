// SPDX-License-Identifier: Apache-2.0
#include "mapping/final_adjuster.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

namespace kinemap {

bool FinalAdjuster::MeasuresDepth(const BundleProblem& problem) {
  return std::any_of(problem.observations.begin(), problem.observations.end(),
                     [](const BundleObservation& observation) { return !std::isnan(observation.right_x_px); });
}

double FinalAdjuster::Adjust(SlamMap* map, double known_radial) const {
  const std::vector<KeyframeId> live = map->LiveKeyframes();
  if (live.size() <= 2) return 0;  // adjusted when it was made
  const size_t left_out = live.size() - std::min(live.size(), static_cast<size_t>(options_.keyframes));
  const BundleProblem solved =
      Solve(CopyBundleProblem(*map, std::set<KeyframeId>(live.begin() + left_out, live.end())), known_radial);
  WriteBackBundle(solved, map);
  return MeasuresDepth(solved) ? 0 : solved.radial;
}

BundleProblem FinalAdjuster::Solve(BundleProblem problem, double known_radial,
                                   const std::atomic<bool>* cancelled) const {
  if (options_.bundle.radial_sigma == 0 || MeasuresDepth(problem)) {
    SolveBundle(camera_, options_.bundle, &problem, cancelled);
    return problem;
  }
  BundleOptions bending = options_.bundle, straight = options_.bundle;
  straight.radial_sigma = 0;
  BundleProblem bent = problem;
  SolveBundleRobustly(camera_, bending, &bent, cancelled);
  SolveBundleRobustly(camera_, straight, &problem, cancelled);
  const auto is_likely = [&] { return std::abs(known_radial + bent.radial) <= options_.most_radial; };
  // Outliers are left out only where it is known which camera they are outliers of.
  if (is_likely() && bent.robust_cost <= (1 - options_.least_explained) * problem.robust_cost) {
    SolveBundleWithoutOutliers(camera_, bending, &bent, cancelled);
    if (is_likely()) return bent;
  }
  SolveBundleWithoutOutliers(camera_, straight, &problem, cancelled);
  return problem;
}

}  // namespace kinemap
