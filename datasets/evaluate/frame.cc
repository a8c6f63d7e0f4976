#include "datasets/evaluate/frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace cairn::datasets {
namespace {

constexpr double kFrameTimesBetter = 5, kFrameLeastOff_m = 0.1, kLeastScale = 1.5;
constexpr std::size_t kLeastFramePairs = 4;

const char* QuestionOf(double scale) {
  constexpr std::array kUnits = {
      std::pair{1000.0, "are they in millimetres?"},
      std::pair{100.0, "are they in centimetres?"},
      std::pair{39.37, "are they in inches?"},
      std::pair{3.2808, "are they in feet?"},
      std::pair{0.3048, "is the map in feet?"},
      std::pair{0.01, "are they in metres, under a header that says _cm?"},
      std::pair{0.001, "are they in kilometres, or in metres under a header that says _mm?"}};
  constexpr double kNear = 0.05;
  for (const auto& [per, question] : kUnits)
    if (std::abs(scale / per - 1) < kNear) return question;
  return "are they in another unit?";
}

std::vector<PointPair> Mirrored(std::vector<PointPair> pairs) {
  for (PointPair& pair : pairs) std::swap(pair.to.x_m, pair.to.y_m);
  return pairs;
}

}  // namespace

std::string OtherFrame::Text() const {
  const bool scaled = scale != 1;
  std::string changed, questions;
  if (scaled) {
    const double times = std::max(scale, 1 / scale);
    changed = scale > 1 ? "divided by " : "multiplied by ";
    changed += times < 100 ? fmt::format("{:.3g}", times) : fmt::format("{:.0f}", times);
    questions = QuestionOf(scale);
  }
  if (mirrored) {
    changed += std::string(scaled ? " and " : "") + "mirrored";
    questions += std::string(scaled ? " " : "") + "are x and y exchanged, or an axis reversed?";
  }
  return fmt::format("with the true positions {} the map's would be {:.3f} m off: {}", changed, rmse_m,
                     questions);
}

std::optional<OtherFrame> FindOtherFrame(const std::vector<PointPair>& pairs) {
  if (pairs.size() < kLeastFramePairs) return std::nullopt;
  double least_m = RmseM(pairs, FitRigid(pairs));
  if (least_m < kFrameLeastOff_m) return std::nullopt;
  std::optional<OtherFrame> best;
  const auto look_at = [&](const std::vector<PointPair>& seen, const Similarity& fit, bool mirrored) {
    const double truth_m = RmseM(seen, fit), map_m = truth_m / fit.scale;
    // In both units: onto one point, of the map or of the truth, everything fits in the other's.
    const double rmse_m = std::max(truth_m, map_m);
    if (rmse_m * kFrameTimesBetter >= least_m) return;
    least_m = rmse_m;
    best = OtherFrame{fit.scale, mirrored, map_m};
  };
  for (const bool mirrored : {false, true}) {
    const std::vector<PointPair> seen = mirrored ? Mirrored(pairs) : pairs;
    if (mirrored) look_at(seen, FitRigid(seen), mirrored);
    const Similarity scaled = FitSimilarity(seen);
    if (std::max(scaled.scale, 1 / scaled.scale) >= kLeastScale) look_at(seen, scaled, mirrored);
  }
  return best;
}

void AddFrame(const std::string& group, const std::optional<OtherFrame>& frame, Scores* scores) {
  const auto add = [&](const char* name, const auto& value) {
    scores->AddForPrograms(group + ".frame_" + name, frame ? ScoreValue(value(*frame)) : ScoreValue());
  };
  add("scale", [](const OtherFrame& of) { return of.scale; });
  add("mirrored", [](const OtherFrame& of) { return of.mirrored; });
  add("rmse_m", [](const OtherFrame& of) { return of.rmse_m; });
  if (frame) scores->AddForPeople(group + ".frame", frame->Text());
}

}  // namespace cairn::datasets
