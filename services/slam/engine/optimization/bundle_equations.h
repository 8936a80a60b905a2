// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "optimization/bundle_adjustment.h"
#include "optimization/reduced_camera_system.h"
#include "optimization/reprojection.h"

namespace kinemap {

/// What a bundle adjustment moves.
struct BundleState {
  explicit BundleState(const BundleProblem& problem);
  void WriteTo(BundleProblem* problem) const;

  std::vector<RigidTransform> cameras_from_map;
  std::vector<Eigen::Vector3d> points_in_map;
  CalibrationRest rest;
};

struct BundleStep {
  std::vector<Vector6d> blocks;  ///< of the cameras that move, then of what calibration left
  std::vector<Eigen::Vector3d> points;
  double expected_decrease;  ///< of the cost, by the linear model
};

/// The normal equations of a bundle adjustment over the observations that are no outliers, solved for a damped step
/// (Levenberg and Marquardt) by eliminating the points. Huber's loss is taken by reweighting: at an error e beyond the
/// bound b, an observation weighs b / e.
class BundleEquations {
 public:
  /// The problem must outlive this; which observations are outliers is read once.
  BundleEquations(const CameraModel& camera, const BundleOptions& options, bool robust, const BundleProblem& problem);

  bool HasUnknownCameras() const { return unknown_cameras_ > 0; }

  /// Half the sum of all losses and priors.
  double Cost(const BundleState& state) const;

  /// Builds the equations at a state. Returns Cost(state).
  double Linearize(const BundleState& state);

  /// The step at a damping, relative to the diagonal. False where the equations cannot be solved.
  bool Solve(double damping, BundleStep* step);

  BundleState Moved(const BundleState& state, const BundleStep& step) const;

 private:
  using Coupling = Eigen::Matrix<double, 6, 3>;
  struct Term {
    int observation;  ///< index in the problem
    int block;        ///< of its camera; -1: it is fixed
  };
  struct PointEquations {
    int first_term, end_term;
    Eigen::Matrix3d hessian, inverse;
    Eigen::Vector3d gradient;
    Coupling with_rest;
  };
  struct BlockEquations {
    Matrix6d hessian, with_rest;
    Vector6d gradient;
  };

  struct VelocityTerm {
    VelocityChange change;
    std::array<int, 3> blocks;  ///< of its cameras, -1: fixed
    double weight = 0;          ///< at the state linearized at
    std::array<Eigen::Matrix<double, 3, 6>, 3> by_pose;
  };

  void NumberBlocks();
  void GroupByPoint();
  void CoupleBlocks();
  const CalibrationRest* RestOf(const BundleState& state) const { return calibrates_ ? &state.rest : nullptr; }
  double RestCost(const CalibrationRest& rest) const;
  template <int kRows>
  double Add(const BundleState& state, const CameraPose& pose, int term, PointEquations* point);
  void AddRestPriors(const CalibrationRest& rest);
  void TakeVelocityChanges();
  double Add(const BundleState& state, VelocityTerm* term);
  void AddBetweenCameras(const VelocityTerm& term);
  void Eliminate(double damping, PointEquations* point);
  double SubstituteBack(double damping, BundleStep* step) const;

  const CameraModel& camera_;
  const BundleOptions& options_;
  const BundleProblem& problem_;
  bool robust_, calibrates_, finds_shift_ = false;
  int unknown_cameras_ = 0;
  std::vector<int> block_of_camera_;
  std::vector<Term> terms_;             // point by point, of each in the order of blocks
  std::vector<Coupling> couplings_;     // of each term's camera with its point
  std::vector<PointEquations> points_;  // with observations or without
  std::vector<BlockEquations> blocks_;  // the cameras that move, then, where it is found, what calibration left
  std::vector<VelocityTerm> velocity_terms_;
  ReducedCameraSystem reduced_{0};
};

}  // namespace kinemap
