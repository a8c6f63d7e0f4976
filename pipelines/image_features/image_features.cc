#include "pipelines/image_features/image_features.h"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "pipelines/common/handed_over.h"
#include "pipelines/common/task_builder.h"
#include "pipelines/image_features/band_features.h"
#include "schema/blob_part.h"

namespace cairn::image_features {
namespace {

constexpr std::int64_t kBytesOfATask = 1 << 23;  // of images: some 10 ms of a core

// Microseconds of a core: a byte of images, and a byte of what is copied into the result.
constexpr double kByteUs = 5e-3, kCopiedUs = 5e-4;

constexpr std::int64_t kMostPixels = 1 << 20;  // along a side
constexpr std::int64_t kMostRuns = std::numeric_limits<std::int32_t>::max();

// What tasks alone read, each its own.
constexpr const char* kImages = "image";

// `run/N/image`: [samples][rows][columns][3].
struct ImageShape {
  std::int64_t samples, rows, columns;
  std::int64_t bytes() const { return rows * columns * 3; }
};

std::string RunPrefix(std::size_t run) { return "run/" + std::to_string(run) + "/"; }

ImageShape ShapeOf(const Options& options, const Blob& samples, const std::string& run, std::size_t index) {
  const std::string name = RunPrefix(index) + kImages;
  if (!samples.Has(name)) throw InputError("run '" + run + "' has no images");
  const Shape& shape = samples.at(name).shape();
  const std::int64_t least = std::min(
      {shape[1], shape[2], std::int64_t{options.texture_rows}, std::int64_t{options.texture_columns}});
  if (least < options.bands) {
    throw InputError("run '" + run + "': images of " + std::to_string(shape[1]) + " by " +
                     std::to_string(shape[2]) + " pixels cannot be cut into " +
                     std::to_string(options.bands) + " bands, nor can a smaller one for texture");
  }
  return {shape[0], shape[1], shape[2]};
}

// The tasks of a run, in the order of its images.
void AddTasks(const std::string& samples, std::size_t run, const ImageShape& shape, proto::Step* plan) {
  const std::int64_t block = std::max<std::int64_t>(1, kBytesOfATask / shape.bytes());
  for (std::int64_t first = 0; first < shape.samples; first += block) {
    const std::int64_t count = std::min(block, shape.samples - first);
    TaskBuilder("features", kByteUs * static_cast<double>(count * shape.bytes()), plan)
        .Set("run", run)
        .ReadPart("images", samples, RowsPart(RunPrefix(run) + kImages, first, count));
  }
}

// All of the samples that does not change, without what only a simulator or a tracker knows.
Blob Unchanged(const Blob& head, const Inputs& inputs) {
  Blob result;
  for (const auto& [name, array] : head.fields()) {
    const bool changes = name.starts_with("run/") && (name.ends_with("/image") || name.ends_with("/input"));
    if (changes || name == "input_name" || name.starts_with("truth/")) continue;
    result.Put(name, array.is_form_alone() ? inputs.Get("samples")->at(name) : array);
  }
  return result;
}

// Appends a partial's features, of `count` samples of the run, each with the inputs that it had.
void Append(const Blob& partial, std::size_t features, std::span<const float> had, std::size_t per_sample,
            std::size_t count, std::vector<float>* input) {
  const auto rows = partial.Get<float>("feature");
  const std::size_t before = input->size() / (features + per_sample);
  RequireWithin("the samples of a partial", static_cast<std::int64_t>(rows.size() / features), 1,
                static_cast<std::int64_t>(count - before));
  for (std::size_t k = 0; k < rows.size() / features; ++k) {
    const auto row = rows.subspan(k * features, features);
    const auto own = had.subspan((before + k) * per_sample, per_sample);
    input->insert(input->end(), row.begin(), row.end());
    input->insert(input->end(), own.begin(), own.end());
  }
}

}  // namespace

Step ImageFeatures::Start(const Inputs& inputs) const {
  const BlobPtr samples = inputs.GetHead("samples", kImages);
  const std::vector<std::string> runs = samples->Texts("runs");
  Step step;
  std::int64_t images = 0;
  double copied = 0;
  for (const auto& [name, array] : samples->fields())
    if (!name.starts_with("truth/")) copied += static_cast<double>(array.bytes().size());
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const ImageShape shape = ShapeOf(options_, *samples, runs[r], r);
    AddTasks(inputs.HashOf("samples").Binary(), r, shape, &step.plan);
    images += shape.samples;
  }
  if (images == 0) throw InputError("there are no images");
  step.plan.set_advance_cost(kCopiedUs * copied);
  step.plan.set_note(std::to_string(images) + " images of " + std::to_string(runs.size()) + " runs");
  return step;
}

Blob ImageFeatures::Run(const Task& task, const Inputs& inputs, Progress& progress) const {
  RequireKind(task, {"features"});
  const BlobPtr images = inputs.Get("images");
  const std::string name =
      RunPrefix(static_cast<std::size_t>(IntegerOf(task, "run", 0, kMostRuns))) + kImages;
  const Shape& shape = images->at(name).shape();
  RequireSize("the shape of images", shape.size(), 4);
  RequireWithin("the number of images", shape[0], 1, std::numeric_limits<std::int32_t>::max());
  RequireWithin("an image's rows", shape[1], options_.bands, kMostPixels);
  RequireWithin("an image's columns", shape[2], options_.bands, kMostPixels);
  RequireWithin("an image's colours", shape[3], 3, 3);
  const auto rgb = images->Get<std::uint8_t>(name);
  const auto bytes = static_cast<std::size_t>(shape[1] * shape[2] * shape[3]);
  std::vector<float> rows;
  for (std::size_t k = 0; k < static_cast<std::size_t>(shape[0]); ++k) {
    progress.Tick();
    const auto features = BandFeatures(
        options_, {static_cast<int>(shape[1]), static_cast<int>(shape[2]), rgb.subspan(k * bytes, bytes)});
    rows.insert(rows.end(), features.begin(), features.end());
  }
  Blob partial;
  partial.Put("feature",
              Array::Of<float>({shape[0], static_cast<std::int64_t>(rows.size()) / shape[0]}, rows));
  return partial;
}

Step ImageFeatures::Advance(const State&, Partials& partials, const Inputs& inputs) const {
  const BlobPtr samples = inputs.GetHead("samples", kImages);
  std::vector<std::string> names = BandFeatureNames(options_);
  const std::size_t features = names.size();
  const std::vector<std::string> had_names = samples->Texts("input_name");
  names.insert(names.end(), had_names.begin(), had_names.end());
  Blob result = Unchanged(*samples, inputs);
  result.Put("input_name", Array::Texts(names));
  std::size_t task = 0;
  for (std::size_t r = 0; r < samples->Texts("runs").size(); ++r) {
    const std::string name = RunPrefix(r) + "input";
    const auto count = static_cast<std::size_t>(samples->at(RunPrefix(r) + "time_s").size());
    const auto had = had_names.empty() ? std::span<const float>() : samples->Get<float>(name);
    std::vector<float> input;
    while (input.size() < count * names.size())
      Append(*partials.Get(task++), features, had, had_names.size(), count, &input);
    result.Put(name, Array::Of<float>(
                         {static_cast<std::int64_t>(count), static_cast<std::int64_t>(names.size())}, input));
  }
  Step step;
  step.plan.set_result(step.Share(std::move(result)));
  step.plan.set_note(std::to_string(names.size()) + " inputs a sample");
  return step;
}

}  // namespace cairn::image_features
