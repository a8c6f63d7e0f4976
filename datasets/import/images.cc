#include "datasets/import/images.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <map>
#include <set>
#include <span>

#include "datasets/import/name_index.h"
#include "datasets/import/pose_track.h"
#include "datasets/import/sample_rows.h"
#include "datasets/import/timed_inputs.h"
#include "schema/error.h"
#include "schema/kinds/inputs_of_time.h"
#include "schema/text.h"

namespace cairn::datasets {
namespace {

namespace fs = std::filesystem;

const std::vector<std::vector<std::string>> kPoses = {{"image", "time_s", "x_m", "y_m", "heading_rad", "run"},
                                                      {"image", "time_s", "x_m", "y_m", "heading_rad"},
                                                      {"image", "time_s", "x_m", "y_m", "run"},
                                                      {"image", "time_s", "x_m", "y_m"}};
const std::vector<std::vector<std::string>> kTimes = {{"image", "time_s", "run"}, {"image", "time_s"}};

bool IsImage(const fs::path& path) {
  std::string ending = path.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending == ".png" || ending == ".jpg" || ending == ".jpeg" || ending == ".ppm";
}

class ImagesImport {
 public:
  ImagesImport(const ImagesImportOptions& options, const ImageReader& read)
      : options_(options), read_(read), bad_(options.skip_bad) {
    if (!fs::is_directory(options.folder)) throw InputError(options.folder + ": there is no such folder");
    folder_ = fs::canonical(options_.folder);
    folder_name_ = folder_.filename().string();
  }

  ImportReport Run(Blob* samples) {
    if (!options_.times.empty()) track_.emplace(options_.poses, options_.smooth_s, &bad_);
    if (!options_.ranges.empty()) ranges_.emplace(options_.ranges, &bad_);
    BadLines bad_before(options_.skip_bad);  // what is wrong with the table is said before images are read
    const std::set<std::string> named = ReadTable(nullptr, &bad_before);
    CountWithoutPose(named);
    const Readings readings = ReadImages(named);
    ReadTable(&readings, &bad_);
    for (SampleRun& run : samples_.runs) CheckRun(Table(), 0, &run, &report_);
    if (track_) report_.unit_doubts = track_->unit_doubts();
    if (samples_.runs.empty()) throw InputError(Table() + ": there are no samples in it");
    report_.skipped.insert(bad_.counts().begin(), bad_.counts().end());
    *samples = MakeSamples(samples_);
    for (std::string& doubt : InputsOfTimeOf(*samples)) report_.warnings.push_back(std::move(doubt));
    return report_;
  }

 private:
  using Readings = std::map<std::string, ImageReading>;  // by path

  const std::string& Table() const { return options_.times.empty() ? options_.poses : options_.times; }
  std::string PathOf(std::string_view image) const {
    return (fs::path(options_.folder) / image).lexically_normal().string();
  }

  // Whoever hands on a data set must not choose which of the next person's pictures go into the samples, be
  // it by a link.
  bool IsInFolder(const std::string& path) const {
    std::error_code error;
    const fs::path file = fs::canonical(path, error);
    return !error && std::ranges::mismatch(folder_, file).in1 == folder_.end();
  }

  // The paths that the table names. With `readings` its lines become samples of them; without they are only
  // checked.
  std::set<std::string> ReadTable(const Readings* readings, BadLines* bad) {
    CsvReader reader(Table(), track_ ? kTimes : kPoses, bad);
    const std::vector<std::string>& header = (track_ ? kTimes : kPoses)[reader.header()];
    const auto column = [&](std::string_view name) -> std::optional<std::size_t> {
      const auto found = std::ranges::find(header, name);
      if (found == header.end()) return std::nullopt;
      return static_cast<std::size_t>(found - header.begin());
    };
    if (const std::string wrong = WhatIsWrongWithName(folder_name_); !column("run") && !wrong.empty())
      throw InputError(Escaped(options_.folder) + ": the run is named after the folder, with a name that " +
                       wrong + "; a column 'run' of " + Table() + " names it otherwise");
    reader.TakeExtraColumns();
    SampleColumns columns{1, column("x_m"), column("y_m"), column("heading_rad"), {}};
    for (std::size_t i = 0; i < reader.extra_columns().size(); ++i)
      columns.input.push_back(header.size() + i);
    samples_ = {reader.extra_columns(), {}};
    if (ranges_) AddRangeNames();
    runs_ = NameIndex();
    std::set<std::string> named;
    while (reader.Next()) {
      named.insert(PathOf(reader.Text(0)));
      ReadRow(columns, column("run"), readings, &reader);
    }
    return named;
  }

  void AddRangeNames() {
    for (const std::string& name : ranges_->names()) {
      if (std::ranges::count(samples_.input_name, name) > 0)
        throw InputError(options_.ranges + ": column '" + name + "' is one of " + Table() + " too");
      samples_.input_name.push_back(name);
    }
  }

  void ReadRow(const SampleColumns& columns, std::optional<std::size_t> run_column, const Readings* readings,
               CsvReader* reader) {
    const std::string path = PathOf(reader->Text(0));
    const auto checked =
        run_column ? reader->Name(*run_column) : std::optional<std::string_view>(folder_name_);
    if (!checked) return;
    const std::string name(*checked);
    if (!fs::is_regular_file(path)) return reader->Bad("no such image", path);
    if (!IsInFolder(path)) return reader->Bad("image outside of the folder", path);
    if (name.empty()) return reader->Bad("run without a name", "the column is empty");
    const auto index = static_cast<std::size_t>(runs_.FindOrAdd(name));
    if (index == samples_.runs.size()) samples_.runs.emplace_back().name = name;
    SampleRun& run = samples_.runs[index];
    std::optional<SampleRow> row = ReadSampleRow(columns, run, reader);
    if (!row || !LookUp(name, &*row, reader)) return;
    if (readings != nullptr && !AddImage(path, readings->at(path), reader, &run)) return;
    AddSampleRow(*row, track_ ? track_->has_heading() : columns.heading.has_value(), &run);
  }

  // The pose and the ranges at the row's time.
  bool LookUp(const std::string& run, SampleRow* row, CsvReader* reader) const {
    const std::string when = std::to_string(row->time_s) + " s";
    if (track_) {
      const auto pose = track_->At(run, row->time_s, options_.most_gap_s);
      if (!pose) return reader->Bad("no pose at its time", "the track says nothing of " + when), false;
      row->x_m = pose->x_m;
      row->y_m = pose->y_m;
      row->heading_rad = pose->heading_rad;
    }
    if (ranges_) {
      const auto nearest = ranges_->Nearest(run, row->time_s, options_.most_gap_s);
      if (nearest.empty()) return reader->Bad("no ranges at its time", "none is near " + when), false;
      row->input.insert(row->input.end(), nearest.begin(), nearest.end());
    }
    return true;
  }

  void CheckBytes(std::size_t bytes) const {
    if (bytes > options_.most_image_bytes)
      throw InputError(Table() + ": its images take more than " + BytesText(options_.most_image_bytes) +
                       "; import them smaller, or some of the runs");
  }

  bool AddImage(const std::string& path, const ImageReading& image, CsvReader* reader, SampleRun* run) {
    if (!image.failure.empty()) return reader->Bad("bad image", path + ": " + image.failure), false;
    if (run->image.empty()) {
      run->image_rows = image.rows;
      run->image_columns = image.columns;
    }
    if (image.rows != run->image_rows || image.columns != run->image_columns) {
      reader->Bad("image of another size", path + ": " + std::to_string(image.rows) + " by " +
                                               std::to_string(image.columns) + ", the run's first " +
                                               std::to_string(run->image_rows) + " by " +
                                               std::to_string(run->image_columns));
      return false;
    }
    // A table may name one image as often as it likes.
    image_bytes_ += image.rgb.size();
    CheckBytes(image_bytes_);
    run->image.insert(run->image.end(), image.rgb.begin(), image.rgb.end());
    return true;
  }

  void CountWithoutPose(const std::set<std::string>& named) {
    std::set<std::string> without;  // in order: the one that is named does not depend on the file system
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(options_.folder)) {
      const std::string path = entry.path().lexically_normal().string();
      if (IsImage(entry.path()) && !named.contains(path)) without.insert(path);
    }
    if (without.empty()) return;
    if (!options_.skip_bad)
      throw InputError(*without.begin() + ": image without a pose: " + Table() + " does not name it");
    report_.skipped["image without a pose"] = static_cast<std::int64_t>(without.size());
  }

  Readings ReadImages(const std::set<std::string>& named) const {
    std::vector<std::string> paths;
    std::ranges::copy_if(named, std::back_inserter(paths),
                         [](const auto& path) { return fs::is_regular_file(path); });
    Readings readings;
    std::size_t bytes = 0;
    for (std::span<const std::string> left = paths; !left.empty();) {
      constexpr std::size_t kAtOnce = 64;  // so that not all are here before it shows that they are too much
      const auto some = left.first(std::min(kAtOnce, left.size()));
      std::vector<ImageReading> read = read_({some.begin(), some.end()});
      CAIRN_DEMAND(!read.empty() && read.size() <= some.size(), "a reader that loses images");
      for (std::size_t i = 0; i < read.size(); ++i) {
        bytes += read[i].rgb.size();
        readings[some[i]] = std::move(read[i]);
      }
      CheckBytes(bytes);
      left = left.subspan(read.size());
    }
    return readings;
  }

  const ImagesImportOptions& options_;
  const ImageReader& read_;
  BadLines bad_;
  std::optional<PoseTracks> track_;
  std::optional<TimedInputs> ranges_;
  ImportReport report_;
  Samples samples_;
  std::size_t image_bytes_ = 0;
  NameIndex runs_;
  fs::path folder_;
  std::string folder_name_;
};

}  // namespace

ImportReport ImportImages(const ImagesImportOptions& options, const ImageReader& read, Blob* samples) {
  return ImagesImport(options, read).Run(samples);
}

}  // namespace cairn::datasets
