// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "features/depth_reader.h"
#include "features/rig_extractor.h"

namespace kinemap {
namespace {

const CameraModel kCamera = CameraModel(640, 480, 500, 500, 320, 240).WithBaseline(0.4);
const PyramidScales kScales(8, 1.2);
const OrbOptions kOptions{1000, 20, 7};

cv::Mat Texture(const cv::Size& size, double sigma_px) {
  cv::Mat image(size, CV_8U);
  cv::RNG random(1);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(image, image, {}, sigma_px);
  cv::normalize(image, image, 0, 255, cv::NORM_MINMAX);
  return image;
}

/// What the right camera sees of a left image: upper half at one disparity, lower half at another.
cv::Mat RightOf(const cv::Mat& left, double upper_px, double lower_px) {
  cv::Mat columns(left.size(), CV_32F), rows(left.size(), CV_32F), right;
  for (int y = 0; y < left.rows; ++y) {
    for (int x = 0; x < left.cols; ++x) {
      columns.at<float>(y, x) = static_cast<float>(x + (y < left.rows / 2 ? upper_px : lower_px));
      rows.at<float>(y, x) = static_cast<float>(y);
    }
  }
  cv::remap(left, right, columns, rows, cv::INTER_CUBIC, cv::BORDER_REFLECT);
  return right;
}

TEST(StereoMatcher, MeasuresDisparitiesToAPartOfAPixel) {
  const cv::Mat left = Texture({640, 480}, 2.0);
  RigExtractor extractor(kOptions, kScales, kCamera);
  cv::Mat right = RightOf(left, 20.3, 41.6);
  right.convertTo(right, CV_8U, 0.9, 12);  // the other camera's exposure
  const FrameFeaturesPtr features = extractor.Extract(left, right, {});
  int measured = 0, wrong = 0;
  double squared_px = 0;
  for (const Keypoint& keypoint : features->keypoints) {
    EXPECT_EQ(keypoint.HasDepth(), !std::isnan(keypoint.right_x_px));
    if (!keypoint.HasDepth() || std::abs(keypoint.pixel_px.y() - 240) < 60) continue;
    const double disparity = keypoint.pixel_px.x() - keypoint.right_x_px;
    EXPECT_NEAR(keypoint.depth_m, 500 * 0.4 / disparity, 1e-9);
    const double error = disparity - (keypoint.pixel_px.y() < 240 ? 20.3 : 41.6);
    ++measured;
    if (std::abs(error) > 1.0) {
      ++wrong;
    } else {
      squared_px += error * error;
    }
  }
  EXPECT_GT(measured, 350);
  EXPECT_LT(wrong, 0.02 * measured);
  EXPECT_LT(std::sqrt(squared_px / (measured - wrong)), 0.25);
}

TEST(StereoMatcher, FindsNothingInAnotherScene) {
  const cv::Mat left = Texture({640, 480}, 2.0);
  cv::Mat turned;
  cv::rotate(left, turned, cv::ROTATE_180);
  const FrameFeaturesPtr features = RigExtractor(kOptions, kScales, kCamera).Extract(left, turned, {});
  const auto measured = std::count_if(features->keypoints.begin(), features->keypoints.end(),
                                      [](const Keypoint& keypoint) { return keypoint.HasDepth(); });
  EXPECT_LT(measured, 0.1 * features->size());
}

TEST(StereoMatcher, OnePairGivesOneSetOfBytes) {
  const cv::Mat left = Texture({640, 480}, 2.0), right = RightOf(left, 12, 12);
  RigExtractor extractor(kOptions, kScales, kCamera);
  const FrameFeaturesPtr a = extractor.Extract(left, right, {}), b = extractor.Extract(left, right, {});
  ASSERT_EQ(a->size(), b->size());
  for (int i = 0; i < a->size(); ++i) EXPECT_EQ(a->keypoints[i].depth_m, b->keypoints[i].depth_m);
}

TEST(DepthReader, ReadsSteepPlanesAndNoOutlines) {
  cv::Mat depth(480, 640, CV_32F);
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      // A road below the horizon, and in front of it a post.
      const float road = y > 245 ? 500 * 1.6f / (y - 240) : 0;
      depth.at<float>(y, x) = x >= 300 && x < 340 ? 4 : road;
    }
  }
  const DepthReader reader(kCamera);
  EXPECT_NEAR(reader.DepthAt(depth, {100.2, 300.4}), 500 * 1.6 / 60, 1e-4);
  EXPECT_NEAR(reader.DepthAt(depth, {320, 300}), 4, 1e-6);
  EXPECT_EQ(reader.DepthAt(depth, {300, 300}), 0) << "on the post's outline";
  EXPECT_EQ(reader.DepthAt(depth, {299, 300}), 0) << "beside it";
  EXPECT_EQ(reader.DepthAt(depth, {100, 200}), 0) << "nothing was measured";
  EXPECT_EQ(reader.DepthAt(depth, {-3, 200}), 0);
  depth.at<float>(300, 100) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(reader.DepthAt(depth, {100, 300}), 0);
}

TEST(RigExtractor, TakesDepthsWhereStereoFoundNone) {
  const cv::Mat left = Texture({640, 480}, 2.0);
  const cv::Mat depth(480, 640, CV_32F, cv::Scalar(7));
  RigExtractor extractor(kOptions, kScales, kCamera);
  const FrameFeaturesPtr of_depth = extractor.Extract(left, {}, depth);
  for (const Keypoint& keypoint : of_depth->keypoints) {
    EXPECT_NEAR(keypoint.depth_m, 7, 1e-6);
    EXPECT_NEAR(keypoint.right_x_px, keypoint.pixel_px.x() - 500 * 0.4 / 7, 1e-5);
  }
  int by_stereo = 0, by_depth = 0;
  const FrameFeaturesPtr of_both = extractor.Extract(left, RightOf(left, 40, 40), depth);
  for (const Keypoint& keypoint : of_both->keypoints) {
    (std::abs(keypoint.depth_m - 5) < 0.5 ? by_stereo : by_depth) += 1;
  }
  EXPECT_GT(by_stereo, 300);
  EXPECT_GT(by_depth, 20);
}

}  // namespace
}  // namespace kinemap
