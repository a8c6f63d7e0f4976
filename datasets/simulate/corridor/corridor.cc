#include "datasets/simulate/corridor/corridor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "datasets/common/array_text.h"
#include "datasets/common/png.h"
#include "datasets/common/samples.h"
#include "datasets/simulate/corridor/camera.h"
#include "datasets/simulate/corridor/change.h"
#include "datasets/simulate/corridor/detectors.h"
#include "datasets/simulate/corridor/sonar.h"
#include "datasets/simulate/sonar.h"
#include "pipelines/image_features/band_features.h"
#include "schema/error.h"

namespace cairn::datasets {
namespace {

using corridor::Look, corridor::Snapshot;

// Streams of the generator: the world's, then one for each set's each run. What people look at in a run draws
// from substreams, so that one does not change the other.
constexpr std::uint64_t kWorldStream = 0;
constexpr std::uint32_t kRunSubstream = 0, kCameraSubstream = 1, kSonarSubstream = 2, kLabelSubstream = 3,
                        kOdometrySubstream = 4;
constexpr std::uint32_t kChangeSubstream = 1;  // of the world's
constexpr int kMostRuns = 64, kSets = 3;

// A door, a light, is in view where it fills so much of the image.
constexpr double kDoorInView = 0.04, kLightInView = 0.003;
// Labels come from tracking: their error changes slowly, by e^-1 within such a distance.
constexpr double kLabelAlongM = 3;
constexpr double kLabelHeadingRad = std::numbers::pi / 180;

// The images of one run on a page, for people to look at: `per_row` in a row, each three times as large as it
// is. All of a size; at least one.
std::string ContactSheetPng(const std::vector<corridor::RgbImage>& images, int per_row) {
  constexpr int kScale = 3, kGap = 6;  // pixels
  const int columns = std::min(per_row, static_cast<int>(images.size()));
  const int rows = (static_cast<int>(images.size()) + per_row - 1) / per_row;
  const int cell_width = images.front().columns * kScale + kGap,
            cell_height = images.front().rows * kScale + kGap;
  const int width = columns * cell_width, height = rows * cell_height;
  std::vector<std::uint8_t> page(
      std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 255);
  for (std::size_t i = 0; i < images.size(); ++i) {
    const int left = static_cast<int>(i) % per_row * cell_width,
              top = static_cast<int>(i) / per_row * cell_height;
    for (int y = 0; y < images[i].rows * kScale; ++y) {
      for (int x = 0; x < images[i].columns * kScale; ++x) {
        const auto from = static_cast<std::size_t>(3 * (y / kScale * images[i].columns + x / kScale));
        const auto to = static_cast<std::size_t>(3 * ((top + y) * width + left + x));
        std::copy_n(images[i].rgb.begin() + static_cast<std::ptrdiff_t>(from), 3,
                    page.begin() + static_cast<std::ptrdiff_t>(to));
      }
    }
  }
  return EncodePng(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), page);
}

void CheckRange(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw InputError(std::string(name) + " is " + ShortNumber(value) + "; allowed is " + ShortNumber(low) +
                   " to " + ShortNumber(high));
}

Look LookOf(const std::string& set) {
  const auto& sets = CorridorSets();
  const auto at = std::ranges::find(sets, set);
  if (at == sets.end()) throw InputError("no set '" + set + "'; there are d1, d2, d3");
  return static_cast<Look>(at - sets.begin());
}

class SlowError {
 public:
  SlowError(double sd, Rng& rng) : sd_(sd), value_(sd * rng.Normal()) {}
  double After(double distance_m, Rng& rng) {
    const double keep = std::exp(-distance_m / kLabelAlongM);
    return value_ = keep * value_ + sd_ * std::sqrt(1 - keep * keep) * rng.Normal();
  }

 private:
  double sd_, value_;
};

void AddPoses(const std::vector<Snapshot>& snapshots, double label_error_m, Rng rng, SampleRun* run) {
  SlowError x(label_error_m, rng), y(label_error_m, rng),
      heading(label_error_m > 0 ? kLabelHeadingRad : 0, rng);
  double last_m = snapshots.front().pose.x_m;
  for (const Snapshot& snapshot : snapshots) {
    const double distance_m = std::abs(snapshot.pose.x_m - last_m);
    last_m = snapshot.pose.x_m;
    run->time_s.push_back(snapshot.time_s);
    run->true_x_m.push_back(snapshot.pose.x_m);
    run->true_y_m.push_back(snapshot.pose.y_m);
    run->true_heading_rad.push_back(snapshot.pose.heading_rad);
    run->x_m.push_back(snapshot.pose.x_m + x.After(distance_m, rng));
    run->y_m.push_back(snapshot.pose.y_m + y.After(distance_m, rng));
    run->heading_rad.push_back(WrapAngle(snapshot.pose.heading_rad + heading.After(distance_m, rng)));
  }
}

// Errors of odometry: of each way and turn, as a share of it; of the wheels, all run long; and of the
// heading.
constexpr double kOdometryShare = 0.02, kWheelShare = 0.02, kDriftRadPerM = 0.003, kWalkRadPerSqrtM = 0.005;

void AddOdometry(const std::vector<Snapshot>& snapshots, Rng rng, SampleRun* run) {
  const double wheels = 1 + kWheelShare * rng.Normal(), drift = kDriftRadPerM * rng.Normal();
  for (std::size_t k = 0; k < snapshots.size(); ++k) {
    const Pose from = snapshots[k > 0 ? k - 1 : 0].pose, to = snapshots[k].pose;
    const double turn = WrapAngle(to.heading_rad - from.heading_rad),
                 distance_m = std::hypot(to.x_m - from.x_m, to.y_m - from.y_m);
    const double c = std::cos(to.heading_rad), s = std::sin(to.heading_rad);
    const auto measured = [&](double moved_m) { return moved_m * (wheels + kOdometryShare * rng.Normal()); };
    run->turn_rad.push_back(turn * (1 + kOdometryShare * rng.Normal()) + drift * distance_m +
                            kWalkRadPerSqrtM * std::sqrt(distance_m) * rng.Normal());
    run->forward_m.push_back(measured(c * (to.x_m - from.x_m) + s * (to.y_m - from.y_m)));
    run->left_m.push_back(measured(c * (to.y_m - from.y_m) - s * (to.x_m - from.x_m)));
  }
}

// The image itself, or what becomes of it.
void AddImage(const corridor::RgbImage& image, bool as_it_is, SampleRun* run) {
  if (as_it_is) {
    run->image_rows = image.rows;
    run->image_columns = image.columns;
    run->image.insert(run->image.end(), image.rgb.begin(), image.rgb.end());
    return;
  }
  const std::vector<float> features =
      image_features::BandFeatures({}, {image.rows, image.columns, image.rgb});
  run->input.insert(run->input.end(), features.begin(), features.end());
}

// The bit that is true, and what the detector makes of image and sonars.
void AddFeatures(const corridor::View& view, const std::vector<float>& ranges, Look look, SampleRun* run) {
  const bool light = look == Look::kCeiling;
  const std::size_t side = look == Look::kOuter ? kSonars / 4 : 3 * kSonars / 4;
  const auto side_ranges_m = std::span(ranges).subspan(side - 1, 3);
  const bool in_view = light ? view.light_share >= kLightInView : view.door_share >= kDoorInView;
  const bool detected =
      light ? corridor::DetectLight(view.image) : corridor::DetectDoor(view.image, side_ranges_m);
  run->feature.push_back(in_view ? 1 : 0);
  run->feature.push_back(detected ? 1 : 0);
}

bool ComesBack(const SimulateCorridorOptions& options, int number) {
  return options.both_ways && number % 2 == 1;
}

SampleRun SimulateRun(const corridor::World& world, const SimulateCorridorOptions& options, Look look,
                      int number, std::vector<CorridorPicture>* pictures) {
  const bool back = ComesBack(options, number);
  const std::uint64_t set = static_cast<std::uint64_t>(look) + (options.changed > 0 ? kSets : 0);
  const std::uint64_t stream = 1 + set * kMostRuns + static_cast<std::uint64_t>(number);
  Rng run_rng(options.seed, stream, kRunSubstream), camera_rng(options.seed, stream, kCameraSubstream),
      sonar_rng(options.seed, stream, kSonarSubstream);
  const corridor::Run drive = corridor::DrawRun(world, options.snapshots, back, run_rng);
  const corridor::Scene scene(world, drive);
  const corridor::Shade shade(scene);
  SampleRun run;
  run.name = CorridorRunName(options, number);
  std::vector<corridor::RgbImage> shown;
  for (const Snapshot& snapshot : drive.snapshots) {
    const corridor::View view = TakeImage(scene, shade, snapshot, look, camera_rng);
    const std::vector<float> ranges = SonarRanges(scene, snapshot, sonar_rng);
    AddImage(view.image, options.images, &run);
    run.input.insert(run.input.end(), ranges.begin(), ranges.end());
    AddFeatures(view, ranges, look, &run);
    if (pictures != nullptr && snapshot.time_s * corridor::kSpeedMps >= static_cast<double>(shown.size()))
      shown.push_back(view.image);
  }
  AddPoses(drive.snapshots, options.label_error_m, Rng(options.seed, stream, kLabelSubstream), &run);
  if (options.odometry) AddOdometry(drive.snapshots, Rng(options.seed, stream, kOdometrySubstream), &run);
  if (pictures != nullptr) pictures->push_back({run.name, ContactSheetPng(shown, 10)});
  return run;
}

}  // namespace

const std::vector<std::string>& CorridorSets() {
  static const std::vector<std::string> sets{"d1", "d2", "d3"};
  return sets;
}

std::string CorridorRunName(const SimulateCorridorOptions& options, int number) {
  return options.set + (options.changed > 0 ? " changed" : "") + " run " + std::to_string(number + 1) +
         (ComesBack(options, number) ? " back" : "");
}

Blob SimulateCorridor(const SimulateCorridorOptions& options, std::vector<CorridorPicture>* pictures) {
  const Look look = LookOf(options.set);
  CheckRange("runs", options.runs, 1, kMostRuns);
  CheckRange("snapshots", options.snapshots, 2, 100000);
  CheckRange("length_m", options.length_m, 30.0, 1000.0);
  CheckRange("label_error_m", options.label_error_m, 0.0, 5.0);
  CheckRange("changed", options.changed, 0.0, 1.0);
  Rng world_rng(options.seed, kWorldStream);
  corridor::World world = corridor::DrawWorld(options.length_m, world_rng);
  Rng change_rng(options.seed, kWorldStream, kChangeSubstream);
  if (options.changed > 0) corridor::ChangeWorld(options.changed, &world, change_rng);
  Samples samples;
  if (!options.images) samples.input_name = image_features::BandFeatureNames({});
  for (int beam = 0; beam < kSonars; ++beam) samples.input_name.push_back("sonar " + std::to_string(beam));
  const std::string what = look == Look::kCeiling ? "light" : "door";
  samples.feature_name = {what, what + " detected"};
  samples.label_error_m = options.label_error_m;
  for (int number = 0; number < options.runs; ++number)
    samples.runs.push_back(SimulateRun(world, options, look, number, pictures));
  return MakeSamples(samples);
}

}  // namespace cairn::datasets
