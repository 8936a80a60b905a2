// SPDX-License-Identifier: Apache-2.0
#include "geometry/sim3_ransac.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "geometry/sim3_alignment.h"

namespace kinemap {
namespace {

constexpr size_t kSampleSize = 3;

double SquaredError(const CameraModel& camera, const Eigen::Vector3d& point, const Eigen::Vector2d& pixel_px,
                    double inverse_variance) {
  if (point.z() <= 0) return std::numeric_limits<double>::infinity();
  return (camera.Project(point) - pixel_px).squaredNorm() * inverse_variance;
}

}  // namespace

Eigen::Vector2d TwoWayError(const CameraModel& camera, const SimilarityTransform& first_from_second,
                            const PointPair& pair) {
  return {
      SquaredError(camera, first_from_second * pair.in_second, pair.first_px, pair.first_inverse_variance),
      SquaredError(camera, first_from_second.Inverse() * pair.in_first, pair.second_px, pair.second_inverse_variance)};
}

Sim3Estimate CountInliers(const CameraModel& camera, const SimilarityTransform& first_from_second,
                          const std::vector<PointPair>& pairs, double bound) {
  Sim3Estimate estimate;
  estimate.first_from_second = first_from_second;
  for (const PointPair& pair : pairs) {
    estimate.inlier.push_back(TwoWayError(camera, first_from_second, pair).maxCoeff() <= bound);
    if (estimate.inlier.back()) ++estimate.inliers;
  }
  return estimate;
}

std::optional<Sim3Estimate> EstimateSim3(const CameraModel& camera, const std::vector<PointPair>& pairs,
                                         const Sim3RansacOptions& options, RandomEngine& random) {
  if (pairs.size() < std::max<size_t>(kSampleSize, static_cast<size_t>(options.min_inliers))) return std::nullopt;
  Sim3Estimate best;
  const auto consider = [&](const std::vector<size_t>& chosen) {
    std::vector<Eigen::Vector3d> first, second;
    for (const size_t index : chosen) {
      first.push_back(pairs[index].in_first);
      second.push_back(pairs[index].in_second);
    }
    const auto aligned = AlignPoints(second, first, options.fixed_scale);
    if (!aligned) return;
    Sim3Estimate candidate = CountInliers(camera, *aligned, pairs, options.bound);
    if (candidate.inliers > best.inliers) best = std::move(candidate);
  };
  std::vector<size_t> order(pairs.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    for (size_t k = 0; k < kSampleSize; ++k) std::swap(order[k], order[k + random.Below(order.size() - k)]);
    consider({order.begin(), order.begin() + kSampleSize});
  }
  std::vector<size_t> inliers;
  for (size_t i = 0; i < best.inlier.size(); ++i) {
    if (best.inlier[i]) inliers.push_back(i);
  }
  consider(inliers);
  if (best.inliers < options.min_inliers) return std::nullopt;
  return best;
}

}  // namespace kinemap
