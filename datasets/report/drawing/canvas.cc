#include "datasets/report/drawing/canvas.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "datasets/common/png.h"

namespace cairn::datasets::report {
namespace {

constexpr int kFine = 2;              // pixels inside for a pixel of the file, along each axis
constexpr int kShift = 4;             // fraction bits of OpenCV's coordinates
constexpr double kFarPixels = 30000;  // what lies beyond would overflow them
constexpr double kFillShare = 1.0 / 6;
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontHeight = 21;  // of a capital letter at scale 1

cv::Scalar Colour(Rgb rgb) {
  return {static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2])};
}

int Fixed(double value) {
  return static_cast<int>(std::lround(std::clamp(value, -kFarPixels, kFarPixels) * kFine * (1 << kShift)));
}

cv::Point Fixed(Point at) { return {Fixed(at.x_m), Fixed(at.y_m)}; }

int Thickness(double width) { return std::max(1, static_cast<int>(std::lround(width * kFine))); }

double FontScale(double height) { return height * kFine / kFontHeight; }

int FontThickness(double height) { return std::max(1, static_cast<int>(std::lround(height * kFine / 9))); }

}  // namespace

Canvas::Canvas(int width, int height, Rgb paper)
    : image_(height * kFine, width * kFine, CV_8UC3, Colour(paper)), paper_(paper) {}

void Canvas::Line(Point from, Point to, Rgb colour, double width) {
  cv::line(image_, Fixed(from), Fixed(to), Colour(colour), Thickness(width), cv::LINE_AA, kShift);
}

void Canvas::Polyline(const std::vector<Point>& points, Rgb colour, double width) {
  std::vector<cv::Point> fixed;
  fixed.reserve(points.size());
  for (const Point& point : points) fixed.push_back(Fixed(point));
  cv::polylines(image_, fixed, false, Colour(colour), Thickness(width), cv::LINE_AA, kShift);
}

void Canvas::Fill(Point low, Point high, Rgb colour) {
  const auto pixel = [](double value) { return static_cast<int>(std::lround(value * kFine)); };
  const cv::Rect rect(cv::Point(pixel(low.x_m), pixel(low.y_m)), cv::Point(pixel(high.x_m), pixel(high.y_m)));
  const cv::Rect seen = rect & cv::Rect(0, 0, image_.cols, image_.rows);
  if (!seen.empty()) image_(seen).setTo(Colour(colour));
}

void Canvas::Frame(Point low, Point high, Rgb colour, double width) {
  cv::rectangle(image_, Fixed(low), Fixed(high), Colour(colour), Thickness(width), cv::LINE_AA, kShift);
}

void Canvas::Dot(Point centre, double radius, Rgb colour) {
  cv::circle(image_, Fixed(centre), Fixed(radius), Colour(colour), cv::FILLED, cv::LINE_AA, kShift);
}

void Canvas::Ring(Point centre, double radius, Rgb colour, double width) {
  cv::circle(image_, Fixed(centre), Fixed(radius), Colour(colour), Thickness(width), cv::LINE_AA, kShift);
}

void Canvas::Ellipse(Point centre, double major, double minor, double degrees, Rgb colour, double width) {
  const cv::Size axes(Fixed(major), Fixed(minor));
  // Only a square round it is copied to be blended.
  const int reach = static_cast<int>(std::ceil(std::min(std::max(major, minor) + 2, kFarPixels) * kFine));
  const cv::Point middle(Fixed(centre).x >> kShift, Fixed(centre).y >> kShift);
  const cv::Rect square(middle.x - reach, middle.y - reach, 2 * reach, 2 * reach);
  const cv::Rect seen = square & cv::Rect(0, 0, image_.cols, image_.rows);
  if (seen.empty()) return;
  cv::Mat below = image_(seen);
  cv::Mat filled = below.clone();
  const cv::Point at = Fixed(centre) - cv::Point(seen.x << kShift, seen.y << kShift);
  cv::ellipse(filled, at, axes, degrees, 0, 360, Colour(colour), cv::FILLED, cv::LINE_AA, kShift);
  cv::addWeighted(filled, kFillShare, below, 1 - kFillShare, 0, below);
  cv::ellipse(below, at, axes, degrees, 0, 360, Colour(colour), Thickness(width), cv::LINE_AA, kShift);
}

void Canvas::Text(Point at, const std::string& text, Rgb colour, double height, Align align, double halo) {
  const double width = TextWidth(text, height);
  const double shift = align == Align::kLeft ? 0 : align == Align::kMiddle ? width / 2 : width;
  const cv::Point origin(static_cast<int>(std::lround((at.x_m - shift) * kFine)),
                         static_cast<int>(std::lround(at.y_m * kFine)));
  const int thickness = FontThickness(height);
  if (halo > 0) {
    cv::putText(image_, text, origin, kFont, FontScale(height), Colour(paper_),
                thickness + 2 * Thickness(halo), cv::LINE_AA);
  }
  cv::putText(image_, text, origin, kFont, FontScale(height), Colour(colour), thickness, cv::LINE_AA);
}

double Canvas::TextWidth(const std::string& text, double height) {
  int baseline = 0;
  return cv::getTextSize(text, kFont, FontScale(height), FontThickness(height), &baseline).width /
         static_cast<double>(kFine);
}

std::string Canvas::Png() const {
  cv::Mat file;
  cv::resize(image_, file, {image_.cols / kFine, image_.rows / kFine}, 0, 0, cv::INTER_AREA);
  return EncodePng(static_cast<std::uint32_t>(file.cols), static_cast<std::uint32_t>(file.rows),
                   {file.data, file.total() * file.elemSize()});
}

}  // namespace cairn::datasets::report
