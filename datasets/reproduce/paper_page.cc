#include "datasets/report/format.h"
#include "datasets/report/style.h"
#include "datasets/reproduce/landmark_figures.h"

namespace cairn::datasets {

std::string PaperPageHtml(const std::string& title, const std::string& lead,
                          const std::vector<PaperFigure>& figures) {
  using report::Escape;
  std::string html =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
      Escape(title) + "</title>\n<style>" + report::kStyle +
      "figure img { max-width:100%; height:auto; background:#fff; border:1px solid var(--line); }\n"
      "dl { display:grid; grid-template-columns:max-content 1fr; gap:2px 14px; margin:8px 0 0; }\n"
      "dt { color:var(--soft); } dd { margin:0; }\n</style>\n</head>\n<body>\n<main>\n<h1>" +
      Escape(title) + "</h1>\n<p class=\"lead\">" + Escape(lead) + "</p>\n";
  for (const PaperFigure& figure : figures) {
    html += "<section>\n<h2>" + Escape(figure.title) + "</h2>\n<figure><img src=\"" + Escape(figure.file) +
            "\" alt=\"" + Escape(figure.title) + "\"></figure>\n<dl><dt>paper</dt><dd>" +
            Escape(figure.claim) + "</dd><dt>here</dt><dd>" + Escape(figure.measured) +
            "</dd></dl>\n</section>\n";
  }
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace cairn::datasets
