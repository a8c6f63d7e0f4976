// Picture::Png: the shapes in the table's looks (style.h) by OpenCV, twice as fine inside as the file that
// comes of it.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "datasets/report/drawing/ascii.h"
#include "datasets/report/drawing/picture.h"
#include "datasets/report/drawing/style.h"

namespace cairn::datasets::report {
namespace {

constexpr int kFine = 2;              // pixels inside for a pixel of the file, along each axis
constexpr int kShift = 4;             // fraction bits of OpenCV's coordinates
constexpr double kFarPixels = 30000;  // what lies beyond would overflow them
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontHeight = 21, kCapitals = 0.65;  // of a capital letter: at scale 1; of a font's size

cv::Scalar Colour(Rgb rgb) {
  return {static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2])};
}

class Painter {
 public:
  // Pixels inside for one of the picture's.
  Painter(double width, double height, double scale)
      : scale_(kFine * scale),
        image_(kFine * static_cast<int>(std::lround(height * scale)),
               kFine * static_cast<int>(std::lround(width * scale)), CV_8UC3, Colour(kPaper)),
        seen_(0, 0, image_.cols, image_.rows) {}

  void Paint(const Element& shape) {
    using enum Element::Kind;
    if (shape.kind == kBeginLayer || shape.kind == kEndLayer) hidden_ = shape.classes == "off";
    if (shape.kind == kBeginLayer || shape.kind == kEndLayer || shape.kind == kRounds || hidden_) return;
    const Look look = LookOf(shape.classes);
    if (shape.kind == kBeginClip) {
      seen_ = Pixels(shape) & cv::Rect(0, 0, image_.cols, image_.rows);
    } else if (shape.kind == kEndClip) {
      seen_ = cv::Rect(0, 0, image_.cols, image_.rows);
    } else if (shape.kind == kImage) {
      PaintImage(shape);
    } else if (shape.kind == kText) {
      PaintText(shape, look);
    } else if (shape.kind == kDots) {
      for (const Point& at : shape.points)
        Fill(Round(at, *look.width / 2, *look.width / 2, 0), ColourOf(look.stroke, shape.classes), 1);
    } else {
      const bool closed = shape.kind != kLine && shape.kind != kPolyline;
      const std::vector<Point> outline = OutlineOf(shape);
      if (closed)
        Fill(outline, shape.fill ? shape.fill : ColourOf(look.fill, shape.classes),
             look.fill_opacity.value_or(1));
      if (const auto stroke = ColourOf(look.stroke, shape.classes)) Stroke(outline, closed, *stroke, look);
    }
  }

  std::string Png() const {
    cv::Mat file;
    cv::resize(image_, file, {image_.cols / kFine, image_.rows / kFine}, 0, 0, cv::INTER_AREA);
    return EncodePng(static_cast<std::uint32_t>(file.cols), static_cast<std::uint32_t>(file.rows),
                     {file.data, file.total() * file.elemSize()});
  }

 private:
  static std::vector<Point> Round(Point at, double major, double minor, double degrees) {
    const int corners = 48;
    const double c = std::cos(degrees * std::numbers::pi / 180),
                 s = std::sin(degrees * std::numbers::pi / 180);
    std::vector<Point> outline;
    for (int k = 0; k < corners; ++k) {
      const double angle = 2 * std::numbers::pi * k / corners;
      const double x = major * std::cos(angle), y = minor * std::sin(angle);
      outline.push_back({at.x_m + c * x - s * y, at.y_m + s * x + c * y});
    }
    return outline;
  }

  static std::vector<Point> OutlineOf(const Element& shape) {
    const Point& at = shape.points.front();
    if (shape.kind == Element::Kind::kEllipse) return Round(at, shape.width, shape.height, shape.degrees);
    if (shape.kind != Element::Kind::kRect) return shape.points;
    const double right = at.x_m + shape.width, bottom = at.y_m + shape.height;
    return {at, {right, at.y_m}, {right, bottom}, {at.x_m, bottom}};
  }

  int Whole(double value) const {
    return static_cast<int>(std::lround(std::clamp(value * scale_, -kFarPixels, kFarPixels)));
  }
  cv::Rect Pixels(const Element& shape) const {
    const Point& at = shape.points.front();
    return {cv::Point(Whole(at.x_m), Whole(at.y_m)),
            cv::Point(Whole(at.x_m + shape.width), Whole(at.y_m + shape.height))};
  }
  // In fractions of a pixel, from a corner.
  std::vector<cv::Point> Fixed(const std::vector<Point>& points, cv::Point from) const {
    const auto fixed = [this](double value, int low) {
      return static_cast<int>(
          std::lround((std::clamp(value * scale_, -kFarPixels, kFarPixels) - low) * (1 << kShift)));
    };
    std::vector<cv::Point> all;
    for (const Point& p : points) all.emplace_back(fixed(p.x_m, from.x), fixed(p.y_m, from.y));
    return all;
  }

  void Fill(const std::vector<Point>& outline, std::optional<Rgb> colour, double opacity) {
    if (!colour) return;
    std::vector<cv::Point> corners = Fixed(outline, {0, 0});
    cv::Rect box = cv::boundingRect(corners);
    box = cv::Rect(cv::Point((box.x >> kShift) - 1, (box.y >> kShift) - 1),
                   cv::Point((box.br().x >> kShift) + 2, (box.br().y >> kShift) + 2)) &
          seen_;
    if (box.empty()) return;
    cv::Mat below = image_(box);
    cv::Mat filled = opacity < 1 ? below.clone() : below;
    cv::fillPoly(filled, std::vector{Fixed(outline, box.tl())}, Colour(*colour), cv::LINE_AA, kShift);
    if (opacity < 1) cv::addWeighted(filled, opacity, below, 1 - opacity, 0, below);
  }

  // A stroke that is to be seen through is as pale as it is on paper.
  void Stroke(const std::vector<Point>& outline, bool closed, Rgb colour, const Look& look) {
    if (seen_.empty()) return;
    cv::Mat below = image_(seen_);
    const int width = std::max(1, static_cast<int>(std::lround(*look.width * scale_ - 0.6)));
    const cv::Scalar pale = Colour(Mix(kPaper, colour, look.stroke_opacity.value_or(1)));
    for (const std::vector<Point>& piece :
         look.dashes.empty() ? std::vector<std::vector<Point>>{outline} : Dashes(outline, look))
      cv::polylines(below, std::vector{Corners(Fixed(piece, seen_.tl()))}, closed, pale, width, cv::LINE_AA,
                    kShift);
  }

  // Without those that lie within a pixel inside of the corner before; the ends stay.
  static std::vector<cv::Point> Corners(const std::vector<cv::Point>& line) {
    std::vector<cv::Point> corners;
    for (const cv::Point& at : line) {
      if (&at == &line.front() || &at == &line.back() || cv::norm(at - corners.back()) >= 1 << kShift)
        corners.push_back(at);
    }
    return corners;
  }

  // Dashes go on along the whole line.
  static std::vector<std::vector<Point>> Dashes(const std::vector<Point>& line, const Look& look) {
    const double drawn = look.dashes[0] - '0', period = drawn + look.dashes[2] - '0';
    std::vector<std::vector<Point>> dashes;
    double phase = 0;
    for (std::size_t k = 1; k < line.size(); ++k) {
      const Point from = line[k - 1], to = line[k];
      const double length = DistanceM(from, to);
      const auto at = [&](double way) {
        const double share = way / length;
        return Point{from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m)};
      };
      for (double way = 0; way < length;) {
        const bool is_drawn = phase < drawn;
        const double end = std::min(length, way + (is_drawn ? drawn : period) - phase);
        if (is_drawn) dashes.push_back({at(way), at(end)});
        phase += end - way;
        if (phase >= period - 1e-9) phase = 0;
        if (phase >= drawn - 1e-9 && phase < drawn) phase = drawn;
        way = end;
      }
    }
    return dashes;
  }

  void PaintText(const Element& shape, const Look& look) {
    const double pixels = *look.font * kCapitals * scale_, font = pixels / kFontHeight;
    const int thin = std::max(1, static_cast<int>(std::lround(pixels / (look.bold ? 6.5 : 9))));
    const std::string text = Ascii(shape.text);
    int below = 0;
    const cv::Size size = cv::getTextSize(text, kFont, font, thin, &below);
    const double shift = look.anchor == "middle" ? size.width / 2.0 : look.anchor == "end" ? size.width : 0;
    const Point at{shape.points.front().x_m * scale_, shape.points.front().y_m * scale_};
    const Rgb ink = ColourOf(look.fill, shape.classes).value_or(kInk);
    if (shape.degrees != 0) {  // upwards
      cv::Mat letters(size.height + below + 2 * thin, size.width + 2 * thin, CV_8U, cv::Scalar(0));
      cv::putText(letters, text, {thin, size.height + thin}, kFont, font, 255, thin, cv::LINE_AA);
      cv::rotate(letters, letters, cv::ROTATE_90_COUNTERCLOCKWISE);
      const cv::Point corner(static_cast<int>(at.x_m) - size.height - thin,
                             static_cast<int>(at.y_m + shift) - size.width - thin);
      const cv::Rect whole(corner, letters.size()), box = whole & seen_;
      if (!box.empty()) image_(box).setTo(Colour(ink), letters(box - corner) > 127);
      return;
    }
    const cv::Point origin(static_cast<int>(std::lround(at.x_m - shift)) - seen_.x,
                           static_cast<int>(std::lround(at.y_m)) - seen_.y);
    if (seen_.empty()) return;
    cv::Mat view = image_(seen_);
    if (!look.stroke.empty())
      cv::putText(view, text, origin, kFont, font, Colour(kPaper),
                  thin + static_cast<int>(std::lround(*look.width * scale_)), cv::LINE_AA);
    cv::putText(view, text, origin, kFont, font, Colour(ink), thin, cv::LINE_AA);
  }

  void PaintImage(const Element& shape) {
    const int channels = static_cast<int>(shape.raster.colour);
    const cv::Rect whole = Pixels(shape), box = whole & seen_;
    if (box.empty()) return;
    const cv::Mat cells(static_cast<int>(shape.raster.rows), static_cast<int>(shape.raster.columns),
                        CV_8UC(channels), const_cast<std::uint8_t*>(shape.raster.pixels.data()));
    if (whole.width < cells.cols) {
      cv::Mat smaller;
      cv::resize(cells, smaller, whole.size(), 0, 0, cv::INTER_AREA);
      for (int y = box.y; y < box.br().y; ++y)
        for (int x = box.x; x < box.br().x; ++x)
          Cover({x, y}, smaller.ptr(y - whole.y, x - whole.x), channels);
      return;
    }
    // Enlarged, all of it may be far larger than what is seen: cell by cell.
    const auto cell = [](int pixel, int pixels, int cells) {
      return static_cast<int>(std::min<std::int64_t>(std::int64_t{pixel} * cells / pixels, cells - 1));
    };
    for (int y = box.y; y < box.br().y; ++y) {
      const int row = cell(y - whole.y, whole.height, cells.rows);
      for (int x = box.x; x < box.br().x; ++x)
        Cover({x, y}, cells.ptr(row, cell(x - whole.x, whole.width, cells.cols)), channels);
    }
  }

  // A pixel of the image by one of a raster, as far as that is opaque.
  void Cover(cv::Point at, const std::uint8_t* from, int channels) {
    std::uint8_t* to = image_.ptr(at.y, at.x);
    const int opaque = channels == 4 ? from[3] : 255;
    for (int c = 0; c < 3; ++c)
      to[c] = static_cast<std::uint8_t>((opaque * from[c] + (255 - opaque) * to[c] + 127) / 255);
  }

  double scale_;
  cv::Mat image_;        // RGB
  cv::Rect seen_;        // what is not cut
  bool hidden_ = false;  // within a layer that is not shown
};

}  // namespace

std::string Picture::Png(double scale) const {
  Painter painter(width_, height_, scale);
  for (const Element& shape : elements_) painter.Paint(shape);
  return painter.Png();
}

}  // namespace cairn::datasets::report
