// SPDX-License-Identifier: Apache-2.0
// What the engine shows the semi-dense map of a frame.
#include <utility>

#include "engine.h"

namespace kinemap {

void Engine::AddToSemiDense(const Frame& frame, const cv::Mat& image, const FrameObjects& objects, bool is_keyframe) {
  semi_dense_->Collect(frame_index_);
  const bool is_first_view = initializer_.IsFirstView(frame.timestamp_ns);
  if (!is_keyframe && !is_first_view) return;
  PixelLabels labels(options_.stage, objects.track_image, objects.rows, objects.masks_fresh, options_.mask_border_px);
  if (is_first_view) {
    first_view_.emplace();
    first_view_->timestamp_ns = frame.timestamp_ns;
    first_view_->grey = image;
    first_view_->labels = std::move(labels);
    return;
  }
  if (first_view_) {
    const Keyframe& first = map()->keyframe(map()->first_keyframe_id());
    if (first.timestamp_ns == first_view_->timestamp_ns) {
      semi_dense_->Add(*map(), first.id, first_view_->grey, std::move(first_view_->labels), frame_index_);
    }
    first_view_.reset();
  }
  semi_dense_->Add(*map(), frame.reference_keyframe_id, image, std::move(labels), frame_index_);
}

}  // namespace kinemap
