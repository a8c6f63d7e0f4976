// The report's words and tables.
#pragma once

#include <string>
#include <vector>

#include "datasets/evaluate/evaluate.h"
#include "datasets/report/pictures.h"
#include "datasets/report/scene.h"
#include "schema/blob.h"

namespace cairn::datasets::report {

// "3 robots, 3,012 m in 2 h 31 min, 203 observations; 20 landmarks found."
std::string LeadHtml(const Blob& result, const Blob* log);

// The key numbers, as tiles.
std::string TilesHtml(const Blob& result, const Evaluation* evaluation);

// How long the result took, as a tile; nothing where the provenance does not tell.
std::string WallTimeTile(const Blob& result);

// Which log, which job: "museum: landmark_map", from the provenance. Empty where that does not tell.
std::string TitleOf(const Blob& result);

// A table a robot: its way, observations, error.
std::string RobotsTableHtml(const Blob& result, const Blob* log, const Evaluation* evaluation);

// A table of the landmarks.
std::string LandmarksTableHtml(const Scene& scene);

// From the history; empty where it has none.
std::vector<Iteration> Iterations(const Blob& result);

// From the provenance; empty where it has no rounds.
std::vector<RoundTime> RoundTimes(const Blob& result);

// Version, workers, seconds and the resolved job, where the provenance tells them.
std::string ProvenanceHtml(const Blob& result);

}  // namespace cairn::datasets::report
