#include "coordinator/local/embedded.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <utility>
#include <vector>

#include "coordinator/local/private_folder.h"
#include "coordinator/local/worker_pool.h"
#include "coordinator/server/server.h"
#include "coordinator/server/zmq_transport.h"
#include "coordinator/store/checkpoint_file.h"
#include "coordinator/store/recovery.h"
#include "schema/build_info.h"
#include "schema/numerics.h"
#include "schema/store/atomic_file.h"
#include "schema/store/blob_file.h"
#include "schema/store/regular_file.h"
#include "schema/wire/shared_blobs.h"

namespace cairn::coordinator {
namespace {

namespace fs = std::filesystem;

constexpr const char* kJobId = "run";
constexpr double kPoll_s = 0.05;
constexpr double kProgressEvery_s = 0.1;
constexpr double kWorkerPatience_s = 0.3;  // with save_patience_s below 2 s

EmbeddedResult End(EmbeddedEnd end, std::string reason) {
  EmbeddedResult result;
  result.end = end;
  result.reason = std::move(reason);
  return result;
}

// The run cannot have its folder: in use, full, or no place to write to, which is the user's choice.
EmbeddedResult NoFolder(const Status& status) {
  const Code code = status.code();
  const bool worlds_fault = code == Code::kNoSpace || code == Code::kIo;
  return End(code == Code::kBusy ? EmbeddedEnd::kBusy
             : worlds_fault      ? EmbeddedEnd::kFailed
                                 : EmbeddedEnd::kInputError,
             status.message());
}

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// A line each. What is no stage's name, but a path out of the folder, say, was not written here, nor was what
// lies beyond the names that a job may have.
std::set<std::string> ReadStages(const fs::path& path) {
  constexpr std::size_t kMostBytes = 1 << 16;
  const Result<RegularFile> file = RegularFile::Open(path);
  if (!file.ok()) return {};
  std::string text(std::min<std::uint64_t>(kMostBytes, file.value().size()), '\0');
  if (file.value().ReadAt(std::as_writable_bytes(std::span(text)), 0) != 0) return {};
  if (text.size() == kMostBytes) text.resize(text.rfind('\n') + 1);  // a name that was cut is another
  std::set<std::string> stages;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (IsPlainName(line)) stages.insert(line);
  return stages;
}

bool IsLink(const fs::path& path) {
  std::error_code error;
  return fs::is_symlink(fs::symlink_status(path, error));
}

// Not also where that cannot be looked at now.
bool IsThere(const fs::path& path) {
  std::error_code unknown;
  return fs::exists(path, unknown);
}

// The figures that a plan's State carries for people.
std::map<std::string, double> ExpectedOf(const proto::Step& step) {
  const std::string prefix = "expected/";
  std::map<std::string, double> expected;
  for (const auto& [name, value] : step.state().scalars())
    if (name.starts_with(prefix)) expected[name.substr(prefix.size())] = value.d();
  return expected;
}

// What the run's end says again needs no warning of its own.
LogSink WithoutTheEnd(LogSink log) {
  return [log = std::move(log)](Severity severity, const std::string& line) {
    if (!line.starts_with(std::string(kJobId) + ": failed: ")) log(severity, line);
  };
}

class Run {
 public:
  Run(const EmbeddedOptions& options, proto::Job job, std::vector<wire::NamedBlob> inputs, StoreFolder folder)
      : options_(options), job_(std::move(job)), inputs_(std::move(inputs)), folder_(std::move(folder)) {
    if (!options_.log) options_.log = [](Severity, const std::string&) {};
  }

  EmbeddedResult Do(const std::function<void(const EmbeddedProgress&)>& on_progress,
                    const std::atomic<bool>& stop);
  // The folder stays locked; the memory for blobs is given back.
  void EndHub() { server_.reset(); }

 private:
  std::string Endpoint() const { return "ipc://" + (socket_folder_->path() / "hub").string(); }
  fs::path ResultFile(const std::string& stage) const { return fs::path(options_.dir) / (stage + ".h5"); }
  // Stages of the run that `force` replaces, while their results are still there.
  fs::path ReplacedFile() const { return folder_.dir() / "replaced"; }
  std::set<std::string> StagesHere() const;
  std::optional<fs::path> InputThatWouldGo() const;
  Status Clear();
  std::vector<fs::path> MadeOf(const std::set<std::string>& stages) const;
  bool IsInputFile(const fs::path& file) const;
  Status WriteReplaced(const std::set<std::string>& stages) const;
  void RemoveReplaced();
  Status Open();
  bool EarlierRunIsWorthless() const;
  std::vector<fs::path> PublishedByThisRun() const;
  std::optional<EmbeddedResult> LookAtEarlierRun();
  std::string WhatIsWrongWithResults() const;
  wire::SharedMemory ShareInputs() const;
  void KillTheLost(WorkerPool& workers);
  void SayHowItDied(const WorkerPool::Death& death) const;
  void Loop(WorkerPool& workers, const std::function<void(const EmbeddedProgress&)>& on_progress,
            const std::atomic<bool>& stop);
  EmbeddedResult Outcome() const;
  EmbeddedResult Refused() const;
  const Job* Known() const { return server_->core().FindJob(kJobId); }

  EmbeddedOptions options_;
  const proto::Job job_;
  const std::vector<wire::NamedBlob> inputs_;
  StoreFolder folder_;
  std::optional<PrivateFolder> socket_folder_;
  std::unique_ptr<Transport> transport_;
  std::unique_ptr<Server> server_;
  std::map<std::int64_t, double> seen_s_;  // pid -> when the worker was last in the fleet
  bool resumed_ = false;
  std::optional<EmbeddedResult> trouble_;  // that ends the run, whatever the job's state
};

// Of earlier runs, whose results may be there.
std::set<std::string> Run::StagesHere() const {
  std::set<std::string> stages = ReadStages(ReplacedFile());
  for (const std::string& job : folder_.JobsWithCheckpoints())
    for (const std::uint64_t number : folder_.CheckpointNumbers(job))
      if (const auto checkpoint = ReadCheckpoint(folder_.CheckpointFile(job, number)); checkpoint.ok())
        for (const proto::Stage& stage : checkpoint.value().job().stages())
          if (IsPlainName(stage.name())) stages.insert(stage.name());
  return stages;
}

std::optional<fs::path> Run::InputThatWouldGo() const {
  std::set<std::string> stages = StagesHere();
  for (const proto::Stage& stage : job_.stages()) stages.insert(stage.name());
  for (const fs::path& file : MadeOf(stages))
    if (IsInputFile(file)) return file;
  return std::nullopt;
}

// Forgets earlier runs. Their results stay until the new run has one of its own: it may yet be refused. What
// the store alone tells of them is written down before it goes.
Status Run::Clear() {
  std::set<std::string> stages = StagesHere();
  if (const Status status = WriteReplaced(stages); !status.ok()) return status;
  if (const Status status = folder_.Clear(); !status.ok()) return status;
  for (const proto::Stage& stage : job_.stages()) stages.insert(stage.name());
  return WriteReplaced(stages);
}

// Results and pages of a run with these stages.
std::vector<fs::path> Run::MadeOf(const std::set<std::string>& stages) const {
  std::vector<fs::path> files;
  for (const char* page : {"map.png", "picture.png", "report.html"}) {
    files.push_back(fs::path(options_.dir) / page);
    for (const std::string& stage : stages)
      if (const fs::path folder = fs::path(options_.dir) / stage; !IsLink(folder))
        files.push_back(folder / page);
  }
  for (const std::string& stage : stages) files.push_back(ResultFile(stage));
  return files;
}

bool Run::IsInputFile(const fs::path& file) const {
  return std::ranges::any_of(options_.input_files, [&](const std::string& input) {
    std::error_code ignored;  // of files that are not there: not the same
    return fs::equivalent(file, input, ignored);
  });
}

Status Run::WriteReplaced(const std::set<std::string>& stages) const {
  std::string lines;
  for (const std::string& stage : stages) lines += stage + "\n";
  return WriteTextAtomically(ReplacedFile(), lines);
}

// The new run has a result: what it replaces goes, all together, with the pictures that were made of it.
void Run::RemoveReplaced() {
  if (Known()->stage == 0 || !IsThere(ReplacedFile()) || !folder_.IsStillThere().ok()) return;
  const std::set<std::string> stages = ReadStages(ReplacedFile());
  std::vector<fs::path> files = MadeOf(stages);
  for (std::uint32_t done = 0; done < Known()->stage; ++done)
    std::erase(files, ResultFile(job_.stages(static_cast<int>(done)).name()));
  std::erase_if(files, [this](const fs::path& file) { return IsInputFile(file); });
  for (const fs::path& file : files) {
    std::error_code error;
    fs::remove(file, error);
    if (error) options_.log(Severity::kWarning, file.string() + ": " + error.message());
  }
  std::error_code ignored;  // the next run tries again
  fs::remove(ReplacedFile(), ignored);
}

// A run that ended for bad input before it had any result: whoever mends the input need not force anything.
bool Run::EarlierRunIsWorthless() const {
  const Job* known = Known();
  return known != nullptr && known->input_error && known->results.empty() && known->hash != HashOfJob(job_);
}

std::vector<fs::path> Run::PublishedByThisRun() const {
  const std::set<std::string> replaced = ReadStages(ReplacedFile());
  std::vector<fs::path> files;
  for (const proto::Stage& stage : job_.stages())
    if (!replaced.contains(stage.name()) && IsThere(ResultFile(stage.name())))
      files.push_back(ResultFile(stage.name()));
  return files;
}

Status Run::Open() {
  transport_.reset();
  socket_folder_.reset();
  Result<PrivateFolder> socket_folder = PrivateFolder::Make();
  if (!socket_folder.ok()) return socket_folder.status();
  socket_folder_.emplace(std::move(socket_folder).value());
  Result<std::unique_ptr<Transport>> transport = ListenZmq(Endpoint());
  if (!transport.ok()) return transport.status();
  transport_ = std::move(transport).value();
  Result<JobTable> table = OpenJobTable(folder_, options_.log);
  if (!table.ok()) return table.status();
  ServerOptions server;
  FixNumericsOfThread();
  server.core.build = ThisBuild();
  server.core.checkpoint_interval_s = options_.checkpoint_interval_s;
  server.core.checkpoint_rounds = options_.checkpoint_rounds;
  server.given_inputs = inputs_;
  server.result_path = [this](const std::string&, const std::string& stage) { return ResultFile(stage); };
  server.result_files = [this](const std::string&) { return PublishedByThisRun(); };
  try {
    server_ = std::make_unique<Server>(folder_, *transport_, std::move(table).value(), std::move(server),
                                       WithoutTheEnd(options_.log));
  } catch (const UnreadableStore& error) {
    return {Code::kIo, error.what()};
  }
  return Status::Ok();
}

// Of each stage that is done its file holds the very arrays that the checkpoint names:
// those of this job, its inputs and its options.
std::string Run::WhatIsWrongWithResults() const {
  const Job& known = *Known();
  for (std::size_t stage = 0; stage < known.results.size(); ++stage) {
    const fs::path file = ResultFile(known.spec.stages(static_cast<int>(stage)).name());
    if (!IsThere(file) && known.state != proto::JOB_DONE) continue;
    if (!IsThere(file)) return file.string() + " is missing";
    const Result<BlobFile> result = ReadBlobFile(file, {.only = {}, .without = {"provenance/"}});
    if (!result.ok()) return "its result cannot be used: " + result.status().message();
    if (result.value().blob.ContentHash() != known.results[stage])
      return file.string() + " is not what it computed";
  }
  return "";
}

// What is in the folder already: nothing, the same job, or something else.
std::optional<EmbeddedResult> Run::LookAtEarlierRun() {
  const Job* known = Known();
  if (known == nullptr) {
    const std::set<std::string> replaced = ReadStages(ReplacedFile());
    for (const proto::Stage& stage : job_.stages())
      if (IsThere(ResultFile(stage.name())) && !replaced.contains(stage.name()))
        return End(EmbeddedEnd::kConflict,
                   ResultFile(stage.name()).string() + " is there already, of another run");
    return std::nullopt;
  }
  if (known->hash != HashOfJob(job_))
    return End(EmbeddedEnd::kConflict,
               options_.dir + " holds a run of another job, or of other inputs or options");
  if (const std::string wrong = WhatIsWrongWithResults(); !wrong.empty())
    return End(EmbeddedEnd::kConflict, options_.dir + " holds this run, but " + wrong);
  if (known->state != proto::JOB_DONE) {
    if (known->build && !BuildDifference(ThisBuild(), *known->build).empty())
      return End(EmbeddedEnd::kConflict, options_.dir +
                                             " holds a run that another build of cairn began: its " +
                                             BuildDifference(ThisBuild(), *known->build));
    resumed_ = known->step.has_value() || known->stage > 0;
    return std::nullopt;
  }
  EmbeddedResult done = Outcome();
  done.end = EmbeddedEnd::kAlreadyDone;
  return done;
}

// A large log, say, which else each worker would fetch, on the cores that count. Where the system has no room
// for that, they do.
wire::SharedMemory Run::ShareInputs() const {
  Result<wire::SharedMemory> shared = wire::ShareBlobs(inputs_);
  if (shared.ok()) return std::move(shared).value();
  options_.log(Severity::kWarning, shared.status().message() + "; each worker fetches the inputs");
  return {};
}

EmbeddedResult Run::Do(const std::function<void(const EmbeddedProgress&)>& on_progress,
                       const std::atomic<bool>& stop) {
  if (options_.force) {
    if (const auto input = InputThatWouldGo())
      return End(EmbeddedEnd::kInputError, "'" + input->string() +
                                               "' is an input, and would go with the earlier run of " +
                                               options_.dir + ": name another folder");
    if (const Status status = Clear(); !status.ok()) return End(EmbeddedEnd::kFailed, status.message());
  }
  if (const Status status = Open(); !status.ok()) return End(EmbeddedEnd::kFailed, status.message());
  if (EarlierRunIsWorthless()) {
    server_.reset();
    Status status = folder_.Clear();
    if (status.ok()) status = Open();
    if (!status.ok()) return End(EmbeddedEnd::kFailed, status.message());
  }
  if (std::optional<EmbeddedResult> found = LookAtEarlierRun()) {
    if (found->end == EmbeddedEnd::kAlreadyDone) RemoveReplaced();  // where it was killed before it did
    return *found;
  }
  const wire::SharedMemory shared = ShareInputs();
  WorkerPool workers({options_.worker_program, Endpoint(), options_.workers, 5, folder_.dir() / "workers.log",
                      options_.task_memory_mb, shared.descriptor()});
  if (const Status status = workers.Start(); !status.ok()) return End(EmbeddedEnd::kFailed, status.message());
  if (Known() == nullptr)
    server_->Submit(kJobId, job_, inputs_);
  else
    server_->GoOn(kJobId);
  if (options_.when_listening) options_.when_listening(Endpoint());
  Loop(workers, on_progress, stop);
  server_->Shut(options_.save_patience_s);
  RemoveReplaced();
  workers.End(kWorkerPatience_s);
  if (on_progress)
    on_progress({MakeInfo(*Known(), Now()), static_cast<unsigned>(server_->core().fleet().size())});
  return trouble_ ? *trouble_ : Outcome();
}

// A worker of one's own that was not heard of for so long that the fleet has given it up (stopped, say) is
// replaced.
void Run::KillTheLost(WorkerPool& workers) {
  constexpr double kLost_s = 2;
  std::set<std::int64_t> here;
  for (const auto& [number, worker] : server_->core().fleet().workers()) here.insert(worker.hello.pid());
  for (const std::int64_t pid : here) seen_s_[pid] = Now();
  for (const auto& [pid, seen_s] : seen_s_)
    if (Now() - seen_s > kLost_s) workers.Kill(pid);
}

// The hub may have known it by its connection first, which does not tell how.
void Run::SayHowItDied(const WorkerPool::Death& death) const {
  if (death.signal == 0) return;
  if (death.killed_here) {
    options_.log(Severity::kWarning, "worker process " + std::to_string(death.pid) +
                                         " was silent for too long (stopped?) and is replaced by another");
    return;
  }
  options_.log(Severity::kWarning,
               "worker process " + std::to_string(death.pid) + " died of signal " +
                   std::to_string(death.signal) + " (" + ::strsignal(death.signal) + ")" +
                   (death.signal == SIGKILL ? ": where nobody killed it, memory ran out" : ""));
}

void Run::Loop(WorkerPool& workers, const std::function<void(const EmbeddedProgress&)>& on_progress,
               const std::atomic<bool>& stop) {
  double told_s = 0;
  const auto planned = [&] { return options_.plan_only && (Known()->step || Known()->stage > 0); };
  while (!stop && !trouble_ && Known()->Running() && !planned()) {
    server_->Step(kPoll_s);
    RemoveReplaced();
    if (Now() - told_s < kProgressEvery_s) continue;
    told_s = Now();
    if (on_progress)
      on_progress({MakeInfo(*Known(), told_s), static_cast<unsigned>(server_->core().fleet().size())});
    KillTheLost(workers);
    for (const WorkerPool::Death& death : workers.Reap()) {
      seen_s_.erase(death.pid);
      server_->TellDead(death.pid);
      SayHowItDied(death);
      // Whom nobody here has refused (its connection broke at a bad moment) may fare better the next time.
      if (death.refused && !server_->last_refusal().empty()) trouble_ = Refused();
    }
    if (workers.AllGone() && !trouble_)
      trouble_ = End(EmbeddedEnd::kFailed, "the workers keep dying; what they say is in " +
                                               (folder_.dir() / "workers.log").string());
  }
}

EmbeddedResult Run::Refused() const {
  return End(EmbeddedEnd::kFailed, "a worker was refused: " + server_->last_refusal());
}

EmbeddedResult Run::Outcome() const {
  const Job& job = *Known();
  EmbeddedResult result;
  result.reason = job.reason;
  result.info = MakeInfo(job, Now());
  result.resumed = resumed_;
  if (options_.plan_only && job.step) result.expected = ExpectedOf(*job.step);
  switch (job.state) {
    case proto::JOB_DONE:
      result.end = EmbeddedEnd::kDone;
      break;
    case proto::JOB_PAUSED:
      result.end = EmbeddedEnd::kPaused;
      break;
    case proto::JOB_FAILED:
      result.end = job.input_error ? EmbeddedEnd::kInputError : EmbeddedEnd::kFailed;
      break;
    default:
      result.end = EmbeddedEnd::kStopped;
  }
  for (std::uint32_t stage = 0; stage < job.stage; ++stage) {
    const std::string& name = job_.stages(static_cast<int>(stage)).name();
    result.results[name] = ResultFile(name).string();
  }
  return result;
}

}  // namespace

EmbeddedResult RunEmbedded(const EmbeddedOptions& options, proto::Job job,
                           const std::map<std::string, BlobPtr>& inputs,
                           const std::function<void(const EmbeddedProgress&)>& on_progress,
                           const std::atomic<bool>& stop) {
  std::vector<wire::NamedBlob> named;
  job.clear_input_blobs();
  for (const auto& [name, blob] : inputs) {
    named.push_back(wire::NameBlob(blob));
    (*job.mutable_input_blobs())[name] = named.back().hash.Binary();
  }
  if (const std::string wrong = CheckJob(job); !wrong.empty()) return End(EmbeddedEnd::kInputError, wrong);
  std::error_code error;
  fs::create_directories(options.dir, error);
  if (error) return NoFolder(SystemFailure(options.dir, "cannot make the folder", error.value()));
  const fs::path store = fs::path(options.dir) / ".cairn";
  if (IsLink(store))
    return End(EmbeddedEnd::kConflict,
               store.string() + " is a link; a run keeps what it needs in its own folder");
  for (const proto::Stage& stage : job.stages())
    if (const fs::path pages = fs::path(options.dir) / stage.name(); IsLink(pages))
      return End(EmbeddedEnd::kInputError,
                 pages.string() + " is a link; the pages of a stage go into a folder of the run's own");
  Result<StoreFolder> folder = StoreFolder::Open(store);
  if (!folder.ok()) return NoFolder(folder.status());
  RemoveLeftovers(options.dir);
  Run run(options, std::move(job), std::move(named), std::move(folder).value());
  EmbeddedResult result = run.Do(on_progress, stop);
  run.EndHub();
  const bool done = result.end == EmbeddedEnd::kDone || result.end == EmbeddedEnd::kAlreadyDone;
  if (done && options.when_done) options.when_done(result);
  return result;
}

}  // namespace cairn::coordinator
