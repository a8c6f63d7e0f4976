// What a worker computes is a task of a plan that another worker made, with blobs that others made: one gone
// bad may put anything there. Whatever that is, the task is done or fails with a reason, and the process that
// computes it lives on. So it is with what comes after the tasks: a state and partials that others made. Most
// telling in a build with a sanitizer, which sees what is read out of bounds.
//
// Every third change is tried, with HOSTILE_PLANS=all in the environment every one.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <limits>
#include <set>
#include <span>
#include <utility>

#include "pipelines/common/fan_out.h"
#include "pipelines/testing/in_process.h"
#include "schema/demands_throw.h"
#include "tests/conformance/cases.h"

namespace cairn::conformance {
namespace {

using Params = std::map<std::string, proto::Value>;

// What a worker gets: the parameters of a task or the scalars of a state, and all blobs.
struct Handed {
  Params params;
  InputMap inputs;

  Handed With(const std::string& param, const proto::Value& value) const {
    Handed handed = *this;
    handed.params[param] = value;
    return handed;
  }
  Handed With(const std::string& input, const std::string& name, const Array& array) const {
    Handed handed = *this;
    Blob changed = *inputs.at(input);
    changed.Put(name, array);
    handed.inputs[input] = std::make_shared<const Blob>(std::move(changed));
    return handed;
  }
};

constexpr std::int64_t kIntegers[] = {-1,
                                      0,
                                      std::int64_t{1} << 30,
                                      std::int64_t{1} << 31,
                                      std::int64_t{1} << 40,
                                      std::numeric_limits<std::int64_t>::min(),
                                      std::numeric_limits<std::int64_t>::max()};
constexpr double kNumbers[] = {
    std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e308, -1e308, -1, 0};

using Arrays = std::vector<std::pair<std::string, Array>>;

// Every element, and the last alone, as each of `values`, cut to what T holds.
template <class T, class Values>
void AddFilled(const Array& array, const Values& values, Arrays* to) {
  const auto elements = array.As<T>();
  if (elements.empty()) return;
  for (auto value : values) {
    if constexpr (std::is_integral_v<T>)
      value = std::clamp<std::int64_t>(value, std::numeric_limits<T>::min(), std::numeric_limits<T>::max());
    const std::vector<T> all(elements.size(), static_cast<T>(value));
    std::vector<T> last(elements.begin(), elements.end());
    last.back() = static_cast<T>(value);
    to->push_back({"all " + std::to_string(value), Array::Of(array.shape(), all)});
    to->push_back({"last " + std::to_string(value), Array::Of(array.shape(), last)});
  }
}

// The first of its bytes in another shape.
Array Reshaped(const Array& array, const Shape& shape) {
  std::size_t bytes = array.item_bytes();
  for (const std::int64_t n : shape) bytes *= static_cast<std::size_t>(n);
  return Array::FromBytes(array.type(), array.item_bytes(), shape, array.bytes().first(bytes)).value();
}

Arrays MutantsOf(const Array& array) {
  Arrays mutants;
  if (array.type() == DType::kI64) AddFilled<std::int64_t>(array, kIntegers, &mutants);
  if (array.type() == DType::kI32) AddFilled<std::int32_t>(array, kIntegers, &mutants);
  if (array.type() == DType::kU8) AddFilled<std::uint8_t>(array, kIntegers, &mutants);
  if (array.type() == DType::kF64) AddFilled<double>(array, kNumbers, &mutants);
  if (array.type() == DType::kF32) AddFilled<float>(array, kNumbers, &mutants);
  const Shape& shape = array.shape();
  if (shape.empty()) mutants.push_back({"of no element", Reshaped(array, {0})});
  if (shape.size() > 1) mutants.push_back({"flat", Reshaped(array, {array.size()})});
  for (const std::int64_t rows : {std::int64_t{0}, shape.empty() ? 0 : shape[0] / 2}) {
    if (shape.empty() || rows >= shape[0]) continue;
    Shape cut = shape;
    cut[0] = rows;
    mutants.push_back({"of " + std::to_string(rows) + " rows", Reshaped(array, cut)});
  }
  return mutants;
}

using Visit = std::function<void(const std::string& what, const Handed& handed)>;

// Every parameter and every array by itself.
void ForEachMutant(const Handed& real, const Visit& visit) {
  for (const auto& [name, value] : real.params) {
    proto::Value hostile;
    for (const std::int64_t i : kIntegers) {
      hostile.set_i(i);
      if (value.has_i()) visit(name + " = " + std::to_string(i), real.With(name, hostile));
    }
    for (const double d : kNumbers) {
      hostile.set_d(d);
      if (value.has_d()) visit(name + " = " + std::to_string(d), real.With(name, hostile));
    }
    Handed without = real;
    without.params.erase(name);
    visit("without " + name, without);
  }
  for (const auto& [input, blob] : real.inputs) {
    for (const auto& [name, array] : blob->fields()) {
      if (name.starts_with("truth/")) continue;
      for (const auto& [what, mutant] : MutantsOf(array))
        visit(input + ", " + name + ": " + what, real.With(input, name, mutant));
    }
  }
}

// Somebody cancels a task that takes long.
class SomeTicks : public Progress {
 public:
  void Tick() override {
    if (++ticks_ > 20) throw Cancelled{};
  }

 private:
  int ticks_ = 0;
};

using Compute = std::function<void(const Handed&, Progress&)>;

struct Change {
  std::string what;
  Handed handed;
};

[[noreturn]] void ComputeAndExit(const Compute& compute, std::span<const Change> changes) {
  rlim_t seconds = 600;
#ifndef CAIRN_SANITIZED
  const rlimit memory{rlim_t{4} << 30, rlim_t{4} << 30};
  setrlimit(RLIMIT_AS, &memory);
  seconds = 60;
#endif
  const rlimit processor_time{seconds, seconds};
  setrlimit(RLIMIT_CPU, &processor_time);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const DemandsThrow demands_throw;  // as in a worker
  for (const Change& change : changes) {
    SomeTicks progress;
    try {
      compute(change.handed, progress);
    } catch (const std::exception&) {
    } catch (const Cancelled&) {
    }
  }
  _exit(0);
}

// Computes one after the other in a process of their own, and says how that ended; empty where it lived on.
std::string EndOf(const Compute& compute, std::span<const Change> changes) {
  int ends[2];
  if (pipe(ends) != 0) return "there is no pipe";
  const pid_t child = fork();
  if (child == 0) {
    dup2(ends[1], STDERR_FILENO);
    close(ends[0]);
    ComputeAndExit(compute, changes);
  }
  close(ends[1]);
  std::string said;
  char bytes[4096];
  for (ssize_t count = 0; (count = read(ends[0], bytes, sizeof bytes)) > 0;)
    said.append(bytes, static_cast<std::size_t>(count));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  return (WIFSIGNALED(status) ? std::string(strsignal(WTERMSIG(status))) : "it exited") + "\n" +
         said.substr(0, 4000);
}

// A sanitizer's allocator does not throw.
bool IsBadAlloc(const std::string& end) {
  for (const char* what : {"allocation-size-too-big", "out-of-memory", "exceeds maximum supported size"})
    if (end.find(what) != std::string::npos) return true;
  return false;
}

// Tries every change, or every third one.
class Tried {
 public:
  // Several in a process; where that ends, each in one of its own.
  void All(const std::string& of, const Handed& real, const Compute& compute) {
    constexpr std::size_t kTogether = 16;
    std::vector<Change> changes;
    const auto try_them = [&] {
      const bool lived_on = EndOf(compute, changes).empty();
      for (const Change& change : changes) {
        const std::string end = lived_on ? "" : EndOf(compute, {&change, 1});
        EXPECT_TRUE(end.empty() || IsBadAlloc(end)) << of << ", " << change.what << ": " << end;
      }
      changes.clear();
    };
    ForEachMutant(real, [&](const std::string& what, const Handed& handed) {
      if (every_ || changes_ % 3 == 0) changes.push_back({what, handed});
      ++changes_;
      if (changes.size() == kTogether) try_them();
    });
    try_them();
  }

 private:
  const bool every_ = [] {
    const char* which = std::getenv("HOSTILE_PLANS");
    return which != nullptr && std::string_view(which) == "all";
  }();
  int changes_ = 0;
};

std::string NamesIn(const InputMap& inputs) {
  std::string names;
  for (const auto& [name, blob] : inputs) names += " " + name;
  return names;
}

// Of several candidate starts (pipelines/common/fan_out.h) the first's and the last's state is changed, of
// the partials the first and the last one: others are read as these are.
constexpr const char* kFirstPartial = "first partial";
constexpr const char* kLastPartial = "last partial";

bool IsOfAMiddleStart(const std::string& name, int starts) {
  const auto of = [&](int start) { return name.starts_with("start/" + std::to_string(start) + "/"); };
  return name.starts_with("start/") && !of(0) && !of(starts - 1);
}

// What an Advance is handed.
Handed HandedOn(const proto::State& state, const BlobsByHash& store, const std::vector<BlobPtr>& done) {
  Handed real;
  const int starts = StartsIn(state);
  for (const auto& [name, value] : state.scalars())
    if (!IsOfAMiddleStart(name, starts)) real.params[name] = value;
  for (const auto& [name, hash] : state.blobs())
    if (!IsOfAMiddleStart(name, starts)) real.inputs[name] = store.at(hash);
  if (!done.empty()) real.inputs[kLastPartial] = done.back();
  if (done.size() > 1) real.inputs[kFirstPartial] = done.front();
  return real;
}

void AdvanceAsHanded(const Pipeline& pipeline, const proto::State& state, MapInputs inputs,
                     std::vector<BlobPtr> done, const Handed& handed) {
  const int starts = StartsIn(state);
  proto::State changed = state;
  for (const auto& [name, value] : state.scalars())
    if (!IsOfAMiddleStart(name, starts)) changed.mutable_scalars()->erase(name);
  for (const auto& [name, value] : handed.params) (*changed.mutable_scalars())[name] = value;
  for (const auto& [name, blob] : handed.inputs) inputs.Put(name, blob);
  if (!done.empty()) done.back() = handed.inputs.at(kLastPartial);
  if (done.size() > 1) done.front() = handed.inputs.at(kFirstPartial);
  VectorPartials partials(std::move(done));
  (void)pipeline.Advance(changed, partials, inputs);
}

// A round of more candidates is of the same kind as one of fewer.
std::string KindOf(const proto::Step& plan, const InputMap& inputs) {
  const proto::State& state = plan.state();
  const std::string last = "start/" + std::to_string(StartsIn(state) - 1) + "/";
  std::string kind = "advance";
  for (const auto& [name, blob] : inputs)
    kind += " " + (name.starts_with(last) ? "last/" + name.substr(last.size()) : name);
  const auto phase = state.scalars().find("phase");
  if (phase != state.scalars().end()) kind += " " + phase->second.ShortDebugString();
  std::set<std::string> tasks;
  for (const Task& task : plan.tasks())
    if (tasks.insert(task.kind()).second) kind += " " + task.kind();
  return kind;
}

class HostilePlans : public ::testing::TestWithParam<Case> {};

TEST_P(HostilePlans, AStepIsComputedOrFailsAndItsProcessLivesOn) {
  const Case& c = GetParam();
  const auto pipeline = Make(c.stage, c.seed);
  std::set<std::string> seen;  // kinds of tasks and of states, by all that they are handed
  Tried tried;
  NoProgress progress;
  BlobsByHash store;
  for (const auto& [name, blob] : c.inputs) store[blob->ContentHash().Binary()] = blob;
  Step step = pipeline->Start(MapInputs(c.inputs));
  while (true) {
    for (const BlobPtr& blob : step.blobs) store[blob->ContentHash().Binary()] = blob;
    if (!step.plan.result().empty()) return;
    std::vector<BlobPtr> done;
    for (const Task& task : step.plan.tasks()) {
      Handed real{{task.params().begin(), task.params().end()}, {}};
      for (const proto::InputRef& ref : task.inputs()) real.inputs[ref.name()] = InputOf(ref, store, done);
      if (seen.insert(task.kind() + NamesIn(real.inputs)).second) {
        tried.All("task " + task.kind(), real, [&](const Handed& handed, Progress& ticks) {
          Task changed = task;
          changed.mutable_params()->clear();
          changed.mutable_params()->insert(handed.params.begin(), handed.params.end());
          Make(c.stage, c.seed)->Run(changed, MapInputs(handed.inputs), ticks);
        });
      }
      done.push_back(std::make_shared<const Blob>(pipeline->Run(task, MapInputs(real.inputs), progress)));
    }
    const proto::State& state = step.plan.state();
    const MapInputs inputs = InputsOfRound(state, store, c.inputs);
    const Handed real = HandedOn(state, store, done);
    if (seen.insert(KindOf(step.plan, real.inputs)).second) {
      tried.All("advance", real, [&](const Handed& handed, Progress&) {
        AdvanceAsHanded(*Make(c.stage, c.seed), state, inputs, done, handed);
      });
    }
    VectorPartials partials(std::move(done));
    step = pipeline->Advance(state, partials, inputs);
  }
}

// Of a pipeline's cases those that have tasks, or arrays, which the others have not.
std::vector<Case> CasesOfAllTasks() {
  std::vector<Case> cases = AllCases();
  std::erase_if(cases, [](const Case& c) {
    for (const char* alike : {"landmark_map_side_by_side", "forward_map_one_tile", "landmark_learning_global",
                              "landmark_learning_starts", "landmark_learning_deep",
                              "landmark_learning_momentum", "localization_samples", "localization_grid"})
      if (c.name == alike) return true;
    return false;
  });
  return cases;
}

INSTANTIATE_TEST_SUITE_P(All, HostilePlans, ::testing::ValuesIn(CasesOfAllTasks()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace cairn::conformance
