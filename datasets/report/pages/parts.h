// The pieces that every page is put together from.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/report/drawing/charts.h"
#include "datasets/report/pictures.h"
#include "schema/blob.h"

namespace cairn::datasets::report {

// A section with its heading; empty where the body is.
std::string SectionHtml(const std::string& title, const std::string& body);
// A figure is drawn twice, for a wide page and for a phone, and the page shows the one that fits: text that
// is made small with its drawing cannot be read. Widths are in pixels.
inline constexpr double kWidePicture = 1040, kNarrowPicture = 400;
using Drawing = std::function<Picture(double width)>;
// Both drawings with words (HTML) below; empty where the drawing is.
std::string DrawingHtml(const Drawing& draw, const std::string& caption);
// A picture in its own size, to be scrolled sideways where the page is narrower.
std::string PictureHtml(const Picture& picture, const std::string& caption);
// A chart with its title and legend above it; empty where there is no point to draw.
std::string ChartHtml(const LineChart& chart, const std::string& caption, double height = 200);
std::string LegendHtml(const std::vector<LegendEntry>& entries);
// The first row is the head.
using Table = std::vector<std::vector<std::string>>;
std::string TableHtml(const Table& rows);
// Key numbers side by side; empty without any.
std::string TilesHtml(const std::string& tiles);
// A key number. `mood`: "", good or bad.
std::string TileHtml(const std::string& value, const std::string& what, const char* mood = "");
std::string CountTileHtml(std::int64_t count, const std::string& noun);  // "1" over "iteration"
// Wall time by round.
std::string TimeHtml(const std::vector<RoundTime>& rounds);
// A whole page of its own round `body`.
std::string PageHtml(const std::string& title, const std::string& body, const Blob& result);

}  // namespace cairn::datasets::report
