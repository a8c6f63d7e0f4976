#include "worker/testing/toy_pipeline.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "schema/blob_part.h"
#include "schema/rng.h"

namespace cairn::testing {
namespace {

struct Options {
  std::int64_t rounds = 3;
  std::int64_t slices = 5;
  std::int64_t padding = 0;
};

template <class V>
void VisitOptions(V& visit, Options& o) {
  visit(Option{"rounds", "", 1, 1e6, "how often the tasks run", {}}, o.rounds);
  visit(Option{"slices", "", 1, 1e6, "tasks that read rows of the data; one more combines them", {}},
        o.slices);
  visit(Option{"padding", "", 0, 1e9, "values that each partial carries along", {}}, o.padding);
}

class Toy : public Pipeline {
 public:
  Toy(const Options& options, std::uint64_t seed) : options_(options), seed_(seed) {}

  Step Start(const Inputs& inputs) const override {
    const BlobPtr log = inputs.Get("log");
    const auto forward = log->Get<double>("robot/0/odometry/forward_m");
    if (forward.empty()) throw InputError("the log has no odometry");
    Step step;
    Blob data;
    data.PutVector<double>("values", {forward.begin(), forward.end()});
    (*step.plan.mutable_state()->mutable_blobs())["data"] = step.Share(std::move(data));
    PlanRound(0, 1.0, static_cast<std::int64_t>(forward.size()), step);
    return step;
  }

  Blob Run(const Task& task, const Inputs& inputs, Progress& progress) const override {
    Blob partial;
    double sum = 0;
    if (task.kind() == "slice") {
      Rng rng(seed_, static_cast<std::uint64_t>(task.params().at("round").i()), task.index());
      const double scale = task.params().at("scale").d();
      for (const double value : inputs.Get("data")->Get<double>("values")) {
        progress.Tick();
        sum += std::sin(value * scale) + 1e-3 * rng.Normal();
      }
    } else {  // a and b are partials of this round
      if (task.kind() != "combine") throw InputError("a task of the kind '" + task.kind() + "'");
      sum = std::tanh(inputs.Get("a")->Scalar<double>("sum")) - 0.5 * inputs.Get("b")->Scalar<double>("sum");
    }
    partial.PutScalar("sum", sum);
    if (options_.padding > 0) {
      partial.PutVector("padding", std::vector<double>(static_cast<std::size_t>(options_.padding), sum));
    }
    return partial;
  }

  Step Advance(const State& state, Partials& partials, const Inputs& inputs) const override {
    double total = 0;
    for (std::size_t i = 0; i < partials.size(); ++i) {
      total = 0.75 * total + partials.Get(i)->Scalar<double>("sum");  // another order gives another value
    }
    std::vector<double> history;
    if (inputs.Has("history")) {
      const auto before = inputs.Get("history")->Get<double>("total");
      history.assign(before.begin(), before.end());
    }
    history.push_back(total);
    Step step;
    Blob blob;
    blob.PutVector("total", history);
    const std::int64_t round = state.scalars().at("round").i() + 1;
    const std::string hash = step.Share(std::move(blob));
    if (round == options_.rounds) {
      step.plan.set_result(hash);
      return step;
    }
    (*step.plan.mutable_state()->mutable_blobs())["history"] = hash;
    (*step.plan.mutable_state()->mutable_blobs())["data"] = state.blobs().at("data");
    PlanRound(round, 1 + std::tanh(total), state.scalars().at("rows").i(), step);
    return step;
  }

 private:
  void PlanRound(std::int64_t round, double scale, std::int64_t rows, Step& step) const {
    if (rows < 1 || rows > 1'000'000'000) throw InputError("a state of this pipeline has other rows");
    auto& scalars = *step.plan.mutable_state()->mutable_scalars();
    scalars["round"].set_i(round);
    scalars["rows"].set_i(rows);
    step.plan.set_note("round " + std::to_string(round));
    const double later = static_cast<double>(options_.rounds - round - 1);
    ExpectRounds(later, later * static_cast<double>(rows), 0, &step.plan);
    const std::int64_t slices = std::min(options_.slices, rows);
    for (std::int64_t i = 0; i < slices; ++i)
      AddSlice(round, scale, rows * i / slices, rows * (i + 1) / slices, step);
    for (std::int64_t i = 0; i + 1 < slices; i += 2) AddCombine(static_cast<std::uint32_t>(i), step);
  }

  static void AddSlice(std::int64_t round, double scale, std::int64_t begin, std::int64_t end, Step& step) {
    Task& task = *step.plan.add_tasks();
    task.set_index(static_cast<std::uint32_t>(step.plan.tasks_size() - 1));
    task.set_kind("slice");
    (*task.mutable_params())["round"].set_i(round);
    (*task.mutable_params())["scale"].set_d(scale);
    task.set_cost(static_cast<std::uint64_t>(end - begin));
    proto::InputRef& data = *task.add_inputs();
    data.set_name("data");
    data.set_blob(step.plan.state().blobs().at("data"));
    if (task.index() % 2 == 0) {  // either way
      *data.mutable_part() = RowsPart("values", begin, end - begin);
      return;
    }
    data.set_first_row(begin);
    data.set_row_count(end - begin);
  }

  static void AddCombine(std::uint32_t first, Step& step) {
    Task& task = *step.plan.add_tasks();
    task.set_index(static_cast<std::uint32_t>(step.plan.tasks_size() - 1));
    task.set_kind("combine");
    task.set_cost(1);
    for (const std::uint32_t i : {0u, 1u}) {
      proto::InputRef& input = *task.add_inputs();
      input.set_name(i == 0 ? "a" : "b");
      input.set_task(first + i);
    }
  }

  const Options options_;
  const std::uint64_t seed_;
};

}  // namespace

PipelineInfo ToyInfo() {
  return {"toy", "sums that depend on their order", {"log"}, DescribeOptions<Options>()};
}

std::unique_ptr<const Pipeline> MakeToy(const proto::Stage& stage, std::uint64_t seed) {
  if (stage.pipeline() != "toy") throw InputError("there is no pipeline '" + stage.pipeline() + "'");
  return std::make_unique<Toy>(ParseOptions<Options>(stage.options()), seed);
}

Blob ToyLog(int controls) {
  Rng rng(11);
  std::vector<double> time_s, turn_rad, forward_m;
  for (int i = 0; i < controls; ++i) {
    time_s.push_back(i);
    turn_rad.push_back(0.1 * rng.Normal());
    forward_m.push_back(rng.Uniform(0, 2));
  }
  Blob log;
  log.Put("robots", Array::Texts({"toy"}));
  log.PutVector("robot/0/odometry/time_s", time_s);
  log.PutVector("robot/0/odometry/turn_rad", turn_rad);
  log.PutVector("robot/0/odometry/forward_m", forward_m);
  for (const char* name : {"time_s", "x_m", "y_m", "heading_rad"})
    log.PutVector(std::string("truth/robot/0/poses/") + name, time_s);
  return log;
}

}  // namespace cairn::testing
