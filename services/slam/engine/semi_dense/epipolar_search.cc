// SPDX-License-Identifier: Apache-2.0
#include "semi_dense/epipolar_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kinemap {
namespace {

constexpr float kMarginPx = 4;            // the pattern and its derivatives stay inside the image
constexpr float kLeastDepthRatio = 0.2f;  // a point that much nearer to the other camera looks too different
constexpr float kSlackPx = 1.5f;          // at the ends of a line, so that a minimum there is seen from both sides
constexpr int kWellSteps = 2;             // steps around the best one that belong to the same minimum
constexpr int kRefinements = 3;
constexpr float kFurthestRefinementPx = 1.5f;

// Engel, Koltun and Cremers, "Direct sparse odometry", 2018, figure 4: spreads over 5x5 pixels.
const float kPattern[8][2] = {{0, 0}, {0, -2}, {-1, -1}, {1, -1}, {-2, 0}, {2, 0}, {-1, 1}, {0, 2}};

float Interpolate(const cv::Mat& grey, float x, float y) {
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const float dx = x - static_cast<float>(column), dy = y - static_cast<float>(row);
  const uint8_t* upper = grey.ptr<uint8_t>(row) + column;
  const uint8_t* lower = upper + grey.step;
  const float above = static_cast<float>(upper[0]) + dx * static_cast<float>(upper[1] - upper[0]);
  const float below = static_cast<float>(lower[0]) + dx * static_cast<float>(lower[1] - lower[0]);
  return above + dy * (below - above);
}

// In KeyframeView::kGradientUnit.
Eigen::Vector2f GradientAt(const KeyframeView& view, int column, int row) {
  const cv::Vec2s& gradient = view.gradient.ptr<cv::Vec2s>(row)[column];
  return {static_cast<float>(gradient[0]), static_cast<float>(gradient[1])};
}

// Of what is not negative; std::lround is a call.
int Rounded(float value) { return static_cast<int>(value + 0.5f); }

float Squared(float value) { return value * value; }

Eigen::Vector2f Dehomogenized(const Eigen::Vector3f& point) { return point.head<2>() / point.z(); }

}  // namespace

struct EpipolarSearch::Pixel {
  Eigen::Vector2f gradient;  // as it should appear in the searched image, in KeyframeView::kGradientUnit
  float squared_modulus;
  float variance;               // of the difference between two images of a point, to half a step on the line
  Eigen::Vector3f at_infinity;  // homogeneous, in the searched image; its third coordinate is a ratio of depths
  const FeatureLabel* label;
  Patch patch;
};

struct EpipolarSearch::Segment {
  Eigen::Vector2f start, direction;  // from far to near
  float length;
  int axis;  // the coordinate along which it is longer
};

EpipolarSearch::EpipolarSearch(const EpipolarSearchOptions& options, const CameraModel& camera, const KeyframeView& own,
                               const KeyframeView& searched, const SimilarityTransform& searched_from_own)
    : options_(options), own_(own), searched_(searched) {
  const Eigen::Matrix3d intrinsics = camera.Intrinsics();
  const Eigen::Matrix3d rotation = searched_from_own.rotation.toRotationMatrix();
  const Eigen::Vector3d offset = searched_from_own.translation / searched_from_own.scale;
  homography_ = (intrinsics * rotation * intrinsics.inverse()).cast<float>();
  epipole_ = (intrinsics * offset).cast<float>();
  own_epipole_ = (intrinsics * (rotation.transpose() * offset)).cast<float>();
  const Eigen::Vector2d roll =
      Eigen::Vector2d(rotation(0, 0) + rotation(1, 1), rotation(1, 0) - rotation(0, 1)).normalized();
  turn_ << static_cast<float>(roll.x()), static_cast<float>(-roll.y()), static_cast<float>(roll.y()),
      static_cast<float>(roll.x());
}

std::optional<InverseDepth> EpipolarSearch::Find(int column, int row, const DepthRange& range) const {
  Pixel pixel;
  Segment segment;
  if (!MakePixel(column, row, &pixel) || !MakeSegment(pixel, range, &segment)) return std::nullopt;
  const int step = BestStep(pixel, segment);
  if (step < 0) return std::nullopt;
  return Refine(pixel, segment, segment.start + static_cast<float>(step) * segment.direction);
}

bool EpipolarSearch::MakePixel(int column, int row, Pixel* pixel) const {
  const Eigen::Vector2f gradient = GradientAt(own_, column, row);
  pixel->squared_modulus = gradient.squaredNorm();
  pixel->variance = 2 * Squared(options_.intensity_sigma) +
                    pixel->squared_modulus * Squared(options_.place_sigma_px / KeyframeView::kGradientUnit);
  // The epipolar line through this pixel. Along an edge every place looks the same.
  const Eigen::Vector2f line =
      own_epipole_.head<2>() - own_epipole_.z() * Eigen::Vector2f(static_cast<float>(column), static_cast<float>(row));
  if (Squared(gradient.dot(line)) < Squared(options_.least_line_cosine) * pixel->squared_modulus * line.squaredNorm()) {
    return false;
  }
  pixel->gradient = turn_ * gradient;
  pixel->at_infinity = homography_ * Eigen::Vector3f(static_cast<float>(column), static_cast<float>(row), 1);
  pixel->label = &own_.labels.LabelAt(column, row);
  for (int i = 0; i < kPatternSize; ++i) {
    const int x = column + static_cast<int>(kPattern[i][0]), y = row + static_cast<int>(kPattern[i][1]);
    pixel->patch[i] = own_.grey.at<uint8_t>(y, x);
  }
  return true;
}

bool EpipolarSearch::MakeSegment(const Pixel& pixel, const DepthRange& range, Segment* segment) const {
  float nearest = range.nearest;
  const float depth_left = kLeastDepthRatio - pixel.at_infinity.z();
  if (epipole_.z() < 0) nearest = std::min(nearest, depth_left / epipole_.z());
  if (pixel.at_infinity.z() + range.farthest * epipole_.z() < kLeastDepthRatio || nearest <= range.farthest)
    return false;
  const Eigen::Vector2f far_end = Dehomogenized(pixel.at_infinity + range.farthest * epipole_);
  const Eigen::Vector2f span = Dehomogenized(pixel.at_infinity + nearest * epipole_) - far_end;
  const float whole = span.norm();
  if (!(whole > 1e-3f)) return false;
  // The part of it that lies in the image.
  float first = -kSlackPx / whole, last = 1 + kSlackPx / whole;
  const Eigen::Vector2f low(kMarginPx, kMarginPx);
  const Eigen::Vector2f high(static_cast<float>(searched_.grey.cols) - kMarginPx - 1,
                             static_cast<float>(searched_.grey.rows) - kMarginPx - 1);
  for (int axis = 0; axis < 2; ++axis) {
    if (std::abs(span[axis]) < 1e-6f) {
      if (far_end[axis] < low[axis] || far_end[axis] > high[axis]) return false;
      continue;
    }
    const float a = (low[axis] - far_end[axis]) / span[axis], b = (high[axis] - far_end[axis]) / span[axis];
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  segment->length = (last - first) * whole;
  if (!(segment->length >= 0)) return false;
  // What is so near that it moves further looks too different.
  segment->length = std::min(segment->length, kMostSteps - 1.0f);
  segment->start = far_end + first * span;
  segment->direction = span / whole;
  segment->axis = std::abs(span.x()) > std::abs(span.y()) ? 0 : 1;
  return true;
}

bool EpipolarSearch::MayBeThere(const Pixel& pixel, const Eigen::Vector2f& place) const {
  const int column = Rounded(place.x()), row = Rounded(place.y());
  const Eigen::Vector2f gradient = GradientAt(searched_, column, row);
  const float squared = gradient.squaredNorm(), least_ratio = Squared(options_.least_gradient_ratio);
  if (squared < least_ratio * pixel.squared_modulus || pixel.squared_modulus < least_ratio * squared) return false;
  const float along = gradient.dot(pixel.gradient);
  if (along <= 0 || Squared(along) < Squared(options_.least_gradient_cosine) * squared * pixel.squared_modulus) {
    return false;
  }
  return MayMatch(*pixel.label, searched_.labels.LabelAt(column, row));
}

float EpipolarSearch::InverseDepthAt(const Pixel& pixel, const Segment& segment, const Eigen::Vector2f& place) const {
  const int axis = segment.axis;
  return (pixel.at_infinity[axis] - place[axis] * pixel.at_infinity.z()) /
         (place[axis] * epipole_.z() - epipole_[axis]);
}

Eigen::Matrix2f EpipolarSearch::Warp(const Pixel& pixel, float inverse_depth, const Eigen::Vector2f& place) const {
  const float depth_ratio = pixel.at_infinity.z() + inverse_depth * epipole_.z();
  return (homography_.topLeftCorner<2, 2>() - place * homography_.bottomLeftCorner<1, 2>()) / depth_ratio;
}

float EpipolarSearch::Error(const Pixel& pixel, const Segment& segment, const Eigen::Vector2f& place) const {
  constexpr float kTooMuch = std::numeric_limits<float>::max();
  const Eigen::Matrix2f warp = Warp(pixel, InverseDepthAt(pixel, segment, place), place);
  // Errors above the accepted one count only in so far as they show that there is no second place.
  const float limit = pixel.variance * kPatternSize * options_.max_error / options_.max_ambiguity;
  float squared = 0;
  for (int i = 0; i < kPatternSize; ++i) {
    const Eigen::Vector2f at = place + warp * Eigen::Vector2f(kPattern[i][0], kPattern[i][1]);
    if (!(at.x() >= 0 && at.y() >= 0 && at.x() < static_cast<float>(searched_.grey.cols - 1) &&
          at.y() < static_cast<float>(searched_.grey.rows - 1))) {
      return kTooMuch;
    }
    squared += Squared(pixel.patch[i] - Interpolate(searched_.grey, at.x(), at.y()));
    if (squared > limit) return kTooMuch;
  }
  const float modulus = GradientAt(searched_, Rounded(place.x()), Rounded(place.y())).norm();
  const float modulus_residual = (std::sqrt(pixel.squared_modulus) - modulus) / KeyframeView::kGradientUnit;
  return (squared / kPatternSize + Squared(modulus_residual) / options_.gradient_variance_ratio) / pixel.variance;
}

int EpipolarSearch::BestStep(const Pixel& pixel, const Segment& segment) const {
  const int steps = static_cast<int>(segment.length);
  std::array<float, kMostSteps> errors;
  int best = -1;
  for (int step = 0; step <= steps; ++step) {
    const Eigen::Vector2f place = segment.start + static_cast<float>(step) * segment.direction;
    errors[step] = std::numeric_limits<float>::max();
    if (!MayBeThere(pixel, place)) continue;
    errors[step] = Error(pixel, segment, place);
    if (errors[step] < options_.max_error && (best < 0 || errors[step] < errors[best])) best = step;
  }
  if (best < 0) return -1;
  for (int step = 0; step <= steps; ++step) {
    if (std::abs(step - best) > kWellSteps && errors[best] > options_.max_ambiguity * errors[step]) return -1;
  }
  return best;
}

std::optional<InverseDepth> EpipolarSearch::Refine(const Pixel& pixel, const Segment& segment,
                                                   Eigen::Vector2f place) const {
  const Eigen::Vector2f start = place;
  float information = 0;
  for (int iteration = 0; iteration < kRefinements; ++iteration) {
    const Eigen::Matrix2f warp = Warp(pixel, InverseDepthAt(pixel, segment, place), place);
    float slope_by_residual = 0;
    information = 0;
    for (int i = 0; i < kPatternSize; ++i) {
      const Eigen::Vector2f at = place + warp * Eigen::Vector2f(kPattern[i][0], kPattern[i][1]);
      const Eigen::Vector2f before = at - 0.5f * segment.direction, after = at + 0.5f * segment.direction;
      const float limit_x = static_cast<float>(searched_.grey.cols - 1);
      const float limit_y = static_cast<float>(searched_.grey.rows - 1);
      if (!(std::min(before.x(), after.x()) >= 0 && std::min(before.y(), after.y()) >= 0 &&
            std::max(before.x(), after.x()) < limit_x && std::max(before.y(), after.y()) < limit_y)) {
        return std::nullopt;
      }
      const float low = Interpolate(searched_.grey, before.x(), before.y());
      const float high = Interpolate(searched_.grey, after.x(), after.y());
      const float slope = high - low;
      const float residual = pixel.patch[i] - Interpolate(searched_.grey, at.x(), at.y());
      slope_by_residual += slope * residual;
      information += slope * slope;
    }
    if (information < 1) return std::nullopt;
    place += slope_by_residual / information * segment.direction;
    if (!((place - start).norm() <= kFurthestRefinementPx)) return std::nullopt;
  }
  InverseDepth result;
  result.value = InverseDepthAt(pixel, segment, place);
  const float depth_ratio = pixel.at_infinity.z() + result.value * epipole_.z();
  const float px_per_inverse_depth = (epipole_.head<2>() - place * epipole_.z()).norm() / depth_ratio;
  // A point beside its epipolar line is matched where its edge crosses the line.
  const float squared_cosine = Squared(pixel.gradient.dot(segment.direction)) / pixel.squared_modulus;
  const float line_variance = Squared(options_.line_sigma_px) / squared_cosine;
  const float match_variance = 2 * Squared(options_.intensity_sigma) / information;
  result.sigma = std::sqrt(match_variance + line_variance) / px_per_inverse_depth;
  if (!(result.value > 0) || !std::isfinite(result.sigma)) return std::nullopt;
  return result;
}

}  // namespace kinemap
