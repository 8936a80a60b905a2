// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "geometry/camera_model.h"
#include "geometry/rigid_transform.h"
#include "geometry/triangulation.h"
#include "geometry/two_view_motion.h"
#include "geometry/two_view_ransac.h"

namespace kinemap {
namespace {

RigidTransform SomeMotion() { return {RotationFromVector({0.02, -0.05, 0.03}), Eigen::Vector3d(0.6, 0.1, -0.4)}; }

TEST(RigidTransform, InverseUndoesIt) {
  const RigidTransform motion = SomeMotion();
  const Eigen::Vector3d point(1, -2, 7);
  EXPECT_LT((motion.Inverse() * (motion * point) - point).norm(), 1e-12);
  EXPECT_LT(((motion * motion.Inverse()).Matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-12);
}

TEST(RigidTransform, PerturbationHasItsDerivativeByTheStep) {
  const RigidTransform motion = SomeMotion();
  const Eigen::Vector3d point(1, -2, 7), moved = motion * point;
  for (int axis = 0; axis < 6; ++axis) {
    Vector6d step = Vector6d::Zero();
    step[axis] = 1e-6;
    const Eigen::Vector3d numeric = (motion.PerturbedInTarget(step) * point - moved) / 1e-6;
    const Eigen::Vector3d analytic =
        axis < 3 ? Eigen::Vector3d::Unit(axis) : Eigen::Vector3d(Eigen::Vector3d::Unit(axis - 3).cross(moved));
    EXPECT_LT((numeric - analytic).norm(), 1e-5) << "axis " << axis;
  }
}

TEST(RigidTransform, RefusesWhatIsNoRotation) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix(0, 0) = 2;
  EXPECT_THROW(RigidTransform::FromMatrix(matrix), std::invalid_argument);
  matrix(0, 0) = -1;
  EXPECT_THROW(RigidTransform::FromMatrix(matrix), std::invalid_argument);
}

TEST(CameraModel, DistortsWhatItUndistorted) {
  const CameraModel camera(640, 480, 500, 510, 320, 240, {-0.28, 0.07, 0.001, -0.0005, 0.002});
  for (const double x : {20.0, 320.0, 600.0}) {
    for (const double y : {20.0, 240.0, 460.0}) {
      const Eigen::Vector2d raw(x, y);
      EXPECT_LT((camera.Distort(camera.Undistort(raw)) - raw).norm(), 1e-3) << raw.transpose();
    }
  }
  EXPECT_LT(camera.low_corner_px().x(), 0);
  EXPECT_GT(camera.high_corner_px().y(), 480);
}

TEST(CameraModel, ProjectionJacobianIsItsDerivative) {
  const CameraModel camera(640, 480, 500, 510, 320, 240);
  const Eigen::Vector3d point(0.7, -0.4, 5);
  const Eigen::Matrix<double, 2, 3> jacobian = camera.ProjectionJacobian(point);
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d moved = point + 1e-6 * Eigen::Vector3d::Unit(axis);
    EXPECT_LT(((camera.Project(moved) - camera.Project(point)) / 1e-6 - jacobian.col(axis)).norm(), 1e-3);
  }
}

TEST(CameraModel, NamesTheValueItRefuses) {
  try {
    CameraModel(640, 480, -500, 500, 320, 240);
    FAIL() << "a negative focal length was accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "camera: expected a positive focal length fx, got -500");
  }
  EXPECT_THROW(CameraModel(640, 480, 500, 500, 320, 240, {0.1, 0.2, 0.3}), std::invalid_argument);
}

TEST(Triangulation, FindsThePointTwoRaysMeetIn) {
  const RigidTransform second_from_first = SomeMotion();
  const Eigen::Vector3d point(1.5, -0.7, 9);
  const Eigen::Vector3d in_second = second_from_first * point;
  const Eigen::Vector3d found = TriangulateTwoRays(second_from_first, point / point.z(), in_second / in_second.z());
  EXPECT_LT((found - point).norm(), 1e-6);
}

TEST(Triangulation, CorrespondingPixelsLieOnEachOthersEpipolarLine) {
  const CameraModel camera(640, 480, 500, 510, 320, 240);
  const Eigen::Matrix3d fundamental = FundamentalFromMotion(SomeMotion(), camera.Intrinsics());
  const Eigen::Vector3d point(1.5, -0.7, 9);
  const Eigen::Vector2d pixel_1 = camera.Project(point), pixel_2 = camera.Project(SomeMotion() * point);
  const Eigen::Vector3d line = fundamental * pixel_1.homogeneous();
  EXPECT_NEAR(line.dot(pixel_2.homogeneous()) / line.head<2>().norm(), 0, 1e-6);
}

/// Pairs of pixels of points in two views, with half a pixel of noise and a share of wrong matches.
class TwoViews : public ::testing::Test {
 protected:
  void Make(bool planar, double wrong_share) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> across(-4, 4), along(6, 20), anywhere(0, 480);
    std::normal_distribution<double> noise(0, 0.5);
    const RigidTransform motion = SomeMotion();
    while (pairs_.size() < 400) {
      Eigen::Vector3d point(across(random), across(random), along(random));
      if (planar) point.z() = 10 + 0.3 * point.x();
      PixelPair pair{camera_.Project(point), camera_.Project(motion * point)};
      if (!camera_.Contains(pair.first_px) || !camera_.Contains(pair.second_px)) continue;
      pair.second_px += Eigen::Vector2d(noise(random), noise(random));
      wrong_.push_back(pairs_.size() < wrong_share * 400);
      if (wrong_.back()) pair.second_px = {anywhere(random), anywhere(random)};
      pairs_.push_back(pair);
    }
  }

  void ExpectMotion(const TwoViewMotion& found) const {
    const RigidTransform truth = SomeMotion();
    EXPECT_LT(found.second_from_first.rotation.angularDistance(truth.rotation), 0.02);
    EXPECT_GT(found.second_from_first.translation.dot(truth.translation.normalized()), 0.98);
  }

  CameraModel camera_{640, 480, 500, 500, 320, 240};
  std::vector<PixelPair> pairs_;
  std::vector<bool> wrong_;
};

TEST_F(TwoViews, FundamentalWinsInADeepSceneAndGivesTheMotion) {
  Make(false, 0.3);
  RandomEngine random(0, 1);
  const TwoViewModel homography = EstimateHomography(pairs_, 1, 200, random);
  const TwoViewModel fundamental = EstimateFundamental(pairs_, 1, 200, random);
  EXPECT_LT(homography.score / (homography.score + fundamental.score), 0.45);
  const std::vector<TwoViewMotion> motions = MotionsFromFundamental(fundamental, pairs_, camera_, 1);
  ASSERT_EQ(motions.size(), 4u);
  ExpectMotion(motions[0]);
  EXPECT_LT(motions[1].in_front, 0.5 * motions[0].in_front);
}

TEST_F(TwoViews, HomographyWinsOnAPlaneAndGivesTheMotion) {
  Make(true, 0.3);
  RandomEngine random(0, 1);
  const TwoViewModel homography = EstimateHomography(pairs_, 1, 200, random);
  const TwoViewModel fundamental = EstimateFundamental(pairs_, 1, 200, random);
  EXPECT_GT(homography.score / (homography.score + fundamental.score), 0.45);
  // A plane leaves two motions that put all points in front of both cameras; one of them is the true one.
  const std::vector<TwoViewMotion> motions = MotionsFromHomography(homography, pairs_, camera_, 1);
  ASSERT_GE(motions.size(), 2u);
  const double first = motions[0].second_from_first.rotation.angularDistance(SomeMotion().rotation);
  const double second = motions[1].second_from_first.rotation.angularDistance(SomeMotion().rotation);
  ExpectMotion(first < second ? motions[0] : motions[1]);
}

TEST_F(TwoViews, WrongMatchesAreOutliers) {
  Make(false, 0.4);
  RandomEngine random(0, 1);
  const TwoViewModel model = EstimateFundamental(pairs_, 1, 300, random);
  int wrong_inliers = 0, right_outliers = 0;
  for (size_t i = 0; i < pairs_.size(); ++i) {
    wrong_inliers += wrong_[i] && model.inlier[i] ? 1 : 0;
    right_outliers += !wrong_[i] && !model.inlier[i] ? 1 : 0;
  }
  EXPECT_LT(wrong_inliers, 10);  // a wrong match may lie on its epipolar line by chance
  EXPECT_LT(right_outliers, 30);
}

TEST_F(TwoViews, OneSeedGivesOneModel) {
  Make(false, 0.3);
  RandomEngine random_1(7, 99), random_2(7, 99);
  EXPECT_EQ(EstimateFundamental(pairs_, 1, 50, random_1).matrix, EstimateFundamental(pairs_, 1, 50, random_2).matrix);
}

TEST_F(TwoViews, TooFewPairsScoreNothing) {
  Make(false, 0);
  pairs_.resize(7);
  RandomEngine random(0, 1);
  EXPECT_EQ(EstimateFundamental(pairs_, 1, 10, random).score, 0);
}

TEST(RigidTransform, KnowsTheStepBetweenTwo) {
  const RigidTransform from(RotationFromVector({0.3, -1, 0.2}), Eigen::Vector3d(4, -2, 1));
  Vector6d step;
  step << 0.1, -0.2, 0.3, 0.02, -0.4, 0.1;
  EXPECT_LT((from.PerturbedInTarget(step).StepInTargetFrom(from) - step).norm(), 1e-12);
  EXPECT_LT(from.StepInTargetFrom(from).norm(), 1e-12);
}

}  // namespace
}  // namespace kinemap
