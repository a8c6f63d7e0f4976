#include "pipelines/local_map/traces/match.h"

#include <algorithm>
#include <cmath>

namespace cairn::local_map {
namespace {

struct Sought {
  const Profile &along, &sides;
  Peak z, u;
};

// The sharpest position of a profile; where that is not determined the assumed one.
Peak PeakOf(const Profile& profile, const MatchOptions& options) {
  const Peak peak = profile.FindPeak(options.sharpness);
  return std::isfinite(peak.sd_m) ? peak : Peak{0, profile[0], peak.sd_m, true};
}

// [DM98] section 4.2: 'The proposed correction is only accepted if it improves significantly edge and sides
// similarities over the initial position.'
Verdict Judge(const Match& match, const Sought& found, const MatchOptions& options) {
  if (match.known < options.min_known) return Verdict::kUnknown;
  if (std::isinf(match.sd_z_m) && std::isinf(match.sd_u_m)) return Verdict::kUnknown;
  if (match.sides_after <= 0 || !found.z.inside || !found.u.inside) return Verdict::kRefused;
  if (std::hypot(found.z.at_m, found.u.at_m) <= options.kept_m) return Verdict::kConfirmed;
  const double gain = found.z.value - found.along[0] + found.u.value - found.sides[0];
  return gain >= options.min_gain ? Verdict::kCorrected : Verdict::kRefused;
}

Match MatchOf(const OnTrace& on, const Sought& found, const MatchOptions& options) {
  Match match;
  match.z_m = on.at.z_m + found.z.at_m;
  match.u_m = on.at.u_m + found.u.at_m;
  match.sd_z_m = std::hypot(found.z.sd_m, options.floor_sd_m);
  match.sd_u_m = std::hypot(found.u.sd_m, options.floor_sd_m);
  ScoreOptions all = options.score;
  all.scheme = Scheme::kAverage;
  match.known = SidesScore(on, static_cast<int>(std::lround(on.ShiftOf(match.z_m))), match.u_m, all).known;
  const double each = 1.0 / std::max(match.known, 1);
  match.along_before = found.along[0] * each;
  match.along_after = found.z.value * each;
  match.sides_before = found.sides[0] * each;
  match.sides_after = found.u.value * each;
  match.verdict = Judge(match, found, options);
  return match;
}

// Adds a profile whose steps run the same way (1) or the opposite one (-1).
void Add(Profile& profile, const Profile& other, int sign) {
  for (int step = -profile.reach(); step <= profile.reach(); ++step) profile[step] += other[sign * step];
}

Peak AlongTrace(const Peak& peak, int sign) { return {sign * peak.at_m, peak.value, peak.sd_m, peak.inside}; }

}  // namespace

Match Correct(const OnTrace& on, const SearchWindow& range, const MatchOptions& options) {
  // [DM98] section 4.2: first z by edges and widths, then u by sides.
  Profile along = AlongProfile(on, range.z_m, options.score);
  Peak z = PeakOf(along, options);
  Profile sides = SidesProfile(on, z.at_m, range.u_m, options.score);
  Peak u = PeakOf(sides, options);
  if (options.again) {
    along = AlongProfileAt(on, on.at.u_m + u.at_m, range.z_m, options.score);
    z = PeakOf(along, options);
    sides = SidesProfile(on, z.at_m, range.u_m, options.score);
    u = PeakOf(sides, options);
  }
  return MatchOf(on, {along, sides, z, u}, options);
}

PairMatch CorrectPair(const OnTrace& first, const OnTrace& second, int quarter, const SearchWindow& range,
                      const MatchOptions& one) {
  MatchOptions options = one;
  options.sharpness /= 2;  // what lies across the one way lies along the other: each wall speaks twice
  // A robot that moves by (dz, du) on the first moves by (quarter du, -quarter dz) on the second.
  // [DM98] section 4.2: pairs of two orthogonal connected traces
  Profile z = AlongProfile(first, range.z_m, options.score);
  Profile u = AlongProfile(second, range.u_m, options.score);
  Peak best_z = PeakOf(z, options), best_u = PeakOf(u, options);  // `u` runs as the second's z
  for (int turn = 0; turn < (options.again ? 2 : 1); ++turn) {
    if (turn > 0) {
      z = AlongProfileAt(first, first.at.u_m + quarter * best_u.at_m, range.z_m, options.score);
      u = AlongProfileAt(second, second.at.u_m - quarter * best_z.at_m, range.u_m, options.score);
    }
    Add(z, SidesProfile(second, best_u.at_m, range.z_m, options.score), -quarter);
    Add(u, SidesProfile(first, best_z.at_m, range.u_m, options.score), quarter);
    best_z = PeakOf(z, options);
    best_u = PeakOf(u, options);
  }
  return {MatchOf(first, {z, u, best_z, AlongTrace(best_u, quarter)}, options),
          MatchOf(second, {u, z, best_u, AlongTrace(best_z, -quarter)}, options)};
}

}  // namespace cairn::local_map
