// The pieces that every page is put together from.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/report/pictures.h"
#include "schema/blob.h"

namespace cairn::datasets::report {

// A section with its heading; empty where the body is.
std::string SectionHtml(const std::string& title, const std::string& body);
// A figure is drawn twice, for a wide page and for a phone, and the page shows the one that fits: text that
// is made small with its drawing cannot be read. Widths are in pixels.
inline constexpr double kWidePicture = 1040, kNarrowPicture = 400;
// A drawing of a width, as SVG; empty: there is nothing to draw.
using Drawing = std::function<std::string(double width)>;
// Both drawings with words (HTML) below; empty where the drawing is.
std::string DrawingHtml(const Drawing& draw, const std::string& caption);
// A raster picture in its own size, to be scrolled sideways where the page is narrower.
std::string PictureHtml(std::string_view png, const std::string& label, const std::string& caption);
// What a legend's entries look like and mean; `drawing`: SVG in a box of 26 by 14.
struct LegendEntry {
  std::string drawing, text;
};
std::string LegendHtml(const std::vector<LegendEntry>& entries);
// A key number. `mood`: "", good or bad.
std::string TileHtml(const std::string& value, const std::string& what, const char* mood = "");
// A row of a table; `tag`: td, or th.
std::string RowHtml(const std::vector<std::string>& cells, const char* tag = "td");
// Wall time by round.
std::string TimeHtml(const std::vector<RoundTime>& rounds);
// A whole page of its own round `body`.
std::string PageHtml(const std::string& title, const std::string& body, const Blob& result);

}  // namespace cairn::datasets::report
