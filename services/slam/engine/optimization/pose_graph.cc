// SPDX-License-Identifier: Apache-2.0
#include "optimization/pose_graph.h"

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <array>

#include "optimization/relative_pose_cost.h"

namespace kinemap {
namespace {
// Two nodes at one place would give the translation between them an endless weight.
constexpr double kShortestLength = 1e-3;
}  // namespace

void SolvePoseGraph(const PoseGraphOptions& options, PoseGraph* graph) {
  std::vector<std::array<double, kSimilaritySize>> blocks(graph->nodes.size());
  for (size_t i = 0; i < blocks.size(); ++i) WriteSimilarity(graph->nodes[i].map_from_node, blocks[i].data());

  SimilarityManifold manifold(options.fixed_scale);
  ceres::Problem::Options problem_options;
  problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  for (size_t i = 0; i < blocks.size(); ++i) {
    problem.AddParameterBlock(blocks[i].data(), kSimilaritySize, &manifold);
    if (graph->nodes[i].fixed) problem.SetParameterBlockConstant(blocks[i].data());
  }
  for (const PoseGraphEdge& edge : graph->edges) {
    const double length = std::max(edge.first_from_second.translation.norm(), kShortestLength);
    const RelativePoseWeights weights{edge.trust / (options.relative_length * length),
                                      edge.trust / options.rotation_rad, edge.trust / options.relative_scale};
    problem.AddResidualBlock(new RelativePoseCost(edge.first_from_second, weights), nullptr, blocks[edge.first].data(),
                             blocks[edge.second].data());
  }
  ceres::Solver::Options solver_options;
  solver_options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver_options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;  // as in bundle_adjustment.cc
  solver_options.max_num_iterations = options.iterations;
  solver_options.function_tolerance = options.tolerance;
  solver_options.num_threads = 1;
  solver_options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options, &problem, &summary);
  for (size_t i = 0; i < blocks.size(); ++i) {
    if (!graph->nodes[i].fixed) graph->nodes[i].map_from_node = ReadSimilarity(blocks[i].data());
  }
}

}  // namespace kinemap
