#include "datasets/bag/definition.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <utility>

#include "datasets/bag/bytes.h"
#include "datasets/bag/container.h"
#include "datasets/common/text_file.h"
#include "schema/text.h"

namespace cairn::datasets::bag {
namespace {

constexpr std::size_t kMostTypes = 1000, kMostFields = 10'000;

struct BaseName {
  std::string_view name;
  Base base;
};
constexpr BaseName kBaseNames[] = {
    {"bool", Base::kBool},       {"byte", Base::kUint8},        {"char", Base::kUint8},
    {"int8", Base::kInt8},       {"uint8", Base::kUint8},       {"int16", Base::kInt16},
    {"uint16", Base::kUint16},   {"int32", Base::kInt32},       {"uint32", Base::kUint32},
    {"int64", Base::kInt64},     {"uint64", Base::kUint64},     {"float32", Base::kFloat32},
    {"float64", Base::kFloat64}, {"time", Base::kTime},         {"duration", Base::kTime},
    {"string", Base::kString},   {"wstring", Base::kWideString}};

std::optional<Base> BaseOf(std::string_view name) {
  for (const BaseName& known : kBaseNames)
    if (known.name == name) return known.base;
  if (name == "builtin_interfaces/Time" || name == "builtin_interfaces/Duration") return Base::kTime;
  return std::nullopt;
}

[[noreturn]] void BadLine(std::string_view line) {
  throw Damage{"a definition with the line '" + Printable(std::string(line), 80) + "'"};
}

// `name`, as it stands in a type of `package`.
std::string FullName(std::string_view name, std::string_view package) {
  if (name == "Header") return "std_msgs/Header";
  if (name.find('/') != std::string_view::npos) return TypeName(std::string(name));
  return std::string(package) + "/" + std::string(name);
}

// "float64[36]", "int32[]", "Point[<=5]", "string<=10": the name without what stands behind it.
std::string_view SplitAmount(std::string_view word, Field* field) {
  if (const std::size_t open = word.find('['); open != std::string_view::npos) {
    if (!word.ends_with(']')) BadLine(word);
    const std::string_view inside = word.substr(open + 1, word.size() - open - 2);
    field->amount = Amount::kSequence;
    if (!inside.empty() && !inside.starts_with("<=")) {
      const auto [end, error] = std::from_chars(inside.data(), inside.data() + inside.size(), field->count);
      if (error != std::errc() || end != inside.data() + inside.size()) BadLine(word);
      field->amount = Amount::kFixed;
    }
    word = word.substr(0, open);
  }
  return word.substr(0, word.find("<="));
}

std::string_view CutWord(std::string_view* text) {
  *text = Trim(*text);
  const std::string_view word = text->substr(0, text->find_first_of(" \t"));
  text->remove_prefix(word.size());
  *text = Trim(*text);
  return word;
}

// Of a text of several types those of each: by name, in it the lines.
class Parser {
 public:
  Parser(const std::string& type, std::string_view text) {
    if (text.size() > kMostDefinitionBytes) throw Damage{"a definition of more than a megabyte"};
    Split(type, text);
    Resolve(type);
  }
  Definition Take() { return std::move(definition_); }

 private:
  void Split(const std::string& type, std::string_view text) {
    constexpr std::string_view kRule = "===", kMsg = "MSG:";
    std::vector<std::string_view>* into = &texts_[type];
    std::vector<std::string_view> repeated;  // of two of a name the first counts
    Lines lines(text);
    while (lines.Next()) {
      const std::string_view line = Trim(lines.text());
      if (line.starts_with(kRule)) continue;
      if (!line.starts_with(kMsg)) {
        into->push_back(line);
        continue;
      }
      const auto [found, is_new] = texts_.try_emplace(TypeName(std::string(Trim(line.substr(kMsg.size())))));
      if (texts_.size() > kMostTypes) throw Damage{"a definition of more than 1,000 types"};
      into = is_new ? &found->second : &repeated;
    }
  }

  // The place of the type in the definition.
  std::size_t Resolve(const std::string& name) {
    if (const auto done = places_.find(name); done != places_.end()) {
      if (!done->second) throw Damage{"a definition in which '" + Printable(name, 80) + "' holds itself"};
      return *done->second;
    }
    if (places_.size() == kMostTypes) throw Damage{"a definition of more than 1,000 types"};
    places_[name] = std::nullopt;
    const std::size_t place = definition_.types.size();
    definition_.types.push_back({name, {}});
    std::vector<Field> fields;
    for (const std::string_view line : LinesOf(name))
      if (auto field = ParseLine(line, name.substr(0, name.find('/')))) {
        if (++fields_ > kMostFields) throw Damage{"a definition of more than 10,000 fields"};
        fields.push_back(std::move(*field));
      }
    definition_.types[place].fields = std::move(fields);
    places_[name] = place;
    return place;
  }

  // Of one that the text leaves out, as it is known.
  std::vector<std::string_view> LinesOf(const std::string& name) {
    auto found = texts_.find(name);
    // As ROS had it until 2010 (C Turtle).
    if (found == texts_.end() && name == "std_msgs/Header") found = texts_.find("roslib/Header");
    if (found != texts_.end()) return found->second;
    const std::string_view known = KnownDefinition(name);
    if (known.empty()) throw Damage{"a definition that does not say what '" + Printable(name, 80) + "' is"};
    std::vector<std::string_view> own;
    Lines lines(known);
    while (lines.Next() && !lines.text().starts_with("MSG:")) own.push_back(Trim(lines.text()));
    return own;
  }

  // Nothing for comments and constants.
  std::optional<Field> ParseLine(std::string_view line, std::string_view package) {
    std::string_view rest = line.substr(0, line.find('#'));
    const std::string_view type = CutWord(&rest);
    if (type.empty()) return std::nullopt;
    const std::string_view name = rest.substr(0, rest.find_first_of(" \t="));
    if (name.empty() || name.size() > 200) BadLine(line);
    // A constant has a '=' behind its name, a default value has none.
    if (Trim(rest.substr(name.size())).starts_with('=')) return std::nullopt;
    Field field;
    field.name = name;
    const std::string_view base = SplitAmount(type, &field);
    const auto known = BaseOf(base.find('/') == std::string_view::npos ? base : TypeName(std::string(base)));
    field.base = known.value_or(Base::kStruct);
    if (known) return field;
    if (++depth_ > kMostDepth) throw Damage{"a definition of types in types, more than 50 deep"};
    field.type = Resolve(FullName(base, package));
    --depth_;
    return field;
  }

  static constexpr int kMostDepth = 50;
  std::map<std::string, std::vector<std::string_view>> texts_;
  std::map<std::string, std::optional<std::size_t>> places_;  // nothing: while its fields are looked at
  Definition definition_;
  std::size_t fields_ = 0;
  int depth_ = 0;
};

void AddPaths(const Definition& definition, const Type& type, const std::string& before,
              std::vector<std::string>* paths) {
  constexpr std::size_t kMostPaths = 100;
  for (const Field& field : type.fields) {
    if (paths->size() == kMostPaths) return;
    if (field.base == Base::kStruct)
      AddPaths(definition, definition.types[field.type], before + field.name + ".", paths);
    else if (field.base != Base::kWideString)
      paths->push_back(before + field.name);
  }
}

}  // namespace

std::size_t SizeOf(Base base) {
  switch (base) {
    case Base::kBool:
    case Base::kInt8:
    case Base::kUint8:
      return 1;
    case Base::kInt16:
    case Base::kUint16:
      return 2;
    case Base::kInt32:
    case Base::kUint32:
    case Base::kFloat32:
    case Base::kTime:
      return 4;
    case Base::kInt64:
    case Base::kUint64:
    case Base::kFloat64:
      return 8;
    default:
      return 0;
  }
}

Definition ParseDefinition(const std::string& type, std::string_view text) {
  return Parser(type, text).Take();
}

std::vector<std::string> FieldPaths(const Definition& definition) {
  std::vector<std::string> paths;
  AddPaths(definition, definition.types.front(), "", &paths);
  return paths;
}

}  // namespace cairn::datasets::bag
