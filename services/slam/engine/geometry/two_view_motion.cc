// SPDX-License-Identifier: Apache-2.0
#include "geometry/two_view_motion.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "geometry/triangulation.h"

namespace kinemap {
namespace {

// Rays closer than this (0.36 degrees) say nothing about depth; the sign of z is not held against them.
constexpr double kParallelCosine = 0.99998;
constexpr size_t kParallaxRank = 50;
constexpr double kErrorBound = 4.0;  // squared, in units of sigma

TwoViewMotion TestMotion(const RigidTransform& second_from_first, const TwoViewModel& model,
                         const std::vector<PixelPair>& pairs, const CameraModel& camera, double sigma_px) {
  TwoViewMotion motion;
  motion.second_from_first = second_from_first;
  motion.points_in_first.assign(pairs.size(), Eigen::Vector3d::Zero());
  motion.triangulated.assign(pairs.size(), false);
  const Eigen::Vector3d second_center = second_from_first.Inverse().translation;
  const double bound = kErrorBound * sigma_px * sigma_px;
  std::vector<double> cosines;
  for (size_t i = 0; i < pairs.size(); ++i) {
    if (!model.inlier[i]) continue;
    const Eigen::Vector3d point =
        TriangulateTwoRays(second_from_first, camera.Ray(pairs[i].first_px), camera.Ray(pairs[i].second_px));
    if (!point.allFinite()) continue;
    const Eigen::Vector3d in_second = second_from_first * point;
    const double cosine = ParallaxCosine(point, Eigen::Vector3d::Zero(), second_center);
    const bool has_parallax = cosine < kParallelCosine;
    if (has_parallax && (point.z() <= 0 || in_second.z() <= 0)) continue;
    if ((camera.Project(point) - pairs[i].first_px).squaredNorm() > bound) continue;
    if ((camera.Project(in_second) - pairs[i].second_px).squaredNorm() > bound) continue;
    ++motion.in_front;
    cosines.push_back(cosine);
    motion.points_in_first[i] = point;
    motion.triangulated[i] = has_parallax;
  }
  if (!cosines.empty()) {
    const size_t rank = std::min(kParallaxRank, cosines.size() - 1);
    std::nth_element(cosines.begin(), cosines.begin() + rank, cosines.end());
    motion.parallax_deg = std::acos(std::clamp(cosines[rank], -1.0, 1.0)) * 180.0 / M_PI;
  }
  return motion;
}

void SortBySupport(std::vector<TwoViewMotion>* motions) {
  std::stable_sort(motions->begin(), motions->end(),
                   [](const TwoViewMotion& a, const TwoViewMotion& b) { return a.in_front > b.in_front; });
}

}  // namespace

std::vector<TwoViewMotion> MotionsFromHomography(const TwoViewModel& model, const std::vector<PixelPair>& pairs,
                                                 const CameraModel& camera, double sigma_px) {
  cv::Mat homography, intrinsics;
  cv::eigen2cv(model.matrix, homography);
  cv::eigen2cv(camera.Intrinsics(), intrinsics);
  std::vector<cv::Mat> rotations, translations, normals;
  cv::decomposeHomographyMat(homography, intrinsics, rotations, translations, normals);
  std::vector<TwoViewMotion> motions;
  for (size_t i = 0; i < rotations.size(); ++i) {
    Eigen::Matrix3d rotation;
    Eigen::Vector3d translation;
    cv::cv2eigen(rotations[i], rotation);
    cv::cv2eigen(translations[i], translation);
    if (translation.norm() < 1e-9 || !rotation.allFinite()) continue;
    motions.push_back(
        TestMotion({Eigen::Quaterniond(rotation), translation.normalized()}, model, pairs, camera, sigma_px));
  }
  SortBySupport(&motions);
  return motions;
}

std::vector<TwoViewMotion> MotionsFromFundamental(const TwoViewModel& model, const std::vector<PixelPair>& pairs,
                                                  const CameraModel& camera, double sigma_px) {
  const Eigen::Matrix3d intrinsics = camera.Intrinsics();
  const Eigen::Matrix3d essential = intrinsics.transpose() * model.matrix * intrinsics;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(essential, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d quarter_turn;
  quarter_turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const Eigen::Vector3d translation = svd.matrixU().col(2).normalized();
  std::vector<TwoViewMotion> motions;
  for (const Eigen::Matrix3d& turn : {quarter_turn, Eigen::Matrix3d(quarter_turn.transpose())}) {
    Eigen::Matrix3d rotation = svd.matrixU() * turn * svd.matrixV().transpose();
    if (rotation.determinant() < 0) rotation = -rotation;
    for (const double sign : {1.0, -1.0}) {
      motions.push_back(TestMotion({Eigen::Quaterniond(rotation), sign * translation}, model, pairs, camera, sigma_px));
    }
  }
  SortBySupport(&motions);
  return motions;
}

}  // namespace kinemap
