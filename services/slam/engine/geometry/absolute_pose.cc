// SPDX-License-Identifier: Apache-2.0
#include "geometry/absolute_pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

namespace kinemap {
namespace {

std::array<size_t, 3> DrawThree(size_t count, RandomEngine* random) {
  std::array<size_t, 3> drawn{};
  for (size_t i = 0; i < drawn.size(); ++i) {
    bool again = true;
    while (again) {
      drawn[i] = random->Below(count);
      again = false;
      for (size_t before = 0; before < i; ++before) again = again || drawn[before] == drawn[i];
    }
  }
  return drawn;
}

std::vector<RigidTransform> PosesOfThree(const std::vector<PointSight>& sights, const std::array<size_t, 3>& drawn,
                                         const CameraModel& camera) {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> rays;
  for (const size_t index : drawn) {
    const Eigen::Vector3d& point = sights[index].point_in_map;
    const Eigen::Vector3d ray = camera.Ray(sights[index].pixel_px);
    points.emplace_back(point.x(), point.y(), point.z());
    rays.emplace_back(ray.x() / ray.z(), ray.y() / ray.z());
  }
  std::vector<cv::Mat> rotations, translations;
  cv::solveP3P(points, rays, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), rotations, translations, cv::SOLVEPNP_AP3P);
  std::vector<RigidTransform> poses;
  for (size_t i = 0; i < rotations.size(); ++i) {
    Eigen::Vector3d turn, translation;
    cv::cv2eigen(rotations[i], turn);
    cv::cv2eigen(translations[i], translation);
    if (!turn.allFinite() || !translation.allFinite()) continue;
    const double angle = turn.norm();
    const Eigen::Vector3d axis = angle > 0 ? Eigen::Vector3d(turn / angle) : Eigen::Vector3d::UnitX();
    poses.emplace_back(Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)), translation);
  }
  return poses;
}

AbsolutePose Judge(const std::vector<PointSight>& sights, const RigidTransform& camera_from_map,
                   const CameraModel& camera) {
  AbsolutePose judged{camera_from_map, std::vector<bool>(sights.size(), false), 0};
  const Eigen::Matrix3d rotation = camera_from_map.rotation.toRotationMatrix();
  for (size_t i = 0; i < sights.size(); ++i) {
    const Eigen::Vector3d in_camera = rotation * sights[i].point_in_map + camera_from_map.translation;
    if (in_camera.z() <= 0) continue;
    const double squared = (camera.Project(in_camera) - sights[i].pixel_px).squaredNorm();
    if (squared > sights[i].max_error_px * sights[i].max_error_px) continue;
    judged.inlier[i] = true;
    ++judged.inliers;
  }
  return judged;
}

}  // namespace

std::optional<AbsolutePose> EstimateAbsolutePose(const std::vector<PointSight>& sights, const CameraModel& camera,
                                                 const AbsolutePoseOptions& options, RandomEngine* random) {
  if (sights.size() < 4) return std::nullopt;  // three points alone leave up to four poses
  AbsolutePose best;
  double iterations = options.iterations;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    for (const RigidTransform& pose : PosesOfThree(sights, DrawThree(sights.size(), random), camera)) {
      AbsolutePose judged = Judge(sights, pose, camera);
      if (judged.inliers > best.inliers) best = std::move(judged);
    }
    const double share = static_cast<double>(best.inliers) / static_cast<double>(sights.size());
    const double all_wrong = 1 - share * share * share;
    if (all_wrong < 1 - 1e-9) {
      iterations =
          std::min<double>(options.iterations, std::log(1 - options.confidence) / std::log(std::max(all_wrong, 1e-12)));
    }
  }
  if (best.inliers < options.least_inliers) return std::nullopt;
  return best;
}

}  // namespace kinemap
