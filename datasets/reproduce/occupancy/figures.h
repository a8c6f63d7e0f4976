// The figures of [Thr01] from the results of occupancy_study.h, with the paper's claim and our number for
// each.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "datasets/reproduce/occupancy/study.h"
#include "datasets/reproduce/paper_figure.h"

namespace cairn::datasets {

// `results`: of all stages, by name.
// Throws InputError that names a result that is missing.
std::vector<PaperFigure> OccupancyFigures(const OccupancyStudy& study,
                                          const std::map<std::string, Blob>& results);

// Walls found against doors right, by setting of evidence_map.
std::vector<PaperFigure> CurveFigures(const OccupancyStudy& study,
                                      const std::map<std::string, Blob>& results);

}  // namespace cairn::datasets
