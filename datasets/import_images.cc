#include "datasets/import_images.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <map>
#include <set>

#include "datasets/images/image_features.h"
#include "datasets/name_index.h"
#include "datasets/sample_rows.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

namespace fs = std::filesystem;

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
  }

  ImportReport Run(Blob* samples) {
    BadLines bad_before(options_.skip_bad);  // what is wrong with the table is said before images are read
    const std::set<std::string> named = ReadTable(nullptr, &bad_before);
    CountWithoutPose(named);
    const Readings readings = ReadImages(named);
    ReadTable(&readings, &bad_);
    for (const SampleRun& run : samples_.runs) CheckRun(options_.poses, run, &report_);
    if (samples_.runs.empty()) throw InputError(options_.poses + ": there are no samples in it");
    report_.skipped.insert(bad_.counts().begin(), bad_.counts().end());
    *samples = MakeSamples(samples_);
    return report_;
  }

 private:
  using Readings = std::map<std::string, ImageReading>;  // by path

  std::string PathOf(std::string_view image) const {
    return (fs::path(options_.folder) / image).lexically_normal().string();
  }

  // The paths that the table names. With `readings` its lines become samples of them; without they are only
  // checked.
  std::set<std::string> ReadTable(const Readings* readings, BadLines* bad) {
    const std::vector<std::vector<std::string>> headers = {
        {"image", "time_s", "x_m", "y_m", "heading_rad", "run"},
        {"image", "time_s", "x_m", "y_m", "heading_rad"},
        {"image", "time_s", "x_m", "y_m", "run"},
        {"image", "time_s", "x_m", "y_m"}};
    CsvReader reader(options_.poses, headers, bad);
    reader.TakeExtraColumns();
    const std::size_t width = headers[reader.header()].size();
    SampleColumns columns{1, 2, 3, {}, {}};
    if (reader.header() < 2) columns.heading = 4;
    std::optional<std::size_t> run_column;
    if (reader.header() % 2 == 0) run_column = width - 1;
    samples_ = {ImageFeatureNames(), {}};
    for (const std::string& name : reader.extra_columns()) {
      if (std::ranges::count(samples_.input_name, name) > 0)
        throw InputError(options_.poses + ":1: column '" + name + "' is called as an image's feature");
      columns.input.push_back(width + columns.input.size());
      samples_.input_name.push_back(name);
    }
    runs_ = NameIndex();
    std::set<std::string> named;
    while (reader.Next()) {
      named.insert(PathOf(reader.Text(0)));
      ReadRow(columns, run_column, readings, &reader);
    }
    return named;
  }

  void ReadRow(const SampleColumns& columns, std::optional<std::size_t> run_column, const Readings* readings,
               CsvReader* reader) {
    const std::string path = PathOf(reader->Text(0));
    const std::string name = run_column ? std::string(reader->Text(*run_column)) : FolderName();
    if (!fs::is_regular_file(path)) return reader->Bad("no such image", path);
    if (name.empty()) return reader->Bad("run without a name", "the column is empty");
    const auto index = static_cast<std::size_t>(runs_.FindOrAdd(name));
    if (index == samples_.runs.size()) samples_.runs.push_back({name, {}, {}, {}, {}, {}});
    SampleRun& run = samples_.runs[index];
    std::optional<SampleRow> row = ReadSampleRow(columns, run, reader);
    if (!row) return;
    if (readings != nullptr) {
      const ImageReading& reading = readings->at(path);
      if (!reading.failure.empty()) return reader->Bad("bad image", path + ": " + reading.failure);
      row->input.insert(row->input.begin(), reading.features.begin(), reading.features.end());
    }
    AddSampleRow(columns, *row, &run);
  }

  std::string FolderName() const { return fs::canonical(options_.folder).filename().string(); }

  void CountWithoutPose(const std::set<std::string>& named) {
    std::set<std::string> without;  // in order: the one that is named does not depend on the file system
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(options_.folder)) {
      const std::string path = entry.path().lexically_normal().string();
      if (IsImage(entry.path()) && !named.contains(path)) without.insert(path);
    }
    if (without.empty()) return;
    if (!options_.skip_bad)
      throw InputError(*without.begin() + ": image without a pose: " + options_.poses + " does not name it");
    report_.skipped["image without a pose"] = static_cast<std::int64_t>(without.size());
  }

  Readings ReadImages(const std::set<std::string>& named) const {
    std::vector<std::string> paths;
    std::ranges::copy_if(named, std::back_inserter(paths),
                         [](const auto& path) { return fs::is_regular_file(path); });
    const std::vector<ImageReading> read = read_(paths);
    CAIRN_DEMAND(read.size() == paths.size(), "a reader that loses images");
    Readings readings;
    for (std::size_t i = 0; i < paths.size(); ++i) readings[paths[i]] = read[i];
    return readings;
  }

  const ImagesImportOptions& options_;
  const ImageReader& read_;
  BadLines bad_;
  ImportReport report_;
  Samples samples_;
  NameIndex runs_;
};

}  // namespace

ImportReport ImportImages(const ImagesImportOptions& options, const ImageReader& read, Blob* samples) {
  return ImagesImport(options, read).Run(samples);
}

}  // namespace cairn::datasets
