#include "datasets/import_vectors.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "datasets/csv_reader.h"
#include "datasets/samples.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

const std::vector<std::string> kPose{"time_s", "x_m", "y_m"};
const std::vector<std::string> kPoseAndHeading{"time_s", "x_m", "y_m", "heading_rad"};

std::string RunName(const std::string& path) {
  std::string name = std::filesystem::path(path).filename().string();
  for (const char* ending : {".gz", ".csv"}) {
    if (name.ends_with(ending) && name != ending) name.resize(name.size() - std::string_view(ending).size());
  }
  return name;
}

class VectorsImport {
 public:
  explicit VectorsImport(const VectorsImportOptions& options) : options_(options), bad_(options.skip_bad) {}

  ImportReport Run(Blob* samples) {
    if (options_.runs.empty()) throw InputError("import vectors needs a file");
    for (const std::string& path : options_.runs) ReadRun(path);
    report_.skipped = bad_.counts();
    *samples = MakeSamples(samples_);
    return report_;
  }

 private:
  void ReadRun(const std::string& path) {
    SampleRun run;
    run.name = RunName(path);
    for (std::size_t n = 0; n < samples_.runs.size(); ++n) {
      if (samples_.runs[n].name == run.name)
        throw InputError(path + ": its run is called '" + run.name + "', as that of " + options_.runs[n] +
                         "; runs are named after their files");
    }
    CsvReader reader(path, {kPoseAndHeading, kPose}, &bad_);
    const std::vector<std::size_t> columns = InputColumns(path, &reader);
    while (reader.Next()) ReadRow(columns, &reader, &run);
    if (run.time_s.size() < 2) {
      throw InputError(path + ":" + std::to_string(reader.line()) +
                       ": a run has two samples or more; this one has " +
                       (run.time_s.empty() ? "none" : "one"));
    }
    if (const std::int64_t repeated = CountRepeatedPoses(run); repeated > 0) {
      report_.warnings.push_back(path + ": " + std::to_string(repeated) + " of " +
                                 std::to_string(run.time_s.size()) +
                                 " samples repeat the pose of an earlier one");
    }
    samples_.runs.push_back(std::move(run));
  }

  // For each input, where the reader has it.
  std::vector<std::size_t> InputColumns(const std::string& path, CsvReader* reader) {
    reader->TakeExtraColumns();
    const std::vector<std::string>& names = reader->extra_columns();
    const bool has_heading = reader->header() == 0;
    if (samples_.runs.empty()) {
      if (names.empty())
        throw InputError(path + ":1: the header has no inputs: columns beside time_s, x_m, y_m, heading_rad");
      samples_.input_name = names;
      has_heading_ = has_heading;
    }
    if (has_heading && !has_heading_) RefuseColumn(path, "heading_rad", true);
    if (!has_heading && has_heading_) RefuseColumn(path, "heading_rad", false);
    for (const std::string& name : names) {
      if (std::ranges::count(samples_.input_name, name) == 0) RefuseColumn(path, name, true);
    }
    std::vector<std::size_t> columns;
    const std::size_t first = has_heading ? kPoseAndHeading.size() : kPose.size();
    for (const std::string& name : samples_.input_name) {
      const auto place = std::ranges::find(names, name);
      if (place == names.end()) RefuseColumn(path, name, false);
      columns.push_back(first + static_cast<std::size_t>(place - names.begin()));
    }
    return columns;
  }

  // `has`: this file has the column and the first one lacks it; else the other way round.
  [[noreturn]] void RefuseColumn(const std::string& path, const std::string& column, bool has) const {
    throw InputError(path + ":1: the header " + (has ? "has" : "lacks") + " column '" + column + "', which " +
                     options_.runs.front() + (has ? " lacks" : " has") + "; all runs have the same columns");
  }

  // Nothing is kept of a row that is bad.
  void ReadRow(const std::vector<std::size_t>& columns, CsvReader* reader, SampleRun* run) {
    const auto time = reader->Number(0), x = time ? reader->Number(1) : time, y = x ? reader->Number(2) : x,
               heading = y && has_heading_ ? reader->Number(3) : y;
    if (!heading) return;
    if (!run->time_s.empty() && *time < run->time_s.back()) {
      reader->Bad("time runs backwards",
                  std::to_string(*time) + " after " + std::to_string(run->time_s.back()));
      return;
    }
    row_.clear();
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const std::optional<double> value = reader->Number(columns[i]);
      if (!value) return;
      if (std::abs(*value) > std::numeric_limits<float>::max()) {
        reader->Bad("too large", samples_.input_name[i] + " is " + std::string(reader->Text(columns[i])));
        return;
      }
      row_.push_back(static_cast<float>(*value));
    }
    run->time_s.push_back(*time);
    run->x_m.push_back(*x);
    run->y_m.push_back(*y);
    if (has_heading_) run->heading_rad.push_back(NormalizedAngle(*heading));
    run->input.insert(run->input.end(), row_.begin(), row_.end());
  }

  const VectorsImportOptions& options_;
  BadLines bad_;
  ImportReport report_;
  Samples samples_;
  bool has_heading_ = false;
  std::vector<float> row_;
};

}  // namespace

ImportReport ImportVectors(const VectorsImportOptions& options, Blob* samples) {
  return VectorsImport(options).Run(samples);
}

}  // namespace cairn::datasets
