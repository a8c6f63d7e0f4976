// What a message is made of, by the text that a bag carries: the .msg file of its type, and behind it, after
// lines of '=' and "MSG: PACKAGE/TYPE", those of the types in it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace cairn::datasets::bag {

enum class Base : std::uint8_t {
  kBool,
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64,
  kTime,  // seconds and nanoseconds of four bytes each: a time or a duration, of ROS 1 or 2
  kString,
  kWideString,
  kStruct,
};
// Of one in a message; of a time of each of its halves; of texts and structs 0.
std::size_t SizeOf(Base base);

enum class Amount : std::uint8_t { kOne, kFixed, kSequence };

struct Field {
  std::string name;
  Base base = Base::kBool;
  std::size_t type = 0;  // of a struct: index into Definition::types
  Amount amount = Amount::kOne;
  std::uint32_t count = 1;  // of kFixed
};

struct Type {
  std::string name;  // "geometry_msgs/Pose"
  std::vector<Field> fields;
};

struct Definition {
  std::vector<Type> types;  // the message's own first
};

constexpr std::size_t kMostDefinitionBytes = 1 << 20;

// Of a message of `type`. Throws Damage (bytes.h): a line that is none of a definition's, a type that the
// text does not define, one that holds itself, more than 1 MiB of text, 1,000 types or 10,000 fields.
Definition ParseDefinition(const std::string& type, std::string_view text);

// Of what MessageReader finds: numbers and texts, also those in sequences; a hundred at the most.
std::vector<std::string> FieldPaths(const Definition& definition);

// Of types that Cairn reads, as ROS 2 defines them, for bags that carry none (rosbag2 before Iron); empty
// where it is none of them.
std::string_view KnownDefinition(std::string_view type);

}  // namespace cairn::datasets::bag
