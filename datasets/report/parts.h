// The pieces that every page is put together from.
#pragma once

#include <string>
#include <vector>

#include "datasets/report/figures.h"
#include "schema/blob.h"

namespace cairn::datasets::report {

// A section with its heading; empty where the body is.
std::string SectionHtml(const std::string& title, const std::string& body);
// A drawing with words below it; empty where the drawing is.
std::string FigureHtml(const std::string& drawing, const std::string& caption);
// A key number. `mood`: "", good or bad.
std::string TileHtml(const std::string& value, const std::string& what, const char* mood = "");
// A row of a table; `tag`: td, or th.
std::string RowHtml(const std::vector<std::string>& cells, const char* tag = "td");
// Wall time by round.
std::string TimeHtml(const std::vector<RoundTime>& rounds);
// A whole page of its own round `body`.
std::string PageHtml(const std::string& title, const std::string& body, const Blob& result);

}  // namespace cairn::datasets::report
