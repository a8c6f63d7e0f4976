#include "pipelines/landmark_map/so_far.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "pipelines/common/fan_out.h"
#include "pipelines/landmark_map/landmarks/summary.h"
#include "pipelines/landmark_map/state/partial.h"
#include "schema/kinds/map_so_far.h"

namespace cairn::landmark_map {
namespace {

// A blob of the new State: made in this step, or carried over from the one before, under whatever name.
BlobPtr Find(const std::string& hash, const State& state, const Inputs& inputs, const cairn::Step& step) {
  for (const BlobPtr& blob : step.blobs)
    if (blob->ContentHash().Binary() == hash) return blob;
  for (const auto& [name, known] : state.blobs())
    if (known == hash) return inputs.Get(name);
  return nullptr;
}

struct Shown {
  int start = 0;
  BlobPtr landmarks, path;
  kinds::MapSoFar::History history;

  // Log-likelihoods are of as much data only where the prefix is the same.
  std::pair<double, double> Rank() const {
    const double log_likelihood = history.log_likelihood.back();
    return {history.prefix.back(), std::isnan(log_likelihood) ? -HUGE_VAL : log_likelihood};
  }
};

std::optional<Shown> ShownOf(int start, const std::string& prefix, const State& state, const Inputs& inputs,
                             const cairn::Step& step) {
  const auto& blobs = step.plan.state().blobs();
  const auto history = blobs.find(prefix + "history"), landmarks = blobs.find(prefix + "landmarks");
  if (history == blobs.end() || landmarks == blobs.end()) return std::nullopt;
  const BlobPtr rows = Find(history->second, state, inputs, step);
  Shown shown{start, Find(landmarks->second, state, inputs, step), {}, {}};
  const auto path = blobs.find(prefix + "path");
  if (path != blobs.end()) shown.path = Find(path->second, state, inputs, step);
  if (!rows || !shown.landmarks) return std::nullopt;
  shown.history = FieldsIn<kinds::MapSoFar::History>("", *rows);
  if (shown.history.log_likelihood.OrNone().empty()) return std::nullopt;
  return shown;
}

// A table for each robot. Tasks hand their steps over in no order.
std::vector<kinds::MapSoFar::Robot> PathsOf(const Blob& path, std::size_t robots) {
  std::vector<std::vector<PathPoint>> of(robots);
  for (const PathPoint& at : RowsIn<PathPoint>(path)) of.at(static_cast<std::size_t>(at.robot)).push_back(at);
  std::vector<kinds::MapSoFar::Robot> paths;
  for (std::vector<PathPoint>& points : of) {
    std::ranges::sort(points, {}, &PathPoint::time_s);
    paths.push_back({{ColumnOf(points, &PathPoint::time_s), ColumnOf(points, &PathPoint::x_m),
                      ColumnOf(points, &PathPoint::y_m)}});
  }
  return paths;
}

kinds::MapSoFar MapOf(const Shown& shown, int starts, const Blob& log) {
  const Texts names = Texts::In(log, "landmarks");
  const auto rows = RowsIn<Landmark>(*shown.landmarks);
  kinds::MapSoFar map;
  map.landmarks = names.OrNone();
  map.history = shown.history;
  if (shown.path) {
    map.robots = log.Texts("robots");
    map.robot = PathsOf(*shown.path, map.robots.size());
  }
  const std::string iteration = fmt::format("iteration {}", shown.history.log_likelihood.size());
  map.what = starts > 1 ? fmt::format("start {} of {}, {}", shown.start + 1, starts, iteration) : iteration;
  map.map.landmark_x_m = ColumnOf(rows, &Landmark::x_m);
  map.map.landmark_y_m = ColumnOf(rows, &Landmark::y_m);
  map.map.landmark_count = ColumnOf(rows, &Landmark::count);
  map.map.landmark_covariance_m2 = Column<double>(shown.landmarks->at("covariance_m2"));
  const auto named = static_cast<std::int64_t>(map.landmarks.size());
  map.map.landmark_identity =
      ColumnOf(rows, [&](const Landmark& l) { return std::int32_t{l.type < named ? l.type : -1}; });
  return map;
}

}  // namespace

void ShowSoFar(const State& state, const Inputs& inputs, cairn::Step* step) {
  const int starts = StartsIn(step->plan.state());
  std::optional<Shown> best;
  for (int start = 0; start < std::max(1, starts); ++start) {
    const std::string prefix = starts == 0 ? "" : "start/" + std::to_string(start) + "/";
    auto shown = ShownOf(start, prefix, state, inputs, *step);
    if (shown && (!best || best->Rank() < shown->Rank())) best = std::move(shown);
  }
  if (!best) return;
  const std::string hash = step->Share(BlobOf(MapOf(*best, starts, *inputs.Get("log"))));
  step->plan.mutable_state()->set_so_far(hash);
}

}  // namespace cairn::landmark_map
