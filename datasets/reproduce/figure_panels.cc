#include "datasets/reproduce/figure_panels.h"

#include <cstdarg>
#include <cstdio>

#include "datasets/common/control.h"

namespace cairn::datasets {

using report::PanelPicture;

namespace {

struct RawPath {
  std::vector<Point> path, marks;  // where odometry has the robot, all along and at its observations
};

RawPath RawPathOf(const Blob& log, std::size_t robot, double until_s) {
  const std::string prefix = "robot/" + std::to_string(robot) + "/";
  const auto time = log.Get<double>(prefix + "odometry/time_s"),
             turn = log.Get<double>(prefix + "odometry/turn_rad"),
             forward = log.Get<double>(prefix + "odometry/forward_m"),
             seen = log.Get<double>(prefix + "observations/time_s");
  RawPath raw{{{0, 0}}, {}};
  Pose pose;
  std::size_t mark = 0;
  for (std::size_t i = 0; i < time.size() && time[i] <= until_s; ++i) {
    pose = Apply(pose, {turn[i], forward[i]});
    raw.path.push_back({pose.x_m, pose.y_m});
    for (; mark < seen.size() && seen[mark] <= time[i]; ++mark) raw.marks.push_back({pose.x_m, pose.y_m});
  }
  return raw;
}

}  // namespace

std::string Say(const char* format, ...) {
  char text[600];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

PanelPicture RawPanel(const std::string& title, const Blob& log, std::size_t robot, double until_s) {
  RawPath raw = RawPathOf(log, robot, until_s);
  PanelPicture panel;
  panel.title = title;
  panel.raw = {std::move(raw.path)};
  panel.marks = std::move(raw.marks);
  return panel;
}

PanelPicture MapPanel(const std::string& title, const Blob& result, const Blob& log,
                      const Evaluation& score) {
  const report::Scene scene = report::MakeScene(result, &log, &score);
  PanelPicture panel;
  panel.title = title;
  for (const report::Path& path : scene.paths) panel.paths.push_back(path.points);
  for (const report::MapLandmark& landmark : scene.landmarks) panel.landmarks.push_back(landmark.at);
  panel.truth = scene.truth_landmarks;
  return panel;
}

std::string DrawFigure(const std::vector<PanelPicture>& panels, int columns) {
  return report::DrawPanels(panels, report::BoundsOf(panels), columns);
}

const char* RightOrWrong(const Evaluation& score) {
  return score.topology_correct.value_or(false) ? "right" : "wrong";
}

std::string ScoreText(const Evaluation& score) {
  const auto metres = [](std::optional<double> error_m) {
    return error_m ? Say("%.2f m", *error_m) : "unknown";
  };
  return Say("topology %s, %lld of %lld landmarks found, %lld spurious, landmark error %s, path error %s",
             RightOrWrong(score), static_cast<long long>(score.landmarks->found),
             static_cast<long long>(score.landmarks->found + score.landmarks->missed),
             static_cast<long long>(score.landmarks->spurious), metres(score.landmarks->rmse_m).c_str(),
             metres(score.trajectory_rmse_m).c_str());
}

}  // namespace cairn::datasets
