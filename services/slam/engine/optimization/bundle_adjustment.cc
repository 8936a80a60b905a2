// SPDX-License-Identifier: Apache-2.0
#include "optimization/bundle_adjustment.h"

#include <ceres/iteration_callback.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "optimization/radial_projection.h"
#include "optimization/reprojection_cost.h"

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

/// One round of minimisation, over all observations that are no outliers.
class BundleSolver {
 public:
  BundleSolver(const CameraModel& camera, const BundleOptions& options, bool robust, BundleProblem* bundle)
      : camera_(camera),
        options_(options),
        robust_(robust),
        bundle_(*bundle),
        poses_(bundle->cameras.size() + 1),
        camera_used_(bundle->cameras.size(), false),
        point_used_(bundle->points.size(), false),
        problem_(ProblemOptions()) {
    for (size_t i = 0; i < bundle_.cameras.size(); ++i) WritePose(bundle_.cameras[i].camera_from_map, poses_[i].data());
    *right_shift_px_ = bundle_.right_shift_px;
    *radial_ = bundle_.radial;
    for (const BundleObservation& observation : bundle_.observations) {
      if (!observation.outlier) AddObservation(observation);
    }
    AddPriors();
  }

  void Solve(const std::atomic<bool>* cancelled) {
    if (free_cameras_ == 0) return;
    ceres::Solver::Options options;
    options.linear_solver_type = free_cameras_ > kMostDenseCameras ? ceres::SPARSE_SCHUR : ceres::DENSE_SCHUR;
    // Not SuiteSparse: its BLAS has threads of its own, with whose number the last bits would change.
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
    options.linear_solver_ordering = ordering_;
    options.max_num_iterations = robust_ ? options_.robust_iterations : options_.final_iterations;
    options.num_threads = 1;
    options.function_tolerance = options_.tolerance;
    options.logging_type = ceres::SILENT;
    StopWhenCancelled stop(cancelled);
    if (cancelled != nullptr) options.callbacks.push_back(&stop);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    if (robust_) bundle_.robust_cost = summary.IsSolutionUsable() ? summary.final_cost : std::nan("");
    bundle_.right_shift_px = *right_shift_px_;
    bundle_.radial = *radial_;
    for (size_t i = 0; i < bundle_.cameras.size(); ++i) {
      if (!bundle_.cameras[i].fixed) bundle_.cameras[i].camera_from_map = ReadPose(poses_[i].data());
    }
  }

 private:
  static ceres::Problem::Options ProblemOptions() {
    ceres::Problem::Options options;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.disable_all_safety_checks = true;
    return options;
  }

  bool CalibratesToo() const { return options_.radial_sigma > 0; }

  void AddObservation(const BundleObservation& observation) {
    double* pose = poses_[observation.camera].data();
    double* point = bundle_.points[observation.point].position_in_map.data();
    const double inverse_sigma = std::sqrt(observation.inverse_variance);
    if (std::isnan(observation.right_x_px)) {
      ceres::LossFunction* loss = robust_ ? &huber_ : nullptr;
      if (CalibratesToo()) {
        problem_.AddResidualBlock(new RadialReprojectionCost<2>(camera_, observation.pixel_px, inverse_sigma), loss,
                                  pose, point, radial_);
      } else {
        problem_.AddResidualBlock(new ReprojectionCost<2>(camera_, observation.pixel_px, inverse_sigma), loss, pose,
                                  point);
      }
    } else {
      ceres::LossFunction* loss = robust_ ? &stereo_huber_ : nullptr;
      const Eigen::Vector3d observed_px(observation.pixel_px.x(), observation.pixel_px.y(), observation.right_x_px);
      if (CalibratesToo()) {
        problem_.AddResidualBlock(new RadialReprojectionCost<3>(camera_, observed_px, inverse_sigma), loss, pose, point,
                                  radial_, right_shift_px_);
        shifts_right_image_ = true;
      } else {
        problem_.AddResidualBlock(new ReprojectionCost<3>(camera_, observed_px, inverse_sigma), loss, pose, point);
      }
    }
    UseCamera(observation.camera);
    if (point_used_[observation.point]) return;
    point_used_[observation.point] = true;
    ordering_->AddElementToGroup(point, 0);
  }

  void UseCamera(int camera) {
    if (camera_used_[camera]) return;
    camera_used_[camera] = true;
    double* pose = poses_[camera].data();
    problem_.SetManifold(pose, &manifold_);
    ordering_->AddElementToGroup(pose, 1);
    if (bundle_.cameras[camera].fixed) {
      problem_.SetParameterBlockConstant(pose);
    } else {
      ++free_cameras_;
    }
  }

  void AddPriors() {
    if (free_cameras_ == 0) return;
    if (CalibratesToo()) {
      problem_.AddResidualBlock(new ZeroPriorCost(options_.radial_sigma), nullptr, radial_);
      ordering_->AddElementToGroup(radial_, 1);
    }
    if (!shifts_right_image_) return;
    ordering_->AddElementToGroup(right_shift_px_, 1);
    if (options_.right_shift_sigma_px > 0 && !camera_.right_is_virtual()) {
      problem_.AddResidualBlock(new ZeroPriorCost(options_.right_shift_sigma_px), nullptr, right_shift_px_);
    } else {
      problem_.SetParameterBlockConstant(right_shift_px_);
    }
  }

  const CameraModel& camera_;
  const BundleOptions& options_;
  bool robust_;
  BundleProblem& bundle_;
  // Ceres eliminates in the order of addresses: one vector, so that they are the same in every run. The last block
  // holds what the calibration left.
  std::vector<PoseBlock> poses_;
  double* right_shift_px_ = &poses_.back()[0];
  double* radial_ = &poses_.back()[1];
  std::vector<bool> camera_used_, point_used_;
  int free_cameras_ = 0;
  bool shifts_right_image_ = false;
  PoseManifold manifold_;
  ceres::HuberLoss huber_{std::sqrt(kOutlierBound)}, stereo_huber_{std::sqrt(kStereoOutlierBound)};
  ceres::Problem problem_;  // after all that it points to
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering_ = std::make_shared<ceres::ParameterBlockOrdering>();
};

void MarkOutliers(const CameraModel& camera, BundleProblem* bundle) {
  for (BundleObservation& observation : bundle->observations) {
    const Eigen::Vector3d point =
        bundle->cameras[observation.camera].camera_from_map * bundle->points[observation.point].position_in_map;
    const bool stereo = !std::isnan(observation.right_x_px);
    double squared_px = (ProjectRadial(camera, bundle->radial, point) - observation.pixel_px).squaredNorm();
    if (stereo) {
      const double right_x_px = RightXRadial(camera, bundle->radial, point) + bundle->right_shift_px;
      squared_px += std::pow(right_x_px - observation.right_x_px, 2);
    }
    const double bound = stereo ? kStereoOutlierBound : kOutlierBound;
    observation.outlier = point.z() <= 0 || !(squared_px * observation.inverse_variance <= bound);
  }
}

}  // namespace

void SolveBundle(const CameraModel& camera, const BundleOptions& options, BundleProblem* problem,
                 const std::atomic<bool>* cancelled) {
  BundleSolver(camera, options, true, problem).Solve(cancelled);
  MarkOutliers(camera, problem);
  if (options.final_iterations == 0) return;
  BundleSolver(camera, options, false, problem).Solve(cancelled);
  MarkOutliers(camera, problem);
}

}  // namespace kinemap
