// The page of samples, as the pipeline `image_features` makes them.
#pragma once

#include <string>

#include "datasets/report/scene.h"
#include "schema/blob.h"

namespace cairn::datasets::report {

// The page's body: where they were taken, and of each run how many, its way and what was sensed on it.
// Throws InputError where the arrays do not fit each other.
std::string SamplesHtml(const Blob& samples);

// Where they were taken, a path a run.
Scene SamplesSceneOf(const Blob& samples);

}  // namespace cairn::datasets::report
