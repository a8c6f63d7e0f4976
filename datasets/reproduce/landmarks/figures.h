// The papers' figures on landmark maps, drawn from what a LandmarkStudy's job has found, each beside the
// paper's claim and the figures that were measured.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "datasets/reproduce/landmarks/study.h"
#include "datasets/reproduce/paper_figure.h"

namespace cairn::datasets {

// `results`: of the study's stages, by name.
// Throws InputError where one is missing or lacks what is drawn.
std::vector<PaperFigure> LandmarkFigures(const LandmarkStudy& study,
                                         const std::map<std::string, Blob>& results);

}  // namespace cairn::datasets
