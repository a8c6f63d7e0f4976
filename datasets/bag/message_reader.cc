#include "datasets/bag/message_reader.h"

#include <algorithm>
#include <bit>

#include "schema/error.h"

namespace cairn::datasets::bag {
namespace {

constexpr std::size_t kMostSteps = 20'000, kMostStepsOfFile = 2'000'000;

template <class T>
T Load(const std::byte* at, bool swaps) {
  std::array<std::byte, sizeof(T)> bytes;
  std::memcpy(bytes.data(), at, sizeof(T));
  if (swaps) std::ranges::reverse(bytes);
  return std::bit_cast<T>(bytes);
}

template <class T>
void AddNumbers(ByteSpan bytes, bool swaps, std::vector<double>* numbers) {
  const std::size_t count = bytes.size() / sizeof(T), before = numbers->size();
  numbers->resize(before + count);
  for (std::size_t i = 0; i < count; ++i)
    (*numbers)[before + i] = static_cast<double>(Load<T>(bytes.data() + i * sizeof(T), swaps));
}

// ROS 2 has no seconds beyond 31 bits, of either sign; those of ROS 1 are beyond them from 2038 on.
double SecondsAt(const std::byte* at, bool swaps, bool is_signed) {
  const double seconds = is_signed ? Load<std::int32_t>(at, swaps) : Load<std::uint32_t>(at, swaps);
  return seconds + 1e-9 * Load<std::uint32_t>(at + 4, swaps);
}

}  // namespace

// Where in a message the reader is.
struct MessageReader::Cursor {
  ByteSpan left;
  std::size_t at = 0;         // of the first of them, from where alignment counts
  std::size_t alignment = 1;  // at the most
  bool swaps = false;
  bool is_cdr = false;

  ByteSpan Take(std::uint64_t count) {
    if (count > left.size()) throw Damage{"the message is shorter than its definition says"};
    const ByteSpan taken = left.first(count);
    left = left.subspan(count);
    at += count;
    return taken;
  }
  void Align(std::size_t size) {
    const std::size_t to = std::min(size, alignment);
    if (to > 1 && at % to != 0) Take(to - at % to);
  }
  std::uint32_t TakeLength() {
    Align(4);
    return Load<std::uint32_t>(Take(4).data(), swaps);
  }
};

MessageReader::MessageReader(const Definition& definition, Wire wire, const std::vector<std::string>& paths)
    : wire_(wire), has_(paths.size(), false), found_(paths.size()) {
  root_.base = Base::kStruct;
  for (const Field& field : definition.types.front().fields) {
    Step step = Compile(definition, field, field.name, paths);
    if (!IsEmpty(step)) root_.fields.push_back(std::move(step));
  }
}

void MessageReader::CountFields(const std::string& file, std::size_t* fields) const {
  *fields += steps_;
  if (*fields > kMostStepsOfFile)
    throw InputError(file + ": topics of more than 2,000,000 fields, counted in all types");
}

MessageReader::Step MessageReader::Compile(const Definition& definition, const Field& field,
                                           const std::string& path, const std::vector<std::string>& paths) {
  if (++steps_ > kMostSteps) throw Damage{"a definition of more than 20,000 fields, counted in all types"};
  Step step{field.base, field.amount, field.count, -1, {}};
  const bool has_place =
      field.base != Base::kWideString && (field.base != Base::kStruct || field.amount == Amount::kSequence);
  if (const auto found = std::ranges::find(paths, path); found != paths.end() && has_place) {
    step.path = static_cast<int>(found - paths.begin());
    has_[static_cast<std::size_t>(step.path)] = true;
  }
  if (field.base != Base::kStruct) return step;
  for (const Field& part : definition.types[field.type].fields) {
    Step inner = Compile(definition, part, path + "." + part.name, paths);
    if (!IsEmpty(inner)) step.fields.push_back(std::move(inner));
  }
  // As CDR has no struct without fields, ROS 2 puts a byte into it.
  if (step.fields.empty() && wire_ == Wire::kCdr)
    step.fields.push_back({Base::kUint8, Amount::kOne, 1, -1, {}});
  return step;
}

// Takes no byte of a message: what is left has an end with its message.
bool MessageReader::IsEmpty(const Step& step) {
  if (step.amount == Amount::kSequence) return false;
  if (step.amount == Amount::kFixed && step.count == 0) return true;
  return step.base == Base::kStruct && step.fields.empty();
}

const std::vector<Found>& MessageReader::Read(ByteSpan message) {
  for (Found& found : found_) {
    found.numbers.clear();
    found.texts.clear();
    found.bytes = {};
  }
  Cursor at;
  at.left = message;
  constexpr std::size_t kMostPadding = 7;
  if (wire_ == Wire::kCdr) {
    if (message.size() < 4) throw Damage{"a message of CDR without its first four bytes"};
    // DDS-XTypes 1.3, section 7.6.3.1.2: 0 and 1 CDR, 6 and 7 CDR2, big- and little-endian.
    const auto kind = std::to_integer<unsigned>(message[1]);
    if (message[0] != std::byte{0} || (kind > 1 && kind != 6 && kind != 7))
      throw Damage{"a message that is not plain CDR"};
    at.left = message.subspan(4);
    at.alignment = kind > 1 ? 4 : 8;
    at.swaps = kind % 2 == 0;
    at.is_cdr = true;
  }
  for (const Step& step : root_.fields) ReadField(step, &at);
  if (at.left.size() > (at.is_cdr ? kMostPadding : 0))
    throw Damage{"the message is longer than its definition says"};
  return found_;
}

void MessageReader::ReadField(const Step& step, Cursor* at) {
  std::uint64_t count = step.count;
  if (step.amount == Amount::kSequence) count = at->TakeLength();
  if (step.base == Base::kString || step.base == Base::kWideString) return ReadTexts(step, count, at);
  if (step.base != Base::kStruct) return ReadNumbers(step, count, at);
  if (step.path >= 0)
    found_[static_cast<std::size_t>(step.path)].numbers.push_back(static_cast<double>(count));
  if (step.fields.empty() && count > 0) throw Damage{"a sequence of what takes no bytes"};
  for (std::uint64_t i = 0; i < count; ++i)
    for (const Step& field : step.fields) ReadField(field, at);
}

void MessageReader::ReadNumbers(const Step& step, std::uint64_t count, Cursor* at) {
  const std::size_t size = SizeOf(step.base);
  if (count > 0) at->Align(size);
  const ByteSpan bytes = at->Take(count * size * (step.base == Base::kTime ? 2 : 1));
  if (step.path < 0) return;
  Found& found = found_[static_cast<std::size_t>(step.path)];
  std::vector<double>* numbers = &found.numbers;
  switch (step.base) {
    case Base::kBool:
    case Base::kUint8:
    case Base::kInt8:
      if (step.amount != Amount::kOne)
        found.bytes = bytes;
      else if (step.base == Base::kInt8)
        AddNumbers<std::int8_t>(bytes, false, numbers);
      else
        AddNumbers<std::uint8_t>(bytes, false, numbers);
      break;
    case Base::kInt16:
      return AddNumbers<std::int16_t>(bytes, at->swaps, numbers);
    case Base::kUint16:
      return AddNumbers<std::uint16_t>(bytes, at->swaps, numbers);
    case Base::kInt32:
      return AddNumbers<std::int32_t>(bytes, at->swaps, numbers);
    case Base::kUint32:
      return AddNumbers<std::uint32_t>(bytes, at->swaps, numbers);
    case Base::kInt64:
      return AddNumbers<std::int64_t>(bytes, at->swaps, numbers);
    case Base::kUint64:
      return AddNumbers<std::uint64_t>(bytes, at->swaps, numbers);
    case Base::kFloat32:
      return AddNumbers<float>(bytes, at->swaps, numbers);
    case Base::kFloat64:
      return AddNumbers<double>(bytes, at->swaps, numbers);
    default:
      for (std::uint64_t i = 0; i < count; ++i)
        numbers->push_back(SecondsAt(bytes.data() + 8 * i, at->swaps, at->is_cdr));
  }
}

void MessageReader::ReadTexts(const Step& step, std::uint64_t count, Cursor* at) {
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t length = at->TakeLength();
    if (step.base == Base::kWideString) {
      at->Take(4 * length);
      continue;
    }
    std::string_view text = AsText(at->Take(length));
    if (text.ends_with('\0')) text.remove_suffix(1);  // CDR counts it
    if (step.path >= 0) found_[static_cast<std::size_t>(step.path)].texts.push_back(text);
  }
}

}  // namespace cairn::datasets::bag
