#include "schema/store/result_kind.h"

namespace cairn {

std::string ResultKind(const Blob& result) {
  if (result.Has("map/landmark_x_m")) return "landmark_map";
  if (result.Has("map/grid/probability")) return "grid_map";
  if (result.Has("networks/hidden_weight")) return "networks";
  if (result.Has("belief/place")) return "localization";
  if (result.Has("traces/first_z")) return "local_map";
  if (result.Has("robot/0/poses/time_s")) return "poses";
  if (result.Has("run/0/input")) return "samples";
  return "result";
}

}  // namespace cairn
