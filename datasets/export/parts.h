// What the exporters share.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "datasets/common/occupancy.h"
#include "datasets/export/export.h"
#include "schema/blob.h"
#include "schema/geometry.h"

namespace cairn::datasets {

// A robot's path, and where it has them the covariances of x, y, heading (9 numbers a pose).
struct Path {
  std::size_t index = 0;  // in `robots`
  std::string robot;      // its name
  std::string file;       // its name made fit for a file name, unlike the others'
  std::vector<double> time_s;
  std::vector<Pose> poses;
  std::vector<double> covariances;
};

// The most likely poses, else the means, else the true ones.
// Throws InputError where there are none.
std::vector<Path> ReadPaths(const Blob& blob);

// The same, but of a grid_map, which may be without: none.
std::vector<Path> PathsOf(const Blob& blob);
// Throws InputError beyond what 64 bits hold.
std::int64_t Nanoseconds(double time_s);

// What other programs may take a cell to be. Of a grid map as ReadOccupancy says. A landmark map tells where
// something stands and nothing of free space: known are the cells of its extracted landmarks, which are
// occupied, and those that hold a landmark more likely than not; of all others nothing is.
// Throws InputError where there is no grid.
Occupancy ReadCells(const Blob& blob);
// Whether it is a grid_map, and no landmark_map, which has a layer for each landmark.
bool IsGridMap(const Blob& blob);

struct MapLandmark {
  Point at;
  double var_xx_m2 = 0, var_xy_m2 = 0, var_yy_m2 = 0;
};
std::vector<MapLandmark> ReadMapLandmarks(const Blob& blob);  // empty where there are none

// Files that are written into a folder, once all of them are known.
class FolderWriter {
 public:
  FolderWriter(std::string folder, bool replace) : folder_(std::move(folder)), replace_(replace) {}
  void Write(const std::string& name, std::string text);
  // The paths, or the first failure.
  // Throws InputError, and writes nothing, where one of the files is there already with other bytes and none
  // is to be replaced; nor is one that has come to be there meanwhile. Nor is ever a file of Cairn (it may be
  // the input). They are written in their order, and of several that change all but the first are taken away
  // before: one that names others comes last.
  Written Finish();

 private:
  std::string folder_;
  bool replace_;
  std::vector<std::pair<std::string, std::string>> files_;  // path, text
};

}  // namespace cairn::datasets
