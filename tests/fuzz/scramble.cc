#include "tests/fuzz/scramble.h"

#include <array>
#include <limits>
#include <string>
#include <vector>

namespace cairn::fuzz {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

constexpr std::array<std::uint64_t, 12> kIntegers{
    0, 1, 2, 7, 255, 4096, 0x7fffffff, 0x80000000, 0xffffffff, 0x7fffffffffffffff, 0x8000000000000000, ~0ULL};

double Number(ByteSource* source) {
  using Limits = std::numeric_limits<double>;
  constexpr std::array<double, 12> kNumbers{0,
                                            -1,
                                            1e-300,
                                            1e9,
                                            1e18,
                                            -1e300,
                                            Limits::max(),
                                            Limits::infinity(),
                                            0.5,
                                            1e5,
                                            Limits::quiet_NaN(),
                                            -Limits::infinity()};
  const std::size_t choice = source->Below(kNumbers.size() + 1);
  return choice < kNumbers.size() ? kNumbers[choice] : source->Take<double>();
}

std::uint64_t Integer(ByteSource* source) {
  const std::size_t choice = source->Below(kIntegers.size() + 1);
  return choice < kIntegers.size() ? kIntegers[choice] : source->Take<std::uint64_t>();
}

std::string Word(ByteSource* source) {
  switch (source->Below(6)) {
    case 0:
      return "";
    case 1:
      return "../../../etc/passwd";
    case 2:
      return std::string(16, static_cast<char>(source->Byte()));
    case 3:
      return std::string(1000, '/');
    case 4:
      return "stage";
    default:
      return source->Text();
  }
}

// A field set to a value, or added with it where it is repeated.
void SetScalar(Message* message, const FieldDescriptor* field, ByteSource* source) {
  const auto* r = message->GetReflection();
  const bool many = field->is_repeated();
  const auto put = [&](auto set, auto add, auto value) {
    if (many)
      (r->*add)(message, field, value);
    else
      (r->*set)(message, field, value);
  };
  using R = google::protobuf::Reflection;
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_INT32:
      return put(&R::SetInt32, &R::AddInt32, static_cast<std::int32_t>(Integer(source)));
    case FieldDescriptor::CPPTYPE_INT64:
      return put(&R::SetInt64, &R::AddInt64, static_cast<std::int64_t>(Integer(source)));
    case FieldDescriptor::CPPTYPE_UINT32:
      return put(&R::SetUInt32, &R::AddUInt32, static_cast<std::uint32_t>(Integer(source)));
    case FieldDescriptor::CPPTYPE_UINT64:
      return put(&R::SetUInt64, &R::AddUInt64, Integer(source));
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return put(&R::SetDouble, &R::AddDouble, Number(source));
    case FieldDescriptor::CPPTYPE_BOOL:
      return put(&R::SetBool, &R::AddBool, source->Below(2) == 1);
    case FieldDescriptor::CPPTYPE_ENUM:
      return put(&R::SetEnumValue, &R::AddEnumValue, static_cast<int>(source->Below(8)));
    case FieldDescriptor::CPPTYPE_STRING:
      return put(&R::SetString, &R::AddString, Word(source));
    default:
      return;
  }
}

// Into it, or a new one, or one less.
void ScrambleMessageField(Message* message, const FieldDescriptor* field, ByteSource* source) {
  const auto* r = message->GetReflection();
  if (!field->is_repeated()) return Scramble(r->MutableMessage(message, field), source);
  const int size = r->FieldSize(*message, field);
  const std::size_t choice = source->Below(4);
  if (size == 0 || choice == 0) {
    r->AddMessage(message, field);
  } else if (choice == 1) {
    r->RemoveLast(message, field);
  } else {
    Scramble(r->MutableRepeatedMessage(message, field, static_cast<int>(source->Below(256)) % size), source);
  }
}

Array Retyped(const Array& array, ByteSource* source) {
  const auto count = static_cast<std::size_t>(array.size());
  switch (source->Below(4)) {
    case 0:
      return Array::Of<double>(array.shape(), std::vector<double>(count, Number(source)));
    case 1:
      return Array::Of<std::int32_t>(array.shape(), std::vector<std::int32_t>(count, 1));
    case 2:
      return Array::Of<std::int64_t>(array.shape(), std::vector<std::int64_t>(count, 1));
    default:
      return Array::Texts(std::vector<std::string>(count, "x"));
  }
}

Array Reshaped(const Array& array, ByteSource* source) {
  const std::int64_t n = array.size();
  constexpr std::array<std::int64_t, 4> kOther{1, 0, 2, 3};
  Shape shape{n, 1};
  if (source->Below(2) == 0) shape = {kOther[source->Below(4)], n};
  if (shape[0] * shape[1] != n) return Array::FromBytes(array.type(), array.item_bytes(), {0}, {}).value();
  return Array::FromBytes(array.type(), array.item_bytes(), shape, array.bytes()).value();
}

template <class T>
Array WithElements(const Array& array, ByteSource* source) {
  const auto old = array.As<T>();
  std::vector<T> values(old.begin(), old.end());
  const std::size_t first = source->Take<std::uint16_t>() % values.size();
  const std::size_t end = source->Below(4) == 0 ? values.size() : first + 1;
  for (std::size_t i = first; i < end; ++i) {
    if constexpr (std::is_floating_point_v<T>)
      values[i] = static_cast<T>(Number(source));
    else
      values[i] = static_cast<T>(Integer(source));
  }
  return Array::Of<T>(array.shape(), values);
}

Array Changed(const Array& array, ByteSource* source) {
  if (array.size() == 0) return Array::Vector<double>({Number(source)});
  switch (array.type()) {
    case DType::kU8:
      return WithElements<std::uint8_t>(array, source);
    case DType::kI32:
      return WithElements<std::int32_t>(array, source);
    case DType::kI64:
      return WithElements<std::int64_t>(array, source);
    case DType::kF32:
      return WithElements<float>(array, source);
    case DType::kF64:
      return WithElements<double>(array, source);
    case DType::kText:
      break;
  }
  std::vector<std::string> texts = array.AsTexts();
  if (texts.empty()) return Array::Text(Word(source));
  texts[source->Below(texts.size())] = Word(source);
  return Array::Texts(texts);
}

}  // namespace

void Scramble(Message* message, ByteSource* source) {
  const auto* descriptor = message->GetDescriptor();
  if (descriptor->field_count() == 0) return;
  const FieldDescriptor* field =
      descriptor->field(static_cast<int>(source->Below(static_cast<std::size_t>(descriptor->field_count()))));
  if (source->Below(8) == 0) return message->GetReflection()->ClearField(message, field);
  if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE)
    return ScrambleMessageField(message, field, source);
  SetScalar(message, field, source);
}

Blob Scrambled(const Blob& blob, ByteSource* source) {
  Blob::Fields fields = blob.fields();
  for (std::size_t edits = source->Below(5); edits > 0 && !fields.empty(); --edits) {
    auto it = fields.begin();
    std::advance(it, static_cast<std::ptrdiff_t>(source->Byte() % fields.size()));
    const Array array = it->second;
    switch (source->Below(8)) {
      case 0:
        fields.erase(it);
        break;
      case 1:
        if (!array.shape().empty()) it->second = array.Rows(0, array.shape()[0] / 2);
        break;
      case 2:
        it->second = Retyped(array, source);
        break;
      case 3:
        it->second = Reshaped(array, source);
        break;
      default:
        it->second = Changed(array, source);
    }
  }
  return Blob(std::move(fields));
}

}  // namespace cairn::fuzz
