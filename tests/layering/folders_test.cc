#include "tests/layering/folders.h"

#include <gtest/gtest.h>

namespace cairn::layering {
namespace {

TEST(Folders, IncludeEachOtherInNoCircle) {
  const Folders folders = ReadFolders(CAIRN_SOURCE_DIR);
  EXPECT_GT(folders.includes.size(), 40u) << "the sources are not where this test looks";
  std::string text;
  for (const std::string& folder : CircleIn(folders)) text += folder + " -> ";
  EXPECT_EQ(text, "");
}

TEST(Folders, HaveThirtySourcesAtMost) {
  for (const auto& [folder, sources] : ReadFolders(CAIRN_SOURCE_DIR).sources)
    EXPECT_LE(sources, 30) << folder << " needs folders of its own";
}

TEST(Folders, OfACircleAreFound) {
  Folders folders;
  folders.includes = {{"a", {"b", "c"}}, {"b", {"c"}}, {"c", {"d"}}, {"d", {"e"}}};
  EXPECT_TRUE(CircleIn(folders).empty());
  folders.includes["e"] = {"c"};
  EXPECT_EQ(CircleIn(folders), (std::vector<std::string>{"c", "d", "e", "c"}));
}

}  // namespace
}  // namespace cairn::layering
