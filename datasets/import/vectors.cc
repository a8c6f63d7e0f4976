#include "datasets/import/vectors.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <optional>

#include "datasets/import/csv_reader.h"
#include "datasets/import/sample_rows.h"
#include "schema/error.h"
#include "schema/kinds/inputs_of_time.h"
#include "schema/text.h"

namespace cairn::datasets {
namespace {

const std::vector<std::string> kPose{"time_s", "x_m", "y_m"};
const std::vector<std::string> kPoseAndHeading{"time_s", "x_m", "y_m", "heading_rad"};

constexpr const char* kTurn = "odometry_turn_rad";
constexpr const char* kForward = "odometry_forward_m";
constexpr const char* kLeft = "odometry_left_m";

bool IsOdometry(const std::string& column) {
  return column == kTurn || column == kForward || column == kLeft;
}

// A name that means odometry and is none that is read: of another unit, or other letters.
bool IsLikeOdometry(std::string column) {
  for (char& c : column) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return column.starts_with("odometry_");
}

std::int64_t Total(const std::map<std::string, std::int64_t>& counts) {
  std::int64_t total = 0;
  for (const auto& [reason, count] : counts) total += count;
  return total;
}

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
    for (std::string& doubt : InputsOfTimeOf(*samples)) report_.warnings.push_back(std::move(doubt));
    return report_;
  }

 private:
  void ReadRun(const std::string& path) {
    SampleRun run;
    run.name = RunName(path);
    if (const std::string wrong = WhatIsWrongWithName(run.name); !wrong.empty())
      throw InputError(Escaped(path) + ": its run is named after it, with a name that " + wrong);
    for (std::size_t n = 0; n < samples_.runs.size(); ++n) {
      if (samples_.runs[n].name == run.name)
        throw InputError(path + ": its run is called '" + run.name + "', as that of " + options_.runs[n] +
                         "; runs are named after their files");
    }
    CsvReader reader(path, {kPoseAndHeading, kPose}, &bad_);
    SampleColumns columns;
    columns.x = 1;
    columns.y = 2;
    columns.input = InputColumns(&reader);
    if (has_heading_) columns.heading = 3;
    FindOdometry(reader, &columns);
    const std::int64_t bad_before = Total(bad_.counts());
    while (reader.Next()) {
      const auto row = ReadSampleRow(columns, run, &reader);
      if (!row) continue;
      AddSampleRow(*row, has_heading_, &run);
      if (columns.turn) AddOdometryRow(*row, &run);
    }
    if (columns.turn && Total(bad_.counts()) > bad_before)
      throw InputError(path + ": has odometry, in which skipped lines leave a gap");
    CheckRun(path, reader.line(), &run, &report_);
    samples_.runs.push_back(std::move(run));
  }

  // Where it stands, behind the pose.
  void FindOdometry(const CsvReader& reader, SampleColumns* columns) const {
    const std::vector<std::string>& names = reader.extra_columns();
    const auto column = [&](const char* name) -> std::optional<std::size_t> {
      const auto place = std::ranges::find(names, name);
      if (place == names.end()) return std::nullopt;
      return (has_heading_ ? kPoseAndHeading.size() : kPose.size()) +
             static_cast<std::size_t>(place - names.begin());
    };
    columns->turn = column(kTurn);
    columns->forward = column(kForward);
    columns->left = column(kLeft);
    if (columns->turn.has_value() != columns->forward.has_value() || (columns->left && !columns->turn))
      throw InputError(reader.Place() + "the header has some odometry; it takes " + kTurn + " and " +
                       kForward + ", and may have " + kLeft);
  }

  // For each input, where the reader has it.
  std::vector<std::size_t> InputColumns(CsvReader* reader) {
    reader->TakeExtraColumns();
    const std::vector<std::string>& names = reader->extra_columns();
    std::vector<std::string> inputs;
    for (const std::string& name : names) {
      if (IsOdometry(name)) continue;
      if (IsLikeOdometry(name))
        throw InputError(reader->Place() + "column '" + name + "' is no input of a network; odometry is " +
                         kTurn + ", " + kForward + " and " + kLeft + ", in these units and letters");
      inputs.push_back(name);
    }
    const bool has_heading = reader->header() == 0;
    if (samples_.runs.empty()) {
      if (inputs.empty())
        throw InputError(reader->Place() +
                         "the header has no inputs: columns beside time_s, x_m, y_m, heading_rad");
      samples_.input_name = inputs;
      has_heading_ = has_heading;
    }
    if (has_heading && !has_heading_) ThrowColumnMismatch(reader->Place(), "heading_rad", true);
    if (!has_heading && has_heading_) ThrowColumnMismatch(reader->Place(), "heading_rad", false);
    const auto known = PlacesOf(samples_.input_name), places = PlacesOf(names);
    for (const std::string& name : inputs) {
      if (!known.contains(name)) ThrowColumnMismatch(reader->Place(), name, true);
    }
    std::vector<std::size_t> columns;
    const std::size_t first = has_heading ? kPoseAndHeading.size() : kPose.size();
    for (const std::string& name : samples_.input_name) {
      const auto place = places.find(name);
      if (place == places.end()) ThrowColumnMismatch(reader->Place(), name, false);
      columns.push_back(first + place->second);
    }
    return columns;
  }

  // `has`: this file has the column and the first one lacks it; else the other way round.
  [[noreturn]] void ThrowColumnMismatch(const std::string& place, const std::string& column, bool has) const {
    throw InputError(place + "the header " + (has ? "has" : "lacks") + " column '" + column + "', which " +
                     options_.runs.front() + (has ? " lacks" : " has") + "; all runs have the same columns");
  }

  const VectorsImportOptions& options_;
  BadLines bad_;
  ImportReport report_;
  Samples samples_;
  bool has_heading_ = false;
};

}  // namespace

ImportReport ImportVectors(const VectorsImportOptions& options, Blob* samples) {
  return VectorsImport(options).Run(samples);
}

}  // namespace cairn::datasets
