// Which robot comes first, where several see landmarks at a distance that have no names: the others are
// placed in its map, and where that is wrong they do not put it right. So both of two are tried, one after
// the other, and the likelier map of all is kept: their order in the log does not decide.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pipelines/landmark_map/state/options.h"
#include "pipelines/landmark_map/state/settings.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_map {

// The robots that are tried, as many as `first_robots` says (0: both of two, of more the log's first): those
// that looked at most from different frames, of equals those that came the shorter way. The log's first
// alone, too, where there is nothing to choose: landmarks that have names, contact detections, a given map,
// EM that starts once.
std::vector<std::size_t> FirstRobots(const Options& options, const Inputs& inputs);

// The stage's inputs, in whose log one robot comes before the others. Refers to `inputs`.
class LedBy : public Inputs {
 public:
  LedBy(std::size_t first, const Inputs& inputs);
  bool Has(const std::string& name) const override { return inputs_.Has(name); }
  BlobPtr Get(const std::string& name) const override { return name == "log" ? log_ : inputs_.Get(name); }

 private:
  const Inputs& inputs_;
  BlobPtr log_;
};

// The robots of a result that was made so, in the log's order again.
Blob InOrderOf(const Blob& log, std::size_t first, const Blob& result);

// What came of each robot as the first; a State carries them from round to round.
class FirstRobotTrials {
 public:
  explicit FirstRobotTrials(const std::vector<std::size_t>& robots);
  // None where the State tries none. Throws InputError where it cannot be one's: others made it.
  static std::optional<FirstRobotTrials> Load(const State& state, std::size_t robots);
  // Into a step of the one that is tried now. Its tasks say that they are a trial's.
  void Store(cairn::Step* step) const;

  std::size_t robot() const { return trials_[now_].robot; }
  std::size_t count() const { return trials_.size(); }
  // What a step of the first round expects of a trial, for those that are to come.
  void Expect(const proto::Step& plan);

  // The one that is tried now has ended; `log`, `result`: in the log's order.
  void Ended(Blob result, const Settings& settings, cairn::Step* step);
  void Failed(const std::string& why, const Blob& log);
  // Of a round of the one that is tried now.
  std::string Note(const Blob& log, const std::string& of_round) const;
  // Goes on with the next one; false: all have been tried.
  bool Next();
  // The likeliest map. `inputs`, `step`: hold the results that there are. Throws InputError, of the robot
  // that comes first in the log, where all failed.
  Blob Best(const Blob& log, const Inputs& inputs, const cairn::Step& step) const;

 private:
  struct Trial {
    std::size_t robot = 0;
    std::string failure;      // why it has no map
    std::string result = {};  // hash; empty: none yet
    double score_nats = 0.0;  // as ScoreOf has it, of all robots' map
  };
  FirstRobotTrials() = default;

  std::vector<Trial> trials_;
  std::size_t now_ = 0;
  double rounds_ = 0.0, cost_ = 0.0;  // of a trial
  double alike_ = 0.0;                // maps that say the same of so many observations are one
};

// Whether a task is a trial's: that no path fits is then the trial's affair.
bool IsOfTrial(const Task& task);

}  // namespace cairn::landmark_map
