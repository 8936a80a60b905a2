// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "features/corner_detector.h"
#include "features/fast_score.h"
#include "features/patch_orientation.h"
#include "features/steered_brief.h"
#include "features/thread_team.h"

namespace kinemap {
namespace {

cv::Mat Noise(int width, int height) {
  cv::Mat image(height, width, CV_8U);
  cv::RNG random(3);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(image, image, {}, 1.5);
  cv::normalize(image, image, 0, 255, cv::NORM_MINMAX);
  return image;
}

TEST(FastScore, SaysTheLargestThresholdThatOpenCvStillFindsACornerAt) {
  const cv::Mat image = Noise(101, 60);
  std::vector<cv::Mat> found;  // by threshold
  for (int threshold = 0; threshold < 256; ++threshold) {
    std::vector<cv::KeyPoint> corners;
    cv::FAST(image, corners, threshold, false);
    found.emplace_back(cv::Mat::zeros(image.size(), CV_8U));
    for (const cv::KeyPoint& corner : corners) found.back().at<uint8_t>(cv::Point(corner.pt)) = 1;
  }
  std::vector<uint8_t> scores(image.cols);
  for (int row = kFastRadiusPx; row < image.rows - kFastRadiusPx; ++row) {
    FastScoresOfRow(image, row, scores.data());
    for (int column = kFastRadiusPx; column < image.cols - kFastRadiusPx; ++column) {
      int thresholds = 0;
      for (const cv::Mat& at_threshold : found) thresholds += at_threshold.at<uint8_t>(row, column);
      ASSERT_EQ(scores[column], thresholds) << "row " << row << " column " << column;
    }
  }
}

TEST(CornerDetector, FindsEachMaximumOnceEvenOnAPlateau) {
  cv::Mat image(80, 80, CV_8U, cv::Scalar(50));
  image(cv::Rect(30, 30, 2, 2)).setTo(200);  // four pixels with one score
  const std::vector<Corner> corners = CornerDetector({20, 7}).Detect(image, 19);
  ASSERT_EQ(corners.size(), 1u);
  EXPECT_EQ(corners.front().score, 150);
}

TEST(CornerDetector, KeepsFaintCornersOnlyWhereThereIsNoStrongOne) {
  cv::Mat image(120, 240, CV_8U, cv::Scalar(50));
  image.at<uint8_t>(40, 30) = 200;
  image.at<uint8_t>(40, 45) = 60;   // in one cell with the strong corner
  image.at<uint8_t>(60, 180) = 60;  // alone
  const std::vector<Corner> corners = CornerDetector({20, 7}).Detect(image, 19);
  ASSERT_EQ(corners.size(), 2u);
  EXPECT_EQ(corners[0].column, 30);
  EXPECT_EQ(corners[1].column, 180);
}

TEST(PatchOrientation, PointsAtTheBrightSide) {
  cv::Mat image(64, 64, CV_8U);
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 64; ++column) image.at<uint8_t>(row, column) = static_cast<uint8_t>(2 * column + row);
  }
  EXPECT_NEAR(PatchOrientation().AngleDeg(image, 32, 32), 26.57, 0.5);
}

TEST(SteeredBrief, IsOpenCvsDescriptor) {
  const cv::Mat image = Noise(200, 150);
  cv::Mat smoothed;
  cv::GaussianBlur(image, smoothed, {7, 7}, 2, 2, cv::BORDER_REFLECT_101);
  const cv::Ptr<cv::ORB> orb = cv::ORB::create(500, 1.2f, 1, 19);
  std::vector<cv::KeyPoint> keypoints;
  for (int i = 0; i < 200; ++i) {
    keypoints.emplace_back(cv::Point2f(20.0f + i % 40 * 4, 20.0f + i / 40 * 25), 31, 90.0f * (i % 4), 1, 0);
  }
  cv::Mat expected;
  orb->compute(image, keypoints, expected);
  ASSERT_EQ(expected.rows, 200);
  const SteeredBrief brief;
  // OpenCV rounds its smoothed image a little differently, so that a test between equals may turn over.
  int different = 0;
  for (int i = 0; i < expected.rows; ++i) {
    const cv::Point place = keypoints[i].pt;
    Descriptor of_opencv;
    std::memcpy(of_opencv.data(), expected.ptr(i), sizeof(of_opencv));
    different += HammingDistance(brief.Compute(smoothed, place.x, place.y, keypoints[i].angle), of_opencv);
  }
  EXPECT_LT(different, 0.005 * 256 * expected.rows);
}

TEST(ThreadTeam, DoesEveryTaskOnceAndTellsOfFailure) {
  for (const int size : {1, 3}) {
    ThreadTeam team(size);
    for (int round = 0; round < 50; ++round) {
      std::vector<std::atomic<int>> done(20);
      team.Run(20, [&](int index) { ++done[index]; });
      EXPECT_TRUE(std::all_of(done.begin(), done.end(), [](const auto& times) { return times == 1; }));
    }
    const auto fail_at_seven = [](int index) {
      if (index == 7) throw std::runtime_error("seven");
    };
    EXPECT_THROW(team.Run(20, fail_at_seven), std::runtime_error);
    team.Run(1, [](int) {});
  }
}

}  // namespace
}  // namespace kinemap
