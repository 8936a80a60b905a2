// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "synthetic/scene.h"
#include "tracking/motion_model.h"

namespace kinemap {
namespace {

using synthetic::CameraAt;

constexpr double kDepth = 10;

/// What 100 points 10 units away tell of a pose.
Matrix6d ByLandmarks() {
  Matrix6d information = Matrix6d::Zero();
  information.diagonal().head<3>().setConstant(1e6);
  information.diagonal().tail<3>().setConstant(1e6 * kDepth * kDepth);
  return information;
}

double PositionSigma(const PredictedPose& predicted) { return std::sqrt(predicted.PoseCovariance()(2, 2)); }

class MotionModels : public ::testing::Test {
 protected:
  /// Frames of a camera that goes `speed` a frame, and shakes.
  void Drive(int frames, double speed, double shake, uint32_t seed = 1) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, shake);
    for (int i = 0; i < frames; ++i) {
      position_ += speed + noise(random);
      const PredictedPose predicted = model_.Predict(last_);
      const RigidTransform found = CameraAt({0, 0, position_});
      model_.Correct(predicted, found, ByLandmarks() + predicted.Prior().information);
      last_ = found;
    }
  }

  double position_ = 0;
  RigidTransform last_ = CameraAt({0, 0, 0});
  MotionModel model_;
};

TEST_F(MotionModels, PredictsSteadyMotion) {
  model_.Start(CameraAt({0, 0, -1}), last_, kDepth);
  Drive(20, 0.7, 0);
  const PredictedPose predicted = model_.Predict(last_, 3);
  EXPECT_NEAR(predicted.camera_from_map.Inverse().translation.z(), position_ + 3 * 0.7, 0.01);
  EXPECT_LT(PositionSigma(predicted), 0.15);
}

TEST_F(MotionModels, IsLessSureTheLongerNothingWasSeen) {
  model_.Start(CameraAt({0, 0, -1}), last_, kDepth);
  Drive(20, 0.7, 0.02);
  double before = 0;
  for (int frames = 1; frames <= 10; ++frames) {
    const double sigma = PositionSigma(model_.Predict(last_, frames));
    EXPECT_GT(sigma, before) << frames;
    before = sigma;
  }
}

TEST_F(MotionModels, LearnsHowMuchTheCameraShakes) {
  model_.Start(CameraAt({0, 0, -1}), last_, kDepth);
  Drive(40, 0.7, 0);
  const double calm = PositionSigma(model_.Predict(last_));
  Drive(40, 0.7, 0.2);
  const double shaken = PositionSigma(model_.Predict(last_));
  EXPECT_LT(calm, 0.06);
  EXPECT_GT(shaken, 0.15);
  EXPECT_LT(shaken, 1.5);
}

TEST_F(MotionModels, RescalesLengthsAlone) {
  model_.Start(CameraAt({0, 0, -1}), last_, kDepth);
  Drive(20, 0.7, 0.02);
  const PredictedPose before = model_.Predict({});
  model_.Rescale(2);
  const PredictedPose after = model_.Predict({});
  EXPECT_NEAR(after.camera_from_map.translation.z(), 2 * before.camera_from_map.translation.z(), 1e-9);
  EXPECT_NEAR(PositionSigma(after), 2 * PositionSigma(before), 1e-9);
  EXPECT_NEAR(after.PoseCovariance()(4, 4), before.PoseCovariance()(4, 4), 1e-12);
  EXPECT_NEAR(after.RadiusPx(500, 2 * kDepth), before.RadiusPx(500, kDepth), 1e-6);
}

}  // namespace
}  // namespace kinemap
