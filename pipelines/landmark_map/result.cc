#include "pipelines/landmark_map/result.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "pipelines/landmark_map/track.h"

namespace cairn::landmark_map {
namespace {

// A pose as the result lists it: mean, covariance, mode.
struct Row {
  double time_s, x_m, y_m, heading_rad, covariance[9], mode_x_m, mode_y_m, mode_heading_rad;
};

double Wrap(double angle) {
  const double wrapped = std::remainder(angle, 2.0 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? std::numbers::pi : wrapped;
}

std::vector<double> Joined(const std::vector<Blob>& summaries, const char* name) {
  std::vector<double> all;
  for (const Blob& summary : summaries) {
    const auto values = summary.Get<double>(name);
    all.insert(all.end(), values.begin(), values.end());
  }
  return all;
}

// A pose and a heading correction at a step.
struct Anchor {
  double x_m, y_m, correction_rad;
};

// Where odometry says `at` is, carried over from step `s` at `anchor`.
Anchor Carry(const RobotSteps& steps, int s, const Anchor& anchor, const OdometricPose& at) {
  const double dx = at.x_m - steps.odo_x_m[s], dy = at.y_m - steps.odo_y_m[s];
  const double cosine = std::cos(anchor.correction_rad), sine = std::sin(anchor.correction_rad);
  return {anchor.x_m + cosine * dx - sine * dy, anchor.y_m + sine * dx + cosine * dy, anchor.correction_rad};
}

// Between two steps the position error is interpolated linearly ([TBF98] section 5): odometry from the
// earlier one and from the later one, weighed by the way.
Anchor Between(const RobotSteps& steps, int s, const Anchor& a, const Anchor& b, const OdometricPose& at,
               double part) {
  Anchor middle = a;
  const double turn = Wrap(b.correction_rad - a.correction_rad);
  middle.correction_rad = a.correction_rad + part * turn;
  const Anchor from = Carry(steps, s, {a.x_m, a.y_m, a.correction_rad + 0.5 * part * turn}, at);
  const Anchor to = Carry(steps, s + 1, {b.x_m, b.y_m, b.correction_rad - 0.5 * (1.0 - part) * turn}, at);
  middle.x_m = from.x_m + part * (to.x_m - from.x_m);
  middle.y_m = from.y_m + part * (to.y_m - from.y_m);
  return middle;
}

// The path of one robot: its steps, and controls between them at least `spacing_m` apart.
class PathWriter {
 public:
  PathWriter(const RobotSteps& steps, const Odometry& odometry, const std::vector<Blob>& summaries,
             double drift_rad_per_m, double spacing_m)
      : steps_(steps),
        odometry_(odometry),
        spacing_m_(spacing_m),
        mean_{Joined(summaries, "pose/x_m"), Joined(summaries, "pose/y_m"),
              Joined(summaries, "pose/heading_rad")},
        mode_{Joined(summaries, "pose/mode_x_m"), Joined(summaries, "pose/mode_y_m"),
              Joined(summaries, "pose/mode_heading_rad")},
        covariance_(Joined(summaries, "pose/covariance")) {
    // The estimates are relative to odometry without its drift, the path here is written from odometry as it
    // is.
    const std::vector<double> way = steps.WaySoFar();
    for (std::size_t s = 0; s < way.size(); ++s) {
      mean_.correction_rad[s] -= drift_rad_per_m * way[s];
      mode_.correction_rad[s] -= drift_rad_per_m * way[s];
    }
  }

  void Write(const std::string& prefix, Blob* result) {
    const int last = steps_.size() - 1;
    double previous = -1e300;
    std::size_t control = 0;
    for (int s = 0; s <= last; ++s) {
      const double until = steps_.time_s[s];
      for (; control < odometry_.time_s.size() && odometry_.time_s[control] < until; ++control) {
        if (odometry_.path_m[control] - previous < spacing_m_) continue;
        AddAt(PoseAt(odometry_, odometry_.time_s[control]), s - 1);
        previous = odometry_.path_m[control];
      }
      const OdometricPose at = PoseOfStep(s);
      AddAt(at, s);
      previous = at.path_m;
      while (control < odometry_.time_s.size() && odometry_.time_s[control] <= until) ++control;
    }
    for (; control < odometry_.time_s.size(); ++control) {
      if (odometry_.path_m[control] - previous < spacing_m_) continue;
      AddAt(PoseAt(odometry_, odometry_.time_s[control]), last);
      previous = odometry_.path_m[control];
    }
    Put(prefix, result);
  }

 private:
  struct Table {
    std::vector<double> x_m, y_m, correction_rad;
    Anchor at(int s) const { return {x_m[s], y_m[s], correction_rad[s]}; }
  };

  OdometricPose PoseOfStep(int s) const {
    OdometricPose at = PoseAt(odometry_, steps_.time_s[s]);
    at.x_m = steps_.odo_x_m[s];
    at.y_m = steps_.odo_y_m[s];
    at.heading_rad = steps_.odo_heading_rad[s];
    return at;
  }

  // The pose `at` lies at or after step `s` (-1: before the first).
  void AddAt(const OdometricPose& at, int s) {
    const int last = steps_.size() - 1, anchor = std::max(s, 0);
    Anchor mean = Carry(steps_, anchor, mean_.at(anchor), at),
           mode = Carry(steps_, anchor, mode_.at(anchor), at);
    double part = 0.0;
    if (s >= 0 && s < last && at.time_s > steps_.time_s[s]) {
      const double start = PoseAt(odometry_, steps_.time_s[s]).path_m;
      part =
          steps_.path_m[s + 1] > 0 ? std::clamp((at.path_m - start) / steps_.path_m[s + 1], 0.0, 1.0) : 0.0;
      mean = Between(steps_, s, mean_.at(s), mean_.at(s + 1), at, part);
      mode = Between(steps_, s, mode_.at(s), mode_.at(s + 1), at, part);
    }
    Row row{at.time_s, mean.x_m, mean.y_m, Wrap(at.heading_rad + mean.correction_rad),
            {},        mode.x_m, mode.y_m, Wrap(at.heading_rad + mode.correction_rad)};
    const int next = std::min(anchor + 1, last);
    for (int k = 0; k < 9; ++k) {
      row.covariance[k] =
          covariance_[9 * anchor + k] + part * (covariance_[9 * next + k] - covariance_[9 * anchor + k]);
    }
    rows_.push_back(row);
  }

  void Put(const std::string& prefix, Blob* result) const {
    const auto put = [&](const char* name, double Row::* field) {
      std::vector<double> values;
      for (const Row& row : rows_) values.push_back(row.*field);
      result->PutVector(prefix + name, values);
    };
    put("time_s", &Row::time_s);
    put("x_m", &Row::x_m);
    put("y_m", &Row::y_m);
    put("heading_rad", &Row::heading_rad);
    put("mode_x_m", &Row::mode_x_m);
    put("mode_y_m", &Row::mode_y_m);
    put("mode_heading_rad", &Row::mode_heading_rad);
    std::vector<double> covariance;
    for (const Row& row : rows_) covariance.insert(covariance.end(), row.covariance, row.covariance + 9);
    result->Put(prefix + "covariance",
                Array::Of<double>({static_cast<std::int64_t>(rows_.size()), 3, 3}, covariance));
  }

  const RobotSteps& steps_;
  const Odometry& odometry_;
  double spacing_m_;
  Table mean_, mode_;
  std::vector<double> covariance_;
  std::vector<Row> rows_;
};

void PutAssociations(const RobotSteps& steps, const std::vector<Blob>& summaries, const std::string& prefix,
                     Blob* result) {
  std::vector<std::int32_t> landmark, rows;
  for (const Blob& summary : summaries) {
    const auto values = summary.Get<std::int32_t>("association/landmark");
    landmark.insert(landmark.end(), values.begin(), values.end());
  }
  const std::vector<double> probability = Joined(summaries, "association/probability");
  std::vector<double> row_probability;
  for (const std::int32_t k : steps.row_observation) {
    rows.push_back(k < 0 ? -1 : landmark[static_cast<std::size_t>(k)]);
    row_probability.push_back(k < 0 ? 0.0 : probability[static_cast<std::size_t>(k)]);
  }
  result->PutVector(prefix + "map_landmark", rows);
  result->PutVector(prefix + "probability", row_probability);
}

void PutMap(const LayeredGrid& map, const GridSpec& grid, int types, Blob* result) {
  Box box;
  for (const Layer& layer : map.layers) box = Union(box, layer.box);
  const bool unknown = types == 0 || !map.layers.back().box.empty();
  const int kinds = types + (unknown ? 1 : 0);
  std::vector<double> cells;
  cells.reserve(static_cast<std::size_t>(kinds * box.cells()));
  for (int type = 0; type < kinds; ++type) {
    for (int y = box.y0; y < box.y0 + box.ny; ++y) {
      for (int x = box.x0; x < box.x0 + box.nx; ++x) cells.push_back(map.layers[type].At(x, y));
    }
  }
  result->Put("map/grid/probability", Array::Of<double>({kinds, box.ny, box.nx}, cells));
  result->PutScalar<double>("map/grid/origin_x_m", (box.x0 - 0.5) * grid.cell_m);
  result->PutScalar<double>("map/grid/origin_y_m", (box.y0 - 0.5) * grid.cell_m);
  result->PutScalar<double>("map/grid/cell_m", grid.cell_m);
}

void PutLandmarks(const std::vector<Landmark>& landmarks, int types, Blob* result) {
  const Blob blob = ToBlob(landmarks);
  for (const char* name : {"x_m", "y_m", "covariance_m2", "count"}) {
    result->Put(std::string("map/landmark_") + name, blob.at(name));
  }
  std::vector<std::int32_t> identity;
  for (const Landmark& l : landmarks) identity.push_back(l.type < types ? l.type : -1);
  result->PutVector("map/landmark_identity", identity);
}

}  // namespace

Blob EmptyHistory() {
  Blob history;
  history.PutVector<double>("log_likelihood", {});
  history.PutVector<double>("prefix", {});
  history.PutVector<std::int64_t>("robots", {});
  return history;
}

Blob Extended(const Blob& history, const Schedule& done, double log_likelihood) {
  Blob extended;
  const auto append = [&]<class T>(const char* name, T value) {
    const auto old = history.Get<T>(name);
    std::vector<T> values(old.begin(), old.end());
    values.push_back(value);
    extended.PutVector(name, values);
  };
  append("log_likelihood", log_likelihood);
  append("prefix", done.prefix);
  append("robots", done.robots);
  return extended;
}

Step MakeResult(const Blob& log, const Settings& settings, const Inputs& inputs, const RoundSum& sum,
                const std::vector<double>& drift, const Blob& history) {
  const std::vector<std::string> robots = log.Texts("robots");
  const std::vector<Landmark> landmarks = LandmarksFromBlob(*inputs.Get("landmarks"));
  Blob result;
  result.Put("robots", log.at("robots"));
  result.Put("landmarks", log.at("landmarks"));
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const std::string prefix = "robot/" + std::to_string(r) + "/";
    const RobotSteps steps = RobotSteps::FromBlob(*inputs.Get("steps/" + std::to_string(r)));
    const Odometry odometry = Integrate(log.Sub(prefix), robots[r]);
    const std::vector<Blob> summaries = sum.SummariesOf(r);
    PathWriter(steps, odometry, summaries, drift[r], 0.5 * settings.map.grid.cell_m)
        .Write(prefix + "poses/", &result);
    PutAssociations(steps, summaries, prefix + "observations/", &result);
    result.PutScalar<double>(prefix + "heading_drift_rad_per_m", drift[r]);
  }
  PutLandmarks(landmarks, settings.map.types, &result);
  const LayeredGrid counts = LayeredGrid::Load("counts/", *inputs.Get("counts"));
  PutMap(MapOf(counts, settings.map), settings.map.grid, settings.map.types, &result);
  result.PutAll("history/", history);
  Step step;
  step.plan.set_result(step.Share(std::move(result)));
  char note[120];
  std::snprintf(note, sizeof note, "%zu landmarks, log-likelihood %.2f", landmarks.size(),
                sum.log_likelihood());
  step.plan.set_note(note);
  return step;
}

}  // namespace cairn::landmark_map
