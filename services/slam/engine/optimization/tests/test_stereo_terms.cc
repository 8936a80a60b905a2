// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "optimization/bundle_adjustment.h"
#include "optimization/pose_optimizer.h"
#include "optimization/radial_projection.h"
#include "synthetic/scene.h"

namespace kinemap {
namespace {

using synthetic::CameraAt;
using synthetic::Scene;
using synthetic::TestStereoCamera;

TEST(PoseOptimizer, KnowsHowFarItWentByTheRightImage) {
  // All points far ahead: the left image alone hardly tells a step forward.
  const Scene scene(300, 3, 12, 14);
  const CameraModel camera = TestStereoCamera();
  const RigidTransform truth = CameraAt({0.1, 0, 0.4});
  const Frame frame = scene.Observe(camera, synthetic::TestScales(), truth, 1, 0.5);
  std::vector<PoseObservation> mono, stereo;
  for (int i = 0; i < frame.size(); ++i) {
    const Keypoint& keypoint = frame.features->keypoints[i];
    mono.push_back({scene.points()[scene.observed_points()[i]], keypoint.pixel_px, 1.0});
    stereo.push_back(mono.back());
    stereo.back().right_x_px = keypoint.right_x_px + (i % 10 == 0 ? 15 : 0);
  }
  const PoseEstimate by_left = PoseOptimizer(camera).Optimize(CameraAt({0, 0, 0}), mono);
  const PoseEstimate by_both = PoseOptimizer(camera).Optimize(CameraAt({0, 0, 0}), stereo);
  EXPECT_LT((by_both.camera_from_map.Inverse().translation - Eigen::Vector3d(0.1, 0, 0.4)).norm(), 0.02);
  for (size_t i = 0; i < stereo.size(); i += 10) EXPECT_FALSE(by_both.inlier[i]) << "right image wrong by 15 px";
  EXPECT_GT(by_both.inliers, 0.85 * stereo.size());
  EXPECT_GT(by_both.information(2, 2), by_left.information(2, 2) * 0.9);
}

/// Three views of one scene, all but the first disturbed and everything a tenth too large.
BundleProblem Problem(const Scene& scene, const CameraModel& camera, double radial) {
  BundleProblem problem;
  for (int k = 0; k < 3; ++k) {
    const RigidTransform truth = CameraAt({0.3 * k, 0, 0.2 * k});
    problem.cameras.push_back({k, k == 0 ? truth : CameraAt({0.33 * k, 0.01, 0.22 * k}), k == 0});
    for (size_t i = 0; i < scene.points().size(); ++i) {
      const Eigen::Vector3d in_camera = truth * scene.points()[i];
      BundleObservation observation{k, static_cast<int>(i), ProjectRadial(camera, radial, in_camera), 1.0};
      observation.right_x_px = RightXRadial(camera, radial, in_camera);
      problem.observations.push_back(observation);
    }
  }
  for (size_t i = 0; i < scene.points().size(); ++i) {
    problem.points.push_back({static_cast<LandmarkId>(i), 1.1 * scene.points()[i]});
  }
  return problem;
}

TEST(StereoBundle, FindsTheScale) {
  const Scene scene(150, 3, 5, 12);
  BundleProblem problem = Problem(scene, TestStereoCamera(), 0);
  SolveBundle(TestStereoCamera(), {20, 20, 1e-10}, &problem);
  for (int k = 1; k < 3; ++k) {
    const Eigen::Vector3d center = problem.cameras[k].camera_from_map.Inverse().translation;
    EXPECT_LT((center - Eigen::Vector3d(0.3 * k, 0, 0.2 * k)).norm(), 1e-4);
  }
  for (const BundleObservation& observation : problem.observations) EXPECT_FALSE(observation.outlier);
}

TEST(StereoBundle, LeavesOutWhatIsWrongInTheRightImageOnly) {
  const Scene scene(150, 3, 5, 12);
  BundleProblem problem = Problem(scene, TestStereoCamera(), 0);
  for (size_t i = 0; i < problem.observations.size(); i += 19) problem.observations[i].right_x_px -= 12;
  SolveBundle(TestStereoCamera(), {20, 20, 1e-10}, &problem);
  for (size_t i = 0; i < problem.observations.size(); ++i) EXPECT_EQ(problem.observations[i].outlier, i % 19 == 0);
}

TEST(StereoBundle, FindsTheShiftOfTheRightImage) {
  const Scene scene(300, 4, 3, 20);
  BundleProblem problem = Problem(scene, TestStereoCamera(), 0);
  for (BundleObservation& observation : problem.observations) observation.right_x_px += 0.3;
  BundleOptions options{30, 30, 1e-12, 0.01};
  options.right_shift_sigma_px = 5;
  SolveBundle(TestStereoCamera(), options, &problem);
  EXPECT_NEAR(problem.right_shift_px, 0.3, 0.01);
  EXPECT_LT((problem.cameras[2].camera_from_map.Inverse().translation - Eigen::Vector3d(0.6, 0, 0.4)).norm(), 2e-3);
}

TEST(StereoBundle, FindsTheRadialDistortionOfBothImages) {
  const Scene scene(300, 4, 5, 12);
  for (const CameraModel& camera : {TestStereoCamera(), TestStereoCamera().WithDepthBaseline(0.3)}) {
    BundleProblem problem = Problem(scene, camera, -0.02);
    BundleOptions options{30, 30, 1e-10};
    options.radial_sigma = 0.1;
    SolveBundle(camera, options, &problem);
    EXPECT_NEAR(problem.radial, -0.02, 2e-4);
    EXPECT_LT((problem.cameras[2].camera_from_map.Inverse().translation - Eigen::Vector3d(0.6, 0, 0.4)).norm(), 1e-3);
  }
}

}  // namespace
}  // namespace kinemap
