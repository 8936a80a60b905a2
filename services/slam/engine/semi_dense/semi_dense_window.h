// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "geometry/camera_model.h"
#include "geometry/similarity_transform.h"
#include "semi_dense/epipolar_search.h"
#include "semi_dense/inverse_depth.h"
#include "semi_dense/keyframe_view.h"
#include "semi_dense/semi_dense_cloud.h"
#include "semi_dense/semi_dense_options.h"
#include "semi_dense/semi_dense_state.h"
#include "semi_dense/view_builder.h"

namespace kinemap {

/// One step of the window: the keyframe that enters it, and where all its keyframes stand now.
struct WindowStep {
  std::optional<KeyframeView> entering;  ///< raw image and labels
  std::map<KeyframeId, SimilarityTransform> map_from_anchor;
  bool is_last = false;  ///< nothing more enters: all that is open is finished
};

/// The newest keyframes with their images and inverse depths. A keyframe is estimated when enough later ones have come,
/// and checked against its neighbours, finished and given out when those are estimated too. One thread at a time.
class SemiDenseWindow {
 public:
  SemiDenseWindow(const SemiDenseOptions& options, const CameraModel& camera)
      : options_(options), camera_(camera), view_builder_(camera) {}

  /// Returns what this step finishes.
  std::vector<SemiDenseCloud> Advance(WindowStep step);

  std::deque<OpenKeyframe> state() const;
  /// Throws std::invalid_argument when a keyframe's estimates are not those of its image.
  void Restore(const std::deque<OpenKeyframe>& state);

 private:
  struct Entry {
    KeyframeView view;
    std::vector<cv::Point> pixels;
    InverseDepthImage estimates;  // empty: not estimated yet
    bool finished = false;
  };
  using Poses = std::map<KeyframeId, SimilarityTransform>;

  std::vector<cv::Point> GradientPixels(const KeyframeView& view) const;
  std::vector<int> NeighborsOf(int index, int count) const;
  InverseDepth EstimatePixel(const cv::Point& pixel, const DepthRange& range,
                             const std::vector<EpipolarSearch>& searches) const;
  void Estimate(int index, const Poses& map_from_anchor);
  SemiDenseCloud Finish(int index, const Poses& map_from_anchor);

  SemiDenseOptions options_;
  CameraModel camera_;
  ViewBuilder view_builder_;
  std::deque<Entry> entries_;
};

}  // namespace kinemap
