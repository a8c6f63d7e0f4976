#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "datasets/export.h"
#include "datasets/export_parts.h"
#include "datasets/png.h"

namespace cairn::datasets {
namespace {

constexpr int kLongSidePx = 1600, kShortestSidePx = 400, kMarginPx = 40;

// Colours of paths that a colour-blind eye tells apart (M. Okabe and K. Ito), as RGB.
const cv::Scalar kColours[] = {{0, 114, 178},   {230, 159, 0},  {0, 158, 115},
                               {204, 121, 167}, {86, 180, 233}, {213, 94, 0}};
const cv::Scalar kRed(200, 0, 0), kBlack(0, 0, 0);

struct Box {
  double low_x = INFINITY, low_y = INFINITY, high_x = -INFINITY, high_y = -INFINITY;
  void Add(double x, double y) {
    if (!std::isfinite(x) || !std::isfinite(y)) return;
    low_x = std::min(low_x, x);
    low_y = std::min(low_y, y);
    high_x = std::max(high_x, x);
    high_y = std::max(high_y, y);
  }
};

class Picture {
 public:
  explicit Picture(const Box& box) : box_(box) {
    const double width = std::max(box.high_x - box.low_x, 1e-3),
                 height = std::max(box.high_y - box.low_y, 1e-3);
    pixels_per_m_ = (kLongSidePx - 2 * kMarginPx) / std::max(width, height);
    const auto side = [&](double metres) {
      return std::max(kShortestSidePx, static_cast<int>(std::lround(metres * pixels_per_m_)) + 2 * kMarginPx);
    };
    image_ = cv::Mat(side(height), side(width), CV_8UC3, cv::Scalar(255, 255, 255));
  }

  cv::Point2d At(double x_m, double y_m) const {
    return {kMarginPx + (x_m - box_.low_x) * pixels_per_m_,
            image_.rows - kMarginPx - (y_m - box_.low_y) * pixels_per_m_};
  }

  // White: free; black: occupied; shades of a landmark map are lifted so that its small probabilities show.
  void Draw(const Grid& grid) {
    for (std::int64_t row = 0; row < grid.rows; ++row) {
      for (std::int64_t column = 0; column < grid.columns; ++column) {
        const double p = grid.probability[static_cast<std::size_t>(row * grid.columns + column)];
        if (p == 0) continue;
        const double grey = std::isnan(p) ? 205 : 255 * (1 - std::sqrt(std::clamp(p, 0.0, 1.0)));
        const double x = grid.origin_x_m + static_cast<double>(column) * grid.cell_m;
        const double y = grid.origin_y_m + static_cast<double>(row) * grid.cell_m;
        const cv::Point low = At(x, y), high = At(x + grid.cell_m, y + grid.cell_m);
        cv::rectangle(image_, low, high, cv::Scalar::all(grey), cv::FILLED);
      }
    }
  }

  void Draw(const Path& path, const cv::Scalar& colour) {
    std::vector<cv::Point> line;
    for (const PoseM& pose : path.poses) {
      if (std::isfinite(pose.x_m) && std::isfinite(pose.y_m)) line.emplace_back(At(pose.x_m, pose.y_m));
    }
    cv::polylines(image_, line, false, colour, 1, cv::LINE_AA);
    if (!line.empty()) cv::circle(image_, line.front(), 6, colour, cv::FILLED, cv::LINE_AA);
  }

  void Draw(const MapLandmark& landmark) {
    if (!std::isfinite(landmark.at.x_m) || !std::isfinite(landmark.at.y_m)) return;
    const cv::Point at = At(landmark.at.x_m, landmark.at.y_m);
    cv::drawMarker(image_, at, kRed, cv::MARKER_CROSS, 12, 2, cv::LINE_AA);
    // Axes and angle of the covariance's ellipse; an image's y points down.
    const double mean = (landmark.var_xx_m2 + landmark.var_yy_m2) / 2,
                 half = (landmark.var_xx_m2 - landmark.var_yy_m2) / 2;
    const double root = std::hypot(half, landmark.var_xy_m2);
    if (!(mean > 0) || !std::isfinite(root)) return;
    const double angle_deg = -0.5 * std::atan2(landmark.var_xy_m2, half) * 180 / CV_PI;
    const auto axis = [&](double variance) { return 2 * std::sqrt(std::max(variance, 0.0)) * pixels_per_m_; };
    const cv::Size axes(static_cast<int>(std::min(axis(mean + root), 1e4)),
                        static_cast<int>(std::min(axis(mean - root), 1e4)));
    cv::ellipse(image_, at, axes, angle_deg, 0, 360, kRed, 1, cv::LINE_AA);
  }

  // A bar of 1, 2 or 5 times a power of ten metres, about a fifth of the width.
  void DrawScale() {
    const double wish = image_.cols / 5.0 / pixels_per_m_, power = std::pow(10, std::floor(std::log10(wish)));
    const double metres = power * (wish / power >= 5 ? 5 : wish / power >= 2 ? 2 : 1);
    const cv::Point left(kMarginPx, image_.rows - 12),
        right(kMarginPx + static_cast<int>(metres * pixels_per_m_), left.y);
    cv::line(image_, left, right, kBlack, 3);
    cv::putText(image_, NumberText(metres) + " m", {right.x + 8, right.y + 5}, cv::FONT_HERSHEY_SIMPLEX, 0.6,
                kBlack, 1, cv::LINE_AA);
  }

  std::string Png() const {
    const std::size_t size = image_.total() * image_.elemSize();
    return EncodePng(static_cast<std::uint32_t>(image_.cols), static_cast<std::uint32_t>(image_.rows),
                     {image_.data, size});
  }

 private:
  Box box_;
  double pixels_per_m_ = 1;
  cv::Mat image_;  // RGB
};

}  // namespace

Written ExportPng(const Blob& result, const std::string& folder) {
  const std::optional<Grid> grid = ReadGrid(result);
  const std::vector<MapLandmark> landmarks = ReadMapLandmarks(result);
  std::vector<Path> paths;
  if (result.Has("robots") && (!grid || result.Has("robot/0/poses/time_s"))) paths = ReadPaths(result);
  Box box;
  if (grid) {
    box.Add(grid->origin_x_m, grid->origin_y_m);
    box.Add(grid->origin_x_m + static_cast<double>(grid->columns) * grid->cell_m,
            grid->origin_y_m + static_cast<double>(grid->rows) * grid->cell_m);
  }
  for (const Path& path : paths) {
    for (const PoseM& pose : path.poses) box.Add(pose.x_m, pose.y_m);
  }
  for (const MapLandmark& landmark : landmarks) box.Add(landmark.at.x_m, landmark.at.y_m);
  if (!(box.low_x <= box.high_x)) throw InputError("there is neither a map nor a path in it to draw");
  Picture picture(box);
  if (grid) picture.Draw(*grid);
  for (std::size_t n = 0; n < paths.size(); ++n) picture.Draw(paths[n], kColours[n % std::size(kColours)]);
  for (const MapLandmark& landmark : landmarks) picture.Draw(landmark);
  picture.DrawScale();
  FolderWriter writer(folder);
  writer.Write("map.png", picture.Png());
  return writer.Finish();
}

}  // namespace cairn::datasets
