// What a grid map ought to show, laid over its cells.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "datasets/common/occupancy.h"
#include "datasets/common/walls.h"
#include "datasets/evaluate/maps/scored_scans.h"
#include "datasets/evaluate/matching/similarity.h"
#include "schema/blob.h"

namespace cairn::datasets {

struct MapTruth {
  GridBox box;                     // the map's cells, and as many more around as it takes
  std::vector<std::uint8_t> wall;  // [cells] 1: a wall crosses it
  std::vector<std::uint8_t> due;   // … of which some reading tells: a map should have it
  std::vector<std::uint8_t> free;  // 1: no wall, and reached from the robot's way without crossing one
  std::int64_t offset_columns = 0, offset_rows = 0;  // of the map's cell (0, 0) in the box
};

// Walls of a log's truth, in the map's frame, and where the scans were truly taken. A wall's cell is due
// where a beam of `scans` has it in its cone, at most a cell's edge behind the nearest point of any wall in
// it.
MapTruth TruthOfWalls(const GridBox& map, const std::vector<Wall>& walls,
                      const std::vector<ScoredSensor>& scans);

// Of another grid map: due are all cells that it has as occupied, free those that it has as free. Of a cell
// tells what that map says at its centre, and, where its cells are smaller, all of them whose centre lies
// within: one that is occupied makes it occupied.
// Throws InputError where it tells of none: the maps lie apart.
MapTruth TruthOfMap(const GridBox& map, const Occupancy& reference);

// truth/walls/ (or truth/doors/) of a log, in the map's frame.
// Throws InputError where columns differ in shape.
std::vector<Wall> ReadSegments(const Blob& log, const std::string& prefix, const Similarity& to_map);

struct CellScore {
  std::int64_t false_occupied = 0;   // occupied, in the free, no wall in the cell nor beside it
  std::int64_t free = 0;             // cells that are truly free
  std::int64_t missed_occupied = 0;  // due, and neither the cell nor one beside it is occupied
  std::int64_t missed_free = 0;      // of these, held to be free, not unknown
  std::int64_t due = 0;
  std::int64_t beyond_walls = 0;  // occupied, where no robot could know: behind walls
};
CellScore ScoreCells(const Occupancy& map, const MapTruth& truth);

}  // namespace cairn::datasets
