// The pages of a coordinator that a day goes by on in minutes: one job that runs, its rounds, its log, its
// workers' tasks. The clock goes on by a step when whoever looks on has heard of the step before.
//   page_day HOURS STEP_S
// It prints a link, after each hour "HOUR BYTES", bytes of this process that are in use, and ends after the
// last.
#include <malloc.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "coordinator/http/http_server.h"
#include "coordinator/page/site.h"
#include "tests/bench/bench_main.h"

namespace cairn {
namespace {

// What a coordinator would say of its one job at each time.
class Day : public page::Source {
 public:
  page::FactsPtr Latest() override {
    const std::lock_guard lock(mutex_);
    return facts_;
  }
  page::HistoryPtr HistoryOf(const wire::JobInfo&) override {
    const std::lock_guard lock(mutex_);
    return history_;
  }
  void Look(const std::string&, std::function<void()> then) override {
    ++looks_;
    if (then) then();
  }
  void Command(const std::string&, const std::string&, int,
               std::function<void(const page::CommandOutcome&)> then) override {
    then({false, "It is a day that was made up."});
  }
  void FetchResults(const page::ResultsOf&, std::function<void(const page::FetchedResults&)> then) override {
    then({.trouble = "There is none."});
  }
  void Compare(const page::Compared&, std::function<void(const page::FetchedResults&)> then) override {
    then({.trouble = "There is none."});
  }
  std::shared_ptr<const page::FetchedResults> Fetched(const page::ResultsOf&) override { return nullptr; }
  std::shared_ptr<const page::FetchedResults> SoFar(const wire::JobInfo&) override { return nullptr; }
  std::uint64_t looks() const { return looks_; }

  void GoOn(double now_s) {
    auto facts = std::make_shared<page::Facts>();
    facts->number = ++steps_;
    facts->known = true;
    facts->utc = std::to_string(now_s);
    wire::JobInfo job;
    job.set_id("1-day");
    job.set_name("a long day");
    job.set_state("running");
    job.set_stages(1);
    job.set_stage_name("landmark_map");
    job.set_round(steps_ / 10);
    job.set_tasks(10);
    job.set_tasks_done(static_cast<std::uint32_t>(steps_ % 10));
    job.set_rounds_left(100);
    job.set_seconds(now_s);
    job.set_workers(4);
    facts->list->jobs.push_back(job);
    for (std::uint64_t w = 0; w < 4; ++w) {
      wire::WorkerInfo worker;
      worker.set_number(w);
      worker.set_host("host" + std::to_string(w));
      worker.set_state("busy");
      worker.set_assigned(1);
      worker.set_task("1-day: round " + std::to_string(steps_ / 10) + ", task " +
                      std::to_string(4 * steps_ + w));
      facts->workers.push_back(worker);
    }
    times_.Add(facts->workers, now_s);
    facts->times = times_;
    page::HistoryPtr longer = history_;
    if (steps_ % 10 == 0) {
      const auto history =
          history_ ? std::make_shared<page::JobHistory>(*history_) : std::make_shared<page::JobHistory>();
      wire::LogLine line;
      line.set_number(steps_ / 10);
      line.set_level("info");
      line.set_text("stage 'landmark_map', round " + std::to_string(steps_ / 10) +
                    ": 10 tasks in 1.5 s, 5.2 s of work: iteration " + std::to_string(steps_ / 10) +
                    ", log-likelihood -" + std::to_string(1000 + steps_ % 977));
      history->Add({line});
      longer = history;
    }
    const std::lock_guard lock(mutex_);
    facts_ = facts;
    history_ = longer;
  }

 private:
  std::mutex mutex_;
  page::FactsPtr facts_ = std::make_shared<page::Facts>();
  page::HistoryPtr history_;
  page::FleetTimes times_;
  std::uint64_t steps_ = 0;
  std::atomic<std::uint64_t> looks_ = 0;
};

int Main(const std::vector<std::string>& args) {
  const double hours = args.empty() ? 24 : std::atof(args[0].c_str()),
               step_s = args.size() < 2 ? 1 : std::atof(args[1].c_str());
  const auto day = std::make_shared<Day>();
  std::shared_ptr<page::Site> site;
  std::string link;
  std::atomic<double> now_s = 0;
  auto server = coordinator::HttpServer::Listen(
      "0", "a day", {.streams = 4, .body_bytes = 1000},
      [&site](const coordinator::HttpRequest& request, const auto& reply) { site->Answer(request, reply); });
  if (!server.ok()) throw InputError(server.status().message());
  // What a page keeps of rounds and lines is full before the first hour: it is to go on from there.
  constexpr int kBefore = 60'000;
  for (int i = 0; i < kBefore; ++i) day->GoOn((i - kBefore) * step_s);
  day->GoOn(0);
  site = std::make_shared<page::Site>(
      page::SiteOptions{.foot = "a day"},
      page::Entrance({.address = server.value()->address(), .proxy = "", .password = ""},
                     [&link](const std::string& next) { link = next; }),
      day, [&now_s] { return now_s.load(); });
  std::printf("open %s\n", link.c_str());
  std::fflush(stdout);
  while (server.value()->streams() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  int hour = 0;
  for (double at_s = step_s; at_s <= 3600 * hours; at_s += step_s) {
    now_s = at_s;
    const std::uint64_t looks = day->looks();
    day->GoOn(at_s);
    server.value()->Wake();
    for (int i = 0; day->looks() == looks && i < 10'000; ++i)
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    for (int i = 0; server.value()->streams() == 0; ++i) {  // it goes to another page, or has gone
      if (i == 6000) return 1;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    if (at_s < 3600 * (hour + 1)) continue;
    std::printf("%d %zu\n", ++hour, mallinfo2().uordblks);
    std::fflush(stdout);
  }
  std::this_thread::sleep_for(std::chrono::minutes(10));  // for who measures the other side, and ends this
  return 0;
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) { return cairn::BenchMain("page_day", cairn::Main, argc, argv); }
