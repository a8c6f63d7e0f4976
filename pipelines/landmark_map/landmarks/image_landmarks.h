// Landmarks without identity from whole images, once the poses are known: things that stand closer together
// than one range-bearing observation is exact can still be told apart where one image shows them both.
#pragma once

#include <span>
#include <vector>

#include "pipelines/landmark_map/landmarks/summary.h"
#include "pipelines/landmark_map/model/steps.h"
#include "schema/geometry.h"

namespace cairn::landmark_map {

// Of a landmark that has a name.
struct NamedInImage {
  std::int32_t landmark;
  Point position;
  bool shown;  // in this very image; else a little earlier or later from the same step
};

// What a robot saw at one step, laid out from its most likely pose; `heading_rad` is where it looked.
struct ImageObservations {
  Point from;
  double heading_rad = 0.0;
  std::vector<Point> seen;
  std::size_t robot = 0;
  std::vector<std::int32_t> observation;  // of each: its index in the robot's steps
  std::vector<NamedInImage> named = {};   // besides, or alone
};

// Appends the images of a robot's range-bearing observations of `type`, contact detections left out. `steps`:
// with the drift taken off that the poses have been estimated under. x_m, y_m, correction_rad: [S], a pose
// and a heading correction a step. What has a name, a smaller type, comes along where `row_time_s`, the time
// of each row of the log, is given; its `landmark` is the type.
void AppendImages(const RobotSteps& steps, int type, std::size_t robot, const std::vector<double>& x_m,
                  const std::vector<double>& y_m, const std::vector<double>& correction_rad,
                  std::span<const double> row_time_s, std::vector<ImageObservations>* images);

struct ImageRules {
  double sigma_m = 0.3;  // of a range-bearing observation's place: what the sensor errs, and the pose
  double cell_m = 1.0;   // of the map whose poses these are: no landmark is known better
  int type = 0;          // layer of the landmarks
};

struct ImageLandmarks {
  std::vector<Landmark> landmarks;  // most observed first
  std::vector<std::vector<std::int32_t>>
      landmark;                                  // [image][seen]: an index into those with names, then them
  std::vector<std::vector<double>> probability;  // of that, against the landmarks near by
};

// k-means in which an image shows no landmark twice and k is found. In turn: each image gives its
// range-bearing observations to landmarks, nearest pairs first, within three sigma, after a shift of the
// whole image that the pairs ask for (poses err, and an image's range-bearing observations err together);
// what is left over begins a landmark; landmarks move to the mean of what they got. Of two within three sigma
// that are hardly ever in one image the rarer goes; so does, in the end, one all of whose range-bearing
// observations (but for one in fifty) could be of others that their images do not show; and always one that
// was seen only once, or in less than a tenth of the images that looked at it. Last go those few observations
// of which are as likely false ones that fell together: as many as are of no landmark, anywhere. `named`:
// landmarks with names, which stay where they are, and to which observations without a name are given, too,
// where their image does not show them by name: so one beside them that is hardly ever shown together with
// them goes.
ImageLandmarks FindImageLandmarks(const std::vector<ImageObservations>& images, const ImageRules& rules,
                                  const std::vector<Point>& named = {});

// How much likelier it is, in nats, that `count` of so many looks at a place show a landmark, of which a look
// shows `rate` as it does of others, than that false observations fell together there, of which there are
// `false_ones` and `beside` in the place's surroundings a look.
double LogOddsOfLandmark(double count, double looks, double rate, double false_ones, double beside);

}  // namespace cairn::landmark_map
