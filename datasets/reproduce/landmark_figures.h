// The papers' figures on landmark maps, drawn from what a LandmarkStudy's job has found, each beside the
// paper's claim and the figures that were measured.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "datasets/reproduce/landmark_study.h"

namespace cairn::datasets {

struct PaperFigure {
  std::string file;      // figure_05.png
  std::string title;     // "Figure 5: raw data"
  std::string claim;     // the paper's
  std::string measured;  // ours, a sentence
  std::string png;       // the file's bytes
};

// `results`: of the study's stages, by name. Throws InputError where one is missing or lacks what is drawn.
std::vector<PaperFigure> LandmarkFigures(const LandmarkStudy& study,
                                         const std::map<std::string, Blob>& results);

// The page that shows them, its pictures beside it.
std::string PaperPageHtml(const std::string& title, const std::string& lead,
                          const std::vector<PaperFigure>& figures);

}  // namespace cairn::datasets
