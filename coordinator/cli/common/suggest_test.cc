#include "coordinator/cli/common/suggest.h"

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

TEST(NearestFlag, KnowsWhatWasMeantByAFlag) {
  const std::vector<std::string> flags = {"--help",  "--out",     "--set",  "--seed",
                                          "--input", "--workers", "--force"};
  for (const char* flag : {"--ouput", "--output", "--outt", "--ou", "--uot", "--outdir"})
    EXPECT_EQ(NearestFlag(flag, flags), "--out") << flag;
  EXPECT_EQ(NearestFlag("--worker", flags), "--workers");
  EXPECT_EQ(NearestFlag("--inputs", flags), "--input");
  for (const char* flag : {"--no-such-option", "--verbose", "--x", "--json"})
    EXPECT_EQ(NearestFlag(flag, flags), "") << flag;
}

}  // namespace
}  // namespace cairn::cli
