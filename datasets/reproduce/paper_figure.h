// A figure or a table of a paper as it came out here, beside the paper's claim, and the page of them all.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace cairn::datasets {

struct PaperTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;  // each as long as the head; the first column names it
};

struct PaperFigure {
  std::string file;       // figure_05.png; empty: a table only
  std::string title;      // "Figure 5: raw data"
  std::string claim;      // the paper's
  std::string measured;   // ours, a sentence
  std::string png;        // the file's bytes
  PaperTable table = {};  // may be empty
  // Whether what the claim says is so here, by the figures in `measured`; none: nothing in it that could be
  // checked.
  std::optional<bool> holds = {};
};

// "holds here", "does not hold here" or "not checked".
const char* ClaimVerdict(const PaperFigure& figure);

// The page that shows them, its pictures beside it.
std::string PaperPageHtml(const std::string& title, const std::string& lead,
                          const std::vector<PaperFigure>& figures);

// For a terminal: columns as wide as they must be, "    " before each line.
std::string PaperTableText(const PaperTable& table);

}  // namespace cairn::datasets
