// Clouds of points as scans: what of them is at a height.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "datasets/bag/readers.h"

namespace cairn::datasets::bag {

struct CloudCut {
  double low_m = 0, high_m = 0;  // above the robot's frame
  double reach_m = 0;
};
// "0.2,0.5,20". Throws InputError.
CloudCut ParseCloudCut(const std::string& text);

// Where what lies in a frame lies on the robot; throws InputError where nothing says so.
using FindMount = std::function<Transform(const std::string& topic, const std::string& frame)>;

// Of sensor_msgs/PointCloud2: half a degree about the sensor is a beam, and its range is that of the nearest
// point between the two heights. Beams are those directions in which there were points at any height.
std::unique_ptr<TopicReader> ReadCloud(const CloudCut& cut, FindMount find_mount, ScanTopic* topic);

}  // namespace cairn::datasets::bag
