// SPDX-License-Identifier: Apache-2.0
#include "ground/scale_smoother.h"

#include <algorithm>
#include <cmath>

namespace kinemap {
namespace {

constexpr double kDriftVariance = 1e-4 / 50;  // a metre: one percent in 50 m
constexpr double kRoadSigma = 0.03;           // how flat roads are
// Samples follow each other more closely than the road changes its slope.
constexpr double kSamplesAnEvidence = 5;
constexpr double kHuber = 2;

double VarianceOf(double sigma) { return (sigma * sigma + kRoadSigma * kRoadSigma) * kSamplesAnEvidence; }

// One filter step: x, P -> updated by z.
void Update(double z, double sigma, double* x, double* variance) {
  double noise = VarianceOf(sigma);
  const double innovation = z - *x;
  const double bound = kHuber * std::sqrt(*variance + noise / kSamplesAnEvidence);
  if (std::abs(innovation) > bound) noise *= std::abs(innovation) / bound;
  const double gain = *variance / (*variance + noise);
  *x += gain * innovation;
  *variance *= 1 - gain;
}

}  // namespace

std::vector<ScaleEstimate> SmoothScale(const std::vector<ScaleMeasurement>& measurements) {
  if (measurements.empty()) return {};
  std::vector<double> all;
  for (const ScaleMeasurement& measurement : measurements) all.push_back(measurement.log_scale);
  std::nth_element(all.begin(), all.begin() + all.size() / 2, all.end());
  double x = all[all.size() / 2], variance = 0.1 * 0.1;
  std::vector<double> filtered, filtered_variance, predicted_variance;
  double way_m = measurements.front().way_m;
  for (const ScaleMeasurement& measurement : measurements) {
    variance += kDriftVariance * std::max(0.0, measurement.way_m - way_m);
    way_m = measurement.way_m;
    predicted_variance.push_back(variance);
    Update(measurement.log_scale, measurement.sigma, &x, &variance);
    filtered.push_back(x);
    filtered_variance.push_back(variance);
  }
  std::vector<ScaleEstimate> smoothed(measurements.size());
  for (size_t i = measurements.size(); i-- > 0;) {
    if (i + 1 < measurements.size()) {
      const double gain = filtered_variance[i] / predicted_variance[i + 1];
      x = filtered[i] + gain * (x - filtered[i]);
      variance = filtered_variance[i] + gain * gain * (variance - predicted_variance[i + 1]);
    }
    smoothed[i] = {x, std::sqrt(variance)};
  }
  return smoothed;
}

}  // namespace kinemap
