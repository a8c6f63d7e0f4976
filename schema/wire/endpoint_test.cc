#include "schema/wire/endpoint.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "schema/wire/testing.h"

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
