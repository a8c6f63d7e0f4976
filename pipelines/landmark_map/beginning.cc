#include "pipelines/landmark_map/beginning.h"

namespace cairn::landmark_map {

bool StartsAnywhere(const Options& options, std::size_t robot) {
  return robot > 0 || options.start == "anywhere";
}

Beginning BeginningOf(const Options& options, const Inputs& inputs) {
  const Blob& log = *inputs.Get("log");
  Beginning beginning{Resolve(options, log), {}, {}, {}};
  beginning.schedule.prefix = beginning.settings.growth_start;
  beginning.schedule.growth = beginning.settings.growth_factor;
  beginning.schedule.summarise = options.iterations == 0;
  if (options.iterations == 0) beginning.settings.starts = 1;  // nothing to choose from
  const std::size_t robots = log.Texts("robots").size();
  if (!inputs.Has("map")) {
    if (options.start == "anywhere") throw InputError("start=anywhere needs the input 'map'");
    if (options.iterations == 0 && robots > 1)
      throw InputError("iterations=0 needs the input 'map' where there are several robots");
    return beginning;
  }
  if (options.starts > 1) throw InputError("with the input 'map' EM starts from it alone: take starts=1");
  beginning.settings.starts = 1;
  beginning.settings.loose_frame = false;  // the frame is the given map's
  beginning.schedule.prefix = 1.0;
  beginning.schedule.robots = static_cast<std::int64_t>(robots);
  beginning.given = ReadGivenMap(*inputs.Get("map"), log, beginning.settings);
  beginning.perception = PerceptionOf(beginning.given->map, beginning.settings.map);
  return beginning;
}

}  // namespace cairn::landmark_map
