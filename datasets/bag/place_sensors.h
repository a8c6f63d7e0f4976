// From what was read of bags to a log: which odometry, where each sensor sits, rounds of a ring of sonars.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "datasets/bag/cloud.h"
#include "datasets/bag/fixes.h"
#include "datasets/bag/gyro.h"
#include "datasets/bag/readers.h"
#include "datasets/bag/tag_images.h"
#include "datasets/import/log_rows.h"
#include "schema/blob.h"

namespace cairn::datasets::bag {

// An odometry that the log does not have: the one that it has is compared with it.
struct OtherOdometry {
  std::string topic;
  OdometryRows rows;
};

struct Gathered {
  std::string robot;             // its namespace; empty: it has none
  std::string path;              // for messages
  std::filesystem::path folder;  // for what is read of it (KeepIn)
  NoiseParameters noise;
  std::string odometry_topic;          // "tf": that of a frame which moves on "odom"
  std::string base;                    // the robot's frame; empty: that of the odometry
  std::map<std::string, Pose> mounts;  // by topic or frame
  FindMount find_mount;                // of sensors that are looked at before all frames are known
  OdometryRows odometry;
  std::vector<std::unique_ptr<OtherOdometry>> others;
  GyroRows gyro;  // without a topic there is none
  FrameTree frames;
  std::vector<std::unique_ptr<ScanTopic>> scans, sonars;
  SpooledRows<PoseRow> truth, poses;
  bool truth_by_tf = false, poses_by_tf = false;  // they are those of the robot on "map"
  FixRows fixes;                                  // the truth, where it has a topic
  std::vector<Sighting> landmarks;
  std::vector<FrameSighting> tags;  // detections of tags that are where their frames are
  std::vector<std::unique_ptr<TagCamera>> cameras;
  FollowedFrames followed;
  std::vector<Topic> topics;  // all that there are

  // What there are many of lies there while it is read.
  void KeepIn(const std::filesystem::path& where) {
    folder = where;
    frames = FrameTree(folder);
    odometry.poses = truth = poses = SpooledRows<PoseRow>(folder);
    gyro.rows = SpooledRows<GyroRow>(folder);
  }
};

// Where the robot's sensors sit, by its odometry and its frames.
FindMount MountsOf(Gathered robot);

// As ImportBag says (import_bag.h).
ImportReport MakeBagLog(std::vector<Gathered> robots, ImportReport report, Blob* log);

}  // namespace cairn::datasets::bag
