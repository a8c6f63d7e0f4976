#include "coordinator/client.h"

#include <chrono>
#include <set>
#include <utility>

#include "schema/wire/poller.h"

namespace cairn::coordinator {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kCleaning_s = 600;  // it reads every checkpoint
constexpr double kSlowestBytesPerS = 1e6;

std::chrono::milliseconds Left(Clock::time_point end) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
  return std::max(left, std::chrono::milliseconds(0));
}

Result<wire::JobInfo> OnlyJob(const Result<wire::Message>& reply, const std::string& job) {
  if (!reply.ok()) return reply.status();
  const auto& jobs = reply.value().envelope.reply().jobs();
  if (jobs.empty()) return Status(Code::kNotFound, "there is no job '" + job + "'");
  return jobs[0];
}

// What came where a reply was expected.
Result<wire::Message> Judge(wire::Received received) {
  if (!received.status.ok()) return received.status;
  const wire::Envelope& envelope = received.message.envelope;
  if (envelope.has_refuse()) return Status(Code::kRefused, envelope.refuse().reason());
  if (!envelope.has_reply()) {
    return Status(Code::kVersion, std::string("the service answers with '") + wire::KindName(envelope) +
                                      "': its version differs");
  }
  // Where something is missing it may be sent: no refusal yet.
  if (!envelope.reply().ok() && envelope.reply().missing().empty())
    return Status(Code::kRefused, envelope.reply().message());
  return std::move(received.message);
}

}  // namespace

Client::Client(ClientOptions options, wire::DealerSocket socket)
    : options_(std::move(options)), socket_(std::move(socket)) {}

Result<Client> Client::Connect(const ClientOptions& options) {
  const wire::Context context;
  Result<wire::DealerSocket> socket =
      wire::DealerSocket::Connect(context, options.endpoint, options.security);
  if (!socket.ok()) return socket.status();
  return Client(options, std::move(socket).value());
}

Result<wire::Message> Client::Ask(wire::Message question, double timeout_s) {
  Result<wire::Message> answer = AskOnce(std::move(question), timeout_s);
  const Code code = answer.status().code();
  if (code == Code::kOk || (code == Code::kRefused && answered_)) return answer;
  // An answer that comes late must not be taken for that to the next question.
  if (const Status again = socket_.Reconnect(); !again.ok()) return again;
  return answer;
}

Result<wire::Message> Client::AskOnce(wire::Message question, double timeout_s) {
  const Clock::time_point end =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(timeout_s));
  wire::Poller poller;
  poller.Add(socket_);
  answered_ = false;
  bool sent = false, broken = false;
  while (true) {
    while (const std::optional<wire::LinkEvent> event = socket_.TryEvent()) {
      if (*event == wire::LinkEvent::kKeyRefused)
        return Status(Code::kRefused, "the service does not know this key");
      broken |= *event == wire::LinkEvent::kHandshakeFailed;
      if (*event == wire::LinkEvent::kDisconnected && sent) {
        return Status(Code::kIo, "the service at " + options_.endpoint + " went away before it answered");
      }
    }
    if (!sent) sent = socket_.Send(question).ok();
    if (std::optional<wire::Received> received = socket_.TryReceive()) {
      answered_ = received->status.ok();
      return Judge(std::move(*received));
    }
    if (Clock::now() >= end) {
      const std::string service = "the service at " + options_.endpoint;
      if (!sent && broken)
        return Status(Code::kIo, service +
                                     " breaks off each connection before it is secured: is the server key "
                                     "that of the coordinator, and has this key no connections too many?");
      return Status(Code::kIo,
                    sent ? service + " does not answer" : "no service listens at " + options_.endpoint);
    }
    // Unsent, the connection may be there before its event is: look again soon.
    poller.Wait(sent ? Left(end) : std::min(Left(end), std::chrono::milliseconds(20)));
  }
}

// First without its inputs: the service may have them, or the job. What it has then may be gone when they
// come, with the job that held it: so a second time.
Result<wire::JobInfo> Client::Submit(proto::Job job, const std::map<std::string, BlobPtr>& inputs,
                                     bool* known) {
  std::map<std::string, wire::NamedBlob> blobs;  // by hash
  for (const auto& [name, blob] : inputs) {
    const wire::NamedBlob named = wire::NameBlob(blob);
    (*job.mutable_input_blobs())[name] = named.hash.Binary();
    blobs.emplace(named.hash.Binary(), named);
  }
  std::set<std::string> lacking;
  for (int tries = 0; tries < 3; ++tries) {
    wire::Message submit;
    *submit.envelope.mutable_submit()->mutable_job() = job;
    std::size_t bytes = 0;
    for (const std::string& hash : lacking) {
      const auto it = blobs.find(hash);
      if (it == blobs.end())
        return Status(Code::kVersion, "the service asks for a blob that it was not offered");
      bytes += it->second.blob->ByteCount();
      submit.blobs.push_back(it->second);
    }
    const Result<wire::Message> answer =
        Ask(std::move(submit), options_.timeout_s + static_cast<double>(bytes) / kSlowestBytesPerS);
    if (!answer.ok()) return answer.status();
    const wire::Reply& reply = answer.value().envelope.reply();
    if (reply.ok()) {
      if (known != nullptr) *known = reply.known();
      return OnlyJob(answer, "");
    }
    lacking.insert(reply.missing().begin(), reply.missing().end());
  }
  return Status(Code::kRefused, "the service does not keep the job's inputs");
}

Result<wire::Message> Client::Query(const std::string& job, const std::string& action, double timeout_s) {
  wire::Message question;
  question.envelope.mutable_query()->set_job(job);
  question.envelope.mutable_query()->set_action(action);
  return Ask(std::move(question), timeout_s);
}

Result<wire::JobInfo> Client::Command(const std::string& job, const std::string& action, int priority) {
  // An empty name would ask for all.
  if (job.empty()) return Status(Code::kNotFound, "which job?");
  wire::Message question;
  question.envelope.mutable_query()->set_job(job);
  question.envelope.mutable_query()->set_action(action);
  question.envelope.mutable_query()->set_priority(priority);
  return OnlyJob(Ask(std::move(question), options_.timeout_s), job);
}

Result<JobList> Client::List() {
  const Result<wire::Message> answer = Query("", "status", options_.timeout_s);
  if (!answer.ok()) return answer.status();
  const wire::Reply& reply = answer.value().envelope.reply();
  return JobList{{reply.jobs().begin(), reply.jobs().end()},
                 reply.workers(),
                 {reply.refused().begin(), reply.refused().end()},
                 {reply.store_bytes(), reply.store_limit_bytes()},
                 reply.warning()};
}

Result<std::vector<wire::WorkerInfo>> Client::Workers() { return AskOfWorkers("status", 0); }

Result<std::vector<wire::WorkerInfo>> Client::Drain(std::uint64_t worker) {
  return AskOfWorkers("drain", worker);
}

Result<std::vector<wire::WorkerInfo>> Client::AskOfWorkers(const std::string& action, std::uint64_t worker) {
  wire::Message question;
  question.envelope.mutable_workers()->set_action(action);
  question.envelope.mutable_workers()->set_worker(worker);
  const Result<wire::Message> answer = Ask(std::move(question), options_.timeout_s);
  if (!answer.ok()) return answer.status();
  const auto& fleet = answer.value().envelope.reply().fleet();
  return std::vector<wire::WorkerInfo>(fleet.begin(), fleet.end());
}

Result<LogPart> Client::Log(const std::string& job, std::uint64_t after) {
  wire::Message question;
  question.envelope.mutable_query()->set_job(job);
  question.envelope.mutable_query()->set_action("logs");
  question.envelope.mutable_query()->set_after(after);
  const Result<wire::Message> answer = Ask(std::move(question), options_.timeout_s);
  const Result<wire::JobInfo> info = OnlyJob(answer, job);
  if (!info.ok()) return info.status();
  const auto& lines = answer.value().envelope.reply().log();
  return LogPart{info.value(), {lines.begin(), lines.end()}};
}

Result<wire::Reply> Client::Clean(bool damaged, bool dry_run) {
  wire::Message question;
  question.envelope.mutable_clean()->set_damaged(damaged);
  question.envelope.mutable_clean()->set_dry_run(dry_run);
  Result<wire::Message> answer = Ask(std::move(question), kCleaning_s);
  if (!answer.ok()) return answer.status();
  return answer.value().envelope.reply();
}

Result<wire::JobInfo> Client::Info(const std::string& job) { return Command(job, "status"); }

Result<std::map<std::string, BlobPtr>> Client::Results(const std::string& job) {
  if (job.empty()) return Status(Code::kNotFound, "which job?");
  // How much will come is not known before: as for a gigabyte.
  Result<wire::Message> answer = Query(job, "results", options_.timeout_s + 1e9 / kSlowestBytesPerS);
  if (!answer.ok()) return answer.status();
  const wire::Reply& reply = answer.value().envelope.reply();
  // A stage whose file cannot be read any more.
  if (!reply.message().empty()) return Status(Code::kCorrupt, reply.message());
  const std::vector<wire::NamedBlob>& blobs = answer.value().blobs;
  if (static_cast<std::size_t>(reply.names_size()) != blobs.size()) {
    return Status(Code::kCorrupt, "the service names " + std::to_string(reply.names_size()) +
                                      " results and sends " + std::to_string(blobs.size()));
  }
  std::map<std::string, BlobPtr> results;
  for (const std::string& name : reply.names())
    if (name.empty() || name[0] == '.' || name.find('/') != std::string::npos ||
        name.find('\0') != std::string::npos)
      return Status(Code::kCorrupt, "the service sends a result whose name is no file's name");
  for (std::size_t i = 0; i < blobs.size(); ++i) results[reply.names(static_cast<int>(i))] = blobs[i].blob;
  return results;
}

}  // namespace cairn::coordinator
