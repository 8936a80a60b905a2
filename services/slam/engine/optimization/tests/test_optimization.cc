// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>

#include "optimization/bundle_adjustment.h"
#include "optimization/pose_optimizer.h"
#include "optimization/radial_projection.h"
#include "synthetic/scene.h"

namespace kinemap {
namespace {

using synthetic::CameraAt;
using synthetic::Scene;
using synthetic::TestCamera;

std::vector<PoseObservation> Observations(const Scene& scene, const RigidTransform& camera_from_map, double noise_px,
                                          uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 1);
  std::vector<PoseObservation> observations;
  for (const Eigen::Vector3d& point : scene.points()) {
    const Eigen::Vector2d error(noise(random), noise(random));
    observations.push_back({point, TestCamera().Project(camera_from_map * point) + noise_px * error, 1.0});
  }
  return observations;
}

TEST(PoseOptimizer, FindsThePoseDespiteWrongMatches) {
  const Scene scene(200, 3, 5, 15);
  const RigidTransform truth = CameraAt({0.5, -0.2, 1}, 0.1);
  std::vector<PoseObservation> observations = Observations(scene, truth, 0.5, 3);
  for (size_t i = 0; i < 60; ++i) observations[i].pixel_px += Eigen::Vector2d(40, -25);
  const PoseEstimate estimate = PoseOptimizer(TestCamera()).Optimize(CameraAt({0.2, 0, 0.6}), observations);
  EXPECT_LT((estimate.camera_from_map.Inverse().translation - Eigen::Vector3d(0.5, -0.2, 1)).norm(), 0.02);
  EXPECT_LT(estimate.camera_from_map.rotation.angularDistance(truth.rotation), 0.003);
  for (size_t i = 0; i < 60; ++i) EXPECT_FALSE(estimate.inlier[i]);
  EXPECT_GT(estimate.inliers, 130);
}

TEST(PoseOptimizer, CovarianceIsTheSpreadOfItsEstimates) {
  const Scene scene(60, 3, 5, 15);
  const RigidTransform truth = CameraAt({0, 0, 0});
  Matrix6d spread = Matrix6d::Zero(), covariance = Matrix6d::Zero();
  constexpr int kTrials = 400;
  for (int trial = 0; trial < kTrials; ++trial) {
    const PoseEstimate estimate =
        PoseOptimizer(TestCamera()).Optimize(truth, Observations(scene, truth, 0.5, 100 + trial));
    const RigidTransform error = estimate.camera_from_map * truth.Inverse();
    Vector6d step;
    step << error.translation, 2 * error.rotation.vec();
    spread += step * step.transpose() / kTrials;
    // Observations were given unit variance but have a quarter of it.
    covariance += 0.25 * estimate.information.inverse() / kTrials;
  }
  for (int axis = 0; axis < 6; ++axis) EXPECT_NEAR(spread(axis, axis) / covariance(axis, axis), 1, 0.25) << axis;
}

PosePrior PriorAt(const RigidTransform& camera_from_map, double sigma) {
  return {camera_from_map, Matrix6d::Identity() / (sigma * sigma)};
}

TEST(PoseOptimizer, PriorHoldsWhatFewPointsLeaveOpen) {
  // Far points close together: turning and shifting look nearly the same.
  const Scene scene(8, 1, 28, 32);
  const RigidTransform truth = CameraAt({0, 0, 0.5}, 0.02);
  const std::vector<PoseObservation> observations = Observations(scene, truth, 0.5, 4);
  const PoseOptimizer optimizer(TestCamera());
  const PoseEstimate free = optimizer.Optimize(truth, observations);
  const PoseEstimate held = optimizer.Optimize(truth, observations, PriorAt(CameraAt({0.01, 0, 0.5}, 0.02), 0.02));
  EXPECT_GT((free.camera_from_map * truth.Inverse()).translation.norm(), 0.1);
  EXPECT_LT((held.camera_from_map * truth.Inverse()).translation.norm(), 0.03);
  EXPECT_LT(held.information.inverse().diagonal().maxCoeff(), 0.02 * 0.02);
}

TEST(PoseOptimizer, WrongPriorHardlyMovesAPoseOfManyPoints) {
  const Scene scene(200, 3, 5, 15);
  const RigidTransform truth = CameraAt({0.5, -0.2, 1}, 0.1);
  const PoseEstimate estimate = PoseOptimizer(TestCamera())
                                    .Optimize(CameraAt({0.2, 0, 0.6}), Observations(scene, truth, 0.5, 3),
                                              PriorAt(CameraAt({0.2, 0, 0.6}), 0.005));
  EXPECT_LT((estimate.camera_from_map.Inverse().translation - Eigen::Vector3d(0.5, -0.2, 1)).norm(), 0.03);
  EXPECT_GT(estimate.inliers, 180);
}

TEST(PosePrior, ContainsWhatIsLikely) {
  const PosePrior prior = PriorAt(CameraAt({0, 0, 0}), 0.1);
  EXPECT_TRUE(prior.Contains(CameraAt({0.3, 0, 0}, 0.3)));
  EXPECT_FALSE(prior.Contains(CameraAt({0.3, 0, 0}, 0.4)));
}

TEST(PoseOptimizer, APointOfUnknownDepthTellsOnlyWhatItKnows) {
  const Scene scene(80, 4, 5, 15);
  const RigidTransform truth = CameraAt({0.4, 0, 0.3}, 0.1);
  std::vector<PoseObservation> observations = Observations(scene, truth, 0.3, 5);
  // Half the points are a third too near along the ray of the camera that made them.
  for (size_t i = 0; i < observations.size(); i += 2) observations[i].point_in_map *= 0.67;
  const auto off = [&] {
    const RigidTransform found =
        PoseOptimizer(TestCamera()).Optimize(CameraAt({0, 0, 0}), observations).camera_from_map;
    return (found.Inverse().translation - truth.Inverse().translation).norm();
  };
  const double trusted = off();
  for (size_t i = 0; i < observations.size(); i += 2) {
    observations[i].depth_error = 0.5 * observations[i].point_in_map;
  }
  EXPECT_LT(off(), 0.02);
  EXPECT_GT(trusted, 0.05);
}

TEST(PoseOptimizer, SaysNothingOfTwoPoints) {
  const Scene scene(2, 3, 5, 15);
  EXPECT_EQ(PoseOptimizer(TestCamera()).Optimize({}, Observations(scene, {}, 0, 1)).inliers, 0);
}

class Bundle : public ::testing::Test {
 protected:
  Bundle() {
    for (int k = 0; k < 5; ++k) {
      const RigidTransform truth = CameraAt({0.4 * k, 0, 0.3 * k}, 0.02 * k);
      truth_.push_back(truth);
      problem_.cameras.push_back({k, truth, k < 2});
    }
    for (size_t i = 0; i < scene_.points().size(); ++i) {
      problem_.points.push_back({static_cast<LandmarkId>(i), scene_.points()[i]});
      for (int k = 0; k < 5; ++k) {
        problem_.observations.push_back(
            {k, static_cast<int>(i), TestCamera().Project(truth_[k] * scene_.points()[i]), 1.0});
      }
    }
  }

  void Disturb() {
    std::mt19937 random(8);
    std::normal_distribution<double> noise(0, 1);
    for (int k = 2; k < 5; ++k) {
      Vector6d step;
      for (int axis = 0; axis < 6; ++axis) step[axis] = 0.02 * noise(random);
      problem_.cameras[k].camera_from_map = problem_.cameras[k].camera_from_map.PerturbedInTarget(step);
    }
    for (BundlePoint& point : problem_.points) {
      point.position_in_map += 0.1 * Eigen::Vector3d(noise(random), noise(random), noise(random));
    }
  }

  Scene scene_{100, 2, 5, 12};
  std::vector<RigidTransform> truth_;
  BundleProblem problem_;
};

TEST_F(Bundle, FindsCamerasAndPointsAgain) {
  Disturb();
  SolveBundle(TestCamera(), {10, 20, 1e-8}, &problem_);
  for (int k = 0; k < 5; ++k) {
    EXPECT_LT((problem_.cameras[k].camera_from_map.Matrix() - truth_[k].Matrix()).norm(), 1e-4) << "camera " << k;
  }
  for (size_t i = 0; i < scene_.points().size(); ++i) {
    EXPECT_LT((problem_.points[i].position_in_map - scene_.points()[i]).norm(), 1e-3);
  }
}

TEST_F(Bundle, LeavesOutWrongObservationsAndFixedCameras) {
  Disturb();
  for (size_t i = 0; i < problem_.observations.size(); i += 20) problem_.observations[i].pixel_px.x() += 30;
  SolveBundle(TestCamera(), {10, 20, 1e-8}, &problem_);
  for (size_t i = 0; i < problem_.observations.size(); ++i) {
    EXPECT_EQ(problem_.observations[i].outlier, i % 20 == 0) << i;
  }
  EXPECT_EQ(problem_.cameras[0].camera_from_map.Matrix(), truth_[0].Matrix());
  EXPECT_LT((problem_.cameras[4].camera_from_map.Matrix() - truth_[4].Matrix()).norm(), 1e-4);
}

TEST_F(Bundle, FindsTheRadialDistortionThatCalibrationLeft) {
  for (BundleObservation& observation : problem_.observations) {
    observation.pixel_px =
        ProjectRadial(TestCamera(), 0.02, truth_[observation.camera] * scene_.points()[observation.point]);
  }
  Disturb();
  SolveBundle(TestCamera(), {20, 30, 1e-10, 0.05}, &problem_);
  EXPECT_NEAR(problem_.radial, 0.02, 0.001);
  EXPECT_LT((problem_.cameras[4].camera_from_map.Matrix() - truth_[4].Matrix()).norm(), 0.002);
}

TEST_F(Bundle, FindsNoRadialDistortionWhereThereIsNone) {
  Disturb();
  SolveBundle(TestCamera(), {20, 30, 1e-10, 0.05}, &problem_);
  EXPECT_NEAR(problem_.radial, 0, 1e-4);
}

TEST_F(Bundle, SparseSystemOfManyCamerasGivesTheSame) {
  // The same scene again and again, each with cameras and points of its own.
  constexpr int kCopies = 40;
  const int cameras = static_cast<int>(problem_.cameras.size()), points = static_cast<int>(problem_.points.size());
  Disturb();
  const BundleProblem one = problem_;
  for (int copy = 1; copy < kCopies; ++copy) {
    problem_.cameras.insert(problem_.cameras.end(), one.cameras.begin(), one.cameras.end());
    problem_.points.insert(problem_.points.end(), one.points.begin(), one.points.end());
    for (BundleObservation observation : one.observations) {
      observation.camera += copy * cameras;
      observation.point += copy * points;
      problem_.observations.push_back(observation);
    }
  }
  SolveBundle(TestCamera(), {10, 20, 1e-8}, &problem_);
  for (size_t i = 0; i < problem_.cameras.size(); ++i) {
    EXPECT_LT((problem_.cameras[i].camera_from_map.Matrix() - truth_[i % cameras].Matrix()).norm(), 1e-4) << i;
  }
}

TEST_F(Bundle, PointBehindACameraDoesNotDrownTheOthers) {
  Disturb();
  problem_.points[7].position_in_map = {0.5, 0, -3};
  SolveBundle(TestCamera(), {10, 20, 1e-8}, &problem_);
  EXPECT_LT(problem_.robust_cost, 1);
  for (const BundleObservation& observation : problem_.observations) {
    EXPECT_EQ(observation.outlier, observation.point == 7);
  }
  EXPECT_LT((problem_.cameras[4].camera_from_map.Matrix() - truth_[4].Matrix()).norm(), 1e-4);
}

TEST_F(Bundle, SpeedHoldsACameraThatSeesLittle) {
  std::erase_if(problem_.observations,
                [](const BundleObservation& observation) { return observation.camera == 4 && observation.point > 0; });
  const Eigen::Vector3d ahead = CameraAt({0.4 * 4, 0, 0.3 * 4 + 1}, 0.08).Inverse().translation;
  problem_.cameras[4].camera_from_map = CameraAt(ahead, 0.08);
  problem_.velocity_changes = {{2, 3, 4, 0.1, 0.1, 0.02}};
  const auto way = [&] {
    return (problem_.cameras[4].camera_from_map.Inverse().translation -
            problem_.cameras[3].camera_from_map.Inverse().translation)
        .norm();
  };
  const BundleProblem before = problem_;
  SolveBundle(TestCamera(), {20, 20, 1e-9}, &problem_);
  EXPECT_GT(way(), 1);
  problem_ = before;
  BundleOptions options{20, 20, 1e-9};
  options.velocity_change = 1;
  SolveBundle(TestCamera(), options, &problem_);
  EXPECT_NEAR(way(), 0.5, 0.02);
}

TEST_F(Bundle, OneProblemGivesOneSolution) {
  Disturb();
  BundleProblem again = problem_;
  SolveBundle(TestCamera(), {5, 5, 1e-5}, &problem_);
  SolveBundle(TestCamera(), {5, 5, 1e-5}, &again);
  for (size_t i = 0; i < problem_.points.size(); ++i) {
    EXPECT_EQ(problem_.points[i].position_in_map, again.points[i].position_in_map);
  }
}

}  // namespace
}  // namespace kinemap
