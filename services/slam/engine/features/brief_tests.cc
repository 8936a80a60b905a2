// SPDX-License-Identifier: Apache-2.0
#include "features/brief_tests.h"

#include <algorithm>
#include <opencv2/features2d.hpp>
#include <optional>

namespace kinemap {
namespace {

constexpr int kCenterPx = 40;
constexpr int kPatchRadiusPx = 15;
constexpr int kBlurRadiusPx = 3;  // OpenCV smooths with 7x7 pixels before it tests

/// What an edge moves along: columns, rows or their sum.
struct Axis {
  int column, row;
  int Along(int x, int y) const { return column * x + row * y; }
  int Reach(int of_one) const { return (column + row) * of_one; }
};

/// Where a test's two pixels lie along an axis; nothing when both lie at the same place.
struct Interval {
  int a, b;
};
using Intervals = std::array<std::optional<Interval>, 256>;

class EdgeProbe {
 public:
  EdgeProbe() : orb_(cv::ORB::create(1, 1.2f, 1, 19)), image_(2 * kCenterPx + 1, 2 * kCenterPx + 1, CV_8U) {}

  /// The tests that find a darker than b when pixels from `edge` on (or, `falling`, those before it) are white.
  cv::Mat Descriptor(const Axis& axis, int edge, bool falling) {
    for (int row = 0; row < image_.rows; ++row) {
      for (int column = 0; column < image_.cols; ++column) {
        const bool beyond = axis.Along(column - kCenterPx, row - kCenterPx) >= edge;
        image_.at<uint8_t>(row, column) = beyond != falling ? 255 : 0;
      }
    }
    std::vector<cv::KeyPoint> center{cv::KeyPoint(kCenterPx, kCenterPx, 31, 0, 1, 0)};
    cv::Mat descriptor;
    orb_->compute(image_, center, descriptor);
    return descriptor;
  }

 private:
  cv::Ptr<cv::ORB> orb_;
  cv::Mat image_;
};

/// A test answers yes while the smoothed edge lies between its pixels, so its first and last yes tell where they are.
Intervals Measure(const Axis& axis, EdgeProbe* probe) {
  Intervals intervals;
  const int blur = axis.Reach(kBlurRadiusPx), reach = axis.Reach(kPatchRadiusPx) + blur;
  for (const bool falling : {false, true}) {
    for (int edge = -reach; edge <= reach; ++edge) {
      const cv::Mat descriptor = probe->Descriptor(axis, edge, falling);
      for (int test = 0; test < 256; ++test) {
        if ((descriptor.at<uint8_t>(0, test / 8) >> test % 8 & 1) == 0) continue;
        if (!intervals[test]) intervals[test] = falling ? Interval{0, edge + blur - 1} : Interval{edge + blur - 1, 0};
        (falling ? intervals[test]->a : intervals[test]->b) = edge - blur;
      }
    }
  }
  return intervals;
}

std::array<BriefTest, 256> ReadTests() {
  EdgeProbe probe;
  const Intervals columns = Measure({1, 0}, &probe), rows = Measure({0, 1}, &probe), sums = Measure({1, 1}, &probe);
  std::array<BriefTest, 256> tests;
  for (int i = 0; i < 256; ++i) {
    // Two different pixels agree in one of the three at most, and that one follows from the others.
    const Interval x = columns[i] ? *columns[i] : Interval{sums[i]->a - rows[i]->a, sums[i]->b - rows[i]->b};
    const Interval y = rows[i] ? *rows[i] : Interval{sums[i]->a - columns[i]->a, sums[i]->b - columns[i]->b};
    tests[i] = {x.a, y.a, x.b, y.b};
  }
  return tests;
}

}  // namespace

const std::array<BriefTest, 256>& LearnedBriefTests() {
  static const std::array<BriefTest, 256> tests = ReadTests();
  return tests;
}

}  // namespace kinemap
