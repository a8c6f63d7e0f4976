// What is taken from messages that say where something was seen: markers of known types, any message's fields
// by their names, frames of tf that are landmarks.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/bag/readers.h"
#include "datasets/import/log_rows.h"

namespace cairn::datasets::bag {

// A field of a message, by its path, and what its numbers are multiplied by.
struct ScaledField {
  std::string path;
  double factor = 1;
};
// "PATH", "PATH*0.001", "PATH*deg" (of degrees radians). Throws InputError that says `whose` it is.
ScaledField ParseScaledField(std::string_view text, const std::string& whose);

// "TOPIC", "TOPIC:range=PATH,bearing=PATH,id=PATH", "TOPIC:x=PATH,y=PATH", "TOPIC:contact",
// "tf:BEGINNING".
struct LandmarkSource {
  std::string topic;
  std::string beginning;                      // of the names of tf's frames that are landmarks
  std::map<std::string, ScaledField> fields;  // by what they are; empty: as the topic's type is known
  bool is_contact = false;                    // the robot is at the landmark itself
  bool has_fields() const { return is_contact || !fields.empty(); }
};
// Throws InputError: no such thing as `KEY=`, neither a range with a bearing nor two of x, y and z.
LandmarkSource ParseLandmarkSource(const std::string& text);

// Of kLandmarks, and `tags` where its messages carry no place (apriltag_msgs).
std::unique_ptr<TopicReader> ReadLandmarks(const std::string& type, std::vector<Sighting>* rows,
                                           std::vector<FrameSighting>* tags);
// Of messages of any type.
std::unique_ptr<TopicReader> ReadLandmarkFields(const LandmarkSource& source, std::vector<Sighting>* rows);

// Detections of tags, each where tf has the frame of its tag at the same time; one without is counted in the
// report. Throws InputError, which begins with `whose`, where none has one.
void PlaceTags(const std::string& whose, std::vector<FrameSighting> tags,
               const std::vector<FrameSighting>& frames, std::vector<Sighting>* rows, ImportReport* report);

}  // namespace cairn::datasets::bag
