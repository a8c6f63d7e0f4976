#include "coordinator/server/metrics.h"

#include <fmt/format.h>

#include <limits>
#include <utility>
#include <vector>

#include "schema/wire/refusal.h"

namespace cairn::coordinator {
namespace {

using ByLabel = std::map<std::string, std::uint64_t>;

// A label's value: of ours, but a build's flags may be anybody's.
std::string LabelValue(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\' || c == '"') escaped += '\\';
    escaped += c == '\n' ? "\\n" : std::string(1, c);
  }
  return escaped;
}

// The page, a metric after the other; values are written so that reading them gives the same number.
class Page {
 public:
  template <class Number>
  void Add(const char* type, const char* name, const char* help, Number value) {
    Head(type, name, help);
    Line(name, "", static_cast<double>(value));
  }
  void Add(const char* type, const char* name, const char* help, const char* label, const ByLabel& values) {
    Head(type, name, help);
    for (const auto& [key, value] : values)
      Line(name, fmt::format("{{{}=\"{}\"}}", label, LabelValue(key)), static_cast<double>(value));
  }
  void AddInfo(const char* name, const char* help,
               const std::vector<std::pair<const char*, std::string>>& labels) {
    Head("gauge", name, help);
    std::string text;
    for (const auto& [label, value] : labels)
      text += fmt::format("{}{}=\"{}\"", text.empty() ? "" : ",", label, LabelValue(value));
    Line(name, "{" + text + "}", 1);
  }
  void Add(const char* name, const char* help, const Histogram& histogram) {
    Head("histogram", name, help);
    const std::string of = name;
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
      count += histogram.counts[i];
      const bool bound = i < Histogram::kBounds_s.size();
      const std::string le = bound ? fmt::format("{}", Histogram::kBounds_s[i]) : "+Inf";
      Line(of + "_bucket", "{le=\"" + le + "\"}", static_cast<double>(count));
    }
    Line(of + "_sum", "", histogram.sum_s);
    Line(of + "_count", "", static_cast<double>(count));
  }
  std::string Take() { return std::move(text_); }

 private:
  void Head(const char* type, const char* name, const char* help) {
    text_ += fmt::format("# HELP {0} {1}\n# TYPE {0} {2}\n", name, help, type);
  }
  void Line(const std::string& name, const std::string& labels, double value) {
    const bool infinite = value == std::numeric_limits<double>::infinity();
    text_ += name + labels + " " + (infinite ? "+Inf" : fmt::format("{}", value)) + "\n";
  }

  std::string text_;
};

void AddWork(const Metrics& metrics, Page& page) {
  page.Add("gauge", "cairn_jobs", "Jobs by state.", "state", metrics.census.jobs);
  page.Add("gauge", "cairn_workers", "Connected workers by state.", "state", metrics.census.workers);
  page.Add("gauge", "cairn_tasks", "Tasks of running jobs that are not done, by state.", "state",
           ByLabel{{"running", metrics.census.tasks_running}, {"waiting", metrics.census.tasks_waiting}});
  page.Add("gauge", "cairn_waiting_work_seconds",
           "What the tasks that wait would take on one worker, as far as is known.",
           metrics.census.waiting_work_s);
  page.Add("counter", "cairn_tasks_done_total", "Tasks whose answer was accepted.", metrics.tally.tasks_done);
  page.Add("counter", "cairn_task_retries_total", "Attempts at tasks that failed.", metrics.tally.retries);
  page.Add("counter", "cairn_task_losses_total", "Attempts at tasks that were lost with their machines.",
           metrics.tally.lost);
  page.Add("cairn_round_duration_seconds", "How long rounds of jobs took.", metrics.tally.rounds);
}

void AddStore(const Metrics& metrics, Page& page) {
  const double limit = metrics.store_limit_bytes == 0 ? std::numeric_limits<double>::infinity()
                                                      : static_cast<double>(metrics.store_limit_bytes);
  page.Add("gauge", "cairn_store_bytes", "What the store takes on disk.", metrics.store_bytes);
  page.Add("gauge", "cairn_store_limit_bytes", "What the store may take on disk.", limit);
  page.Add("gauge", "cairn_store_blobs", "Blobs that jobs hold.", metrics.store_blobs);
  page.Add("gauge", "cairn_store_writable", "1 where the store could be written when that was last tried.",
           metrics.store_writable ? 1 : 0);
  page.Add("counter", "cairn_checkpoints_total", "Checkpoints that became durable.",
           metrics.tally.checkpoints);
  page.Add("counter", "cairn_checkpoint_failures_total", "Checkpoints that could not be written.",
           metrics.tally.checkpoint_failures);
  page.Add("gauge", "cairn_last_checkpoint_timestamp_seconds",
           "When the last checkpoint became durable, in Unix time; 0 where none has since the start.",
           metrics.last_checkpoint_utc_s);
}

}  // namespace

std::string MetricsText(const Metrics& metrics) {
  Page page;
  AddWork(metrics, page);
  AddStore(metrics, page);
  page.Add("counter", "cairn_received_bytes_total", "Bytes of messages that came in.",
           metrics.traffic.bytes_in);
  page.Add("counter", "cairn_sent_bytes_total", "Bytes of messages that went out.",
           metrics.traffic.bytes_out);
  ByLabel refused;
  for (int kind = 0; kind <= static_cast<int>(wire::RefusalKind::kQuota); ++kind)
    refused[wire::KindName(static_cast<wire::RefusalKind>(kind))];
  for (const auto& [kind, count] : metrics.refused) refused[kind] = count;
  page.Add("counter", "cairn_refusals_total", "Connections, messages and requests refused, by reason.",
           "reason", refused);
  page.Add("cairn_event_loop_turn_seconds", "How long turns of the event loop took, without waiting.",
           metrics.turns);
  page.AddInfo("cairn_build_info", "1, with what the coordinator is a build of.",
               {{"version", metrics.version}, {"compiler", metrics.compiler}});
  return page.Take();
}

}  // namespace cairn::coordinator
