// schema/FORMAT.md, `local_map`: traces of walls and edges, and how they hang together.
#pragma once

#include "schema/kinds/poses.h"

namespace cairn::kinds {

// How far an edge may be from the way, m: no sensor of a robot sees as far.
inline constexpr Values kFromPath = Between(-1000, 1000).OrNan();
inline constexpr Values kLocalCell{.least = Above0().least, .most = 10};

struct LocalMap {
  struct Walls {
    Column<double> time_s, angle_rad, strength;
    Column<std::uint8_t> locked, other_area;
    static void Fields(const auto& field) {
      field(Needed("time_s", "S", Rising()), &Walls::time_s);
      field(Needed("angle_rad", "S", Finite().OrNan()), &Walls::angle_rad);
      field(Needed("strength", "S", Share()), &Walls::strength);
      field(Needed("locked", "S", YesNo()), &Walls::locked);
      field(Needed("other_area", "S", YesNo()), &Walls::other_area);
    }
  };
  struct Cuts {
    Column<double> time_s;
    Texts why;
    static void Fields(const auto& field) {
      field(Needed("time_s", "C", Rising()), &Cuts::time_s);
      field(Needed("why", "C"), &Cuts::why);
    }
  };
  // Where odometry's metre is not one.
  struct Metre {
    Column<double> time_s, scale;
    static void Fields(const auto& field) {
      field({"time_s", "G", Finite()}, &Metre::time_s);
      field({"scale", "G", Above0()}, &Metre::scale);
    }
  };
  // Where the path does not move as its scans show that the robot did.
  struct Fit {
    Column<double> from_s, until_s, scans_turn_rad, odometry_turn_rad, path_turn_rad, apart_m,
        odometry_apart_m;
    Column<std::uint8_t> hole;
    static void Fields(const auto& field) {
      field({"from_s", "D", Finite()}, &Fit::from_s);
      field({"until_s", "D", Finite()}, &Fit::until_s);
      field({"scans_turn_rad", "D", Finite()}, &Fit::scans_turn_rad);
      field({"odometry_turn_rad", "D", Finite()}, &Fit::odometry_turn_rad);
      field({"path_turn_rad", "D", Finite()}, &Fit::path_turn_rad);
      field({"apart_m", "D", NotNegative()}, &Fit::apart_m);
      field({"odometry_apart_m", "D", NotNegative()}, &Fit::odometry_apart_m);
      field({"hole", "D", YesNo()}, &Fit::hole);
    }
  };
  // Whether two of its lasers see the same walls in the same places.
  struct Lasers {
    Texts first, second;
    Column<std::int64_t> looked, moved_looked;
    Column<double> share, moved_share, moved_m, moved_rad;
    static void Fields(const auto& field) {
      field({"first", "L"}, &Lasers::first);
      field({"second", "L"}, &Lasers::second);
      field({"looked", "L", NotNegative()}, &Lasers::looked);
      field({"share", "L", Share()}, &Lasers::share);
      field({"moved_looked", "L", NotNegative()}, &Lasers::moved_looked);
      field({"moved_share", "L", Share()}, &Lasers::moved_share);
      field({"moved_m", "L", NotNegative()}, &Lasers::moved_m);
      field({"moved_rad", "L", NotNegative()}, &Lasers::moved_rad);
    }
  };
  // Scans of places that were passed more than once.
  struct Passes {
    Column<double> from_s, to_s, through, off_x_m, off_y_m;
    Column<std::uint8_t> doubled;
    static void Fields(const auto& field) {
      field({"from_s", "V", Finite()}, &Passes::from_s);
      field({"to_s", "V", Finite()}, &Passes::to_s);
      field({"through", "V", Share()}, &Passes::through);
      field({"doubled", "V", YesNo()}, &Passes::doubled);
      field({"off_x_m", "V", Finite()}, &Passes::off_x_m);
      field({"off_y_m", "V", Finite()}, &Passes::off_y_m);
    }
  };
  struct Positions {
    Column<double> time_s, z_m, u_m, range_z_m, range_u_m;
    Column<std::int32_t> trace;
    Column<std::uint8_t> corrected;
    static void Fields(const auto& field) {
      field(Needed("time_s", "Q", Rising()), &Positions::time_s);
      field(Needed("trace", "Q", IndexInto("traces/robot")), &Positions::trace);
      field(Needed("z_m", "Q", Position()), &Positions::z_m);
      field(Needed("u_m", "Q", Position()), &Positions::u_m);
      field(Needed("range_z_m", "Q", NotNegative()), &Positions::range_z_m);
      field(Needed("range_u_m", "Q", NotNegative()), &Positions::range_u_m);
      field(Needed("corrected", "Q", YesNo()), &Positions::corrected);
    }
  };
  struct Robot {
    PoseTable poses;
    Walls walls;
    Cuts cuts;
    Metre metre;
    Fit fit;
    Lasers lasers;
    Passes passes;
    Positions positions;
    static void Fields(const auto& field) {
      field({"poses", "S"}, &Robot::poses);
      field("walls", &Robot::walls);
      field("cuts", &Robot::cuts);
      field("metre", &Robot::metre);
      field("fit", &Robot::fit);
      field("lasers", &Robot::lasers);
      field("passes", &Robot::passes);
      field("positions", &Robot::positions);
    }
  };
  struct Traces {
    Column<std::int32_t> robot, first_z;
    Column<double> first_s, last_s, x_m, y_m, direction_rad;
    Column<std::int64_t> features;
    static void Fields(const auto& field) {
      field(Needed("robot", "T", IndexInto("robots")), &Traces::robot);
      field(Needed("first_s", "T", Finite()), &Traces::first_s);
      field(Needed("last_s", "T", Finite()), &Traces::last_s);
      field(Needed("x_m", "T", Position()), &Traces::x_m);
      field(Needed("y_m", "T", Position()), &Traces::y_m);
      field(Needed("direction_rad", "T", Finite()), &Traces::direction_rad);
      field(Needed("first_z", "T", Position()), &Traces::first_z);
      field(Needed("features", "T", RowsOf("features/left/angle_low_rad")), &Traces::features);
    }
  };
  struct Side {
    Column<float> angle_low_rad, angle_high_rad, distance_low_m, distance_high_m, cross_m;
    Column<std::uint8_t> occupied;
    static void Fields(const auto& field) {
      field(Needed("angle_low_rad", "F", Finite().OrNan()), &Side::angle_low_rad);
      field(Needed("angle_high_rad", "F", Finite().OrNan()), &Side::angle_high_rad);
      field(Needed("distance_low_m", "F", kFromPath), &Side::distance_low_m);
      field(Needed("distance_high_m", "F", kFromPath), &Side::distance_high_m);
      field(Needed("cross_m", "F", kFromPath), &Side::cross_m);
      field(Needed("occupied", "F", YesNo()), &Side::occupied);
    }
  };
  struct Connections {
    Column<std::int32_t> from, to, kind;
    Column<double> from_s, to_s, from_z_m, from_u_m, to_z_m, to_u_m, quality;
    Column<std::uint8_t> used, tells_x, tells_y;
    static void Fields(const auto& field) {
      field(Needed("from", "K", IndexInto("traces/robot")), &Connections::from);
      field(Needed("to", "K", IndexInto("traces/robot")), &Connections::to);
      field(Needed("kind", "K", Between(0, 2)), &Connections::kind);
      field(Needed("from_s", "K", Finite()), &Connections::from_s);
      field(Needed("to_s", "K", Finite()), &Connections::to_s);
      field(Needed("from_z_m", "K", Position()), &Connections::from_z_m);
      field(Needed("from_u_m", "K", Position()), &Connections::from_u_m);
      field(Needed("to_z_m", "K", Position()), &Connections::to_z_m);
      field(Needed("to_u_m", "K", Position()), &Connections::to_u_m);
      field(Needed("quality", "K", Share()), &Connections::quality);
      field(Needed("used", "K", YesNo()), &Connections::used);
      field({"tells_x", "K", YesNo()}, &Connections::tells_x);
      field({"tells_y", "K", YesNo()}, &Connections::tells_y);
    }
  };
  struct Edges {
    Column<double> x0_m, y0_m, x1_m, y1_m;
    static void Fields(const auto& field) {
      field(Needed("x0_m", "E", Position()), &Edges::x0_m);
      field(Needed("y0_m", "E", Position()), &Edges::y0_m);
      field(Needed("x1_m", "E", Position()), &Edges::x1_m);
      field(Needed("y1_m", "E", Position()), &Edges::y1_m);
    }
  };
  struct Snapshots {
    Column<std::int32_t> robot;
    Column<double> time_s, frame_rad, histogram;
    Column<float> occupancy, edge_rad;
    Column<std::int64_t> edges;
    Edges edge;
    static void Fields(const auto& field) {
      field(Needed("robot", "P", IndexInto("robots")), &Snapshots::robot);
      field(Needed("time_s", "P", Finite()), &Snapshots::time_s);
      field(Needed("frame_rad", "P", Finite()), &Snapshots::frame_rad);
      field(Needed("occupancy", "P,n,n", From(0)), &Snapshots::occupancy);
      field(Needed("edge_rad", "P,n,n", Finite().OrNan()), &Snapshots::edge_rad);
      field(Needed("histogram", "P,8", Finite()), &Snapshots::histogram);
      field(Needed("edges", "P", RowsOf("snapshots/edge/x0_m")), &Snapshots::edges);
      field("edge", &Snapshots::edge);
    }
  };

  Texts robots, log_hash;
  std::vector<Robot> robot;
  Column<double> cell_m;
  Traces traces;
  Side left, right;
  Connections connections;
  Snapshots snapshots;

  static void Fields(const auto& field) {
    field({"robots", "R"}, &LocalMap::robots);
    field({"log_hash", ""}, &LocalMap::log_hash);
    field("robot", &LocalMap::robot);
    field({"cell_m", "", kLocalCell}, &LocalMap::cell_m);
    field("traces", &LocalMap::traces);
    field("features/left", &LocalMap::left);
    field("features/right", &LocalMap::right);
    field("connections", &LocalMap::connections);
    field("snapshots", &LocalMap::snapshots);
  }
};

}  // namespace cairn::kinds
