#include "datasets/reproduce/ball_study.h"

#include <cstdio>

#include "datasets/simulate_corridor.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

// Of eight features, and of a single one; chosen, as the recipe is, on seeds below 100.
constexpr double kTrustInTwo = 0.3, kTrustInOne = 1.0;

proto::Value Integer(std::int64_t i) {
  proto::Value value;
  value.set_i(i);
  return value;
}

proto::Value Real(double d) {
  proto::Value value;
  value.set_d(d);
  return value;
}

class JobMaker {
 public:
  JobMaker(const BallRecipe& recipe, proto::Job* job) : recipe_(recipe), job_(*job) {}

  void AddTraining(int networks, double window_m) {
    proto::Stage& stage = Add(BallStage(networks, window_m), "landmark_learning");
    (*stage.mutable_inputs())["samples"] = "training";
    for (const auto& [name, value] : recipe_) (*stage.mutable_options())[name] = value;
    (*stage.mutable_options())["networks"] = Integer(networks);
    (*stage.mutable_options())["window_m"] = Real(window_m);
  }
  proto::Stage& AddLocalization(const std::string& name) {
    proto::Stage& stage = Add(name, "localization");
    (*stage.mutable_inputs())["samples"] = "samples";
    return stage;
  }

 private:
  proto::Stage& Add(const std::string& name, const char* pipeline) {
    proto::Stage& stage = *job_.add_stages();
    stage.set_name(name);
    stage.set_pipeline(pipeline);
    return stage;
  }

  const BallRecipe& recipe_;
  proto::Job& job_;
};

void AddStages(const BallRecipe& recipe, BallJob* ball) {
  JobMaker make(recipe, &ball->job);
  for (const double window_m : BallWindows()) make.AddTraining(1, window_m);
  for (int networks = 2; networks <= kMostBallNetworks; ++networks) make.AddTraining(networks, kBallWindowM);
  for (const double window_m : {5.0, 10.0}) make.AddTraining(kMostBallNetworks, window_m);
  (*make.AddLocalization("locate").mutable_inputs())["networks"] = BallStage(kMostBallNetworks, kBallWindowM);
  proto::Stage& two = make.AddLocalization("locate_two");
  (*two.mutable_inputs())["networks"] = BallStage(kMostBallNetworks, 5);
  (*two.mutable_inputs())["networks_2"] = BallStage(kMostBallNetworks, 10);
  (*two.mutable_options())["trust"] = Real(kTrustInTwo);
  for (const bool perfect : {false, true}) {
    auto& options = *make.AddLocalization(perfect ? "locate_perfect" : "locate_detected").mutable_options();
    options["runs"].set_s(ball->held_out);
    options["trust"] = Real(kTrustInOne);
    options["features"].set_s(perfect ? PerfectFeature(ball->set) : DetectedFeature(ball->set));
  }
}

}  // namespace

BallRecipe DefaultBallRecipe(std::int64_t steps) {
  return {{"steps", Integer(steps)}, {"rate", Real(0.02)}, {"weight_decay", Real(0.01)}};
}

std::string BallStage(int networks, double window_m) {
  char text[40];
  std::snprintf(text, sizeof text, "n%d_w%g", networks, window_m);
  return text;
}

std::string PerfectFeature(const std::string& set) { return set == "d3" ? "light" : "door"; }

std::string DetectedFeature(const std::string& set) { return PerfectFeature(set) + " detected"; }

Blob WithoutRun(const Blob& samples, const std::string& run) {
  Blob rest = samples.Without("truth/").Without("run/");
  std::vector<std::string> names;
  const std::vector<std::string> all = samples.Texts("runs");
  for (std::size_t r = 0; r < all.size(); ++r) {
    if (all[r] == run) continue;
    rest.PutAll("run/" + std::to_string(names.size()) + "/", samples.Sub("run/" + std::to_string(r) + "/"));
    names.push_back(all[r]);
  }
  CAIRN_DEMAND(names.size() + 1 == all.size(), "one run is left out");
  rest.Put("runs", Array::Texts(names));
  return rest;
}

BallJob MakeBallJob(const std::string& set, std::uint64_t seed, const BallRecipe& recipe) {
  BallJob ball{.name = set + "_" + std::to_string(seed),
               .set = set,
               .seed = seed,
               .held_out = {},
               .samples = SimulateCorridor({.set = set, .seed = seed}),
               .training = {},
               .job = {}};
  const std::vector<std::string> runs = ball.samples.Texts("runs");
  ball.held_out = runs[seed % runs.size()];
  ball.training = WithoutRun(ball.samples, ball.held_out);
  ball.job.set_name("reproduce-ball-" + ball.name);
  ball.job.set_seed(seed);
  AddStages(recipe, &ball);
  (*ball.job.mutable_inputs())["samples"] = "inputs/" + ball.name + ".h5";
  (*ball.job.mutable_inputs())["training"] = "inputs/" + ball.name + "_training.h5";
  return ball;
}

}  // namespace cairn::datasets
