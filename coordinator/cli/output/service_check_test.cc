#include "coordinator/cli/output/service_check.h"

#include <gtest/gtest.h>

namespace cairn::cli {
namespace {

coordinator::JobList Jobs(const std::vector<const char*>& states) {
  coordinator::JobList list;
  for (const char* state : states) list.jobs.emplace_back().set_state(state);
  return list;
}

std::vector<wire::WorkerInfo> Workers(const std::vector<const char*>& states) {
  std::vector<wire::WorkerInfo> workers;
  for (const char* state : states) workers.emplace_back().set_state(state);
  return workers;
}

bool Has(const ServiceVerdict& verdict, const std::string& text) {
  return verdict.line.find(text) != std::string::npos;
}

TEST(ServiceCheck, AServiceThatWorksOrRestsIsFine) {
  const ServiceVerdict works = CheckService(Jobs({"running", "done", "failed"}), Workers({"busy", "idle"}));
  EXPECT_EQ(works.code, 0);
  EXPECT_EQ(works.line,
            "CAIRN OK: 1 job running, 0 queued, 2 workers | jobs_running=1 jobs_queued=0 jobs_paused=0 "
            "jobs_failed=1 workers=2 store=0B;;;0;");
  EXPECT_EQ(CheckService({}, {}).code, 0) << "nothing to do, and nobody to do it";
}

TEST(ServiceCheck, JobsThatNobodyCanTakeAreCritical) {
  EXPECT_EQ(CheckService(Jobs({"queued"}), {}).code, 2);
  const ServiceVerdict hung = CheckService(Jobs({"running"}), Workers({"hung", "draining"}));
  EXPECT_EQ(hung.code, 2);
  EXPECT_TRUE(hung.line.starts_with("CAIRN CRITICAL: no worker can take")) << hung.line;
  EXPECT_TRUE(Has(hung, "1 worker hung")) << "all that was found is said: " << hung.line;
}

TEST(ServiceCheck, AStoreThatCannotBeWrittenIsCriticalAnyOtherWarningIsOne) {
  coordinator::JobList list;
  list.warning = "the list of keys | cannot be read";
  const ServiceVerdict keys = CheckService(list, {});
  EXPECT_EQ(keys.code, 1);
  EXPECT_TRUE(keys.line.starts_with("CAIRN WARNING: the list of keys / cannot be read; 0 jobs")) << keys.line;
  list.store_fails = true;
  EXPECT_EQ(CheckService(list, {}).code, 2);
}

TEST(ServiceCheck, WarnsOfJobsThatAreNotPausedByTheirOwner) {
  coordinator::JobList list = Jobs({"paused"});
  list.jobs[0].set_reason("paused by its owner");
  EXPECT_EQ(CheckService(list, {}).code, 0);
  list.jobs[0].set_reason("paused by chief (Yx8f…)");
  EXPECT_EQ(CheckService(list, {}).code, 1) << "an administrator";
  list.jobs[0].set_reason("cannot save: a full disk");
  EXPECT_EQ(CheckService(list, {}).code, 1);
}

TEST(ServiceCheck, WarnsOfAStoreThatIsNearlyFull) {
  coordinator::JobList list;
  list.store = {.bytes = 91, .limit_bytes = 100};
  EXPECT_EQ(CheckService(list, {}).code, 1);
  EXPECT_TRUE(Has(CheckService(list, {}), "91% full"));
  EXPECT_TRUE(Has(CheckService(list, {}), "store=91B;;;0;100"));
  list.store.bytes = 89;
  EXPECT_EQ(CheckService(list, {}).code, 0);
}

TEST(ServiceCheck, WhereNobodyAnswersThatIsCritical) {
  EXPECT_EQ(Unanswered("no service listens").code, 2);
  EXPECT_EQ(Unanswered("no service listens").line, "CAIRN CRITICAL: no service listens");
}

}  // namespace
}  // namespace cairn::cli
