#include "coordinator/page/job_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "coordinator/page/html.h"
#include "schema/hash.h"
#include "schema/text.h"
#include "schema/wire/keys.h"

namespace cairn::page {
namespace {

constexpr std::size_t kLinesShown = 200;

std::string ButtonOf(const std::string& action) {
  struct Words {
    const char* word;
    const char* sure;  // asked before; empty: not asked
  };
  static const std::map<std::string, Words> kWords = {
      {"pause", {"Pause", ""}},
      {"resume", {"Resume", ""}},
      {"cancel", {"Cancel", "Cancel this job? It cannot be resumed; results of stages that are done stay."}},
      {"retry", {"Retry", ""}},
      {"delete",
       {"Delete", "Delete this job with its results? Nothing of it will be left on the coordinator."}}};
  const Words& words = kWords.at(action);
  return fmt::format("<button type=\"button\" data-action=\"{}\" data-sure=\"{}\">{}</button>\n", action,
                     words.sure, words.word);
}

std::string PriorityOf(const wire::JobInfo& job) {
  std::string options;
  for (int priority = 10; priority >= -10; --priority)
    options += fmt::format("<option{}>{}</option>", priority == job.priority() ? " selected" : "", priority);
  return "<label>Priority <select data-action=\"priority\">" + options + "</select></label>\n";
}

std::string ButtonsHtml(const wire::JobInfo& job, bool may_command) {
  if (!may_command) return "";
  std::string buttons;
  for (const std::string& action : ActionsFor(job))
    buttons += action == "priority" ? PriorityOf(job) : ButtonOf(action);
  return "<div class=\"actions scripted\" data-job=\"/jobs/" + UrlPart(job.id()) + "\">\n" + buttons +
         "</div>\n";
}

std::string StartAnotherHtml(const wire::JobInfo& job, bool may_start) {
  return !may_start ? ""
                    : "<p class=\"links\"><a href=\"/new?job=" + UrlPart(job.id()) +
                          "\">Start another job from it</a></p>\n";
}

std::string HeadHtml(const wire::JobInfo& job, bool may_command) {
  return "<div class=\"title\"><h1>" + Text(job.name()) + "</h1>" + StateBadge(job.state()) + "</div>\n" +
         "<p class=\"id\">" + Text(job.id()) + "</p>\n" + ButtonsHtml(job, may_command);
}

std::string AdviceHtml(const wire::JobInfo& job, std::size_t workers) {
  std::string html;
  if (!job.reason().empty()) html += "<p><b>" + Text(job.reason()) + "</b></p>";
  if (const std::string advice = AdviceOf(job, workers); !advice.empty())
    html += "<p>" + Text(advice) + "</p>";
  if (html.empty()) return "";
  return "<div class=\"advice " + std::string(job.state() == "failed" ? "bad" : "") + "\">" + html +
         "</div>\n";
}

// The name of a stage is known of the one under way, and of those whose rounds the log tells.
std::map<std::uint32_t, std::string> StageNames(const wire::JobInfo& job, const HistoryPtr& history) {
  std::map<std::uint32_t, std::string> names;
  for (const wire::StageInfo& stage : job.plan())
    names.emplace(static_cast<std::uint32_t>(names.size()), stage.name());
  if (!names.empty()) return names;
  std::vector<std::string> told;
  if (history)
    for (const RoundLine& round : history->rounds())
      if (std::ranges::find(told, round.stage) == told.end()) told.push_back(round.stage);
  for (std::uint32_t i = 0; i < told.size(); ++i) names[i] = told[i];
  if (!job.stage_name().empty()) names[std::min(job.stage(), job.stages() - 1)] = job.stage_name();
  return names;
}

std::string StateOfStage(const wire::JobInfo& job, std::uint32_t stage) {
  const std::uint32_t done = StagesDone(job);
  return stage < done ? "done" : stage == done ? job.state() : "not begun";
}

// Where each follows the one before alone, a list with arrows says it all.
bool IsChain(const wire::JobInfo& job) {
  for (int i = 1; i < job.plan_size(); ++i)
    if (job.plan(i).after_size() != 1 || job.plan(i).after(0) + 1 != static_cast<std::uint32_t>(i))
      return false;
  return true;
}

// From the left to the right, each stage beyond those whose results it takes.
std::string GraphHtml(const wire::JobInfo& job) {
  constexpr double kWide = 170, kHigh = 62, kPitchX = 230, kPitchY = 80, kPad = 3;
  std::vector<std::size_t> column, in_column;
  std::vector<std::pair<double, double>> corner;
  std::string boxes, lines, says;
  double width = 0, height = 0;
  for (const wire::StageInfo& stage : job.plan()) {
    std::size_t at = 0;
    for (const std::uint32_t before : stage.after())
      if (before < column.size()) at = std::max(at, column[before] + 1);
    in_column.resize(std::max(in_column.size(), at + 1));
    const double x = kPad + kPitchX * static_cast<double>(at),
                 y = kPad + kPitchY * static_cast<double>(in_column[at]++);
    const auto number = static_cast<std::uint32_t>(column.size());
    const bool now = number == StagesDone(job) && !IsOver(job);
    for (const std::uint32_t before : stage.after()) {
      if (before >= corner.size()) continue;
      const auto [from_x, from_y] = corner[before];
      lines += fmt::format("<path class=\"arrow\" d=\"M{} {}C{} {} {} {} {} {}\"/>", from_x + kWide,
                           from_y + kHigh / 2, from_x + kPitchX, from_y + kHigh / 2, x - kPitchX + kWide,
                           y + kHigh / 2, x - 8, y + kHigh / 2) +
               fmt::format("<path class=\"head\" d=\"M{} {}l-9 -5v10z\"/>", x - 1, y + kHigh / 2);
    }
    const std::string state = StateOfStage(job, number);
    boxes += fmt::format(
        "<g class=\"{}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"10\"/><text x=\"{}\" "
        "y=\"{}\"><title>{}</title>{}</text><text class=\"tick\" x=\"{}\" y=\"{}\">{} · {}</text></g>",
        now                    ? "now"
        : state == "not begun" ? "later"
                               : "",
        x, y, kWide, kHigh, x + 12, y + 27, Text(stage.name()), Text(CutTo(stage.name(), 20)), x + 12, y + 47,
        Text(CutTo(stage.pipeline(), 18)), state);
    says += (says.empty() ? "" : "; ") + Text(stage.name()) + " " + state;
    column.push_back(at);
    corner.emplace_back(x, y);
    width = std::max(width, x + kWide + kPad);
    height = std::max(height, y + kHigh + kPad);
  }
  return fmt::format(
      "<h2>Stages</h2>\n<div class=\"graph\" tabindex=\"0\"><svg viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
      "height=\"{1}\" role=\"img\" aria-label=\"Stages: {2}\">{3}{4}</svg></div>\n",
      width, height, says, lines, boxes);
}

std::string StagesHtml(const wire::JobInfo& job, const HistoryPtr& history) {
  if (!IsChain(job)) return GraphHtml(job);
  const std::map<std::uint32_t, std::string> names = StageNames(job, history);
  const std::uint32_t done = StagesDone(job);
  std::string items;
  for (std::uint32_t i = 0; i < job.stages(); ++i) {
    const bool now = i == done && !IsOver(job);
    const std::string state = StateOfStage(job, i);
    const auto name = names.find(i);
    items += fmt::format("<li class=\"{}\"{}><b>{}</b><span>{}</span></li>\n",
                         i < done ? "done"
                         : now    ? "now"
                                  : "later",
                         now ? " aria-current=\"step\"" : "",
                         name == names.end() ? "stage " + std::to_string(i + 1) : Text(name->second),
                         i < done || i == done ? StateBadge(state) : state);
  }
  return "<ol class=\"stages\" aria-label=\"Stages\">\n" + items + "</ol>\n";
}

void AddFact(std::string* html, const char* what, const std::string& value) {
  if (!value.empty()) *html += "<div><dt>" + std::string(what) + "</dt><dd>" + value + "</dd></div>\n";
}

// An owner without a name is his key, of which a part is enough.
std::string OwnerText(const wire::JobInfo& job) {
  return wire::IsPublicKey(job.owner()) ? wire::ShortKey(job.owner()) : job.owner();
}

std::string FactsHtml(const wire::JobInfo& job, std::size_t workers) {
  std::string facts;
  const double part = PartDone(job);
  if (!IsOver(job)) {
    if (part >= 0)
      AddFact(&facts, "Stage done",
              ProgressBar(part, "done of its stage") + fmt::format(" {:.0f}%", 100 * part));
    const std::string left = LeftText(job);
    const std::uint32_t later = job.stages() - std::min(job.stage() + 1, job.stages());
    AddFact(&facts, "Left of the stage",
            left.empty() ? "unknown"
                         : "about " + left + (later == 0 ? "" : ", then " + Count(later, "stage") + " more"));
    AddFact(&facts, "Round",
            fmt::format("{}{}", job.round(),
                        job.rounds_left() == 0 ? "" : fmt::format(", about {} to do", job.rounds_left())));
    if (job.tasks() > 0)
      AddFact(&facts, "Tasks of the round", fmt::format("{} of {}", job.tasks_done(), job.tasks()));
    const double share = workers == 0 ? 0 : 100.0 * job.workers() / static_cast<double>(workers);
    AddFact(&facts, "Share of the fleet",
            fmt::format("{} of {} ({:.0f}%)", job.workers(), Count(workers, "worker"), share));
  }
  AddFact(&facts, "Time, min:s", Duration(job.seconds()));
  AddFact(&facts, "Owner", Text(OwnerText(job)));
  AddFact(&facts, "Priority", std::to_string(job.priority()));
  AddFact(&facts, "Attempts that failed", job.retries() == 0 ? "" : std::to_string(job.retries()));
  const std::string note = job.note().empty() ? "" : "<p class=\"note\">" + Text(job.note()) + "</p>\n";
  return note + "<dl class=\"facts\">\n" + facts + "</dl>\n";
}

std::string ResultHtml(const wire::JobInfo& job, const ResultFiles* results) {
  const std::uint32_t done = StagesDone(job);
  if (done == 0) return "";
  const std::string base = "/jobs/" + UrlPart(job.id());
  const Result<Hash> mark = Hash::FromBinary(job.mark());
  // A browser shows no picture again that has the address of the one before.
  const std::string version =
      "?stages=" + std::to_string(done) + (mark.ok() ? "&amp;of=" + mark.value().Hex() : "");
  std::string links = "<a class=\"button\" href=\"" + base + "/report" + version + "\">Report</a>\n";
  if (results != nullptr)
    for (const std::string& stage : results->stages)
      links += "<a class=\"button\" download href=\"" + base + "/files/" + UrlPart(stage) + ".h5" + version +
               "\">" + Text(stage) + ".h5</a>\n";
  return "<h2>Result" + std::string(done < job.stages() ? " of the stages that are done" : "") + "</h2>\n" +
         "<p><a href=\"" + base + "/report" + version + "\"><img class=\"map\" src=\"" + base + "/picture" +
         version + "\" alt=\"Picture of the result of " + Text(job.name()) +
         "\"></a></p>\n<p class=\"links\">" + links + "</p>\n";
}

// In a frame of its own: a report runs in an origin of its own.
std::string SoFarHtml(const wire::JobInfo& job, const std::string& version) {
  if (version.empty()) return "";
  const std::string address = "/jobs/" + UrlPart(job.id()) + "/so-far?version=" + UrlPart(version);
  return "<h2>Map so far</h2>\n<p>As the last rounds left it; another takes its place while the job runs. It "
         "is no "
         "result.</p>\n<iframe class=\"so-far\" title=\"Map so far of " +
         Text(job.name()) + "\" src=\"" + address + "\" data-src=\"" + address +
         "\" sandbox=\"allow-scripts allow-downloads\"></iframe>\n";
}

// Those that came last are offered; the id of any other may be written.
std::string CompareHtml(const wire::JobInfo& job, const ViewContext& context) {
  constexpr std::size_t kMostNamed = 50;
  if (StagesDone(job) == 0) return "";
  std::string others, logs;
  std::size_t named = 0;
  for (const wire::JobInfo& other : context.facts.list->jobs)
    if (&other != &job && StagesDone(other) > 0 && ++named <= kMostNamed)
      others += "<option value=\"" + Text(other.id()) + "\">" + Text(other.name()) + "</option>";
  if (others.empty()) return "";
  for (const auto& [number, name] : context.brought)
    logs += "<option value=\"" + Text(number) + "\">" + Text(name) + "</option>";
  if (!logs.empty())
    logs = "<label>By the truth in <select name=\"log\"><option value=\"\">nothing</option>" + logs +
           "</select></label>\n";
  return "<form class=\"filter\" method=\"get\" action=\"/compare\">\n<input type=\"hidden\" name=\"one\" "
         "value=\"" +
         Text(job.id()) +
         "\"><label>Compare with <input name=\"other\" list=\"others\" required maxlength=\"300\" "
         "autocomplete=\"off\" placeholder=\"id of a job\"></label><datalist id=\"others\">" +
         others + "</datalist>\n" + logs + "<button>Compare</button>\n</form>\n";
}

std::string FailuresHtml(const wire::JobInfo& job) {
  std::string items;
  for (const std::string& failure : job.failures()) items += "<li>" + Text(failure) + "</li>\n";
  if (items.empty()) return "";
  return "<h2>Attempts that failed</h2>\n<p>" + Count(job.retries(), "attempt") +
         " in all; the last of them:</p>\n<ul class=\"failures\">\n" + items + "</ul>\n";
}

std::string LogHtml(const wire::JobInfo& job, const HistoryPtr& history) {
  if (!history || history->lines().empty()) return "<h2>Log</h2>\n<p class=\"empty\">Nothing yet.</p>\n";
  const std::vector<wire::LogLine>& lines = history->lines();
  const std::size_t first = lines.size() - std::min(kLinesShown, lines.size());
  std::string rows;
  for (std::size_t i = lines.size(); i-- > first;) {
    const wire::LogLine& line = lines[i];
    const std::string level = line.level() == "info" ? "" : "<b>" + Text(line.level()) + ":</b> ";
    rows += fmt::format("<li data-key=\"{}\" class=\"{}\"><time>{}</time> <span>{}{}</span></li>\n",
                        line.number(), Text(line.level()), Text(line.utc()), level, Text(line.text()));
  }
  return "<h2>Log</h2>\n<p>" +
         (lines[first].number() == 1
              ? "The newest first."
              : fmt::format("The last {}, the newest first.", Count(lines.size() - first, "line"))) +
         " <a href=\"/jobs/" + UrlPart(job.id()) +
         "/log.txt\">As text</a> <a download=\"rounds.csv\" href=\"/jobs/" + UrlPart(job.id()) +
         "/rounds.csv\">Rounds as CSV</a></p>\n<ol class=\"log\" tabindex=\"0\" " + "aria-label=\"Log\">\n" +
         rows + "</ol>\n";
}

}  // namespace

std::string StageText(const wire::JobInfo& job) {
  const std::string name = job.stage_name().empty() ? "" : " " + job.stage_name();
  return fmt::format("{}/{}{}", std::min(job.stage() + 1, job.stages()), job.stages(), name);
}

std::string TimesHtml(const FleetTimes& times, const std::string& job) {
  constexpr std::size_t kMostShown = 64;
  constexpr double kLabel = 168, kLane = 832, kRow = 20;
  const auto x = [&](double at_s) {
    return kLabel + kLane * std::clamp(1 - (times.now_s() - at_s) / FleetTimes::kKept_s, 0.0, 1.0);
  };
  std::string svg;
  double y = 0;
  bool any = false;
  for (const auto& [number, of] : times.workers()) {
    if (y >= kMostShown * kRow) break;
    svg += fmt::format(
        "<g data-key=\"{}\"><text class=\"tick\" x=\"0\" y=\"{}\">{} {}</text>"
        "<path class=\"grid\" d=\"M{} {}h{}\"/>",
        number, y + 14, number, Text(CutTo(of.name, 20)), kLabel, y + kRow - 1, kLane);
    for (const TaskSpan& span : of.spans) {
      any = any || job.empty() || span.job == job;
      const double begin = x(span.begin_s), width = std::max(1.5, x(span.end_s) - begin);
      svg += fmt::format(
          "<rect class=\"{}\" x=\"{:.1f}\" y=\"{}\" width=\"{:.1f}\" height=\"{}\"><title>{}: {}, "
          "{}</title></rect>",
          job.empty() || span.job == job ? "span" : "span other", begin,
          y + (span.job == job || job.empty() ? 3 : 7), width, span.job == job || job.empty() ? 14 : 6,
          Text(span.job), Text(span.task), Duration(span.end_s - span.begin_s));
    }
    svg += "</g>";
    y += kRow;
  }
  if (!any) return "";
  for (const int ago_s : {120, 90, 60, 30, 0})
    svg += fmt::format("<text class=\"tick {}\" x=\"{:.1f}\" y=\"{}\">{}</text>",
                       ago_s == 120 ? ""
                       : ago_s == 0 ? "end"
                                    : "middle",
                       x(times.now_s() - ago_s), y + 16, ago_s == 0 ? "now" : fmt::format("{} s ago", ago_s));
  return fmt::format(
      "<h2>Tasks by worker</h2>\n<p>{}</p>\n<div class=\"scroll\" tabindex=\"0\"><svg class=\"times\" "
      "viewBox=\"0 0 {} "
      "{}\" role=\"img\" aria-label=\"Tasks of each worker in the last two minutes\">{}</svg></div>\n{}",
      job.empty() ? "The last two minutes; tasks that are over within a part of a second are not all here."
                  : "The last two minutes: tall, its own tasks; low, those of other jobs. A long one is a "
                    "straggler, for which its round waits.",
      kLabel + kLane, y + 22, svg, SaveButton("SVG", "this time line"));
}

Parts JobParts(const std::string& id, const ViewContext& context) {
  const wire::JobInfo* job = context.facts.Find(id);
  if (job == nullptr)
    return {{"head", "<h1>" + Text(id) +
                         "</h1>\n<div class=\"advice\"><p><b>There is no such job: it was deleted, or "
                         "never was.</b></p><p><a href=\"/\">All jobs</a></p></div>\n"}};
  const std::size_t workers = context.facts.workers.size();
  const bool running = job->state() == "running";
  return {{"head", HeadHtml(*job, context.may_command)},
          {"advice", AdviceHtml(*job, workers)},
          {"stages", StagesHtml(*job, context.history)},
          {"facts", FactsHtml(*job, workers)},
          {"sofar", SoFarHtml(*job, context.so_far)},
          {"result", ResultHtml(*job, context.results) + CompareHtml(*job, context)},
          {"curves", context.history ? ChartsHtml(context.history->rounds()) : ""},
          {"times", running ? TimesHtml(context.facts.times, id) : ""},
          {"failures", FailuresHtml(*job) + StartAnotherHtml(*job, context.may_start)},
          {"log", LogHtml(*job, context.history)}};
}

}  // namespace cairn::page
