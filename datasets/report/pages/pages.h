// The page of each kind of result: what stands between title and footer; and the pictures and scenes that are
// a kind's own. All throw InputError where a result's arrays do not fit each other, or what is given beside
// it (which may be null) is another's.
#pragma once

#include <string>
#include <vector>

#include "datasets/evaluate/evaluate.h"
#include "datasets/evaluate/grid.h"
#include "datasets/evaluate/local.h"
#include "datasets/report/drawing/charts.h"
#include "datasets/report/scene.h"
#include "schema/blob.h"

namespace cairn::datasets::report {

std::string LandmarkMapHtml(const Blob& result, const Blob* log, const Evaluation* evaluation);
std::string GridMapHtml(const Blob& map, const Blob* log, const GridEvaluation* evaluation);

std::string SoFarHtml(const Blob& so_far);
std::string SoFarPng(const Blob& so_far, int width_px);
// The map and its history, of such a map of cells.
std::string GridSoFarHtml(const Blob& map);

std::string LocalHtml(const Blob& result, const Blob* log, const LocalEvaluation* evaluation);
// The paths, edges and loops of a local_map; with `log` raw odometry from each path's first pose on, with
// `evaluation` too true walls and paths.
Scene LocalSceneOf(const Blob& result, const Blob* log, const LocalEvaluation* evaluation);

std::string NetworksHtml(const Blob& result);
// What each network makes of the places it was trained at, by distance travelled in the first run; the same
// as the bytes of a PNG.
std::vector<std::vector<ChartPoint>> OutputsAlongRun(const Blob& result);
std::string OutputsHtml(const Blob& result);
std::string NetworksPng(const Blob& result);

// `samples`: what it was made from, null where errors are not asked for.
std::string LocalizationHtml(const Blob& result, const Blob* samples);
// Error by distance travelled, and how sure the robots are, as the bytes of a PNG.
std::string LocalizationPng(const Blob& result, const Blob* samples);

// Of samples, as the pipeline `image_features` makes them: where they were taken, and of each run how many,
// its way and what was sensed on it.
std::string SamplesHtml(const Blob& samples);
// Where they were taken, a path a run.
Scene SamplesSceneOf(const Blob& samples);

}  // namespace cairn::datasets::report
