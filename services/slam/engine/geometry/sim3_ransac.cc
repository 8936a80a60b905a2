// SPDX-License-Identifier: Apache-2.0
#include "geometry/sim3_ransac.h"

#include <algorithm>
#include <cmath>
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

/// After so many samples one is free of wrong pairs with a probability of 99.9 % (Fischler and Bolles 1981).
double SamplesNeeded(int inliers, size_t pairs) {
  const double good_sample = std::pow(static_cast<double>(inliers) / static_cast<double>(pairs), kSampleSize);
  return good_sample >= 1 ? 1 : std::log(1 - 0.999) / std::log(1 - good_sample);
}

}  // namespace

Sim3Estimate CountInliers(const CameraModel& camera, const SimilarityTransform& first_from_second,
                          const std::vector<PointPair>& pairs, double bound) {
  Sim3Estimate estimate;
  estimate.first_from_second = first_from_second;
  estimate.inlier.reserve(pairs.size());
  const Eigen::Matrix3d turn = first_from_second.scale * first_from_second.rotation.toRotationMatrix();
  const SimilarityTransform second_from_first = first_from_second.Inverse();
  const Eigen::Matrix3d turn_back = second_from_first.scale * second_from_first.rotation.toRotationMatrix();
  for (const PointPair& pair : pairs) {
    const Eigen::Vector3d in_first = turn * pair.in_second + first_from_second.translation;
    const Eigen::Vector3d in_second = turn_back * pair.in_first + second_from_first.translation;
    estimate.inlier.push_back(SquaredError(camera, in_first, pair.first_px, pair.first_inverse_variance) <= bound &&
                              SquaredError(camera, in_second, pair.second_px, pair.second_inverse_variance) <= bound);
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
  double needed = options.iterations;
  for (int iteration = 0; iteration < needed; ++iteration) {
    for (size_t k = 0; k < kSampleSize; ++k) std::swap(order[k], order[k + random.Below(order.size() - k)]);
    const int inliers_before = best.inliers;
    consider({order.begin(), order.begin() + kSampleSize});
    if (best.inliers > inliers_before) needed = std::min(needed, SamplesNeeded(best.inliers, pairs.size()));
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
