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
    Grid grid;
    static void Fields(const auto& field) {
      field(Needed("landmark_x_m", "K", Position()), &Map::landmark_x_m);
      field(Needed("landmark_y_m", "K", Position()), &Map::landmark_y_m);
      field(Needed("landmark_covariance_m2", "K,2,2", Finite()), &Map::landmark_covariance_m2);
      field(Needed("landmark_identity", "K", IndexInto("so_far/landmarks").OrNone()),
            &Map::landmark_identity);
      field(Needed("landmark_count", "K", From(0)), &Map::landmark_count);
      field("grid", &Map::grid);
    }
  };
  struct History {
    Column<double> log_likelihood, prefix, landmark_x_m, landmark_y_m;
    Column<std::int64_t> robots, landmark_iteration, occupied;
    static void Fields(const auto& field) {
      field({"log_likelihood", "I", Free()}, &History::log_likelihood);
      field({"prefix", "I", Share()}, &History::prefix);
      field({"robots", "I", From(0)}, &History::robots);
      field({"occupied", "I", From(0)}, &History::occupied);
      field({"landmark_iteration", "J", IndexInto("so_far/history/log_likelihood")},
            &History::landmark_iteration);
      field({"landmark_x_m", "J", Finite()}, &History::landmark_x_m);
      field({"landmark_y_m", "J", Finite()}, &History::landmark_y_m);
    }
  };

  Texts what, landmarks;
  Map map;
  History history;

  static void Fields(const auto& field) {
    field({"so_far/what", ""}, &MapSoFar::what);
    field({"so_far/landmarks", "L"}, &MapSoFar::landmarks);
    field("so_far/map", &MapSoFar::map);
    field("so_far/history", &MapSoFar::history);
  }
};

}  // namespace cairn::kinds
