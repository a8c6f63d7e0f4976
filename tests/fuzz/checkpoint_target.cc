#include "coordinator/core/core.h"
#include "coordinator/store/checkpoint_file.h"
#include "tests/fuzz/byte_source.h"
#include "tests/fuzz/scramble.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {
namespace {

std::string SomeHash(char c) { return std::string(16, c); }

proto::Checkpoint GoodCheckpoint(bool with_step) {
  proto::Checkpoint checkpoint;
  checkpoint.set_job_id("1-toy");
  checkpoint.set_number(3);
  checkpoint.set_order(1);
  proto::Job& job = *checkpoint.mutable_job();
  job.set_name("toy");
  (*job.mutable_inputs())["log"] = "log.h5";
  (*job.mutable_input_blobs())["log"] = SomeHash('l');
  for (const char* name : {"one", "two"}) {
    proto::Stage& stage = *job.add_stages();
    stage.set_name(name);
    stage.set_pipeline("toy");
    (*stage.mutable_inputs())["log"] = "log";
  }
  checkpoint.set_stage(1);
  checkpoint.add_results(SomeHash('r'));
  for (const char c : {'l', 'r', 's'}) checkpoint.add_blobs(SomeHash(c));
  checkpoint.add_facts()->add_rounds()->set_note("start");
  checkpoint.add_facts();
  if (!with_step) return checkpoint;
  proto::Step& step = *checkpoint.mutable_step();
  (*step.mutable_state()->mutable_blobs())["shared"] = SomeHash('s');
  for (std::uint32_t i = 0; i < 3; ++i) {
    proto::Task& task = *step.add_tasks();
    task.set_index(i);
    proto::InputRef& input = *task.add_inputs();
    input.set_name("x");
    if (i == 2)
      input.set_task(0);
    else
      input.set_blob(SomeHash('s'));
  }
  for (int i = 0; i < 3; ++i) checkpoint.add_partials(i == 1 ? SomeHash('p') : "");
  return checkpoint;
}

// A worker that fails at whatever it is given, until nothing is left to do.
void GoOn(coordinator::Core& core) {
  using namespace coordinator;
  WorkerHello hello{"w", {}};
  hello.hello.set_protocol(3);
  hello.hello.set_slots(4);
  double now_s = 1;
  std::vector<Action> actions = core.Handle(hello, now_s);
  for (int i = 0; i < 20 && !actions.empty(); ++i) {
    std::vector<Action> next;
    const auto handle = [&](const Event& event) {
      for (Action& action : core.Handle(event, now_s += 0.5)) next.push_back(std::move(action));
    };
    for (const Action& action : actions) {
      if (const auto* persist = std::get_if<Persist>(&action))
        handle(PersistDone{persist->checkpoint.job_id(), persist->checkpoint.number()});
      const auto* send = std::get_if<Send>(&action);
      if (send == nullptr || !send->message.has_assign()) continue;
      TaskFailed failed{"w", {}};
      *failed.failed.mutable_key() = send->message.assign().key();
      handle(failed);
    }
    handle(Tick{});
    actions = std::move(next);
  }
}

Outcome Run(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return Outcome::kRefused;
  std::string inside;
  if (bytes[0] % 2 == 0) {
    inside.assign(bytes.begin() + 1, bytes.end());
  } else {
    ByteSource source(bytes.subspan(1));
    proto::Checkpoint checkpoint = GoodCheckpoint(bytes[0] % 4 == 1);
    for (std::size_t edits = source.Below(6); edits > 0; --edits) Scramble(&checkpoint, &source);
    inside = checkpoint.SerializeAsString();
  }
  const Result<proto::Checkpoint> parsed = coordinator::ParseCheckpoint(
      std::span(reinterpret_cast<const std::uint8_t*>(inside.data()), inside.size()));
  if (!parsed.ok()) return Outcome::kRefused;
  coordinator::Core core{coordinator::CoreOptions{}};
  core.Handle(coordinator::RestoreJob{parsed.value(), {}}, 0);
  CAIRN_DEMAND(core.Jobs().size() == 1, "a checkpoint that was accepted gives a job");
  GoOn(core);
  core.Handle(coordinator::CancelJob{parsed.value().job_id()}, 1e6);
  return Outcome::kAccepted;
}

std::vector<Bytes> Seeds() {
  std::vector<Bytes> seeds{{1, 0}, {3, 0}};
  for (const bool with_step : {false, true}) {
    const std::string bytes = GoodCheckpoint(with_step).SerializeAsString();
    seeds.emplace_back(1, 0);
    seeds.back().insert(seeds.back().end(), bytes.begin(), bytes.end());
  }
  return seeds;
}

}  // namespace

Target CheckpointTarget() { return {"checkpoint", Run, Seeds, 5000}; }

}  // namespace cairn::fuzz
