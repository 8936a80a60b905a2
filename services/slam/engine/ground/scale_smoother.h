// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace kinemap {

/// One measurement of a map's scale: log of metres per map unit at some length of way (metres).
struct ScaleMeasurement {
  double way_m;
  double log_scale;
  double sigma;
};

/// A logarithm of metres per map unit and its standard deviation.
struct ScaleEstimate {
  double log_scale = 0;
  double sigma = 0;
};

/// The scale at each measurement, given all of them (`measurements` by their way): it drifts with the way like a random
/// walk (Kalman filter and smoother of Rauch, Tung and Striebel 1965), and what a slope, or something that is no road,
/// tells is limited (Huber).
std::vector<ScaleEstimate> SmoothScale(const std::vector<ScaleMeasurement>& measurements);

}  // namespace kinemap
