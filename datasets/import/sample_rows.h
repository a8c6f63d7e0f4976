// What the importers of samples have in common: a row of a table with a pose, and inputs beside it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/common/samples.h"
#include "datasets/import/csv_reader.h"
#include "datasets/import/log_rows.h"

namespace cairn::datasets {

// Where a reader has them. Without x and y the pose comes from elsewhere.
struct SampleColumns {
  std::size_t time = 0;
  std::optional<std::size_t> x, y, heading;
  std::vector<std::size_t> input;
  // Of odometry; without a left it goes straight ahead.
  std::optional<std::size_t> turn = {}, forward = {}, left = {};
};

struct SampleRow {
  double time_s = 0, x_m = 0, y_m = 0, heading_rad = 0;
  std::vector<float> input;
  double turn_rad = 0, forward_m = 0, left_m = 0;
};

// The reader's row, to stand in `run` after those that it has; nothing where it is bad: a number that is
// none, not finite or too large for 32 bits, a time that runs backwards.
std::optional<SampleRow> ReadSampleRow(const SampleColumns& columns, const SampleRun& run, CsvReader* reader);

void AddSampleRow(const SampleRow& row, bool with_heading, SampleRun* run);
void AddOdometryRow(const SampleRow& row, SampleRun* run);

// Puts headings within a turn; warns of samples that repeat a pose, and doubts the units of moves that no
// robot makes.
// `last_line`: of the run in its file; 0: it has none. Throws InputError "FILE:LINE: REASON" for a run of
// less than two samples.
void CheckRun(const std::string& file, std::int64_t last_line, SampleRun* run, ImportReport* report);

}  // namespace cairn::datasets
