// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "optimization/pose_graph.h"
#include "optimization/relative_pose_cost.h"
#include "optimization/sim3_optimizer.h"
#include "synthetic/scene.h"

namespace kinemap {
namespace {

constexpr double kPi = 3.14159265358979;
constexpr int kNodes = 40;

SimilarityTransform OnCircle(int index) {
  const double angle = 2 * kPi * index / kNodes;
  return {Eigen::Quaterniond(Eigen::AngleAxisd(-angle, Eigen::Vector3d::UnitY())),
          {10 * std::cos(angle), 0, 10 * std::sin(angle)},
          1};
}

/// A circle whose steps each turn and shrink a little too much; the last node is tied to the first as it should be.
PoseGraph DriftedCircle(double scale_drift) {
  PoseGraph graph;
  SimilarityTransform pose = OnCircle(0);
  for (int i = 0; i < kNodes; ++i) {
    graph.nodes.push_back({i, pose, i == 0});
    SimilarityTransform step = OnCircle(i).Inverse() * OnCircle(i + 1);
    step.scale *= scale_drift;
    step.rotation = step.rotation * RotationFromVector({0, 0.002, 0.001});
    pose = pose * step;
    if (i > 0)
      graph.edges.push_back({i - 1, i, graph.nodes[i - 1].map_from_node.Inverse() * graph.nodes[i].map_from_node});
  }
  graph.edges.push_back({0, kNodes - 1, OnCircle(0).Inverse() * OnCircle(kNodes - 1), 10});
  return graph;
}

double WorstDistance(const PoseGraph& graph) {
  double worst = 0;
  for (int i = 0; i < kNodes; ++i) {
    worst = std::max(worst, (graph.nodes[i].map_from_node.translation - OnCircle(i).translation).norm());
  }
  return worst;
}

TEST(PoseGraph, ClosesACircleAndTakesBackItsScaleDrift) {
  PoseGraph graph = DriftedCircle(0.99);
  const double before = WorstDistance(graph);
  ASSERT_LT(graph.nodes.back().map_from_node.scale, 0.7);
  SolvePoseGraph({}, &graph);
  const PoseGraphNode& last = graph.nodes.back();
  EXPECT_NEAR(last.map_from_node.scale, 1, 0.01);
  EXPECT_LT((last.map_from_node.translation - OnCircle(kNodes - 1).translation).norm(), 0.1);
  EXPECT_LT(WorstDistance(graph), before / 3);
  EXPECT_EQ(graph.nodes[0].map_from_node.translation, OnCircle(0).translation);
}

TEST(PoseGraph, KeepsTheScaleWhereItIsKnown) {
  PoseGraph graph = DriftedCircle(1);
  const double before = WorstDistance(graph);
  PoseGraphOptions options;
  options.fixed_scale = true;
  SolvePoseGraph(options, &graph);
  EXPECT_LT(WorstDistance(graph), before / 3);
  for (const PoseGraphNode& node : graph.nodes) EXPECT_EQ(node.map_from_node.scale, 1.0);
}

TEST(PoseGraph, LeavesAGraphThatAgreesAsItIs) {
  PoseGraph graph;
  for (int i = 0; i < 5; ++i) graph.nodes.push_back({i, OnCircle(i), i == 0});
  for (int i = 1; i < 5; ++i) graph.edges.push_back({i - 1, i, OnCircle(i - 1).Inverse() * OnCircle(i)});
  SolvePoseGraph({}, &graph);
  for (int i = 0; i < 5; ++i) {
    EXPECT_LT((graph.nodes[i].map_from_node.translation - OnCircle(i).translation).norm(), 1e-9);
  }
}

TEST(RelativePoseCost, ItsDerivativesAreThoseOfItsResidual) {
  const RelativePoseCost cost({RotationFromVector({0.3, 0.1, -0.2}), {1, 2, -1}, 1.3}, {2, 3, 4});
  const SimilarityManifold manifold(false);
  double values[2][kSimilaritySize];
  WriteSimilarity({RotationFromVector({0.1, -0.5, 0.2}), {0.5, 0.2, 3}, 0.8}, values[0]);
  WriteSimilarity({RotationFromVector({0.5, -0.3, 0.1}), {1.5, 2, 1}, 1.1}, values[1]);
  const double* parameters[] = {values[0], values[1]};
  double residuals[7], jacobian[2][7 * kSimilaritySize];
  double* jacobians[] = {jacobian[0], jacobian[1]};
  cost.Evaluate(parameters, residuals, jacobians);
  for (int node = 0; node < 2; ++node) {
    for (int column = 0; column < 7; ++column) {
      double ahead[7], behind[7], moved[kSimilaritySize];
      for (const double sign : {1.0, -1.0}) {
        double step[7] = {};
        step[column] = sign * 1e-6;
        manifold.Plus(values[node], step, moved);
        const double* moved_parameters[] = {node == 0 ? moved : values[0], node == 1 ? moved : values[1]};
        cost.Evaluate(moved_parameters, sign > 0 ? ahead : behind, nullptr);
      }
      for (int row = 0; row < 7; ++row) {
        EXPECT_NEAR(jacobian[node][row * kSimilaritySize + column], (ahead[row] - behind[row]) / 2e-6, 1e-6)
            << node << " " << row << " " << column;
      }
    }
  }
}

TEST(Sim3Optimizer, RefinesAndLeavesOutWhatDoesNotFit) {
  const SimilarityTransform truth(RotationFromVector({0.02, -0.1, 0.03}), {0.4, -0.1, 0.3}, 1.2);
  const CameraModel camera = synthetic::TestCamera();
  const synthetic::Scene scene(60, 2, 6, 12);
  std::vector<PointPair> pairs;
  for (const Eigen::Vector3d& point : scene.points()) {
    PointPair pair{point, truth.Inverse() * point, camera.Project(point), {}, 1, 1};
    pair.second_px = camera.Project(pair.in_second);
    pairs.push_back(pair);
  }
  for (int i = 0; i < 6; ++i) pairs[i].first_px.x() += 40;
  const SimilarityTransform guess(RotationFromVector({0, -0.12, 0.02}), {0.5, 0, 0.2}, 1.1);
  const Sim3Estimate free = Sim3Optimizer(camera, false).Optimize(guess, pairs);
  EXPECT_EQ(free.inliers, 54);
  EXPECT_FALSE(free.inlier[0]);
  EXPECT_NEAR(free.first_from_second.scale, 1.2, 1e-5);
  EXPECT_LT((free.first_from_second.translation - truth.translation).norm(), 1e-4);
  EXPECT_EQ(Sim3Optimizer(camera, true).Optimize(guess, pairs).first_from_second.scale, 1.1);
}

TEST(Sim3Optimizer, FindsTheScaleOfTwoCamerasInOnePlace) {
  const SimilarityTransform truth(RotationFromVector({0.02, -0.1, 0.03}), {0, 0, 0}, 0.7);
  const CameraModel camera = synthetic::TestCamera();
  const synthetic::Scene scene(60, 2, 6, 12);
  std::vector<PointPair> pairs;
  for (const Eigen::Vector3d& point : scene.points()) {
    PointPair pair{point, truth.Inverse() * point, camera.Project(point), {}, 1, 1};
    pair.second_px = camera.Project(pair.in_second);
    pairs.push_back(pair);
  }
  const SimilarityTransform guess(truth.rotation, {0.1, 0, 0.1}, 1.1);
  EXPECT_NEAR(Sim3Optimizer(camera, false).Optimize(guess, pairs).first_from_second.scale, 0.7, 1e-3);
}

}  // namespace
}  // namespace kinemap
