#include "coordinator/server/address_lock.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>

#include "coordinator/server/testing/hub_fixture.h"

namespace cairn::coordinator {
namespace {

class AddressLockTest : public ::testing::Test {
 protected:
  std::string Path() const { return (temp_.path() / "s").string(); }
  std::string Endpoint() const { return "ipc://" + Path(); }
  // A listening socket there; the file stays when it is closed.
  int Listen() const {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, Path().c_str(), sizeof(address.sun_path) - 1);
    const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
    EXPECT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    EXPECT_EQ(::listen(socket, 1), 0);
    return socket;
  }
  TempFolder temp_;
};

TEST_F(AddressLockTest, OneAtATimeHasItAndTheOtherIsToldWho) {
  {
    const auto first = AddressLock::Take(Endpoint(), "store /one");
    ASSERT_TRUE(first.ok()) << first.status().message();
    const Status second = AddressLock::Take(Endpoint(), "store /two").status();
    EXPECT_EQ(second.code(), Code::kBusy);
    EXPECT_NE(second.message().find("process " + std::to_string(::getpid()) + ", store /one; stop it"),
              std::string::npos)
        << second.message();
  }
  EXPECT_TRUE(AddressLock::Take(Endpoint(), "store /two").ok());
}

TEST_F(AddressLockTest, ASocketThatAKilledProcessLeftIsInNobodysWay) {
  const int socket = Listen();
  const Status served = AddressLock::Take(Endpoint(), "").status();
  EXPECT_EQ(served.code(), Code::kBusy) << "by whom knows no locks";
  ::close(socket);
  ASSERT_TRUE(std::filesystem::exists(Path()));
  EXPECT_TRUE(AddressLock::Take(Endpoint(), "").ok());
}

TEST_F(AddressLockTest, WhatIsNoAddressIsRefusedAndOfTcpThereIsNothingToLock) {
  EXPECT_EQ(AddressLock::Take("ipc://relative", "").status().code(), Code::kRefused);
  const auto first = AddressLock::Take("tcp://127.0.0.1:7017", "");
  EXPECT_TRUE(AddressLock::Take("tcp://127.0.0.1:7017", "").ok());
}

}  // namespace
}  // namespace cairn::coordinator
