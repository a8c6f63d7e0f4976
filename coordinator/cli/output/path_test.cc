#include "coordinator/cli/output/path.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "schema/error.h"
#include "schema/wire/testing/private_folder.h"

namespace cairn::cli {
namespace {

std::string TextOf(const std::string& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

// As it is where it came to be there after CheckOverwrite had looked.
TEST(OutputPath, BytesTakeNobodysPlaceUnlessForced) {
  const wire::PrivateFolder folder;
  const std::string path = (folder.path() / "run.png").string();
  WriteOutput(path, std::string_view("first"), false);
  EXPECT_EQ(TextOf(path), "first");
  EXPECT_THROW(WriteOutput(path, "second", false), InputError);
  EXPECT_EQ(TextOf(path), "first");
  WriteOutput(path, "third", true);
  EXPECT_EQ(TextOf(path), "third");
}

}  // namespace
}  // namespace cairn::cli
