// SPDX-License-Identifier: Apache-2.0
#include "geometry/two_view_ransac.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>

namespace kinemap {
namespace {

// 95 % bounds of chi-squared with two and one degrees of freedom.
constexpr double kHomographyBound = 5.991;
constexpr double kFundamentalBound = 3.841;
constexpr double kScoreBound = 5.991;
constexpr size_t kSampleSize = 8;
constexpr int kRefits = 5;

using Matrix9d = Eigen::Matrix<double, 9, 9>;
using Vector9d = Eigen::Matrix<double, 9, 1>;

/// Similarity that moves the centroid to the origin and the mean distance to sqrt(2) (Hartley 1997).
Eigen::Matrix3d Normalization(const std::vector<PixelPair>& pairs, Eigen::Vector2d PixelPair::* side) {
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();
  for (const PixelPair& pair : pairs) centroid += pair.*side;
  centroid /= static_cast<double>(pairs.size());
  double distance = 0;
  for (const PixelPair& pair : pairs) distance += (pair.*side - centroid).norm();
  const double scale = std::sqrt(2.0) * static_cast<double>(pairs.size()) / std::max(distance, 1e-12);
  Eigen::Matrix3d normalization;
  normalization << scale, 0, -scale * centroid.x(), 0, scale, -scale * centroid.y(), 0, 0, 1;
  return normalization;
}

Eigen::Matrix3d NullMatrix(const Matrix9d& normal_matrix) {
  const Eigen::SelfAdjointEigenSolver<Matrix9d> solver(normal_matrix);
  const Vector9d h = solver.eigenvectors().col(0);
  Eigen::Matrix3d matrix;
  matrix << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8];
  return matrix;
}

/// Direct linear transform over the chosen, normalized pairs.
Eigen::Matrix3d SolveHomography(const std::vector<PixelPair>& pairs, const std::vector<size_t>& chosen) {
  Matrix9d normal = Matrix9d::Zero();
  for (const size_t index : chosen) {
    const Eigen::Vector3d p = pairs[index].first_px.homogeneous();
    const Eigen::Vector2d& q = pairs[index].second_px;
    Vector9d row_1, row_2;
    row_1 << Eigen::Vector3d::Zero(), -p, q.y() * p;
    row_2 << p, Eigen::Vector3d::Zero(), -q.x() * p;
    normal += row_1 * row_1.transpose() + row_2 * row_2.transpose();
  }
  return NullMatrix(normal);
}

/// Eight-point algorithm over the chosen, normalized pairs, made singular.
Eigen::Matrix3d SolveFundamental(const std::vector<PixelPair>& pairs, const std::vector<size_t>& chosen) {
  Matrix9d normal = Matrix9d::Zero();
  for (const size_t index : chosen) {
    const Eigen::Vector3d p = pairs[index].first_px.homogeneous();
    const Eigen::Vector3d q = pairs[index].second_px.homogeneous();
    Vector9d row;
    row << q.x() * p, q.y() * p, p;
    normal += row * row.transpose();
  }
  Eigen::JacobiSVD<Eigen::Matrix3d> svd(NullMatrix(normal), Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d singular_values = svd.singularValues();
  singular_values[2] = 0;
  return svd.matrixU() * singular_values.asDiagonal() * svd.matrixV().transpose();
}

double SquaredLineDistance(const Eigen::Vector3d& line, const Eigen::Vector2d& pixel) {
  const double error = line.dot(pixel.homogeneous());
  return error * error / std::max(line.head<2>().squaredNorm(), 1e-18);
}

void ScoreHomography(const std::vector<PixelPair>& pairs, double inverse_variance, TwoViewModel* model) {
  const Eigen::Matrix3d inverse = model->matrix.inverse();
  model->score = 0;
  model->inlier.assign(pairs.size(), false);
  if (!inverse.allFinite()) return;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector2d forward = (model->matrix * pairs[i].first_px.homogeneous()).hnormalized();
    const Eigen::Vector2d backward = (inverse * pairs[i].second_px.homogeneous()).hnormalized();
    const double error_2 = (forward - pairs[i].second_px).squaredNorm() * inverse_variance;
    const double error_1 = (backward - pairs[i].first_px).squaredNorm() * inverse_variance;
    if (error_1 < kHomographyBound) model->score += kScoreBound - error_1;
    if (error_2 < kHomographyBound) model->score += kScoreBound - error_2;
    model->inlier[i] = error_1 < kHomographyBound && error_2 < kHomographyBound;
  }
}

void ScoreFundamental(const std::vector<PixelPair>& pairs, double inverse_variance, TwoViewModel* model) {
  model->score = 0;
  model->inlier.assign(pairs.size(), false);
  for (size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector3d line_2 = model->matrix * pairs[i].first_px.homogeneous();
    const Eigen::Vector3d line_1 = model->matrix.transpose() * pairs[i].second_px.homogeneous();
    const double error_2 = SquaredLineDistance(line_2, pairs[i].second_px) * inverse_variance;
    const double error_1 = SquaredLineDistance(line_1, pairs[i].first_px) * inverse_variance;
    if (error_1 < kFundamentalBound) model->score += kScoreBound - error_1;
    if (error_2 < kFundamentalBound) model->score += kScoreBound - error_2;
    model->inlier[i] = error_1 < kFundamentalBound && error_2 < kFundamentalBound;
  }
}

/// RANSAC over samples of eight, then fits to all inliers of the best model as long as they raise the score.
template <typename Solve, typename Denormalize, typename Score>
TwoViewModel Ransac(const std::vector<PixelPair>& pairs, int iterations, RandomEngine& random, Solve solve,
                    Denormalize denormalize, Score score) {
  TwoViewModel best;
  best.inlier.assign(pairs.size(), false);
  if (pairs.size() < kSampleSize) return best;
  const Eigen::Matrix3d normalize_1 = Normalization(pairs, &PixelPair::first_px);
  const Eigen::Matrix3d normalize_2 = Normalization(pairs, &PixelPair::second_px);
  std::vector<PixelPair> normalized(pairs.size());
  for (size_t i = 0; i < pairs.size(); ++i) {
    normalized[i].first_px = (normalize_1 * pairs[i].first_px.homogeneous()).head<2>();
    normalized[i].second_px = (normalize_2 * pairs[i].second_px.homogeneous()).head<2>();
  }
  const auto consider = [&](const std::vector<size_t>& chosen) {
    TwoViewModel candidate;
    candidate.matrix = denormalize(solve(normalized, chosen), normalize_1, normalize_2);
    if (!candidate.matrix.allFinite()) return;
    score(pairs, &candidate);
    if (candidate.score > best.score) best = std::move(candidate);
  };
  std::vector<size_t> order(pairs.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    for (size_t k = 0; k < kSampleSize; ++k) std::swap(order[k], order[k + random.Below(order.size() - k)]);
    consider({order.begin(), order.begin() + kSampleSize});
  }
  for (int round = 0; round < kRefits; ++round) {
    std::vector<size_t> inliers;
    for (size_t i = 0; i < pairs.size(); ++i) {
      if (best.inlier[i]) inliers.push_back(i);
    }
    const double score_before = best.score;
    if (inliers.size() >= kSampleSize) consider(inliers);
    if (best.score <= score_before) break;
  }
  return best;
}

}  // namespace

TwoViewModel EstimateHomography(const std::vector<PixelPair>& pairs, double sigma_px, int iterations,
                                RandomEngine& random) {
  const double inverse_variance = 1.0 / (sigma_px * sigma_px);
  return Ransac(
      pairs, iterations, random, SolveHomography,
      [](const Eigen::Matrix3d& h, const Eigen::Matrix3d& n1, const Eigen::Matrix3d& n2) -> Eigen::Matrix3d {
        return n2.inverse() * h * n1;
      },
      [&](const std::vector<PixelPair>& all, TwoViewModel* model) { ScoreHomography(all, inverse_variance, model); });
}

TwoViewModel EstimateFundamental(const std::vector<PixelPair>& pairs, double sigma_px, int iterations,
                                 RandomEngine& random) {
  const double inverse_variance = 1.0 / (sigma_px * sigma_px);
  return Ransac(
      pairs, iterations, random, SolveFundamental,
      [](const Eigen::Matrix3d& f, const Eigen::Matrix3d& n1, const Eigen::Matrix3d& n2) -> Eigen::Matrix3d {
        return n2.transpose() * f * n1;
      },
      [&](const std::vector<PixelPair>& all, TwoViewModel* model) { ScoreFundamental(all, inverse_variance, model); });
}

}  // namespace kinemap
