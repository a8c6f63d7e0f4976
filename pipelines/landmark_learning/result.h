// What training ends with: a file of kind `networks` (schema/FORMAT.md).
#pragma once

#include <string>

#include "pipelines/landmark_learning/data/training_data.h"
#include "pipelines/landmark_learning/state/state.h"
#include "pipelines/pipeline.h"

namespace cairn::landmark_learning {

// What the last step did, in a line for people: right after Training::Record.
std::string NoteOf(const Options& options, const Training& training);

// `parent`: the result that this run went on from, or null. `starts`: what it says of the starts that were
// compared, or null.
Step ResultOf(const Options& options, const TrainingData& data, const Training& training,
              const HistoryRows& history, const Blob* parent, const Blob* starts);

}  // namespace cairn::landmark_learning
