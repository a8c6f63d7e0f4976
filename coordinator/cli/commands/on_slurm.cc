#include "coordinator/cli/commands/on_slurm.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <numeric>
#include <sstream>

#include "coordinator/cli/common/allow_list_file.h"
#include "coordinator/cli/common/failure.h"
#include "coordinator/cli/common/folder_lock.h"
#include "coordinator/cli/common/programs.h"
#include "coordinator/scale/engines/programs.h"
#include "coordinator/scale/engines/slurm_engine.h"
#include "schema/hash.h"
#include "schema/store/atomic_file.h"
#include "schema/store/regular_file.h"
#include "schema/text.h"
#include "schema/wire/keys.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;
using coordinator::ShellWord;

// What the script does, once its variables are set. It is told to go some time before its limit, or where it
// is preempted: then it is queued anew. Told by who cancels it, it takes its workers with it.
constexpr const char* kScript = R"sh(
address=$(scontrol show node "$SLURMD_NODENAME" | sed -n 's/.*NodeAddr=\([^ ]*\).*/\1/p')
at=tcp://${address:-$(hostname)}:$port
client() {
  command=$1
  shift
  $exec "$cairn" "$command" "$@" --connect "$at" --key "$own/client.key" --server-key "$own/coordinator.pub"
}
exec=
scaler=
end() {
  [ -z "$scaler" ] || { kill "$scaler"; wait "$scaler"; } 2>/dev/null
  squeue -h --me -o '%A %j' | sed -n "s/^\([0-9]*\) slurm-$name-[0-9]*$/\1/p" | sort -u | xargs -r scancel
  kill "$coordinator" 2>/dev/null
  wait
}
told() {
  state=$(squeue -h -j "$SLURM_JOB_ID" -o %T)
  end
  [ "$state" != RUNNING ] || scontrol requeue "$SLURM_JOB_ID"
  exit 143
}
echo "$SLURM_JOB_ID" >"$own/job"
"$cairn" coordinator --take-over --store "$own/store" --listen "tcp://*:$port" --keys "$own" &
coordinator=$!
trap told TERM
until client list >/dev/null 2>&1; do
  kill -0 "$coordinator" 2>/dev/null || exit 1
  sleep 1
done
client submit --json >"$own/submitted" "$@" || { end; exit 2; }
id=$(sed -n 's/.*"id": *"\([^"]*\)".*/\1/p' "$own/submitted" | head -n 1)
{ exec=exec; scale; } &
scaler=$!
client watch "$id" &
wait $!
code=$?
client results "$id" --out "$out" $force || code=$?
end
exit $code
)sh";

std::string Words(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += " " + ShellWord(word);
  return text;
}

// As `cairn submit` takes them, files by their whole paths.
std::vector<std::string> SubmitWords(const JobArguments& job) {
  std::vector<std::string> words;
  if (IsJobFile(job.what)) {
    words = {fs::absolute(job.what).string()};
  } else {
    words = {job.what, fs::absolute(job.file).string(), "--seed", std::to_string(job.seed)};
    if (!job.name.empty()) words.insert(words.end(), {"--name", job.name});
    for (const std::string& setting : job.settings) words.insert(words.end(), {"--set", setting});
    for (const std::string& input : job.inputs) {
      const std::size_t equals = input.find('=');
      words.insert(words.end(), {"--input", input.substr(0, equals + 1) +
                                                fs::absolute(input.substr(equals + 1)).string()});
    }
  }
  if (job.units_are_right) words.emplace_back("--units-are-right");
  return words;
}

// Of the folder, so that it is the same where the job is queued anew.
std::uint64_t NumberOf(const std::string& folder) {
  Hasher hasher;
  hasher.Add(std::string_view(folder));
  const Hash hash = hasher.Finish();
  return std::accumulate(hash.bytes.begin(), hash.bytes.begin() + 4, std::uint64_t{0},
                         [](std::uint64_t sum, std::uint8_t byte) { return 256 * sum + byte; });
}

// Whoever hands on a folder must not choose who may enter, or which other files are written.
void MakeOwnFolder(const fs::path& own) {
  std::error_code error;
  fs::create_directories(own.parent_path(), error);
  if (error) Throw(SystemFailure(own, "cannot make the folder", error.value()));
  if (::mkdir(own.c_str(), 0700) != 0 && errno != EEXIST)
    Throw(SystemFailure(own, "cannot make the folder", errno));
  struct stat is{};
  if (::lstat(own.c_str(), &is) != 0) Throw(SystemFailure(own, "look at", errno));
  if (!S_ISDIR(is.st_mode) || is.st_uid != ::geteuid() || (is.st_mode & 077) != 0)
    throw InputError(own.string() +
                     " is there already, and is no folder of your own that nobody else may enter: remove it, "
                     "or name another --out");
  for (const fs::directory_entry& entry : fs::directory_iterator(own))
    if (entry.is_symlink())
      throw InputError(entry.path().string() + " is a link; a run keeps what it needs in its own folder");
}

// In the place of a number, while nobody knows it yet.
constexpr const char* kSubmitting = "submitting\n";

// Its keys must stay as they are, and the store is its own, also while it is queued.
void RefuseWhereOneRuns(const fs::path& own) {
  constexpr std::size_t kMostBytes = 64;
  const Result<std::string> started = ReadSmallFile(own / "job", kMostBytes);
  if (started.ok() && started.value() == kSubmitting)
    throw InputError("`cairn run --on slurm` was cut off while it submitted a job that works in " +
                     own.parent_path().string() +
                     ": where `squeue --me` shows such a one, end it by `scancel`; "
                     "then remove " +
                     (own / "job").string() + " and say this again");
  const std::string number = started.ok() ? coordinator::SlurmJobNumber(started.value()) : "";
  if (number.empty()) return;
  constexpr double kLimit_s = 30;
  const coordinator::ProgramOutput queue =
      coordinator::RunPrograms({{{"squeue", "-h", "--me", "-o", "%A"}, ""}}, kLimit_s)[0];
  if (queue.exit_code != 0) throw WorldError(coordinator::SlurmFailure(queue));
  std::istringstream lines(queue.out);
  for (std::string line; std::getline(lines, line);)
    if (line == number)
      throw InputError("Slurm's job " + number + " works in " + own.parent_path().string() +
                       " already, or will; `scancel " + number + "` ends it");
}

// Anew for each submission: those that lie there may be known to others.
void MakeKeys(const fs::path& own) {
  for (const char* old : {"coordinator.key", "coordinator.pub", "client.key", "client.pub", kAllowListName,
                          "keys"})  // those of workers
    fs::remove_all(own / old);
  for (const char* name : {"coordinator", "client"})
    Check(wire::WriteKeyPair(own / name, wire::GenerateKeyPair()));
  AllowKey(own / kAllowListName, Take(wire::ReadPublicKey(own / "client.pub")),
           {.roles = {.submitter = true}, .limits = {}, .name = "client"});
}

}  // namespace

std::string OnSlurmScript(const OnSlurmArguments& arguments, const std::string& program,
                          const std::string& own) {
  constexpr std::uint64_t kFirstPort = 20'000, kPorts = 12'000;
  const std::uint64_t number = NumberOf(own);
  std::string sbatch;
  for (const std::string& option : arguments.sbatch)
    if (option != "--wait" && option != "-W") sbatch += " " + ShellWord("--sbatch=" + option);
  return "#!/bin/sh\n# Made by `cairn run --on slurm`. Submitted again it goes on where it was.\ncairn=" +
         ShellWord(program) + "\nown=" + ShellWord(own) +
         "\nout=" + ShellWord(fs::path(own).parent_path().string()) +
         "\nforce=" + (arguments.force ? "--force" : "") + "\nname=run" + std::to_string(number % 1'000'000) +
         "\nport=" + std::to_string(kFirstPort + number % kPorts) +
         "\nscale() {\n  client scale slurm --name \"$name\" --folder \"$own\" --keys \"$own\" --idle-s 30 "
         "--max " +
         std::to_string(arguments.workers) + sbatch + "\n}\nset --" + Words(SubmitWords(arguments.job)) +
         "\n" + kScript;
}

int RunOnSlurm(const OnSlurmArguments& arguments) {
  const fs::path out = fs::absolute(arguments.out), own = out / ".on-slurm";
  std::error_code error;
  const bool is_new = !fs::exists(own), is_new_out = !fs::exists(out);
  MakeOwnFolder(own);
  fs::create_directory(own / "submitting", error);
  const FolderLock lock(own / "submitting", "another `cairn run --on slurm` submits a job that works in " +
                                                out.string() + ", or waits for it");
  RefuseWhereOneRuns(own);
  Check(WriteTextAtomically(own / "job", kSubmitting));
  MakeKeys(own);
  const fs::path program = fs::path(WorkerProgram()).parent_path() / "cairn";
  coordinator::Program sbatch{
      {"sbatch", "--parsable", "--requeue", "--ntasks=1", "--open-mode=append", "--signal=B:TERM@90",
       "--job-name=cairn-" + out.filename().string(), "--output=" + coordinator::SlurmFileName(own / "log")},
      OnSlurmScript(arguments, program.string(), own.string())};
  sbatch.words.insert(sbatch.words.end(), arguments.sbatch.begin(), arguments.sbatch.end());
  constexpr double kMonth_s = 30 * 86400;  // it may wait for the job
  const coordinator::ProgramOutput output = coordinator::RunPrograms({sbatch}, kMonth_s)[0];
  const std::string number = coordinator::SlurmJobNumber(output.out);
  const bool waited = std::ranges::any_of(
      arguments.sbatch, [](const std::string& option) { return option == "--wait" || option == "-W"; });
  if (number.empty() || (output.exit_code != 0 && !waited)) {  // it ends as the job does where it waits
    fs::remove(own / "job", error);
    if (is_new) fs::remove_all(own, error);
    if (is_new_out) fs::remove(out, error);
    throw WorldError(output.exit_code != 0
                         ? coordinator::SlurmFailure(output)
                         : "sbatch said no number of a job, but '" + Printable(output.out, 100) + "'");
  }
  Check(WriteTextAtomically(own / "job", number + "\n"));
  std::printf("submitted as Slurm's job %s; results come into %s, what happens is in %s\n", number.c_str(),
              out.c_str(), (own / "log").c_str());
  return output.exit_code;
}

}  // namespace cairn::cli
