// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "geometry/similarity_transform.h"

namespace kinemap {

/// The target_from_source that brings `source` nearest to `target`, point by point, in the sense of least squares
/// (Umeyama 1991, eq. 40 to 42). With `fixed_scale` lengths stay what they are. Nothing for fewer than three points or
/// points on a line, which leave a turn open.
std::optional<SimilarityTransform> AlignPoints(const std::vector<Eigen::Vector3d>& source,
                                               const std::vector<Eigen::Vector3d>& target, bool fixed_scale);

}  // namespace kinemap
