// SPDX-License-Identifier: Apache-2.0
// What the engine does about the distortion that calibration left in the images of one camera.
#include "engine.h"
#include "loop_closing/map_correction.h"

namespace kinemap {

void Engine::LookThroughLens() {
  if (!options_.localize_only && loop_closer_.IsFree())
    lens_finder_.Look(*map(), frame_index_, camera_.remaining_radial());
}

void Engine::TakeLens() {
  if (lens_finder_.IsFree()) return;
  const BundleProblem solved = lens_finder_.Take();
  if (solved.radial == 0 || map() == nullptr || map()->FindKeyframe(solved.cameras.front().keyframe_id) == nullptr) {
    return;
  }
  // What it has was undistorted as before and belongs to the poses before.
  if (semi_dense_) semi_dense_->Finish(*map());
  mapper_.Settle(map());
  ApplyAdjustment(solved, map());
  BelieveLens(solved.radial);
}

void Engine::BelieveLens(double radial) {
  if (radial == 0) return;
  // The product of both without the fourth power of the distance.
  SetLens(camera_.remaining_radial() + radial);
  for (const auto& any : atlas_.maps()) any->UndistortFeatures(camera_);
  TrackerState state = tracker_.state();
  if (state.last.features != nullptr) state.last.features = Undistorted(*state.last.features, camera_);
  tracker_.Restore(state);
}

void Engine::SetLens(double radial) {
  if (radial == camera_.remaining_radial()) return;
  camera_ = camera_.WithRemainingRadial(radial);
  extractor_.SetRemainingRadial(radial);
  if (semi_dense_) semi_dense_->ChangeLens(map(), camera_);
  if (ground_scale_) ground_scale_->ChangeLens(camera_);
}

}  // namespace kinemap
