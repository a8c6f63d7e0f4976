// Sessions of up to four peers with a server over real files.
#include <array>
#include <chrono>
#include <functional>
#include <optional>
#include <set>
#include <thread>

#include "coordinator/server/server.h"
#include "coordinator/store/recovery.h"
#include "schema/flat_blob_testing.h"
#include "tests/fuzz/byte_source.h"
#include "tests/fuzz/frames.h"
#include "tests/fuzz/scramble.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {
namespace {

using coordinator::Incoming;

wire::NamedBlob TextBlob(const std::string& text) {
  Blob blob;
  blob.Put("text", Array::Text(text));
  return wire::NameBlob(std::make_shared<const Blob>(std::move(blob)));
}

class Peers : public coordinator::Transport {
 public:
  std::vector<Incoming> Poll(double) override { return std::exchange(queue_, {}); }
  bool TookAll() const override { return true; }
  bool Send(const std::string& peer, wire::Message message) override {
    if (gone_.contains(peer)) return false;
    if (message.envelope.has_assign() && assigned_.size() < 64)
      assigned_.emplace_back(peer, message.envelope.assign());
    if (message.envelope.has_reply()) ++replies_;
    return true;
  }
  std::size_t Unsent(const std::string&) const override { return 0; }
  void Drop(const std::string& peer) override { gone_.insert(peer); }
  std::vector<wire::Refusal> TakeRefusals() override { return {}; }
  wire::Traffic TotalTraffic() const override { return {}; }
  void Wake() override {}

  void Come(const std::string& peer, Status status, wire::Message message) {
    queue_.push_back({peer, std::move(status), std::move(message)});
  }
  void Toggle(const std::string& peer) {
    if (gone_.erase(peer) == 0) gone_.insert(peer);
  }
  const auto& assigned() const { return assigned_; }
  int replies() const { return replies_; }

 private:
  std::vector<Incoming> queue_;
  std::set<std::string> gone_;
  std::vector<std::pair<std::string, wire::Assign>> assigned_;
  int replies_ = 0;
};

proto::Job SomeJob(std::size_t which) {
  proto::Job job;
  job.set_name("job" + std::to_string(which));
  (*job.mutable_inputs())["log"] = "log.h5";
  (*job.mutable_input_blobs())["log"] = TextBlob("the log").hash.Binary();
  for (std::size_t i = 0; i <= which % 2; ++i) {
    proto::Stage& stage = *job.add_stages();
    stage.set_name("stage" + std::to_string(i));
    stage.set_pipeline("toy");
    (*stage.mutable_inputs())["log"] = "log";
  }
  return job;
}

// What an honest worker would say: two rounds of two tasks a stage.
wire::Message AnswerTo(const wire::Assign& assign) {
  wire::Message message;
  wire::Done& done = *message.envelope.mutable_done();
  *done.mutable_key() = assign.key();
  message.blobs = {TextBlob(assign.key().job() + std::to_string(assign.key().kind()) +
                            std::to_string(assign.key().round()) + std::to_string(assign.key().task()))};
  const std::string hash = message.blobs[0].hash.Binary();
  if (assign.key().kind() == wire::TaskKey::RUN) {
    done.set_partial(hash);
  } else if (assign.key().kind() == wire::TaskKey::ADVANCE && assign.key().round() == 1) {
    done.mutable_step()->set_result(hash);
  } else {
    (*done.mutable_step()->mutable_state()->mutable_blobs())["shared"] = hash;
    for (std::uint32_t i = 0; i < 2; ++i) {
      proto::Task& task = *done.mutable_step()->add_tasks();
      task.set_index(i);
      proto::InputRef& input = *task.add_inputs();
      input.set_name("x");
      input.set_blob(hash);
    }
  }
  return message;
}

class Session {
 public:
  explicit Session(std::span<const std::uint8_t> bytes) : source_(bytes) {
    folder_.emplace(coordinator::StoreFolder::Open(scratch_.path() / "store").value());
    coordinator::ServerOptions options;
    options.core.checkpoint_interval_s = 0;
    options.memory_bytes = 4096;
    options.result_path = [this](const std::string& job, const std::string& stage) {
      return scratch_.path() / "results" / job / (stage + ".h5");
    };
    server_ = std::make_unique<coordinator::Server>(*folder_, peers_, OpenJobTable(*folder_, Sink()).value(),
                                                    std::move(options), Sink());
  }

  Outcome Run() {
    const bool look_back = source_.Below(8) == 0;
    for (int ops = 0; ops < 64 && !source_.empty(); ++ops) {
      Op();
      server_->Step(0);
    }
    CAIRN_DEMAND(server_->core().fleet().size() <= 4, "more workers than peers");
    if (look_back) {
      CAIRN_DEMAND(server_->Shut(60), "it cannot save what it has");
      server_.reset();
      log_.clear();
      coordinator::BlobFiles files(*folder_);
      Recover(*folder_, files, coordinator::InputsOf::kStore, {},
              [this](coordinator::Severity severity, const std::string&, const std::string& line) {
                Sink()(severity, line);
              });
      CAIRN_DEMAND(log_.find("quarantined") == std::string::npos, log_);
    }
    return peers_.replies() > 0 || !peers_.assigned().empty() ? Outcome::kAccepted : Outcome::kRefused;
  }

 private:
  coordinator::LogSink Sink() {
    return [this](coordinator::Severity, const std::string& line) { log_ += line + "\n"; };
  }
  std::string Peer() { return std::string(1, static_cast<char>('a' + source_.Below(4))); }
  std::string JobName() {
    const std::vector<wire::JobInfo> jobs = server_->core().Jobs();
    const std::size_t which = source_.Below(jobs.size() + 1);
    return which < jobs.size() ? jobs[which].id() : source_.Text();
  }
  void Say(const std::string& peer, wire::Message message) {
    peers_.Come(peer, Status::Ok(), std::move(message));
  }
  // As it would come over the wire: what cannot be decoded is refused by the transport.
  void SayFrames(const std::string& peer, std::span<const std::span<const std::byte>> frames) {
    Result<wire::Message> message = wire::Decode(frames);
    if (message.ok())
      Say(peer, std::move(message).value());
    else
      peers_.Come(peer, message.status(), {});
  }
  void SayScrambled(const std::string& peer, wire::Message message) {
    wire::Frames frames = wire::Encode(std::move(message));
    wire::Envelope envelope;
    envelope.ParseFromString(frames.envelope);
    for (std::size_t edits = 1 + source_.Below(3); edits > 0; --edits) Scramble(&envelope, &source_);
    frames.envelope = envelope.SerializeAsString();
    std::vector<std::span<const std::byte>> views{std::as_bytes(std::span(frames.envelope))};
    for (const Array& array : frames.arrays) views.push_back(array.bytes());
    SayFrames(peer, views);
  }

  static std::string Log() { return flat_testing::Flat(*TextBlob("the log").blob); }
  // As an honest client does; whether it may depends on what it said before.
  void Bring(const std::string& peer) {
    const std::string hash = TextBlob("the log").hash.Binary();
    wire::Message offer, piece;
    offer.envelope.mutable_offer()->set_hash(hash);
    offer.envelope.mutable_offer()->set_bytes(Log().size());
    piece.envelope.mutable_piece()->set_hash(hash);
    piece.envelope.mutable_piece()->set_data(Log());
    Say(peer, std::move(offer));
    Say(peer, std::move(piece));
    for (int i = 0; i < 1000 && (i == 0 || server_->uploads().size() > 0); ++i) {
      server_->Step(0);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  void Op() {
    wire::Message message;
    wire::Envelope& envelope = message.envelope;
    const std::size_t op = source_.Below(26);
    const bool scrambled = op >= 13;
    std::string peer = Peer();
    switch (op % 13) {
      case 0:
        envelope.mutable_hello()->set_protocol(3);
        envelope.mutable_hello()->set_slots(2);
        break;
      case 1:
      case 2: {
        if (peers_.assigned().empty()) return;
        const auto& [who, assign] = peers_.assigned()[source_.Byte() % peers_.assigned().size()];
        if (source_.Below(8) != 0) peer = who;
        message = AnswerTo(assign);
        break;
      }
      case 3:
        if (peers_.assigned().empty()) return;
        *envelope.mutable_failed()->mutable_key() =
            peers_.assigned()[source_.Byte() % peers_.assigned().size()].second.key();
        envelope.mutable_failed()->set_input_error(source_.Below(2) == 1);
        break;
      case 4:
        envelope.mutable_heartbeat();
        for (const auto& [who, assign] : peers_.assigned()) {
          if (source_.Below(2) == 0) continue;
          *envelope.mutable_heartbeat()->add_tasks() = assign.key();
          envelope.mutable_heartbeat()->add_ticks(source_.Byte());
        }
        break;
      case 5:
        if (source_.Below(2) == 0) return peers_.Toggle(peer);
        envelope.mutable_leave();
        break;
      case 6:
        envelope.mutable_fetch()->set_hash(TextBlob("the log").hash.Binary());
        if (source_.Below(2) == 0) Scramble(envelope.mutable_fetch()->mutable_part(), &source_);
        break;
      case 7:
        envelope.mutable_have()->add_hashes(TextBlob("the log").hash.Binary());
        break;
      case 8:
        envelope.mutable_submit()->set_protocol(wire::kProtocol);
        *envelope.mutable_submit()->mutable_job() = SomeJob(source_.Below(4));
        if (source_.Below(4) != 0) Bring(peer);
        break;
      case 9: {
        constexpr std::array<const char*, 5> kActions{"", "status", "cancel", "resume", "results"};
        envelope.mutable_query()->set_action(kActions[source_.Below(5)]);
        envelope.mutable_query()->set_job(JobName());
        break;
      }
      case 10:
        envelope.mutable_offer()->set_hash(TextBlob("the log").hash.Binary());
        envelope.mutable_offer()->set_bytes(source_.Below(2) == 0 ? Log().size() : source_.Below(200));
        break;
      case 11: {
        const std::size_t at = source_.Below(2) == 0 ? 0 : source_.Below(200);
        envelope.mutable_piece()->set_hash(TextBlob("the log").hash.Binary());
        envelope.mutable_piece()->set_at(at);
        envelope.mutable_piece()->set_data(Log().substr(std::min(at, Log().size()), source_.Byte()));
        break;
      }
      default: {
        const auto bytes = source_.Span(source_.Take<std::uint16_t>() % 1024);
        return SayFrames(peer, CutIntoFrames(std::as_bytes(bytes)));
      }
    }
    if (scrambled)
      SayScrambled(peer, std::move(message));
    else
      Say(peer, std::move(message));
  }

  ByteSource source_;
  const ScratchFolder scratch_;
  Peers peers_;
  std::string log_;
  std::optional<coordinator::StoreFolder> folder_;
  std::unique_ptr<coordinator::Server> server_;
};

Outcome Run(std::span<const std::uint8_t> bytes) { return Session(bytes).Run(); }

std::vector<Bytes> Seeds() {
  // A worker comes, a job is submitted, all that is assigned is answered: byte by byte as Op reads them.
  Bytes honest{0, 0, 0, 8, 1, 0, 1};
  for (std::uint8_t i = 0; i < 12; ++i) honest.insert(honest.end(), {1, 0, i, 1});
  Bytes asking{1, 8, 1, 1, 1, 9, 1, 1, 0, 9, 1, 2, 0, 9, 1, 4, 0, 6, 1, 7, 1};
  Bytes liar = honest;
  for (std::size_t i = 7; i < liar.size(); i += 8) liar[i] = 14;
  return {honest, asking, liar};
}

}  // namespace

Target CoordinatorTarget() { return {"coordinator", Run, Seeds, 200}; }

}  // namespace cairn::fuzz
