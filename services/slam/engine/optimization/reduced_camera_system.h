// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "geometry/rigid_transform.h"

namespace kinemap {

/// The linear system that is left of a bundle adjustment's normal equations once the points are eliminated (Triggs et
/// al., "Bundle adjustment: a modern synthesis", 2000, section 6): symmetric, positive definite, of blocks of six
/// unknowns. Only blocks (a, b) with a <= b that were coupled exist; the diagonal ones always do.
class ReducedCameraSystem {
 public:
  explicit ReducedCameraSystem(int size);

  int size() const { return size_; }

  /// Makes room for block (a, b), a <= b.
  void Couple(int a, int b);

  void SetZero();
  /// Block (a, b), a <= b, which must have been coupled.
  Matrix6d& Block(int a, int b) { return blocks_[number_[a * size_ + b]]; }
  Vector6d& Right(int a) { return right_[a]; }

  /// False where the matrix is not positive definite. Dense for few blocks, sparse for many; on one thread. No block
  /// may be coupled after the first call.
  bool Solve(std::vector<Vector6d>* solution);

 private:
  Eigen::VectorXd StackedRight() const;
  bool SolveDense(Eigen::VectorXd* stacked) const;
  bool SolveSparse(Eigen::VectorXd* stacked);
  void LayOut();

  /// What only the places of blocks decide.
  struct SparseLayout {
    Eigen::SparseMatrix<double> upper;
    std::vector<std::array<int, 6>> starts;  ///< of the columns of each block among the values of `upper`
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Upper> factor;
  };

  int size_;
  std::vector<int> number_;                 // of block (a, b) at a * size + b; -1: there is none
  std::vector<std::pair<int, int>> place_;  // of the block of this number
  std::vector<Matrix6d> blocks_;
  std::vector<Vector6d> right_;
  std::unique_ptr<SparseLayout> sparse_;
};

}  // namespace kinemap
