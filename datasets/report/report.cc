#include "datasets/report/report.h"

#include <vector>

#include "datasets/report/draw_map.h"
#include "datasets/report/facts.h"
#include "datasets/report/format.h"
#include "datasets/report/grid_page.h"
#include "datasets/report/landmark_page.h"
#include "datasets/report/local_page.h"
#include "datasets/report/localization_page.h"
#include "datasets/report/localized_figures.h"
#include "datasets/report/networks_page.h"
#include "datasets/report/parts.h"
#include "datasets/report/samples_page.h"
#include "schema/store/result_kind.h"

namespace cairn::datasets {
namespace report {
namespace {

std::string BodyHtml(const ReportedStage& stage) {
  const std::string kind = ResultKind(*stage.result);
  if (kind == "landmark_map") return LandmarkMapHtml(*stage.result, stage.source, stage.evaluation);
  if (kind == "grid_map") return GridMapHtml(*stage.result, stage.source, stage.grid_evaluation);
  if (kind == "local_map") return LocalHtml(*stage.result, stage.source, stage.local_evaluation);
  if (kind == "networks") return NetworksHtml(*stage.result);
  if (kind == "localization") return LocalizationHtml(*stage.result, stage.source);
  if (kind == "samples") return SamplesHtml(*stage.result);
  throw InputError("stage '" + stage.name + "': there is no page of a " + kind);
}

std::string StageHtml(const ReportedStage& stage, std::size_t number) {
  return "<article id=\"stage-" + std::to_string(number) + "\">\n<h1 class=\"stage\">" + Escape(stage.name) +
         " <small>" + Escape(ResultKind(*stage.result)) + "</small></h1>\n" + BodyHtml(stage) +
         "</article>\n";
}

std::string ContentsHtml(const std::vector<ReportedStage>& stages) {
  std::string links;
  for (std::size_t i = 0; i < stages.size(); ++i)
    links += "<a href=\"#stage-" + std::to_string(i) + "\">" + Escape(stages[i].name) + "</a>\n";
  return "<nav>\n" + links + "</nav>\n";
}

}  // namespace
}  // namespace report

bool HasReport(const std::string& kind) {
  return kind == "landmark_map" || kind == "grid_map" || kind == "local_map" || kind == "networks" ||
         kind == "localization" || kind == "samples";
}

std::string JobReportHtml(const std::vector<ReportedStage>& stages, const std::string& title) {
  CAIRN_DEMAND(!stages.empty(), "something to report on");
  const ReportedStage& last = stages.back();
  std::string html;
  if (stages.size() == 1) {
    html = report::BodyHtml(last);
  } else {
    html = report::ContentsHtml(stages);
    for (std::size_t i = 0; i < stages.size(); ++i) html += report::StageHtml(stages[i], i);
  }
  html += report::SectionHtml("Job", report::ProvenanceHtml(*last.result));
  std::string heading = title.empty() ? report::TitleOf(*last.result) : title;
  if (heading.empty()) heading = last.name;
  return report::PageHtml(heading, html, *last.result);
}

std::string StagePicturePng(const ReportedStage& stage, int width_px) {
  const std::string kind = ResultKind(*stage.result);
  if (kind == "landmark_map") return DrawMapPng(*stage.result, stage.source, stage.evaluation, width_px);
  if (kind == "grid_map") return DrawGridPng(*stage.result, stage.source, stage.grid_evaluation, width_px);
  if (kind == "local_map")
    return DrawScenePng(report::LocalSceneOf(*stage.result, stage.source, stage.local_evaluation), width_px);
  if (kind == "networks") return report::NetworksPng(*stage.result);
  if (kind == "localization") return report::LocalizationPng(*stage.result, stage.source);
  if (kind == "samples") return DrawScenePng(report::SamplesSceneOf(*stage.result), width_px);
  throw InputError("stage '" + stage.name + "': there is no picture of a " + kind);
}

}  // namespace cairn::datasets
