// The client side of a coordinator's service (server/service.h): what `cairn submit`, `list`, `cancel` and
// the like do.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/error.h"
#include "schema/wire.pb.h"
#include "schema/wire/socket.h"

namespace cairn::coordinator {

struct ClientOptions {
  std::string endpoint;                          // ipc://PATH or tcp://HOST:PORT
  std::optional<wire::ClientSecurity> security;  // needed for tcp
  double timeout_s = 10;  // without an answer; a transfer gets a second more a megabyte
};

struct StoreFacts {
  std::uint64_t bytes = 0;        // on disk
  std::uint64_t limit_bytes = 0;  // 0: none
};

struct JobList {
  std::vector<wire::JobInfo> jobs;
  unsigned workers = 0;                          // connected
  std::map<std::string, std::uint64_t> refused;  // since the service began, by kind (schema/wire/refusal.h)
  StoreFacts store;
  std::string warning = {};  // what is wrong with the service; empty: nothing
  bool store_fails = false;  // that is that its store cannot be written
  bool may_submit = false;   // who asks may hand in jobs
};

struct FleetFacts {
  std::vector<wire::WorkerInfo> workers;  // those that are connected, in the order in which they joined
  std::vector<wire::Demand> demand;       // of each job that runs
};

// Of a job's log.
struct LogPart {
  wire::JobInfo job;  // where it is over, the lines are all that there are
  std::vector<wire::LogLine> lines;
};

// The bytes of an input's arrays, in the order of names.
class InputBytes {
 public:
  virtual ~InputBytes() = default;
  virtual Status Read(std::span<std::byte> bytes) = 0;  // fills `bytes`
};

// An input of a job, which need not fit into memory.
struct Input {
  wire::BlobMeta meta;
  // From their beginning; again where an upload has to begin again.
  std::function<Result<std::unique_ptr<InputBytes>>()> open;
};
Input InputInMemory(BlobPtr blob);

// What there is to say of a job's results.
struct ResultsFacts {
  wire::JobInfo job;    // as it stands
  std::string damaged;  // why stages that are done are not among them; empty: none is missing
};

// Every call asks once and waits for the answer. After a failure the next call starts on a new connection.
// For one thread.
// kIo: nobody answers at the endpoint.
// kRefused: the service said no (message: why), or does not know this key.
// kNoSpace: it cannot now, for what it lacks (a full disk or store, too much that others ask). Where it says
// that it was asked too often it is asked again, for a minute.
// kNotFound: no such job.
class Client {
 public:
  // Does not wait for the service to be there: the first call does.
  static Result<Client> Connect(const ClientOptions& options);

  // Uploads those inputs (by the names of job.inputs; truth left behind by the caller) that the service
  // lacks, in pieces, and no faster than it lets them come; fills in job.input_blobs, and returns the job as
  // it is queued, once it is durable. Where the service goes away in the middle, it begins again once it is
  // back. `known`: the service has the same job already, which may be done.
  Result<wire::JobInfo> Submit(proto::Job job, const std::map<std::string, Input>& inputs,
                               bool* known = nullptr);
  Result<wire::JobInfo> Submit(proto::Job job, const std::map<std::string, BlobPtr>& inputs,
                               bool* known = nullptr);
  Result<JobList> List();
  Result<wire::JobInfo> Info(const std::string& job);
  // pause, resume, cancel, retry, delete or priority: once it is durable, the job as it stands then (one that
  // is gone has the state `deleted`).
  Result<wire::JobInfo> Command(const std::string& job, const std::string& action, int priority = 0);
  Result<FleetFacts> Fleet();
  // The lines whose numbers are above `after`.
  Result<LogPart> Log(const std::string& job, std::uint64_t after = 0);
  // Lets a worker finish what it runs, and end; 0: all. Those that were told, as they stand then.
  Result<std::vector<wire::WorkerInfo>> Drain(std::uint64_t worker);
  // Reply.cleaned says what went, or would; Reply.message why that is not all.
  Result<wire::Reply> Clean(bool damaged, bool dry_run);
  // Of the stages that are done, by their names; asked for again where the connection is lost before they are
  // here. kCorrupt: one cannot be read; where `facts` are asked for that
  // is said there, beside those that can.
  Result<std::map<std::string, BlobPtr>> Results(const std::string& job, ResultsFacts* facts = nullptr);
  // In the same way what there is to see of the stage under way (State.so_far); nothing: there is none.
  Result<std::map<std::string, BlobPtr>> SoFar(const std::string& job, ResultsFacts* facts = nullptr);
  // And the inputs of a job of one's own, by their names; nothing: they are not kept any more.
  Result<std::map<std::string, BlobPtr>> Inputs(const std::string& job, ResultsFacts* facts = nullptr);

 private:
  Result<std::map<std::string, BlobPtr>> Blobs(const std::string& job, const std::string& action,
                                               ResultsFacts* facts);
  Result<FleetFacts> AskOfWorkers(const std::string& action, std::uint64_t worker);
  explicit Client(ClientOptions options, wire::DealerSocket socket);
  // `repeats`: how often it may ask again on another connection.
  Result<wire::Message> Ask(wire::Message question, double timeout_s, int repeats = 0);
  // Where the last answer was that it was asked too often, and may be again before `end`: waits until then.
  bool WaitToAskAgain(std::chrono::steady_clock::time_point end);
  // kBusy: it has to begin again.
  Status Upload(const Input& input);
  Result<wire::Message> AskOnce(const wire::Message& question, double timeout_s, int repeats);
  Result<wire::Message> Query(const std::string& job, const std::string& action, double timeout_s,
                              int repeats = 0);

  ClientOptions options_;
  wire::DealerSocket socket_;
  bool answered_ = false;  // the last question, whatever the answer was
  double again_s_ = 0;     // Reply.again_s of it
};

}  // namespace cairn::coordinator
