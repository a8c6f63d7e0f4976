#include "datasets/kinds/job_report.h"

#include "datasets/report/drawing/format.h"
#include "datasets/report/pages/facts.h"
#include "datasets/report/pages/parts.h"
#include "schema/kinds/kind.h"

namespace cairn::datasets {
namespace report {
namespace {

const ResultKind& RowOf(const ReportedStage& stage) {
  const std::string kind = KindOf(*stage.result);
  const ResultKind* row = FindResultKind(kind);
  if (row == nullptr)
    throw InputError("stage '" + stage.name + "': there is neither page nor picture of " + WithArticle(kind));
  return *row;
}

std::string BodyHtml(const ReportedStage& stage) {
  const ResultKind& row = RowOf(stage);
  std::string html;
  if (row.verdict != nullptr) {
    const Verdict verdict = row.verdict(*stage.result);
    html = "<p class=\"verdict\">How far to trust it: <b>" + std::string(Word(verdict.trust)) +
           "</b>: " + Escape(verdict.why) + ".</p>\n";
  }
  return html + row.page(stage);
}

std::string StageHtml(const ReportedStage& stage, std::size_t number) {
  return "<article id=\"stage-" + std::to_string(number) + "\">\n<h1 class=\"stage\">" + Escape(stage.name) +
         " <small>" + Escape(KindOf(*stage.result)) + "</small></h1>\n" + BodyHtml(stage) + "</article>\n";
}

std::string ContentsHtml(const std::vector<ReportedStage>& stages) {
  std::string links;
  for (std::size_t i = 0; i < stages.size(); ++i)
    links += "<a href=\"#stage-" + std::to_string(i) + "\">" + Escape(stages[i].name) + "</a>\n";
  return "<nav>\n" + links + "</nav>\n";
}

}  // namespace
}  // namespace report

std::string JobReportHtml(const std::vector<ReportedStage>& stages, const std::string& title,
                          const std::string& note) {
  CAIRN_DEMAND(!stages.empty(), "something to report on");
  const ReportedStage& last = stages.back();
  std::string html;
  if (stages.size() == 1) {
    html = report::BodyHtml(last);
  } else {
    html = report::ContentsHtml(stages);
    for (std::size_t i = 0; i < stages.size(); ++i) html += report::StageHtml(stages[i], i);
  }
  if (!note.empty()) html.insert(0, "<p class=\"verdict\">Mind: " + report::Escape(note) + ".</p>\n");
  html += report::SectionHtml("Job", report::ProvenanceHtml(*last.result));
  std::string heading = title.empty() ? report::TitleOf(*last.result) : title;
  if (heading.empty()) heading = last.name;
  return report::PageHtml(heading, html, *last.result);
}

std::string StagePicturePng(const ReportedStage& stage, int width_px) {
  return report::RowOf(stage).picture(stage, width_px);
}

}  // namespace cairn::datasets
