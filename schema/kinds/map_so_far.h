// schema/FORMAT.md, `map_so_far`: what there is to see of a stage that has not ended. No result, and of a
// kind of its own, so that nothing takes it for one.
#pragma once

#include "schema/kinds/landmark_map.h"

namespace cairn::kinds {

struct MapSoFar {
  struct Grid : GridPlace {
    Column<std::uint8_t> occupied;
    static void Fields(const auto& field) {
      field(Needed("occupied", "ny,nx", YesNo()), &Grid::occupied);
      GridPlace::Fields(field);
    }
  };
  struct Map {
    Column<double> landmark_x_m, landmark_y_m, landmark_covariance_m2, landmark_count;
    Column<std::int32_t> landmark_identity;
    Column<double> along_m;
    Column<std::int32_t> run;
    Column<float> output;
    Grid grid;
    static void Fields(const auto& field) {
      field(Needed("landmark_x_m", "K", Position()), &Map::landmark_x_m);
      field(Needed("landmark_y_m", "K", Position()), &Map::landmark_y_m);
      field(Needed("landmark_covariance_m2", "K,2,2", Finite()), &Map::landmark_covariance_m2);
      field(Needed("landmark_identity", "K", IndexInto("so_far/landmarks").OrNone()),
            &Map::landmark_identity);
      field(Needed("landmark_count", "K", From(0)), &Map::landmark_count);
      field("grid", &Map::grid);
      field({"along_m", "S", Finite()}, &Map::along_m);
      field({"run", "S", From(0)}, &Map::run);
      field({"output", "S,N", Share()}, &Map::output);
    }
  };
  struct Poses {
    Column<double> time_s, x_m, y_m;
    static void Fields(const auto& field) {
      field(Needed("time_s", "P", Rising()), &Poses::time_s);
      field(Needed("x_m", "P", Position()), &Poses::x_m);
      field(Needed("y_m", "P", Position()), &Poses::y_m);
    }
  };
  struct Robot {
    Poses poses;
    static void Fields(const auto& field) { field("poses", &Robot::poses); }
  };
  struct History {
    Column<double> log_likelihood, prefix, landmark_x_m, landmark_y_m;
    Column<std::int64_t> robots, landmark_iteration, occupied, changed_iteration, changed_cell;
    static void Fields(const auto& field) {
      field({"log_likelihood", "I", Free()}, &History::log_likelihood);
      field({"prefix", "I", Share()}, &History::prefix);
      field({"robots", "I", From(0)}, &History::robots);
      field({"occupied", "I", From(0)}, &History::occupied);
      field({"changed_iteration", "C", IndexInto("so_far/history/log_likelihood")},
            &History::changed_iteration);
      field({"changed_cell", "C", From(0)}, &History::changed_cell);
      field({"landmark_iteration", "J", IndexInto("so_far/history/log_likelihood")},
            &History::landmark_iteration);
      field({"landmark_x_m", "J", Finite()}, &History::landmark_x_m);
      field({"landmark_y_m", "J", Finite()}, &History::landmark_y_m);
    }
  };

  Texts what, job, landmarks, robots;
  std::vector<Robot> robot;
  Column<double> edge_x_m, edge_y_m;  // where walls were met
  Map map;
  History history;

  static void Fields(const auto& field) {
    field({"so_far/what", ""}, &MapSoFar::what);
    field({"so_far/job", ""}, &MapSoFar::job);
    field({"so_far/landmarks", "L"}, &MapSoFar::landmarks);
    field({"so_far/robots", "R"}, &MapSoFar::robots);
    field("so_far/robot", &MapSoFar::robot);
    field({"so_far/edges/x_m", "E", Position()}, &MapSoFar::edge_x_m);
    field({"so_far/edges/y_m", "E", Position()}, &MapSoFar::edge_y_m);
    field("so_far/map", &MapSoFar::map);
    field("so_far/history", &MapSoFar::history);
  }
};

}  // namespace cairn::kinds
