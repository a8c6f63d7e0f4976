// What `cairn export g2o` writes, given to a solver that knows nothing of Cairn: it stays at the map that was
// exported.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "datasets/evaluate/evaluate.h"
#include "datasets/evaluate/local.h"
#include "datasets/export/export.h"
#include "datasets/simulate/loop.h"
#include "datasets/simulate/office/office.h"
#include "datasets/testing.h"
#include "pipelines/registry.h"
#include "pipelines/testing/in_process.h"
#include "tests/bench/stage_option.h"

namespace cairn {
namespace {

// Poses and landmarks as g2o has them, in one vector; the heading of a landmark is none.
struct Vertex {
  Eigen::Index at = 0, size = 0;
};
struct Edge {
  std::size_t from = 0, to = 0;
  Eigen::VectorXd measured;
  Eigen::MatrixXd information;
};
struct Graph {
  std::vector<Vertex> vertices;
  Eigen::VectorXd values;
  std::set<std::size_t> fixed;
  std::vector<Edge> edges;
};

Eigen::VectorXd ReadNumbers(std::istream& in, Eigen::Index count) {
  Eigen::VectorXd numbers(count);
  for (double& number : numbers) EXPECT_TRUE(in >> number);
  return numbers;
}

Graph ReadGraph(const std::string& path) {
  Graph graph;
  std::vector<double> values;
  std::ifstream file(path);
  for (std::string line, tag; std::getline(file, line);) {
    std::istringstream in(line);
    std::size_t id = 0, to = 0;
    in >> tag >> id;
    if (tag == "FIX") {
      graph.fixed.insert(id);
    } else if (tag.starts_with("VERTEX")) {
      EXPECT_EQ(id, graph.vertices.size());
      const Eigen::VectorXd at = ReadNumbers(in, tag == "VERTEX_SE2" ? 3 : 2);
      graph.vertices.push_back({static_cast<Eigen::Index>(values.size()), at.size()});
      values.insert(values.end(), at.begin(), at.end());
    } else {
      in >> to;
      Edge edge{id, to, ReadNumbers(in, tag == "EDGE_SE2" ? 3 : 2), {}};
      const Eigen::Index n = edge.measured.size();
      edge.information.resize(n, n);
      for (Eigen::Index r = 0; r < n; ++r) {
        for (Eigen::Index c = r; c < n; ++c)
          edge.information(r, c) = edge.information(c, r) = ReadNumbers(in, 1)[0];
      }
      graph.edges.push_back(edge);
    }
  }
  graph.values = Eigen::Map<Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  return graph;
}

// As g2o's EdgeSE2 and EdgeSE2PointXY have it: where `to` lies in the frame of `from`, less where it was
// measured; of a pose in the frame of the measured one.
Eigen::VectorXd ErrorOf(const Graph& graph, const Edge& edge, const Eigen::VectorXd& values) {
  const Vertex &a = graph.vertices[edge.from], &b = graph.vertices[edge.to];
  const Eigen::Rotation2Dd back(-values[a.at + 2]);
  Eigen::VectorXd error(edge.measured.size());
  error.head<2>() =
      back * Eigen::Vector2d(values.segment<2>(b.at) - values.segment<2>(a.at)) - edge.measured.head<2>();
  if (error.size() == 2) return error;
  error.head<2>() = (Eigen::Rotation2Dd(-edge.measured[2]) * Eigen::Vector2d(error.head<2>())).eval();
  error[2] = std::remainder(values[b.at + 2] - values[a.at + 2] - edge.measured[2], 2 * std::numbers::pi);
  return error;
}

double CostOf(const Graph& graph, const Eigen::VectorXd& values) {
  double cost = 0;
  for (const Edge& edge : graph.edges) {
    const Eigen::VectorXd error = ErrorOf(graph, edge, values);
    cost += 0.5 * error.dot(edge.information * error);
  }
  return cost;
}

// The step of Gauss and Newton, derivatives by differences.
Eigen::VectorXd StepAt(const Graph& graph, const Eigen::VectorXd& values) {
  constexpr double kDifference = 1e-6, kHeld = 1e12, kFree = 1e-9;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(values.size());
  Eigen::VectorXd moved = values;
  for (const Edge& edge : graph.edges) {
    const Eigen::VectorXd error = ErrorOf(graph, edge, values);
    std::vector<Eigen::Index> at;
    for (const std::size_t vertex : {edge.from, edge.to}) {
      for (Eigen::Index k = 0; k < graph.vertices[vertex].size; ++k)
        at.push_back(graph.vertices[vertex].at + k);
    }
    Eigen::MatrixXd by(error.size(), static_cast<Eigen::Index>(at.size()));
    for (std::size_t k = 0; k < at.size(); ++k) {
      moved[at[k]] = values[at[k]] + kDifference;
      const Eigen::VectorXd ahead = ErrorOf(graph, edge, moved);
      moved[at[k]] = values[at[k]] - kDifference;
      by.col(static_cast<Eigen::Index>(k)) = (ahead - ErrorOf(graph, edge, moved)) / (2 * kDifference);
      moved[at[k]] = values[at[k]];
    }
    const Eigen::MatrixXd square = by.transpose() * edge.information * by;
    const Eigen::VectorXd pull = by.transpose() * (edge.information * error);
    for (std::size_t i = 0; i < at.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      gradient[at[i]] += pull[row];
      for (std::size_t j = 0; j < at.size(); ++j)
        entries.emplace_back(at[i], at[j], square(row, static_cast<Eigen::Index>(j)));
    }
  }
  for (Eigen::Index k = 0; k < values.size(); ++k) entries.emplace_back(k, k, kFree);
  for (const std::size_t vertex : graph.fixed) {
    for (Eigen::Index k = 0; k < graph.vertices[vertex].size; ++k)
      entries.emplace_back(graph.vertices[vertex].at + k, graph.vertices[vertex].at + k, kHeld);
  }
  Eigen::SparseMatrix<double> matrix(values.size(), values.size());
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(matrix);
  EXPECT_EQ(factors.info(), Eigen::Success);
  return -factors.solve(gradient);
}

struct Solved {
  Eigen::VectorXd values;
  double start_cost = 0, cost = 0;
};

// Steps that are halved until they help.
Solved Solve(const Graph& graph) {
  Solved solved{graph.values, CostOf(graph, graph.values), CostOf(graph, graph.values)};
  for (int round = 0; round < 50; ++round) {
    Eigen::VectorXd step = StepAt(graph, solved.values);
    double cost = CostOf(graph, solved.values + step);
    for (int halved = 0; halved < 20 && !(cost < solved.cost); ++halved) {
      step /= 2;
      cost = CostOf(graph, solved.values + step);
    }
    if (!(cost < solved.cost)) break;
    const double gain = solved.cost - cost;
    solved.values += step;
    solved.cost = cost;
    if (gain < 1e-6) break;
  }
  return solved;
}

// The result with the solver's poses and landmarks in place of its own.
Blob WithValues(Blob result, const Graph& graph, const Eigen::VectorXd& values) {
  std::size_t id = 0;
  const auto put = [&](const std::vector<std::string>& names) {
    const auto count = static_cast<std::size_t>(result.at(names[0]).size());
    for (std::size_t k = 0; k < names.size(); ++k) {
      std::vector<double> column;
      for (std::size_t i = 0; i < count; ++i)
        column.push_back(values[graph.vertices.at(id + i).at + static_cast<Eigen::Index>(k)]);
      result.PutVector(names[k], column);
    }
    id += count;
  };
  for (std::size_t r = 0; r < result.Texts("robots").size(); ++r) {
    const std::string poses = "robot/" + std::to_string(r) + "/poses/";
    const std::string prefix = poses + (result.Has(poses + "mode_x_m") ? "mode_" : "");
    put({prefix + "x_m", prefix + "y_m", prefix + "heading_rad"});
    if (prefix == poses) continue;
    for (const char* name : {"x_m", "y_m", "heading_rad"}) result.Put(poses + name, result.at(prefix + name));
  }
  if (result.Has("map/landmark_x_m")) put({"map/landmark_x_m", "map/landmark_y_m"});
  EXPECT_EQ(id, graph.vertices.size());
  return result;
}

struct Exported {
  Graph graph;
  Solved solved;
  Blob result;  // as solved
};

Exported ExportAndSolve(const Blob& result, const Blob& log) {
  const datasets::TestFolder folder;
  const Graph graph = ReadGraph(datasets::ExportG2o(result, &log, folder / "").value().at(0));
  const Solved solved = Solve(graph);
  return {graph, solved, WithValues(result, graph, solved.values)};
}

BlobPtr ResultOf(const std::string& pipeline, const Blob& log, const std::vector<std::string>& options = {}) {
  proto::Stage stage;
  stage.set_name("map");
  stage.set_pipeline(pipeline);
  for (const std::string& option : options) SetOption(option, &stage);
  return RunInProcess(*MakePipeline(stage, 1),
                      {{"log", std::make_shared<const Blob>(log.Without("truth/"))}});
}

// How far the solver moves the landmarks, on average.
double MovedM(const Exported& exported) {
  double squares = 0, count = 0;
  for (const Vertex& vertex : exported.graph.vertices) {
    if (vertex.size != 2) continue;
    squares += (exported.solved.values - exported.graph.values).segment<2>(vertex.at).squaredNorm();
    ++count;
  }
  return std::sqrt(squares / count);
}

// Of the squares of errors in their standard deviations, those at the solver's end, over as many as there
// should be where widths are right.
double SquaresOfFreedom(const Exported& exported) {
  auto freedom = static_cast<double>(3 * exported.graph.fixed.size()) -
                 static_cast<double>(exported.graph.values.size());
  for (const Edge& edge : exported.graph.edges) freedom += static_cast<double>(edge.measured.size());
  return 2 * exported.solved.cost / freedom;
}

void ExpectToStay(const Blob& log, double most_moved_m) {
  const Blob result = *ResultOf("landmark_map", log, {"starts=1"});
  const Exported exported = ExportAndSolve(result, log);
  const datasets::Evaluation before = datasets::Evaluate(result, log),
                             after = datasets::Evaluate(exported.result, log);
  EXPECT_LE(after.landmarks->rmse_m.value(), 1.1 * before.landmarks->rmse_m.value());
  EXPECT_LE(after.trajectory_rmse_m.value(), 1.1 * before.trajectory_rmse_m.value());
  EXPECT_EQ(after.landmarks->found, before.landmarks->found);
  EXPECT_LT(MovedM(exported), most_moved_m);
  EXPECT_GT(SquaresOfFreedom(exported), 0.5);
  EXPECT_LT(SquaresOfFreedom(exported), 2);
}

TEST(ExportedGraph, OfFourRobotsThatDetectContactsStaysAtTheMap) {
  ExpectToStay(datasets::SimulateLoop({.difficulty = "base", .robots = 4, .seed = 1}), 0.2);
}

TEST(ExportedGraph, OfRangesAndBearingsStaysAtTheMap) {
  datasets::SimulateLoopOptions world{.difficulty = "base", .robots = 2, .seed = 3};
  world.sensing = {.sensor = "range-bearing", .identities = true};
  ExpectToStay(datasets::SimulateLoop(world), 0.010);
}

TEST(ExportedGraph, OfALocalMapStaysAtThePath) {
  const Blob log = datasets::SimulateOffice({.minutes = 3, .seed = 2});
  const Blob result = *ResultOf("local_map", log);
  const Exported exported = ExportAndSolve(result, log);
  const datasets::LocalEvaluation before = datasets::EvaluateLocal(result, log),
                                  after = datasets::EvaluateLocal(exported.result, log);
  EXPECT_LE(after.path.rmse_m, 1.1 * before.path.rmse_m);
  EXPECT_GT(before.odometry.rmse_m, 2 * before.path.rmse_m) << "where loops are missing odometry would do";
  EXPECT_GT(exported.solved.start_cost, 1) << "edges are of the log, and not of the path itself";
}

}  // namespace
}  // namespace cairn
