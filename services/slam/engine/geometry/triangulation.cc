// SPDX-License-Identifier: Apache-2.0
#include "geometry/triangulation.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace kinemap {

Eigen::Vector3d TriangulateTwoRays(const RigidTransform& second_from_first, const Eigen::Vector3d& ray_1,
                                   const Eigen::Vector3d& ray_2) {
  const Eigen::Matrix3d rotation = second_from_first.rotation.toRotationMatrix();
  const Eigen::Vector3d& translation = second_from_first.translation;
  Eigen::Matrix4d design;
  design.row(0) << -1, 0, ray_1.x(), 0;
  design.row(1) << 0, -1, ray_1.y(), 0;
  for (int axis = 0; axis < 2; ++axis) {
    design.row(2 + axis).head<3>() = ray_2[axis] * rotation.row(2) - rotation.row(axis);
    design(2 + axis, 3) = ray_2[axis] * translation.z() - translation[axis];
  }
  // The null vector of a 4x4 matrix as the weakest eigenvector of its normal matrix: a fifth of an SVD's time.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(design.transpose() * design);
  const Eigen::Vector4d solution = solver.eigenvectors().col(0);
  return solution.head<3>() / solution.w();
}

double ParallaxCosine(const Eigen::Vector3d& point, const Eigen::Vector3d& center_1, const Eigen::Vector3d& center_2) {
  return (point - center_1).normalized().dot((point - center_2).normalized());
}

Eigen::Matrix3d FundamentalFromMotion(const RigidTransform& second_from_first, const Eigen::Matrix3d& intrinsics) {
  const Eigen::Matrix3d inverse = intrinsics.inverse();
  return inverse.transpose() * CrossMatrix(second_from_first.translation) *
         second_from_first.rotation.toRotationMatrix() * inverse;
}

}  // namespace kinemap
