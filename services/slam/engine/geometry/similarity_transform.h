// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/rigid_transform.h"

namespace kinemap {

/// A Sim(3), named target_from_source: point_target = scale * rotation * point_source + translation.
struct SimilarityTransform {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  double scale = 1;

  SimilarityTransform() = default;
  SimilarityTransform(const Eigen::Quaterniond& rotation_in, const Eigen::Vector3d& translation_in, double scale_in)
      : rotation(rotation_in.normalized()), translation(translation_in), scale(scale_in) {}
  explicit SimilarityTransform(const RigidTransform& rigid, double scale_in = 1)
      : SimilarityTransform(rigid.rotation, rigid.translation, scale_in) {}

  SimilarityTransform Inverse() const {
    const Eigen::Quaterniond inverse = rotation.conjugate();
    return {inverse, -(inverse * translation) / scale, 1 / scale};
  }

  /// The same place and direction, lengths in the target's units.
  RigidTransform WithoutScale() const { return {rotation, translation}; }

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return scale * (rotation * point) + translation; }
  SimilarityTransform operator*(const SimilarityTransform& other) const {
    return {rotation * other.rotation, scale * (rotation * other.translation) + translation, scale * other.scale};
  }
};

}  // namespace kinemap
