#include "schema/kinds/fields.h"

#include <gtest/gtest.h>

namespace cairn {
namespace {

enum class Colour { kRed, kBlue };

struct Mark {
  double x_m = 0;
  float matrix[4] = {};
  std::int32_t count = 0;
  bool seen = false;
  Colour colour = Colour::kRed;
  friend bool operator==(const Mark&, const Mark&) = default;
  static void Fields(const auto& field) {
    field("x_m", &Mark::x_m);
    field({"matrix", "K,2,2"}, &Mark::matrix);
    field("count", &Mark::count);
    field("seen", &Mark::seen);
    field("colour", &Mark::colour);
  }
};

struct Track {
  std::vector<std::size_t> steps;
  friend bool operator==(const Track&, const Track&) = default;
  static void Fields(const auto& field) { field("step", &Track::steps); }
};

struct Whole {
  std::string name;
  std::vector<std::string> words;
  std::optional<double> range_m, bearing_rad;
  Mark best;
  std::vector<Mark> marks;
  std::vector<Track> tracks;
  friend bool operator==(const Whole&, const Whole&) = default;
  static void Fields(const auto& field) {
    field("name", &Whole::name);
    field("word", &Whole::words);
    field("range_m", &Whole::range_m);
    field("bearing_rad", &Whole::bearing_rad);
    field("best", &Whole::best);
    field("mark", &Whole::marks);
    field("track", &Whole::tracks);
  }
};

Whole Example() {
  const Mark blue{1.5, {1, 2, 3, 4}, -2, true, Colour::kBlue};
  return {"a", {"b", "cd"}, 3.0, {}, blue, {Mark{}, blue}, {{{1, 2}}, {{}}, {{7}}}};
}

std::string Refusal(const Blob& blob) {
  try {
    FieldsIn<Whole>("", blob);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Fields, ComeBackAsTheyWere) {
  const Whole whole = Example();
  EXPECT_TRUE(FieldsIn<Whole>("", BlobOf(whole)) == whole);
  Blob under;
  PutFields("in/", whole, &under);
  EXPECT_TRUE(FieldsIn<Whole>("in/", under) == whole);
}

TEST(Fields, LieInArraysOfTheirNames) {
  const Blob blob = BlobOf(Example());
  EXPECT_EQ(blob.Text("name"), "a");
  EXPECT_FALSE(blob.Has("bearing_rad"));
  EXPECT_EQ(blob.Scalar<std::uint8_t>("best/seen"), 1);
  EXPECT_EQ(blob.Scalar<std::int32_t>("best/colour"), 1);
  EXPECT_EQ(blob.at("mark/matrix").shape(), (Shape{2, 2, 2}));
  EXPECT_EQ(blob.at("mark/x_m").shape(), Shape{2});
  EXPECT_EQ(blob.Get<std::int64_t>("track/2/step")[0], 7);
}

TEST(Fields, ThatAreMissingOrOfAnotherFormAreNamed) {
  const Blob good = BlobOf(Example());
  EXPECT_EQ(Refusal(good), "");
  EXPECT_NE(Refusal(good.Without("mark/count")).find("'mark/count'"), std::string::npos);
  Blob blob = good;
  blob.PutVector<double>("best/x_m", {1, 2});
  EXPECT_NE(Refusal(blob).find("'best/x_m' is not a single value"), std::string::npos);
  blob = good;
  blob.PutVector<std::int32_t>("mark/count", {1, 2, 3});
  EXPECT_EQ(Refusal(blob), "'mark/count' has 3 rows, where 2 are needed");
  blob = good;
  blob.PutVector<double>("mark/count", {1, 2});
  EXPECT_NE(Refusal(blob).find("'mark/count' holds"), std::string::npos);
}

TEST(Fields, OfMoreGroupsThanAnybodyHasAreNotMade) {
  Blob blob = BlobOf(Example());
  blob.Put("tracks", Array::Texts(std::vector<std::string>(10'001, "a")));
  EXPECT_EQ(Refusal(blob), "'tracks' has 10001 rows, where 10000 are the most");
}

TEST(Rows, AreAppendedAfterThoseThatAreThere) {
  const std::vector<Mark> two = Example().marks;
  Blob blob;
  PutRows("", two, &blob);
  std::vector<Mark> rows{Mark{.x_m = 9}};
  AppendRows("", blob, &rows);
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].x_m, 9);
  EXPECT_TRUE(rows[2] == two[1]);
  EXPECT_EQ(ColumnOf(rows, &Mark::x_m), (std::vector<double>{9, 0, 1.5}));
}

TEST(Column, NamesWhatIsMissingToWhoeverNeedsIt) {
  Blob blob;
  blob.PutVector<double>("x_m", {1, 2});
  const auto x = Column<double>::In(blob, "x_m"), y = Column<double>::In(blob, "y_m");
  EXPECT_EQ(x.vector(), (std::vector<double>{1, 2}));
  EXPECT_FALSE(y);
  EXPECT_EQ(y.Or(7), 7);
  EXPECT_THROW(x.Scalar(), InputError);
  try {
    EXPECT_EQ(y.size(), 0U);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "there is no 'y_m'");
  }
  const auto of_texts = Texts::In(blob, "x_m");
  EXPECT_FALSE(of_texts);
  EXPECT_TRUE(of_texts.OrNone().empty());
  EXPECT_THROW(of_texts.values(), InputError);
  EXPECT_THROW(Column<float>::In(blob, "x_m").values(), InputError);
}

}  // namespace
}  // namespace cairn
