// "did you mean …?" for mistyped words.
#pragma once

#include <string>
#include <vector>

namespace cairn::cli {

// The word of `known` nearest to `word` in edits (insert, delete, replace, swap neighbours), where it is near
// enough to be what was meant: at most a third of its letters. Else empty.
std::string Nearest(const std::string& word, const std::vector<std::string>& known);

// The same for a command's flags, which are short: "--out" for "--ouput", "--output" and "--ou".
std::string NearestFlag(const std::string& flag, const std::vector<std::string>& known);

// "; did you mean 'cell_m'?" and what is known: "; known: cell_m, heading_deg".
std::string Suggest(const std::string& word, const std::vector<std::string>& known);

std::string Join(const std::vector<std::string>& words);

}  // namespace cairn::cli
