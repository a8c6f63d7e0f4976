#include "datasets/kinds/job_report.h"

#include <algorithm>
#include <sstream>

#include "datasets/common/array_text.h"
#include "datasets/report/drawing/format.h"
#include "datasets/report/pages/facts.h"
#include "datasets/report/pages/parts.h"
#include "schema/kinds/kind.h"
#include "schema/kinds/provenance.h"

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

Scores ScoresOf(const ReportedStage& stage) {
  if (stage.evaluated) return MakeScores(*stage.evaluated);
  const auto summary = RowOf(stage).summary;
  return summary == nullptr ? Scores() : summary(*stage.result);
}

std::vector<std::string> JobLines(const Blob& result) {
  std::vector<std::string> lines;
  if (const Texts yaml = kinds::Provenance::In(result).job_yaml) {
    std::istringstream text(yaml.Scalar());
    for (std::string line; std::getline(text, line);) lines.push_back(line);
  }
  return lines;
}

// Of what one job says and the other does not, in their order.
Table DifferentLines(const Blob& a, const Blob& b, const Table::value_type& head) {
  Table rows{head};
  const std::vector<std::string> of_a = JobLines(a), of_b = JobLines(b);
  const auto add = [&](const std::vector<std::string>& lines, const std::vector<std::string>& others,
                       bool first) {
    for (const std::string& line : lines) {
      if (std::ranges::find(others, line) != others.end()) continue;
      rows.push_back(first ? Table::value_type{line, ""} : Table::value_type{"", line});
    }
  };
  add(of_a, of_b, true);
  add(of_b, of_a, false);
  return rows;
}

// Who computed each, and when: of what differs.
Table DifferentOrigins(const Blob& a, const Blob& b, const Table::value_type& head) {
  const auto said = [](const Blob& result) {
    const kinds::Provenance of = kinds::Provenance::In(result);
    const auto text = [](const Texts& texts) { return texts ? texts.Scalar() : std::string(); };
    const auto number = [](const auto& column, const char* unit) {
      return column ? cairn::datasets::ShortNumber(static_cast<double>(column.Scalar())) + unit
                    : std::string();
    };
    std::string hosts;
    for (const std::string& host : of.hosts.OrNone()) hosts += (hosts.empty() ? "" : ", ") + host;
    return Table{{"version", text(of.version)},
                 {"build", text(of.build)},
                 {"finished", text(of.finished_utc)},
                 {"took", number(of.seconds_s, " s")},
                 {"workers", number(of.workers, "")},
                 {"hosts", hosts},
                 {"attempts that failed", number(of.retries, "")}};
  };
  Table rows{{"", head[0], head[1]}};
  const Table of_a = said(a), of_b = said(b);
  for (std::size_t i = 0; i < of_a.size(); ++i)
    if (of_a[i][1] != of_b[i][1]) rows.push_back({of_a[i][0], of_a[i][1], of_b[i][1]});
  return rows;
}

std::string PairHtml(const ReportedPair& pair, const std::string& a, const std::string& b) {
  if (KindOf(*pair.a.result) != KindOf(*pair.b.result))
    throw InputError("'" + pair.a.name + "' is " + WithArticle(KindOf(*pair.a.result)) + " and '" +
                     pair.b.name + "' is " + WithArticle(KindOf(*pair.b.result)) +
                     ": only results of a kind can be compared");
  Table scores{{"", a, b, "difference"}};
  std::int64_t same = 0;
  for (const auto& row : Scores::Compared(ScoresOf(pair.a), ScoresOf(pair.b))) {
    if (row[1] == row[2])
      ++same;
    else
      scores.emplace_back(row.begin(), row.end());
  }
  const Table lines = DifferentLines(*pair.a.result, *pair.b.result, {a, b});
  const auto compared = [](const Table& rows) {
    return rows.size() > 1 ? "<div class=\"compared\">\n" + TableHtml(rows) + "</div>\n" : std::string();
  };
  std::string html = SectionHtml(
      "Scores", compared(scores) + (same > 0 ? "<p>" + Count(same, "score") + " the same.</p>\n" : ""));
  html += SectionHtml("Jobs", lines.size() > 1 ? compared(lines) : "<p>The jobs say the same.</p>\n");
  html +=
      SectionHtml("Where they come from", compared(DifferentOrigins(*pair.a.result, *pair.b.result, {a, b})));
  html += "<div class=\"beside\">\n";
  for (const auto& [stage, name] : {std::pair(&pair.a, &a), std::pair(&pair.b, &b)})
    html += "<article>\n<h1 class=\"stage\">" + Escape(*name) + " <small>" + Escape(KindOf(*stage->result)) +
            "</small></h1>\n" + BodyHtml(*stage) + "</article>\n";
  return html + "</div>\n";
}

}  // namespace
}  // namespace report

std::string ComparisonHtml(const std::vector<ReportedPair>& pairs, const std::string& a,
                           const std::string& b) {
  CAIRN_DEMAND(!pairs.empty(), "something to compare");
  std::string html;
  for (const ReportedPair& pair : pairs) html += report::PairHtml(pair, a, b);
  return report::PageHtml(a + " beside " + b, html, *pairs.front().a.result);
}

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
