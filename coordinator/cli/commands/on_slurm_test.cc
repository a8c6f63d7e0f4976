// tests/faults/scale_slurm_test.sh --long has it run on a cluster.
#include "coordinator/cli/commands/on_slurm.h"

#include <gtest/gtest.h>

#include "coordinator/scale/engines/programs.h"

namespace cairn::cli {
namespace {

// What a shell makes of the script's beginning, and then of `more`.
std::string ShellSays(const std::string& script, const std::string& more) {
  const std::string beginning = script.substr(0, script.find("\naddress="));
  EXPECT_LT(beginning.size(), script.size());
  const coordinator::ProgramOutput output =
      coordinator::RunPrograms({{{"sh", "-s"}, beginning + "\n" + more + "\n"}}, 60)[0];
  EXPECT_EQ(output.failure, "");
  return output.out;
}

TEST(OnSlurm, TheScriptHoldsWhatWasAskedForWhateverIsInIt) {
  OnSlurmArguments arguments;
  arguments.job.what = "landmark_map";
  arguments.job.file = "/logs/it's $HOME.h5";
  arguments.job.settings = {"cell_m=0.2", "starts=`reboot`"};
  arguments.job.seed = 7;
  arguments.workers = 40;
  arguments.sbatch = {"--partition=long", "--wait", "--comment=two words"};
  const std::string script = OnSlurmScript(arguments, "/opt/my cairn/bin/cairn", "/home/ann/a map/.on-slurm");
  EXPECT_EQ(ShellSays(script, "printf '%s|' \"$@\""),
            "landmark_map|/logs/it's $HOME.h5|--seed|7|--set|cell_m=0.2|--set|starts=`reboot`|");
  EXPECT_EQ(ShellSays(script, "printf '%s|' \"$cairn\" \"$own\" \"$out\""),
            "/opt/my cairn/bin/cairn|/home/ann/a map/.on-slurm|/home/ann/a map|");
  const std::string scaled = ShellSays(script, "client() { printf '%s|' \"$@\"; }; scale");
  EXPECT_PRED_FORMAT2(testing::IsSubstring,
                      "--max|40|--sbatch=--partition=long|--sbatch=--comment=two words|", scaled);
  EXPECT_PRED_FORMAT2(testing::IsNotSubstring, "--wait", scaled) << "workers are not waited for";
  EXPECT_EQ(OnSlurmScript(arguments, "/opt/my cairn/bin/cairn", "/home/ann/a map/.on-slurm"), script)
      << "queued anew it has the same address";
  const coordinator::ProgramOutput whole = coordinator::RunPrograms({{{"sh", "-n"}, script}}, 60)[0];
  EXPECT_EQ(whole.failure, "") << "the rest is a script, too";
}

}  // namespace
}  // namespace cairn::cli
