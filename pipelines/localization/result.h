// What localisation ends with: a file of kind `localization` (schema/FORMAT.md), and the rows of it that a
// task makes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipelines/localization/traverse.h"
#include "schema/blob.h"

namespace cairn::localization {

class ResultRows {
 public:
  void Add(std::size_t number, const Source& source, const Traverse& traverse, const Localized& localized);
  // The rows of a later task.
  void Append(const Blob& rows);

  Blob ToBlob() const;
  // How sure the robot is at the start and at the end of its traverses, for people.
  std::string Note() const;

 private:
  template <class S, class F>
  static void Visit(S& rows, const F& f);

  std::vector<std::int32_t> traverse_, run_, sample_;  // of each step
  std::vector<double> travelled_m_, mean_x_m_, mean_y_m_, mode_x_m_, mode_y_m_, spread_m_, off_label_m_,
      lead_nats_, expected_lead_nats_;
  std::vector<std::int64_t> entries_;   // of each step's belief
  std::vector<std::int32_t> position_;  // of each entry
  std::vector<float> probability_;
};

Blob ResultOf(const Options& options, const Source& source, const Poses& poses, const ResultRows& rows);

}  // namespace cairn::localization
