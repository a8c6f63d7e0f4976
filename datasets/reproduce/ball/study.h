// What `cairn-reproduce ball` runs: the corridors, trainings and localisations behind the tables and figures
// of [Thr98] on simulated data. A job is one simulated set: three of its runs are trained on, the fourth is
// tested on.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/job.pb.h"

namespace cairn::datasets {

// How networks are trained: options of landmark_learning beyond `networks` and `window_m`.
using BallRecipe = std::map<std::string, proto::Value>;

proto::Value IntegerValue(std::int64_t i);
proto::Value RealValue(double d);

// Adam, rate and weight decay as chosen on seeds below 100: what studies compare variants of.
BallRecipe DefaultBallRecipe(std::int64_t steps = 500);

// With noise on the inputs and wider first weights, as chosen on seeds below 100: for the paper's table and
// figures.
BallRecipe PaperBallRecipe(std::int64_t steps = 500);

struct BallJob {
  std::string name;  // "d1_101"
  std::string set;
  std::uint64_t seed = 0;
  std::string held_out;                // the run that nothing was trained on: another one from seed to seed
  std::map<std::string, Blob> inputs;  // `samples`: of all runs, with truth; others without truth
  proto::Job job;                      // its inputs by these names

  const Blob& samples() const { return inputs.at("samples"); }
};

inline const std::vector<double>&
BallWindows() {  // half-widths, m; the last is global: the corridor's length
  static const std::vector<double> windows = {1, 2, 5, 10, 50, 89};
  return windows;
}
inline constexpr int kMostBallNetworks = 4;
inline constexpr double kBallWindowM = 2;  // for which several networks are trained

// "n4_w2", the stage that trains so many networks for a window.
std::string BallStage(int networks, double window_m);

// The hand-made feature of a set ("door", "light") and what a detector says of it ("door detected").
std::string PerfectFeature(const std::string& set);
std::string DetectedFeature(const std::string& set);

// The set's samples, and one run of them held out: of other runs than that, `training`. No stages yet.
BallJob BareBallJob(const std::string& study, const std::string& set, std::uint64_t seed);

// A stage that trains: options of the recipe, then those given here.
void AddTraining(const std::string& stage, const std::string& training, const BallRecipe& recipe,
                 const BallRecipe& options, proto::Job* job);

// Adds a blob as an input.
void AddInput(const std::string& name, Blob blob, BallJob* ball);

// Trainings of one network for each window, of up to four for +-2 m, and of four for +-5, +-10 and +-89 m.
// Then 35 robots that know nothing at the start: "locate" by the four for +-2 m, as in the paper,
// "locate_three" by the twelve others together, "locate_detected" and "locate_perfect" by doors or lights. Of
// the same seed all sets are of one corridor.
BallJob MakeBallJob(const std::string& set, std::uint64_t seed, const BallRecipe& recipe);

// The samples of other runs than `run`, truth left out.
Blob WithoutRun(const Blob& samples, const std::string& run);

}  // namespace cairn::datasets
