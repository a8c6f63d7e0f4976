#include <algorithm>

#include "datasets/report/drawing/format.h"
#include "datasets/report/drawing/style.h"
#include "datasets/reproduce/paper_figure.h"

namespace cairn::datasets {
namespace {

std::string Html(const PaperTable& table) {
  if (table.head.empty()) return {};
  const auto row = [](const std::vector<std::string>& cells, const char* tag) {
    std::string html = "<tr>";
    for (const std::string& cell : cells)
      html += std::string("<") + tag + ">" + report::Escape(cell) + "</" + tag + ">";
    return html + "</tr>\n";
  };
  std::string html = "<div class=\"scroll\"><table>\n" + row(table.head, "th");
  for (const auto& cells : table.rows) html += row(cells, "td");
  return html + "</table></div>\n";
}

std::string Picture(const PaperFigure& figure) {
  if (figure.file.empty()) return {};
  return "<figure><div class=\"scroll\"><img src=\"" + report::Escape(figure.file) + "\" alt=\"" +
         report::Escape(figure.title) + "\"></div></figure>\n";
}

}  // namespace

const char* ClaimVerdict(const PaperFigure& figure) {
  if (!figure.holds) return "not checked";
  return *figure.holds ? "holds here" : "does not hold here";
}

std::string PaperTableText(const PaperTable& table) {
  std::vector<std::size_t> width(table.head.size(), 0);
  const auto measure = [&](const std::vector<std::string>& cells) {
    for (std::size_t c = 0; c < cells.size(); ++c) width[c] = std::max(width[c], cells[c].size());
  };
  measure(table.head);
  for (const auto& cells : table.rows) measure(cells);
  std::string text;
  const auto add = [&](const std::vector<std::string>& cells) {
    text += "    ";
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const std::string pad(width[c] - cells[c].size(), ' ');
      text += c == 0 ? cells[c] + pad : "  " + pad + cells[c];
    }
    text += "\n";
  };
  if (!table.head.empty()) add(table.head);
  for (const auto& cells : table.rows) add(cells);
  return text;
}

std::string PaperPageHtml(const std::string& title, const std::string& lead,
                          const std::vector<PaperFigure>& figures) {
  using report::Escape;
  std::string html =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
      Escape(title) + "</title>\n<style>" + report::PageCss() +
      // On a phone pictures keep their size, and are scrolled sideways.
      "figure img { max-width:100%; height:auto; background:#fff; border:1px solid var(--line); }\n"
      "@media screen and (max-width:860px) { figure img { max-width:none; } }\n"
      "dl { display:grid; grid-template-columns:max-content 1fr; gap:2px 14px; margin:8px 0 0; }\n"
      "dt { color:var(--soft); } dd { margin:0; }\n</style>\n</head>\n<body>\n<main>\n<h1>" +
      Escape(title) + "</h1>\n<p class=\"lead\">" + Escape(lead) + "</p>\n";
  for (const PaperFigure& figure : figures) {
    html += "<section>\n<h2>" + Escape(figure.title) + "</h2>\n" + Picture(figure) +
            "<dl><dt>paper</dt><dd>" + Escape(figure.claim) + "</dd><dt>here</dt><dd>" +
            Escape(figure.measured) + "</dd><dt>claim</dt><dd>" + ClaimVerdict(figure) + "</dd></dl>\n" +
            Html(figure.table) + "</section>\n";
  }
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace cairn::datasets
