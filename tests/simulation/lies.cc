#include "tests/simulation/lies.h"

#include <limits>

#include "tests/simulation/world.h"

namespace cairn::simulation {
namespace {

using coordinator::TaskDone;
using coordinator::TaskFailed;
using coordinator::WorkerHeartbeat;

Hash RandomHash(Rng& rng) {
  Hasher hasher;
  hasher.Add(rng.Bits64());
  return hasher.Finish();
}

// Another answer of the right shape.
TaskDone Distort(Rng& rng, TaskDone done) {
  const Hash wrong = RandomHash(rng);
  if (done.done.key().kind() == wire::TaskKey::RUN) {
    done.done.set_partial(wrong.Binary());
    done.blobs.clear();
  } else if (!done.done.has_step() || !done.done.step().result().empty()) {
    done.done.mutable_step()->set_result(wrong.Binary());
  } else {
    (*done.done.mutable_step()->mutable_state()->mutable_blobs())["kept"] = wrong.Binary();
  }
  done.blobs.push_back(wrong);
  return done;
}

TaskDone Misshape(Rng& rng, TaskDone done) {
  proto::Step& step = *done.done.mutable_step();
  if (done.done.key().kind() == wire::TaskKey::RUN) {
    if (rng.Below(3) == 0)
      done.blobs.push_back(RandomHash(rng));
    else
      done.done.set_partial(rng.Below(2) == 0 ? "" : "short");
    return done;
  }
  switch (rng.Below(5)) {
    case 0:
      done.done.clear_step();
      break;
    case 1:
      step.add_tasks()->set_index(1000);
      break;
    case 2:
      step.set_result("short");
      break;
    case 3:
      (*step.mutable_state()->mutable_blobs())["kept"] = "short";
      break;
    default: {
      proto::Task& task = *step.add_tasks();
      task.set_index(static_cast<std::uint32_t>(step.tasks_size() - 1));
      task.add_inputs()->set_task(task.index());  // its own partial
    }
  }
  return done;
}

// A key near to where some job stands, which others may have been given.
wire::TaskKey GuessKey(World& world, wire::TaskKey key) {
  Rng& rng = world.rng;
  if (world.users.jobs().empty() || world.shell().core() == nullptr) return key;
  const auto& jobs = world.users.jobs();
  const std::string& id = jobs[rng.Below(jobs.size())];
  const coordinator::Job* job = world.shell().core()->FindJob(id);
  if (job == nullptr) return key;
  key = job->Key(static_cast<std::uint32_t>(rng.Below(job->tasks.size() + 2)),
                 static_cast<std::uint32_t>(1 + rng.Below(3)));
  if (rng.Below(4) == 0) key.set_stage(key.stage() + static_cast<std::uint32_t>(rng.Below(3)));
  if (rng.Below(4) == 0) key.set_round(rng.Below(4) == 0 ? rng.Bits64() : key.round() + rng.Below(2));
  if (rng.Below(8) == 0) key.set_kind(wire::TaskKey::ADVANCE);
  if (rng.Below(16) == 0) key.set_task(std::numeric_limits<std::uint32_t>::max());
  if (rng.Below(16) == 0) key.set_job("nobody's");
  return key;
}

// Of the kinds that any coordinator must see through.
Answer TellClumsyLie(World& world, const std::string& peer, const wire::Assign& assign, TaskDone done) {
  Rng& rng = world.rng;
  switch (rng.Below(6)) {
    case 0:
      world.Count(kLieNoBlob);
      done = Distort(rng, done);
      done.blobs.clear();
      return {done};
    case 1:
      world.Count(kLieWrongHash);
      return {Distort(rng, done), false};
    case 2:
      world.Count(kLieWrongShape);
      return {Misshape(rng, done)};
    case 3: {
      world.Count(kLieNotTheirsFailed);
      TaskFailed failed{peer, {}};
      *failed.failed.mutable_key() = GuessKey(world, assign.key());
      failed.failed.set_input_error(true);
      failed.failed.set_message("a lie");
      return {failed};
    }
    case 4: {
      world.Count(kLieHeartbeat);
      WorkerHeartbeat heartbeat{peer, {}};
      for (int i = 0; i < 3; ++i) *heartbeat.heartbeat.add_tasks() = GuessKey(world, assign.key());
      heartbeat.heartbeat.add_ticks(std::numeric_limits<std::uint64_t>::max());
      return {heartbeat};
    }
    default:
      world.Count(kLieNotTheirs);
      *done.done.mutable_key() = GuessKey(world, assign.key());
      if (done.done.key().kind() == wire::TaskKey::RUN) done.done.set_partial(RandomHash(rng).Binary());
      return {Distort(rng, done)};
  }
}

}  // namespace

Answer TellTruth(const std::string& peer, const wire::Assign& assign, const ToyAnswer& toy) {
  TaskDone done{peer, {}, toy.blobs};
  *done.done.mutable_key() = assign.key();
  if (assign.key().kind() == wire::TaskKey::RUN)
    done.done.set_partial(toy.partial.Binary());
  else
    *done.done.mutable_step() = toy.step;
  done.done.set_seconds(0.1);
  return {done};
}

std::vector<Answer> TellLies(World& world, const std::string& peer, const wire::Assign& assign,
                             const ToyAnswer& toy) {
  const Answer truth = TellTruth(peer, assign, toy);
  TaskDone done = std::get<TaskDone>(truth.event);
  done.done.set_seconds(world.rng.Below(2) == 0 ? std::numeric_limits<double>::quiet_NaN() : -1e300);
  if (!world.faults.plausible_lies || world.rng.Below(2) == 0)
    return {TellClumsyLie(world, peer, assign, done)};
  if (world.rng.Below(2) == 0) {
    world.Count(kLiePlausible);
    return {{Distort(world.rng, done)}};
  }
  world.Count(kLieSecond);
  return {truth, {Distort(world.rng, done)}};
}

}  // namespace cairn::simulation
