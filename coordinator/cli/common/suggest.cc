#include "coordinator/cli/common/suggest.h"

#include <algorithm>
#include <limits>

namespace cairn::cli {
namespace {

// Optimal string alignment distance, row by row.
std::size_t Edits(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, replace});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::string Nearest(const std::string& word, const std::vector<std::string>& known) {
  std::string best;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const std::string& candidate : known) {
    const std::size_t edits = Edits(word, candidate);
    const bool near = edits <= std::max<std::size_t>(1, candidate.size() / 3);
    if (near && edits < least) {
      best = candidate;
      least = edits;
    }
  }
  return best;
}

std::string NearestFlag(const std::string& flag, const std::vector<std::string>& known) {
  constexpr std::size_t kDashes = 2, kFewLetters = 4, kMostEdits = 2;
  // The one of the fewest edits; of those of as many the one that begins with the same letter.
  std::string best;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const std::string& candidate : known) {
    const std::size_t edits = Edits(flag, candidate);
    const bool begins_alike =
        flag.size() > kDashes && candidate.size() > kDashes && flag[kDashes] == candidate[kDashes];
    const std::size_t bearable = std::max<std::size_t>(
        begins_alike && flag.size() > kFewLetters ? kMostEdits : 1, candidate.size() / 3);
    const std::size_t rank = 2 * edits + (begins_alike ? 0 : 1);
    if (edits > bearable || rank >= least) continue;
    best = candidate;
    least = rank;
  }
  if (!best.empty()) return best;
  for (const std::string& candidate : known)
    if (flag.size() >= kFewLetters && (candidate.starts_with(flag) || flag.starts_with(candidate)))
      return candidate;
  return "";
}

std::string Suggest(const std::string& word, const std::vector<std::string>& known) {
  const std::string nearest = Nearest(word, known);
  const std::string hint = nearest.empty() ? "" : "; did you mean '" + nearest + "'?";
  return hint + (known.empty() ? "; there are none" : "; known: " + Join(known));
}

std::string Join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace cairn::cli
