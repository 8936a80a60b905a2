// SPDX-License-Identifier: Apache-2.0
#include "optimization/reduced_camera_system.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace kinemap {
namespace {

// Dense work grows with the cube of the blocks; the system of a whole map is mostly empty.
constexpr int kMostDenseBlocks = 80;

/// Of a block's column, how many rows lie on or above the whole matrix's diagonal.
int RowsAbove(int a, int b, int column) { return a == b ? column + 1 : 6; }

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

bool ReducedCameraSystem::Solve(std::vector<Vector6d>* solution) {
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

void ReducedCameraSystem::LayOut() {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(36 * blocks_.size());
  for (const auto& [a, b] : place_) {
    for (int column = 0; column < 6; ++column) {
      for (int row = 0; row < RowsAbove(a, b, column); ++row) entries.emplace_back(6 * a + row, 6 * b + column, 0);
    }
  }
  sparse_ = std::make_unique<SparseLayout>();
  sparse_->upper.resize(6 * size_, 6 * size_);
  sparse_->upper.setFromTriplets(entries.begin(), entries.end());
  const int* begins = sparse_->upper.outerIndexPtr();
  const int* rows = sparse_->upper.innerIndexPtr();
  for (const auto& [a, b] : place_) {
    std::array<int, 6>& starts = sparse_->starts.emplace_back();
    for (int column = 0; column < 6; ++column) {
      const int j = 6 * b + column;
      starts[column] = static_cast<int>(std::lower_bound(rows + begins[j], rows + begins[j + 1], 6 * a) - rows);
    }
  }
  sparse_->factor.analyzePattern(sparse_->upper);
}

bool ReducedCameraSystem::SolveSparse(Eigen::VectorXd* stacked) {
  if (sparse_ == nullptr) LayOut();
  double* values = sparse_->upper.valuePtr();
  for (size_t i = 0; i < blocks_.size(); ++i) {
    for (int column = 0; column < 6; ++column) {
      const double* above = blocks_[i].col(column).data();
      std::copy_n(above, RowsAbove(place_[i].first, place_[i].second, column), values + sparse_->starts[i][column]);
    }
  }
  sparse_->factor.factorize(sparse_->upper);
  if (sparse_->factor.info() != Eigen::Success) return false;
  *stacked = sparse_->factor.solve(*stacked);
  return true;
}

}  // namespace kinemap
