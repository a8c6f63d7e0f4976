// Pictures of several plans side by side at one scale: what a belief looks like, observation by observation.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/report/cell_picture.h"
#include "datasets/report/scene.h"
#include "schema/geometry.h"

namespace cairn::datasets::report {

struct PanelPicture {
  std::string title;
  std::optional<CellPicture> cells;       // below all else
  std::optional<Grid> density;            // the darker, the more
  std::string density_name = "belief";    // what it is of, for the legend
  std::vector<std::vector<Point>> raw;    // raw odometry
  std::vector<std::vector<Point>> paths;  // estimated, one a robot
  std::vector<Point> marks;               // where raw odometry has the robot when it observes something
  std::vector<Point> landmarks;           // of the map
  std::vector<Point> truth;               // true landmarks
  std::optional<Point> robot;             // where the robot truly is
};

// Round all that is drawn but densities (those too where there is nothing else), at least 1 m wide.
Box BoundsOf(const std::vector<PanelPicture>& panels);

// The box round both.
Box Around(const Box& a, const Box& b);

// The bytes of a PNG file: `columns` panels a row, each with its title and axes in metres over `box`, a
// legend of what is drawn below. Densities are shaded by the root of their share of the highest.
std::string DrawPanels(const std::vector<PanelPicture>& panels, const Box& box, int columns);

}  // namespace cairn::datasets::report
