#include "datasets/import/pose_track.h"

#include <algorithm>
#include <cmath>

#include "datasets/common/unit_doubts.h"
#include "datasets/import/csv_reader.h"
#include "datasets/import/row_times.h"
#include "schema/error.h"

namespace cairn::datasets {

PoseTracks::PoseTracks(const std::string& path, double smooth_s, BadLines* bad) {
  CsvReader reader(path,
                   {{"time_s", "x_m", "y_m", "heading_rad", "run"},
                    {"time_s", "x_m", "y_m", "heading_rad"},
                    {"time_s", "x_m", "y_m", "run"},
                    {"time_s", "x_m", "y_m"}},
                   bad);
  has_heading_ = reader.header() < 2;
  has_runs_ = reader.header() % 2 == 0;
  while (reader.Next()) {
    const auto time = reader.Number(0), x = time ? reader.Number(1) : time, y = x ? reader.Number(2) : x,
               heading = y && has_heading_ ? reader.Number(3) : y;
    if (!heading) continue;
    Track& track = tracks_[has_runs_ ? std::string(reader.Text(has_heading_ ? 4 : 3)) : ""];
    if (!track.time_s.empty() && *time <= track.time_s.back()) {
      reader.Bad("time does not run forward", std::to_string(*time) + " after " +
                                                  std::to_string(track.time_s.back()) +
                                                  HintOfSameTime(*time, track.time_s.back()));
      continue;
    }
    track.time_s.push_back(*time);
    track.x_m.push_back(*x);
    track.y_m.push_back(*y);
    if (has_heading_) track.heading_rad.push_back(*heading);
    track.cos.push_back(std::cos(has_heading_ ? *heading : 0));
    track.sin.push_back(std::sin(has_heading_ ? *heading : 0));
  }
  if (tracks_.empty()) throw InputError(path + ": there is no track in it");
  for (auto& [run, track] : tracks_) {
    if (track.time_s.size() < 2)
      throw InputError(path + ": a track has two rows or more; " +
                       (run.empty() ? "it" : "that of '" + run + "'") + " has one");
    if (const auto doubt = DoubtPoses(track.time_s, track.x_m, track.y_m, track.heading_rad))
      unit_doubts_.push_back(DoubtText(
          "", path + (run.empty() ? ": the track" : ": the track of '" + run + "'"), "poses", *doubt));
    track.Smooth(smooth_s);
  }
}

void PoseTracks::Track::Smooth(double smooth_s) {
  const auto smoothed = [&](const std::vector<double>& values) {
    std::vector<double> means;
    std::size_t first = 0, end = 0;
    for (const double t : time_s) {
      while (time_s[first] < t - smooth_s / 2) ++first;
      while (end < time_s.size() && time_s[end] <= t + smooth_s / 2) ++end;
      double sum = 0;
      for (std::size_t k = first; k < end; ++k) sum += values[k];
      means.push_back(sum / static_cast<double>(end - first));
    }
    return means;
  };
  for (std::vector<double>* values : {&x_m, &y_m, &cos, &sin}) *values = smoothed(*values);
}

std::optional<TrackedPose> PoseTracks::At(const std::string& run, double time_s, double most_gap_s) const {
  const auto found = tracks_.find(has_runs_ ? run : "");
  if (found == tracks_.end()) return std::nullopt;
  const Track& track = found->second;
  const auto next = std::ranges::lower_bound(track.time_s, time_s);
  if (next == track.time_s.end()) return std::nullopt;
  const auto after = static_cast<std::size_t>(next - track.time_s.begin());
  if (after == 0 && *next > time_s) return std::nullopt;
  const std::size_t before = after == 0 ? 0 : after - 1;
  const double gap = *next - track.time_s[before];
  if (gap > most_gap_s && *next > time_s) return std::nullopt;
  const double share = gap > 0 ? (time_s - track.time_s[before]) / gap : 0;
  const auto between = [&](const std::vector<double>& values) {
    return values[before] + share * (values[after] - values[before]);
  };
  return TrackedPose{between(track.x_m), between(track.y_m),
                     std::atan2(between(track.sin), between(track.cos))};
}

}  // namespace cairn::datasets
