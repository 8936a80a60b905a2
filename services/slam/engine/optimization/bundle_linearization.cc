// SPDX-License-Identifier: Apache-2.0
// The errors of a bundle adjustment and their derivatives.
#include <cmath>

#include "optimization/bundle_equations.h"
#include "optimization/relative_velocity_change.h"

namespace kinemap {
namespace {

constexpr double kVelocityBound = 3.841;  // of the squared change in variances, beyond which it is a jolt

struct Weighed {
  double cost;
  double weight;  ///< of the squared error, 1 / px^2
};

// Huber's loss by reweighting, of the error in standard deviations.
Weighed Weigh(double squared_px, double inverse_variance, double squared_bound, bool robust) {
  const double squared = squared_px * inverse_variance;
  if (!robust || squared <= squared_bound) return {0.5 * squared, inverse_variance};
  const double bound = std::sqrt(squared_bound), error = std::sqrt(squared);
  return {bound * error - 0.5 * squared_bound, inverse_variance * bound / error};
}

template <int kRows>
ObservedPixels<kRows> PixelsOf(const BundleObservation& observation) {
  ObservedPixels<kRows> pixels;
  pixels.template head<2>() = observation.pixel_px;
  if constexpr (kRows == 3) pixels[2] = observation.right_x_px;
  return pixels;
}

RelativeVelocityChange ChangeOf(const VelocityChange& change, const BundleState& state) {
  return {{state.cameras_from_map[change.first], state.cameras_from_map[change.second],
           state.cameras_from_map[change.third]},
          change.earlier_s,
          change.later_s};
}

std::vector<CameraPose> PosesOf(const BundleState& state) {
  return {state.cameras_from_map.begin(), state.cameras_from_map.end()};
}

}  // namespace

double BundleEquations::Cost(const BundleState& state) const {
  const std::vector<CameraPose> poses = PosesOf(state);
  double cost = calibrates_ ? RestCost(state.rest) : 0;
  const auto add = [&]<int kRows>(const BundleObservation& observation, std::integral_constant<int, kRows>) {
    const Eigen::Vector3d in_camera = poses[observation.camera].InFront(state.points_in_map[observation.point]);
    const ObservedPixels<kRows> error =
        Reproject<kRows>(camera_, RestOf(state), in_camera) - PixelsOf<kRows>(observation);
    cost += Weigh(error.squaredNorm(), observation.inverse_variance, kOutlierBound<kRows>, robust_).cost;
  };
  for (const VelocityTerm& term : velocity_terms_) {
    const double sigma = options_.velocity_change * term.change.sigma;
    const double squared = ChangeOf(term.change, state).change.squaredNorm();
    cost += Weigh(squared, 1 / (sigma * sigma), kVelocityBound, true).cost;
  }
  for (const Term& term : terms_) {
    const BundleObservation& observation = problem_.observations[term.observation];
    if (std::isnan(observation.right_x_px)) {
      add(observation, std::integral_constant<int, 2>());
    } else {
      add(observation, std::integral_constant<int, 3>());
    }
  }
  return cost;
}

double BundleEquations::Linearize(const BundleState& state) {
  const std::vector<CameraPose> poses = PosesOf(state);
  for (BlockEquations& block : blocks_) {
    block.hessian.setZero();
    block.with_rest.setZero();
    block.gradient.setZero();
  }
  double cost = 0;
  for (VelocityTerm& term : velocity_terms_) cost += Add(state, &term);
  for (PointEquations& point : points_) {
    point.hessian.setZero();
    point.gradient.setZero();
    if (calibrates_) point.with_rest.setZero();
    for (int i = point.first_term; i < point.end_term; ++i) {
      const BundleObservation& observation = problem_.observations[terms_[i].observation];
      const CameraPose& pose = poses[observation.camera];
      cost += std::isnan(observation.right_x_px) ? Add<2>(state, pose, i, &point) : Add<3>(state, pose, i, &point);
    }
  }
  if (!calibrates_) return cost;
  AddRestPriors(state.rest);
  return cost + RestCost(state.rest);
}

template <int kRows>
double BundleEquations::Add(const BundleState& state, const CameraPose& pose, int term, PointEquations* point) {
  const BundleObservation& observation = problem_.observations[terms_[term].observation];
  const Eigen::Vector3d in_camera = pose.InFront(state.points_in_map[observation.point]);
  const ObservedPixels<kRows> error =
      Reproject<kRows>(camera_, RestOf(state), in_camera) - PixelsOf<kRows>(observation);
  const Weighed weighed = Weigh(error.squaredNorm(), observation.inverse_variance, kOutlierBound<kRows>, robust_);
  ReprojectionJacobians<kRows> by(camera_, RestOf(state), pose, in_camera);
  const Eigen::Matrix<double, kRows, 3> weighed_by_point = weighed.weight * by.by_point;
  point->hessian.noalias() += by.by_point.transpose() * weighed_by_point;
  point->gradient.noalias() += weighed_by_point.transpose() * error;
  const int block = terms_[term].block;
  const Eigen::Matrix<double, kRows, 6> weighed_by_pose = weighed.weight * by.by_pose;
  if (block >= 0) {
    couplings_[term].noalias() = by.by_pose.transpose() * weighed_by_point;
    blocks_[block].hessian.noalias() += by.by_pose.transpose() * weighed_by_pose;
    blocks_[block].gradient.noalias() += weighed_by_pose.transpose() * error;
  }
  if (!calibrates_) return weighed.cost;
  if (!finds_shift_) by.by_rest.col(1).setZero();
  BlockEquations& rest = blocks_.back();
  point->with_rest.template topRows<2>().noalias() += by.by_rest.transpose() * weighed_by_point;
  rest.hessian.template topLeftCorner<2, 2>().noalias() += weighed.weight * by.by_rest.transpose() * by.by_rest;
  rest.gradient.template head<2>().noalias() += weighed.weight * by.by_rest.transpose() * error;
  if (block >= 0) blocks_[block].with_rest.template leftCols<2>().noalias() += weighed_by_pose.transpose() * by.by_rest;
  return weighed.cost;
}

double BundleEquations::Add(const BundleState& state, VelocityTerm* term) {
  const RelativeVelocityChange velocity = ChangeOf(term->change, state);
  const double sigma = options_.velocity_change * term->change.sigma;
  const Weighed weighed = Weigh(velocity.change.squaredNorm(), 1 / (sigma * sigma), kVelocityBound, true);
  term->weight = weighed.weight;
  term->by_pose = velocity.by_pose;
  for (int i = 0; i < 3; ++i) {
    if (term->blocks[i] < 0) continue;
    BlockEquations& block = blocks_[term->blocks[i]];
    block.hessian.noalias() += term->weight * velocity.by_pose[i].transpose() * velocity.by_pose[i];
    block.gradient.noalias() += term->weight * velocity.by_pose[i].transpose() * velocity.change;
  }
  return weighed.cost;
}

double BundleEquations::RestCost(const CalibrationRest& rest) const {
  double cost = 0.5 * std::pow(rest.radial / options_.radial_sigma, 2);
  if (finds_shift_) cost += 0.5 * std::pow(rest.right_shift_px / options_.right_shift_sigma_px, 2);
  return cost;
}

void BundleEquations::AddRestPriors(const CalibrationRest& rest) {
  BlockEquations& block = blocks_.back();
  const auto add = [&block](int index, double value, double sigma) {
    block.hessian(index, index) += 1 / (sigma * sigma);
    block.gradient[index] += value / (sigma * sigma);
  };
  add(0, rest.radial, options_.radial_sigma);
  if (finds_shift_) add(1, rest.right_shift_px, options_.right_shift_sigma_px);
  // The block's other unknowns stand for nothing.
  block.hessian.diagonal().tail(finds_shift_ ? 4 : 5).setOnes();
}

BundleState BundleEquations::Moved(const BundleState& state, const BundleStep& step) const {
  BundleState moved = state;
  for (size_t i = 0; i < block_of_camera_.size(); ++i) {
    if (block_of_camera_[i] < 0) continue;
    moved.cameras_from_map[i] = moved.cameras_from_map[i].PerturbedInTarget(step.blocks[block_of_camera_[i]]);
  }
  for (size_t i = 0; i < step.points.size(); ++i) moved.points_in_map[i] += step.points[i];
  if (!calibrates_) return moved;
  moved.rest.radial += step.blocks.back()[0];
  if (finds_shift_) moved.rest.right_shift_px += step.blocks.back()[1];
  return moved;
}

}  // namespace kinemap
