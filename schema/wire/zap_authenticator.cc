#include "schema/wire/zap_authenticator.h"

#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <string_view>
#include <utility>

#include "schema/wire/connection.h"
#include "schema/wire/keys.h"
#include "schema/wire/system_calls.h"

namespace cairn::wire {
namespace {

constexpr const char* kZapEndpoint = "inproc://zeromq.zap.01";  // fixed by ZAP, rfc.zeromq.org/spec/27
// Not ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL: ZeroMQ 4.3.4, having told of it, takes the errno that is left over
// for a queue that is full, and never closes the connection.
constexpr int kAcceptEvents = ZMQ_EVENT_ACCEPTED | ZMQ_EVENT_ACCEPT_FAILED | ZMQ_EVENT_DISCONNECTED |
                              ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL;
constexpr std::chrono::milliseconds kLookEvery{250};
constexpr std::size_t kMostBuckets = 10'000;
// At least what CURVE and ZMTP add to a frame: what is taken must not seem less than what came.
constexpr std::size_t kFrameOverhead = 64;

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string Z85(const zmq::message_t& key) {
  std::array<char, 41> text{};
  if (key.size() != 32) return "";
  zmq_z85_encode(text.data(), key.data<std::uint8_t>(), key.size());
  return text.data();
}

// One property, as ZMTP writes its metadata (rfc.zeromq.org/spec/23).
std::string Metadata(std::string_view name, std::string_view value) {
  std::string bytes(1, static_cast<char>(name.size()));
  bytes += name;
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(value.size() >> shift & 0xff);
  return bytes.append(value);
}

}  // namespace

const char* KindName(RefusalKind kind) {
  constexpr std::array kNames = {"connections", "rate",  "handshake", "key",   "malformed", "oversized",
                                 "version",     "build", "revoked",   "right", "identity",  "task",
                                 "blob",        "job",   "store",     "quota"};
  return kNames.at(static_cast<std::size_t>(kind));
}

ZapAuthenticator::ZapAuthenticator(zmq::context_t& context, zmq::socket_t& router,
                                   std::optional<std::filesystem::path> allow_list,
                                   const ConnectionLimits& limits)
    : limits_(limits), monitor_(context, router, kAcceptEvents) {
  if (!allow_list) return;
  allow_list_.emplace(*allow_list);
  zap_ = zmq::socket_t(context, zmq::socket_type::rep);
  zap_.set(zmq::sockopt::linger, 0);
  zap_.bind(kZapEndpoint);
}

void ZapAuthenticator::Start(std::string endpoint) {
  endpoint_ = std::move(endpoint);
  thread_ = std::thread([this] { Loop(); });
}

ZapAuthenticator::~ZapAuthenticator() {
  stop_ = true;
  wakeup_.Signal();
  if (thread_.joinable()) thread_.join();
}

void ZapAuthenticator::Loop() {
  auto looked = std::chrono::steady_clock::now();
  while (!stop_) {
    std::vector<zmq::pollitem_t> items = {{monitor_.handle(), 0, ZMQ_POLLIN, 0},
                                          {nullptr, wakeup_.descriptor(), ZMQ_POLLIN, 0}};
    if (allow_list_) items.push_back({zap_.handle(), 0, ZMQ_POLLIN, 0});
    zmq_poll(items.data(), static_cast<int>(items.size()), kLookEvery.count());
    TakeEvents();
    if (allow_list_) AnswerZap();
    if (const auto now = std::chrono::steady_clock::now(); now - looked >= kLookEvery) {
      looked = now;
      CloseThoseThatPileUp();
      if (allow_list_) CloseTheSilent();
    }
  }
}

void ZapAuthenticator::TakeEvents() {
  while (const std::optional<Monitor::Event> event = monitor_.Next()) OnEvent(*event);
}

// A request is: version, request id, domain, address, routing id, mechanism, credentials (CURVE: the client's
// key).
void ZapAuthenticator::AnswerZap() {
  while (true) {
    const std::vector<zmq::message_t> request = ReceiveFrames(zap_, {});
    if (request.empty()) return;
    TakeEvents();  // so that its connection, whichever it is, has been accepted before this handshake
    const std::string id = request.size() > 1 ? request[1].to_string() : "";
    const bool curve = request.size() == 7 && request[5].to_string_view() == "CURVE";
    const std::string key = curve ? Z85(request[6]) : "";
    allow_list_->Refresh();
    const Allowed* allowed = key.empty() ? nullptr : allow_list_->Find(key);
    const std::string too_many = allowed != nullptr ? NoteHandshake(key, *allowed) : "";
    if (!too_many.empty()) {
      Count(RefusalKind::kConnections, too_many);
    } else if (allowed == nullptr) {
      const std::string why = allow_list_->IsOver(key)     ? "its time is over"
                              : allow_list_->status().ok() ? "is not on the list"
                                                           : allow_list_->status().message();
      Count(RefusalKind::kKey, ShortKey(key) + " from " +
                                   request.at(std::min<std::size_t>(3, request.size() - 1)).to_string() +
                                   ": " + why);
    }
    // 300: not now. Its side takes that for a handshake that was broken off, and tries again later.
    const std::string code = !too_many.empty() ? "300" : allowed != nullptr ? "200" : "400";
    const std::array<std::string, 6> reply = {
        "1.0",
        id,
        code,
        code == "400" ? "key not allowed" : "",
        code == "200" ? key : "",
        code == "200" ? Metadata(kHandshakeProperty, std::to_string(++last_number_)) : ""};
    for (std::size_t i = 0; i < reply.size(); ++i) {
      zap_.send(zmq::buffer(reply[i]),
                i + 1 < reply.size() ? zmq::send_flags::sndmore : zmq::send_flags::none);
    }
  }
}

void ZapAuthenticator::OnEvent(const Monitor::Event& event) {
  switch (event.kind) {
    case ZMQ_EVENT_ACCEPTED:
      return OnAccepted(static_cast<int>(event.value));
    case ZMQ_EVENT_ACCEPT_FAILED:
      return Count(RefusalKind::kConnections,
                   std::string("the system gives no more: ") + std::strerror(static_cast<int>(event.value)));
    case ZMQ_EVENT_DISCONNECTED:
      return OnDisconnected(static_cast<int>(event.value));
    default:
      told_ = true;  // what comes next is that it is disconnected
      return Count(RefusalKind::kHandshake,
                   (event.value == EMSGSIZE ? "more came than a handshake has ("
                                            : "it ended before it had shaken hands, or took too long (") +
                       event.where + ")");
  }
}

std::size_t ZapAuthenticator::MostConnections() const {
  rlimit files{};
  ::getrlimit(RLIMIT_NOFILE, &files);
  const std::size_t spare = std::min<std::size_t>(limits_.spare_files, files.rlim_cur / 2);
  return std::min<std::size_t>(limits_.connections, files.rlim_cur - spare);
}

bool ZapAuthenticator::WithinRate(const std::string& address) {
  if (address.empty()) return true;
  const double now_s = Now();
  if (buckets_.size() >= kMostBuckets)
    std::erase_if(buckets_, [&](const auto& b) { return b.second.Full(now_s); });
  if (buckets_.size() >= kMostBuckets) return false;
  return buckets_.try_emplace(address, limits_.handshakes_per_s, limits_.handshake_burst)
      .first->second.Take(now_s);
}

// What is wrong with one more newcomer, who is counted already; empty: nothing.
std::string ZapAuthenticator::WhyTooMany(const std::string& address) {
  const std::size_t most = MostConnections();
  if (open_count_ > most) return address + ": more than " + std::to_string(most) + " connections";
  if (!allow_list_) return "";
  const Places places(most);
  const std::lock_guard lock(mutex_);
  if (kinds_[Kind::kNewcomer] > places.newcomers)
    return address + ": more than " + std::to_string(places.newcomers) + " that have said nothing yet";
  if (newcomers_[address] > places.of_an_address)
    return address + ": more than " + std::to_string(places.of_an_address) +
           " from one address that have said nothing yet";
  return "";
}

void ZapAuthenticator::OnDisconnected(int fd) {
  std::string address;
  {
    const std::lock_guard lock(mutex_);
    if (const auto it = open_.find(fd); it != open_.end()) address = it->second.address;
    Leave(fd);
  }
  const bool by_us = !TakeEndOf(fd);
  if (by_us && !told_)
    Count(RefusalKind::kHandshake,
          "no handshake of ours, no key, or bytes that its key did not make: forged, damaged, sent again (" +
              address + ")");
  told_ = false;
}

void ZapAuthenticator::OnAccepted(int fd) {
  const std::string address = PeerAddress(fd);
  {
    const std::lock_guard lock(mutex_);
    Enter(fd, address);
  }
  if (const std::string too_many = WhyTooMany(address); !too_many.empty()) {
    Count(RefusalKind::kConnections, too_many);
  } else if (!WithinRate(address)) {
    Count(RefusalKind::kRate, address + ": too many connections in a short time");
  } else {
    return;
  }
  ShutDownConnection(fd, endpoint_);
}

void ZapAuthenticator::Enter(int fd, const std::string& address) {
  Leave(fd);
  open_[fd] = {.number = ++last_number_,
               .address = address,
               .since_s = Now(),
               .taken_bytes = 0,
               .kind = Kind::kNewcomer,
               .user = {}};
  open_count_ = open_.size();
  ++kinds_[Kind::kNewcomer];
  ++newcomers_[address];
}

void ZapAuthenticator::Leave(int fd) {
  const auto it = open_.find(fd);
  if (it == open_.end()) return;
  const Connection& connection = it->second;
  --kinds_[connection.kind];
  if (connection.kind != Kind::kNewcomer)
    --guests_.at(connection.user).connections;
  else if (--newcomers_[connection.address] == 0)
    newcomers_.erase(connection.address);
  open_.erase(it);
  open_count_ = open_.size();
}

// Empty where there is room for one more of this key.
std::string ZapAuthenticator::WhyNoPlace(const std::string& key, const Guest& guest) const {
  const Places places(MostConnections());
  const bool worker = guest.kind == Kind::kWorker;
  const std::size_t of_such = worker ? places.of_a_workers_key : places.of_another_key;
  const std::size_t of_key = guest.most == 0 ? of_such : std::min(of_such, guest.most);
  const std::size_t of_kind = worker                           ? places.workers
                              : guest.kind == Kind::kSubmitter ? places.submitters
                                                               : places.viewers;
  const std::string who = "the key " + ShortKey(key) + (guest.name.empty() ? "" : " (" + guest.name + ")");
  if (guest.connections >= of_key)
    return who + " has " + std::to_string(guest.connections) + " connections, the most that such a key may";
  const auto kind = kinds_.find(guest.kind);
  if (kind == kinds_.end() || kind->second < of_kind) return "";
  return who + ": there are " + std::to_string(kind->second) + " connections of " +
         (worker                           ? "workers"
          : guest.kind == Kind::kSubmitter ? "submitters"
                                           : "viewers") +
         ", the most that there may be";
}

// Why this key may not shake hands just now; empty: it may.
std::string ZapAuthenticator::NoteHandshake(const std::string& key, const Allowed& allowed) {
  const Kind kind = allowed.roles.worker      ? Kind::kWorker
                    : allowed.roles.submitter ? Kind::kSubmitter
                                              : Kind::kViewer;
  const std::lock_guard lock(mutex_);
  const bool worker = kind == Kind::kWorker;
  const Bucket handshakes(worker ? limits_.handshakes_per_s : limits_.handshakes_per_s / 2,
                          worker ? limits_.handshake_burst : limits_.handshake_burst / 4);
  const auto [it, fresh] = guests_.try_emplace(key, Guest{kind, allowed.name, handshakes, 0, 0});
  Guest& guest = it->second;
  guest.name = allowed.name;
  guest.most = allowed.limits.connections;
  if (guest.connections == 0) guest.kind = kind;  // else once those that are counted as what it was have gone
  if (const std::string why = WhyNoPlace(key, guest); !why.empty()) return why;
  if (guest.handshakes.Take(Now())) return "";
  return "the key " + ShortKey(key) + " connects too often";
}

bool ZapAuthenticator::TellTaken(int fd, std::uint64_t handshake, const std::string& user, std::size_t bytes,
                                 std::size_t frames) {
  std::string why;
  {
    const std::lock_guard lock(mutex_);
    const auto it = open_.find(fd);
    // A connection that was accepted after the handshake has the descriptor of one that is gone.
    if (it == open_.end() || (allow_list_ && it->second.number > handshake)) return true;
    Connection& connection = it->second;
    connection.taken_bytes += bytes + frames * kFrameOverhead;
    const auto guest = guests_.find(user);
    if (connection.kind != Kind::kNewcomer || guest == guests_.end()) return true;
    why = WhyNoPlace(user, guest->second);
    if (why.empty()) {
      --kinds_[Kind::kNewcomer];
      if (--newcomers_[connection.address] == 0) newcomers_.erase(connection.address);
      connection.kind = guest->second.kind;
      connection.user = user;
      ++kinds_[connection.kind];
      ++guest->second.connections;
      return true;
    }
  }
  Count(RefusalKind::kConnections, why);
  return false;
}

// Whoever has shaken hands and keeps silent takes a place of those who are to come.
void ZapAuthenticator::CloseTheSilent() {
  std::vector<std::pair<int, std::string>> silent;
  {
    const std::lock_guard lock(mutex_);
    const double now_s = Now();
    for (const auto& [fd, connection] : open_)
      if (connection.kind == Kind::kNewcomer && now_s - connection.since_s > limits_.first_word_ms / 1e3)
        silent.emplace_back(fd, connection.address);
  }
  for (const auto& [fd, address] : silent) {
    Count(RefusalKind::kConnections, address + ": it has connected and said nothing");
    ShutDownConnection(fd, endpoint_);
  }
}

// ZeroMQ takes a few times the memory, of frames that are empty or small.
std::size_t ZapAuthenticator::MostUnread(Kind kind) const {
  if (!allow_list_ || kind == Kind::kWorker) return limits_.unread_bytes;
  return std::min(kind == Kind::kNewcomer ? limits_.first_word_bytes : limits_.client_bytes,
                  limits_.unread_bytes);
}

// ZeroMQ hands out whole messages only, and counts those: one that never ends would grow without a limit.
void ZapAuthenticator::CloseThoseThatPileUp() {
  std::vector<std::pair<int, std::string>> piled;
  {
    const std::lock_guard lock(mutex_);
    for (auto& [fd, connection] : open_) {
      if (connection.address.empty()) continue;
      const std::uint64_t came = BytesReceived(fd);
      connection.taken_bytes = std::min(connection.taken_bytes, came);
      if (came - connection.taken_bytes > MostUnread(connection.kind))
        piled.emplace_back(fd, connection.address);
    }
  }
  for (const auto& [fd, address] : piled) {
    Count(RefusalKind::kOversized, address + ": a message that does not end, or more than is read");
    ShutDownConnection(fd, endpoint_);
  }
}

void ZapAuthenticator::Count(RefusalKind kind, std::string reason) {
  const std::lock_guard lock(mutex_);
  const auto [it, fresh] = refusals_.try_emplace(kind, Refusal{kind, "", 0});
  ++it->second.count;
  it->second.reason = std::move(reason);
}

std::vector<Refusal> ZapAuthenticator::TakeRefusals() {
  const std::lock_guard lock(mutex_);
  std::vector<Refusal> taken;
  for (auto& [kind, refusal] : refusals_) taken.push_back(std::move(refusal));
  refusals_.clear();
  return taken;
}

}  // namespace cairn::wire
