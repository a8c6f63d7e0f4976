#include "coordinator/page/views.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "coordinator/page/assets.h"
#include "coordinator/page/html.h"
#include "coordinator/page/job_view.h"
#include "schema/text.h"

namespace cairn::page {
namespace {

constexpr std::array kStates = {"running", "queued", "paused", "failed", "done", "cancelled"};

std::string Lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

std::string Tile(const std::string& value, const std::string& what, const std::string& more = "") {
  return "<div class=\"tile\"><b>" + value + "</b><span>" + what + "</span>" + more + "</div>\n";
}

std::string StoreTile(const coordinator::StoreFacts& store) {
  if (store.limit_bytes == 0) return Tile(Text(BytesText(store.bytes)), "in the store");
  const double part = static_cast<double>(store.bytes) / static_cast<double>(store.limit_bytes);
  return Tile(
      Text(BytesText(store.bytes)), "in the store, of " + Text(BytesText(store.limit_bytes)),
      fmt::format("<meter min=\"0\" max=\"1\" low=\"0.8\" high=\"0.9\" optimum=\"0\" value=\"{:.3f}\" "
                  "aria-label=\"{:.0f}% of the store's limit\"></meter>",
                  part, 100 * part));
}

std::string SummaryHtml(const Facts& facts, bool may_start) {
  std::map<std::string, std::size_t> counts;
  for (const wire::JobInfo& job : facts.list->jobs) ++counts[job.state()];
  std::string tiles;
  for (const char* state : kStates)
    if (counts[state] > 0)
      tiles += fmt::format("<a class=\"tile\" href=\"/?state={0}\"><b>{1}</b>{2}</a>\n", state, counts[state],
                           StateBadge(state));
  const auto busy = std::ranges::count_if(facts.workers, [](const auto& w) { return w.assigned() > 0; });
  tiles += fmt::format("<a class=\"tile\" href=\"/workers\"><b>{} of {}</b><span>workers busy</span></a>\n",
                       busy, facts.workers.size());
  const std::string start =
      may_start ? "<p class=\"links\"><a class=\"button main\" href=\"/new\">Start a job</a></p>\n" : "";
  return start + "<div class=\"tiles\">\n" + tiles + StoreTile(facts.list->store) + "</div>\n";
}

std::vector<const wire::JobInfo*> Chosen(const View& view, const Facts& facts) {
  const std::string search = Lower(view.search);
  std::vector<const wire::JobInfo*> chosen;
  for (const wire::JobInfo& job : facts.list->jobs) {
    if (view.state == "active" ? IsOver(job) : !view.state.empty() && job.state() != view.state) continue;
    if (!search.empty() && Lower(job.id()).find(search) == std::string::npos &&
        Lower(job.name()).find(search) == std::string::npos)
      continue;
    chosen.push_back(&job);
  }
  return chosen;
}

std::string Cell(const char* label, const std::string& html, const char* kind = "") {
  return fmt::format("<td data-label=\"{}\" class=\"{}\">{}</td>", label, kind, html);
}

std::string JobRow(const wire::JobInfo& job, std::size_t workers) {
  std::string progress = job.state() == "done" ? "" : ProgressBar(PartDone(job), "done of its stage");
  if (job.tasks() > 0 && !IsOver(job))
    progress +=
        fmt::format("<small>{}/{} tasks of round {}</small>", job.tasks_done(), job.tasks(), job.round());
  const std::string share =
      IsOver(job) || job.workers() == 0 ? "" : fmt::format("{} of {}", job.workers(), workers);
  const std::string& said = job.reason().empty() ? job.note() : job.reason();
  return "<tr data-key=\"" + Text(job.id()) + "\"><th scope=\"row\"><a href=\"/jobs/" + UrlPart(job.id()) +
         "\">" + Text(job.name()) + "</a><small>" + Text(job.id()) + "</small></th>" +
         Cell("State", StateBadge(job.state())) + Cell("Stage", Text(StageText(job))) +
         Cell("Progress", progress, "wide") + Cell("Left", Text(LeftText(job)), "number") +
         Cell("Workers", share, "number") + Cell("Time", Duration(job.seconds()), "number") +
         Cell("Says", Text(CutTo(said, 160)), "said") + "</tr>\n";
}

std::string PageLink(View view, std::uint64_t page, bool there, const char* word) {
  if (!there) return fmt::format("<span aria-disabled=\"true\">{}</span>", word);
  view.page = page;
  return fmt::format("<a href=\"{}\">{}</a>", Text(view.Address()), word);
}

std::string Pager(const View& view, std::uint64_t page, std::uint64_t pages, std::uint64_t first,
                  std::uint64_t last, std::uint64_t all) {
  if (pages <= 1) return "<p class=\"pager\">" + Count(all, "job") + "</p>\n";
  const std::string shown = fmt::format("<span>{} to {} of {}</span>", first, last, Count(all, "job"));
  return "<nav class=\"pager\" aria-label=\"Pages\">" + PageLink(view, 1, page > 1, "First") +
         PageLink(view, page - 1, page > 1, "Previous") + shown +
         PageLink(view, page + 1, page < pages, "Next") + PageLink(view, pages, page < pages, "Last") +
         "</nav>\n";
}

std::string JobsHtml(const View& view, const Facts& facts) {
  const std::vector<const wire::JobInfo*> chosen = Chosen(view, facts);
  if (chosen.empty())
    return facts.list->jobs.empty()
               ? "<p class=\"empty\">There are no jobs yet: “cairn submit” sends one.</p>\n"
               : "<p class=\"empty\">No job is like that. <a href=\"/\">All jobs</a></p>\n";
  const std::uint64_t pages = (chosen.size() + kJobsOnAPage - 1) / kJobsOnAPage;
  const std::uint64_t page = std::clamp<std::uint64_t>(view.page, 1, pages);
  const std::uint64_t first = (page - 1) * kJobsOnAPage;
  const std::uint64_t last = std::min<std::uint64_t>(first + kJobsOnAPage, chosen.size());
  std::string rows;
  for (std::uint64_t i = first; i < last; ++i) rows += JobRow(*chosen[i], facts.workers.size());
  return "<table class=\"cards\">\n<thead><tr><th>Job</th><th>State</th><th>Stage</th><th>Progress of the "
         "stage</th>"
         "<th class=\"number\">Left</th><th class=\"number\">Workers</th><th class=\"number\">Time, "
         "min:s</th>"
         "<th>Says</th></tr></thead>\n<tbody>\n" +
         rows + "</tbody>\n</table>\n" + SaveButton("CSV", "this table") +
         Pager(view, page, pages, first + 1, last, chosen.size());
}

std::string RefusalsHtml(const Facts& facts) {
  std::string items;
  for (const auto& [kind, count] : facts.list->refused)
    items += "<tr><th scope=\"row\">" + Text(kind) + "</th><td class=\"number\">" + std::to_string(count) +
             "</td></tr>\n";
  if (items.empty()) return "<h2>Refused</h2>\n<p class=\"empty\">Nothing since the coordinator began.</p>\n";
  return "<h2>Refused</h2>\n<p>How often, since the coordinator began; its log says who.</p>\n"
         "<table class=\"narrow\"><thead><tr><th>What was wrong</th><th "
         "class=\"number\">Times</th></tr></thead>"
         "<tbody>\n" +
         items + "</tbody></table>\n" + SaveButton("CSV", "this table");
}

std::string WorkerRow(const wire::WorkerInfo& worker) {
  const std::size_t colon = worker.task().find(": ");
  std::string task;
  if (worker.assigned() > 0 && colon != std::string::npos) {
    const std::string job = worker.task().substr(0, colon);
    task = "<a href=\"/jobs/" + UrlPart(job) + "\">" + Text(job) +
           "</a>: " + Text(worker.task().substr(colon + 2));
  } else if (worker.assigned() > 0) {
    task = Text(worker.task());
  }
  return fmt::format("<tr data-key=\"{0}\"><th scope=\"row\">{0}</th>", worker.number()) +
         Cell("Name", Text(worker.name()), "said") +
         Cell("Host, process", Text(worker.host()) + ", " + std::to_string(worker.pid()), "said") +
         Cell("State", StateBadge(worker.state())) + Cell("Task", task, "said") +
         Cell("For", worker.assigned() > 0 ? Duration(worker.task_s()) : "", "number") +
         Cell("Load", worker.load() > 0 ? fmt::format("{:.2f}", worker.load()) : "", "number") +
         Cell("Memory", worker.memory_bytes() > 0 ? BytesText(worker.memory_bytes()) : "", "number") +
         Cell("Here", Duration(worker.joined_s()), "number") +
         Cell("Failures", std::to_string(worker.failures()), "number") +
         Cell("Silent", Duration(worker.silent_s()), "number") + "</tr>\n";
}

std::string WorkersHtml(const Facts& facts) {
  constexpr std::size_t kMostShown = 500;
  if (facts.workers.empty())
    return "<p class=\"empty\">No worker is connected: start one with “cairn worker”, here or on other "
           "machines.</p>\n";
  std::string rows;
  for (std::size_t i = 0; i < std::min(kMostShown, facts.workers.size()); ++i)
    rows += WorkerRow(facts.workers[i]);
  const std::string more = facts.workers.size() <= kMostShown
                               ? ""
                               : fmt::format("<p>The first {} of {}; “cairn status” lists all.</p>\n",
                                             kMostShown, facts.workers.size());
  return "<table class=\"cards\">\n<thead><tr><th>Worker</th><th>Name</th><th>Host, process"
         "</th><th>State</th><th>Task</th><th class=\"number\">For, min:s</th><th class=\"number\">Load</th>"
         "<th class=\"number\">Memory</th><th class=\"number\">Here, min:s</th><th "
         "class=\"number\">Failed</th><th class=\"number\">Silent, min:s</th>"
         "</tr></thead>\n<tbody>\n" +
         rows + "</tbody>\n</table>\n" + SaveButton("CSV", "this table") + more;
}

std::string NoticeHtml(const Facts& facts) {
  std::string html;
  if (!facts.trouble.empty())
    html += "<p class=\"trouble\">" + Text(facts.trouble) +
            (facts.known ? " Shown is what it said at " + Text(facts.utc) + "." : "") + "</p>";
  if (!facts.list->warning.empty()) html += "<p class=\"trouble\">" + Text(facts.list->warning) + "</p>";
  return html;
}

}  // namespace

std::string View::Address() const {
  if (kind == Kind::kWorkers) return "/workers";
  if (kind == Kind::kJob) return "/jobs/" + UrlPart(job);
  std::string query;
  const auto add = [&query](const char* name, const std::string& value) {
    if (!value.empty()) query += (query.empty() ? "?" : "&") + std::string(name) + "=" + UrlPart(value);
  };
  add("q", search);
  add("state", state);
  if (page > 1) add("page", std::to_string(page));
  return "/" + query;
}

Parts PartsOf(const View& view, const ViewContext& context) {
  const Facts& facts = context.facts;
  Parts parts = {{"notice", NoticeHtml(facts)}};
  if (!facts.known) {
    parts.emplace_back("unknown", "<p class=\"empty\">The coordinator has not answered yet.</p>\n");
    return parts;
  }
  const auto add = [&parts](const char* id, std::string html) { parts.emplace_back(id, std::move(html)); };
  if (view.kind == View::Kind::kJob) {
    for (auto& part : JobParts(view.job, context)) parts.push_back(std::move(part));
  } else if (view.kind == View::Kind::kWorkers) {
    add("workers", WorkersHtml(facts));
    add("times", TimesHtml(facts.times, ""));
  } else {
    add("summary", SummaryHtml(facts, context.may_start));
    add("jobs", JobsHtml(view, facts));
    add("refused", RefusalsHtml(facts));
  }
  add("as-of", "<p class=\"as-of\">As the coordinator said at " + Text(facts.utc) + ".</p>");
  return parts;
}

std::string FilterForm(const View& view) {
  std::string states = "<option value=\"\">all</option>";
  const auto add = [&](const std::string& state, const std::string& word) {
    states += fmt::format("<option value=\"{}\"{}>{}</option>", state, view.state == state ? " selected" : "",
                          word);
  };
  add("active", "not over");
  for (const char* state : kStates) add(state, state);
  return "<form id=\"filter\" class=\"filter\" method=\"get\" action=\"/\" role=\"search\">\n"
         "<label>Search <input type=\"search\" name=\"q\" maxlength=\"200\" autocomplete=\"off\" "
         "placeholder=\"name or id\" value=\"" +
         Text(view.search) + "\"></label>\n<label>State <select name=\"state\">" + states +
         "</select></label>\n<button>Show</button>\n</form>\n";
}

std::string TitleOf(const View& view, const Facts& facts) {
  if (view.kind == View::Kind::kWorkers) return "Workers";
  if (view.kind == View::Kind::kJobs) return "Jobs";
  const wire::JobInfo* job = facts.Find(view.job);
  return job == nullptr ? view.job : job->name();
}

std::string PartsHtml(const Parts& parts) {
  std::string html;
  for (const auto& [id, part] : parts)
    if (id != "notice") html += "<section id=\"" + id + "\">" + part + "</section>\n";
  return html;
}

std::string Page(const std::string& title, const std::string& main, const std::string& notice,
                 const std::string& events, const std::string& foot) {
  std::string html;
  const std::string_view shell = AssetText("page.html");
  const std::map<std::string_view, std::string> values = {
      {"title", Text(title)}, {"main", main}, {"notice", notice}, {"events", Text(events)}, {"foot", foot}};
  for (std::size_t at = 0; at < shell.size();) {
    const std::size_t open = shell.find("{{", at), close = shell.find("}}", open);
    html += shell.substr(at, open - at);
    if (open == std::string_view::npos || close == std::string_view::npos) break;
    const auto value = values.find(shell.substr(open + 2, close - open - 2));
    if (value != values.end()) html += value->second;
    at = close + 2;
  }
  return html;
}

}  // namespace cairn::page
