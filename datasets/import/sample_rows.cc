#include "datasets/import/sample_rows.h"

#include <cmath>
#include <limits>
#include <string>

#include "datasets/common/unit_doubts.h"
#include "datasets/import/row_times.h"
#include "schema/error.h"

namespace cairn::datasets {

std::optional<SampleRow> ReadSampleRow(const SampleColumns& columns, const SampleRun& run,
                                       CsvReader* reader) {
  const auto after = [&](std::optional<double> good, std::optional<std::size_t> column) {
    return good && column ? reader->Number(*column) : good;
  };
  const auto time = reader->Number(columns.time), x = after(time, columns.x), y = after(x, columns.y),
             heading = after(y, columns.heading), turn = after(heading, columns.turn),
             forward = after(turn, columns.forward), left = after(forward, columns.left);
  if (!left) return std::nullopt;
  if (!run.time_s.empty() && !InTimeOrder(*time, run.time_s.back(), columns.time, std::nullopt, "", reader))
    return std::nullopt;
  SampleRow row{*time, *x, *y, *heading, {}};
  if (columns.turn) row.turn_rad = *turn;
  if (columns.forward) row.forward_m = *forward;
  if (columns.left) row.left_m = *left;
  for (const std::size_t column : columns.input) {
    const std::optional<double> value = reader->Number(column);
    if (!value) return std::nullopt;
    if (std::abs(*value) > std::numeric_limits<float>::max()) {
      reader->Bad("too large for 32 bits", std::string(reader->Text(column)));
      return std::nullopt;
    }
    row.input.push_back(static_cast<float>(*value));
  }
  return row;
}

void AddSampleRow(const SampleRow& row, bool with_heading, SampleRun* run) {
  run->time_s.push_back(row.time_s);
  run->x_m.push_back(row.x_m);
  run->y_m.push_back(row.y_m);
  if (with_heading) run->heading_rad.push_back(row.heading_rad);
  run->input.insert(run->input.end(), row.input.begin(), row.input.end());
}

void AddOdometryRow(const SampleRow& row, SampleRun* run) {
  run->turn_rad.push_back(row.turn_rad);
  run->forward_m.push_back(row.forward_m);
  run->left_m.push_back(row.left_m);
}

void CheckRun(const std::string& file, std::int64_t last_line, SampleRun* checked, ImportReport* report) {
  SampleRun& run = *checked;
  const std::size_t samples = run.time_s.size();
  if (samples < 2) {
    const std::string line = last_line > 0 ? ":" + std::to_string(last_line) : "";
    throw InputError(file + line + ": a run has two samples or more; '" + run.name + "' has " +
                     (samples == 0 ? "none" : "one"));
  }
  const std::string who = file + ": run '" + run.name + "'";
  if (const auto doubt = DoubtPoses(run.time_s, run.x_m, run.y_m, run.heading_rad))
    report->unit_doubts.push_back(DoubtText("", who, "samples", *doubt));
  if (const auto doubt = DoubtControls(run.time_s, run.turn_rad, run.forward_m))
    report->unit_doubts.push_back(DoubtText("", who, "odometry", *doubt));
  for (double& heading : run.heading_rad) heading = NormalizedAngle(heading);
  const std::int64_t repeated = CountRepeatedPoses(run);
  if (repeated == 0) return;
  report->warnings.push_back("run '" + run.name + "': " + std::to_string(repeated) + " of " +
                             std::to_string(samples) + " samples repeat the pose of an earlier one");
}

}  // namespace cairn::datasets
