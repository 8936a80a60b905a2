// SPDX-License-Identifier: Apache-2.0
#include "optimization/bundle_adjustment.h"

#include <ceres/iteration_callback.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <array>
#include <cmath>
#include <memory>

#include "optimization/reprojection_cost.h"
#include "optimization/stereo_reprojection_cost.h"

namespace kinemap {
namespace {

constexpr double kOutlierBound = 5.991;        // 95 % of chi-squared, two degrees of freedom
constexpr double kStereoOutlierBound = 7.815;  // three

// A dense reduced system grows with the cube of the cameras; that of a whole map is mostly empty.
constexpr int kMostDenseCameras = 60;

using PoseBlock = std::array<double, kPoseSize>;

class StopWhenCancelled : public ceres::IterationCallback {
 public:
  explicit StopWhenCancelled(const std::atomic<bool>* cancelled) : cancelled_(cancelled) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return *cancelled_ ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }

 private:
  const std::atomic<bool>* cancelled_;
};

void Solve(const CameraModel& camera, const BundleOptions& bundle_options, bool robust,
           const std::atomic<bool>* cancelled, BundleProblem* bundle) {
  std::vector<PoseBlock> poses(bundle->cameras.size());
  for (size_t i = 0; i < poses.size(); ++i) WritePose(bundle->cameras[i].camera_from_map, poses[i].data());

  PoseManifold manifold;
  ceres::HuberLoss huber(std::sqrt(kOutlierBound)), stereo_huber(std::sqrt(kStereoOutlierBound));
  ceres::Problem::Options problem_options;
  problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.disable_all_safety_checks = true;
  ceres::Problem problem(problem_options);
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  std::vector<bool> camera_used(poses.size(), false), point_used(bundle->points.size(), false);
  int free_cameras = 0;
  bool has_right_image = false;
  for (const BundleObservation& observation : bundle->observations) {
    if (observation.outlier) continue;
    double* pose = poses[observation.camera].data();
    double* point = bundle->points[observation.point].position_in_map.data();
    const double inverse_sigma = std::sqrt(observation.inverse_variance);
    const bool stereo = !std::isnan(observation.right_x_px);
    ceres::LossFunction* loss = !robust ? nullptr : stereo ? &stereo_huber : &huber;
    if (stereo && bundle_options.radial_sigma > 0) {
      problem.AddResidualBlock(
          new RadialStereoReprojectionCost(camera, observation.pixel_px, observation.right_x_px, inverse_sigma), loss,
          pose, point, &bundle->radial, &bundle->right_shift_px);
      has_right_image = true;
    } else if (stereo) {
      problem.AddResidualBlock(
          new StereoReprojectionCost(camera, observation.pixel_px, observation.right_x_px, inverse_sigma), loss, pose,
          point);
    } else if (bundle_options.radial_sigma > 0) {
      problem.AddResidualBlock(new RadialReprojectionCost(camera, observation.pixel_px, inverse_sigma), loss, pose,
                               point, &bundle->radial);
    } else {
      problem.AddResidualBlock(new ReprojectionCost(camera, observation.pixel_px, inverse_sigma), loss, pose, point);
    }
    if (!camera_used[observation.camera]) {
      camera_used[observation.camera] = true;
      problem.SetManifold(pose, &manifold);
      ordering->AddElementToGroup(pose, 1);
      if (bundle->cameras[observation.camera].fixed) {
        problem.SetParameterBlockConstant(pose);
      } else {
        ++free_cameras;
      }
    }
    if (!point_used[observation.point]) {
      point_used[observation.point] = true;
      ordering->AddElementToGroup(point, 0);
    }
  }
  if (free_cameras == 0) return;
  if (bundle_options.radial_sigma > 0) {
    problem.AddResidualBlock(new ZeroPriorCost(bundle_options.radial_sigma), nullptr, &bundle->radial);
    ordering->AddElementToGroup(&bundle->radial, 1);
  }
  if (has_right_image) {
    ordering->AddElementToGroup(&bundle->right_shift_px, 1);
    if (bundle_options.right_shift_sigma_px > 0 && !camera.right_is_virtual()) {
      problem.AddResidualBlock(new ZeroPriorCost(bundle_options.right_shift_sigma_px), nullptr,
                               &bundle->right_shift_px);
    } else {
      problem.SetParameterBlockConstant(&bundle->right_shift_px);
    }
  }
  ceres::Solver::Options options;
  options.linear_solver_type = free_cameras > kMostDenseCameras ? ceres::SPARSE_SCHUR : ceres::DENSE_SCHUR;
  options.linear_solver_ordering = ordering;
  options.max_num_iterations = robust ? bundle_options.robust_iterations : bundle_options.final_iterations;
  options.num_threads = 1;
  options.function_tolerance = bundle_options.tolerance;
  options.logging_type = ceres::SILENT;
  StopWhenCancelled stop(cancelled);
  if (cancelled != nullptr) options.callbacks.push_back(&stop);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (robust) bundle->robust_cost = summary.final_cost;
  for (size_t i = 0; i < poses.size(); ++i) {
    if (!bundle->cameras[i].fixed) bundle->cameras[i].camera_from_map = ReadPose(poses[i].data());
  }
}

void MarkOutliers(const CameraModel& camera, BundleProblem* bundle) {
  for (BundleObservation& observation : bundle->observations) {
    const Eigen::Vector3d point =
        bundle->cameras[observation.camera].camera_from_map * bundle->points[observation.point].position_in_map;
    const bool stereo = !std::isnan(observation.right_x_px);
    double squared_px = (ProjectRadial(camera, bundle->radial, point) - observation.pixel_px).squaredNorm();
    if (stereo)
      squared_px +=
          std::pow(RightXRadial(camera, bundle->radial, point) + bundle->right_shift_px - observation.right_x_px, 2);
    const double bound = stereo ? kStereoOutlierBound : kOutlierBound;
    observation.outlier = point.z() <= 0 || !(squared_px * observation.inverse_variance <= bound);
  }
}

}  // namespace

void SolveBundle(const CameraModel& camera, const BundleOptions& options, BundleProblem* problem,
                 const std::atomic<bool>* cancelled) {
  Solve(camera, options, true, cancelled, problem);
  MarkOutliers(camera, problem);
  if (options.final_iterations == 0) return;
  Solve(camera, options, false, cancelled, problem);
  MarkOutliers(camera, problem);
}

}  // namespace kinemap
