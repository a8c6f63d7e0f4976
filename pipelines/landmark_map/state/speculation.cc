#include "pipelines/landmark_map/state/speculation.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "pipelines/landmark_map/state/partial.h"

namespace cairn::landmark_map {
namespace {

bool AgreeIn(const Layer& guess, const Layer& truth) {
  constexpr double kRatio = 1e-7;
  if (guess.box.empty() || truth.box.empty()) return guess.box.empty() == truth.box.empty();
  if (guess.box != truth.box) return false;
  for (std::size_t i = 0; i < guess.values.size(); ++i) {
    const double a = guess.values[i], b = truth.values[i];
    if ((a > 0.0) != (b > 0.0)) return false;
    if (std::abs(a - b) > kRatio * b) return false;
  }
  return true;
}

std::string WarmPrefix(std::size_t slice) { return "warm/" + std::to_string(slice) + "/"; }

}  // namespace

void Guesses::AddEarlier(const Blob& partial) {
  if (!warm.empty()) warm.front() = CopyOf(partial.Sub("warm/"));
  first.insert(first.begin(), partial.Scalar<std::int32_t>("first"));
  warm.insert(warm.begin(), Blob());
}

Blob Guesses::ToBlob() const {
  Blob blob;
  blob.PutVector("first", first);
  for (std::size_t s = 0; s < warm.size(); ++s) blob.PutAll(WarmPrefix(s), warm[s]);
  return blob;
}

Guesses Guesses::FromBlob(const Blob& blob) {
  Guesses guesses;
  const auto first = blob.Get<std::int32_t>("first");
  guesses.first.assign(first.begin(), first.end());
  for (std::size_t s = 0; s < first.size(); ++s) guesses.warm.push_back(blob.Sub(WarmPrefix(s)));
  return guesses;
}

std::vector<bool> WorthGuessing(const Guesses& guesses, std::int64_t steps, std::int64_t overlap,
                                const Schedule& next) {
  const std::size_t slices = guesses.first.size();
  std::vector<bool> worth(slices, false);
  if (next.settled < kSharpAfter) return worth;
  for (std::size_t s = 0; s < slices; ++s) {
    const std::int64_t end = s + 1 < slices ? guesses.first[s + 1] : steps;
    const bool known = s == 0 || !guesses.warm[s].fields().empty();
    worth[s] = known && end - guesses.first[s] >= 2 * overlap;
  }
  const bool any = std::find(worth.begin() + std::min<std::ptrdiff_t>(1, std::ssize(worth)), worth.end(),
                             true) != worth.end();
  if (!any) worth.assign(slices, false);
  return worth;
}

bool TooShort(std::int64_t guessed, std::int64_t confirmed) {
  constexpr std::int64_t kOneIn = 4;
  return kOneIn * (guessed - confirmed) > guessed;
}

bool Agree(const LayeredGrid& guess, const LayeredGrid& truth) {
  if (guess.layers.size() != truth.layers.size()) return false;
  for (std::size_t c = 0; c < guess.layers.size(); ++c) {
    if (!AgreeIn(guess.layers[c], truth.layers[c])) return false;
  }
  return true;
}

}  // namespace cairn::landmark_map
