// SPDX-License-Identifier: Apache-2.0
#include "features/stereo_matcher.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kinemap {
namespace {

constexpr double kRowTolerancePx = 2;  // finest octave
constexpr int kMostBits = 75;          // between a match by row and one without any prediction
constexpr int kPatchRadiusPx = 5;
constexpr int kPatchSide = 2 * kPatchRadiusPx + 1;
constexpr int kSlidePx = 5;
constexpr int kKeypointsOfTask = 100;
constexpr double kOutlierFactor = 2.1;     // of the median difference of the patches
constexpr double kLeastDisparityPx = 0.1;  // a point farther than this says is as good as infinitely far

/// Rounded up to whole vectors of the processor; the rest is zero.
constexpr int kPatchRoom = 128;
using Patch = std::array<int16_t, kPatchRoom>;

/// Grey levels around a pixel less their mean, so that the exposure of the two cameras may differ.
Patch PatchAt(const cv::Mat& image, int column, int row) {
  Patch patch{};
  int sum = 0, next = 0;
  for (int y = -kPatchRadiusPx; y <= kPatchRadiusPx; ++y) {
    const uint8_t* line = image.ptr<uint8_t>(row + y) + column - kPatchRadiusPx;
    for (int x = 0; x < kPatchSide; ++x) sum += patch[next++] = line[x];
  }
  const auto mean = static_cast<int16_t>(sum / next);
  for (int i = 0; i < next; ++i) patch[i] -= mean;
  return patch;
}

int Difference(const Patch& a, const Patch& b) {
  int sum = 0;
  for (int i = 0; i < kPatchRoom; ++i) sum += std::abs(a[i] - b[i]);
  return sum;
}

}  // namespace

/// Keypoints of the right image by the rows in which they may be looked for, one after the other.
struct StereoMatcher::Rows {
  double low_px;
  std::vector<int> start;  // one a row and one past the end
  std::vector<int> keypoints;
};

struct StereoMatcher::Refined {
  int keypoint;
  double right_x_px;
  int difference;
};

StereoMatcher::StereoMatcher(const CameraModel& camera, const PyramidScales& scales)
    : camera_(camera), scales_(scales) {}

StereoMatcher::Rows StereoMatcher::RowsOf(const FrameFeatures& right) const {
  Rows rows;
  rows.low_px = std::floor(camera_.low_corner_px().y());
  const int count = static_cast<int>(std::ceil(camera_.high_corner_px().y() - rows.low_px)) + 1;
  const auto visit = [&](auto&& add) {
    for (int i = 0; i < right.size(); ++i) {
      const double tolerance = kRowTolerancePx * scales_.scale(right.keypoints[i].octave) * right.keypoints[i].spread;
      const double row = right.keypoints[i].pixel_px.y() - rows.low_px;
      const int first = std::max(0, static_cast<int>(std::ceil(row - tolerance)));
      const int last = std::min(count - 1, static_cast<int>(std::floor(row + tolerance)));
      for (int r = first; r <= last; ++r) add(r, i);
    }
  };
  rows.start.assign(count + 1, 0);
  visit([&](int row, int) { ++rows.start[row + 1]; });
  for (int row = 0; row < count; ++row) rows.start[row + 1] += rows.start[row];
  rows.keypoints.resize(rows.start.back());
  std::vector<int> next(rows.start.begin(), rows.start.end() - 1);
  visit([&](int row, int keypoint) { rows.keypoints[next[row]++] = keypoint; });
  return rows;
}

int StereoMatcher::FindCandidate(const FrameFeatures& left, int keypoint, const FrameFeatures& right,
                                 const Rows& rows) const {
  const Keypoint& wanted = left.keypoints[keypoint];
  const int row = static_cast<int>(std::lround(wanted.pixel_px.y() - rows.low_px));
  if (row < 0 || row + 1 >= static_cast<int>(rows.start.size())) return -1;
  // Nothing is nearer than one baseline.
  const double nearest_x_px = camera_.RightXAtDepth(wanted.pixel_px.x(), camera_.baseline_m());
  int best = -1, best_distance = kMostBits;
  for (int k = rows.start[row]; k < rows.start[row + 1]; ++k) {
    const Keypoint& candidate = right.keypoints[rows.keypoints[k]];
    if (std::abs(candidate.octave - wanted.octave) > 1) continue;
    if (candidate.pixel_px.x() < nearest_x_px || candidate.pixel_px.x() > wanted.pixel_px.x()) continue;
    const int distance = HammingDistance(left.descriptors[keypoint], right.descriptors[rows.keypoints[k]]);
    if (distance >= best_distance) continue;
    best = rows.keypoints[k];
    best_distance = distance;
  }
  return best;
}

bool StereoMatcher::Refine(const StereoView& left, const StereoView& right, int keypoint, int match,
                           Refined* refined) const {
  const Keypoint& wanted = left.features->keypoints[keypoint];
  const Keypoint& found = right.features->keypoints[match];
  const cv::Mat& left_image = left.pyramid[wanted.octave];
  const cv::Mat& right_image = right.pyramid[wanted.octave];
  const double scale_x = static_cast<double>(left.pyramid.front().cols) / left_image.cols;
  const double scale_y = static_cast<double>(left.pyramid.front().rows) / left_image.rows;
  const auto at_level = [](double raw_px, double scale) { return (raw_px + 0.5) / scale - 0.5; };
  const double left_x = at_level(wanted.raw_px.x(), scale_x);
  const int column = static_cast<int>(std::lround(left_x));
  const int row = static_cast<int>(std::lround(at_level(wanted.raw_px.y(), scale_y)));
  // The same row of the undistorted pair; in images as they came it may be another.
  const Eigen::Vector2d right_raw_px = camera_.is_distorted()
                                           ? camera_.Distort({found.pixel_px.x(), wanted.pixel_px.y()})
                                           : Eigen::Vector2d(found.raw_px.x(), wanted.raw_px.y());
  const int right_column = static_cast<int>(std::lround(at_level(right_raw_px.x(), scale_x)));
  const int right_row = static_cast<int>(std::lround(at_level(right_raw_px.y(), scale_y)));
  const auto fits = [&](int c, int r, int margin) {
    return c - margin >= kPatchRadiusPx && c + margin < left_image.cols - kPatchRadiusPx && r >= kPatchRadiusPx &&
           r < left_image.rows - kPatchRadiusPx;
  };
  if (!fits(column, row, 0) || !fits(right_column, right_row, kSlidePx)) return false;

  const Patch patch = PatchAt(left_image, column, row);
  std::array<int, 2 * kSlidePx + 1> differences;
  for (int slide = -kSlidePx; slide <= kSlidePx; ++slide) {
    differences[slide + kSlidePx] = Difference(patch, PatchAt(right_image, right_column + slide, right_row));
  }
  const int best = static_cast<int>(std::min_element(differences.begin(), differences.end()) - differences.begin());
  if (best == 0 || best == 2 * kSlidePx) return false;
  const double before = differences[best - 1], at = differences[best], after = differences[best + 1];
  const double curvature = before - 2 * at + after;
  const double between = curvature > 0 ? 0.5 * (before - after) / curvature : 0;
  // The patch stands on whole pixels; what the keypoint lies beside its pixel, its match does too.
  const double right_level_x = right_column + best - kSlidePx + between + (left_x - column);
  const double right_x_raw = (right_level_x + 0.5) * scale_x - 0.5;
  refined->keypoint = keypoint;
  refined->right_x_px = camera_.is_distorted() ? camera_.Undistort({right_x_raw, right_raw_px.y()}).x() : right_x_raw;
  refined->difference = differences[best];
  const double disparity = wanted.pixel_px.x() - refined->right_x_px;
  return disparity > kLeastDisparityPx && disparity < camera_.fx_px();
}

int StereoMatcher::Match(const StereoView& left, const StereoView& right, ThreadTeam* team) const {
  const Rows rows = RowsOf(*right.features);
  // Every keypoint by itself, so that the result is the same with any number of threads.
  std::vector<Refined> refined_of(left.features->size());
  team->Run((left.features->size() + kKeypointsOfTask - 1) / kKeypointsOfTask, [&](int task) {
    const int end = std::min((task + 1) * kKeypointsOfTask, left.features->size());
    for (int i = task * kKeypointsOfTask; i < end; ++i) {
      const int match = FindCandidate(*left.features, i, *right.features, rows);
      if (match < 0 || !Refine(left, right, i, match, &refined_of[i])) refined_of[i].keypoint = -1;
    }
  });
  std::vector<Refined> found;
  for (const Refined& refined : refined_of) {
    if (refined.keypoint >= 0) found.push_back(refined);
  }
  if (found.empty()) return 0;
  std::vector<int> differences;
  for (const Refined& refined : found) differences.push_back(refined.difference);
  std::nth_element(differences.begin(), differences.begin() + differences.size() / 2, differences.end());
  const double bound = kOutlierFactor * differences[differences.size() / 2];
  int kept = 0;
  for (const Refined& refined : found) {
    if (refined.difference > bound) continue;
    Keypoint& keypoint = left.features->keypoints[refined.keypoint];
    keypoint.right_x_px = refined.right_x_px;
    keypoint.depth_m = camera_.DepthOfDisparity(keypoint.pixel_px.x() - refined.right_x_px);
    ++kept;
  }
  return kept;
}

}  // namespace kinemap
