// SPDX-License-Identifier: Apache-2.0
#include "engine.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "stopwatch.h"

namespace kinemap {
namespace {

constexpr double kLeastDown = 0.7;

const EngineOptions& Checked(const EngineOptions& options) {
  options.Check();
  return options;
}

CameraTrackerOptions TrackerOptions(const EngineOptions& options) {
  CameraTrackerOptions tracker;
  tracker.relocalizer.seed = options.seed;
  return tracker;
}

LocalMapperOptions MapperOptions(const EngineOptions& options) {
  LocalMapperOptions mapper;
  mapper.merge_delay_frames = options.merge_delay_frames;
  mapper.bundle.keyframes = options.local_bundle_keyframes;
  mapper.bundle.solver.velocity_change = options.velocity_change;
  mapper.final_adjustment.bundle.velocity_change = options.velocity_change;
  mapper.final_adjustment.bundle.radial_sigma = options.radial_sigma;
  mapper.final_adjustment.bundle.right_shift_sigma_px = options.right_shift_sigma_px;
  return mapper;
}

LensFinderOptions LensOptions(const EngineOptions& options) {
  LensFinderOptions lens;
  lens.adjustment = MapperOptions(options).final_adjustment;
  lens.wait = options.wait_for_loops;
  return lens;
}

LoopCloserOptions ClosingOptions(const EngineOptions& options) {
  LoopCloserOptions closer;
  closer.seed = options.seed;
  closer.bundle.velocity_change = options.velocity_change;
  closer.wait = options.wait_for_loops;
  return closer;
}

// The road's direction below a camera in a map with z up; straight below a level camera where z is not up.
Eigen::Vector3d RoadNormal(const Eigen::Matrix4d& map_from_first_camera) {
  const Eigen::Vector3d down = -map_from_first_camera.row(2).head<3>().transpose();
  return down.y() > kLeastDown ? down.normalized() : Eigen::Vector3d::UnitY();
}

void CheckSize(const char* name, const cv::Mat& image, const CameraModel& camera) {
  if (image.cols == camera.width_px() && image.rows == camera.height_px()) return;
  throw std::invalid_argument(std::string(name) + ": expected " + std::to_string(camera.width_px()) + "x" +
                              std::to_string(camera.height_px()) + " pixels, got " + std::to_string(image.cols) + "x" +
                              std::to_string(image.rows));
}

}  // namespace

Engine::Engine(const CameraModel& camera, const EngineOptions& options)
    : has_right_camera_(camera.baseline_m() > 0),
      camera_(has_right_camera_ ? camera : camera.WithDepthBaseline(Checked(options).depth_baseline_m)),
      options_(Checked(options)),
      scales_(options.pyramid_levels, options.pyramid_factor),
      extractor_({options.features, {options.fast_threshold, options.fast_threshold_low}, options.threads}, scales_,
                 camera_),
      feature_budget_(options.features),
      initializer_({}, camera_),
      map_builder_(camera_, scales_),
      single_frame_builder_(camera_, scales_),
      tracker_(TrackerOptions(options), camera_, &places_),
      keyframe_policy_({}),
      lost_policy_({.patience_frames = options.new_map_after_lost}),
      atlas_(options.map_id, scales_),
      mapper_(MapperOptions(options), camera_),
      lens_finder_(LensOptions(options), camera_),
      contact_placer_(camera_),
      places_(options.vocabulary_path.empty() ? nullptr : Vocabulary::Load(options.vocabulary_path)),
      loop_closer_(ClosingOptions(options), camera_) {
  if (options_.semi_dense) semi_dense_.emplace(SemiDenseOptions{}, camera_);
  if (options.camera_height_m > 0 && !options.localize_only) {
    ground_scale_.emplace(camera_, options.camera_height_m, RoadNormal(options.map_from_first_camera));
  }
  if (options.opencv_threads > 0) cv::setNumThreads(options.opencv_threads);
}

void Engine::BeginFrame(int64_t timestamp_ns, const cv::Mat& image, const cv::Mat& right, const cv::Mat& depth_m) {
  CheckSize("image", image, camera_);
  if (!right.empty()) CheckSize("right", right, camera_);
  if (!right.empty() && !has_right_camera_) {
    throw std::invalid_argument("right: expected no image of a camera without a stereo baseline");
  }
  if (!depth_m.empty()) CheckSize("depth_m", depth_m, camera_);
  if (last_timestamp_ns_ && timestamp_ns <= *last_timestamp_ns_) {
    throw std::invalid_argument("timestamp_ns: expected one after " + std::to_string(*last_timestamp_ns_) + ", got " +
                                std::to_string(timestamp_ns));
  }
  const Stopwatch stopwatch;
  mapper_.StartMapping();
  extractor_.SetWanted(feature_budget_.next());
  FrameFeaturesPtr features = extractor_.Extract(image, right, depth_m);
  RoadView road;
  if (ground_scale_ && right.empty() && depth_m.empty()) road = ground_scale_->viewer().Make(image);
  begun_ = BegunFrame{timestamp_ns, std::move(features), semi_dense_ ? image.clone() : cv::Mat(), stopwatch.ElapsedMs(),
                      std::move(road)};
}

void Engine::FinishMapping() {
  mapper_.FinishMapping();
  // With the keyframe come the landmarks it was the first to see.
  if (new_keyframe_) tracker_.FollowKeyframe(*map(), *new_keyframe_);
  new_keyframe_.reset();
}

Frame Engine::MakeFrame(const FrameObjects& objects) {
  Frame frame;
  frame.timestamp_ns = begun_->timestamp_ns;
  frame.features = begun_->features;
  frame.labels = ObjectLabels(options_.stage, objects.track_image, objects.rows, objects.masks_fresh,
                              options_.mask_border_px, scales_)
                     .LabelsOf(frame.features->keypoints);
  feature_budget_.Observe(frame.labels);
  frame.ForgetMatches();
  return frame;
}

TrackingResult Engine::FinishFrame(const FrameObjects& objects) {
  if (!begun_) throw std::logic_error("finish_frame: no frame was begun");
  if (!objects.track_image.empty()) CheckSize("track_image", objects.track_image, camera_);
  ++frame_index_;
  TrackingResult result;
  result.timestamp_ns = begun_->timestamp_ns;
  result.stage_ms.extract_ms = begun_->extract_ms;
  result.map_id = atlas_.active_map_id();
  result.features = begun_->features->size();
  Frame frame = MakeFrame(objects);
  const cv::Mat image = begun_->image;
  last_timestamp_ns_ = begun_->timestamp_ns;
  RoadView road = std::move(begun_->road);
  begun_.reset();
  if (map() == nullptr) {
    if (!RecoverInOtherMaps(&frame, &result) && !WaitToBeRecognised(&result)) Initialize(&frame, &result);
    if (result.state == TrackingState::kInitializing && !atlas_.maps().empty()) {
      result.reason += "; not recognised in " + std::to_string(atlas_.maps().size()) + " earlier map(s)";
    }
  } else {
    const Stopwatch stopwatch;
    const std::optional<KeyframeId> mapped = new_keyframe_;
    FinishMapping();
    mapper_.MergeIfDue(map(), frame_index_);
    MakeMetricIfFound();
    if (lens_finder_.IsDue(frame_index_)) {
      TakeLens();
      frame.features = Undistorted(*frame.features, camera_);
    }
    const bool is_free = mapper_.IsFree() && loop_closer_.IsFree() && lens_finder_.IsFree();
    if (ground_scale_ && is_free) ground_scale_->Correct(map());
    result.stage_ms.merge_ms = stopwatch.ElapsedMs();
    MergeLoops(&result);
    places_.Follow(map());
    if (mapped) LookForLoops(*mapped, &result);
    if (mapped) LookThroughLens();
    if (options_.stage == Stage::kMoving && objects.masks_fresh && !options_.localize_only) {
      object_states_.Update(objects.rows, frame.timestamp_ns, map());
    }
    Track(&frame, &result);
    if (!road.intensity.empty() && result.state == TrackingState::kTracking) {
      if (!objects.track_image.empty()) ground_scale_->viewer().LeaveOutObjects(objects.track_image, &road);
      ground_scale_->Observe(*map(), frame, std::move(road));
      ReportRoad(frame, objects.track_image, &result);
    }
  }
  if (semi_dense_) AddToSemiDense(frame, image, objects, result.keyframe_inserted);
  if (map() != nullptr) {
    result.map_id = map()->map_id();
    result.metric_scale = map()->metric_scale();
  }
  if (result.state == TrackingState::kLost && map() != nullptr) LeaveMapIfHopeless(&result);
  return result;
}

void Engine::MakeMetricIfFound() {
  if (map()->metric_scale() || !late_scale_.IsFound()) return;
  lens_finder_.Cancel();
  mapper_.Settle(map());
  loop_closer_.Settle(&atlas_);
  tracker_.ChangeUnits(late_scale_.Apply(map()));
}

void Engine::MergeLoops(TrackingResult* result) {
  if (!loop_closer_.IsDue(frame_index_)) return;
  const Stopwatch stopwatch;
  mapper_.Settle(map());
  const LoopEvents events = loop_closer_.Merge(&atlas_, frame_index_);
  lens_finder_.Cancel();
  result->loop_closed = events.loops_closed > 0;
  result->maps_merged = events.maps_merged > 0;
  result->map_id = atlas_.active_map_id();
  result->stage_ms.loop_ms = stopwatch.ElapsedMs();
  result->background_ms = events.background_ms;
}

void Engine::LookForLoops(KeyframeId mapped, TrackingResult* result) {
  if (!options_.loop_closing || !places_.has_vocabulary()) return;
  const Stopwatch stopwatch;
  loop_closer_.Look(&atlas_, places_, mapped, frame_index_);
  result->stage_ms.loop_ms += stopwatch.ElapsedMs();
}

void Engine::Flush() {
  if (options_.localize_only) return;
  SettleMaps();
  if (map() != nullptr) BelieveLens(mapper_.Finish(map(), camera_.remaining_radial()));
  for (const auto& other : atlas_.maps()) {
    if (other.get() != map()) mapper_.Finish(other.get(), camera_.remaining_radial());
  }
  if (map() == nullptr) return;
  if (ground_scale_) ground_scale_->Finish(map());
  if (semi_dense_) semi_dense_->Finish(*map());
}

MapUpdate Engine::TakeUpdate() {
  const std::vector<LateFramePose> late_frames = std::move(late_frames_);
  late_frames_.clear();
  // Only what has begun is waited for.
  mapper_.WaitForMapping();
  MapUpdate update = TakeMapUpdate(atlas_, late_frames);
  if (semi_dense_) AddSemiDense(semi_dense_->TakeFinished(), &update);
  mapper_.StartMapping();
  return update;
}

}  // namespace kinemap
