// `cairn export`: what other tools read. Each function writes files into `folder` (made where missing), every
// one whole or not at all, and returns their paths. They throw InputError where the blob lacks what is asked
// for, and where one of the files is there already and `replace` is false: then none is written. A failed
// Status is the world's: no space, no right to write.
#pragma once

#include <string>
#include <vector>

#include "schema/blob.h"

namespace cairn::datasets {

using Written = Result<std::vector<std::string>>;

// ROBOT.tum for each robot: "time x y z qx qy qz qw" a line, as TUM's tools and evo read it. Poses are the
// most likely ones where the file has them, else the means; of a log, the true ones.
Written ExportTum(const Blob& blob, const std::string& folder, bool replace = true);
// ROBOT.kitti, the upper three rows of each pose's matrix a line, and ROBOT.times beside it, seconds a line.
Written ExportKitti(const Blob& blob, const std::string& folder, bool replace = true);
// ROBOT.csv as EuRoC's state_groundtruth_estimate0/data.csv: nanoseconds, position, quaternion (w first);
// velocity and biases, which nobody knows, are "nan". Throws InputError also where a time is beyond 292
// years.
Written ExportEuroc(const Blob& blob, const std::string& folder, bool replace = true);

// landmarks.ply: where they are, with their covariances; of a grid map map.ply, the middles of the cells that
// are rather occupied; path_ROBOT.ply, the path's poses, with lines from each to the next.
Written ExportPly(const Blob& blob, const std::string& folder, bool replace = true);

// Where (0, 0) of a map lies on the earth, and how far its x-axis is turned from east, counter-clockwise.
struct GeoOrigin {
  double latitude_deg = 0, longitude_deg = 0, x_axis_deg = 0;
};
// map.geojson: a feature for each landmark and each path, on WGS 84.
Written ExportGeojson(const Blob& blob, const GeoOrigin& origin, const std::string& folder,
                      bool replace = true);

// How a graph has landmarks: as VERTEX_XY and EDGE_SE2_XY, or as poses of which next to nothing tells the
// heading, VERTEX_SE2 and EDGE_SE2, for readers that know only these, as GTSAM's.
enum class G2oLandmarks { kPoints, kPoses };
// graph.g2o: VERTEX_SE2 for each pose (as for tum), VERTEX_XY for each landmark. With the log at hand (else
// null) the edges are what the result was made of: odometry from each pose to the next one, and observations
// of landmarks or loops (landmark_edges.h, local_edges.h), so that a solver that starts from the vertices
// stays there. Without it an EDGE_SE2 from each pose to the next one is the result's own motion, as sure as
// the mean of its two poses' covariances, turned into the first pose's frame: a picture.
Written ExportG2o(const Blob& result, const Blob* log, const std::string& folder, bool replace = true,
                  G2oLandmarks landmarks = G2oLandmarks::kPoints);

// map.pgm and map.yaml, as map_server of ROS reads them. Trinary: occupied 0, free 254, unknown 205, by
// map_saver's thresholds 0.65 and 0.196. Scale: grey 255 (1 - p), and map.png beside, which map.yaml names:
// there what is unknown is transparent, as map_server has no other word for it in this mode. Raw: 100 p,
// unknown 255. A landmark map tells where landmarks are and nothing of free space: no cell is free; the cell
// of each extracted landmark is occupied, one that holds a landmark more likely than not has its probability,
// and nothing is known of the rest.
enum class RosMode { kTrinary, kScale, kRaw };
Written ExportRos(const Blob& result, const std::string& folder, bool replace = true,
                  RosMode mode = RosMode::kTrinary);

// map.bt, a binary octree of OctoMap (A. Hornung, K. M. Wurm, M. Bennewitz, C. Stachniss, W. Burgard,
// OctoMap, Autonomous Robots 34, 2013): the grid as one layer of voxels from z = 0 on, occupied where p >
// 1/2, free where p < 1/2, else unknown (of a landmark map none is free, as above). Its voxels lie on
// multiples of the cell; a map whose origin does not is moved by up to half a cell.
Written ExportOctomap(const Blob& result, const std::string& folder, bool replace = true);

// map.mcap: messages of Foxglove's schemas, encoded by protobuf (docs/exports.md has the topics): the grid,
// landmarks with the regions that hold them by 95%, paths, each pose at its time, beliefs.
Written ExportMcap(const Blob& blob, const std::string& folder, bool replace = true);

// map.png: paths, landmarks with their 95% regions, the grid beneath, axes, a bar for scale
// (report/draw_map.h). Of a grid map a pixel for each cell (report/cell_picture.h), and beside it
// most_likely.png, difference.png and dynamic.png where it has these layers.
Written ExportPng(const Blob& result, const std::string& folder, bool replace = true);

// Of a log: odometry.csv, observations.csv, truth_poses.csv, truth_landmarks.csv, truth_associations.csv
// (those that it has), from which `import csv` makes the same log, to the bit; noise parameters are not in
// them. Of a result: poses.csv, landmarks.csv, associations.csv. Numbers have as many digits as it takes to
// read them back.
Written ExportCsv(const Blob& blob, const std::string& folder, bool replace = true);
// Groups of a log for which CSV has no place, sorted: noise, robot/0/laser. Of a result none.
std::vector<std::string> NotInCsv(const Blob& blob);

}  // namespace cairn::datasets
