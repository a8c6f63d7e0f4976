#include "datasets/evaluate/grid.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/common/made_from.h"
#include "datasets/evaluate/maps/doors.h"
#include "datasets/evaluate/track.h"
#include "schema/kinds/provenance.h"
#include "schema/square.h"

namespace cairn::datasets {
namespace {

constexpr double kSamePosesM = 1e-4;  // poses this near to the true ones are in the truth's frame

// The scans of whose times the truth has poses, at these; and the positions of both, to be laid over each
// other.
struct TrueScans {
  std::vector<ScoredSensor> scans;
  std::vector<PointPair> pairs;
  std::vector<double> turned_rad;  // by how much the map's heading differs, in frames as they are
};

TrueScans AtTruePoses(const std::vector<ScoredSensor>& scans, const Blob& log) {
  TrueScans of_truth;
  for (const ScoredSensor& sensor : scans) {
    const Track truth = ReadTrack(log, "truth/robot/" + std::to_string(sensor.robot) + "/poses/");
    std::vector<std::size_t> kept;
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < sensor.poses.size(); ++i) {
      const auto at = PoseAt(truth, sensor.time_s[i]);
      if (!at) continue;
      kept.push_back(i);
      poses.push_back(*at);
      of_truth.pairs.push_back({{at->x_m, at->y_m}, {sensor.poses[i].x_m, sensor.poses[i].y_m}});
      of_truth.turned_rad.push_back(sensor.poses[i].heading_rad - at->heading_rad);
    }
    if (!kept.empty()) of_truth.scans.push_back(sensor.At(kept, poses));
  }
  return of_truth;
}

double HeadingRmseDeg(const std::vector<double>& turned_rad, const Similarity& to_map) {
  double squares = 0;
  for (const double turned : turned_rad) squares += Square(WrapAngle(turned - to_map.angle_rad));
  return std::sqrt(squares / static_cast<double>(turned_rad.size())) * 180 / std::numbers::pi;
}

std::vector<ScoredSensor> Moved(std::vector<ScoredSensor> scans, const Similarity& by) {
  for (ScoredSensor& sensor : scans)
    for (Pose& pose : sensor.poses) pose = by(pose);
  return scans;
}

struct DoorTruth {
  Wall opening;
  bool open = false;
};

std::vector<DoorTruth> ReadDoors(const Blob& log, const Similarity& to_map) {
  if (!log.Has("truth/doors/x_m")) return {};
  const std::vector<Wall> openings = ReadSegments(log, "truth/doors/", to_map);
  const auto open = log.Get<std::uint8_t>("truth/doors/open");
  std::vector<DoorTruth> doors;
  for (std::size_t d = 0; d < openings.size(); ++d) {
    if (!(DistanceM(openings[d].a, openings[d].b) > 0))
      throw InputError("'truth/doors/', row " + std::to_string(d) + ": an opening of no width");
    doors.push_back({openings[d], open[d] != 0});
  }
  return doors;
}

// The truth in the map's frame, and the map's scans.
struct Ground {
  std::vector<ScoredSensor> scans;
  bool by_own_path = false;
  Similarity to_map;
  std::optional<double> pose_rmse_m, pose_heading_rmse_deg;
  std::optional<MapTruth> walls;
  std::vector<DoorTruth> doors;
};

Ground GroundOf(const Blob& map, const Blob& log) {
  CheckMadeFrom(map, log);
  Ground ground;
  ground.scans = ReadScoredScans(map, log);
  const TrueScans of_truth = AtTruePoses(ground.scans, log);
  const std::vector<PointPair>& pairs = of_truth.pairs;
  ground.by_own_path = pairs.empty();
  if (!pairs.empty() && RmseM(pairs, ground.to_map) > kSamePosesM) ground.to_map = FitRigid(pairs);
  if (!pairs.empty()) {
    ground.pose_rmse_m = RmseM(pairs, ground.to_map);
    ground.pose_heading_rmse_deg = HeadingRmseDeg(of_truth.turned_rad, ground.to_map);
  }
  if (log.Has("truth/walls/x_m")) {
    const std::vector<Wall> walls = ReadSegments(log, "truth/walls/", ground.to_map);
    // What was free and seen in the world does not hang on where the map takes its scans to be from: by those
    // poses a map whose path lies in its walls would have nothing false.
    ground.walls = TruthOfWalls(ReadOccupancy(map).box, walls,
                                ground.by_own_path ? ground.scans : Moved(of_truth.scans, ground.to_map));
  }
  ground.doors = ReadDoors(log, ground.to_map);
  return ground;
}

// 1 from `log_odds` on, 0 below; unknown where the map says nothing.
Occupancy CutAt(const Occupancy& map, double log_odds) {
  Occupancy cut = map;
  for (double& p : cut.probability) {
    const double l = std::log(p / (1 - p));
    if (!std::isnan(p)) p = std::abs(l) < kSaysNothingNats ? NAN : l >= log_odds ? 1 : 0;
  }
  return cut;
}

LayerScore ScoreLayer(const Occupancy& map, const std::optional<MapTruth>& truth,
                      const std::vector<DoorTruth>& doors, const std::vector<ScoredSensor>& scans) {
  LayerScore score;
  if (truth) score.cells = ScoreCells(map, *truth);
  for (const DoorTruth& door : doors) {
    const double passage_m = PassageM(map, door.opening);
    score.doors.push_back({door.open, passage_m, passage_m > kPassageM - 1e-9});
  }
  score.held_out = ScoreHeldOut(map, scans);
  return score;
}

GridEvaluation GridScore(const Blob& map, const std::optional<MapTruth>& truth,
                         const std::vector<DoorTruth>& doors, const std::vector<ScoredSensor>& scans) {
  GridEvaluation evaluation;
  const Occupancy probability = ReadOccupancy(map);
  evaluation.cell_m = probability.box.cell_m;
  evaluation.map = ScoreLayer(probability, truth, doors, scans);
  if (HasMostLikely(map)) evaluation.most_likely = ScoreLayer(ReadMostLikely(map), truth, doors, scans);
  evaluation.seconds = kinds::Provenance::In(map).seconds_s.Optional();
  return evaluation;
}

void AddCells(const std::optional<CellScore>& cells, bool by_own_path, Scores* scores) {
  if (!cells) {
    scores->Add("cells", {}, "unknown: the truth has no walls");
    return;
  }
  const char* by = by_own_path ? ", by the map's own path: the truth has none" : "";
  scores->Add("cells.false_occupied", cells->false_occupied, fmt::format(" of {} free{}", cells->free, by));
  scores->AddForPrograms("cells.free", cells->free);
  scores->Add("cells.missed_occupied", cells->missed_occupied,
              fmt::format(" of {} due, {} of them held to be free{}", cells->due, cells->missed_free, by));
  scores->AddForPrograms("cells.missed_free", cells->missed_free);
  scores->AddForPrograms("cells.due", cells->due);
  scores->AddForPrograms("cells.by_own_path", by_own_path);
  scores->Add("cells.occupied_beyond_walls", cells->beyond_walls);
}

void AddDoors(const std::vector<DoorScore>& doors, Scores* scores) {
  if (doors.empty()) {
    scores->AddForPrograms("door.open", {});
    scores->AddRowsForPrograms("door.each", {});
    return;
  }
  const bool all_open = std::ranges::all_of(doors, &DoorScore::open);
  scores->Add("door.open", all_open, all_open ? ", every door" : ", not every door");
  std::vector<Scores> each;
  for (const DoorScore& door : doors) {
    Scores& row = each.emplace_back();
    row.Add("open", door.open);
    row.Add("passage_m", door.passage_m);
    row.Add("truly_open", door.truly_open);
  }
  scores->AddRows("door.each", std::move(each));
}

void AddHeldOut(const std::optional<HeldOutScore>& score, Scores* scores) {
  if (!score) {
    scores->Add("heldout.log_likelihood_per_reading", {}, "unknown: nothing was held out");
    scores->AddForPrograms("heldout.readings", std::int64_t{0});
    scores->AddRowsForPrograms("heldout.sensors", {});
    return;
  }
  scores->Add("heldout.log_likelihood_per_reading", score->log_likelihood_per_reading, " nat");
  scores->Add("heldout.readings", score->readings);
  std::vector<Scores> sensors;
  for (const SensorLikelihood& sensor : score->sensors) {
    Scores& row = sensors.emplace_back();
    row.Add("name", sensor.name);
    row.Add("readings", sensor.readings);
    row.Add("log_likelihood_per_reading", sensor.log_likelihood / static_cast<double>(sensor.readings));
    row.Add("p_hit", sensor.model.p_hit);
    row.Add("p_rand", sensor.model.p_rand);
    row.Add("sigma_m", sensor.model.sigma_m);
  }
  scores->AddRows("heldout.sensors", std::move(sensors));
}

Scores ScoresOfLayer(const LayerScore& layer, bool by_own_path) {
  Scores scores;
  AddCells(layer.cells, by_own_path, &scores);
  AddDoors(layer.doors, &scores);
  AddHeldOut(layer.held_out, &scores);
  return scores;
}

}  // namespace

GridEvaluation EvaluateGrid(const Blob& map, const Blob& truth_log) {
  const Ground ground = GroundOf(map, truth_log);
  GridEvaluation evaluation = GridScore(map, ground.walls, ground.doors, ground.scans);
  evaluation.by_own_path = ground.by_own_path;
  evaluation.to_map = ground.to_map;
  evaluation.pose_rmse_m = ground.pose_rmse_m;
  evaluation.pose_heading_rmse_deg = ground.pose_heading_rmse_deg;
  return evaluation;
}

std::vector<ThresholdScore> ScoreByThreshold(const Blob& map, const Blob& truth_log,
                                             const std::vector<double>& log_odds) {
  const Ground ground = GroundOf(map, truth_log);
  if (!ground.walls) throw InputError("the log's truth has no walls");
  const Occupancy probability = ReadOccupancy(map);
  std::vector<ThresholdScore> scores;
  for (const double at : log_odds) {
    const Occupancy cut = CutAt(probability, at);
    ThresholdScore score{at, ScoreCells(cut, *ground.walls), true};
    for (const DoorTruth& door : ground.doors) {
      const bool open = PassageM(cut, door.opening) > kPassageM - 1e-9;
      score.doors_right = score.doors_right && open == door.open;
    }
    scores.push_back(score);
  }
  return scores;
}

GridEvaluation CompareGrids(const Blob& map, const Blob& reference) {
  return GridScore(map, TruthOfMap(ReadOccupancy(map).box, ReadOccupancy(reference)), {}, {});
}

Scores MakeScores(const GridEvaluation& evaluation) {
  Scores scores = ScoresOfLayer(evaluation.map, evaluation.by_own_path);
  if (evaluation.most_likely)
    scores.AddGroup("most_likely", ScoresOfLayer(*evaluation.most_likely, evaluation.by_own_path));
  else
    scores.AddForPrograms("most_likely", {});
  scores.AddForPrograms("cell_m", evaluation.cell_m);
  const auto add = [&](const char* name, const std::optional<double>& value) {
    if (value)
      scores.Add(name, *value);
    else
      scores.AddForPrograms(name, {});
  };
  add("pose_rmse_m", evaluation.pose_rmse_m);
  add("pose_heading_rmse_deg", evaluation.pose_heading_rmse_deg);
  scores.Add("seconds", OrNone(evaluation.seconds));
  return scores;
}

}  // namespace cairn::datasets
