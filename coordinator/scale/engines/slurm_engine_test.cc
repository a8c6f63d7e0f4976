// A Slurm that says what the test tells it to; tests/end_to_end/slurm_test.sh has a real one.
#include "coordinator/scale/engines/slurm_engine.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace cairn::coordinator {
namespace {

struct Slurm {
  ProgramOutput Run(const Program& program) {
    asked.push_back(program);
    return answers[program.words[0]];
  }
  SlurmEngine Engine(const SlurmOptions& options) {
    return SlurmEngine(options, [this](const Program& program) { return Run(program); });
  }
  static ProgramOutput Well(const std::string& out) { return {0, out, "", ""}; }

  std::vector<Program> asked;
  std::map<std::string, ProgramOutput> answers;
};

const SlurmOptions kSlurm{.prefix = "w-",
                          .folder = testing::TempDir() + "/slurm",
                          .worker = "/opt/cairn-worker",
                          .options = {"--connect", "tcp://hub:7017"},
                          .keyed = true,
                          .sbatch = {"--partition=long"},
                          .drain_s = 60};

TEST(SlurmEngine, AsksForAnArrayOfWorkersWhoseNumbersFollowEachOther) {
  Slurm slurm;
  slurm.answers["sbatch"] = Slurm::Well("77;cluster\n");
  SlurmEngine engine = slurm.Engine(kSlurm);
  EXPECT_EQ(engine.Start({"w-12", "w-13", "w-14"}).names.size(), 3U);
  const Program& asked = slurm.asked.at(0);
  for (const char* word :
       {"--job-name=w-12", "--array=0-2", "--partition=long", "--no-requeue", "--signal=B:TERM@90"})
    EXPECT_TRUE(std::ranges::count(asked.words, word) == 1) << word;
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "name='w-'$((12 + SLURM_ARRAY_TASK_ID))\n", asked.input);
  EXPECT_PRED_FORMAT2(testing::IsSubstring,
                      "exec '/opt/cairn-worker' --name \"$name\" '--connect' 'tcp://hub:7017' --key '" +
                          kSlurm.folder + "/keys/'\"$name\".key",
                      asked.input);
  slurm.answers["scancel"] = Slurm::Well("");
  EXPECT_TRUE(engine.Stop({"w-13", "w-99"}).ok());
  EXPECT_EQ(slurm.asked.at(1).words, (std::vector<std::string>{"scancel", "77_1"}));
}

// %j in a file's name is the job's number to sbatch, but in the part that is meant so.
TEST(SlurmEngine, LogsLieInTheirFolderWhateverItIsCalled) {
  Slurm slurm;
  slurm.answers["sbatch"] = Slurm::Well("77\n");
  SlurmOptions options = kSlurm;
  options.folder += "/50%j";
  slurm.Engine(options).Start({"w-1"});
  EXPECT_EQ(
      std::ranges::count(slurm.asked.at(0).words, "--output=" + kSlurm.folder + "/50%%j/logs/w-%A_%a.log"),
      1);
}

TEST(SlurmEngine, ReadsWhatIsQueuedAndLeavesOthersJobsAlone) {
  std::map<std::string, std::string> ids;
  const std::vector<EngineWorker> workers = ReadQueue("w-",
                                                      "w-12|0|R|cn1|None|77_0\n"
                                                      "w-12|1|PD||Resources|77_1\n"
                                                      "w-12|2|CG|cn2|None|77_2\n"
                                                      "train|N/A|R|cn3|None|78\n"
                                                      "w-x|0|R|cn3|None|79_0\n"
                                                      "w-20|N/A|R|cn3|None|80\n"
                                                      "broken\n",
                                                      &ids);
  ASSERT_EQ(workers.size(), 2U);
  EXPECT_EQ(workers[0].name, "w-12");
  EXPECT_EQ(workers[0].state, EngineWorker::State::kRuns);
  EXPECT_EQ(workers[0].where, "cn1");
  EXPECT_EQ(workers[1].name, "w-13");
  EXPECT_EQ(workers[1].state, EngineWorker::State::kWaiting);
  EXPECT_EQ(workers[1].why, "Resources");
  EXPECT_EQ(ids.at("w-13"), "77_1");
}

TEST(SlurmEngine, OfOneThatIsGoneItSaysHowItEnded) {
  Slurm slurm;
  slurm.answers["squeue"] = Slurm::Well("w-1|0|R|cn1|None|7_0\n");
  SlurmEngine engine = slurm.Engine(kSlurm);
  EXPECT_EQ(engine.List().value().size(), 1U);
  slurm.answers["squeue"] = Slurm::Well("");
  slurm.answers["scontrol"] =
      Slurm::Well("JobId=8 ArrayJobId=7 JobState=NODE_FAIL Reason=NodeDown ExitCode=0:1 BatchHost=cn1 X=y\n");
  for (int i = 0; i < 2; ++i) {
    const auto list = engine.List();
    ASSERT_EQ(list.value().size(), 1U) << "until it is forgotten";
    EXPECT_EQ(list.value()[0].state, EngineWorker::State::kEnded);
    EXPECT_EQ(list.value()[0].where, "cn1");
    EXPECT_EQ(list.value()[0].why, "Slurm says NODE_FAIL (NodeDown)");
  }
  engine.Forget({"w-1"});
  EXPECT_TRUE(engine.List().value().empty());
  EXPECT_EQ(WhyEnded("JobState=COMPLETED Reason=None ExitCode=0:0"), "") << "as it was told";
  EXPECT_EQ(WhyEnded("JobState=FAILED Reason=NonZeroExitCode ExitCode=2:0"),
            "Slurm says FAILED (NonZeroExitCode), exit code 2");
}

TEST(SlurmEngine, SaysWhatSlurmSaysAndWhatToDoWhereItIsMissing) {
  Slurm slurm;
  slurm.answers["sbatch"] = {1, "", "x", "sbatch: error: invalid partition specified: long"};
  slurm.answers["squeue"] = {-1, "", "", "squeue: No such file or directory"};
  SlurmEngine engine = slurm.Engine(kSlurm);
  const Engine::Started started = engine.Start({"w-1"});
  EXPECT_TRUE(started.names.empty());
  EXPECT_EQ(started.status.message(), "sbatch: error: invalid partition specified: long");
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "run this on a machine from which jobs are submitted",
                      engine.List().status().message());
  slurm.answers["squeue"] = {1, "", "", "squeue: fatal: Could not establish a configuration source"};
  EXPECT_PRED_FORMAT2(testing::IsSubstring, "SLURM_CONF", engine.List().status().message());
}

}  // namespace
}  // namespace cairn::coordinator
