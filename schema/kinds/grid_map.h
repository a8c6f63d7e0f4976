// schema/FORMAT.md, `grid_map`: cells that are occupied or free, and the scans that tell so.
#pragma once

#include "schema/kinds/landmark_map.h"

namespace cairn::kinds {

struct GridMap {
  struct Sensor : PoseTable {
    std::string sensor;
    Column<std::uint8_t> held_out;
    Column<std::int32_t> cause;
    Column<double> p_hit, p_rand, p_lost, sigma_m, no_echo_sigma_m, z_max_m;
    static void Fields(const auto& field) {
      PoseTable::Fields(field);
      field({"held_out", "P", YesNo()}, &Sensor::held_out);
      field({"cause", "P,B", From(-5)}, &Sensor::cause);
      field({"p_hit", "", Share()}, &Sensor::p_hit);
      field({"p_rand", "", Share()}, &Sensor::p_rand);
      field({"p_lost", "", Share()}, &Sensor::p_lost);
      field({"sigma_m", "", Positive()}, &Sensor::sigma_m);
      field({"no_echo_sigma_m", "", Positive()}, &Sensor::no_echo_sigma_m);
      field({"z_max_m", "", Positive()}, &Sensor::z_max_m);
    }
  };
  struct Robot {
    PerSensor<Sensor> sensors;
    static void Fields(const auto& field) { field({"SENSOR", "S"}, &Robot::sensors); }
  };
  struct Grid : GridPlace {
    Column<double> probability, log_odds_difference;
    Column<float> log_odds;
    Column<std::uint8_t> occupied, dynamic;
    static void Fields(const auto& field) {
      field(Needed("probability", "ny,nx", Share().OrNan()), &Grid::probability);
      field({"log_odds", "ny,nx", Free()}, &Grid::log_odds);
      field({"log_odds_difference", "ny,nx", Free()}, &Grid::log_odds_difference);
      field({"occupied", "ny,nx", YesNo()}, &Grid::occupied);
      field({"dynamic", "ny,nx", Between(0, 2)}, &Grid::dynamic);
      GridPlace::Fields(field);
    }
  };
  struct History {
    Column<double> log_likelihood, target, expected_log_likelihood;
    Column<std::int64_t> occupied, changed_iteration, changed_cell;
    static void Fields(const auto& field) {
      field({"log_likelihood", "I", Free()}, &History::log_likelihood);
      field({"target", "I", Free()}, &History::target);
      field({"expected_log_likelihood", "I", Free()}, &History::expected_log_likelihood);
      field({"occupied", "I", From(0)}, &History::occupied);
      field({"changed_iteration", "J", IndexInto("history/log_likelihood")}, &History::changed_iteration);
      field({"changed_cell", "J", From(0)}, &History::changed_cell);
    }
  };

  // Whether the map predicts readings that it was not made of.
  struct Fit {
    Column<std::int64_t> checked_readings;
    Column<double> checked_nats, ignorant_nats;
    static void Fields(const auto& field) {
      field({"checked_readings", "", From(0)}, &Fit::checked_readings);
      field({"checked_nats", "", Free()}, &Fit::checked_nats);
      field({"ignorant_nats", "", Free()}, &Fit::ignorant_nats);
    }
  };

  Grid grid;
  Texts robots, log_hash;
  std::vector<Robot> robot;
  History history;
  Fit fit;
  Column<std::int64_t> searches;
  Column<std::uint8_t> cut_short;

  static void Fields(const auto& field) {
    field("map/grid", &GridMap::grid);
    field({"robots", "R"}, &GridMap::robots);
    field({"log_hash", ""}, &GridMap::log_hash);
    field("robot", &GridMap::robot);
    field("history", &GridMap::history);
    field("fit", &GridMap::fit);
    field({"search/searches", "", From(0)}, &GridMap::searches);
    field({"search/cut_short", "", YesNo()}, &GridMap::cut_short);
  }
};

}  // namespace cairn::kinds
