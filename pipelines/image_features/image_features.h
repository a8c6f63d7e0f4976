// What networks see of images: [Thr98] section 5.1.3.
#pragma once

#include <array>
#include <cstdint>

#include "pipelines/image_features/options.h"
#include "pipelines/pipeline.h"

namespace cairn::image_features {

// Input (schema/FORMAT.md): samples with images. Result: the same samples without them, and with their
// features before the inputs that they had. One round: a task is a block of images of a run.
class ImageFeatures : public Pipeline {
 public:
  ImageFeatures(Options options, std::uint64_t /*seed*/) : options_(options) {}

  Step Start(const Inputs& inputs) const override;
  Blob Run(const Task& task, const Inputs& inputs, Progress& progress) const override;
  Step Advance(const State& state, Partials& partials, const Inputs& inputs) const override;

 private:
  Options options_;
};

// For the registry.
using PipelineType = ImageFeatures;
inline constexpr char kSummary[] = "what networks see of images: brightness, colour, texture of bands";
inline constexpr std::array kInputRoles = {"samples"};

}  // namespace cairn::image_features
