#include "datasets/evaluate/testing/perfect_result.h"

#include <algorithm>
#include <vector>

#include "datasets/evaluate/matching/associations.h"
#include "datasets/evaluate/track.h"

namespace cairn::datasets {
namespace {

void PutPoses(const std::string& prefix, const Track& track, Blob& result) {
  std::vector<double> x, y, heading;
  for (const Pose& pose : track.poses) {
    x.push_back(pose.x_m);
    y.push_back(pose.y_m);
    heading.push_back(pose.heading_rad);
  }
  result.PutVector(prefix + "time_s", track.time_s);
  for (const char* field : {"", "mode_"}) {
    result.PutVector(prefix + field + "x_m", x);
    result.PutVector(prefix + field + "y_m", y);
    result.PutVector(prefix + field + "heading_rad", heading);
  }
  const auto rows = static_cast<std::int64_t>(x.size());
  result.Put(prefix + "covariance", Array::Of<double>({rows, 3, 3}, std::vector<double>(x.size() * 9, 0.0)));
}

// Index in the map of each true landmark; -1: never observed. `counts`: of each true one's observations.
std::vector<std::int32_t> MapIndices(const std::vector<double>& counts) {
  std::vector<std::int32_t> indices;
  indices.reserve(counts.size());
  std::int32_t next = 0;
  for (const double count : counts) indices.push_back(count > 0 ? next++ : -1);
  return indices;
}

// Index into the log's `landmarks` of the true landmark; -1 where it has no identity.
std::int32_t IdentityOf(const Blob& log, std::size_t truth) {
  if (!log.Has("truth/landmarks/name")) return -1;
  const std::vector<std::string> names = log.Texts("landmarks");
  const auto it = std::find(names.begin(), names.end(), log.Texts("truth/landmarks/name")[truth]);
  return it == names.end() ? -1 : static_cast<std::int32_t>(it - names.begin());
}

void PutMap(const Blob& log, const std::vector<double>& counts, Blob& result) {
  const auto x = log.Get<double>("truth/landmarks/x_m");
  const auto y = log.Get<double>("truth/landmarks/y_m");
  std::vector<double> map_x, map_y, map_counts;
  std::vector<std::int32_t> identity;
  for (std::size_t t = 0; t < counts.size(); ++t) {
    if (counts[t] == 0) continue;
    map_x.push_back(x[t]);
    map_y.push_back(y[t]);
    map_counts.push_back(counts[t]);
    identity.push_back(IdentityOf(log, t));
  }
  const auto landmarks = static_cast<std::int64_t>(map_x.size());
  result.PutVector("map/landmark_x_m", map_x);
  result.PutVector("map/landmark_y_m", map_y);
  result.Put("map/landmark_covariance_m2",
             Array::Of<double>({landmarks, 2, 2}, std::vector<double>(map_x.size() * 4, 0.0)));
  result.PutVector("map/landmark_identity", identity);
  result.PutVector("map/landmark_count", map_counts);
}

}  // namespace

Blob PerfectLandmarkMap(const Blob& truth_log) {
  const std::size_t landmarks = truth_log.Get<double>("truth/landmarks/x_m").size();
  const auto associations = ReadTrueAssociations(Read<kinds::Log>(truth_log), landmarks);
  if (!associations) throw InputError("the log's truth does not say which landmark each observation is of");
  std::vector<double> counts(landmarks, 0.0);
  for (const auto& robot : *associations) {
    for (const std::int32_t t : robot) {
      if (t >= 0) ++counts[static_cast<std::size_t>(t)];
    }
  }
  const std::vector<std::int32_t> map_index = MapIndices(counts);
  Blob result;
  result.Put("robots", truth_log.at("robots"));
  result.Put("landmarks", truth_log.at("landmarks"));
  for (std::size_t r = 0; r < associations->size(); ++r) {
    const std::string robot = "robot/" + std::to_string(r);
    PutPoses(robot + "/poses/", ReadTrack(truth_log, "truth/" + robot + "/poses/"), result);
    std::vector<std::int32_t> map_landmark;
    for (const std::int32_t t : (*associations)[r]) {
      map_landmark.push_back(t < 0 ? -1 : map_index[static_cast<std::size_t>(t)]);
    }
    result.PutVector(robot + "/observations/map_landmark", map_landmark);
    result.PutVector(robot + "/observations/probability", std::vector<double>(map_landmark.size(), 1.0));
  }
  PutMap(truth_log, counts, result);
  result.PutVector("history/log_likelihood", std::vector<double>{0.0});
  result.PutVector("history/prefix", std::vector<double>{1.0});
  result.PutVector("history/robots",
                   std::vector<std::int64_t>{static_cast<std::int64_t>(associations->size())});
  return result;
}

}  // namespace cairn::datasets
