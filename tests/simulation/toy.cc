#include "tests/simulation/toy.h"

#include <algorithm>

#include "coordinator/core/round.h"
#include "schema/blob_part.h"
#include "schema/rng.h"

namespace cairn::simulation {
namespace {

std::int64_t Option(const proto::Stage& stage, const char* name) { return stage.options().at(name).i(); }

Hash Mix(std::string_view what, const std::vector<std::string>& parts) {
  Hasher hasher;
  hasher.Add(what);
  for (const std::string& part : parts) hasher.Add(std::string_view(part));
  return hasher.Finish();
}

std::uint64_t Draw(const Hash& hash, std::uint64_t n) {
  return Rng(hash.bytes[0] | static_cast<std::uint64_t>(hash.bytes[1]) << 8, hash.bytes[2]).Below(n);
}

// Some tasks read the partial of an earlier one: chains and trees.
void PlanTasks(proto::Step& step, const Hash& basis, std::int64_t most, const Hash& shared) {
  const auto count = static_cast<std::uint32_t>(Draw(basis, static_cast<std::uint64_t>(most) + 1));
  for (std::uint32_t i = 0; i < count; ++i) {
    proto::Task& task = *step.add_tasks();
    task.set_index(i);
    task.set_kind("toy");
    const Hash dice = Mix("task", {basis.Binary(), std::to_string(i)});
    task.set_cost(Draw(dice, 3));
    (*task.mutable_params())["n"].set_i(static_cast<std::int64_t>(Draw(dice, 1000)));
    proto::InputRef& input = *task.add_inputs();
    input.set_name("shared");
    input.set_blob(shared.Binary());
    if (Draw(dice, 2) == 0)  // some read the same rows in one round after the other
      *input.mutable_part() = RowsPart("values", static_cast<std::int64_t>(Draw(dice, 7)), 3);
    if (i == 0 || Draw(dice, 3) == 0) continue;
    proto::InputRef& earlier = *task.add_inputs();
    earlier.set_name("earlier");
    earlier.set_task(static_cast<std::uint32_t>(Draw(dice, i)));
  }
}

ToyAnswer Plan(const proto::Stage& stage, const Hash& basis, std::int64_t round) {
  ToyAnswer answer;
  if (round == Option(stage, "rounds")) {
    const Hash result = Mix("result", {basis.Binary()});
    answer.step.set_result(result.Binary());
    answer.blobs.push_back(result);
    return answer;
  }
  const Hash shared = Mix("shared", {basis.Binary()}), kept = Mix("kept", {basis.Binary()});
  proto::State& state = *answer.step.mutable_state();
  (*state.mutable_scalars())["round"].set_i(round);
  (*state.mutable_blobs())["kept"] = kept.Binary();
  const Hash shown = Mix("shown", {basis.Binary()});
  state.set_so_far(shown.Binary());
  PlanTasks(answer.step, basis, Option(stage, "tasks"), shared);
  answer.step.set_note("round " + std::to_string(round));
  answer.blobs = {shared, kept, shown};
  return answer;
}

std::vector<std::string> Values(const google::protobuf::Map<std::string, std::string>& map) {
  const std::map<std::string, std::string> sorted(map.begin(), map.end());
  std::vector<std::string> values;
  for (const auto& [name, value] : sorted) values.push_back(name + "=" + value);
  return values;
}

}  // namespace

ToyAnswer ComputeToy(const wire::Assign& assign) {
  const proto::Stage& stage = assign.stage();
  if (assign.key().kind() == wire::TaskKey::RUN) {
    std::vector<std::string> parts{std::to_string(assign.task().params().at("n").i())};
    for (const proto::InputRef& input : assign.task().inputs())
      parts.push_back(input.name() + "=" + input.blob() + "/" + std::to_string(input.part().first_row()));
    ToyAnswer answer;
    answer.partial = Mix("partial", parts);
    answer.blobs = {answer.partial};
    answer.input_error = stage.options().contains("bad") && assign.key().round() == 1;
    answer.fails = stage.options().contains("poison") && assign.key().round() == 1;
    return answer;
  }
  std::vector<std::string> parts = Values(assign.inputs());
  parts.push_back(std::to_string(assign.seed()));
  std::int64_t round = 0;
  if (assign.key().kind() == wire::TaskKey::ADVANCE) {
    round = assign.state().scalars().at("round").i() + 1;
    for (const std::string& value : Values(assign.state().blobs())) parts.push_back(value);
    parts.insert(parts.end(), assign.partials().begin(), assign.partials().end());
  }
  ToyAnswer answer = Plan(stage, Mix("plan", parts), round);
  // Where round 1 had no tasks.
  answer.input_error = stage.options().contains("bad") && round == 2;
  answer.fails = stage.options().contains("poison") && round == 2;
  return answer;
}

proto::Job MakeToyJob(std::uint64_t seed, int stages, int rounds, int tasks, ToyKind kind) {
  Rng rng(seed, 77);
  proto::Job job;
  job.set_name("toy");
  job.set_seed(seed);
  (*job.mutable_input_blobs())["log"] = Mix("log", {std::to_string(seed)}).Binary();
  for (int i = 0; i < stages; ++i) {
    proto::Stage& stage = *job.add_stages();
    stage.set_name("stage" + std::to_string(i));
    stage.set_pipeline("toy");
    (*stage.mutable_inputs())["log"] = "log";
    if (i > 0)
      (*stage.mutable_inputs())["before"] =
          "stage" + std::to_string(rng.Below(static_cast<std::uint64_t>(i)));
    (*stage.mutable_options())["rounds"].set_i(
        static_cast<std::int64_t>(rng.Below(static_cast<std::uint64_t>(rounds) + 1)));
    (*stage.mutable_options())["tasks"].set_i(tasks);
    if (kind == ToyKind::kGood || i > 0) continue;
    (*stage.mutable_options())["rounds"].set_i(rounds + 3);
    if (kind == ToyKind::kBadInput) (*stage.mutable_options())["bad"].set_b(true);
    if (kind == ToyKind::kPoisoned) (*stage.mutable_options())["poison"].set_b(true);
    if (kind == ToyKind::kHopeless) (*stage.mutable_inputs())["before"] = "nothing of that name";
  }
  return job;
}

ToyTruth RunToy(const proto::Job& job) {
  ToyTruth truth;
  std::map<std::string, std::string> known(job.input_blobs().begin(), job.input_blobs().end());
  for (std::uint32_t s = 0; s < static_cast<std::uint32_t>(job.stages_size()); ++s) {
    wire::Assign assign;
    *assign.mutable_stage() = job.stages(static_cast<int>(s));
    assign.set_seed(job.seed());
    for (const auto& [name, source] : assign.stage().inputs())
      (*assign.mutable_inputs())[name] = known.at(source);
    assign.mutable_key()->set_kind(wire::TaskKey::START);
    ToyAnswer plan = ComputeToy(assign);
    for (std::uint64_t round = 0; plan.step.result().empty(); ++round) {
      ToyTruth::Round& known_round = truth.rounds[{s, round}];
      known_round.step = coordinator::HashOfStep(plan.step);
      truth.most_tasks = std::max(truth.most_tasks, static_cast<std::size_t>(plan.step.tasks_size()));
      assign.mutable_key()->set_round(round);
      assign.mutable_key()->set_kind(wire::TaskKey::RUN);
      assign.clear_partials();
      for (const proto::Task& task : plan.step.tasks()) {
        *assign.mutable_task() = task;
        for (proto::InputRef& input : *assign.mutable_task()->mutable_inputs())
          if (input.has_task()) input.set_blob(std::string(assign.partials(static_cast<int>(input.task()))));
        known_round.partials.push_back(ComputeToy(assign).partial);
        assign.add_partials(known_round.partials.back().Binary());
      }
      *assign.mutable_state() = plan.step.state();
      assign.mutable_key()->set_kind(wire::TaskKey::ADVANCE);
      plan = ComputeToy(assign);
    }
    truth.ends.push_back(coordinator::HashOfStep(plan.step));
    truth.results.push_back(Hash::FromBinary(plan.step.result()).value());
    known[assign.stage().name()] = plan.step.result();
  }
  return truth;
}

}  // namespace cairn::simulation
