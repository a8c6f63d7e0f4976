#include "datasets/common/samples.h"

#include <array>
#include <set>

namespace cairn::datasets {
namespace {

void PutFeatures(const std::string& prefix, std::size_t features, const SampleRun& run, Blob* blob) {
  if (features == 0) return;
  const Shape shape{static_cast<std::int64_t>(run.time_s.size()), static_cast<std::int64_t>(features)};
  blob->Put(prefix + "feature", Array::Of(shape, run.feature));
}

void PutTruth(const std::string& prefix, const SampleRun& run, Blob* blob) {
  if (run.true_x_m.empty()) return;
  blob->PutVector("truth/" + prefix + "x_m", run.true_x_m);
  blob->PutVector("truth/" + prefix + "y_m", run.true_y_m);
  blob->PutVector("truth/" + prefix + "heading_rad", run.true_heading_rad);
}

}  // namespace

std::int64_t CountRepeatedPoses(const SampleRun& run) {
  std::set<std::array<double, 3>> seen;
  for (std::size_t k = 0; k < run.x_m.size(); ++k) {
    seen.insert({run.x_m[k], run.y_m[k], run.heading_rad.empty() ? 0 : run.heading_rad[k]});
  }
  return static_cast<std::int64_t>(run.x_m.size() - seen.size());
}

Blob MakeSamples(const Samples& samples) {
  Blob blob;
  std::vector<std::string> names;
  for (std::size_t n = 0; n < samples.runs.size(); ++n) {
    const SampleRun& run = samples.runs[n];
    const std::string prefix = "run/" + std::to_string(n) + "/";
    names.push_back(run.name);
    blob.PutVector(prefix + "time_s", run.time_s);
    blob.PutVector(prefix + "x_m", run.x_m);
    blob.PutVector(prefix + "y_m", run.y_m);
    if (!run.heading_rad.empty()) blob.PutVector(prefix + "heading_rad", run.heading_rad);
    const auto count = static_cast<std::int64_t>(run.time_s.size());
    blob.Put(prefix + "input",
             Array::Of({count, static_cast<std::int64_t>(samples.input_name.size())}, run.input));
    if (!run.image.empty())
      blob.Put(prefix + "image", Array::Of({count, run.image_rows, run.image_columns, 3}, run.image));
    if (!run.turn_rad.empty()) {
      blob.PutVector(prefix + "odometry/turn_rad", run.turn_rad);
      blob.PutVector(prefix + "odometry/forward_m", run.forward_m);
      blob.PutVector(prefix + "odometry/left_m", run.left_m);
    }
    PutFeatures(prefix, samples.feature_name.size(), run, &blob);
    PutTruth(prefix, run, &blob);
  }
  blob.Put("runs", Array::Texts(names));
  blob.Put("input_name", Array::Texts(samples.input_name));
  if (!samples.feature_name.empty()) blob.Put("feature_name", Array::Texts(samples.feature_name));
  if (samples.label_error_m) blob.PutScalar("label_error_m", *samples.label_error_m);
  return blob;
}

}  // namespace cairn::datasets
