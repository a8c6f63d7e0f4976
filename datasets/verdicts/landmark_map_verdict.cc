#include "datasets/verdicts/landmark_map_verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "datasets/verdicts/calibration_doubts.h"
#include "datasets/verdicts/landmarks_on_one_side.h"
#include "datasets/verdicts/landmarks_seen_once.h"
#include "datasets/verdicts/moved_landmarks.h"
#include "datasets/verdicts/odometry_gap_doubts.h"
#include "datasets/verdicts/robot_place_doubts.h"
#include "datasets/verdicts/width_doubts.h"
#include "schema/kinds/landmark_map.h"
#include "schema/text.h"

namespace cairn::datasets {
namespace {

// How many of the maps that were called so were right: 375 of 376, 27 of 30, 4 of 13.
const char* Frequency(Confidence confidence) {
  if (confidence == Confidence::kHigh) return "99 of 100";
  return confidence == Confidence::kFair ? "9 of 10" : "3 of 10";
}

// In what the job differs from those on which the rates were measured; none: in nothing.
std::optional<std::string> Unlike(const kinds::LandmarkMap::Search& search) {
  if (!search.unlike) return "the file does not say what it was made from";
  std::string all;
  for (const std::string& what : search.unlike) all += (all.empty() ? "" : ", ") + what;
  if (all.empty()) return {};
  return all;
}

std::string FoundText(const kinds::LandmarkMap::Search& search) {
  const std::optional<double> lead = search.lead_nats.Optional();
  const std::string ahead =
      lead ? fmt::format("{:.1f} nats ahead of the next different map", *lead) : "no other map was found";
  return fmt::format("found from {} of {} starts, {}", search.support.Or(0), search.starts.Or(0), ahead);
}

// Without a search, and nothing else to judge the map by.
std::string WhyNothingIsKnown(const Blob& result) {
  const auto map = Read<kinds::LandmarkMap>(result);
  const std::string why = "there was no search";
  if (const std::string reason = map.refinement_reason ? map.refinement_reason.Scalar() : "";
      reason.starts_with("not tried"))
    return why + ", nor a refinement whose residuals would tell (" + reason + ")";
  const auto& identity = map.map.landmark_identity.OrNone();
  const bool named = !identity.empty() && std::ranges::all_of(identity, [](int id) { return id >= 0; });
  if (!named || map.refinement_done.Or(0) == 0) return why;
  return why +
         ", as observations name their landmarks; nor have contact detections a range or bearing whose "
         "errors "
         "would tell: compare the map with landmarks or poses that you know (cairn import csv "
         "--truth-landmarks, --truth-poses; cairn evaluate)";
}

// What the search says of the map it chose.
Verdict SearchVerdict(const Blob& result, std::size_t robots, bool at_a_distance, const SeenOnce& seen) {
  Verdict verdict;
  const auto search = FieldsIn<kinds::LandmarkMap::Search>("search/", result);
  const Confidence confidence = ReadConfidence(result);
  if (confidence == Confidence::kNone) {
    verdict.why = WhyNothingIsKnown(result);
    return verdict;
  }
  verdict.numbers = {{"starts", search.starts.Or(0)}, {"starts_that_found_it", search.support.Or(0)}};
  if (const auto lead = search.lead_nats.Optional()) verdict.numbers.emplace_back("lead_nats", *lead);
  const std::string found = FoundText(search);
  if (result.Has("refinement/along_odometry")) {
    verdict.trust = Confidence::kLow;
    verdict.why =
        "no map that the search found explains the observations; this one lies along odometry, so that what "
        "the "
        "robot came back to may be there twice, and its path may be no better than odometry's: names of some "
        "landmarks would tell, or how the odometry errs (--heading-drift-rad-per-m, "
        "--heading-walk-rad-per-sqrt-m)";
  } else if (search.starts.Or(0) == 1) {
    verdict.why = "EM started once, no other map to compare with";
    if (search.why) verdict.why += " (" + search.why.Scalar() + ")";
  } else if (at_a_distance) {
    const bool few = 4 * search.support.Scalar() < search.starts.Or(0);
    verdict.trust = few ? std::min(confidence, Confidence::kFair) : confidence;
    verdict.why = found;
  } else if (const auto unlike = Unlike(search)) {
    if (confidence == Confidence::kLow) verdict.trust = confidence;  // no rate is needed to doubt it
    verdict.why = found + "; how often such maps are right was not measured (" + *unlike + ")";
  } else if (robots > 1) {
    verdict.trust = std::min(confidence, Confidence::kFair);
    verdict.why =
        std::string("of several robots right in ") + Frequency(verdict.trust) + " such simulations; " + found;
  } else if (seen.passed_again > 0) {
    verdict.trust = confidence;  // what it is of logs with false observations was not measured
    verdict.why = found;
  } else {
    verdict.trust = confidence;
    verdict.why = std::string("right in ") + Frequency(confidence) +
                  " such simulations, which have no false observations; " + found;
  }
  return verdict;
}

// The name of the landmark that more than half of the misfits are of, though not half of the observations;
// empty: there is none.
std::string LandmarkThatMoves(const kinds::LandmarkMap& map) {
  constexpr std::int64_t kLeast = 5;
  const kinds::LandmarkMap::Fit& fit = map.fit;
  const std::int64_t misfits = fit.landmark_misfits.Or(0), seen = fit.landmark_observations.Or(0);
  if (fit.misfit_landmark.Or(-1) < 0 || misfits < kLeast || 2 * misfits <= fit.misfits.Scalar() ||
      2 * seen >= fit.observations.Scalar())
    return "";
  return map.landmarks[static_cast<std::size_t>(fit.misfit_landmark.Scalar())];
}

Verdict::Doubt OfMisfits(const kinds::LandmarkMap& map) {
  const kinds::LandmarkMap::Fit& fit = map.fit;
  constexpr double kFew = 0.03, kMany = 0.2, kGross = 6;
  const std::int64_t observations = fit.observations.Scalar(), misfits = fit.misfits.Scalar();
  if (misfits == 0) return {Confidence::kHigh};
  const double share = static_cast<double>(misfits) / static_cast<double>(observations);
  const double worst = fit.worst_sigmas.OrNone().empty() ? 0 : fit.worst_sigmas.OrNone().front();
  const double time_s = fit.worst_time_s.OrNone().empty() ? 0 : fit.worst_time_s.OrNone().front();
  const std::string moves = LandmarkThatMoves(map);
  return {std::min(AtMost(share, kFew, kMany), worst < kGross ? Confidence::kHigh : Confidence::kFair),
          fmt::format(
              "{} of {} observations {} not fit the map, the worst is {:.1f} standard deviations off, "
              "at {:.1f} s{}",
              misfits, observations, misfits == 1 ? "does" : "do", worst, time_s,
              moves.empty()
                  ? ""
                  : "; most of them are of landmark '" + moves +
                        "': does it move, or one that is seen with it? Leave its rows out and look again")};
}

Verdict::Doubt OfRun(const kinds::LandmarkMap::Fit& fit) {
  constexpr std::int64_t kLong = 5;
  if (fit.longest_run.Scalar() < kLong) return {Confidence::kHigh};
  return {Confidence::kFair,
          fmt::format("{} in a row do not from {:.1f} s on: were names exchanged, or was a landmark or the "
                      "robot moved?",
                      fit.longest_run.Scalar(), fit.longest_run_from_s.Scalar())};
}

// Landmarks in a regular pattern: what was seen before a long way without any fits as well among their
// neighbours.
Verdict::Doubt OfPattern(const kinds::LandmarkMap& map, Verdict* verdict) {
  constexpr double kTold_nats = 10;
  const kinds::LandmarkMap::Fit& fit = map.fit;
  if (!fit.shift_lead_nats) return {Confidence::kHigh};
  const double lead_nats = fit.shift_lead_nats.Scalar();
  const bool taken = fit.shift_taken.Or(0) != 0;
  verdict->numbers.emplace_back("shift_lead_nats", lead_nats);
  if (lead_nats >= kTold_nats && !taken) return {Confidence::kHigh};
  const std::string seen = fmt::format("what was seen from {:.1f} to {:.1f} s is {:.1f} m further on",
                                       fit.shift_from_s.Or(0), fit.shift_until_s.Or(0), fit.shift_m.Or(0));
  if (lead_nats >= kTold_nats)
    return {Confidence::kFair,
            fmt::format("landmarks stand in a regular pattern: EM's own map, in which {}, is {:.1f} nats "
                        "behind",
                        seen, lead_nats)};
  return {Confidence::kLow,
          fmt::format(
              "landmarks stand in a regular pattern: a map in which {} is {:.1f} nats {}; a name for one or "
              "two landmarks would tell, or a landmark that breaks the pattern",
              seen, std::abs(lead_nats), lead_nats < 0 ? "ahead" : "behind")};
}

// Of the landmarks, the longer side of their box.
double ExtentM(const kinds::LandmarkMap::Map& map) {
  double extent_m = 0;
  for (const std::span<const double> along : {map.landmark_x_m.OrNone(), map.landmark_y_m.OrNone()}) {
    if (along.empty()) continue;
    const auto [least, most] = std::ranges::minmax(along);
    extent_m = std::max(extent_m, most - least);
  }
  return extent_m;
}

// A map may be as exact as it says and yet too vague to be called right.
Verdict::Doubt OfUncertainty(const kinds::LandmarkMap& map, Verdict* verdict) {
  constexpr double kVague_m = 1, kVagueShare = 1.0 / 50;  // the latter of a large map
  constexpr double k95 = 5.991;                           // chi-square of two degrees of freedom
  double most_m2 = 0;
  const std::span<const double> c = map.map.landmark_covariance_m2.OrNone();
  for (std::size_t i = 0; i + 3 < c.size(); i += 4) {
    const double mean = (c[i] + c[i + 3]) / 2;
    most_m2 = std::max(most_m2, mean + std::hypot((c[i] - c[i + 3]) / 2, c[i + 1]));
  }
  if (most_m2 == 0) return {Confidence::kHigh};
  const double radius_m = std::sqrt(k95 * most_m2);
  verdict->numbers.emplace_back("worst_landmark_95_m", radius_m);
  if (radius_m <= std::max(kVague_m, kVagueShare * ExtentM(map.map))) return {Confidence::kHigh};
  return {Confidence::kFair,
          fmt::format("by its own account the least certain landmark may be {:.1f} m off", radius_m)};
}

// Without names only their own agreement tells maps apart: a sensor that errs more than it should, or a path
// that breaks, weighs more where most starts led to another map.
Verdict::Doubt WhereStartsDisagree(const kinds::LandmarkMap& map, Verdict::Doubt doubt) {
  const bool disagree = map.search.support && 2 * map.search.support.Scalar() < map.search.starts.Or(0);
  if (doubt.at_most == Confidence::kHigh || !disagree) return doubt;
  return {Confidence::kLow, doubt.text + "; most starts led to another map"};
}

// Where landmarks have no names: false observations, which may make landmarks where they fall together.
Verdict::Doubt OfFalse(bool all_named, double explained_share) {
  constexpr double kMost = 0.02;
  const bool many = !all_named && 1 - explained_share > kMost;
  return {many ? Confidence::kFair : Confidence::kHigh};
}

// Of landmarks that observations name there is no search: the fit of the least squares is what the verdict
// rests on. Else it may lower what the search says.
void JudgeFit(const kinds::LandmarkMap& map, double explained_share, const SeenOnce& seen, Verdict* verdict) {
  constexpr std::int64_t kMany = 50;
  constexpr double kNearlyAll = 0.9;
  const kinds::LandmarkMap::Fit& fit = map.fit;
  if (!fit.observations) return;
  const std::int64_t observations = fit.observations.Scalar(), misfits = fit.misfits.Scalar();
  verdict->numbers.emplace_back("observations_fitted", static_cast<double>(observations));
  verdict->numbers.emplace_back("misfits", static_cast<double>(misfits));
  verdict->numbers.emplace_back("misfits_in_a_row", static_cast<double>(fit.longest_run.Scalar()));
  verdict->numbers.emplace_back("odometry_misfits", static_cast<double>(fit.odometry_misfits.Or(0)));
  const bool all_named =
      std::ranges::all_of(map.map.landmark_identity.OrNone(), [](int id) { return id >= 0; });
  const bool named = !map.search.support && all_named;
  // What is seen once fits wherever it was: it tests nothing.
  const std::int64_t testing = observations - static_cast<std::int64_t>(seen.once);
  const bool many = testing >= kMany && explained_share >= kNearlyAll;
  const Confidence by_number = testing <= 0 ? Confidence::kNone
                               : many       ? Confidence::kHigh
                                            : Confidence::kFair;
  verdict->trust = named ? by_number : std::min(verdict->trust, by_number);
  const std::string fitted =
      testing <= 0 ? "no landmark was observed twice, so nothing tests the map"
                   : fmt::format("{} observations fit the map", std::max<std::int64_t>(0, testing - misfits));
  verdict->why = named ? fitted : verdict->why + "; " + fitted;
  verdict->Add(OfSeenOnce(seen, true));
  for (const Verdict::Doubt& doubt :
       {OfMisfits(map),
        OfFalse(all_named, explained_share),
        WhereStartsDisagree(map, OfWidths(fit, all_named, !LandmarkThatMoves(map).empty())),
        OfMuchLeftOut(fit, all_named, explained_share),
        WhereStartsDisagree(map, OfRun(fit)),
        WhereStartsDisagree(map, OfJumps(map)),
        OfHalves(fit),
        OfLandmarksOnOneSide(map, verdict),
        OfFewInCommon(map, verdict),
        OfHoles(map, verdict),
        OfPlaces(map, verdict),
        OfChance(map, verdict),
        OfPattern(map, verdict),
        OfOneSided(map, verdict),
        OfUncertainty(map, verdict),
        OfDistances(map, verdict),
        OfTurns(map, verdict),
        OfClocks(map, verdict),
        OfMounts(map, verdict),
        OfRangeOffsets(map, verdict)}) {
    verdict->Add(doubt);
  }
}

}  // namespace

Confidence ReadConfidence(const Blob& result) {
  constexpr std::int32_t kFairSupport = 2, kHighSupport = 3;
  constexpr double kFairLead = 3.0, kHighLead = 10.0;
  const auto search = FieldsIn<kinds::LandmarkMap::Search>("search/", result);
  if (!search.support) return Confidence::kNone;
  const std::int32_t support = search.support.Scalar();
  const double lead = search.lead_nats.Or(std::numeric_limits<double>::infinity());
  if (support >= kHighSupport && lead >= kHighLead) return Confidence::kHigh;
  return support >= kFairSupport && lead >= kFairLead ? Confidence::kFair : Confidence::kLow;
}

std::string NotRefined(const Blob& result) {
  const Texts reason = Texts::In(result, "refinement/reason");
  return reason ? reason.Scalar() : "";
}

bool OdometryContradicts(const Blob& result) {
  return NotRefined(result) == std::string("refused: ") + kinds::kOdometryWrongByHalf;
}

// Nobody looks for what is not there.
Verdict::Doubt OfMissing(const kinds::LandmarkMap& map) {
  std::vector<std::string> names;
  for (const std::int32_t name : map.missing_landmarks.OrNone())
    names.push_back(map.landmarks[static_cast<std::size_t>(name)]);
  if (names.empty()) return {Confidence::kHigh};
  std::string text =
      fmt::format("{} landmark{} seen and {} not in it: {}", names.size(),
                  names.size() == 1 ? " was" : "s were", names.size() == 1 ? "is" : "are", NameList(names));
  if (map.robot.size() > 1)
    text +=
        "; without ranges, or without refinement, what a robot saw before it came to a landmark of the first "
        "robot's is not used: let the one come first that saw most";
  return {Confidence::kFair, text};
}

bool RefinementRefused(const Blob& result) { return NotRefined(result).starts_with("refused"); }

Verdict LandmarkMapVerdict(const Blob& result) {
  const auto map = Read<kinds::LandmarkMap>(result);
  const SeenOnce seen = CountSeenOnce(map);
  const bool at_a_distance = map.fit.observations.Or(0) > 0;
  Verdict verdict = SearchVerdict(result, map.robot.size(), at_a_distance, seen);
  std::size_t observations = 0, explained = 0;
  for (const auto& robot : map.robot) {
    observations += robot.map_landmark.OrNone().size();
    for (const std::int32_t landmark : robot.map_landmark.OrNone()) explained += landmark >= 0;
  }
  // What was left out counts neither way.
  if (map.until_observations)
    observations = std::clamp<std::size_t>(static_cast<std::size_t>(*map.until_observations.Optional()),
                                           explained, observations);
  verdict.AddCount("observations", observations);
  verdict.AddCount("observations_explained", explained);
  const auto all = static_cast<double>(std::max<std::size_t>(1, observations));
  verdict.AddCount("landmarks_observed_once", seen.once);
  verdict.AddCount("of_them_passed_again", seen.passed_again);
  if (map.search.support && !at_a_distance) {
    verdict.Add(OfSeenOnce(seen, false));
    verdict.Add(OfPlaces(map, &verdict));
  }
  JudgeFit(map, static_cast<double>(explained) / all, seen, &verdict);
  if (explained < observations)
    verdict.why +=
        fmt::format("; {} of {} observations {} of none of its landmarks", observations - explained,
                    observations, observations - explained == 1 ? "is" : "are");
  if (2 * explained < observations) verdict.trust = Confidence::kLow;
  verdict.Add(OfMissing(map));
  for (const std::string& doubt : map.observation_doubts.OrNone()) verdict.Add({Confidence::kLow, doubt});
  if (const std::string moved = MovedText(result); !moved.empty()) {
    verdict.trust = std::min(verdict.trust, Confidence::kFair);
    verdict.why += "; " + moved;
  }
  if (RefinementRefused(result)) {
    const bool none = result.Has("map/landmark_x_m") && result.Get<double>("map/landmark_x_m").empty();
    verdict.why += "; refinement was " + NotRefined(result) +
                   (none ? ", no landmark was found" : ", the landmarks stand where EM left them");
    if (OdometryContradicts(result)) verdict.trust = Confidence::kLow;
  }
  return verdict;
}

}  // namespace cairn::datasets
