// SPDX-License-Identifier: Apache-2.0
#include "ground/road_alignment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace kinemap {
namespace {

constexpr int kPixelStep = 3;         // along a row; the next row's lie between them
constexpr double kSearchStep = 0.04;  // of the logarithm of the height
constexpr size_t kSearchPixelStep = 4;
constexpr double kTukey = 4.0;    // times the residuals' deviation
constexpr double kEnough = 2e-4;  // relative step that ends the iteration
// Normalising over a window ties neighbouring pixels together: about one in so many counts as independent.
constexpr double kPixelsAnEvidence = 8;

struct Sample {
  float value, by_column, by_row;
};

// Bilinear value and gradient; false outside the view or on an object.
bool Read(const RoadView& view, const Eigen::Vector2d& pixel, Sample* sample) {
  const int column = static_cast<int>(std::floor(pixel.x())), row = static_cast<int>(std::floor(pixel.y()));
  if (column < 0 || row < 0 || column + 1 >= view.intensity.cols || row + 1 >= view.intensity.rows) return false;
  if (view.usable.at<uint8_t>(row, column) == 0) return false;
  const float a = static_cast<float>(pixel.x() - column), b = static_cast<float>(pixel.y() - row);
  const float* upper = view.intensity.ptr<float>(row) + column;
  const float* lower = view.intensity.ptr<float>(row + 1) + column;
  const float top = upper[0] + a * (upper[1] - upper[0]), bottom = lower[0] + a * (lower[1] - lower[0]);
  sample->value = top + b * (bottom - top);
  sample->by_row = bottom - top;
  sample->by_column = (1 - b) * (upper[1] - upper[0]) + b * (lower[1] - lower[0]);
  return true;
}

}  // namespace

std::vector<RoadAlignment::Pixel> RoadAlignment::RoadPixels(const RoadView& view, const Eigen::Vector3d& normal) const {
  std::vector<Pixel> pixels;
  for (int row = 0; row < view.intensity.rows; ++row) {
    for (int column = row % kPixelStep; column < view.intensity.cols; column += kPixelStep) {
      if (view.usable.at<uint8_t>(row, column) == 0) continue;
      const Eigen::Vector3d ray = viewer_.Ray(column, row);
      const double slope = normal.dot(ray);
      if (slope < options_.far_slope || std::abs(ray.x()) > options_.half_width * slope) continue;
      pixels.push_back({ray, view.intensity.at<float>(row, column)});
    }
  }
  return pixels;
}

double RoadAlignment::Correlation(const std::vector<Pixel>& pixels, size_t step, const RoadView& older,
                                  const RigidTransform& older_from_newer,
                                  const Eigen::Vector3d& normal_by_height) const {
  const Eigen::Matrix3d rotation = older_from_newer.rotation.toRotationMatrix();
  double a_sum = 0, b_sum = 0, aa = 0, bb = 0, ab = 0;
  size_t count = 0;
  Sample sample;
  for (size_t i = 0; i < pixels.size(); i += step) {
    const Eigen::Vector3d in_older =
        rotation * pixels[i].ray + older_from_newer.translation * normal_by_height.dot(pixels[i].ray);
    if (in_older.z() <= 0 || !Read(older, viewer_.Project(in_older), &sample)) continue;
    const double a = pixels[i].intensity, b = sample.value;
    a_sum += a, b_sum += b, aa += a * a, bb += b * b, ab += a * b;
    ++count;
  }
  if (count * step < static_cast<size_t>(options_.min_pixels)) return -1;
  const double n = static_cast<double>(count);
  const double variances = (aa - a_sum * a_sum / n) * (bb - b_sum * b_sum / n);
  return variances > 0 ? (ab - a_sum * b_sum / n) / std::sqrt(variances) : -1;
}

std::optional<RoadMeasurement> RoadAlignment::Align(const RoadView& newer, const RoadView& older,
                                                    const RigidTransform& older_from_newer,
                                                    const Eigen::Vector3d& expected_normal, double low,
                                                    double high) const {
  const std::vector<Pixel> pixels = RoadPixels(newer, expected_normal);
  if (static_cast<int>(pixels.size()) < options_.min_pixels) return std::nullopt;
  const int steps = std::max(1, static_cast<int>(std::ceil(std::log(high / low) / kSearchStep)));
  Eigen::Vector3d plane = expected_normal / low;  // n / h
  double best = -1;
  for (int step = 0; step <= steps; ++step) {
    const Eigen::Vector3d candidate = expected_normal / (low * std::pow(high / low, static_cast<double>(step) / steps));
    const double correlation = Correlation(pixels, kSearchPixelStep, older, older_from_newer, candidate);
    if (correlation > best) best = correlation, plane = candidate;
  }
  if (best < 0.3) return std::nullopt;

  const Eigen::Matrix3d rotation = older_from_newer.rotation.toRotationMatrix();
  const Eigen::Vector3d& translation = older_from_newer.translation;
  double deviation = 1;
  Eigen::Matrix3d information;
  std::vector<float> absolute;
  int used = 0;
  for (int iteration = 0; iteration < options_.iterations; ++iteration) {
    information.setZero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    absolute.clear();
    Sample sample;
    for (const Pixel& pixel : pixels) {
      const Eigen::Vector3d in_older = rotation * pixel.ray + translation * plane.dot(pixel.ray);
      if (in_older.z() <= 0) continue;
      const Eigen::Vector2d place = viewer_.Project(in_older);
      if (!Read(older, place, &sample)) continue;
      const double residual = pixel.intensity - sample.value;
      absolute.push_back(static_cast<float>(std::abs(residual)));
      const double relative = residual / (kTukey * deviation);
      if (std::abs(relative) >= 1) continue;
      const double root = 1 - relative * relative;
      // The pixel in the older view moves along the epipolar line by `along` for a step of n^T ray / h.
      const double inverse = viewer_.focal_px() / in_older.z();
      const double along =
          sample.by_column * inverse * (translation.x() - in_older.x() / in_older.z() * translation.z()) +
          sample.by_row * inverse * (translation.y() - in_older.y() / in_older.z() * translation.z());
      const double weight = root * root;
      gradient += weight * along * residual * pixel.ray;
      information += weight * along * along * pixel.ray * pixel.ray.transpose();
    }
    used = static_cast<int>(absolute.size());
    if (used < options_.min_pixels) return std::nullopt;
    std::nth_element(absolute.begin(), absolute.begin() + used / 2, absolute.end());
    deviation = std::max(0.05, 1.4826 * absolute[used / 2]);
    const double weight = 1 / (deviation * deviation * kPixelsAnEvidence);
    information *= weight;
    gradient *= weight;
    // The road's tilt is near the expected one: n / h across the expected normal is small.
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - expected_normal * expected_normal.transpose();
    const double tilt_weight = 1 / (plane.squaredNorm() * options_.tilt_sigma_rad * options_.tilt_sigma_rad);
    information += tilt_weight * across;
    gradient -= tilt_weight * across * plane;
    const Eigen::Vector3d step = information.ldlt().solve(gradient);
    if (!step.allFinite()) return std::nullopt;
    plane += step;
    if (step.norm() < kEnough * plane.norm()) break;
  }
  RoadMeasurement found;
  const double inverse_height = plane.norm();
  found.plane = {plane / inverse_height, 1 / inverse_height};
  const Eigen::Vector3d normal = found.plane.normal;
  found.sigma = std::sqrt(normal.dot(information.ldlt().solve(normal))) / inverse_height;
  found.pixels = used;
  found.correlation = Correlation(pixels, 1, older, older_from_newer, plane);
  const bool in_range = found.plane.height > low / (1 + kSearchStep) && found.plane.height < high * (1 + kSearchStep);
  if (!in_range || found.correlation < options_.min_correlation || !(found.sigma < options_.max_sigma)) {
    return std::nullopt;
  }
  return found;
}

}  // namespace kinemap
