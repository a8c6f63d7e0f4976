// What people look at: a page of a job, and a picture of each of its stages.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/kinds/result_kinds.h"
#include "schema/blob.h"

namespace cairn::cli {

// A stage's result with what it was made from, and its score.
struct ScoredStage {
  std::string name, kind;
  BlobPtr result, source = nullptr;  // the log or the samples; may be null

  std::optional<datasets::Evaluated> evaluated = {};

  // Fills it in, where the source holds what it takes.
  // Throws InputError where it is not the result's.
  void Score();
};

// In the order of their job, as their provenance tells it.
void SortByJob(std::vector<ScoredStage>* stages);

// Where the pages of a job's stages went.
struct WrittenPages {
  std::string report;                 // empty: none of the stages has a page
  std::vector<std::string> pictures;  // of each stage; empty where it has none
};

// Writes DIR/report.html of all stages, and a picture of each: map.png of a map, picture.png of anything
// else. That of the stage that people look for (the last landmark_map, else the last map, else the last
// stage) goes into `dir`, those of others into DIR/STAGE/.
// Throws InputError where a DIR/STAGE is a link.
WrittenPages WritePages(const std::filesystem::path& dir, const std::vector<ScoredStage>& stages);

// The page alone, with a sentence for its reader before all else.
std::string PageOf(const std::vector<ScoredStage>& stages, const std::string& note = "");

}  // namespace cairn::cli
