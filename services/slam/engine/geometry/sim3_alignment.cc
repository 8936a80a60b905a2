// SPDX-License-Identifier: Apache-2.0
#include "geometry/sim3_alignment.h"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace kinemap {
namespace {
// Of the largest singular value; points nearer to a line than this leave the turn about it to noise.
constexpr double kLeastSpread = 1e-6;
}  // namespace

std::optional<SimilarityTransform> AlignPoints(const std::vector<Eigen::Vector3d>& source,
                                               const std::vector<Eigen::Vector3d>& target, bool fixed_scale) {
  if (source.size() < 3 || source.size() != target.size()) return std::nullopt;
  const double count = static_cast<double>(source.size());
  Eigen::Vector3d source_mean = Eigen::Vector3d::Zero(), target_mean = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < source.size(); ++i) {
    source_mean += source[i] / count;
    target_mean += target[i] / count;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double source_variance = 0;
  for (size_t i = 0; i < source.size(); ++i) {
    const Eigen::Vector3d from_mean = source[i] - source_mean;
    covariance += (target[i] - target_mean) * from_mean.transpose() / count;
    source_variance += from_mean.squaredNorm() / count;
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& singular_values = svd.singularValues();
  if (!(singular_values[1] > kLeastSpread * singular_values[0])) return std::nullopt;
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) sign[2] = -1;
  const Eigen::Matrix3d rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  const double scale = fixed_scale ? 1.0 : singular_values.dot(sign) / source_variance;
  if (!(scale > 0)) return std::nullopt;
  return SimilarityTransform(Eigen::Quaterniond(rotation), target_mean - scale * (rotation * source_mean), scale);
}

}  // namespace kinemap
