#include "datasets/kinds/result_kinds.h"

#include <fmt/core.h>

#include <algorithm>

#include "datasets/common/occupancy.h"
#include "datasets/report/draw_map.h"
#include "datasets/report/pages/pages.h"
#include "datasets/verdicts/grid_map_verdict.h"
#include "datasets/verdicts/landmark_map_verdict.h"
#include "datasets/verdicts/local_map_verdict.h"
#include "datasets/verdicts/localization_verdict.h"
#include "datasets/verdicts/networks_verdict.h"
#include "schema/kinds/grid_map.h"
#include "schema/kinds/local_map.h"

namespace cairn::datasets {
namespace {

// Null where the stage was not evaluated.
template <class T>
const T* EvaluationOf(const ReportedStage& stage) {
  return stage.evaluated ? &std::get<T>(*stage.evaluated) : nullptr;
}

bool HasTruth(const Blob& log) { return !log.Sub("truth/").fields().empty(); }

bool HasTruePoses(const Blob& log) {
  return std::ranges::any_of(log.Sub("truth/robot/").fields(),
                             [](const auto& field) { return field.first.ends_with("/poses/time_s"); });
}

Evaluated EvaluateGridOf(const Blob& map, const Blob& truth, const ScoreOptions&) {
  return truth.Has("map/grid/probability") ? CompareGrids(map, truth) : EvaluateGrid(map, truth);
}

Scores SummaryOfLandmarkMap(const Blob& map) {
  const auto landmarks = static_cast<std::int64_t>(map.at("map/landmark_x_m").size());
  const auto likelihood = map.Get<double>("history/log_likelihood");
  const auto iterations = static_cast<std::int64_t>(likelihood.size());
  Scores scores;
  scores.AddForPeople("found",
                      fmt::format("{} landmark{} in {} iteration{}, log-likelihood {:.1f}", landmarks,
                                  landmarks == 1 ? "" : "s", iterations, iterations == 1 ? "" : "s",
                                  likelihood.empty() ? 0.0 : likelihood.back()));
  scores.AddForPrograms("landmarks", landmarks);
  scores.AddForPrograms("iterations", iterations);
  scores.AddForPrograms("log_likelihood",
                        likelihood.empty() ? ScoreValue() : ScoreValue(double{likelihood.back()}));
  return scores;
}

Scores SummaryOfLocalMap(const Blob& result) {
  const auto map = Read<kinds::LocalMap>(result);
  const auto traces = static_cast<std::int64_t>(map.traces.robot.size());
  Scores scores;
  const double reach_m = LocalGridsReach_m(result);
  scores.AddForPeople("found",
                      fmt::format("{} trace{}, joined by {} connections{}", traces, traces == 1 ? "" : "s",
                                  map.connections.kind.size(),
                                  reach_m > 0 ? fmt::format(", in grids that reach {:g} m", reach_m) : ""));
  scores.AddForPrograms("traces", traces);
  scores.AddForPrograms("connections", static_cast<std::int64_t>(map.connections.kind.size()));
  scores.AddForPrograms("grids_reach_m", reach_m > 0 ? ScoreValue(reach_m) : ScoreValue());
  return scores;
}

Scores SummaryOfGridMap(const Blob& result) {
  const auto map = Read<kinds::GridMap>(result);
  const Shape& shape = map.grid.probability.shape();
  const double cell_m = map.grid.cell_m.Scalar();
  const std::int64_t occupied =
      std::ranges::count_if(KnownProbabilities(map.grid), [](double p) { return p > 0.5; });
  Scores scores;
  scores.AddForPeople("found", fmt::format("{:.1f} by {:.1f} m in cells of {:g} m, {} of them occupied",
                                           static_cast<double>(shape[1]) * cell_m,
                                           static_cast<double>(shape[0]) * cell_m, cell_m, occupied));
  scores.AddForPrograms("cell_m", cell_m);
  scores.AddForPrograms("occupied", occupied);
  return scores;
}

constexpr ResultKind kResultKinds[] = {
    {.name = "landmark_map",
     .is_map = true,
     .made_of = "log",
     .has_truth = HasTruth,
     .evaluate = [](const Blob& map, const Blob& log, const ScoreOptions& options) -> Evaluated {
       return Evaluate(map, log, options.reference_point);
     },
     .page =
         [](const ReportedStage& s) {
           return report::LandmarkMapHtml(*s.result, s.source, EvaluationOf<Evaluation>(s));
         },
     .picture =
         [](const ReportedStage& s, int width_px) {
           return DrawMapPng(*s.result, s.source, EvaluationOf<Evaluation>(s), width_px);
         },
     .summary = SummaryOfLandmarkMap,
     .verdict = LandmarkMapVerdict,
     .exports = "csv euroc g2o geojson kitti mcap octomap ply png ros tum"},
    {.name = "grid_map",
     .is_map = true,
     .made_of = "log",
     .has_truth = HasTruth,
     .evaluate = EvaluateGridOf,
     .compares = true,
     .page =
         [](const ReportedStage& s) {
           return report::GridMapHtml(*s.result, s.source, EvaluationOf<GridEvaluation>(s));
         },
     .picture =
         [](const ReportedStage& s, int width_px) {
           return DrawGridPng(*s.result, s.source, EvaluationOf<GridEvaluation>(s), width_px);
         },
     .summary = SummaryOfGridMap,
     .verdict = GridMapVerdict,
     .exports = "mcap octomap ply png ros",
     .tells_free_space = true},
    {.name = "local_map",
     .is_map = true,
     .made_of = "log",
     .has_truth = HasTruePoses,
     .evaluate = [](const Blob& map, const Blob& log, const ScoreOptions&) -> Evaluated {
       return EvaluateLocal(map, log);
     },
     .page =
         [](const ReportedStage& s) {
           return report::LocalHtml(*s.result, s.source, EvaluationOf<LocalEvaluation>(s));
         },
     .picture =
         [](const ReportedStage& s, int width_px) {
           return DrawScenePng(report::LocalSceneOf(*s.result, s.source, EvaluationOf<LocalEvaluation>(s)),
                               width_px);
         },
     .summary = SummaryOfLocalMap,
     .verdict = LocalMapVerdict,
     .exports = "csv euroc g2o geojson kitti mcap ply png tum"},
    {.name = "networks",
     .made_of = "samples",
     .evaluate = [](const Blob& networks, const Blob& samples, const ScoreOptions& options) -> Evaluated {
       return EvaluateNetworks(networks, samples, options);
     },
     .takes_score_options = true,
     .page_takes_source = false,
     .page = [](const ReportedStage& s) { return report::NetworksHtml(*s.result); },
     .picture = [](const ReportedStage& s, int) { return report::NetworksPng(*s.result); },
     .verdict = NetworksVerdict},
    {.name = "localization",
     .made_of = "samples",
     .evaluate = [](const Blob& result, const Blob& samples, const ScoreOptions&) -> Evaluated {
       return EvaluateLocalization(result, samples);
     },
     .page = [](const ReportedStage& s) { return report::LocalizationHtml(*s.result, s.source); },
     .picture = [](const ReportedStage& s, int) { return report::LocalizationPng(*s.result, s.source); },
     .verdict = LocalizationVerdict},
    {.name = "map_so_far",
     .is_map = true,
     .page_takes_source = false,
     .page = [](const ReportedStage& s) { return report::SoFarHtml(*s.result); },
     .picture = [](const ReportedStage& s, int width_px) { return report::SoFarPng(*s.result, width_px); }},
    {.name = "samples",
     .page_takes_source = false,
     .page = [](const ReportedStage& s) { return report::SamplesHtml(*s.result); },
     .picture = [](const ReportedStage& s,
                   int width_px) { return DrawScenePng(report::SamplesSceneOf(*s.result), width_px); }},
};

}  // namespace

std::span<const ResultKind> ResultKinds() { return kResultKinds; }

const ResultKind* FindResultKind(std::string_view name) {
  const ResultKind* kind = std::ranges::find(kResultKinds, name, &ResultKind::name);
  return kind == std::end(kResultKinds) ? nullptr : kind;
}

}  // namespace cairn::datasets
