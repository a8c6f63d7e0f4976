#include "coordinator/cli/commands/report.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "schema/wire/testing/private_folder.h"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

// A folder that somebody hands on must not choose where the next person's pages go.
TEST(WritePages, AStagesFolderThatIsALinkIsRefused) {
  const wire::PrivateFolder folder;
  fs::create_directories(folder.path() / "victim");
  fs::create_directories(folder.path() / "out");
  fs::create_directory_symlink(folder.path() / "victim", folder.path() / "out" / "first");
  const std::vector<ScoredStage> stages = {{.name = "first", .kind = "landmark_map", .result = nullptr},
                                           {.name = "second", .kind = "landmark_map", .result = nullptr}};
  EXPECT_THROW(WritePages(folder.path() / "out", stages), InputError);
  EXPECT_TRUE(fs::is_empty(folder.path() / "victim"));
}

}  // namespace
}  // namespace cairn::cli
