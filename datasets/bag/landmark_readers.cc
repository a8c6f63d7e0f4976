#include "datasets/bag/landmark_readers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "datasets/import/name_index.h"
#include "schema/error.h"
#include "schema/text.h"

namespace cairn::datasets::bag {
namespace {

double NumberAt(const Found& found, std::size_t i) {
  if (i >= found.numbers.size()) throw LineError{"markers without a place each", ""};
  return found.numbers[i];
}

// A definition may have two fields of one name: then what is found is of several kinds.
std::string NameAt(const Found& id, std::size_t i) {
  if (i >= (id.texts.empty() ? id.numbers.size() : id.texts.size()))
    throw LineError{"markers without a number or a name each", ""};
  if (!id.texts.empty()) return Printable(std::string(id.texts[i]), 100);
  if (!(std::abs(id.numbers[i]) < 1e15))
    throw LineError{"no number of a marker", std::to_string(id.numbers[i])};
  return std::to_string(static_cast<std::int64_t>(id.numbers[i]));
}

void CheckPlace(const Sighting& seen) {
  if (!(std::hypot(seen.point.x, seen.point.y, seen.point.z) < 1e4))
    throw LineError{"no place of a marker", seen.name.empty() ? "" : "marker " + seen.name};
}

// Where a type of detections has what it says of each.
struct MarkerType {
  std::string_view type, each, id, position;
};
constexpr MarkerType kMarkerTypes[] = {
    {"apriltag_ros/AprilTagDetectionArray", "detections", "detections.id",
     "detections.pose.pose.pose.position"},
    {"ar_track_alvar_msgs/AlvarMarkers", "markers", "markers.id", "markers.pose.pose.position"},
    {"aruco_msgs/MarkerArray", "markers", "markers.id", "markers.pose.pose.position"},
    {"fiducial_msgs/FiducialTransformArray", "transforms", "transforms.fiducial_id",
     "transforms.transform.translation"},
    {"vision_msgs/Detection3DArray", "detections", "detections.id", "detections.bbox.center.position"},
    {"isaac_ros_apriltag_interfaces/AprilTagDetectionArray", "detections", "detections.id",
     "detections.pose.pose.pose.position"},
    {"ros2_aruco_interfaces/ArucoMarkers", "poses", "marker_ids", "poses.position"},
};

class MarkerReader : public TopicReader {
 public:
  MarkerReader(const std::string& type, std::vector<Sighting>* rows)
      : type_(*std::ranges::find(kMarkerTypes, std::string_view(type), &MarkerType::type)), rows_(*rows) {}
  std::vector<std::string> paths() const override {
    const std::string position(type_.position);
    return {std::string(type_.each), std::string(type_.id), position + ".x", position + ".y", position + ".z",
            "header.stamp", "header.frame_id", std::string(type_.each) + ".header.frame_id",
            // ar_track_alvar leaves the array's own header empty.
            std::string(type_.each) + ".header.stamp"};
  }
  std::size_t needed() const override { return 6; }
  void Take(const std::vector<Found>& found, const Message& message, TopicClock* clock) override {
    const std::size_t count = FirstCount(found[0]);
    if (count == 0) return;
    const Found& id = found[1];
    if (id.numbers.size() + id.texts.size() != count)
      throw LineError{"markers of other than one number", "bundles of tags are not landmarks"};
    std::vector<double> stamp = found[5].numbers;
    if (FirstNumber(found[5]) == 0 && !found[8].numbers.empty()) stamp = {found[8].numbers.front()};
    const auto time_s = clock->At(stamp, message.receive_ns);
    if (!time_s) return;
    for (std::size_t i = 0; i < count; ++i) {
      Sighting seen{*time_s,
                    message.number,
                    {},
                    {NumberAt(found[2], i), NumberAt(found[3], i), NumberAt(found[4], i)},
                    {}};
      seen.name = NameAt(id, i);
      seen.frame = FrameName(FirstText(found[6]));
      if (seen.frame.empty() && i < found[7].texts.size()) seen.frame = FrameName(found[7].texts[i]);
      CheckPlace(seen);
      rows_.push_back(std::move(seen));
    }
  }

 private:
  const MarkerType& type_;
  std::vector<Sighting>& rows_;
};

// Keys of --landmarks that say where it was seen.
constexpr std::string_view kRange = "range", kBearing = "bearing";
constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "z"};

class LandmarkFieldsReader : public TopicReader {
 public:
  LandmarkFieldsReader(const LandmarkSource& source, std::vector<Sighting>* rows) : rows_(*rows) {
    is_polar_ = source.fields.contains(std::string(kRange));
    for (const auto& [key, field] : source.fields) {
      if (key == "time") time_ = paths_.size();
      if (key == "frame") frame_ = paths_.size();
      if (key == "id") id_ = paths_.size();
      if (key != "time" && key != "frame" && key != "id")
        places_.emplace_back(paths_.size(), PlaceOf(key), field.factor);
      paths_.push_back(field.path);
    }
    needed_ = paths_.size();
    for (const auto& [path, at] :
         {std::pair{"header.stamp", &time_}, std::pair{"header.frame_id", &frame_}}) {
      if (*at) continue;
      *at = paths_.size();
      paths_.emplace_back(path);
    }
  }
  std::vector<std::string> paths() const override { return paths_; }
  std::size_t needed() const override { return needed_; }
  bool fields_are_named() const override { return true; }

  void Take(const std::vector<Found>& found, const Message& message, TopicClock* clock) override {
    // What says how many landmarks there are; of a contact without a name it is one.
    const std::optional<std::size_t> counted =
        places_.empty() ? id_ : std::optional(std::get<0>(places_.front()));
    const std::size_t count = counted ? found[*counted].size() : 1;
    for (std::size_t i = 0; i < needed_; ++i)
      if (i != *time_ && i != *frame_ && found[i].size() != count)
        throw LineError{"other numbers of one field than of another",
                        std::to_string(found[i].size()) + " of '" + paths_[i] + "', " +
                            std::to_string(count) + " of '" + paths_[*counted] + "'"};
    if (count == 0) return;
    const auto time_s = clock->At(found[*time_].numbers, message.receive_ns);
    if (!time_s) return;
    const std::string frame = FrameName(FirstText(found[*frame_]));
    for (std::size_t i = 0; i < count; ++i) {
      Sighting seen{*time_s, message.number, NameIn(found, i), {}, frame};
      seen.is_contact = places_.empty();
      std::array<double, 3> numbers{};  // range and bearing, or x, y, z
      for (const auto& [path, place, factor] : places_) numbers[place] = factor * ElementOf(found[path], i);
      if (is_polar_ && !(numbers[0] >= 0))
        throw LineError{"no range of a landmark", std::to_string(numbers[0]) + " m"};
      seen.point = is_polar_
                       ? PointInSpace{numbers[0] * std::cos(numbers[1]), numbers[0] * std::sin(numbers[1]), 0}
                       : PointInSpace{numbers[0], numbers[1], numbers[2]};
      CheckPlace(seen);
      rows_.push_back(std::move(seen));
    }
  }

 private:
  static std::size_t PlaceOf(const std::string& key) {
    if (key == kRange) return 0;
    if (key == kBearing) return 1;
    return static_cast<std::size_t>(std::ranges::find(kAxes, key) - kAxes.begin());
  }
  static double ElementOf(const Found& found, std::size_t i) {
    if (i < found.bytes.size()) return std::to_integer<int>(found.bytes[i]);
    return NumberAt(found, i);
  }
  // Empty: it is not known which it is.
  std::string NameIn(const std::vector<Found>& found, std::size_t i) const {
    if (!id_) return {};
    const Found& id = found[*id_];
    std::string name =
        i < id.bytes.size() ? std::to_string(std::to_integer<int>(id.bytes[i])) : NameAt(id, i);
    return MeansUnknown(name) ? std::string() : name;
  }

  std::vector<Sighting>& rows_;
  bool is_polar_ = false;
  std::vector<std::string> paths_;
  std::size_t needed_ = 0;
  std::optional<std::size_t> id_, time_, frame_;                      // which path
  std::vector<std::tuple<std::size_t, std::size_t, double>> places_;  // path, place in what they make, factor
};

// apriltag_msgs of ROS 2 says where in the image a tag is; where in space, its frame in tf.
class TagReader : public TopicReader {
 public:
  explicit TagReader(std::vector<FrameSighting>* tags) : tags_(*tags) {}
  std::vector<std::string> paths() const override {
    return {"detections.family", "detections.id", "header.stamp", "header.frame_id"};
  }
  std::size_t needed() const override { return 4; }
  void Take(const std::vector<Found>& found, const Message& message, TopicClock* clock) override {
    if (found[0].texts.empty()) return;
    if (found[1].size() != found[0].texts.size())
      throw LineError{"other numbers of one field than of another",
                      std::to_string(found[0].texts.size()) + " of 'detections.family', " +
                          std::to_string(found[1].size()) + " of 'detections.id'"};
    const auto time_s = clock->At(found[2].numbers, message.receive_ns);
    if (!time_s) return;
    for (std::size_t i = 0; i < found[0].texts.size(); ++i) {
      const std::string name = std::string(found[0].texts[i]) + ":" + NameAt(found[1], i);
      tags_.push_back({FirstNumber(found[2]),
                       {*time_s, message.number, Printable(name, 100), {}, FrameName(FirstText(found[3]))}});
    }
  }

 private:
  std::vector<FrameSighting>& tags_;
};

constexpr std::string_view kTagsOfRos2 = "apriltag_msgs/AprilTagDetectionArray";

[[noreturn]] void BadSource(const std::string& text, const std::string& what) {
  throw InputError("--landmarks " + Printable(text, 200) + ": " + what +
                   "; it is TOPIC, TOPIC:range=FIELD,bearing=FIELD, TOPIC:x=FIELD,y=FIELD or TOPIC:contact, "
                   "each with ,id=FIELD");
}

}  // namespace

ScaledField ParseScaledField(std::string_view text, const std::string& whose) {
  const std::size_t star = text.find('*');
  ScaledField field{std::string(text.substr(0, star)), 1};
  if (star == std::string_view::npos) return field;
  const std::string_view factor = text.substr(star + 1);
  const char* reason = nullptr;
  if (factor == "deg")
    field.factor = std::numbers::pi / 180;
  else if (const auto number = ParseNumber(factor, &reason); number && *number != 0)
    field.factor = *number;
  else
    throw InputError(whose + ": '" + Printable(std::string(factor), 40) +
                     "' is nothing to multiply by; allowed: a number other than 0, or deg");
  return field;
}

LandmarkSource ParseLandmarkSource(const std::string& text) {
  const std::size_t colon = text.find(':');
  LandmarkSource source;
  source.topic = text.substr(0, colon);
  if (colon == std::string::npos) return source;
  std::string rest = text.substr(colon + 1);
  if (source.topic == "tf") {
    if (rest.empty()) BadSource(text, "of tf's frames those whose names begin so, as tf:tag36h11");
    source.beginning = rest;
    return source;
  }
  constexpr std::array<std::string_view, 8> kKeys = {"range", "bearing", "x",    "y",
                                                     "z",     "id",      "time", "frame"};
  for (std::size_t end = 0; end != std::string::npos; rest.erase(0, end + 1)) {
    end = rest.find(',');
    const std::string part = rest.substr(0, end);
    if (part == "contact" && !source.is_contact) {
      source.is_contact = true;
      if (end == std::string::npos) break;
      continue;
    }
    const std::size_t equals = part.find('=');
    const std::string key = part.substr(0, equals);
    if (std::ranges::find(kKeys, key) == kKeys.end() || equals == std::string::npos)
      BadSource(text,
                "'" + Printable(part, 80) + "' is no KEY=FIELD of range, bearing, x, y, z, id, time, frame");
    const ScaledField field =
        ParseScaledField(part.substr(equals + 1), "--landmarks " + Printable(text, 200));
    if (field.path.empty() || !source.fields.emplace(key, field).second)
      BadSource(text, "'" + key + "=' names no field, or a second one");
    if (end == std::string::npos) break;
  }
  const auto has = [&](std::string_view key) { return source.fields.contains(std::string(key)); };
  const auto axes = std::ranges::count_if(kAxes, has);
  if (source.is_contact && (has(kRange) || has(kBearing) || axes > 0))
    BadSource(text, "a contact is at the landmark itself: there is no place to it");
  if (source.is_contact) return source;
  if (has(kRange) != has(kBearing) || has(kRange) == (axes > 0) || axes == 1)
    BadSource(text, "a range and a bearing are needed, or two of x, y and z");
  std::set<std::string> paths;
  for (const auto& [key, field] : source.fields)
    if (!paths.insert(field.path).second) BadSource(text, "'" + field.path + "' is named twice");
  return source;
}

std::unique_ptr<TopicReader> ReadLandmarks(const std::string& type, std::vector<Sighting>* rows,
                                           std::vector<FrameSighting>* tags) {
  if (type == kTagsOfRos2) return std::make_unique<TagReader>(tags);
  return std::make_unique<MarkerReader>(type, rows);
}

std::unique_ptr<TopicReader> ReadLandmarkFields(const LandmarkSource& source, std::vector<Sighting>* rows) {
  return std::make_unique<LandmarkFieldsReader>(source, rows);
}

void PlaceTags(const std::string& whose, std::vector<FrameSighting> tags,
               const std::vector<FrameSighting>& frames, std::vector<Sighting>* rows, ImportReport* report) {
  if (tags.empty()) return;
  using Key = std::tuple<std::string, std::string, double>;  // the tag's frame, the camera's, when
  std::map<Key, PointInSpace> places;
  for (const FrameSighting& one : frames)
    places[{one.seen.name, one.seen.frame, one.stamp_s}] = one.seen.point;
  std::int64_t without = 0;
  for (FrameSighting& tag : tags) {
    const auto place = places.find({tag.seen.name, tag.seen.frame, tag.stamp_s});
    if (place == places.end()) {
      ++without;
      continue;
    }
    tag.seen.point = place->second;
    rows->push_back(std::move(tag.seen));
  }
  if (without == static_cast<std::int64_t>(tags.size()))
    throw InputError(
        whose + ": detections of apriltag_msgs do not say where a tag is; apriltag_ros says it in /tf, " +
        "as the place of '" + tags.front().seen.name +
        "', and there is no such transform of their times: record /tf, or name the frames by "
        "--landmarks tf:BEGINNING");
  if (without > 0) report->dropped["detections of tags without the place of their frame in tf"] += without;
}

}  // namespace cairn::datasets::bag
