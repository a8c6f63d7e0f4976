#include "datasets/verdicts/moved_landmarks.h"

#include <fmt/format.h>

#include "schema/kinds/landmark_map.h"

namespace cairn::datasets {

std::string MovedText(const Blob& landmark_map) {
  const auto map = Read<kinds::LandmarkMap>(landmark_map);
  std::string text;
  for (std::size_t m = 0; m < map.moved.landmark.OrNone().size(); ++m) {
    const bool later = map.moved.later_left_out[m] != 0;
    text += fmt::format(
        "{}landmark '{}' was moved between {:.1f} and {:.1f} s: the {} observations {} are left out; give it "
        "another name from {:.1f} s on, and it is mapped in both places",
        text.empty() ? "" : "; ", map.landmarks[static_cast<std::size_t>(map.moved.landmark[m])],
        map.moved.until_s[m], map.moved.from_s[m], map.moved.left_out[m],
        later ? "after that" : "before that", map.moved.from_s[m]);
  }
  return text;
}

}  // namespace cairn::datasets
