#include "datasets/common/samples.h"

#include <array>
#include <set>

#include "schema/kinds/learning.h"

namespace cairn::datasets {
std::int64_t CountRepeatedPoses(const SampleRun& run) {
  std::set<std::array<double, 3>> seen;
  for (std::size_t k = 0; k < run.x_m.size(); ++k) {
    seen.insert({run.x_m[k], run.y_m[k], run.heading_rad.empty() ? 0 : run.heading_rad[k]});
  }
  return static_cast<std::int64_t>(run.x_m.size() - seen.size());
}

Blob MakeSamples(const Samples& samples) {
  kinds::Samples file;
  std::vector<std::string> names;
  const auto inputs = static_cast<std::int64_t>(samples.input_name.size()),
             features = static_cast<std::int64_t>(samples.feature_name.size());
  const auto put = [](const std::vector<double>& values, Column<double>* column) {
    if (!values.empty()) *column = values;
  };
  for (const SampleRun& run : samples.runs) {
    names.push_back(run.name);
    const auto count = static_cast<std::int64_t>(run.time_s.size());
    kinds::Samples::Run& of = file.run.emplace_back();
    of.time_s = run.time_s;
    of.x_m = run.x_m;
    of.y_m = run.y_m;
    of.input = {{count, inputs}, run.input};
    put(run.heading_rad, &of.heading_rad);
    put(run.turn_rad, &of.turn_rad);
    put(run.forward_m, &of.forward_m);
    put(run.left_m, &of.left_m);
    if (!run.image.empty()) of.image = {{count, run.image_rows, run.image_columns, 3}, run.image};
    if (features > 0) of.feature = {{count, features}, run.feature};
    kinds::Samples::TrueRun& truth = file.true_run.emplace_back();
    put(run.true_x_m, &truth.x_m);
    put(run.true_y_m, &truth.y_m);
    put(run.true_heading_rad, &truth.heading_rad);
  }
  file.runs = names;
  file.input_name = samples.input_name;
  if (features > 0) file.feature_name = samples.feature_name;
  if (samples.label_error_m) file.label_error_m = *samples.label_error_m;
  return BlobOf(file);
}

}  // namespace cairn::datasets
