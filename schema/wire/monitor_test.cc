#include "schema/wire/monitor.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <optional>
#include <string>

#include "schema/wire/testing/private_folder.h"
#include "schema/wire/testing/raw_peer.h"

namespace cairn::wire {
namespace {

constexpr timeval kMonitorPatience{20, 0};  // far more than anything here takes

// Takes connections and breaks them off.
class RudePeer {
 public:
  explicit RudePeer(const std::string& path) : listener_(path) {
    EXPECT_EQ(
        ::setsockopt(listener_.fd(), SOL_SOCKET, SO_RCVTIMEO, &kMonitorPatience, sizeof kMonitorPatience), 0);
  }
  // False: none comes.
  bool BreakTheNext() const { return ::close(listener_.AcceptFd()) == 0; }

 private:
  const RawListener listener_;
};

struct MonitoredLink {
  PrivateFolder folder;
  RudePeer peer{(folder.path() / "s").string()};
  zmq::context_t context;
  zmq::socket_t dealer{context, zmq::socket_type::dealer};
  std::optional<Monitor> monitor{std::in_place, context, dealer,
                                 ZMQ_EVENT_CONNECTED | ZMQ_EVENT_DISCONNECTED};

  MonitoredLink() {
    dealer.set(zmq::sockopt::linger, 0);
    dealer.set(zmq::sockopt::reconnect_ivl, 1);
    dealer.connect(folder.Ipc("s"));
  }
  Monitor::Event Await() {
    zmq::pollitem_t item{monitor->handle(), 0, ZMQ_POLLIN, 0};
    zmq_poll(&item, 1, kMonitorPatience.tv_sec * 1000);
    return monitor->Next().value_or(Monitor::Event{});
  }
};

TEST(Monitor, TellsInOrderWhatBecomesOfAConnection) {
  MonitoredLink link;
  for (int i = 0; i < 3; ++i) {
    const Monitor::Event connected = link.Await();
    EXPECT_EQ(connected.kind, ZMQ_EVENT_CONNECTED);
    EXPECT_EQ(connected.where, link.folder.Ipc("s"));
    ASSERT_TRUE(link.peer.BreakTheNext());
    EXPECT_EQ(link.Await().kind, ZMQ_EVENT_DISCONNECTED);
  }
}

// Events come where nobody listens any more; ZeroMQ's thread would wait until somebody does.
TEST(Monitor, ThatHasGoneDoesNotHoldUpItsSocket) {
  MonitoredLink link;
  ASSERT_TRUE(link.peer.BreakTheNext());
  link.monitor.reset();
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(link.peer.BreakTheNext()) << i;
}

}  // namespace
}  // namespace cairn::wire
