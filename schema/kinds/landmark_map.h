// schema/FORMAT.md, `landmark_map`: landmarks, and the robots' paths among them.
#pragma once

#include "schema/kinds/poses.h"

namespace cairn::kinds {

// Where a grid lies.
struct GridPlace {
  Column<double> origin_x_m, origin_y_m, cell_m;

  static GridPlace Of(const GridBox& box) { return {box.origin_x_m, box.origin_y_m, box.cell_m}; }
  static void Fields(const auto& field) {
    field(Needed("origin_x_m", "", Position()), &GridPlace::origin_x_m);
    field(Needed("origin_y_m", "", Position()), &GridPlace::origin_y_m);
    field(Needed("cell_m", "", Positive()), &GridPlace::cell_m);
  }
};

// What refinement/reason says after "refused: " where no path explains both odometry and observations.
inline constexpr const char* kOdometryWrongByHalf = "odometry's ways or turns would be wrong by half";

struct LandmarkMap {
  struct RobotPoses : UncertainPoses {
    Column<double> mode_x_m, mode_y_m, mode_heading_rad;
    Pose Mode(std::size_t i) const { return {mode_x_m[i], mode_y_m[i], mode_heading_rad[i]}; }
    static void Fields(const auto& field) {
      UncertainPoses::Fields(field);
      field({"mode_x_m", "P", Position()}, &RobotPoses::mode_x_m);
      field({"mode_y_m", "P", Position()}, &RobotPoses::mode_y_m);
      field({"mode_heading_rad", "P", Finite()}, &RobotPoses::mode_heading_rad);
    }
  };
  struct Beliefs {
    Column<double> time_s, value;
    Column<std::int32_t> box;
    static void Fields(const auto& field) {
      field(Needed("time_s", "S", Rising()), &Beliefs::time_s);
      field(Needed("box", "S,4", Free()), &Beliefs::box);
      field(Needed("value", "V", From(0)), &Beliefs::value);
    }
  };
  struct Robot {
    RobotPoses poses;
    Column<std::int32_t> map_landmark;  // of each observation
    Column<double> probability, heading_drift_rad_per_m, heading_walk_rad_per_sqrt_m, turn_ratio,
        distance_scale, turn_scale, range_offset_m, observations_late_s, bearings_turned_rad, sensor_x_m,
        sensor_y_m, odometry_walk_rad_per_sqrt_m, odometry_turn_rad_per_sqrt_rad, odometry_way_m_per_sqrt_m,
        place_lead_nats, place_odds_nats;
    Column<double> half_step_m;
    Column<std::int64_t> shared_landmarks, one_sided_landmarks;
    Beliefs beliefs;
    static void Fields(const auto& field) {
      field("poses", &Robot::poses);
      field(Needed("observations/map_landmark", "O", IndexInto("map/landmark_x_m").OrNone()),
            &Robot::map_landmark);
      field(Needed("observations/probability", "O", Share()), &Robot::probability);
      field("beliefs", &Robot::beliefs);
      field({"heading_drift_rad_per_m", "", Finite()}, &Robot::heading_drift_rad_per_m);
      field({"heading_walk_rad_per_sqrt_m", "", NotNegative()}, &Robot::heading_walk_rad_per_sqrt_m);
      field({"turn_ratio", "", NotNegative()}, &Robot::turn_ratio);
      field({"distance_scale", "", Positive()}, &Robot::distance_scale);
      field({"turn_scale", "", Positive()}, &Robot::turn_scale);
      field({"range_offset_m", "", Finite()}, &Robot::range_offset_m);
      field({"observations_late_s", "", Finite()}, &Robot::observations_late_s);
      field({"bearings_turned_rad", "", Finite()}, &Robot::bearings_turned_rad);
      field({"sensor_x_m", "", Finite()}, &Robot::sensor_x_m);
      field({"sensor_y_m", "", Finite()}, &Robot::sensor_y_m);
      field({"half_step_m", "", Finite()}, &Robot::half_step_m);
      field({"odometry_walk_rad_per_sqrt_m", "", NotNegative()}, &Robot::odometry_walk_rad_per_sqrt_m);
      field({"odometry_turn_rad_per_sqrt_rad", "", NotNegative()}, &Robot::odometry_turn_rad_per_sqrt_rad);
      field({"odometry_way_m_per_sqrt_m", "", NotNegative()}, &Robot::odometry_way_m_per_sqrt_m);
      field({"shared_landmarks", "", From(0)}, &Robot::shared_landmarks);
      field({"one_sided_landmarks", "", From(0)}, &Robot::one_sided_landmarks);
      field({"place_lead_nats", "", Finite()}, &Robot::place_lead_nats);
      field({"place_odds_nats", "", Finite()}, &Robot::place_odds_nats);
    }
  };
  struct Map {
    Column<double> landmark_x_m, landmark_y_m, landmark_covariance_m2, landmark_joint_covariance_m2,
        landmark_count, probability;
    Column<std::int32_t> landmark_identity, landmark_type;
    Column<std::int64_t> landmark_passes;
    GridPlace grid;
    static void Fields(const auto& field) {
      field(Needed("landmark_x_m", "K", Position()), &Map::landmark_x_m);
      field(Needed("landmark_y_m", "K", Position()), &Map::landmark_y_m);
      field({"landmark_covariance_m2", "K,2,2", Finite()}, &Map::landmark_covariance_m2);
      field({"landmark_joint_covariance_m2", "K,2,K,2", Finite()}, &Map::landmark_joint_covariance_m2);
      field({"landmark_identity", "K", IndexInto("landmarks").OrNone()}, &Map::landmark_identity);
      field({"landmark_type", "K", IndexInto("types").OrNone()}, &Map::landmark_type);
      field({"landmark_count", "K", From(0)}, &Map::landmark_count);
      field({"landmark_passes", "K", From(0)}, &Map::landmark_passes);
      field(Needed("grid/probability", "G,ny,nx", Share()), &Map::probability);
      field("grid", &Map::grid);
    }
  };
  struct History {
    Column<double> log_likelihood, prefix;
    Column<std::int64_t> robots, guessed, confirmed, landmark_iteration;
    Column<double> landmark_x_m, landmark_y_m;
    static void Fields(const auto& field) {
      field({"log_likelihood", "I", Free()}, &History::log_likelihood);
      field({"prefix", "I", Share()}, &History::prefix);
      field({"robots", "I", From(0)}, &History::robots);
      field({"guessed", "I", From(0)}, &History::guessed);
      field({"confirmed", "I", From(0)}, &History::confirmed);
      field({"landmark_iteration", "J", IndexInto("history/log_likelihood")}, &History::landmark_iteration);
      field({"landmark_x_m", "J", Finite()}, &History::landmark_x_m);
      field({"landmark_y_m", "J", Finite()}, &History::landmark_y_m);
    }
  };
  struct Search {
    Column<double> start_drift_rad_per_m, start_prefix, drift_rad_per_m, log_likelihood, score_nats,
        lead_nats, tried_score_nats;
    Column<std::int32_t> refit_of, landmarks, same_map, best, support, starts, first_robot, tried_robot,
        tried_same_map;
    Texts unlike, why;
    static void Fields(const auto& field) {
      field({"start_drift_rad_per_m", "C", Finite()}, &Search::start_drift_rad_per_m);
      field({"start_prefix", "C", Share()}, &Search::start_prefix);
      field({"refit_of", "C", IndexInto("search/start_drift_rad_per_m").OrNone()}, &Search::refit_of);
      field({"drift_rad_per_m", "C", Free()}, &Search::drift_rad_per_m);
      field({"log_likelihood", "C", Free()}, &Search::log_likelihood);
      field({"landmarks", "C", From(0)}, &Search::landmarks);
      field({"score_nats", "C", Free()}, &Search::score_nats);
      field({"same_map", "C", YesNo()}, &Search::same_map);
      field({"best", "", IndexInto("search/start_drift_rad_per_m")}, &Search::best);
      field({"support", "", From(0)}, &Search::support);
      field({"starts", "", From(0)}, &Search::starts);
      field({"unlike", "U"}, &Search::unlike);
      field({"why", ""}, &Search::why);
      field({"lead_nats", "", Free()}, &Search::lead_nats);
      field({"first_robot", "", IndexInto("robots")}, &Search::first_robot);
      field({"tried_robot", "B", IndexInto("robots")}, &Search::tried_robot);
      field({"tried_score_nats", "B", Finite().OrNan()}, &Search::tried_score_nats);
      field({"tried_same_map", "B", YesNo()}, &Search::tried_same_map);
    }
  };

  // Whether the model explains what was measured.
  struct Fit {
    Texts kind;
    Column<double> stated, found, longest_run_from_s, worst_time_s, worst_sigmas, worst_odometry_s,
        odometry_break_lead_nats, fewest_common_s, one_sided_s, most_one_sided_s, shift_m, shift_from_s,
        shift_until_s, shift_lead_nats, few_common_lead_nats, false_ratio, repeats_along, repeats_across,
        tail_sigmas;
    Column<std::int64_t> observations, misfits, longest_run, odometry_misfits, fewest_common, one_sided,
        two_sided, most_one_sided;
    Column<std::int32_t> worst_robot;
    Column<std::int32_t> misfit_landmark;
    Column<std::int64_t> landmark_misfits, landmark_observations;
    Column<std::uint8_t> shift_taken, told;
    static void Fields(const auto& field) {
      field({"kind", "F"}, &Fit::kind);
      field({"told", "F", YesNo()}, &Fit::told);
      field({"stated", "F", NotNegative()}, &Fit::stated);
      field({"found", "F", NotNegative()}, &Fit::found);
      field({"repeats_along", "", From(1)}, &Fit::repeats_along);
      field({"repeats_across", "", From(1)}, &Fit::repeats_across);
      field({"tail_sigmas", "", Positive()}, &Fit::tail_sigmas);
      field({"observations", "", From(0)}, &Fit::observations);
      field({"misfits", "", From(0)}, &Fit::misfits);
      field({"longest_run", "", From(0)}, &Fit::longest_run);
      field({"longest_run_from_s", "", Finite()}, &Fit::longest_run_from_s);
      field({"odometry_misfits", "", From(0)}, &Fit::odometry_misfits);
      field({"worst_odometry_s", "", Finite()}, &Fit::worst_odometry_s);
      field({"odometry_break_lead_nats", "", Finite()}, &Fit::odometry_break_lead_nats);
      field({"fewest_common", "", From(0)}, &Fit::fewest_common);
      field({"fewest_common_s", "", Finite()}, &Fit::fewest_common_s);
      field({"few_common_lead_nats", "", Finite()}, &Fit::few_common_lead_nats);
      field({"false_ratio", "", Share()}, &Fit::false_ratio);
      field({"one_sided", "", From(0)}, &Fit::one_sided);
      field({"two_sided", "", From(0)}, &Fit::two_sided);
      field({"one_sided_s", "", Finite()}, &Fit::one_sided_s);
      field({"most_one_sided", "", From(0)}, &Fit::most_one_sided);
      field({"most_one_sided_s", "", Finite()}, &Fit::most_one_sided_s);
      field({"worst_robot", "W", IndexInto("robots")}, &Fit::worst_robot);
      field({"worst_time_s", "W", Finite()}, &Fit::worst_time_s);
      field({"worst_sigmas", "W", From(0)}, &Fit::worst_sigmas);
      field({"misfit_landmark", "", IndexInto("landmarks").OrNone()}, &Fit::misfit_landmark);
      field({"landmark_misfits", "", From(0)}, &Fit::landmark_misfits);
      field({"landmark_observations", "", From(0)}, &Fit::landmark_observations);
      field({"shift_m", "", NotNegative()}, &Fit::shift_m);
      field({"shift_from_s", "", Finite()}, &Fit::shift_from_s);
      field({"shift_until_s", "", Finite()}, &Fit::shift_until_s);
      field({"shift_lead_nats", "", Finite()}, &Fit::shift_lead_nats);
      field({"shift_taken", "", YesNo()}, &Fit::shift_taken);
    }
  };

  // Landmarks with an identity that stood elsewhere before, or after.
  struct Moved {
    Column<std::int32_t> landmark;
    Column<double> until_s, from_s;
    Column<std::int64_t> left_out;
    Column<std::uint8_t> later_left_out;
    static void Fields(const auto& field) {
      field({"landmark", "M", IndexInto("landmarks")}, &Moved::landmark);
      field({"until_s", "M", Finite()}, &Moved::until_s);
      field({"from_s", "M", Finite()}, &Moved::from_s);
      field({"left_out", "M", From(0)}, &Moved::left_out);
      field({"later_left_out", "M", YesNo()}, &Moved::later_left_out);
    }
  };

  // Pauses of a robot's odometry of whose way no row tells.
  struct Holes {
    Column<std::int32_t> robot;
    Column<double> from_s, length_s, missing_m, lead_nats;
    Column<std::int64_t> shared_landmarks;
    static void Fields(const auto& field) {
      field(Needed("robot", "H", IndexInto("robots")), &Holes::robot);
      field(Needed("from_s", "H", Finite()), &Holes::from_s);
      field(Needed("length_s", "H", Positive()), &Holes::length_s);
      field(Needed("missing_m", "H", Positive()), &Holes::missing_m);
      field(Needed("shared_landmarks", "H", From(0)), &Holes::shared_landmarks);
      field(Needed("lead_nats", "H", Finite().OrNan()), &Holes::lead_nats);
    }
  };

  Column<std::int32_t> missing_landmarks;
  Texts robots, landmarks, types, log_hash, refinement_reason, observation_doubts;
  Column<double> until_s;
  Column<std::int64_t> until_observations;
  std::vector<Robot> robot;
  Map map;
  History history;
  Column<std::uint8_t> refinement_done, refinement_along_odometry;
  Search search;
  Fit fit;
  Moved moved;
  Holes holes;

  static void Fields(const auto& field) {
    field({"robots", "R"}, &LandmarkMap::robots);
    field({"landmarks", "L"}, &LandmarkMap::landmarks);
    field({"types", "T"}, &LandmarkMap::types);
    field({"log_hash", ""}, &LandmarkMap::log_hash);
    field({"until_s", "", Finite()}, &LandmarkMap::until_s);
    field({"until_observations", "", From(0)}, &LandmarkMap::until_observations);
    field("robot", &LandmarkMap::robot);
    field("map", &LandmarkMap::map);
    field("history", &LandmarkMap::history);
    field({"refinement/done", "", YesNo()}, &LandmarkMap::refinement_done);
    field({"refinement/reason", ""}, &LandmarkMap::refinement_reason);
    field({"refinement/along_odometry", "", YesNo()}, &LandmarkMap::refinement_along_odometry);
    field({"observation_doubts", "D"}, &LandmarkMap::observation_doubts);
    field({"missing_landmarks", "N", IndexInto("landmarks")}, &LandmarkMap::missing_landmarks);
    field("search", &LandmarkMap::search);
    field("fit", &LandmarkMap::fit);
    field("moved", &LandmarkMap::moved);
    field("holes", &LandmarkMap::holes);
  }
};

}  // namespace cairn::kinds
