#include "coordinator/store/recovery.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "coordinator/core/job.h"
#include "coordinator/store/checkpoint_file.h"
#include "coordinator/store/result_file.h"
#include "coordinator/store/served_file.h"
#include "coordinator/store/sqlite_files.h"
#include "schema/store/atomic_file.h"
#include "schema/text.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

std::vector<Hash> BlobsOf(const proto::Checkpoint& checkpoint) {
  std::vector<Hash> blobs;
  for (const std::string& blob : checkpoint.blobs()) blobs.push_back(Hash::FromBinary(blob).value());
  return blobs;
}

// The input that it is; empty: none.
std::string InputOf(const proto::Job& job, const Hash& hash) {
  for (const auto& [name, blob] : job.input_blobs())
    if (blob == hash.Binary()) return name;
  return "";
}

// Quarantines what is damaged of it; true where all that the store must have can be read, but for inputs: no
// older checkpoint has those, and whoever submitted them may do so again, so a job without one has failed.
// Throws UnreadableStore.
bool BlobsAreGood(BlobFiles& files, proto::Checkpoint& checkpoint, InputsOf inputs, const JobLogSink& log) {
  bool good = true;
  for (const Hash& hash : BlobsOf(checkpoint)) {
    const std::string input = InputOf(checkpoint.job(), hash);
    if (inputs == InputsOf::kUser && !input.empty()) continue;
    const Status blob = files.Check(hash);
    if (blob.ok()) continue;
    if (SaysNothing(blob)) throw UnreadableStore(blob);
    log(Severity::kWarning, checkpoint.job_id(), blob.message());
    if (blob.code() == Code::kCorrupt) files.Quarantine(hash);
    good = good && !input.empty();
    const bool needs_none =
        checkpoint.state() == proto::JOB_DONE || checkpoint.state() == proto::JOB_CANCELLED;
    if (input.empty() || needs_none) continue;
    checkpoint.set_state(proto::JOB_FAILED);
    checkpoint.set_reason("the store's copy of its input '" + input +
                          "' is damaged or gone: submit the job again, which sends it anew");
  }
  return good;
}

// That of a job; one that is another's is corrupt.
Result<proto::Checkpoint> ReadCheckpointOf(const std::string& job, const fs::path& path) {
  Result<proto::Checkpoint> checkpoint = ReadCheckpoint(path);
  if (checkpoint.ok() && checkpoint.value().job_id() != job)
    return Status(Code::kCorrupt, path.string() + ": is of job '" + checkpoint.value().job_id() + "'");
  return checkpoint;
}

// The newest that is good, from `numbers` (ascending), which loses it and all that were newer. Throws
// UnreadableStore.
std::optional<proto::Checkpoint> TakeNewest(const StoreFolder& folder, BlobFiles& files,
                                            const std::string& job, std::vector<std::uint64_t>& numbers,
                                            InputsOf inputs, const JobLogSink& log) {
  while (!numbers.empty()) {
    const fs::path path = folder.CheckpointFile(job, numbers.back());
    numbers.pop_back();
    Result<proto::Checkpoint> checkpoint = ReadCheckpointOf(job, path);
    if (SaysNothing(checkpoint.status())) throw UnreadableStore(checkpoint.status());
    if (checkpoint.ok() && BlobsAreGood(files, checkpoint.value(), inputs, log))
      return std::move(checkpoint).value();
    const std::string why =
        checkpoint.ok() ? "its blobs are missing or damaged" : checkpoint.status().message();
    log(Severity::kWarning, job,
        "quarantined the checkpoint " + path.string() + ": " + why +
            (numbers.empty() ? "" : "; the one before it is used"));
    Quarantine(path);
  }
  return std::nullopt;
}

std::vector<std::string> NamesIn(const fs::path& folder) {
  std::vector<std::string> names;
  for (const fs::path& path : EntriesOf(folder))
    if (std::error_code error; fs::is_directory(path, error)) names.push_back(path.filename().string());
  std::ranges::sort(names);
  return names;
}

// Of a job that has a checkpoint.
void CheckJobInStore(const StoreFolder& folder, const BlobFiles& files, const std::string& job,
                     const fs::path& results, StoreFindings& found) {
  const std::vector<std::uint64_t> numbers = folder.CheckpointNumbers(job);
  if (numbers.empty()) return found.damaged.push_back("job " + job + " has no checkpoint");
  const Result<proto::Checkpoint> newest = ReadCheckpointOf(job, folder.CheckpointFile(job, numbers.back()));
  if (!newest.ok()) return found.damaged.push_back("job " + job + ": " + newest.status().message());
  ++found.jobs;
  const proto::Checkpoint& checkpoint = newest.value();
  for (const Hash& hash : BlobsOf(checkpoint))
    if (const Status blob = files.Check(hash); !blob.ok())
      found.damaged.push_back("job " + job + ": " + blob.message());
  for (int stage = 0; checkpoint.state() == proto::JOB_DONE && stage < checkpoint.results_size(); ++stage) {
    const fs::path path = results / job / (checkpoint.job().stages(stage).name() + ".h5");
    if (const Result<PublishedResult> result = ReadPublished(path); !result.ok())
      found.damaged.push_back("job " + job + ": " + result.status().message());
    else if (result.value().hash.Binary() != checkpoint.results(stage))
      found.damaged.push_back("job " + job + ": " + path.string() + ": is another result than this job made");
  }
}

// The record of a job that is done: all its stages have published what they gave.
std::optional<proto::Checkpoint> RecordOfResults(const std::string& job, std::uint64_t number,
                                                 const PublishedFiles& published) {
  std::map<std::string, PublishedResult> results;  // by stage
  for (const fs::path& path : published.of ? published.of(job) : std::vector<fs::path>())
    if (Result<PublishedResult> result = ReadPublished(path); result.ok()) {
      const std::string stage = result.value().stage;
      results[stage] = std::move(result).value();
    }
  if (results.empty()) return std::nullopt;
  const proto::Job spec = results.begin()->second.job;
  if (!CheckJob(spec).empty()) return std::nullopt;
  proto::Checkpoint record;
  record.set_job_id(job);
  record.set_number(number);
  record.set_order(NumberOfJob(job));
  *record.mutable_job() = spec;
  record.set_state(proto::JOB_DONE);
  record.set_stage(static_cast<std::uint32_t>(spec.stages_size()));
  record.set_ended_served_s(published.served_s);
  for (const proto::Stage& stage : spec.stages()) {
    const auto result = results.find(stage.name());
    if (result == results.end() || HashOfJob(result->second.job) != HashOfJob(spec)) return std::nullopt;
    record.add_results(result->second.hash.Binary());
    record.set_seconds(record.seconds() + result->second.seconds);
  }
  return record;
}

std::optional<proto::Checkpoint> MakeOfResults(const StoreFolder& folder, const std::string& job,
                                               std::uint64_t number, const PublishedFiles& published,
                                               const JobLogSink& log) {
  std::optional<proto::Checkpoint> record = RecordOfResults(job, number, published);
  if (!record) return record;
  log(Severity::kWarning, job,
      "no checkpoint of it can be read, but all its results are there and whole: it is done");
  if (const Status saved = WriteCheckpoint(folder.CheckpointFile(job, number), *record); !saved.ok())
    log(Severity::kWarning, job, saved.message());  // the next start makes it of the results again
  return record;
}

// But no links: whoever may write to a folder of results must not choose which other files become a job's.
std::vector<fs::path> OwnFilesIn(const fs::path& folder) {
  std::vector<fs::path> files = EntriesOf(folder);
  std::erase_if(files, [](const fs::path& path) { return fs::is_symlink(path); });
  return files;
}

Status MakeJobOf(const StoreFolder& folder, const proto::Checkpoint& record) {
  const fs::path of_job = folder.Checkpoints() / record.job_id();
  std::error_code error;
  fs::create_directory(of_job, error);
  if (error) return SystemFailure(of_job, "make the folder", error.value());
  const Status written = WriteCheckpoint(folder.CheckpointFile(record.job_id(), 1), record);
  return written.ok() ? SyncFolder(folder.Checkpoints()) : written;
}

// A process that died may have left files that are there but whose folder was not synced: counted on, with
// what came before them cleared away, they would be gone at the next power cut.
void MakeDurable(const StoreFolder& folder, const JobLogSink& log) {
  std::vector<fs::path> folders = {folder.Blobs(), folder.Checkpoints()};
  for (const std::string& job : folder.JobsWithCheckpoints()) folders.push_back(folder.Checkpoints() / job);
  for (const fs::path& path : folders)
    if (const Status status = SyncFolder(path); !status.ok()) log(Severity::kError, "", status.message());
}

}  // namespace

std::vector<RestoreJob> Recover(const StoreFolder& folder, BlobFiles& files, InputsOf inputs,
                                const PublishedFiles& published, const JobLogSink& log) {
  MakeDurable(folder, log);
  std::vector<RestoreJob> jobs;
  std::set<Hash> named;
  bool all_known = true;
  for (const std::string& job : folder.JobsWithCheckpoints()) {
    std::vector<std::uint64_t> numbers = folder.CheckpointNumbers(job);
    const std::size_t before_count = numbers.size();
    // Cut off before its first checkpoint was there: nobody was told that there is such a job.
    std::error_code not_empty;
    if (numbers.empty() && fs::remove(folder.Checkpoints() / job, not_empty)) continue;
    const std::uint64_t next = numbers.empty() ? 1 : numbers.back() + 1;
    std::optional<proto::Checkpoint> newest = TakeNewest(folder, files, job, numbers, inputs, log);
    all_known = all_known && newest && numbers.size() + 1 == before_count;
    if (!newest) newest = MakeOfResults(folder, job, next, published, log);
    if (!newest) {
      log(Severity::kError, "", "job " + job + " has no checkpoint left that can be read; it is lost");
      continue;
    }
    RestoreJob restore{std::move(*newest), {}};
    const proto::JobState state = restore.checkpoint.state();
    if (state == proto::JOB_DONE || state == proto::JOB_CANCELLED) {
      restore.checkpoint.clear_blobs();  // needed before version 1 of checkpoints only
      numbers.clear();
    }
    if (!numbers.empty())
      if (const auto before = ReadCheckpoint(folder.CheckpointFile(job, numbers.back())); before.ok())
        for (const Hash& hash : BlobsOf(before.value()))
          if (files.Has(hash)) restore.previous_blobs.push_back(hash);
    for (const Hash& hash : BlobsOf(restore.checkpoint)) named.insert(hash);
    named.insert(restore.previous_blobs.begin(), restore.previous_blobs.end());
    jobs.push_back(std::move(restore));
  }
  const Result<std::vector<std::string>> lost = LostJobs(folder);
  if (!lost.ok()) log(Severity::kWarning, "", lost.status().message());
  const std::vector<std::string> told = folder.JobsWithCheckpoints();
  for (const std::string& job : lost.ok() ? lost.value() : std::vector<std::string>())
    if (!std::ranges::binary_search(told, job))
      log(Severity::kError, "",
          WhyLost(folder, job) + "; blobs that nobody needs stay for its sake until `cairn clean --damaged`");
  all_known = all_known && lost.ok() && lost.value().empty();
  // What a damaged checkpoint named may be all that is left of its job: `cairn clean` removes it, when told.
  if (all_known) files.RemoveAllBut(named);
  std::sort(jobs.begin(), jobs.end(), [](const RestoreJob& a, const RestoreJob& b) {
    return std::tuple(a.checkpoint.order(), a.checkpoint.job_id()) <
           std::tuple(b.checkpoint.order(), b.checkpoint.job_id());
  });
  return jobs;
}

bool KnowsItsLogs(const StoreFolder& folder) {
  std::error_code error;
  return fs::exists(folder.JobTable(), error) && !fs::exists(folder.JobTable().string() + ".damaged", error);
}

Result<std::vector<std::string>> LostJobs(const StoreFolder& folder) {
  std::error_code error;
  if (!fs::exists(folder.JobTable(), error)) return std::vector<std::string>();
  Result<std::vector<std::string>> jobs = JobTable::JobsWithLogIn(folder.JobTable());
  if (!jobs.ok()) return jobs;
  std::erase_if(jobs.value(), [&folder](const std::string& job) {
    return !IsPlainName(job) || !folder.CheckpointNumbers(job).empty();
  });
  if (jobs.value().empty()) return jobs;
  // Whether it was being deleted.
  const Result<std::vector<std::string>> now = JobTable::JobsWithLogIn(folder.JobTable());
  if (!now.ok()) return now;
  std::erase_if(jobs.value(),
                [&now](const std::string& job) { return !std::ranges::binary_search(now.value(), job); });
  return jobs;
}

std::string WhyLost(const StoreFolder& folder, const std::string& job) {
  return "job " + job + " is lost: none of its checkpoints is in " + (folder.Checkpoints() / job).string() +
         ", and it was not deleted";
}

StoreFindings CheckStore(const StoreFolder& folder, const fs::path& results, bool adopt) {
  StoreFindings found;
  const std::vector<std::string> jobs = folder.JobsWithCheckpoints();
  const BlobFiles files(folder);
  for (const std::string& job : jobs) CheckJobInStore(folder, files, job, results, found);
  const Result<double> served_s = ReadServed(folder.ServedFile());
  const PublishedFiles published{[&results](const std::string& job) { return OwnFilesIn(results / job); },
                                 served_s.ok() ? served_s.value() : 0};
  std::map<std::uint64_t, std::vector<std::string>> of_number;  // a service gives each to one job
  for (const std::string& job : jobs) of_number[NumberOfJob(job)].push_back(job);
  std::vector<proto::Checkpoint> records;
  for (const std::string& job : NamesIn(results)) {
    if (std::ranges::find(jobs, job) != jobs.end()) continue;
    const bool is_job = NumberOfJob(job) > 0 && IsPlainName(job) && !fs::is_symlink(results / job);
    std::optional<proto::Checkpoint> record =
        is_job ? RecordOfResults(job, 1, published) : std::optional<proto::Checkpoint>();
    if (!record) {
      found.unclaimed.push_back(job);
      continue;
    }
    of_number[NumberOfJob(job)].push_back(job);
    records.push_back(std::move(*record));
  }
  for (const proto::Checkpoint& record : records) {
    const std::string& job = record.job_id();
    if (NumberOfJob(job) > kMostJobNumber) {
      found.damaged.push_back(
          "results/" + job + " would be a job of a number above " + std::to_string(kMostJobNumber) +
          ", which no service gave, and would leave none for the jobs after it: rename it");
      continue;
    }
    std::vector<std::string> others = of_number[NumberOfJob(job)];
    std::erase(others, job);
    if (!others.empty()) {
      found.damaged.push_back("results/" + job + " would be a job of the number that " + NameList(others) +
                              " has: move away what is a copy");
      continue;
    }
    found.orphaned.push_back(job);
    if (!adopt) continue;
    if (const Status made = MakeJobOf(folder, record); !made.ok())
      found.damaged.push_back("job " + job + ": " + made.message());
  }
  const Result<std::vector<std::string>> lost = LostJobs(folder);
  if (!lost.ok()) found.damaged.push_back("the logs of jobs: " + lost.status().message());
  for (const std::string& job : lost.ok() ? lost.value() : std::vector<std::string>())
    if (std::ranges::find(jobs, job) == jobs.end() &&
        std::ranges::find(found.orphaned, job) == found.orphaned.end())
      found.damaged.push_back(WhyLost(folder, job));
  return found;
}

Result<JobTable> OpenJobTable(const StoreFolder& folder, const LogSink& log) {
  const Result<std::vector<fs::path>> unsafe = sqlite::QuarantineUnsafe(folder.JobTable());
  if (!unsafe.ok()) return unsafe.status();
  for (const fs::path& file : unsafe.value())
    log(Severity::kWarning,
        "quarantined " + file.string() + ": the job table never leaves such a file there");
  std::error_code error;
  if (!fs::exists(folder.JobTable(), error) && !folder.JobsWithCheckpoints().empty()) {
    log(Severity::kWarning, "the job table is missing; it is made anew, without the logs of jobs");
    const Status noted = WriteTextAtomically(folder.JobTable().string() + ".damaged", "it was missing\n");
    if (!noted.ok()) return noted;
  }
  Result<JobTable> table = JobTable::Open(folder.JobTable());
  if (table.ok() && table.value().damaged_lines().count > 0) {
    const log_table::DamagedLines damaged = table.value().damaged_lines();
    log(Severity::kWarning, "removed damaged lines from the logs of jobs: " + std::to_string(damaged.count) +
                                ", of job '" + damaged.job + "' for one; is the disk whole?");
    if (Status status = table.value().RemoveDamagedLines(); !status.ok()) return status;
  }
  if (table.ok() || table.status().code() != Code::kCorrupt) return table;
  log(Severity::kWarning, "made the job table anew, without the logs of jobs: " + table.status().message());
  const std::uint64_t last = JobTable::LastNumberIn(folder.JobTable());
  Quarantine(folder.JobTable());
  std::error_code ignored;
  fs::remove(folder.JobTable().string() + "-wal", ignored);
  fs::remove(folder.JobTable().string() + "-shm", ignored);
  Result<JobTable> anew = JobTable::Open(folder.JobTable());
  if (anew.ok() && last > 0)
    if (Status status = anew.value().NoteRemoval(std::to_string(last)); !status.ok()) return status;
  return anew;
}

}  // namespace cairn::coordinator
