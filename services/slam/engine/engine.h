// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "engine_options.h"
#include "features/orb_extractor.h"
#include "map/atlas.h"
#include "map_update.h"
#include "mapping/local_mapper.h"
#include "mapping/object_states.h"
#include "tracking/camera_tracker.h"
#include "tracking/initial_map_builder.h"
#include "tracking/keyframe_policy.h"
#include "tracking/map_initializer.h"
#include "tracking_result.h"

namespace kinemap {

/// Objects of one frame, as the tracker service knows them.
struct FrameObjects {
  cv::Mat track_image;  ///< CV_32S, pixel = object id, 0 background; empty: no objects
  std::vector<ObjectRow> rows;
  bool masks_fresh = true;  ///< false: carried from an earlier frame, so nothing on an object is trusted
};

/// Monocular SLAM, frame by frame: the same images, objects and options give the same bytes, on any load. Not to be
/// called from two threads at once.
class Engine {
 public:
  /// Throws std::invalid_argument when an option is out of its range.
  Engine(const CameraModel& camera, const EngineOptions& options);

  /// Extracts the features of an 8-bit grey image of the camera's size. A frame begun but not finished is replaced.
  /// Throws std::invalid_argument when the size is another or the timestamp does not come after the last frame's.
  void BeginFrame(int64_t timestamp_ns, const cv::Mat& image);

  /// Tracks and maps the begun frame. `depth_m` is CV_32F of the camera's size or empty. Throws std::logic_error when
  /// no frame was begun, std::invalid_argument for images of another size.
  TrackingResult FinishFrame(const FrameObjects& objects, const cv::Mat& depth_m);

  /// The end of the input: merges the background's work and adjusts the whole map (its newest 300 keyframes) once more,
  /// together with the radial distortion that the calibration left.
  void Flush();

  /// Radial distortion k that Flush found on top of the calibration; 0 before. A perfect calibration gives 0.
  double remaining_radial() const { return mapper_.remaining_radial(); }

  /// Everything that changed since the last call. What is mapped around a keyframe in the background begins with the
  /// next call of this or of BeginFrame, and so is reported after the next frame; nothing is left after Flush.
  MapUpdate TakeUpdate();

 private:
  /// Gives the maps back to the caller's thread; public methods begin with it, but BeginFrame and TakeUpdate.
  void FinishMapping();
  Frame MakeFrame(const FrameObjects& objects);
  void Initialize(Frame* frame, const cv::Mat& depth_m, TrackingResult* result);
  void FillWaitingFrames(const Frame& first, const Frame& current);
  void Track(Frame* frame, const cv::Mat& depth_m, TrackingResult* result);
  SlamMap* map() { return atlas_.active(); }
  const SlamMap* map() const { return atlas_.active(); }
  bool NeedsKeyframe(const Frame& frame, int tracked) const;
  void ReportPose(const Frame& frame, const Matrix6d& information, TrackingResult* result) const;

  CameraModel camera_;
  EngineOptions options_;
  PyramidScales scales_;
  OrbExtractor extractor_;
  MapInitializer initializer_;
  InitialMapBuilder map_builder_;
  CameraTracker tracker_;
  KeyframePolicy keyframe_policy_;
  Atlas atlas_;  // before the mapper, whose thread works on its maps
  LocalMapper mapper_;
  ObjectStates object_states_;

  struct BegunFrame {
    int64_t timestamp_ns;
    FrameFeaturesPtr features;
    double extract_ms;
  };
  std::optional<BegunFrame> begun_;
  std::optional<int64_t> last_timestamp_ns_;
  int64_t frame_index_ = -1;
  int64_t last_keyframe_index_ = 0;
  std::optional<KeyframeId> new_keyframe_;  // that the last frame became
  std::deque<Frame> waiting_;               // frames before the map existed
  std::vector<LateFramePose> late_frames_;
};

}  // namespace kinemap
