// SPDX-License-Identifier: Apache-2.0
#include "semi_dense/inter_keyframe_check.h"

#include <Eigen/Core>
#include <cmath>
#include <optional>

namespace kinemap {
namespace {

// Another keyframe as the pixels of this one fall into it.
struct Projection {
  Eigen::Matrix3f homography;  // of points at infinity
  Eigen::Vector3f epipole;     // what inverse depth 1 moves them by
  float scale;                 // units of the own anchor in one of the other's
  const InverseDepthImage* estimates;

  Projection(const Eigen::Matrix3d& intrinsics, const OtherEstimates& other)
      : homography(
            (intrinsics * other.other_from_own.rotation.toRotationMatrix() * intrinsics.inverse()).cast<float>()),
        epipole((intrinsics * other.other_from_own.translation / other.other_from_own.scale).cast<float>()),
        scale(static_cast<float>(other.other_from_own.scale)),
        estimates(other.estimates) {}

  /// The other keyframe's estimate of this pixel, in the own keyframe's terms; of the four pixels around its place the
  /// one that agrees best.
  std::optional<InverseDepth> Confirm(const cv::Point& pixel, const InverseDepth& own) const {
    const Eigen::Vector3f far =
        homography * Eigen::Vector3f(static_cast<float>(pixel.x), static_cast<float>(pixel.y), 1);
    const Eigen::Vector3f there = far + own.value * epipole;
    if (there.z() <= 0) return std::nullopt;
    const float x = there.x() / there.z(), y = there.y() / there.z();
    if (!(x >= 0 && y >= 0 && x < static_cast<float>(estimates->width() - 1) &&
          y < static_cast<float>(estimates->height() - 1))) {
      return std::nullopt;
    }
    std::optional<InverseDepth> best;
    for (int row = static_cast<int>(y); row <= static_cast<int>(y) + 1; ++row) {
      for (int column = static_cast<int>(x); column <= static_cast<int>(x) + 1; ++column) {
        const InverseDepth& theirs = estimates->At(column, row);
        if (!theirs.IsKnown()) continue;
        // theirs = own / (scale (far.z + own epipole.z)), solved for own
        const float scaled = theirs.value * scale, divisor = 1 - scaled * epipole.z();
        if (divisor <= 0) continue;
        const InverseDepth converted{scaled * far.z() / divisor, theirs.sigma * scale * far.z() / (divisor * divisor)};
        if (!converted.IsKnown() || !AreCompatible(own, converted)) continue;
        if (!best || std::abs(converted.value - own.value) < std::abs(best->value - own.value)) best = converted;
      }
    }
    return best;
  }
};

}  // namespace

void CheckAgainstKeyframes(const CameraModel& camera, const std::vector<cv::Point>& pixels,
                           const std::vector<OtherEstimates>& others, int least_consistent,
                           InverseDepthImage* estimates) {
  std::vector<Projection> projections;
  for (const OtherEstimates& other : others) projections.emplace_back(camera.Intrinsics(), other);
  for (const cv::Point& pixel : pixels) {
    InverseDepth& own = estimates->At(pixel.x, pixel.y);
    if (!own.IsKnown()) continue;
    InverseDepthMean mean;
    mean.Add(own);
    int consistent = 0;
    for (const Projection& projection : projections) {
      const std::optional<InverseDepth> theirs = projection.Confirm(pixel, own);
      if (!theirs) continue;
      mean.Add(*theirs);
      ++consistent;
    }
    // The keyframes share their images, so that their mean is no more certain than the estimate itself.
    own = consistent >= least_consistent ? InverseDepth{mean.value(), own.sigma} : InverseDepth{};
  }
}

}  // namespace kinemap
