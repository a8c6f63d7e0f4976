// The figures of [DM98] from the results of local_study.h, with the paper's claim and our number for each.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "datasets/reproduce/local/study.h"
#include "datasets/reproduce/paper_figure.h"

namespace cairn::datasets {

// `results`: of all stages, by name.
// Throws InputError that names a result that is missing.
std::vector<PaperFigure> LocalFigures(const LocalStudy& study, const std::map<std::string, Blob>& results);

}  // namespace cairn::datasets
