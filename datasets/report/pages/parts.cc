#include "datasets/report/pages/parts.h"

#include <fmt/format.h>

#include "datasets/report/drawing/format.h"
#include "datasets/report/drawing/style.h"
#include "datasets/report/pages/page_script.h"

namespace cairn::datasets::report {
namespace {

std::string Footer(const Blob& result) {
  std::string text = "Made by Cairn";
  if (result.Has("provenance/version")) text += " " + Escape(result.Text("provenance/version"));
  if (result.Has("provenance/workers"))
    text += " with " + Count(result.Scalar<std::int64_t>("provenance/workers"), "worker");
  return "<footer>" + text + ". Lengths in metres, headings counter-clockwise.</footer>\n";
}

}  // namespace

std::string SectionHtml(const std::string& title, const std::string& body) {
  return body.empty() ? "" : "<section>\n<h2>" + title + "</h2>\n" + body + "</section>\n";
}

std::string DrawingHtml(const Drawing& draw, const std::string& caption) {
  const Picture wide = draw(kWidePicture);
  if (wide.empty()) return {};
  return fmt::format(
      "<figure>\n<div class=\"wide\">{}</div>\n<div class=\"narrow\">{}</div>\n"
      "<figcaption>{}</figcaption>\n</figure>\n",
      wide.Svg(), draw(kNarrowPicture).Svg(&wide), caption);
}

std::string PictureHtml(const Picture& picture, const std::string& caption) {
  return fmt::format(
      "<figure>\n<div class=\"scroll\"><div style=\"width:{}px\">{}</div></div>\n"
      "<figcaption>{}</figcaption>\n</figure>\n",
      Short(picture.width()), picture.Svg(), caption);
}

std::string ChartHtml(const LineChart& chart, const std::string& caption, double height) {
  const std::string figure = DrawingHtml(
      [&](double width) {
        constexpr double kTop = 8;
        Picture picture(width, kTop + height + kChartBottom, chart.title);
        Draw(chart, {kChartLeft, kTop, width - kChartLeft - kChartRight, height}, &picture);
        return picture;
      },
      caption);
  if (figure.empty()) return {};
  return fmt::format("<h3>{}</h3>\n{}{}", Escape(chart.title), LegendHtml(LegendOf({chart})), figure);
}

std::string LegendHtml(const std::vector<LegendEntry>& entries) {
  std::string items;
  for (const LegendEntry& entry : entries)
    items += fmt::format("<li><svg viewBox=\"0 0 {} {}\" aria-hidden=\"true\">{}</svg>{}</li>\n", kMarkWidth,
                         kMarkHeight, entry.mark.SvgShapes(), Escape(entry.text));
  return items.empty() ? "" : "<ul class=\"legend\">\n" + items + "</ul>\n";
}

std::string TableHtml(const Table& rows) {
  std::string html;
  for (const std::vector<std::string>& row : rows) {
    const char* tag = html.empty() ? "th" : "td";
    html += "<tr>";
    for (const std::string& cell : row) html += fmt::format("<{0}>{1}</{0}>", tag, Escape(cell));
    html += "</tr>\n";
  }
  return "<div class=\"scroll\"><table>\n" + html + "</table></div>\n";
}

std::string TilesHtml(const std::string& tiles) {
  return tiles.empty() ? "" : "<div class=\"tiles\">\n" + tiles + "</div>\n";
}

std::string TileHtml(const std::string& value, const std::string& what, const char* mood) {
  return fmt::format("<div class=\"tile {}\"><b>{}</b><span>{}</span></div>\n", mood, Escape(value),
                     Escape(what));
}

std::string CountTileHtml(std::int64_t count, const std::string& noun) {
  return TileHtml(std::to_string(count), noun + (count == 1 ? "" : "s"));
}

std::string TimeHtml(const std::vector<RoundTime>& rounds) {
  double seconds = 0, compute = 0;
  std::int64_t tasks = 0, count = 0;
  for (const RoundTime& round : rounds) {
    seconds += round.seconds;
    compute += round.compute_seconds;
    tasks += round.tasks;
    count += round.rounds;
  }
  return DrawingHtml([&](double width) { return RoundsPicture(rounds, width); },
                     fmt::format("{} with {}: {} of wall time, {} of computing.", Count(count, "round"),
                                 Count(tasks, "task"), Duration(seconds), Duration(compute)));
}

std::string PageHtml(const std::string& title, const std::string& body, const Blob& result) {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{0}</title>\n"
      "<style>{1}</style>\n</head>\n<body>\n<main>\n<h1>{0}</h1>\n{2}{3}</main>\n<script>\n{4}</script>\n</"
      "body>\n</html>\n",
      Escape(title), PageCss(), body, Footer(result), kPageScript);
}

}  // namespace cairn::datasets::report
