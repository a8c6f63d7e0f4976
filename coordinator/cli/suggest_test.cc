#include "coordinator/cli/suggest.h"

#include <gtest/gtest.h>

namespace cairn::cli {
namespace {

TEST(Nearest, FindsOneSlipOfTheFinger) {
  const std::vector<std::string> known = {"cell_m", "heading_deg", "iterations"};
  EXPECT_EQ(Nearest("ceil_m", known), "cell_m");
  EXPECT_EQ(Nearest("cel_m", known), "cell_m");
  EXPECT_EQ(Nearest("celll_m", known), "cell_m");
  EXPECT_EQ(Nearest("iteratoins", known), "iterations");
}

TEST(Nearest, IsEmptyWhereNothingIsNear) {
  EXPECT_EQ(Nearest("blur", {"cell_m", "heading_deg"}), "");
  EXPECT_EQ(Nearest("x", {}), "");
}

TEST(Suggest, NamesWhatIsKnown) {
  EXPECT_EQ(Suggest("sede", {"name", "seed"}), "; did you mean 'seed'?; known: name, seed");
  EXPECT_EQ(Suggest("a", {}), "; there are none");
}

}  // namespace
}  // namespace cairn::cli
