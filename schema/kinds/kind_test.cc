#include "schema/kinds/kind.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "schema/kinds/grid_map.h"
#include "schema/kinds/learning.h"
#include "schema/kinds/local_map.h"
#include "schema/kinds/log.h"
#include "schema/kinds/map_so_far.h"

namespace cairn {
namespace {

// What stands between `mark`s, from the first one on.
std::vector<std::string> PartsBetween(const std::string& text, char mark) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  std::string part;
  std::getline(stream, part, mark);
  while (std::getline(stream, part, mark)) parts.push_back(part);
  return parts;
}

// "shape type" of each array that the section of FORMAT.md named `heading` lists, in rows as
// "| `names` | [shape] | type | …".
std::map<std::string, std::string> ListedIn(const std::string& heading) {
  std::map<std::string, std::string> listed;
  std::ifstream page(CAIRN_FORMAT_MD);
  bool is_in = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("## ")) is_in = line.starts_with("## `" + heading + "`");
    const std::vector<std::string> cells = PartsBetween(line, '|');
    if (!is_in || cells.size() < 4 || !cells[0].starts_with(" `") || !cells[1].starts_with(" [")) continue;
    const std::string shape = cells[1].substr(2, cells[1].rfind(']') - 2),
                      type = cells[2].substr(1, cells[2].size() - 2);
    const std::vector<std::string> names = PartsBetween(cells[0], '`');
    std::string folder;  // of the row's first name; the others may leave it out
    for (std::size_t i = 0; i < names.size(); i += 2) {  // between them are commas
      const std::string& one = names[i];
      if (folder.empty()) folder = one.substr(0, one.rfind('/') + 1);
      const bool is_whole = one.find('/') != std::string::npos || folder.empty();
      listed[is_whole ? one : folder + one] = shape + " " + type;
    }
  }
  return listed;
}

// `text` with `part`, where it holds it, replaced.
std::string Replaced(std::string_view text, std::string_view part, std::string_view by) {
  std::string replaced(text);
  if (const std::size_t at = replaced.find(part); at != std::string::npos)
    replaced.replace(at, part.size(), by);
  return replaced;
}

std::map<std::string, std::string> KnownOf(std::span<const ArraySpec> specs) {
  std::map<std::string, std::string> known;
  for (const ArraySpec& spec : specs) {
    std::string type = DTypeName(spec.type);  // "float64", where the page says f64
    for (const auto& [name, letter] : {std::pair("float", "f"), {"uint", "u"}, {"int", "i"}})
      if (type.starts_with(name)) type = Replaced(type, name, letter);
    EXPECT_TRUE(known.emplace(spec.name, std::string(spec.shape) + " " + type).second) << spec.name;
  }
  return known;
}

TEST(Kinds, HaveTheArraysThatFormatMdLists) {
  for (const Kind& kind : Kinds())
    EXPECT_EQ(ListedIn(std::string(kind.name)), KnownOf(kind.arrays())) << kind.name;
  EXPECT_EQ(ListedIn("provenance"), KnownOf(ProvenanceArrays()));
}

// What an array refers to is listed too, and its mark.
TEST(Kinds, ReferToArraysThatTheyHave) {
  for (const Kind& kind : Kinds()) {
    std::set<std::string_view> names;
    for (const ArraySpec& spec : kind.arrays()) names.insert(spec.name);
    for (const ArraySpec& spec : kind.arrays()) {
      for (const std::string_view of : {spec.values.index_into, spec.values.rows_of})
        EXPECT_TRUE(of.empty() || names.contains(of)) << spec.name;
    }
    const std::string mark = Replaced(kind.mark, "/0/", "/N/");
    EXPECT_TRUE(names.contains(mark)) << kind.name;
  }
}

// An array of every name in `specs`, two of whatever there are several of, that holds what it may.
Blob Filled(std::span<const ArraySpec> specs) {
  Blob blob;
  for (const ArraySpec& spec : specs) {
    Shape shape;
    std::istringstream axes{std::string(spec.shape)};
    for (std::string axis; std::getline(axes, axis, ',');)
      shape.push_back(std::isdigit(axis[0]) != 0 ? std::stoi(axis) : 2);
    std::size_t size = 1;
    for (const std::int64_t n : shape) size *= static_cast<std::size_t>(n);
    const double value = spec.values.rows_of.empty() && spec.values.least > 0 ? 1
                         : spec.values.rows_of.empty()                        ? 0
                                                                              : 1;
    for (const char* const number : {"/0/", "/1/"}) {
      std::string name = Replaced(spec.name, "/N/", number);
      name = Replaced(name, "/SENSOR/", "/laser2/");
      if (spec.type == DType::kText)
        blob.Put(name, shape.empty() ? Array::Text("a") : Array::Texts({"a", "b"}));
      else if (spec.type == DType::kU8)
        blob.Put(name, Array::Of(shape, std::vector<std::uint8_t>(size, static_cast<std::uint8_t>(value))));
      else if (spec.type == DType::kI32)
        blob.Put(name, Array::Of(shape, std::vector<std::int32_t>(size, static_cast<std::int32_t>(value))));
      else if (spec.type == DType::kI64)
        blob.Put(name, Array::Of(shape, std::vector<std::int64_t>(size, static_cast<std::int64_t>(value))));
      else if (spec.type == DType::kF32)
        blob.Put(name, Array::Of(shape, std::vector<float>(size, static_cast<float>(value))));
      else
        blob.Put(name, Array::Of(shape, std::vector<double>(size, value)));
    }
  }
  return blob;
}

template <class K>
class Struct : public testing::Test {};
using Structs =
    testing::Types<kinds::Log, kinds::Poses, kinds::LandmarkMap, kinds::GridMap, kinds::LocalMap,
                   kinds::Samples, kinds::Errors, kinds::Networks, kinds::Localization, kinds::MapSoFar>;
TYPED_TEST_SUITE(Struct, Structs);

TYPED_TEST(Struct, HoldsWhatItsFileDoes) {
  const Blob blob = Filled(ArraysOf<TypeParam>());
  EXPECT_NO_THROW(CheckArrays(blob, ArraysOf<TypeParam>()));
  EXPECT_TRUE(BlobOf(FieldsIn<TypeParam>("", blob)).fields() == blob.fields());
}

TYPED_TEST(Struct, IsReadWithoutAnyOfItsArrays) {
  const Blob blob = Filled(ArraysOf<TypeParam>());
  for (const auto& [name, array] : blob.fields()) {
    Blob::Fields fields = blob.fields();
    fields.erase(name);
    if (name == "robots" || name == "runs") continue;  // which say how many groups there are
    EXPECT_TRUE(BlobOf(FieldsIn<TypeParam>("", Blob(fields))).fields() == fields) << name;
  }
}

TYPED_TEST(Struct, RefusesAnArrayOfAnotherShape) {
  const Blob good = Filled(ArraysOf<TypeParam>());
  for (const auto& [name, array] : good.fields()) {
    Blob blob = good;
    blob.Put(name, array.type() == DType::kText ? Array::Text("a") : Array::Scalar<double>(0));
    if (array.shape().empty()) blob.PutVector<float>(name, {0, 0});
    try {
      CheckArrays(blob, ArraysOf<TypeParam>());
      ADD_FAILURE() << name;
    } catch (const InputError&) {
    }
  }
}

TYPED_TEST(Struct, RefusesATableWithoutAColumnThatItNeeds) {
  const Blob good = Filled(ArraysOf<TypeParam>());
  int needed = 0;
  for (const ArraySpec& spec : ArraysOf<TypeParam>()) {
    if (!spec.is_needed) continue;
    ++needed;
    std::string name = Replaced(spec.name, "/N/", "/1/");
    name = Replaced(name, "/SENSOR/", "/laser2/");
    EXPECT_THROW(CheckArrays(good.Without(name), ArraysOf<TypeParam>()), InputError) << name;
  }
  EXPECT_GE(needed, 2);
}

// What no sensor does is said where the log is read: a plan that is made of it would be at fault.
TEST(Log, RefusesAReachOrABeamThatNoSensorHas) {
  const auto failure_of = [](const std::string& name, const Array& value) {
    Blob blob = Filled(ArraysOf<kinds::Log>());
    blob.Put(name, value);
    try {
      CheckArrays(blob, ArraysOf<kinds::Log>());
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string reach = "robot/0/laser2/max_range_m", beams = "robot/0/laser2/beam_heading_rad";
  EXPECT_EQ(failure_of(reach, Array::Scalar<double>(1e4)), "");
  EXPECT_EQ(failure_of(reach, Array::Scalar<double>(1e6)),
            "'" + reach + "': 1000000, where a number above 0, to 10000 is needed");
  const std::string turned = failure_of(beams, Array::Of({2}, std::vector<double>{0, 1e300}));
  EXPECT_TRUE(turned.starts_with("'" + beams + "', entry 1: 1e+300, where -1e+09 to 1e+09")) << turned;
}

TEST(KindOf, GoesByTheArraysThatAKindMustHave) {
  Blob blob;
  EXPECT_EQ(KindOf(blob), "result");
  blob.PutVector<double>("error", {0});
  EXPECT_EQ(KindOf(blob), "errors");
  blob.PutVector<float>("run/0/input", {0});
  EXPECT_EQ(KindOf(blob), "samples");
  blob.PutVector<double>("robot/0/poses/time_s", {0});
  EXPECT_EQ(KindOf(blob), "poses");
  blob.PutVector<double>("robot/0/odometry/time_s", {0});
  EXPECT_EQ(KindOf(blob), "log");
  blob.PutVector<std::int32_t>("traces/first_z", {});
  EXPECT_EQ(KindOf(blob), "local_map");
  blob.PutVector<std::int32_t>("belief/position", {0});
  EXPECT_EQ(KindOf(blob), "localization");
  blob.PutVector<double>("networks/hidden_weight", {0});
  EXPECT_EQ(KindOf(blob), "networks");
  blob.PutVector<double>("map/grid/probability", {0});
  EXPECT_EQ(KindOf(blob), "grid_map");
  blob.PutVector<double>("map/landmark_x_m", {});
  EXPECT_EQ(KindOf(blob), "landmark_map");
  blob.Put("so_far/what", Array::Text("iteration 3"));
  EXPECT_EQ(KindOf(blob), "map_so_far");
}

TEST(CheckInput, TakesNoMapThatIsStillBeingMade) {
  Blob blob;
  blob.PutVector<double>("robot/0/poses/time_s", {0});
  EXPECT_NO_THROW(CheckInput(blob.Without("robot/"), "map"));
  blob.Put("so_far/what", Array::Text("iteration 3"));
  try {
    CheckInput(blob, "map");
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "input 'map': it is a map_so_far (a map that is still being made: no result)");
  }
}

// A sensor's word for "no reading"; what is seen at the robot itself says NaN.
TEST(CheckKind, ARangeOf0IsNone) {
  Blob log;
  log.Put("robots", Array::Texts({"rover"}));
  log.Put("landmarks", Array::Texts({}));
  log.PutVector<double>("robot/0/observations/time_s", {1, 2});
  log.PutVector<std::int32_t>("robot/0/observations/landmark", {-1, -1});
  log.PutVector<double>("robot/0/observations/range_m", {2, NAN});
  log.PutVector<double>("robot/0/observations/bearing_rad", {0, NAN});
  EXPECT_NO_THROW(CheckKind(log, "log"));
  log.PutVector<double>("robot/0/observations/range_m", {2, 0});
  try {
    CheckKind(log, "log");
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "'robot/0/observations/range_m', entry 1: 0, where a number above 0, to 1e+09 or NaN is needed");
  }
}

TEST(Kinds, AreFoundByNameAndSpokenOf) {
  EXPECT_EQ(Kinds().size(), 10U);
  for (const Kind& kind : Kinds()) EXPECT_EQ(FindKind(kind.name), &kind);
  EXPECT_EQ(FindKind("checkpoint"), nullptr);
  EXPECT_EQ(WithArticle("log"), "a log");
  EXPECT_EQ(WithArticle("samples"), "samples");
  EXPECT_EQ(WithArticle("checkpoint"), "a checkpoint");
  EXPECT_EQ(IsNeeded("log"), "a log is needed");
  EXPECT_EQ(IsNeeded("networks"), "networks are needed");
}

}  // namespace
}  // namespace cairn
