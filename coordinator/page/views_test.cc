#include "coordinator/page/views.h"

#include <gtest/gtest.h>

#include "coordinator/page/job_view.h"

namespace cairn::page {
namespace {

std::size_t Times(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++count;
  return count;
}

Facts Many(int count) {
  Facts facts;
  facts.known = true;
  for (int i = 1; i <= count; ++i) {
    wire::JobInfo job;
    job.set_id(std::to_string(i) + "-Tour");
    job.set_name("Tour " + std::to_string(i));
    job.set_state(i % 10 == 0 ? "running" : "done");
    job.set_stages(1);
    facts.list->jobs.push_back(job);
  }
  SortForPeople(&facts.list->jobs);
  return facts;
}

std::string PartOf(const View& view, const ViewContext& context, const std::string& id) {
  for (const auto& [known, html] : PartsOf(view, context))
    if (known == id) return html;
  return "no such part";
}

TEST(Jobs, OfTenThousandAPageHasFifty) {
  const Facts facts = Many(10'000);
  const ViewContext context{.facts = facts};
  const std::string first = PartOf({}, context, "jobs");
  EXPECT_EQ(Times(first, "<tr data-key"), 50u);
  EXPECT_LT(first.size(), 60'000u);
  EXPECT_NE(first.find("1 to 50 of 10000 jobs"), std::string::npos);
  EXPECT_NE(first.find("Tour 10000<"), std::string::npos) << "the latest of those that run";
  EXPECT_NE(first.find("<a href=\"/?page=2\">Next</a>"), std::string::npos);
  const std::string last = PartOf({.page = 200}, context, "jobs");
  EXPECT_NE(last.find("9951 to 10000 of 10000 jobs"), std::string::npos);
  EXPECT_NE(last.find("Tour 1<"), std::string::npos);
  EXPECT_EQ(PartOf({.page = 1000}, context, "jobs"), last) << "beyond the end is the end";
}

TEST(Jobs, AreFoundByNameIdAndState) {
  const Facts facts = Many(1000);
  const ViewContext context{.facts = facts};
  EXPECT_EQ(Times(PartOf({.search = "tOUR 99"}, context, "jobs"), "<tr data-key"), 11u);
  EXPECT_EQ(Times(PartOf({.search = "1000-t"}, context, "jobs"), "<tr data-key"), 1u);
  EXPECT_NE(PartOf({.state = "running"}, context, "jobs").find("1 to 50 of 100 jobs"), std::string::npos);
  EXPECT_NE(PartOf({.state = "active"}, context, "jobs").find("1 to 50 of 100 jobs"), std::string::npos);
  EXPECT_NE(PartOf({.search = "nothing"}, context, "jobs").find("No job is like that"), std::string::npos);
  EXPECT_NE(PartOf({.search = "Tour 1&x"}, context, "jobs").find("No job"), std::string::npos);
  EXPECT_EQ((View{.search = "a b&c", .state = "done", .page = 3}.Address()),
            "/?q=a%20b%26c&state=done&page=3");
}

TEST(Job, ShowsItsShareOfTheFleetItsStagesAndWhatIsLeft) {
  Facts facts = Many(1);
  wire::JobInfo& job = facts.list->jobs[0];
  job.set_state("running");
  job.set_stages(3);
  job.set_stage(1);
  job.set_stage_name("map");
  job.set_workers(1);
  job.set_eta_s(40);
  job.set_eta_most_s(41);
  job.set_eta_least_s(39);
  facts.workers.resize(4);
  const View view{.kind = View::Kind::kJob, .job = "1-Tour"};
  const std::string figures = PartOf(view, {.facts = facts}, "facts");
  EXPECT_NE(figures.find("1 of 4 workers (25%)"), std::string::npos) << figures;
  EXPECT_NE(figures.find("about 0:40, then 1 stage more"), std::string::npos) << figures;
  const std::string stages = PartOf(view, {.facts = facts}, "stages");
  EXPECT_EQ(Times(stages, "<li"), 3u);
  EXPECT_NE(stages.find("aria-current=\"step\"><b>map</b>"), std::string::npos) << stages;
  EXPECT_NE(PartOf(view, {.facts = facts}, "result").find("/jobs/1-Tour/report?stages=1"), std::string::npos);
  job.set_mark(std::string(16, 'a'));
  EXPECT_NE(PartOf(view, {.facts = facts}, "result").find("/picture?stages=1&amp;of=616161"),
            std::string::npos)
      << "a browser shows no picture anew whose address is the same";
  const ResultFiles files{.stages = {"first"}, .has_report = true};
  EXPECT_NE(PartOf(view, {.facts = facts, .results = &files}, "result").find("/files/first.h5"),
            std::string::npos);
}

// A diamond: both in the middle take the first one's result, the last one both of theirs.
TEST(Job, ShowsStagesThatBranchAsAGraph) {
  Facts facts = Many(1);
  wire::JobInfo& job = facts.list->jobs[0];
  job.set_state("running");
  job.set_stages(4);
  job.set_stage(1);
  const std::vector<std::vector<std::uint32_t>> after = {{}, {0}, {0}, {1, 2}};
  for (std::size_t i = 0; i < after.size(); ++i) {
    wire::StageInfo& stage = *job.add_plan();
    stage.set_name("<" + std::to_string(i) + ">");
    stage.set_pipeline("toy");
    stage.mutable_after()->Assign(after[i].begin(), after[i].end());
  }
  const View view{.kind = View::Kind::kJob, .job = "1-Tour"};
  const std::string graph = PartOf(view, {.facts = facts}, "stages");
  EXPECT_EQ(Times(graph, "class=\"arrow\""), 4u);
  EXPECT_EQ(Times(graph, "<rect"), 4u);
  EXPECT_NE(graph.find("&lt;0&gt; done; &lt;1&gt; running; &lt;2&gt; not begun"), std::string::npos) << graph;
  EXPECT_EQ(Times(graph, "x=\"233\" y=\"3\""), 1u) << "side by side in the second column";
  EXPECT_EQ(Times(graph, "x=\"233\" y=\"83\""), 1u);
  job.mutable_plan()->DeleteSubrange(2, 2);
  job.set_stages(2);
  const std::string chain = PartOf(view, {.facts = facts}, "stages");
  EXPECT_EQ(Times(chain, "<li"), 2u);
  EXPECT_NE(chain.find("<b>&lt;1&gt;</b>"), std::string::npos) << chain;
}

TEST(Workers, SayWhatTheyDoHowTheyAreAndWhatFailed) {
  Facts facts = Many(1);
  wire::WorkerInfo worker;
  worker.set_number(3);
  worker.set_state("busy");
  worker.set_assigned(1);
  worker.set_task("1-Tour: task 4");
  worker.set_load(1.5);
  worker.set_memory_bytes(84'000'000);
  worker.set_joined_s(3723);
  worker.set_failures(2);
  facts.workers.push_back(worker);
  const std::string html = PartOf({.kind = View::Kind::kWorkers}, {.facts = facts}, "workers");
  for (const char* cell :
       {">1.50</td>", ">84.0 MB</td>", ">1:02:03</td>", ">2</td>", "task 4", "data-save=\"CSV\""})
    EXPECT_NE(html.find(cell), std::string::npos) << cell << html;
}

TEST(Job, ButtonsAreForThoseWhoMay) {
  Facts facts = Many(1);
  facts.list->jobs[0].set_state("failed");
  const View view{.kind = View::Kind::kJob, .job = "1-Tour"};
  const std::string may = PartOf(view, {.facts = facts}, "head");
  EXPECT_NE(may.find("data-action=\"retry\""), std::string::npos);
  EXPECT_NE(may.find("data-sure=\"Delete this job"), std::string::npos) << "who deletes is asked before";
  EXPECT_EQ(PartOf(view, {.facts = facts, .may_command = false}, "head").find("data-action"),
            std::string::npos);
}

TEST(Times, TellsAJobsOwnTasksFromOthers) {
  FleetTimes times;
  std::vector<wire::WorkerInfo> workers(2);
  for (int i = 0; i < 2; ++i) {
    auto& worker = workers[static_cast<std::size_t>(i)];
    worker.set_number(static_cast<std::uint64_t>(i + 1));
    worker.set_assigned(1);
    worker.set_task(i == 0 ? "1-a: task 0" : "2-b: task 5");
    worker.set_task_s(10);
  }
  times.Add(workers, 100);
  const std::string html = TimesHtml(times, "1-a");
  EXPECT_EQ(Times(html, "class=\"span\""), 1u);
  EXPECT_EQ(Times(html, "class=\"span other\""), 1u);
  EXPECT_NE(html.find("1-a: task 0, 0:10"), std::string::npos) << html;
  EXPECT_EQ(TimesHtml(times, "3-c"), "") << "nobody works at it";
}

}  // namespace
}  // namespace cairn::page
