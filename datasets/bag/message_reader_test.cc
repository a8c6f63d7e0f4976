#include "datasets/bag/message_reader.h"

#include "datasets/bag/testing_bag.h"
#include "datasets/testing.h"

namespace cairn::datasets::bag {
namespace {

template <class Function>
std::string DamageOf(Function function) {
  try {
    function();
  } catch (const Damage& damage) {
    return damage.what;
  }
  return {};
}

constexpr const char* kText =
    "# a comment\n"
    "uint8 KIND=3\n"
    "string NAME = a=b # is a constant\n"
    "uint8 kind\n"
    "int16[3] triple 1\n"
    "Part[] parts\n"
    "string<=10 name \"unnamed\"\n"
    "float32[<=4] few\n"
    "builtin_interfaces/Time stamp\n"
    "bool last true\n"
    "================\nMSG: pkg/msg/Part\nfloat64 value\nstring[] words\n";

std::string EncodedMessage(Encoder::To to) {
  Encoder out(to);
  out.Put<std::uint8_t>(7).Put<std::int16_t>(-1).Put<std::int16_t>(2).Put<std::int16_t>(3);
  out.Put<std::uint32_t>(2);
  out.Put(0.5).Put<std::uint32_t>(1).Text("a");
  out.Put(-0.5).Put<std::uint32_t>(2).Text("bc").Text("");
  out.Text("name").Floats({1.5F, 2.5F});
  out.Put<std::uint32_t>(10).Put<std::uint32_t>(500'000'000).Put<std::uint8_t>(1);
  return out.text();
}

TEST(MessageReader, FindsFieldsByNameInAnyEncoding) {
  const Definition definition = ParseDefinition("pkg/Whole", kText);
  for (const Encoder::To to : {Encoder::To::kRos1, Encoder::To::kCdr, Encoder::To::kBigCdr}) {
    MessageReader reader(definition, to == Encoder::To::kRos1 ? Wire::kRos1 : Wire::kCdr,
                         {"kind", "triple", "parts.value", "parts.words", "name", "few", "stamp", "last",
                          "parts", "none", "KIND"});
    const std::string message = EncodedMessage(to);
    const std::vector<Found>& found = reader.Read(std::as_bytes(std::span(message)));
    EXPECT_EQ(found[0].numbers, (std::vector<double>{7}));
    EXPECT_EQ(found[1].numbers, (std::vector<double>{-1, 2, 3}));
    EXPECT_EQ(found[2].numbers, (std::vector<double>{0.5, -0.5}));
    EXPECT_EQ(found[5].numbers, (std::vector<double>{1.5, 2.5}));
    EXPECT_EQ(found[6].numbers, (std::vector<double>{10.5}));
    EXPECT_EQ(found[7].numbers, (std::vector<double>{1}));
    EXPECT_EQ(found[8].numbers, (std::vector<double>{2}));
    EXPECT_EQ(found[3].texts.size(), 3U);
    EXPECT_EQ(found[4].texts.size(), 1U);
    EXPECT_FALSE(reader.Has(9));
    EXPECT_FALSE(reader.Has(10)) << "a constant is no field";
  }
}

TEST(MessageReader, RefusesWhatDoesNotMatchItsDefinition) {
  const Definition definition = ParseDefinition("pkg/Whole", kText);
  MessageReader reader(definition, Wire::kRos1, {"kind"});
  const std::string whole = EncodedMessage(Encoder::To::kRos1);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::string cut = whole.substr(0, size);
    EXPECT_NE(DamageOf([&] { reader.Read(std::as_bytes(std::span(cut))); }), "") << size;
  }
  const std::string longer = whole + "x";
  EXPECT_EQ(DamageOf([&] { reader.Read(std::as_bytes(std::span(longer))); }),
            "the message is longer than its definition says");
}

TEST(MessageReader, AHeaderMayBeOfTheFirstReleasesOfRos) {
  const Definition definition = ParseDefinition(
      "pkg/Old",
      "Header header\nuint8 last\n====\nMSG: roslib/Header\nuint32 seq\ntime stamp\nstring frame_id\n");
  MessageReader reader(definition, Wire::kRos1, {"header.stamp", "header.frame_id", "last"});
  Encoder out(Encoder::To::kRos1);
  const std::string message = out.Header(10.5, "laser").Put<std::uint8_t>(7).text();
  const std::vector<Found>& found = reader.Read(std::as_bytes(std::span(message)));
  EXPECT_EQ(found[0].numbers, (std::vector<double>{10.5}));
  EXPECT_EQ(found[1].texts.at(0), "laser");
  EXPECT_EQ(found[2].numbers, (std::vector<double>{7}));
}

TEST(MessageReader, ASequenceOfNothingHasAnEnd) {
  const std::string endless = "\xFF\xFF\xFF\xFF";
  MessageReader reader(ParseDefinition("p/A", "B[] many\n====\nMSG: p/B\n"), Wire::kRos1, {"many"});
  EXPECT_EQ(DamageOf([&] { reader.Read(std::as_bytes(std::span(endless))); }),
            "a sequence of what takes no bytes");
}

TEST(ParseDefinition, RefusesTypesWithoutEnd) {
  EXPECT_EQ(DamageOf([] { ParseDefinition("p/A", "B b\n====\nMSG: p/B\nA[] a\n"); }),
            "a definition in which 'p/A' holds itself");
  EXPECT_EQ(DamageOf([] { ParseDefinition("p/A", "B b\n"); }),
            "a definition that does not say what 'p/B' is");
  std::string deep, wide;
  for (int i = 0; i < 100; ++i)
    deep += "A" + std::to_string(i) + " a\n====\nMSG: p/A" + std::to_string(i) + "\n";
  EXPECT_EQ(DamageOf([&] { ParseDefinition("p/A", deep); }),
            "a definition of types in types, more than 50 deep");
  for (int i = 0; i < 20; ++i) {
    for (const char* name : {"a", "b", "c", "d"}) wide += "W" + std::to_string(i) + " " + name + "\n";
    wide += "====\nMSG: p/W" + std::to_string(i) + "\n";
  }
  wide += "uint8 x\n";
  const Definition definition = ParseDefinition("p/W", wide);
  EXPECT_EQ(DamageOf([&] { MessageReader(definition, Wire::kRos1, {}); }),
            "a definition of more than 20,000 fields, counted in all types");
  EXPECT_EQ(DamageOf([] { ParseDefinition("p/A", "uint8[x] a\n"); }),
            "a definition with the line 'uint8[x]'");
}

}  // namespace
}  // namespace cairn::datasets::bag
