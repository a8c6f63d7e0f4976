#include "datasets/report/pages/parts.h"

#include "datasets/report/drawing/base64.h"
#include "datasets/report/drawing/format.h"
#include "datasets/report/pages/style.h"

namespace cairn::datasets::report {
namespace {

std::string Footer(const Blob& result) {
  std::string text = "Made by Cairn";
  if (result.Has("provenance/version")) text += " " + Escape(result.Text("provenance/version"));
  if (result.Has("provenance/workers"))
    text += " with " + Count(result.Scalar<std::int64_t>("provenance/workers"), "worker");
  return "<footer>" + text + ". Lengths in metres, headings counter-clockwise.</footer>\n";
}

// Big-endian, of a PNG's header.
std::uint32_t PngSide(std::string_view png, std::size_t at) {
  std::uint32_t side = 0;
  for (std::size_t i = at; i < at + 4; ++i) side = 256 * side + static_cast<unsigned char>(png.at(i));
  return side;
}

}  // namespace

std::string SectionHtml(const std::string& title, const std::string& body) {
  return body.empty() ? "" : "<section>\n<h2>" + title + "</h2>\n" + body + "</section>\n";
}

std::string DrawingHtml(const Drawing& draw, const std::string& caption) {
  const std::string wide = draw(kWidePicture);
  if (wide.empty()) return {};
  return "<figure>\n<div class=\"wide\">" + wide + "</div>\n<div class=\"narrow\">" + draw(kNarrowPicture) +
         "</div>\n<figcaption>" + caption + "</figcaption>\n</figure>\n";
}

std::string PictureHtml(std::string_view png, const std::string& label, const std::string& caption) {
  const std::string width = std::to_string(PngSide(png, 16)), height = std::to_string(PngSide(png, 20));
  return "<figure>\n<div class=\"scroll\"><img width=\"" + width + "\" height=\"" + height + "\" alt=\"" +
         Escape(label) + "\" src=\"data:image/png;base64," + Base64(png) + "\"></div>\n<figcaption>" +
         caption + "</figcaption>\n</figure>\n";
}

std::string LegendHtml(const std::vector<LegendEntry>& entries) {
  std::string items;
  for (const LegendEntry& entry : entries)
    items += "<li><svg viewBox=\"0 0 26 14\" aria-hidden=\"true\">" + entry.drawing + "</svg>" +
             Escape(entry.text) + "</li>\n";
  return items.empty() ? "" : "<ul class=\"legend\">\n" + items + "</ul>\n";
}

std::string TileHtml(const std::string& value, const std::string& what, const char* mood) {
  return "<div class=\"tile " + std::string(mood) + "\"><b>" + Escape(value) + "</b><span>" + Escape(what) +
         "</span></div>\n";
}

std::string RowHtml(const std::vector<std::string>& cells, const char* tag) {
  std::string row = "<tr>";
  for (const std::string& cell : cells) row += "<" + std::string(tag) + ">" + Escape(cell) + "</" + tag + ">";
  return row + "</tr>\n";
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
                     Count(count, "round") + " with " + Count(tasks, "task") + ": " + Duration(seconds) +
                         " of wall time, " + Duration(compute) + " of computing.");
}

std::string PageHtml(const std::string& title, const std::string& body, const Blob& result) {
  return "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         Escape(title) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n<main>\n<h1>" +
         Escape(title) + "</h1>\n" + body + Footer(result) + "</main>\n</body>\n</html>\n";
}

}  // namespace cairn::datasets::report
