// What each step of a run left behind. A run may take a million steps, and a State travels with every round:
// it names blocks of rows, each a blob, and only the last few rows travel with it.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "pipelines/pipeline.h"
#include "schema/kinds/fields.h"

namespace cairn::landmark_learning {

inline constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// A column an array, all of one length.
struct HistoryRows {
  std::vector<double> error;       // E_posterior before the step
  std::vector<double> validation;  // the same of the held-out run; NaN where it was not looked at
  std::vector<double> norm;        // of the gradient

  std::size_t size() const { return error.size(); }
  void Append(const HistoryRows& more);
  static void Fields(const auto& field) {
    field("error", &HistoryRows::error);
    field("validation", &HistoryRows::validation);
    field("norm", &HistoryRows::norm);
  }
};

class History {
 public:
  static constexpr std::size_t kTail = 128;  // rows that travel; a block has 2^i times as many

  void Add(double error, double validation, double norm);
  double last_error() const { return tail_.error.back(); }  // these three: right after Add
  double last_validation() const { return tail_.validation.back(); }
  double last_norm() const { return tail_.norm.back(); }

  // Names the blocks in `step`'s State as history/0, history/1, …, a new one made of the tail where it is
  // full. Two blocks of one length are made one, so that S steps are in log2(S / kTail) + 1 blocks at most
  // and each row is copied as often. `before` and `inputs`: of the Advance that adds the rows.
  void Share(const State& before, const Inputs& inputs, Step* step);
  // From the first step on.
  HistoryRows All(const Inputs& inputs) const;

  static void Fields(const auto& field) {
    field("blocks", &History::blocks_);
    field("tail", &History::tail_);
  }

 private:
  std::vector<std::int64_t> blocks_;  // the length of each
  HistoryRows tail_;
};

}  // namespace cairn::landmark_learning
