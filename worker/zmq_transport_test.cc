#include "worker/zmq_transport.h"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "schema/wire/testing/link.h"
#include "schema/wire/testing/private_folder.h"

namespace cairn::worker {
namespace {

// What came while the worker was at something else is not all taken at once.
TEST(ZmqTransport, ACallTakesNoMoreBytesThanItsLimit) {
  const wire::PrivateFolder folder;
  wire::Context context;
  wire::RouterSocket router = wire::RouterSocket::Bind(context, folder.Ipc("s")).value();
  const std::unique_ptr<ZmqTransport> transport = ZmqTransport::Connect(folder.Ipc("s")).value();
  std::vector<Event> begin;  // what comes before the handshake's end wakes it, too
  while (begin.empty()) begin = transport->Poll(wire::kPatience.count());
  ASSERT_EQ(begin[0].kind, Event::kConnected);
  ASSERT_TRUE(transport->Send(wire::HelloMessage("here")));
  const std::optional<wire::Received> hello = wire::AwaitMessage(router);
  ASSERT_TRUE(hello);
  constexpr int kMessages = 10;
  constexpr std::size_t kDoubles = 1 << 21;  // 16 MiB, of 64 that a call may take
  for (int i = 0; i < kMessages; ++i) ASSERT_TRUE(router.Send(hello->peer, wire::BlobMessage(kDoubles)).ok());
  const auto end = std::chrono::steady_clock::now() + wire::kPatience;
  wire::Poller poller;
  poller.Add(router);
  while (router.Unsent(hello->peer) > 0 && std::chrono::steady_clock::now() < end)
    poller.Wait(std::chrono::milliseconds(5));
  std::size_t taken = 0;
  while (taken < kMessages && std::chrono::steady_clock::now() < end) {
    const std::vector<Event> events = transport->Poll(0.1);
    EXPECT_LE(events.size(), 4U);
    for (const Event& event : events) EXPECT_EQ(event.kind, Event::kMessage);
    taken += events.size();
  }
  EXPECT_EQ(taken, kMessages);
}

}  // namespace
}  // namespace cairn::worker
