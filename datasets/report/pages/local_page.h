// The page of a local map.
#pragma once

#include <string>
#include <vector>

#include "datasets/evaluate/local.h"
#include "datasets/report/pages/local_pictures.h"
#include "datasets/report/scene.h"
#include "schema/blob.h"

namespace cairn::datasets::report {

// Dead reckoning of each of the log's robots.
std::vector<Track> OdometryOf(const Blob& log);

// The paths, edges and loops of a local_map; with `log` raw odometry from each path's first pose on, with
// `evaluation` too true walls and paths. Both may be null.
// Throws InputError where the arrays do not fit each other, or the log's robots are not the result's.
Scene LocalSceneOf(const Blob& result, const Blob* log, const LocalEvaluation* evaluation);

// The snapshot that shows most: of those with the most edges in their last scan the one with most cells that
// have an orientation. Null where there is none.
const LocalSnapshot* RichestOf(const LocalResult& result);
const LocalTrace* LongestOf(const LocalResult& result);

// The page's body. `log` and `evaluation` may be null.
std::string LocalHtml(const Blob& result, const Blob* log, const LocalEvaluation* evaluation);

}  // namespace cairn::datasets::report
