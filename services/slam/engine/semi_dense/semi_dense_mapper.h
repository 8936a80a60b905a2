// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <future>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "map/slam_map.h"
#include "semi_dense/semi_dense_window.h"

namespace kinemap {

/// Inverse depths of the gradient pixels of every keyframe, worked out in the background (Mur-Artal and Tardos,
/// "Probabilistic semi-dense mapping from highly accurate feature-based monocular SLAM", RSS 2015). What comes out
/// depends on the frames at which keyframes were inserted, never on how fast the machine is: work that begins at frame
/// k is taken at frame k + `delay_frames`, waiting for it if need be, and a keyframe that comes while as much work is
/// under way as may be is left out.
class SemiDenseMapper {
 public:
  SemiDenseMapper(const SemiDenseOptions& options, const CameraModel& camera);
  ~SemiDenseMapper();
  SemiDenseMapper(const SemiDenseMapper&) = delete;
  SemiDenseMapper& operator=(const SemiDenseMapper&) = delete;

  /// Takes in a keyframe just inserted: its raw 8-bit image, which is kept, not copied, and what its pixels belong to.
  void Add(const SlamMap& map, KeyframeId keyframe_id, cv::Mat image, PixelLabels labels, int64_t frame_index);

  /// Takes the background's results that are due.
  void Collect(int64_t frame_index);

  /// Waits for all that is under way and takes it, whatever frame it is due.
  void Settle();

  /// Of a settled mapper.
  SemiDenseState state() const { return {keyframes_, window_.state(), finished_}; }
  void Restore(SemiDenseState state);

  /// Nothing more comes to this map: finishes all keyframes that are still open, and waits for it.
  void Finish(const SlamMap& map);

  /// Undistorts images by another model of the lens from now on; finishes all keyframes that are open in `map`, which
  /// is null where there is none.
  void ChangeLens(const SlamMap* map, const CameraModel& camera);

  /// What was finished since the last call.
  std::vector<SemiDenseCloud> TakeFinished();

 private:
  struct Work {
    std::shared_future<std::vector<SemiDenseCloud>> clouds;
    int64_t due_frame;
  };

  void Start(WindowStep step, int64_t due_frame);
  void CollectFirst();
  WindowStep StepOf(const SlamMap& map) const;

  SemiDenseOptions options_;
  SemiDenseWindow window_;  // the background's while work is under way
  std::deque<KeyframeId> keyframes_;
  std::deque<Work> under_way_;
  std::vector<SemiDenseCloud> finished_;
};

}  // namespace kinemap
