#include "coordinator/client.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "schema/flat_blob.h"
#include "schema/text.h"
#include "schema/wire/poller.h"

namespace cairn::coordinator {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kCleaning_s = 600;  // it reads every checkpoint
constexpr double kSlowestBytesPerS = 1e6;
constexpr std::uint64_t kPieceBytes = 1'000'000;  // no more at a time: a message of less than a MiB
constexpr int kMostUnkept = 3;                    // submissions in turn after which inputs are missing
constexpr double kPatience_s = 60;                // with a service that says: ask again later
constexpr int kMostBroken = 5;                    // uploads that are begun again, answers asked for again

std::chrono::milliseconds Left(Clock::time_point end) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
  return std::max(left, std::chrono::milliseconds(0));
}

Clock::time_point After(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

// Waits, and says for how much longer than that this process was stopped meanwhile: a time in which nobody
// could have answered.
Clock::duration WaitedTooLong(wire::Poller& poller, std::chrono::milliseconds time) {
  constexpr Clock::duration kSurelyStopped = std::chrono::seconds(1);
  const Clock::time_point begin = Clock::now();
  poller.Wait(time);
  const Clock::duration more = Clock::now() - begin - time;
  return more > kSurelyStopped ? more : Clock::duration(0);
}

class BytesInMemory : public InputBytes {
 public:
  explicit BytesInMemory(BlobPtr blob) : blob_(std::move(blob)), array_(blob_->fields().begin()) {}
  Status Read(std::span<std::byte> bytes) override {
    while (!bytes.empty()) {
      const std::span<const std::byte> left = array_->second.bytes().subspan(at_);
      const std::size_t count = std::min(left.size(), bytes.size());
      std::ranges::copy(left.first(count), bytes.begin());
      bytes = bytes.subspan(count);
      at_ += count;
      if (count < left.size()) continue;
      ++array_;
      at_ = 0;
    }
    return Status::Ok();
  }

 private:
  BlobPtr blob_;
  Blob::Fields::const_iterator array_;
  std::size_t at_ = 0;
};

// A flat blob (schema/flat_blob.h), piece by piece.
class FlatSource {
 public:
  static Result<FlatSource> Open(const Input& input) {
    const Result<std::uint64_t> bytes = FlatBytes(input.meta);
    if (!bytes.ok()) return bytes.status();
    Result<std::unique_ptr<InputBytes>> arrays = input.open();
    if (!arrays.ok()) return arrays.status();
    return FlatSource(input.meta, bytes.value(), std::move(arrays).value());
  }
  std::uint64_t left() const { return bytes_ - at_; }
  // No more than `most` bytes.
  Result<wire::Message> Next(std::uint64_t most) {
    wire::Message message;
    wire::Piece& piece = *message.envelope.mutable_piece();
    piece.set_hash(hash_);
    piece.set_at(at_);
    std::string& data = *piece.mutable_data();
    data.resize(std::min({most, kPieceBytes, left()}));
    const std::size_t of_head =
        head_.copy(data.data(), data.size(), std::min<std::uint64_t>(at_, head_.size()));
    const Status read = arrays_->Read(std::as_writable_bytes(std::span(data)).subspan(of_head));
    if (!read.ok()) return read;
    at_ += data.size();
    return message;
  }

 private:
  FlatSource(const wire::BlobMeta& meta, std::uint64_t bytes, std::unique_ptr<InputBytes> arrays)
      : hash_(meta.hash()), head_(FlatHead(meta)), bytes_(bytes), arrays_(std::move(arrays)) {}
  std::string hash_, head_;
  std::uint64_t bytes_, at_ = 0;
  std::unique_ptr<InputBytes> arrays_;
};

Result<wire::JobInfo> OnlyJob(const Result<wire::Message>& reply, const std::string& job) {
  if (!reply.ok()) return reply.status();
  const auto& jobs = reply.value().envelope.reply().jobs();
  if (jobs.empty()) return Status(Code::kNotFound, "there is no job '" + job + "'");
  return jobs[0];
}

// Files and folders are called after jobs and stages.
bool IsFileName(const std::string& name) {
  return !name.empty() && name[0] != '.' && name.find('/') == std::string::npos &&
         WhatIsWrongWithName(name).empty();
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
  for (const wire::JobInfo& job : envelope.reply().jobs())
    if (!IsFileName(job.id()) || !WhatIsWrongWithName(job.name(), kMostTextBytes).empty())
      return Status(Code::kCorrupt, "the service names a job by what is no name");
  // Where something is missing it may be sent: no refusal yet.
  if (!envelope.reply().ok() && envelope.reply().missing().empty())
    return Status(envelope.reply().unable() ? Code::kNoSpace : Code::kRefused, envelope.reply().message());
  return std::move(received.message);
}

}  // namespace

Input InputInMemory(BlobPtr blob) {
  return {MetaOf(blob->ContentHash(), *blob), [blob]() -> Result<std::unique_ptr<InputBytes>> {
            return std::unique_ptr<InputBytes>(std::make_unique<BytesInMemory>(blob));
          }};
}

Client::Client(ClientOptions options, wire::DealerSocket socket)
    : options_(std::move(options)), socket_(std::move(socket)) {}

Result<Client> Client::Connect(const ClientOptions& options) {
  const wire::Context context;
  Result<wire::DealerSocket> socket =
      wire::DealerSocket::Connect(context, options.endpoint, options.security);
  if (!socket.ok()) return socket.status();
  return Client(options, std::move(socket).value());
}

Result<wire::Message> Client::Ask(wire::Message question, double timeout_s, int repeats) {
  Result<wire::Message> answer = AskOnce(question, timeout_s, repeats);
  for (const Clock::time_point end = After(kPatience_s); WaitToAskAgain(end);)
    answer = AskOnce(question, timeout_s, repeats);
  const Code code = answer.status().code();
  const bool said_no = code == Code::kRefused || code == Code::kNoSpace;
  if (code == Code::kOk || (said_no && answered_)) return answer;
  // An answer that comes late must not be taken for that to the next question.
  if (const Status again = socket_.Reconnect(); !again.ok()) return again;
  return answer;
}

bool Client::WaitToAskAgain(Clock::time_point end) {
  if (!(again_s_ > 0) || again_s_ > kPatience_s) return false;
  const Clock::time_point then = After(again_s_);
  if (then > end) return false;
  std::this_thread::sleep_until(then);
  return true;
}

Result<wire::Message> Client::AskOnce(const wire::Message& question, double timeout_s, int repeats) {
  Clock::time_point end = After(timeout_s);
  wire::Poller poller;
  poller.Add(socket_);
  answered_ = false;
  again_s_ = 0;
  bool sent = false, broken = false, lost = false;
  while (true) {
    while (const std::optional<wire::LinkEvent> event = socket_.TryEvent()) {
      if (*event == wire::LinkEvent::kKeyRefused)
        return Status(Code::kRefused, "the service does not know this key");
      broken |= *event == wire::LinkEvent::kHandshakeFailed;
      if (*event != wire::LinkEvent::kDisconnected || !sent) continue;
      lost = true;
      sent = false;
      end = repeats-- > 0 ? After(options_.timeout_s) : Clock::now();
    }
    if (!sent && (!lost || Clock::now() < end) && (sent = socket_.Send(question).ok()) && lost)
      end = After(timeout_s);
    if (std::optional<wire::Received> received = socket_.TryReceive()) {
      const bool late_credit = received->message.envelope.has_credit();  // for an upload that is over
      if (late_credit && Clock::now() < end) continue;
      if (!late_credit) {
        answered_ = received->status.ok();
        // Asked twice, it may be answered twice.
        if (lost)
          if (const Status again = socket_.Reconnect(); !again.ok()) return again;
        again_s_ = received->message.envelope.reply().again_s();
        return Judge(std::move(*received));
      }
    }
    if (Clock::now() >= end) {
      const std::string service = "the service at " + options_.endpoint;
      if (lost && !sent) return Status(Code::kIo, service + " went away before it answered");
      if (!sent && broken)
        return Status(Code::kIo,
                      service +
                          " breaks off each connection before it is secured, or nothing comes "
                          "back from there: is the server key that of the coordinator, has this key "
                          "no connections too many, does the network pass both ways?");
      return Status(Code::kIo, sent ? service + " does not answer"
                                    : "no service listens at " + options_.endpoint +
                                          ", or the one that does stands still");
    }
    // Unsent, the connection may be there before its event is: look again soon.
    end += WaitedTooLong(poller, sent ? Left(end) : std::min(Left(end), std::chrono::milliseconds(20)));
  }
}

Result<wire::JobInfo> Client::Submit(proto::Job job, const std::map<std::string, BlobPtr>& inputs,
                                     bool* known) {
  std::map<std::string, Input> streamed;
  for (const auto& [name, blob] : inputs) streamed[name] = InputInMemory(blob);
  return Submit(std::move(job), streamed, known);
}

// What the service lacks it says; what it has then may be gone when the job comes again, with the job that
// held it: so more than once. The same where it went away in the middle.
Result<wire::JobInfo> Client::Submit(proto::Job job, const std::map<std::string, Input>& inputs,
                                     bool* known) {
  std::map<std::string, const Input*> by_hash;
  for (const auto& [name, input] : inputs) {
    (*job.mutable_input_blobs())[name] = input.meta.hash();
    by_hash.emplace(input.meta.hash(), &input);
  }
  int unkept = 0, broken = 0;
  while (unkept < kMostUnkept) {
    wire::Message submit;
    submit.envelope.mutable_submit()->set_protocol(wire::kProtocol);
    *submit.envelope.mutable_submit()->mutable_job() = job;
    const Result<wire::Message> answer = Ask(std::move(submit), options_.timeout_s);
    if (!answer.ok()) return answer.status();
    const wire::Reply& reply = answer.value().envelope.reply();
    if (reply.ok()) {
      if (known != nullptr) *known = reply.known();
      return OnlyJob(answer, "");
    }
    ++unkept;
    for (const std::string& hash : reply.missing()) {
      const auto input = by_hash.find(hash);
      if (input == by_hash.end())
        return Status(Code::kVersion, "the service asks for a blob that it was not offered");
      Status uploaded = Upload(*input->second);
      for (const Clock::time_point end = After(kPatience_s); WaitToAskAgain(end);)
        uploaded = Upload(*input->second);
      if (uploaded.ok()) continue;
      const bool again = uploaded.code() == Code::kBusy || uploaded.code() == Code::kIo;
      if (!again || ++broken > kMostBroken) return uploaded;
      if (uploaded.code() == Code::kIo)
        if (const Status connected = socket_.Reconnect(); !connected.ok()) return connected;
      unkept = 0;
      break;
    }
  }
  return Status(Code::kRefused, "the service does not keep the job's inputs");
}

Status Client::Upload(const Input& input) {
  Result<FlatSource> source = FlatSource::Open(input);
  if (!source.ok()) return source.status();
  wire::Message offer;
  offer.envelope.mutable_offer()->set_hash(input.meta.hash());
  offer.envelope.mutable_offer()->set_bytes(source.value().left());
  std::optional<wire::Message> next = std::move(offer);
  std::uint64_t credit = 0;
  Clock::time_point end = After(options_.timeout_s);
  wire::Poller poller;
  poller.Add(socket_);
  while (true) {
    while (const std::optional<wire::LinkEvent> event = socket_.TryEvent())
      if (*event != wire::LinkEvent::kConnected)
        return {Code::kIo, "the service at " + options_.endpoint + " went away in the middle of an upload"};
    while (std::optional<wire::Received> received = socket_.TryReceive()) {
      end = After(options_.timeout_s);
      const wire::Envelope& envelope = received->message.envelope;
      if (received->status.ok() && envelope.has_credit()) {
        if (envelope.credit().hash() == input.meta.hash()) credit += envelope.credit().bytes();
        continue;
      }
      again_s_ = envelope.reply().again_s();
      const Result<wire::Message> answer = Judge(std::move(*received));
      if (!answer.ok()) return answer.status();
      const wire::Reply& reply = answer.value().envelope.reply();
      return reply.ok() ? Status::Ok() : Status(Code::kBusy, reply.message());
    }
    if (!next && credit > 0 && source.value().left() > 0) {
      Result<wire::Message> piece = source.value().Next(credit);
      if (!piece.ok()) return piece.status();
      next = std::move(piece).value();
      credit -= next->envelope.piece().data().size();
    }
    if (next && socket_.Send(*next).ok()) {
      next.reset();
      continue;
    }
    if (Clock::now() >= end) return {Code::kIo, "the service at " + options_.endpoint + " does not answer"};
    end += WaitedTooLong(poller, next ? std::min(Left(end), std::chrono::milliseconds(5)) : Left(end));
  }
}

Result<wire::Message> Client::Query(const std::string& job, const std::string& action, double timeout_s,
                                    int repeats) {
  wire::Message question;
  question.envelope.mutable_query()->set_job(job);
  question.envelope.mutable_query()->set_action(action);
  return Ask(std::move(question), timeout_s, repeats);
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
                 reply.warning(),
                 reply.store_fails(),
                 reply.may_submit()};
}

Result<FleetFacts> Client::Fleet() { return AskOfWorkers("status", 0); }

Result<std::vector<wire::WorkerInfo>> Client::Drain(std::uint64_t worker) {
  Result<FleetFacts> told = AskOfWorkers("drain", worker);
  if (!told.ok()) return told.status();
  return std::move(told).value().workers;
}

Result<FleetFacts> Client::AskOfWorkers(const std::string& action, std::uint64_t worker) {
  wire::Message question;
  question.envelope.mutable_workers()->set_action(action);
  question.envelope.mutable_workers()->set_worker(worker);
  const Result<wire::Message> answer = Ask(std::move(question), options_.timeout_s);
  if (!answer.ok()) return answer.status();
  const wire::Reply& reply = answer.value().envelope.reply();
  return FleetFacts{{reply.fleet().begin(), reply.fleet().end()},
                    {reply.demand().begin(), reply.demand().end()}};
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

Result<std::map<std::string, BlobPtr>> Client::Results(const std::string& job, ResultsFacts* facts) {
  return Blobs(job, "results", facts);
}

Result<std::map<std::string, BlobPtr>> Client::SoFar(const std::string& job, ResultsFacts* facts) {
  return Blobs(job, "so_far", facts);
}

Result<std::map<std::string, BlobPtr>> Client::Inputs(const std::string& job, ResultsFacts* facts) {
  return Blobs(job, "inputs", facts);
}

Result<std::map<std::string, BlobPtr>> Client::Blobs(const std::string& job, const std::string& action,
                                                     ResultsFacts* facts) {
  if (job.empty()) return Status(Code::kNotFound, "which job?");
  // A service that does not answer at all is not waited for as one that sends much.
  const Result<wire::Message> status = Query(job, "status", options_.timeout_s, kMostBroken);
  if (const Result<wire::JobInfo> info = OnlyJob(status, job); !info.ok()) return info.status();
  // How much will come is not known before: as for a gigabyte.
  Result<wire::Message> answer =
      Query(job, action, options_.timeout_s + 1e9 / kSlowestBytesPerS, kMostBroken);
  if (!answer.ok()) return answer.status();
  const wire::Reply& reply = answer.value().envelope.reply();
  if (facts != nullptr)
    *facts = {reply.jobs().empty() ? wire::JobInfo() : reply.jobs(0), reply.message()};
  else if (!reply.message().empty())
    return Status(Code::kCorrupt, reply.message());
  const std::vector<wire::NamedBlob>& blobs = answer.value().blobs;
  if (static_cast<std::size_t>(reply.names_size()) != blobs.size()) {
    return Status(Code::kCorrupt, "the service names " + std::to_string(reply.names_size()) +
                                      " results and sends " + std::to_string(blobs.size()));
  }
  std::map<std::string, BlobPtr> results;
  for (const std::string& name : reply.names())
    if (!IsFileName(name))
      return Status(Code::kCorrupt, "the service sends a result whose name is no file's name");
  for (std::size_t i = 0; i < blobs.size(); ++i) results[reply.names(static_cast<int>(i))] = blobs[i].blob;
  return results;
}

}  // namespace cairn::coordinator
