#include "schema/wire/endpoint.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "schema/wire/testing/private_folder.h"

namespace cairn::wire {
namespace {

TEST(Endpoint, IpcNeedsAPrivateFolder) {
  const PrivateFolder folder;
  EXPECT_TRUE(CheckEndpoint(folder.Ipc("socket"), false).ok());
  for (const mode_t mode : {0755, 0770, 0701, 0777}) {
    ASSERT_EQ(::chmod(folder.path().c_str(), mode), 0);
    const Status status = CheckEndpoint(folder.Ipc("socket"), false);
    EXPECT_EQ(status.code(), Code::kRefused) << std::oct << mode;
    EXPECT_NE(status.message().find("0700"), std::string::npos);
  }
  ASSERT_EQ(::chmod(folder.path().c_str(), 0700), 0);
}

TEST(Endpoint, RefusesALinkInTheFoldersPlace) {
  const PrivateFolder folder;
  std::filesystem::create_directory(folder.path() / "real");
  ASSERT_EQ(::chmod((folder.path() / "real").c_str(), 0700), 0);
  std::filesystem::create_symlink(folder.path() / "real", folder.path() / "link");
  EXPECT_TRUE(CheckEndpoint("ipc://" + (folder.path() / "real/s").string(), false).ok());
  const Status status = CheckEndpoint("ipc://" + (folder.path() / "link/s").string(), false);
  EXPECT_EQ(status.code(), Code::kRefused);
  EXPECT_NE(status.message().find("link"), std::string::npos);
}

TEST(Endpoint, RefusesAFolderInWhosePlaceOthersCouldPutTheirs) {
  const PrivateFolder folder;
  const std::filesystem::path open = folder.path() / "open";
  std::filesystem::create_directories(open / "mine");
  ASSERT_EQ(::chmod((open / "mine").c_str(), 0700), 0);
  const std::string endpoint = "ipc://" + (open / "mine/s").string();
  ASSERT_EQ(::chmod(open.c_str(), 0755), 0);
  EXPECT_TRUE(CheckEndpoint(endpoint, false).ok());
  ASSERT_EQ(::chmod(open.c_str(), 0777), 0);
  EXPECT_EQ(CheckEndpoint(endpoint, false).code(), Code::kRefused);
  ASSERT_EQ(::chmod(open.c_str(), 01777), 0);  // as /tmp is
  EXPECT_TRUE(CheckEndpoint(endpoint, false).ok());
  // The same, seen through a link that lies in a safe place.
  ASSERT_EQ(::chmod(open.c_str(), 0777), 0);
  std::filesystem::create_symlink(open, folder.path() / "link");
  EXPECT_EQ(CheckEndpoint("ipc://" + (folder.path() / "link/mine/s").string(), false).code(), Code::kRefused);
}

TEST(Endpoint, RefusesAnothersFolder) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can give a folder away";
  const PrivateFolder folder;
  std::filesystem::create_directory(folder.path() / "theirs");
  ASSERT_EQ(::chmod((folder.path() / "theirs").c_str(), 0700), 0);
  const std::string endpoint = "ipc://" + (folder.path() / "theirs/s").string();
  ASSERT_TRUE(CheckEndpoint(endpoint, false).ok());
  ASSERT_EQ(::chown((folder.path() / "theirs").c_str(), 1, 1), 0);
  EXPECT_EQ(CheckEndpoint(endpoint, false).code(), Code::kRefused);
  // Ours, but in theirs.
  std::filesystem::create_directory(folder.path() / "theirs/ours");
  ASSERT_EQ(::chmod((folder.path() / "theirs/ours").c_str(), 0700), 0);
  EXPECT_EQ(CheckEndpoint("ipc://" + (folder.path() / "theirs/ours/s").string(), false).code(),
            Code::kRefused);
}

TEST(Endpoint, RefusesAFileWhereTheSocketWouldBe) {
  const PrivateFolder folder;
  std::ofstream(folder.path() / "s") << "no socket";
  EXPECT_EQ(CheckEndpoint(folder.Ipc("s"), false).code(), Code::kRefused);
  std::filesystem::create_symlink("/tmp/elsewhere", folder.path() / "link");
  EXPECT_EQ(CheckEndpoint(folder.Ipc("link"), false).code(), Code::kRefused);
}

TEST(Endpoint, RefusesIpcWithoutAFolderOfItsOwn) {
  EXPECT_EQ(CheckEndpoint("ipc://@abstract", false).code(), Code::kRefused);
  EXPECT_EQ(CheckEndpoint("ipc://relative/name", false).code(), Code::kRefused);
  EXPECT_EQ(CheckEndpoint("ipc:///no/such/folder/name", false).code(), Code::kNotFound);
  EXPECT_EQ(CheckEndpoint("ipc:///" + std::string(107, 'x'), false).code(), Code::kRefused);
}

TEST(Endpoint, TcpNeedsKeys) {
  const Status status = CheckEndpoint("tcp://127.0.0.1:7000", false);
  EXPECT_EQ(status.code(), Code::kRefused);
  EXPECT_NE(status.message().find("keys"), std::string::npos);
  EXPECT_TRUE(CheckEndpoint("tcp://127.0.0.1:7000", true).ok());
}

TEST(Endpoint, RefusesOtherTransports) {
  for (const char* other : {"udp://1.2.3.4:5", "inproc://x", "pgm://x", "7000", ""}) {
    EXPECT_EQ(CheckEndpoint(other, true).code(), Code::kRefused) << other;
  }
}

}  // namespace
}  // namespace cairn::wire
