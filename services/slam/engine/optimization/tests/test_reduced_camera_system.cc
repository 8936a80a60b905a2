// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "optimization/reduced_camera_system.h"

namespace kinemap {
namespace {

/// Neighbours in a ring are coupled. Returns the largest error of the solution.
double SolvedError(int size) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-1, 1);
  ReducedCameraSystem system(size);
  for (int i = 0; i < size; ++i) system.Couple(std::min(i, (i + 1) % size), std::max(i, (i + 1) % size));
  system.SetZero();
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(6 * size, 6 * size);
  for (int i = 0; i < size; ++i) {
    const int a = std::min(i, (i + 1) % size), b = std::max(i, (i + 1) % size);
    const Matrix6d beside = Matrix6d::NullaryExpr([&] { return number(random); });
    system.Block(i, i) = 20 * Matrix6d::Identity();
    system.Block(a, b) = beside;
    whole.block<6, 6>(6 * i, 6 * i) = 20 * Matrix6d::Identity();
    whole.block<6, 6>(6 * a, 6 * b) = beside;
    whole.block<6, 6>(6 * b, 6 * a) = beside.transpose();
  }
  const Eigen::VectorXd truth = Eigen::VectorXd::NullaryExpr(6 * size, [&] { return number(random); });
  const Eigen::VectorXd right = whole * truth;
  for (int i = 0; i < size; ++i) system.Right(i) = right.segment<6>(6 * i);
  std::vector<Vector6d> solution;
  if (!system.Solve(&solution)) return INFINITY;
  double error = 0;
  for (int i = 0; i < size; ++i) error = std::max(error, (solution[i] - truth.segment<6>(6 * i)).norm());
  return error;
}

TEST(ReducedCameraSystem, IsSolvedDenseAndSparse) {
  EXPECT_LT(SolvedError(8), 1e-12);
  EXPECT_LT(SolvedError(90), 1e-12);
}

TEST(ReducedCameraSystem, SaysWhenItIsNotPositiveDefinite) {
  for (const int size : {2, 90}) {
    ReducedCameraSystem system(size);
    system.SetZero();
    for (int i = 0; i < size; ++i) system.Block(i, i).setIdentity();
    system.Block(1, 1)(2, 2) = -1;
    std::vector<Vector6d> solution;
    EXPECT_FALSE(system.Solve(&solution)) << size << " blocks";
  }
}

}  // namespace
}  // namespace kinemap
