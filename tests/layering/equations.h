// Where the papers' equations are computed: the comments in the sources, held against the tables in the
// READMEs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cairn::layering {

// `[TBF98] eqs 15, 16` are two of them. `what`: "eq. 15", "section 4.2", "figure 1", "figure 1, step 3",
// "table 1" or "footnote 1".
struct Reference {
  std::string paper, what;
  auto operator<=>(const Reference&) const = default;
};

// All that `text` refers to. `paper`: whose equations are meant where the text names no paper first; empty:
// those without a paper are none.
std::vector<Reference> ReferencesIn(const std::string& text, const std::string& paper = "");

struct Mismatch {
  std::string file;
  int line = 0;
  std::string why;
};

// "pipelines/a.cc:3: names [TBF98] eq. 16, …", for people.
std::string ToText(const Mismatch& mismatch);

struct EquationCheck {
  std::vector<Mismatch> mismatches;
  int rows = 0;      // of the READMEs' tables
  int comments = 0;  // that begin with a reference
};

// Reads below `root` the papers' keys (CITATION.cff), each pipeline's README and its sources, and those of
// pipelines/common and datasets/evaluate, which all pipelines share. A table has the paper's key in its first
// head, `| [TBF98] | function | test | deviation |`. A mismatch is:
// - a README or a pipeline that names a paper without such a table, or a row that names neither an equation
// nor "not in the paper";
// - a row's reference with which no comment line above code begins, in a .cc file or above a header's
// function body;
// - what a comment begins with, or an equation anywhere in it, that no row has; an equation without a paper,
// or
//   of one that CITATION.cff does not have;
// - a row's function that is not in the sources, or a row's test that no *_test.cc has.
EquationCheck CheckEquations(const std::filesystem::path& root);

}  // namespace cairn::layering
