// Sessions of a worker with a coordinator that says anything: the pipeline is the toy.
#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>

#include "pipelines/testing/in_process.h"
#include "schema/blob_part.h"
#include "tests/fuzz/byte_source.h"
#include "tests/fuzz/frames.h"
#include "tests/fuzz/scramble.h"
#include "tests/fuzz/targets.h"
#include "worker/testing/toy_pipeline.h"
#include "worker/worker.h"

namespace cairn::fuzz {
namespace {

using worker::Event;

proto::Stage ToyStage() {
  proto::Stage stage;
  stage.set_name("stage");
  stage.set_pipeline("toy");
  (*stage.mutable_inputs())["log"] = "log";
  return stage;
}

// What a coordinator would assign in the first round of a toy job, and the blobs that go with it.
struct Plan {
  std::vector<wire::Assign> assigns;
  std::map<std::string, wire::NamedBlob> blobs;  // by binary hash
};

class MapInputs : public Inputs {
 public:
  explicit MapInputs(BlobPtr log) : log_(std::move(log)) {}
  bool Has(const std::string& name) const override { return name == "log"; }
  BlobPtr Get(const std::string&) const override { return log_; }

 private:
  BlobPtr log_;
};

std::string Keep(Plan* plan, const BlobPtr& blob) {
  const wire::NamedBlob named = wire::NameBlob(blob);
  plan->blobs[named.hash.Binary()] = named;
  return named.hash.Binary();
}

wire::Assign Assign(wire::TaskKey::Kind kind, std::uint32_t task) {
  wire::Assign assign;
  assign.mutable_key()->set_job("job");
  assign.mutable_key()->set_kind(kind);
  assign.mutable_key()->set_task(task);
  assign.mutable_key()->set_attempt(1);
  *assign.mutable_stage() = ToyStage();
  return assign;
}

Plan MakePlan() {
  Plan plan;
  const auto log = std::make_shared<const Blob>(testing::ToyLog(20));
  const Step step = testing::MakeToy(ToyStage(), 0)->Start(MapInputs(log));
  for (const BlobPtr& blob : step.blobs) Keep(&plan, blob);
  plan.assigns.push_back(Assign(wire::TaskKey::START, 0));
  (*plan.assigns[0].mutable_inputs())["log"] = Keep(&plan, log);
  wire::Assign advance = Assign(wire::TaskKey::ADVANCE, 0);
  *advance.mutable_state() = step.plan.state();
  for (const proto::Task& task : step.plan.tasks()) {
    Blob partial;
    partial.PutScalar("sum", 0.5 + task.index());
    const std::string hash = Keep(&plan, std::make_shared<const Blob>(std::move(partial)));
    advance.add_partials(hash);
    wire::Assign& run = plan.assigns.emplace_back(Assign(wire::TaskKey::RUN, task.index()));
    *run.mutable_task() = task;
    for (proto::InputRef& input : *run.mutable_task()->mutable_inputs())
      if (input.has_task()) input.set_blob(advance.partials(static_cast<int>(input.task())));
  }
  plan.assigns.push_back(std::move(advance));
  return plan;
}

// The coordinator: a script, and blobs for those who ask.
class Script : public worker::Transport {
 public:
  Script(std::span<const std::uint8_t> bytes, std::atomic<bool>& stop) : source_(bytes), stop_(stop) {}

  std::vector<Event> Poll(double) override {
    std::unique_lock lock(mutex_);
    if (source_.empty() && ready_.empty()) Settle(lock);
    if (!source_.empty() && ready_.empty()) Op();
    std::vector<Event> events = std::exchange(ready_, {});
    return events;
  }
  bool Send(const wire::Message& message) override {
    const std::lock_guard lock(mutex_);
    if (message.envelope.has_done() || message.envelope.has_failed()) {
      ++answered_;
      ++all_answered_;
    }
    if (message.envelope.has_fetch()) Answer(message.envelope.fetch());
    return true;
  }
  std::uint64_t BytesCame() const override { return 0; }
  void Wake() override {
    const std::lock_guard lock(mutex_);
    woken_ = true;
    changed_.notify_all();
  }
  int answered() const { return all_answered_; }

 private:
  // The script is at its end: time for what is being computed, but not for what will never come.
  void Settle(std::unique_lock<std::mutex>& lock) {
    const bool more = answered_ < given_ &&
                      changed_.wait_for(lock, std::chrono::milliseconds(300), [this] { return woken_; });
    woken_ = false;
    if (!more) stop_ = true;
  }
  // In place of a part that is none it sends the whole.
  void Answer(const wire::Fetch& fetch) {
    wire::Message message;
    const auto it = plan().blobs.find(fetch.hash());
    if (it == plan().blobs.end()) {
      message.envelope.mutable_missing()->set_hash(fetch.hash());
      if (fetch.has_part()) *message.envelope.mutable_missing()->mutable_part() = fetch.part();
    } else if (fetch.has_part()) {
      const Result<BlobPtr> part = CutPart(*it->second.blob, fetch.part());
      message.envelope.mutable_blob()->set_of(fetch.hash());
      *message.envelope.mutable_blob()->mutable_part() = fetch.part();
      message.blobs = {part.ok() ? wire::NameBlob(part.value()) : it->second};
    } else {
      message.envelope.mutable_blob();
      message.blobs = {it->second};
    }
    Give(std::move(message));
  }
  void Give(wire::Message message) {
    const wire::Envelope& envelope = message.envelope;
    if (envelope.has_welcome()) welcome_ = true;
    if (envelope.has_unknown_worker() || envelope.has_leave()) welcome_ = false;
    // What was dropped is not answered; what came before the Welcome is not even taken.
    if (!welcome_ || envelope.has_cancel()) given_ = answered_;
    if (welcome_ && envelope.has_assign()) ++given_;
    ready_.push_back({Event::kMessage, std::move(message), {}});
  }
  void GiveEvent(Event::Kind kind, const std::string& text) {
    welcome_ = false;
    given_ = answered_;
    ready_.push_back({kind, {}, text});
  }
  void GiveFrames(std::span<const std::span<const std::byte>> frames) {
    Result<wire::Message> message = wire::Decode(frames);
    if (message.ok()) return Give(std::move(message).value());
    GiveEvent(Event::kMalformed, message.status().message());
    GiveEvent(Event::kConnected, {});
  }
  static const Plan& plan() {
    static const Plan plan = MakePlan();
    return plan;
  }

  void Op() {
    wire::Message message;
    const std::size_t op = source_.Below(12);
    const wire::Assign& assign = plan().assigns[source_.Byte() % plan().assigns.size()];
    switch (op) {
      case 0:
        return GiveEvent(Event::kConnected, {});
      case 1:
        return GiveEvent(Event::kDisconnected, {});
      case 2:
        message.envelope.mutable_welcome()->set_heartbeat_s(1);
        break;
      case 3:
        message.envelope.mutable_unknown_worker();
        break;
      case 4:
        message.envelope.mutable_leave();
        break;
      case 5:
        *message.envelope.mutable_cancel()->mutable_key() = assign.key();
        break;
      case 6:
        message.envelope.mutable_blob();
        Scramble(message.envelope.mutable_blob(), &source_);
        message.blobs = {plan().blobs.begin()->second};
        break;
      case 7:
        return GiveFrames(CutIntoFrames(std::as_bytes(source_.Span(source_.Take<std::uint16_t>() % 1024))));
      case 8:
      case 9: {
        wire::Envelope& envelope = message.envelope;
        *envelope.mutable_assign() = assign;
        if (op == 9) Scramble(envelope.mutable_assign(), &source_);
        break;
      }
      default:
        *message.envelope.mutable_assign() = assign;
    }
    Give(std::move(message));
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool woken_ = false;
  bool welcome_ = false;
  ByteSource source_;
  std::atomic<bool>& stop_;
  std::vector<Event> ready_;
  int given_ = 0, answered_ = 0, all_answered_ = 0;
};

Outcome Run(std::span<const std::uint8_t> bytes) {
  std::atomic<bool> stop{false};
  Script script(bytes.first(std::min<std::size_t>(bytes.size(), 4096)), stop);
  RunWorker(script, testing::MakeToy, worker::WorkerOptions{}, stop);
  return script.answered() > 0 ? Outcome::kAccepted : Outcome::kRefused;
}

std::vector<Bytes> Seeds() {
  Bytes honest{0, 0, 2, 0};
  for (std::uint8_t i = 0; i < 9; ++i) honest.insert(honest.end(), {8, i});
  return {honest, {0, 0, 2, 0, 8, 0, 9, 1, 4, 1}};
}

}  // namespace

Target WorkerTarget() { return {"worker", Run, Seeds, 500}; }

}  // namespace cairn::fuzz
