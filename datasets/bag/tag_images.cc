#include "datasets/bag/tag_images.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <utility>

#include "schema/error.h"
#include "schema/text.h"

namespace cairn::datasets::bag {
namespace {

std::optional<double> TagNumber(std::string_view text) {
  double number = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), number);
  if (end.ec != std::errc() || end.ptr != text.data() + text.size() || !std::isfinite(number))
    return std::nullopt;
  return number;
}

// Of an uncompressed image: bytes a pixel, and where its grey stands in them. Bayer's pixels are of one
// colour each, which a black and white tag does not mind.
struct PixelForm {
  std::string_view encoding;
  std::size_t bytes, first, colours;
};
constexpr PixelForm kPixelForms[] = {
    {"mono8", 1, 0, 1},       {"8UC1", 1, 0, 1},        {"mono16", 2, 1, 1},      {"rgb8", 3, 0, 3},
    {"bgr8", 3, 0, 3},        {"8UC3", 3, 0, 3},        {"rgba8", 4, 0, 3},       {"bgra8", 4, 0, 3},
    {"bayer_rggb8", 1, 0, 1}, {"bayer_bggr8", 1, 0, 1}, {"bayer_gbrg8", 1, 0, 1}, {"bayer_grbg8", 1, 0, 1},
    {"yuv422", 2, 1, 1},      {"yuv422_yuy2", 2, 0, 1}};

// As a file, PGM. Of numbers of two bytes the higher one counts.
std::string GreyFile(std::string_view encoding, bool is_big_endian, std::size_t rows, std::size_t columns,
                     std::size_t step, ByteSpan bytes) {
  const auto* const form = std::ranges::find(kPixelForms, encoding, &PixelForm::encoding);
  if (form == std::end(kPixelForms))
    throw LineError{"an image of an encoding that is not known", Printable(std::string(encoding), 40)};
  if (rows == 0 || columns == 0 || columns > step / form->bytes || rows > bytes.size() / step)
    throw LineError{"an image with fewer bytes than pixels", std::to_string(columns) + " by " +
                                                                 std::to_string(rows) + " of " +
                                                                 std::to_string(bytes.size()) + " bytes"};
  const std::size_t first = is_big_endian && encoding == "mono16" ? 0 : form->first;
  std::string file = "P5 " + std::to_string(columns) + " " + std::to_string(rows) + " 255\n";
  file.reserve(file.size() + rows * columns);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      const std::size_t at = row * step + column * form->bytes + first;
      unsigned sum = 0;
      for (std::size_t c = 0; c < form->colours; ++c) sum += std::to_integer<unsigned>(bytes[at + c]);
      file += static_cast<char>(sum / form->colours);
    }
  }
  return file;
}

}  // namespace

class ImageReader : public TopicReader {
 public:
  ImageReader(const std::string& type, TagCamera* camera)
      : is_compressed_(type == "sensor_msgs/CompressedImage"), camera_(*camera) {}
  std::vector<std::string> paths() const override {
    if (is_compressed_) return {"header.stamp", "header.frame_id", "data"};
    return {"header.stamp", "header.frame_id", "data", "encoding", "height", "width", "step", "is_bigendian"};
  }
  std::size_t needed() const override { return is_compressed_ ? 3 : 7; }
  void Take(const std::vector<Found>& found, const Message& message, TopicClock* clock) override {
    const auto time_s = clock->At(found[0].numbers, message.receive_ns);
    if (!time_s) return;
    if (camera_.frame_.empty()) camera_.frame_ = FrameName(FirstText(found[1]));
    const ByteSpan bytes = found[2].bytes;
    camera_.Add(*time_s, message.number,
                is_compressed_
                    ? std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size())
                    : GreyFile(FirstText(found[3]), FirstNumber(found[7]) != 0, FirstCount(found[4]),
                               FirstCount(found[5]), FirstCount(found[6]), bytes));
  }

 private:
  bool is_compressed_;
  TagCamera& camera_;
};

// The first says it for all. Names are in capitals in ROS 1.
class InfoReader : public TopicReader {
 public:
  explicit InfoReader(TagCamera* camera) : camera_(*camera) {}
  std::vector<std::string> paths() const override {
    return {"K",           "k",         "D",     "d",      "P",         "p",          "distortion_model",
            "binning_x",   "binning_y", "width", "height", "roi.width", "roi.height", "roi.x_offset",
            "roi.y_offset"};
  }
  std::size_t needed() const override { return 0; }
  void Take(const std::vector<Found>& found, const Message&, TopicClock*) override {
    if (camera_.camera_) return;
    const auto of = [&](std::size_t i) {
      return found[i].numbers.empty() ? found[i + 1].numbers : found[i].numbers;
    };
    // Images that were rectified have the camera that they were rectified for.
    const bool rectified = camera_.source_.topic.find("image_rect") != std::string::npos;
    const std::vector<double> matrix = rectified ? of(4) : of(0),
                              distortion = rectified ? std::vector<double>() : of(2);
    const std::size_t row = rectified ? 4 : 3;
    if (matrix.size() != 3 * row || !(matrix[0] > 0 && matrix[row + 1] > 0))
      throw LineError{"no camera", "it is not calibrated; --camera says what it is like"};
    Camera camera{matrix[0], matrix[row + 1], matrix[2], matrix[row + 2], {}};
    const std::string model = FirstText(found[6]);
    const bool is_known = model.empty() || model == "plumb_bob" || model == "rational_polynomial";
    if ((!is_known && !rectified) || distortion.size() > camera.distortion.size())
      throw LineError{"a camera whose distortion is not known", Printable(model, 40)};
    std::ranges::copy(distortion, camera.distortion.begin());
    const auto finite = [](double value) { return std::isfinite(value); };
    if (!std::ranges::all_of(matrix, finite) || !std::ranges::all_of(distortion, finite))
      throw LineError{"no camera", "its numbers are not finite; --camera says what it is like"};
    SetPart(found, &camera);
    camera_.camera_ = camera;
  }

 private:
  // The message's camera is that of the whole sensor; the image shows a part of it, or fewer pixels.
  void SetPart(const std::vector<Found>& found, Camera* camera) {
    const auto at_least_1 = [&](std::size_t i) { return std::max<std::size_t>(1, FirstCount(found[i])); };
    const std::size_t every_column = at_least_1(7), every_row = at_least_1(8);
    const std::size_t columns = FirstCount(found[11]) > 0 ? FirstCount(found[11]) : FirstCount(found[9]),
                      rows = FirstCount(found[12]) > 0 ? FirstCount(found[12]) : FirstCount(found[10]);
    const auto of_column = static_cast<double>(every_column), of_row = static_cast<double>(every_row);
    camera->fx /= of_column;
    camera->fy /= of_row;
    camera->cx = (camera->cx - FirstNumber(found[13])) / of_column;
    camera->cy = (camera->cy - FirstNumber(found[14])) / of_row;
    if (columns > 0 && rows > 0) camera_.camera_size_ = {columns / every_column, rows / every_row};
  }

  TagCamera& camera_;
};

TagSource ParseTagSource(const std::string& text) {
  const std::size_t equals = std::min(text.rfind('='), text.size());
  const auto size_m = TagNumber(std::string_view(text).substr(std::min(equals + 1, text.size())));
  if (equals == 0 || !size_m || !(*size_m > 0 && *size_m <= 10))
    throw InputError("--tags " + Printable(text, 200) +
                     ": what is meant is TOPIC=METRES, the edge of a tag's black square, such as "
                     "/camera/image_raw=0.16");
  return {text.substr(0, equals), *size_m};
}

Camera ParseCamera(const std::string& text) {
  std::vector<double> numbers;
  for (const std::string& one : AtCommas(text)) {
    const auto number = TagNumber(one);
    if (number) numbers.push_back(*number);
  }
  constexpr std::size_t kPinhole = 4, kWhole = 12;
  if (numbers.size() != AtCommas(text).size() || numbers.size() < kPinhole || numbers.size() > kWhole ||
      !(numbers[0] > 0 && numbers[1] > 0))
    throw InputError("--camera " + Printable(text, 200) +
                     ": what is meant is FX,FY,CX,CY in pixels and, where it distorts, ,K1,K2,P1,P2,K3");
  Camera camera{numbers[0], numbers[1], numbers[2], numbers[3], {}};
  std::copy(numbers.begin() + kPinhole, numbers.end(), camera.distortion.begin());
  return camera;
}

TagCamera::TagCamera(TagSource source, const BagImportOptions& options)
    : source_(std::move(source)), family_(options.tag_family), find_tags_(options.find_tags) {
  if (!options.camera.empty()) camera_ = ParseCamera(options.camera);
}

std::unique_ptr<TopicReader> TagCamera::ReadImages(const std::string& type) {
  return std::make_unique<ImageReader>(type, this);
}
std::unique_ptr<TopicReader> TagCamera::ReadInfo() { return std::make_unique<InfoReader>(this); }

void TagCamera::Add(double time_s, std::size_t number, const std::string& image) {
  constexpr std::size_t kMostImages = 64, kMostBytes = std::size_t{1} << 25;
  waiting_ += std::to_string(image.size()) + "\n" + image;
  when_.emplace_back(time_s, number);
  ++images_;
  if (when_.size() >= kMostImages || waiting_.size() >= kMostBytes) Look();
}

void TagCamera::Look() {
  if (when_.empty()) return;
  std::istringstream lines(find_tags_(family_, waiting_));
  std::string line;
  for (const auto& [time_s, number] : when_) {
    if (!std::getline(lines, line)) throw InputError("cairn-tags is of another version, or broke off");
    if (line.starts_with("!!")) throw InputError("--tag-family: " + line.substr(2));
    if (line.starts_with('!'))
      ++undecoded_;
    else
      TakeLine(line, time_s, number);
  }
  when_.clear();
  waiting_.clear();
}

void TagCamera::TakeLine(const std::string& line, double time_s, std::size_t number) {
  std::istringstream words(line);
  Size size;
  std::size_t count = 0;
  words >> size.columns >> size.rows >> count;
  if (!size_) size_ = size;
  if (size != *size_) {
    ++of_other_size_;
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    Corners& tag = corners_.emplace_back(Corners{time_s, number, "", {}});
    words >> tag.id;
    for (Eigen::Vector2d& corner : tag.corners) words >> corner.x() >> corner.y();
  }
  if (!words) throw InputError("cairn-tags is of another version: it does not say a tag's corners");
}

void TagCamera::Finish(ImportReport* report) {
  Look();
  if (images_ == 0) return;
  if (!camera_)
    throw InputError(source_.topic +
                     ": no camera_info beside it says what its camera is like: --camera "
                     "FX,FY,CX,CY[,K1,K2,P1,P2,K3]");
  const auto text = [](const Size& size) {
    return std::to_string(size.columns) + " by " + std::to_string(size.rows) + " pixels";
  };
  if (camera_size_ && size_ && *size_ != *camera_size_)
    throw InputError(source_.topic + ": its images are of " + text(*size_) + ", its camera_info is of " +
                     text(*camera_size_) +
                     ": --camera FX,FY,CX,CY[,K1,K2,P1,P2,K3] says what the images' is like");
  double squares_px2 = 0;
  for (const Corners& one : corners_) {
    const auto located = LocateTag(one.corners, *camera_, source_.size_m);
    constexpr double kMostPixels = 2;  // of a corner: else the code was read, and the corners are another's
    if (!located || located->squares_px2 > 4 * kMostPixels * kMostPixels) {
      ++report->dropped["tag whose corners fit no square of its size"];
      continue;
    }
    squares_px2 += located->squares_px2;
    const Eigen::Vector3d& at = located->middle;
    seen_.push_back(
        {{one.time_s, one.number, family_ + ":" + one.id, {at.x(), at.y(), at.z()}, frame_, false},
         located->covariance});
  }
  // How far off corners are, by all of them: a pose leaves two of their eight numbers free.
  constexpr double kFree = 2, kUsual_px = 0.3, kLeast_px = 0.05;
  constexpr std::size_t kEnough = 20;
  const auto n = static_cast<double>(seen_.size());
  const double sigma_px =
      seen_.size() < kEnough ? kUsual_px : std::max(kLeast_px, std::sqrt(squares_px2 / (kFree * n)));
  for (Seen& one : seen_) one.covariance *= sigma_px * sigma_px;
  report->read["tags in " + std::to_string(images_) + " images of " + source_.topic] =
      static_cast<std::int64_t>(seen_.size());
  if (undecoded_ > 0) report->dropped["image of " + source_.topic + " that cannot be decoded"] = undecoded_;
  if (of_other_size_ > 0)
    report->dropped["image of " + source_.topic + " of another size than the first"] = of_other_size_;
}

}  // namespace cairn::datasets::bag
