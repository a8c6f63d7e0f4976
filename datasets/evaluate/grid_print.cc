#include <cstdarg>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "datasets/evaluate/grid.h"

namespace cairn::datasets {
namespace {

using Json = nlohmann::ordered_json;

Json CellsJson(const std::optional<CellScore>& cells) {
  if (!cells) return nullptr;
  return {{"false_occupied", cells->false_occupied},
          {"free", cells->free},
          {"missed_occupied", cells->missed_occupied},
          {"missed_free", cells->missed_free},
          {"due", cells->due},
          {"occupied_beyond_walls", cells->beyond_walls}};
}

bool AllOpen(const std::vector<DoorScore>& doors) {
  for (const DoorScore& door : doors)
    if (!door.open) return false;
  return true;
}

Json DoorJson(const std::vector<DoorScore>& doors) {
  Json each = Json::array();
  for (const DoorScore& door : doors)
    each.push_back({{"open", door.open}, {"passage_m", door.passage_m}, {"truly_open", door.truly_open}});
  return {{"open", doors.empty() ? Json(nullptr) : Json(AllOpen(doors))}, {"each", each}};
}

Json HeldOutJson(const std::optional<HeldOutScore>& score) {
  if (!score) return {{"log_likelihood_per_reading", nullptr}, {"readings", 0}, {"sensors", Json::array()}};
  Json sensors = Json::array();
  for (const SensorLikelihood& sensor : score->sensors) {
    sensors.push_back(
        {{"name", sensor.name},
         {"readings", sensor.readings},
         {"log_likelihood_per_reading", sensor.log_likelihood / static_cast<double>(sensor.readings)},
         {"p_hit", sensor.model.p_hit},
         {"p_rand", sensor.model.p_rand},
         {"sigma_m", sensor.model.sigma_m}});
  }
  return {{"log_likelihood_per_reading", score->log_likelihood_per_reading},
          {"readings", score->readings},
          {"sensors", sensors}};
}

Json LayerJson(const LayerScore& layer) {
  return {{"cells", CellsJson(layer.cells)},
          {"door", DoorJson(layer.doors)},
          {"heldout", HeldOutJson(layer.held_out)}};
}

__attribute__((format(printf, 1, 2))) std::string Words(const char* format, ...) {
  char text[400];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

std::string GridLine(const std::string& name, const std::string& value) {
  return name + std::string(name.size() < 44 ? 44 - name.size() : 1, ' ') + value + "\n";
}

std::string LayerText(const std::string& prefix, const LayerScore& layer) {
  std::string text;
  if (layer.cells) {
    const CellScore& cells = *layer.cells;
    text += GridLine(prefix + "cells.false_occupied",
                     Words("%lld of %lld free", static_cast<long long>(cells.false_occupied),
                           static_cast<long long>(cells.free)));
    text += GridLine(
        prefix + "cells.missed_occupied",
        Words("%lld of %lld due, %lld of them held to be free", static_cast<long long>(cells.missed_occupied),
              static_cast<long long>(cells.due), static_cast<long long>(cells.missed_free)));
    text += GridLine(prefix + "cells.occupied_beyond_walls", std::to_string(cells.beyond_walls));
  } else {
    text += GridLine(prefix + "cells", "unknown: the truth has no walls");
  }
  for (const DoorScore& door : layer.doors) {
    text += GridLine(prefix + "door.open", Words("%s, %.2f m wide; truly %s", door.open ? "yes" : "no",
                                                 door.passage_m, door.truly_open ? "open" : "closed"));
  }
  if (!layer.held_out) return text + GridLine(prefix + "heldout", "nothing was held out");
  for (const SensorLikelihood& sensor : layer.held_out->sensors) {
    text += GridLine(prefix + "heldout " + sensor.name,
                     Words("%.4f a reading, of %lld; p_hit %.3f, p_rand %.3f, sigma %.3f m",
                           sensor.log_likelihood / static_cast<double>(sensor.readings),
                           static_cast<long long>(sensor.readings), sensor.model.p_hit, sensor.model.p_rand,
                           sensor.model.sigma_m));
  }
  return text + GridLine(prefix + "heldout.log_likelihood_per_reading",
                         Words("%.4f nat", layer.held_out->log_likelihood_per_reading));
}

}  // namespace

std::string GridEvaluationJson(const GridEvaluation& evaluation, int indent) {
  Json json = LayerJson(evaluation.map);
  json["most_likely"] = evaluation.most_likely ? LayerJson(*evaluation.most_likely) : Json(nullptr);
  json["cell_m"] = evaluation.cell_m;
  json["pose_rmse_m"] = evaluation.pose_rmse_m ? Json(*evaluation.pose_rmse_m) : Json(nullptr);
  json["seconds"] = evaluation.seconds ? Json(*evaluation.seconds) : Json(nullptr);
  return json.dump(indent);
}

std::string GridEvaluationText(const GridEvaluation& evaluation) {
  std::string text = LayerText("", evaluation.map);
  if (evaluation.most_likely) text += LayerText("most_likely.", *evaluation.most_likely);
  if (evaluation.pose_rmse_m) text += GridLine("pose_rmse_m", Words("%.3f m", *evaluation.pose_rmse_m));
  if (evaluation.seconds) text += GridLine("seconds", Words("%.3f s", *evaluation.seconds));
  return text;
}

}  // namespace cairn::datasets
