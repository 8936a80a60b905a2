// SPDX-License-Identifier: Apache-2.0
#include "optimization/bundle_equations.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace kinemap {
namespace {

constexpr double kLeastDiagonal = 1e-6;  // so that what nothing was seen of stays where it is

template <typename Matrix>
auto DampedDiagonal(const Matrix& hessian, double damping) {
  return (damping * hessian.diagonal().cwiseMax(kLeastDiagonal)).eval();
}

}  // namespace

BundleState::BundleState(const BundleProblem& problem) : rest{problem.radial, problem.right_shift_px} {
  for (const BundleCamera& camera : problem.cameras) cameras_from_map.push_back(camera.camera_from_map);
  for (const BundlePoint& point : problem.points) points_in_map.push_back(point.position_in_map);
}

void BundleState::WriteTo(BundleProblem* problem) const {
  for (size_t i = 0; i < cameras_from_map.size(); ++i) problem->cameras[i].camera_from_map = cameras_from_map[i];
  for (size_t i = 0; i < points_in_map.size(); ++i) problem->points[i].position_in_map = points_in_map[i];
  problem->radial = rest.radial;
  problem->right_shift_px = rest.right_shift_px;
}

BundleEquations::BundleEquations(const CameraModel& camera, const BundleOptions& options, bool robust,
                                 const BundleProblem& problem)
    : camera_(camera),
      options_(options),
      problem_(problem),
      robust_(robust),
      calibrates_(options.radial_sigma > 0),
      block_of_camera_(problem.cameras.size(), -1) {
  NumberBlocks();
  GroupByPoint();
  if (options.velocity_change > 0) TakeVelocityChanges();
  CoupleBlocks();
}

void BundleEquations::NumberBlocks() {
  std::vector<bool> used(problem_.cameras.size(), false);
  bool has_right = false;
  for (const BundleObservation& observation : problem_.observations) {
    if (observation.outlier) continue;
    used[observation.camera] = true;
    has_right |= !std::isnan(observation.right_x_px);
  }
  for (size_t i = 0; i < used.size(); ++i) {
    if (used[i] && !problem_.cameras[i].fixed) block_of_camera_[i] = unknown_cameras_++;
  }
  finds_shift_ = calibrates_ && has_right && options_.right_shift_sigma_px > 0 && !camera_.right_is_virtual();
  blocks_.resize(unknown_cameras_ + (calibrates_ ? 1 : 0));
}

void BundleEquations::GroupByPoint() {
  points_.resize(problem_.points.size());
  std::vector<int> begins(points_.size() + 1, 0);
  for (const BundleObservation& observation : problem_.observations) {
    if (!observation.outlier) ++begins[observation.point + 1];
  }
  for (size_t i = 0; i < points_.size(); ++i) {
    begins[i + 1] += begins[i];
    points_[i].first_term = points_[i].end_term = begins[i];
  }
  terms_.resize(begins.back());
  couplings_.resize(terms_.size());
  for (size_t i = 0; i < problem_.observations.size(); ++i) {
    const BundleObservation& observation = problem_.observations[i];
    if (observation.outlier) continue;
    terms_[points_[observation.point].end_term++] = {static_cast<int>(i), block_of_camera_[observation.camera]};
  }
  for (const PointEquations& point : points_) {
    std::sort(terms_.begin() + point.first_term, terms_.begin() + point.end_term, [](const Term& a, const Term& b) {
      return a.block != b.block ? a.block < b.block : a.observation < b.observation;
    });
  }
}

void BundleEquations::CoupleBlocks() {
  reduced_ = ReducedCameraSystem(static_cast<int>(blocks_.size()));
  for (const PointEquations& point : points_) {
    for (int i = point.first_term; i < point.end_term; ++i) {
      if (terms_[i].block < 0) continue;
      for (int j = i; j < point.end_term; ++j) reduced_.Couple(terms_[i].block, terms_[j].block);
    }
  }
  for (const VelocityTerm& term : velocity_terms_) {
    for (const int a : term.blocks) {
      for (const int b : term.blocks) {
        if (a >= 0 && a < b) reduced_.Couple(a, b);
      }
    }
  }
  if (!calibrates_) return;
  for (int i = 0; i < unknown_cameras_; ++i) reduced_.Couple(i, unknown_cameras_);
}

void BundleEquations::TakeVelocityChanges() {
  std::vector<bool> used(problem_.cameras.size(), false);
  for (const Term& term : terms_) used[problem_.observations[term.observation].camera] = true;
  for (const VelocityChange& change : problem_.velocity_changes) {
    if (!used[change.first] || !used[change.second] || !used[change.third]) continue;
    const std::array<int, 3> blocks{block_of_camera_[change.first], block_of_camera_[change.second],
                                    block_of_camera_[change.third]};
    if (*std::max_element(blocks.begin(), blocks.end()) < 0) continue;
    VelocityTerm& term = velocity_terms_.emplace_back();
    term.change = change;
    term.blocks = blocks;
  }
}

void BundleEquations::AddBetweenCameras(const VelocityTerm& term) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const int a = term.blocks[i], b = term.blocks[j];
      if (a < 0 || a >= b) continue;
      reduced_.Block(a, b).noalias() += term.weight * term.by_pose[i].transpose() * term.by_pose[j];
    }
  }
}

bool BundleEquations::Solve(double damping, BundleStep* step) {
  reduced_.SetZero();
  for (int i = 0; i < reduced_.size(); ++i) {
    Matrix6d& block = reduced_.Block(i, i);
    block = blocks_[i].hessian;
    block.diagonal() += DampedDiagonal(blocks_[i].hessian, damping);
    reduced_.Right(i) = -blocks_[i].gradient;
    if (calibrates_ && i < unknown_cameras_) reduced_.Block(i, unknown_cameras_) = blocks_[i].with_rest;
  }
  for (const VelocityTerm& term : velocity_terms_) AddBetweenCameras(term);
  for (PointEquations& point : points_) Eliminate(damping, &point);
  if (!reduced_.Solve(&step->blocks)) return false;
  step->expected_decrease = SubstituteBack(damping, step);
  return std::isfinite(step->expected_decrease);
}

void BundleEquations::Eliminate(double damping, PointEquations* point) {
  if (point->first_term == point->end_term) return;
  Eigen::Matrix3d damped = point->hessian;
  damped.diagonal() += DampedDiagonal(point->hessian, damping);
  point->inverse = damped.inverse();
  for (int i = point->first_term; i < point->end_term; ++i) {
    const int block = terms_[i].block;
    if (block < 0) continue;
    const Coupling solved = couplings_[i] * point->inverse;
    reduced_.Right(block) += solved * point->gradient;
    for (int j = i; j < point->end_term; ++j) {
      reduced_.Block(block, terms_[j].block).noalias() -= solved * couplings_[j].transpose();
    }
    if (calibrates_) reduced_.Block(block, unknown_cameras_).noalias() -= solved * point->with_rest.transpose();
  }
  if (!calibrates_) return;
  const Coupling solved = point->with_rest * point->inverse;
  reduced_.Right(unknown_cameras_) += solved * point->gradient;
  reduced_.Block(unknown_cameras_, unknown_cameras_).noalias() -= solved * point->with_rest.transpose();
}

double BundleEquations::SubstituteBack(double damping, BundleStep* step) const {
  double decrease = 0;
  const auto expect = [&](const auto& equations, const auto& moved) {
    decrease += moved.dot(DampedDiagonal(equations.hessian, damping).cwiseProduct(moved) - equations.gradient);
  };
  for (size_t i = 0; i < blocks_.size(); ++i) expect(blocks_[i], step->blocks[i]);
  step->points.assign(points_.size(), Eigen::Vector3d::Zero());
  for (size_t i = 0; i < points_.size(); ++i) {
    const PointEquations& point = points_[i];
    if (point.first_term == point.end_term) continue;
    Eigen::Vector3d right = point.gradient;
    for (int term = point.first_term; term < point.end_term; ++term) {
      if (terms_[term].block >= 0) right += couplings_[term].transpose() * step->blocks[terms_[term].block];
    }
    if (calibrates_) right += point.with_rest.transpose() * step->blocks[unknown_cameras_];
    step->points[i] = -(point.inverse * right);
    expect(point, step->points[i]);
  }
  return 0.5 * decrease;
}

}  // namespace kinemap
