// SPDX-License-Identifier: Apache-2.0
#include "optimization/reduced_camera_system.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>

namespace kinemap {
namespace {

// Dense work grows with the cube of the blocks; the system of a whole map is mostly empty.
constexpr int kMostDenseBlocks = 80;

}  // namespace

ReducedCameraSystem::ReducedCameraSystem(int size)
    : size_(size), number_(static_cast<size_t>(size) * size, -1), right_(size) {
  for (int i = 0; i < size; ++i) Couple(i, i);
}

void ReducedCameraSystem::Couple(int a, int b) {
  int& number = number_[a * size_ + b];
  if (number >= 0) return;
  number = static_cast<int>(blocks_.size());
  place_.emplace_back(a, b);
  blocks_.emplace_back();
}

void ReducedCameraSystem::SetZero() {
  for (Matrix6d& block : blocks_) block.setZero();
  for (Vector6d& right : right_) right.setZero();
}

bool ReducedCameraSystem::Solve(std::vector<Vector6d>* solution) const {
  Eigen::VectorXd stacked = StackedRight();
  if (!(size_ > kMostDenseBlocks ? SolveSparse(&stacked) : SolveDense(&stacked))) return false;
  solution->resize(size_);
  for (int i = 0; i < size_; ++i) (*solution)[i] = stacked.segment<6>(6 * i);
  return stacked.allFinite();
}

Eigen::VectorXd ReducedCameraSystem::StackedRight() const {
  Eigen::VectorXd stacked(6 * size_);
  for (int i = 0; i < size_; ++i) stacked.segment<6>(6 * i) = right_[i];
  return stacked;
}

bool ReducedCameraSystem::SolveDense(Eigen::VectorXd* stacked) const {
  Eigen::MatrixXd upper = Eigen::MatrixXd::Zero(6 * size_, 6 * size_);
  for (size_t i = 0; i < blocks_.size(); ++i) {
    upper.block<6, 6>(6 * place_[i].first, 6 * place_[i].second) = blocks_[i];
  }
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>, Eigen::Upper> factor(upper);
  if (factor.info() != Eigen::Success) return false;
  factor.solveInPlace(*stacked);
  return true;
}

bool ReducedCameraSystem::SolveSparse(Eigen::VectorXd* stacked) const {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(36 * blocks_.size());
  for (size_t i = 0; i < blocks_.size(); ++i) {
    const auto [a, b] = place_[i];
    for (int column = 0; column < 6; ++column) {
      for (int row = 0; row < (a == b ? column + 1 : 6); ++row) {
        entries.emplace_back(6 * a + row, 6 * b + column, blocks_[i](row, column));
      }
    }
  }
  Eigen::SparseMatrix<double> upper(6 * size_, 6 * size_);
  upper.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Upper> factor(upper);
  if (factor.info() != Eigen::Success) return false;
  *stacked = factor.solve(*stacked);
  return true;
}

}  // namespace kinemap
