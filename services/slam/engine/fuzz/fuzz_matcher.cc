// SPDX-License-Identifier: Apache-2.0
// Frames of arbitrary keypoints, descriptors, labels and poses against a map of arbitrary landmarks: every matcher must
// end, match a keypoint once, and give landmarks that exist.
#include <cstdlib>
#include <set>

#include "fuzz/byte_source.h"
#include "synthetic/scene.h"
#include "tracking/frame_matcher.h"
#include "tracking/local_map_tracker.h"

namespace kinemap {
namespace {

using fuzz::ByteSource;

Frame AnyFrame(ByteSource* source, const CameraModel& camera, int64_t timestamp_ns) {
  auto features = std::make_shared<FrameFeatures>();
  const int count = source->TakeInt(0, 60);
  Frame frame;
  for (int i = 0; i < count; ++i) {
    Keypoint keypoint;
    // Also outside the image: the lens may bend a corner of it there.
    keypoint.pixel_px = {source->TakeReal(-200, camera.width_px() + 200),
                         source->TakeReal(-200, camera.height_px() + 200)};
    keypoint.raw_px = keypoint.pixel_px;
    keypoint.angle_deg = static_cast<float>(source->TakeReal(0, 359.99));
    keypoint.octave = source->TakeInt(0, synthetic::TestScales().levels() - 1);
    features->keypoints.push_back(keypoint);
    features->descriptors.push_back(source->Take<Descriptor>());
    FeatureLabel label;
    label.role = static_cast<FeatureRole>(source->TakeInt(0, 3));
    label.state = static_cast<MotionState>(source->TakeInt(0, 4));
    label.object_id = static_cast<uint32_t>(source->TakeInt(0, 3));
    frame.labels.push_back(label);
  }
  features->grid = KeypointGrid(features->keypoints, camera.low_corner_px(), camera.high_corner_px());
  frame.features = features;
  frame.timestamp_ns = timestamp_ns;
  frame.camera_from_map = synthetic::CameraAt(
      {source->TakeReal(-3, 3), source->TakeReal(-1, 1), source->TakeReal(-5, 5)}, source->TakeReal(-3.2, 3.2));
  frame.ForgetMatches();
  return frame;
}

void AddLandmarks(ByteSource* source, KeyframeId keyframe_id, SlamMap* map) {
  for (int i = 0; i < map->keyframe(keyframe_id).features->size(); ++i) {
    if (source->TakeInt(0, 2) == 0) continue;
    const Keyframe& keyframe = map->keyframe(keyframe_id);
    const Eigen::Vector3d in_camera(source->TakeReal(-5, 5), source->TakeReal(-5, 5), source->TakeReal(-2, 40));
    Landmark& landmark = map->CreateLandmark(keyframe.map_from_keyframe * in_camera, keyframe_id, keyframe.labels[i]);
    map->Observe(&landmark, keyframe_id, i);
    map->UpdateDescriptor(&landmark);
    map->UpdateViewRange(&landmark);
  }
}

void Require(bool condition) {
  if (!condition) std::abort();
}

void RequireSound(const SlamMap& map, const Frame& frame) {
  Require(static_cast<int>(frame.landmark_ids.size()) == frame.size());
  for (const LandmarkId id : frame.landmark_ids) Require(id == kNoId || map.FindLandmark(id) != nullptr);
}

}  // namespace
}  // namespace kinemap

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace kinemap;
  fuzz::ByteSource source(data, size);
  const CameraModel camera = synthetic::TestCamera();
  SlamMap map(0, synthetic::TestScales());
  for (int i = 0; i < 3; ++i) {
    const KeyframeId id = map.InsertKeyframe(AnyFrame(&source, camera, 100 * (i + 1))).id;
    AddLandmarks(&source, id, &map);
    map.UpdateCovisibility(id);
  }
  Frame last = AnyFrame(&source, camera, 400);
  const std::vector<LandmarkId> landmarks = map.LiveLandmarks();
  for (LandmarkId& id : last.landmark_ids) {
    if (!landmarks.empty()) id = landmarks[source.TakeInt(0, static_cast<int>(landmarks.size()) - 1)];
  }
  Frame frame = AnyFrame(&source, camera, 500);
  frame.reference_keyframe_id = map.last_keyframe_id();
  MatchLastFrame(map, camera, last, source.TakeReal(0, 100), &frame);
  RequireSound(map, frame);
  ProjectKeyframe(map, camera, 1, source.TakeReal(0, 100), source.TakeInt(0, 256), &frame);
  RequireSound(map, frame);
  LocalMapTracker(camera).Track(&map, source.TakeReal(1, 5), &frame);
  RequireSound(map, frame);
  MatchKeyframe(map, 0, source.TakeReal(0.1, 1), &frame);
  RequireSound(map, frame);
  return 0;
}
