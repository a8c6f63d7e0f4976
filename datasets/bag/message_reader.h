// Fields of messages, found by name in the type's definition: one reader for all types, of ROS 1 and of CDR.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/bag/bytes.h"
#include "datasets/bag/container.h"
#include "datasets/bag/definition.h"

namespace cairn::datasets::bag {

// What a message has at a path. Of a path through sequences: of all their elements, one after the other.
struct Found {
  std::vector<double> numbers;  // times in seconds; of a path that ends at a sequence of structs its length
  std::vector<std::string_view> texts;
  ByteSpan bytes;  // of arrays of single bytes, which are in no `numbers`
  std::size_t size() const { return numbers.size() + texts.size() + bytes.size(); }
};

class MessageReader {
 public:
  // Paths such as "pose.pose.position.x", "transforms.child_frame_id". Throws Damage: a definition whose
  // types in types are more than 20,000 fields.
  MessageReader(const Definition& definition, Wire wire, const std::vector<std::string>& paths);
  // Whether the definition has such a field, of a type that `Found` has a place for.
  bool Has(std::size_t path) const { return has_[path]; }
  // Adds how many fields it has, counted in all types, to those of a file's other readers. Throws InputError:
  // they are more than 2,000,000 together.
  void CountFields(const std::string& file, std::size_t* fields) const;
  // What it has at each path, valid until the next message, as are the bytes. Throws Damage: it is shorter or
  // longer than its definition says. Takes time in proportion to the message.
  const std::vector<Found>& Read(ByteSpan message);

 private:
  struct Step {
    Base base = Base::kBool;
    Amount amount = Amount::kOne;
    std::uint32_t count = 1;
    int path = -1;  // which of them ends here
    std::vector<Step> fields;
  };
  struct Cursor;
  Step Compile(const Definition& definition, const Field& field, const std::string& path,
               const std::vector<std::string>& paths);
  void ReadField(const Step& step, Cursor* at);
  void ReadNumbers(const Step& step, std::uint64_t count, Cursor* at);
  void ReadTexts(const Step& step, std::uint64_t count, Cursor* at);
  static bool IsEmpty(const Step& step);

  Step root_;
  Wire wire_;
  std::size_t steps_ = 0;
  std::vector<bool> has_;
  std::vector<Found> found_;
};

}  // namespace cairn::datasets::bag
