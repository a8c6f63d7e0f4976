// A fixture for tests of the server: a folder of its own, and a transport behind which workers and clients
// are played.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/server/server.h"
#include "coordinator/store/recovery.h"
#include "coordinator/store/testing/open_and_serve.h"
#include "schema/flat_blob_testing.h"

namespace cairn::coordinator {

class TempFolder {
 public:
  TempFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "cairn-test-XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~TempFolder() { std::filesystem::remove_all(path_); }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline wire::NamedBlob TextBlob(const std::string& text) {
  Blob blob;
  blob.Put("text", Array::Text(text));
  return wire::NameBlob(std::make_shared<const Blob>(std::move(blob)));
}

// Answers for workers at once: rounds of `tasks` tasks whose blobs say what they were made of.
class FakeTransport : public Transport {
 public:
  int rounds = 3, tasks = 2;
  std::vector<std::pair<std::string, wire::Message>> sent;  // but for what workers were sent
  int assigned = 0;
  std::map<std::string, std::string> users;  // of the workers that are played, by peer
  std::function<bool(const wire::Assign&)> swallow = [](const wire::Assign&) { return false; };

  std::map<std::string, wire::NamedBlob> results;  // of the workers that are played, in place of their own
  void Come(const std::string& peer, wire::Message message, const std::string& user = "") {
    queue_.push_back({peer, Status::Ok(), std::move(message), user});
  }
  void ComeAnswer(const std::string& peer, const wire::Assign& assign) {
    Come(peer, AnswerOf(peer, assign), users[peer]);
  }
  void ComeDamaged(const std::string& peer, Code code = Code::kCorrupt) {
    queue_.push_back({peer, Status(code, "no message"), {}});
  }
  void ComeWorker(const std::string& peer, const std::string& user = "", std::int64_t pid = 0,
                  std::uint64_t process = 0) {
    wire::Message hello;
    hello.envelope.mutable_hello()->set_protocol(3);
    hello.envelope.mutable_hello()->set_slots(2);
    hello.envelope.mutable_hello()->set_host("here");
    hello.envelope.mutable_hello()->set_pid(pid);
    hello.envelope.mutable_hello()->set_process(process);
    Come(peer, std::move(hello), user);
  }

  std::size_t at_once = 1000;
  std::vector<Incoming> Poll(double timeout_s) override {
    if (queue_.empty() && timeout_s > 0) ::usleep(200);
    const auto end = queue_.begin() + static_cast<std::ptrdiff_t>(std::min(at_once, queue_.size()));
    std::vector<Incoming> taken(std::make_move_iterator(queue_.begin()), std::make_move_iterator(end));
    queue_.erase(queue_.begin(), end);
    return taken;
  }
  bool TookAll() const override { return queue_.empty(); }
  std::set<std::string> gone;     // peers that nothing can be sent to
  std::set<std::string> dropped;  // by the server
  std::vector<wire::Refusal> door;
  bool Send(const std::string& peer, wire::Message message) override {
    if (gone.contains(peer)) return false;
    if (message.envelope.has_assign()) {
      ++assigned;
      if (!swallow(message.envelope.assign())) ComeAnswer(peer, message.envelope.assign());
      return true;
    }
    if (deaf.contains(peer))
      for (const wire::NamedBlob& named : message.blobs) unsent[peer] += named.blob->ByteCount();
    sent.emplace_back(peer, std::move(message));
    return true;
  }
  std::map<std::string, std::size_t> unsent;  // by peer
  std::set<std::string> deaf;                 // peers that read no blobs
  std::size_t Unsent(const std::string& peer) const override {
    const auto found = unsent.find(peer);
    return found == unsent.end() ? 0 : found->second;
  }
  void Drop(const std::string& peer) override { dropped.insert(peer); }
  std::vector<wire::Refusal> TakeRefusals() override { return std::exchange(door, {}); }
  wire::Traffic TotalTraffic() const override { return {}; }
  std::mutex wake;  // whoever holds it stops the writing thread when that has something to tell
  void Wake() override { const std::lock_guard lock(wake); }

 private:
  wire::Message AnswerOf(const std::string& peer, const wire::Assign& assign) const {
    wire::Message message = Answer(assign);
    const auto result = results.find(peer);
    if (message.envelope.done().step().result().empty() || result == results.end()) return message;
    message.blobs = {result->second};
    message.envelope.mutable_done()->mutable_step()->set_result(result->second.hash.Binary());
    return message;
  }
  wire::Message Answer(const wire::Assign& assign) const {
    wire::Message message;
    wire::Done& done = *message.envelope.mutable_done();
    *done.mutable_key() = assign.key();
    done.set_seconds(0.5);
    if (assign.key().kind() == wire::TaskKey::RUN) {
      std::string text = "task " + std::to_string(assign.key().task());
      for (const proto::InputRef& input : assign.task().inputs())
        text += Hash::FromBinary(input.blob()).value().Hex();
      message.blobs = {TextBlob(text)};
      done.set_partial(message.blobs[0].hash.Binary());
      return message;
    }
    std::string text = assign.stage().name();
    for (const std::string& partial : assign.partials()) text += Hash::FromBinary(partial).value().Hex();
    message.blobs = {TextBlob(text)};
    const std::string shared = message.blobs[0].hash.Binary();
    const bool planned = assign.key().kind() == wire::TaskKey::ADVANCE;
    if (planned && assign.key().round() + 1 == static_cast<std::uint64_t>(rounds)) {
      done.mutable_step()->set_result(shared);
      return message;
    }
    for (int i = 0; i < tasks; ++i) {
      proto::Task& task = *done.mutable_step()->add_tasks();
      task.set_index(static_cast<std::uint32_t>(i));
      proto::InputRef& input = *task.add_inputs();
      input.set_name("shared");
      input.set_blob(shared);
    }
    (*done.mutable_step()->mutable_state()->mutable_blobs())["shared"] = shared;
    message.blobs.push_back(TextBlob("a map of round " + std::to_string(assign.key().round())));
    done.mutable_step()->mutable_state()->set_so_far(message.blobs[1].hash.Binary());
    return message;
  }

  std::vector<Incoming> queue_;
};

class ServerFixture {
 public:
  ServerFixture() { Start(); }

  TempFolder temp;
  FakeTransport transport;
  std::vector<std::string> log;
  std::optional<StoreFolder> folder;
  std::unique_ptr<Server> server;
  std::uint64_t memory_bytes = 1 << 20;
  double checkpoint_interval_s = 0;
  std::filesystem::path allow_list;
  wire::KeyLimits key_limits;
  bool drains = false;
  bool serves = false;  // opens the store as a service does
  std::function<void(const wire::JobInfo&)> job_ended;
  std::uint64_t store_limit_bytes = 0;
  double stalled_s = ServerOptions().stalled_s;
  std::uint64_t fetched_bytes = ServerOptions().fetched_bytes;
  double keep_s = 0;
  std::filesystem::path store_dir;  // empty: within temp

  void Start() {
    server.reset();
    folder.reset();
    const std::filesystem::path dir = store_dir.empty() ? temp.path() / "store" : store_dir;
    folder.emplace(serves ? OpenAndServe(dir, false).value() : StoreFolder::Open(dir).value());
    ServerOptions options;
    options.memory_bytes = memory_bytes;
    options.core.checkpoint_interval_s = checkpoint_interval_s;
    options.allow_list = allow_list;
    options.key_limits = key_limits;
    options.drains = drains;
    options.job_ended = job_ended;
    options.store_limit_bytes = store_limit_bytes;
    options.stalled_s = stalled_s;
    options.fetched_bytes = fetched_bytes;
    options.core.keep_s = keep_s;
    options.result_path = [this](const std::string& job, const std::string& stage) {
      return temp.path() / "results" / job / (stage + ".h5");
    };
    options.results_folder = [this](const std::string& job) { return temp.path() / "results" / job; };
    options.result_files = [this](const std::string& job) {
      std::vector<std::filesystem::path> files;
      std::error_code none;
      for (const auto& entry : std::filesystem::directory_iterator(temp.path() / "results" / job, none))
        files.push_back(entry.path());
      return files;
    };
    folder->FinishForgetting(options.results_folder);
    const LogSink sink = [this](Severity, const std::string& line) { log.push_back(line); };
    server = std::make_unique<Server>(*folder, transport, OpenJobTable(*folder, sink).value(),
                                      std::move(options), sink);
  }
  proto::Job MakeJob(int stages = 1) {
    proto::Job job;
    job.set_name("toy");
    (*job.mutable_inputs())["log"] = "log.h5";
    (*job.mutable_input_blobs())["log"] = TextBlob("the log").hash.Binary();
    for (int i = 0; i < stages; ++i) {
      proto::Stage& stage = *job.add_stages();
      stage.set_name("stage" + std::to_string(i));
      stage.set_pipeline("toy");
      (*stage.mutable_inputs())["log"] = "log";
    }
    return job;
  }
  void Submit(const std::string& id = "a", int stages = 1) {
    server->Submit(id, MakeJob(stages), {TextBlob("the log")});
  }
  std::string State(const std::string& id = "a") {
    return server->core().Find(id).value_or(wire::JobInfo()).state();
  }
  // Steps until `done`, which must come to pass.
  void Until(const std::function<bool()>& done) {
    for (int i = 0; i < 300000; ++i) {
      if (done()) return;
      server->Step(0.001);
    }
    FAIL() << "it does not come to pass";
  }
  std::optional<wire::Reply> TakeReply(const std::string& peer) {
    for (auto it = transport.sent.begin(); it != transport.sent.end(); ++it) {
      if (it->first != peer || !it->second.envelope.has_reply()) continue;
      last_blobs = it->second.blobs;
      wire::Reply reply = it->second.envelope.reply();
      transport.sent.erase(it);
      return reply;
    }
    return std::nullopt;
  }
  wire::Reply Ask(wire::Message question) {
    std::optional<wire::Reply> reply;
    transport.Come("client", std::move(question));
    Until([&] { return (reply = TakeReply("client")).has_value(); });
    return reply.value_or(wire::Reply());
  }
  // All that `peer` was given since it was last asked.
  std::uint64_t TakeCredit(const std::string& peer) {
    std::uint64_t bytes = 0;
    std::erase_if(transport.sent, [&](const auto& sent) {
      if (sent.first != peer || !sent.second.envelope.has_credit()) return false;
      bytes += sent.second.envelope.credit().bytes();
      return true;
    });
    return bytes;
  }
  static wire::Message Offer(const Hash& hash, std::uint64_t bytes) {
    wire::Message offer;
    offer.envelope.mutable_offer()->set_hash(hash.Binary());
    offer.envelope.mutable_offer()->set_bytes(bytes);
    return offer;
  }
  static wire::Message Piece(const Hash& hash, std::uint64_t at, const std::string& data) {
    wire::Message piece;
    piece.envelope.mutable_piece()->set_hash(hash.Binary());
    piece.envelope.mutable_piece()->set_at(at);
    piece.envelope.mutable_piece()->set_data(data);
    return piece;
  }
  // As a client brings it, and what that is answered.
  wire::Reply Upload(const wire::NamedBlob& named, const std::string& peer = "client",
                     const std::string& user = "") {
    const std::string flat = flat_testing::Flat(*named.blob);
    transport.Come(peer, Offer(named.hash, flat.size()), user);
    std::size_t sent = 0;
    std::optional<wire::Reply> reply;
    Until([&] {
      const std::string piece = flat.substr(sent, TakeCredit(peer));
      if (!piece.empty()) transport.Come(peer, Piece(named.hash, sent, piece), user);
      sent += piece.size();
      return (reply = TakeReply(peer)).has_value();
    });
    return reply.value_or(wire::Reply());
  }
  // Of a client that has brought the log, or has not.
  wire::Message Submission(const proto::Job& job, bool with_log = true) {
    const bool brought = !with_log || Upload(TextBlob("the log")).ok();
    EXPECT_TRUE(brought);
    wire::Message message;
    message.envelope.mutable_submit()->set_protocol(wire::kProtocol);
    *message.envelope.mutable_submit()->mutable_job() = job;
    return message;
  }
  bool Logged(const std::string& part) const {
    for (const std::string& line : log)
      if (line.find(part) != std::string::npos) return true;
    return false;
  }
  std::vector<wire::NamedBlob> last_blobs;  // of the last reply
};

}  // namespace cairn::coordinator
