// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "engine_options.h"
#include "features/feature_budget.h"
#include "features/rig_extractor.h"
#include "ground/contact_placer.h"
#include "ground/ground_scale.h"
#include "loop_closing/loop_closer.h"
#include "map/atlas.h"
#include "map/place_index.h"
#include "map_update.h"
#include "mapping/late_metric_scale.h"
#include "mapping/lens_finder.h"
#include "mapping/local_mapper.h"
#include "mapping/object_states.h"
#include "semi_dense/semi_dense_mapper.h"
#include "storage/map_snapshot.h"
#include "tracking/camera_tracker.h"
#include "tracking/initial_map_builder.h"
#include "tracking/keyframe_policy.h"
#include "tracking/lost_policy.h"
#include "tracking/map_initializer.h"
#include "tracking/single_frame_map_builder.h"
#include "tracking_result.h"

namespace kinemap {

/// Objects of one frame, as the tracker service knows them.
struct FrameObjects {
  cv::Mat track_image;  ///< CV_32S, pixel = object id, 0 background; empty: no objects
  std::vector<ObjectRow> rows;
  bool masks_fresh = true;  ///< false: carried from an earlier frame, so nothing on an object is trusted
};

/// SLAM with one camera, a rectified pair or a depth camera, frame by frame: the same images, objects and options give
/// the same bytes, on any load. A camera that stays lost gets a map of its own, and is looked for in every map it was
/// ever in. Not to be called from two threads at once.
class Engine {
 public:
  /// Throws std::invalid_argument when an option is out of its range or the vocabulary cannot be read.
  Engine(const CameraModel& camera, const EngineOptions& options);

  /// Extracts the features of an 8-bit grey image of the camera's size. `right`, the other image of a rectified pair,
  /// and `depth_m` (CV_32F, along the optical axis, 0 or not a number where unknown) are of the same size or empty.
  /// A frame begun but not finished is replaced. Throws std::invalid_argument when a size is another, a right image
  /// comes to a camera without a baseline or the timestamp does not come after the last frame's.
  void BeginFrame(int64_t timestamp_ns, const cv::Mat& image, const cv::Mat& right = {}, const cv::Mat& depth_m = {});

  /// Tracks and maps the begun frame. Throws std::logic_error when no frame was begun, std::invalid_argument for a
  /// track image of another size.
  TrackingResult FinishFrame(const FrameObjects& objects);

  /// The end of the input: merges the background's work and adjusts every map (its newest 300 keyframes) once more,
  /// together with the radial distortion that the calibration left.
  void Flush();

  /// Radial distortion k that was found on top of the calibration, in young maps and by Flush; 0 before. A perfect
  /// calibration gives 0.
  double remaining_radial() const { return camera_.remaining_radial(); }

  int64_t active_map_id() const { return atlas_.active_map_id(); }
  /// The number of the map after those there are.
  int64_t next_map_id() const { return atlas_.next_map_id(); }
  bool metric_scale() const { return map() != nullptr && map()->metric_scale(); }

  /// Everything that changed since the last call. What is mapped around a keyframe in the background begins with the
  /// next call of this or of BeginFrame, and so is reported after the next frame; nothing is left after Flush.
  MapUpdate TakeUpdate();

  /// Merges what the background holds, so that a snapshot or checkpoint has it too.
  void Settle();

  /// All maps. What the background holds is left out.
  MapSnapshot Snapshot();

  /// Settles, and takes all maps and all else that is carried from frame to frame.
  MapSnapshot Checkpoint();

  /// Takes in another session's maps, in an engine that has seen no frame. The camera must be recognised in one of
  /// them; only when it is not for `new_map_after_lost` frames does it get a map of its own. The next update tells of
  /// everything loaded. Throws MapFileError that names the file, std::logic_error when this engine has a map or frame.
  void LoadMaps(const std::string& path);

  /// The same with this session's maps, after a fall. Ids from `first_free_map_id` << 32 on were never used, so that
  /// what is mapped now is not taken for what was mapped after the snapshot and forgotten.
  void ResumeMaps(const std::string& path, int64_t first_free_map_id);

  /// Goes on exactly where an engine of the same options took this checkpoint; what happens next is the same to
  /// the last bit. Throws MapFileError.
  void RestoreState(const std::vector<uint8_t>& bytes);

 private:
  /// Gives the maps back to the caller's thread; public methods begin with it, but BeginFrame and TakeUpdate.
  void FinishMapping();
  template <typename Archive>
  void SessionFields(Archive& archive);
  void RequireUnused() const;
  void RestoreSemiDense(SemiDenseState state);
  void SettleMaps();
  void BeginInLoadedMaps();
  bool WaitToBeRecognised(TrackingResult* result);
  Frame MakeFrame(const FrameObjects& objects);
  void Initialize(Frame* frame, TrackingResult* result);
  void StartFromOneFrame(Frame* frame);
  void StartFromTwoFrames(Frame* frame, TrackingResult* result);
  void MakeMetricIfFound();
  void TakeLens();
  void LookThroughLens();
  void BelieveLens(double radial);
  void SetLens(double radial);
  void FillWaitingFrames(const Frame& first, const Frame& current);
  void Track(Frame* frame, TrackingResult* result);
  bool RecoverInOtherMaps(Frame* frame, TrackingResult* result);
  void LeaveMapIfHopeless(TrackingResult* result);
  SlamMap* map() { return atlas_.active(); }
  const SlamMap* map() const { return atlas_.active(); }
  void MergeLoops(TrackingResult* result);
  void LookForLoops(KeyframeId mapped, TrackingResult* result);
  bool NeedsKeyframe(const Frame& frame, int tracked) const;
  void CountClose(const Frame& frame, TrackingQuality* quality) const;
  void AddToSemiDense(const Frame& frame, const cv::Mat& image, const FrameObjects& objects, bool is_keyframe);
  void ReportRoad(const Frame& frame, const cv::Mat& track_image, TrackingResult* result);
  void ReportPose(const Frame& frame, const Matrix6d& information, TrackingResult* result) const;

  bool has_right_camera_;
  CameraModel camera_;
  EngineOptions options_;
  PyramidScales scales_;
  RigExtractor extractor_;
  FeatureBudget feature_budget_;
  MapInitializer initializer_;
  InitialMapBuilder map_builder_;
  SingleFrameMapBuilder single_frame_builder_;
  CameraTracker tracker_;
  KeyframePolicy keyframe_policy_;
  LostPolicy lost_policy_;
  Atlas atlas_;  // before the mapper, whose thread works on its maps
  LocalMapper mapper_;
  LensFinder lens_finder_;
  LateMetricScale late_scale_;
  ContactPlacer contact_placer_;
  ObjectStates object_states_;
  PlaceIndex places_;  // of the keyframes of all maps
  LoopCloser loop_closer_;
  std::optional<SemiDenseMapper> semi_dense_;
  std::optional<KeyframeView> first_view_;   // raw, for the semi-dense map, before there is a map
  std::optional<GroundScale> ground_scale_;  // with one camera of known height

  struct BegunFrame {
    int64_t timestamp_ns;
    FrameFeaturesPtr features;
    cv::Mat image;  // a copy, kept for the semi-dense map only
    double extract_ms;
    RoadView road;  ///< empty without a known camera height
  };
  std::optional<BegunFrame> begun_;
  std::optional<int64_t> last_timestamp_ns_;
  int64_t frame_index_ = -1;
  bool must_be_recognised_ = false;  // in a loaded map, before another is begun
  int64_t last_keyframe_index_ = 0;
  std::optional<KeyframeId> new_keyframe_;  // that the last frame became
  std::deque<Frame> waiting_;               // frames before the map existed
  std::vector<LateFramePose> late_frames_;
};

}  // namespace kinemap
