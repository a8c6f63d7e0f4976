// A worker in a thread, with a test on the other end of its transport and a clock that only the test moves.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "pipelines/pipeline.h"
#include "schema/blob_part.h"
#include "worker/testing/fake_transport.h"
#include "worker/worker.h"

namespace cairn::worker {

// A pipeline whose Run is whatever the test says.
class LambdaPipeline : public Pipeline {
 public:
  using RunFunction = std::function<Blob(const Task&, const Inputs&, Progress&)>;
  explicit LambdaPipeline(RunFunction run) : run_(std::move(run)) {}
  Step Start(const Inputs&) const override { return {}; }
  Blob Run(const Task& task, const Inputs& inputs, Progress& progress) const override {
    return run_(task, inputs, progress);
  }
  Step Advance(const State&, Partials&, const Inputs&) const override { return {}; }

 private:
  RunFunction run_;
};

class Rig {
 public:
  explicit Rig(PipelineFactory factory, const std::function<void(WorkerOptions&)>& change = {}) {
    WorkerOptions options;
    options.session.hello.set_host("rig");
    options.session.log = [this](Severity, const std::string& line) {
      const std::lock_guard lock(mutex_);
      log_ += line + "\n";
    };
    options.now_s = [this] { return now_s_.load(); };
    if (change) change(options);
    thread_ = std::thread([this, options, factory = std::move(factory)] {
      code_ = RunWorker(transport, factory, options, stop_);
    });
  }
  explicit Rig(LambdaPipeline::RunFunction run, const std::function<void(WorkerOptions&)>& change = {})
      : Rig([run](const proto::Stage&, std::uint64_t) { return std::make_unique<LambdaPipeline>(run); },
            change) {}
  ~Rig() {
    if (thread_.joinable()) Stop();
  }

  void Give(Event::Kind kind) { transport.Give({.kind = kind, .message = {}, .text = "garbled"}); }
  void Give(wire::Message message) {
    transport.Give({.kind = Event::kMessage, .message = std::move(message), .text = {}});
  }
  // Connects, takes Hello, says Welcome.
  void Begin(double heartbeat_s = 1) {
    Give(Event::kConnected);
    EXPECT_TRUE(transport.Take().envelope.has_hello());
    wire::Message welcome;
    welcome.envelope.mutable_welcome()->set_heartbeat_s(heartbeat_s);
    Give(welcome);
  }
  void Assign(const wire::Assign& assign) {
    wire::Message message;
    *message.envelope.mutable_assign() = assign;
    Give(message);
  }
  void Cancel(const wire::TaskKey& key) {
    wire::Message message;
    *message.envelope.mutable_cancel()->mutable_key() = key;
    Give(message);
  }
  // The next message that is not a fetch of a blob in `store`; those are answered and counted.
  wire::Message Serve() {
    while (true) {
      wire::Message message = transport.Take();
      if (!message.envelope.has_fetch()) return message;
      ++fetches;
      Answer(message.envelope.fetch());
    }
  }
  void Answer(const wire::Fetch& fetch) {
    const Hash hash = Hash::FromBinary(fetch.hash()).value();
    const auto it = store.find(hash);
    if (!fetch.has_part() || it == store.end()) return Answer(hash);
    wire::Message reply;
    if (const Result<BlobPtr> part = CutPart(*it->second, fetch.part()); part.ok()) {
      reply.envelope.mutable_blob()->set_of(fetch.hash());
      *reply.envelope.mutable_blob()->mutable_part() = fetch.part();
      reply.blobs = {wire::NameBlob(part.value())};
    } else {
      reply.envelope.mutable_missing()->set_hash(fetch.hash());
      *reply.envelope.mutable_missing()->mutable_part() = fetch.part();
      reply.envelope.mutable_missing()->set_why(part.status().message());
    }
    Give(reply);
  }
  void Answer(const Hash& hash) {
    wire::Message reply;
    if (const auto it = store.find(hash); it != store.end()) {
      reply.envelope.mutable_blob();
      reply.blobs = {{hash, it->second}};
    } else {
      reply.envelope.mutable_missing()->set_hash(hash.Binary());
    }
    Give(reply);
  }
  Hash Keep(Blob blob) {
    const wire::NamedBlob named = wire::NameBlob(std::make_shared<const Blob>(std::move(blob)));
    store[named.hash] = named.blob;
    return named.hash;
  }
  void Pass(double seconds) {
    now_s_ = now_s_ + seconds;
    transport.Wake();
  }
  int Stop() {
    stop_ = true;
    transport.Wake();
    return Join();
  }
  int Join() {
    thread_.join();
    return code_;
  }
  std::string log() {
    const std::lock_guard lock(mutex_);
    return log_;
  }

  FakeTransport transport;
  std::map<Hash, BlobPtr> store;
  int fetches = 0;

 private:
  std::mutex mutex_;
  std::string log_;
  std::atomic<double> now_s_{100};
  std::atomic<bool> stop_{false};
  int code_ = -1;
  std::thread thread_;
};

// A RUN task of stage "s".
inline wire::Assign RunTask(std::uint32_t index, const std::map<std::string, Hash>& inputs = {}) {
  wire::Assign assign;
  assign.mutable_key()->set_job("job");
  assign.mutable_key()->set_task(index);
  assign.mutable_key()->set_attempt(1);
  assign.mutable_stage()->set_name("s");
  assign.mutable_task()->set_index(index);
  assign.mutable_task()->set_kind("slice");
  for (const auto& [name, hash] : inputs) {
    proto::InputRef& ref = *assign.mutable_task()->add_inputs();
    ref.set_name(name);
    ref.set_blob(hash.Binary());
  }
  return assign;
}

inline Blob Number(double value) {
  Blob blob;
  blob.PutScalar("v", value);
  return blob;
}

// v of input "a", plus the task's index.
inline Blob AddIndex(const Task& task, const Inputs& inputs, Progress& progress) {
  progress.Tick();
  return Number(inputs.Get("a")->Scalar<double>("v") + task.index());
}

inline Blob SpinUntilCancelled(const Task& task, const Inputs&, Progress& progress) {
  while (task.index() == 0) progress.Tick();
  return Number(task.index());
}

}  // namespace cairn::worker
