#include "worker/session.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "schema/blob_part.h"
#include "schema/text.h"

namespace cairn::worker {
namespace {

// Fetches under way: enough to hide the round trip, few enough that the answers fit into the peer's queue.
constexpr std::size_t kMaxRequests = 64;
// Without an answer to any fetch for so long, the answer was lost (a full queue): ask again.
constexpr double kAskAgain_s = 20;
// What comes while it waits for answers is a part of one, unless it is as little as what signs of life take.
constexpr std::uint64_t kSomeBytes = 4096;
constexpr double kHelloAgain_s = 5;
constexpr double kLongestWait_s = 1;
constexpr double kRetry_s = 0.01;  // where the transport's queue is full
constexpr double kShortestHeartbeat_s = 0.01, kLongestHeartbeat_s = 3600;
// A coordinator gives no more tasks than a worker has slots. What it has called back may be answered already,
// and wait to be sent, while others come in its place; more than this of its own is a mistake or an attack.
constexpr std::size_t kTasksPerSlot = 2;

wire::Message FetchOf(const Want& want) {
  wire::Message message;
  wire::Fetch& fetch = *message.envelope.mutable_fetch();
  fetch.set_hash((want.part ? want.part->blob : want.hash).Binary());
  if (want.part) *fetch.mutable_part() = want.part->part;
  return message;
}

// By what is asked for: a blob's hash, or a part's name.
Result<Hash> NameOf(const std::string& blob, const proto::BlobPart* part) {
  Result<Hash> hash = Hash::FromBinary(blob);
  if (!hash.ok() || part == nullptr) return hash;
  return NameOfPart(hash.value(), *part);
}

// A heartbeat names the task and an answer repeats it.
bool HasShortTexts(const wire::Assign& assign) {
  const std::size_t most = wire::JobLimits().text_bytes;
  return assign.key().job().size() <= most && assign.stage().name().size() <= most &&
         assign.stage().pipeline().size() <= most && assign.task().kind().size() <= most;
}

}  // namespace

Session::Session(SessionOptions options, Transport& transport, TaskQueue& queue, double now_s,
                 SharedPath* shared)
    : options_(std::move(options)),
      transport_(transport),
      queue_(queue),
      shared_(shared),
      log_(options_.log),
      cache_(options_.cache_bytes),
      started_s_(now_s) {
  for (const wire::NamedBlob& named : options_.given) given_[named.hash] = named.blob;
}

void Session::Handle(const Event& event, double now_s) {
  switch (event.kind) {
    case Event::kConnected:
      connected_ = true;
      failed_handshakes_ = 0;
      DropConversation();
      SayHello(now_s);
      return;
    case Event::kDisconnected:
      log_.Say(PeerLog::kLink, Severity::kWarning, "the coordinator is gone; waiting for it to come back",
               now_s);
      connected_ = false;
      DropConversation();
      return;
    case Event::kMalformed:
      log_.Say(PeerLog::kMalformed, Severity::kError, event.text, now_s);
      connected_ = false;
      DropConversation();
      return;
    case Event::kHandshakeFailed:
      NoteFailedHandshake();
      return;
    case Event::kKeyRefused:
      End(kExitRefused, Severity::kError, "the coordinator does not know this worker's key");
      return;
    case Event::kMessage:
      HandleMessage(event.message, now_s);
      return;
  }
}

// Told rarer and rarer: it may go on for hours.
void Session::NoteFailedHandshake() {
  connected_ = false;
  DropConversation();
  if (!std::has_single_bit(++failed_handshakes_)) return;
  options_.log(Severity::kWarning,
               "the connection broke before it was secured (" + std::to_string(failed_handshakes_) +
                   (failed_handshakes_ == 1 ? " time" : " times") +
                   "): the coordinator is ending, starting or crowded, or --server-key is not its key; "
                   "trying again");
}

void Session::HandleMessage(const wire::Message& message, double now_s) {
  const wire::Envelope& envelope = message.envelope;
  switch (envelope.body_case()) {
    case wire::Envelope::kWelcome:
      HandleWelcome(envelope.welcome(), now_s);
      return;
    case wire::Envelope::kRefuse:
      End(kExitRefused, Severity::kError, "refused: " + envelope.refuse().reason());
      return;
    case wire::Envelope::kUnknownWorker:
      // UnknownWorker that were on their way when we said Hello are answered by that Hello.
      if (heartbeat_s_) SayHello(now_s);
      return;
    case wire::Envelope::kDrain:
      if (!leaving_)
        log_.Say(PeerLog::kDrain, Severity::kInfo, "told to leave: finishes what it runs", now_s);
      leaving_ = true;
      return;
    case wire::Envelope::kAssign:
      if (heartbeat_s_) HandleAssign(envelope.assign(), now_s);
      return;
    case wire::Envelope::kCancel:
      queue_.Cancel(envelope.cancel().key());
      return;
    case wire::Envelope::kBlob:
      TakeBlob(envelope.blob(), message.blobs[0], now_s);
      return;
    case wire::Envelope::kMissing:
      TakeMissing(envelope.missing(), now_s);
      return;
    case wire::Envelope::kLeave:
      if (options_.exit_on_leave) return End(kExitDone, Severity::kInfo, "the coordinator has ended");
      log_.Say(PeerLog::kEnd, Severity::kInfo, "the coordinator has ended; waiting for the next", now_s);
      DropConversation();
      return;
    default:
      log_.Say(PeerLog::kStray, Severity::kWarning,
               std::string("a message for nobody here: ") + wire::KindName(envelope), now_s);
  }
}

void Session::HandleWelcome(const wire::Welcome& welcome, double now_s) {
  const double heartbeat_s = welcome.heartbeat_s();
  if (!std::isfinite(heartbeat_s) || heartbeat_s < 0) {
    log_.Say(PeerLog::kWelcome, Severity::kError,
             "the coordinator asks for a heartbeat every " + std::to_string(heartbeat_s) +
                 " s, which cannot be; it is not worked for",
             now_s);
    return DropConversation();
  }
  heartbeat_s_ = std::clamp(heartbeat_s, kShortestHeartbeat_s, kLongestHeartbeat_s);
  ever_welcome_ = true;
  heartbeat_sent_s_ = now_s - *heartbeat_s_;  // the first one at once
  log_.Say(PeerLog::kWelcome, Severity::kInfo, "at work", now_s);
}

// What is not kept no heartbeat lists, and a coordinator that made a mistake gives it to another.
void Session::HandleAssign(const wire::Assign& assign, double now_s) {
  const std::uint32_t offered = options_.hello.slots();
  const std::size_t slots = offered > 0 ? offered : wire::JobLimits().slots;
  const std::size_t unsent = Unsent(wire::Envelope::kDone) + Unsent(wire::Envelope::kFailed);
  if (!HasShortTexts(assign))
    return log_.Say(PeerLog::kTask, Severity::kError, "a task whose name is too long is not taken", now_s);
  if (queue_.Count() + unsent >= kTasksPerSlot * slots)
    return log_.Say(
        PeerLog::kTask, Severity::kError,
        "more tasks than this worker has slots (" + std::to_string(slots) + "): what is over is not taken",
        now_s);
  queue_.Add(assign);
}

void Session::TakeBlob(const wire::BlobData& data, const wire::NamedBlob& named, double now_s) {
  if (!data.has_part()) {
    blob_s_ = now_s;
    const auto request = requests_.extract(named.hash);
    if (request.empty() || request.mapped().want.keep) cache_.Put(named);
    return queue_.Deliver(named);
  }
  const Result<Hash> name = NameOf(data.of(), &data.part());
  const auto request = name.ok() ? requests_.extract(name.value()) : decltype(requests_)::node_type();
  if (request.empty()) return;  // not asked for, or not any more
  blob_s_ = now_s;
  if (!MayBe(*named.blob, data.part()))
    return queue_.GiveUp(name.value(), "the coordinator sent another part of a blob than was asked for");
  cache_.Put({name.value(), named.blob});
  queue_.Deliver({name.value(), named.blob});
}

void Session::TakeMissing(const wire::Missing& missing, double now_s) {
  const Result<Hash> name = NameOf(missing.hash(), missing.has_part() ? &missing.part() : nullptr);
  if (!name.ok()) return;
  blob_s_ = now_s;
  requests_.erase(name.value());
  queue_.GiveUp(name.value(), Printable(missing.why(), wire::JobLimits().text_bytes));
}

void Session::SayHello(double now_s) {
  DropConversation();
  hello_s_ = now_s;
  wire::Message message;
  *message.envelope.mutable_hello() = options_.hello;
  outbox_.push_back(std::move(message));
}

void Session::DropConversation() {
  heartbeat_s_.reset();
  queue_.DropAll();
  requests_.clear();
  outbox_.clear();
}

void Session::End(int code, Severity severity, const std::string& line) {
  options_.log(severity, Printable(line, wire::JobLimits().text_bytes));
  DropConversation();
  exit_code_ = code;
}

void Session::SendLeave() {
  DropConversation();
  wire::Message message;
  message.envelope.mutable_leave();
  if (connected_) transport_.Send(message);
}

void Session::Leave(double patience_s, double now_s) {
  options_.log(Severity::kInfo, "leaves: finishes what it runs");
  leaving_ = true;
  leave_by_s_ = now_s + patience_s;
  if (heartbeat_s_)
    heartbeat_sent_s_ = now_s - *heartbeat_s_;  // the next heartbeat, and with it the word, at once
}

// A conversation that is over, or was never begun, leaves nothing to finish.
void Session::EndIfLeft(double now_s) {
  const bool idle = outbox_.empty() && queue_.Empty();
  const bool late = leave_by_s_ && now_s >= *leave_by_s_;
  if (exit_code_ || (heartbeat_s_ && !idle && !late)) return;
  SendLeave();
  exit_code_ = kExitDone;
}

void Session::TakeAnswers() {
  for (wire::Message& answer : queue_.TakeAnswers()) {
    // What this worker made is likely to be an input of what it gets next.
    for (const wire::NamedBlob& named : answer.blobs) cache_.Put(named);
    outbox_.push_back(std::move(answer));
  }
}

BlobPtr Session::Known(const Hash& hash) {
  const auto given = given_.find(hash);
  return given != given_.end() ? given->second : cache_.Get(hash);
}

bool Session::Serve(const Want& want) {
  if (const BlobPtr known = Known(want.hash)) {
    queue_.Deliver({want.hash, known});
    return true;
  }
  const BlobPtr whole = want.part ? Known(want.part->blob) : nullptr;
  if (whole == nullptr) return false;
  if (const Result<BlobPtr> part = CutPart(*whole, want.part->part); part.ok())
    queue_.Deliver({want.hash, part.value()});
  else
    queue_.GiveUp(want.hash, part.status().message());
  return true;
}

void Session::Fetch(double now_s) {
  while (requests_.size() < kMaxRequests) {
    const std::optional<Want> want = queue_.TakeWant();
    if (!want) return;
    if (Serve(*want)) continue;
    const bool look = shared_ != nullptr && want->keep;  // partials are nowhere else
    if (!requests_.try_emplace(want->hash, Request{*want, now_s, look}).second) continue;
    if (look)
      shared_->LookFor(*want);
    else
      outbox_.push_back(FetchOf(*want));
  }
}

// What was found is as good as what is sent.
void Session::TakeLooks(double now_s) {
  if (shared_ == nullptr) return;
  for (const Look& look : shared_->TakeLooks()) {
    if (!look.why.empty()) log_.Say(PeerLog::kShared, Severity::kWarning, look.why, now_s);
    const auto request = requests_.find(look.want.hash);
    if (request == requests_.end() || !request->second.looked_for) continue;  // not wanted any more
    if (look.blob == nullptr) {
      request->second.looked_for = false;
      request->second.asked_s = now_s;
      outbox_.push_back(FetchOf(look.want));
      continue;
    }
    requests_.erase(request);
    cache_.Put({look.want.hash, look.blob});
    queue_.Deliver({look.want.hash, look.blob});
  }
}

// What is not sent is neither repeated nor brought up to date: nothing piles up for a peer that takes
// nothing.
std::size_t Session::Unsent(wire::Envelope::BodyCase kind) const {
  return static_cast<std::size_t>(std::ranges::count_if(
      outbox_, [kind](const wire::Message& message) { return message.envelope.body_case() == kind; }));
}

void Session::NoteArrivals(double now_s) {
  if (requests_.empty()) return came_bytes_.reset();
  const std::uint64_t came = transport_.BytesCame();
  if (!came_bytes_ || came < *came_bytes_) came_bytes_ = came;  // the latter over another connection
  if (came - *came_bytes_ < kSomeBytes) return;
  came_bytes_ = came;
  blob_s_ = now_s;
  queue_.NoteArrival();
}

void Session::RepeatFetches(double now_s) {
  if (Unsent(wire::Envelope::kFetch) > 0) return;
  for (auto& [hash, request] : requests_) {
    if (request.looked_for || now_s - std::max(request.asked_s, blob_s_) < kAskAgain_s) continue;
    request.asked_s = now_s;
    outbox_.push_back(FetchOf(request.want));
  }
}

void Session::SendHeartbeat(double now_s) {
  if (now_s - heartbeat_sent_s_ < *heartbeat_s_ / 2 || Unsent(wire::Envelope::kHeartbeat) > 0) return;
  heartbeat_sent_s_ = now_s;
  wire::Message message;
  *message.envelope.mutable_heartbeat() = queue_.Assigned();
  if (options_.add_vitals) options_.add_vitals(message.envelope.mutable_heartbeat());
  outbox_.push_back(std::move(message));
  if (!leave_by_s_) return;
  wire::Message drain;  // with each heartbeat: a word may get lost
  drain.envelope.mutable_drain();
  outbox_.push_back(std::move(drain));
}

void Session::Flush() {
  while (!outbox_.empty() && transport_.Send(outbox_.front())) outbox_.pop_front();
}

void Session::Work(double now_s) {
  if (exit_code_) return;
  if (heartbeat_s_) {
    TakeAnswers();
    TakeLooks(now_s);
    Fetch(now_s);
    NoteArrivals(now_s);
    RepeatFetches(now_s);
    SendHeartbeat(now_s);
  } else if (connected_ && now_s - hello_s_ >= kHelloAgain_s) {
    SayHello(now_s);
  }
  if (connected_) Flush();
  if (leaving_) EndIfLeft(now_s);
  if (!ever_welcome_ && options_.first_contact_s > 0 && now_s - started_s_ >= options_.first_contact_s) {
    End(kExitLost, Severity::kError, "no coordinator answers");
  }
}

double Session::WaitSeconds(double now_s) const {
  if (!outbox_.empty()) return kRetry_s;
  if (!heartbeat_s_) return kLongestWait_s;
  const double end_s = leave_by_s_.value_or(now_s + kLongestWait_s);
  return std::clamp(std::min(heartbeat_sent_s_ + *heartbeat_s_ / 2, end_s) - now_s, 0.0, kLongestWait_s);
}

}  // namespace cairn::worker
