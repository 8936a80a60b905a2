// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "geometry/camera_model.h"
#include "geometry/similarity_transform.h"
#include "semi_dense/inverse_depth.h"
#include "semi_dense/keyframe_view.h"
#include "semi_dense/semi_dense_options.h"

namespace kinemap {

/// Looks along epipolar lines in one keyframe for the pixels of another, by intensity around the pixel and by the
/// gradient's orientation and modulus, to a part of a pixel and with its variance (Mur-Artal and Tardos,
/// "Probabilistic semi-dense mapping from highly accurate feature-based monocular SLAM", RSS 2015, section III-B).
class EpipolarSearch {
 public:
  /// The views must live as long as this. `searched_from_own` is between what is anchored in the two keyframes.
  EpipolarSearch(const EpipolarSearchOptions& options, const CameraModel& camera, const KeyframeView& own,
                 const KeyframeView& searched, const SimilarityTransform& searched_from_own);

  /// Inverse depth of a pixel, at least four pixels from the image's border, as this pair of keyframes sees it; nothing
  /// where the line runs along the gradient's edge, or shows nothing similar in `range` or several similar places.
  std::optional<InverseDepth> Find(int column, int row, const DepthRange& range) const;

 private:
  static constexpr int kPatternSize = 8;
  static constexpr int kMostSteps = 256;

  struct Pixel;
  struct Segment;
  using Patch = std::array<float, kPatternSize>;

  bool MakePixel(int column, int row, Pixel* pixel) const;
  bool MakeSegment(const Pixel& pixel, const DepthRange& range, Segment* segment) const;
  bool MayBeThere(const Pixel& pixel, const Eigen::Vector2f& place) const;
  float InverseDepthAt(const Pixel& pixel, const Segment& segment, const Eigen::Vector2f& place) const;
  Eigen::Matrix2f Warp(const Pixel& pixel, float inverse_depth, const Eigen::Vector2f& place) const;
  float Error(const Pixel& pixel, const Segment& segment, const Eigen::Vector2f& place) const;
  int BestStep(const Pixel& pixel, const Segment& segment) const;
  std::optional<InverseDepth> Refine(const Pixel& pixel, const Segment& segment, Eigen::Vector2f place) const;

  const EpipolarSearchOptions options_;
  const KeyframeView& own_;
  const KeyframeView& searched_;
  Eigen::Matrix3f homography_;  // of points at infinity
  Eigen::Vector3f epipole_;     // own camera's centre in the searched image, times what inverse depth 1 moves it
  Eigen::Vector3f own_epipole_;
  Eigen::Matrix2f turn_;  // of directions in the image
};

}  // namespace kinemap
